//! Paths and the URIs that editors use for them.

use gen_lsp_types::Uri;
use percent_encoding::{AsciiSet, NON_ALPHANUMERIC, percent_decode_str, utf8_percent_encode};
use std::path::{Path, PathBuf};

/// Characters of a path that are not escaped.
const KEPT: AsciiSet = NON_ALPHANUMERIC.remove(b'/').remove(b'-').remove(b'_').remove(b'.').remove(b'~');

/// The path of a `file` URI; `None` for other URIs.
pub(crate) fn path_of(uri: &Uri) -> Option<PathBuf> {
    let rest = uri.as_ref().strip_prefix("file://")?;
    let path = rest.strip_prefix("localhost").unwrap_or(rest);
    let path = percent_decode_str(path).decode_utf8().ok()?.into_owned();
    // A Windows drive follows a slash.
    let drive = path.strip_prefix('/').filter(|rest| rest.as_bytes().get(1) == Some(&b':'));
    Some(PathBuf::from(drive.unwrap_or(&path)))
}

pub(crate) fn uri_of(path: &Path) -> Uri {
    let shown = path.display().to_string().replace('\\', "/");
    let slash = if shown.starts_with('/') { "" } else { "/" };
    Uri::from(format!("file://{slash}{}", utf8_percent_encode(&shown, &KEPT)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_comes_back_from_its_address() {
        for path in ["/tmp/arm.urdf", "/tmp/my robots/\u{e4}rm #1.xacro"] {
            assert_eq!(path_of(&uri_of(Path::new(path))), Some(PathBuf::from(path)));
        }
        assert_eq!(path_of(&Uri::from("untitled:Untitled-1")), None);
        assert_eq!(path_of(&Uri::from("file:///c%3A/arm.urdf")), Some(PathBuf::from("c:/arm.urdf")));
    }
}
