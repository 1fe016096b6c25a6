//! The files that may be looked at: those of the disk, or those held in memory where there is no disk, as in a browser.
//!
//! While files are [held](hold), the disk is not looked at by this thread. Held files have absolute names, such as
//! `/arm_description/urdf/arm.xacro`; there are no links among them.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::io::{Error, ErrorKind, Result};
use std::path::{Component, Path, PathBuf};

type Held = BTreeMap<PathBuf, Vec<u8>>;

thread_local! {
    static HELD: RefCell<Option<Held>> = const { RefCell::new(None) };
}

/// Runs `work` with these files in place of the disk; relative names begin at `/`.
pub fn with_held<T>(files: impl IntoIterator<Item = (PathBuf, Vec<u8>)>, work: impl FnOnce() -> T) -> T {
    let files: Held = files.into_iter().map(|(name, bytes)| (lexical(&name), bytes)).collect();
    let before = HELD.replace(Some(files));
    let done = work();
    HELD.set(before);
    done
}

/// Whether files are held in place of the disk.
pub fn are_held() -> bool {
    HELD.with_borrow(Option::is_some)
}

/// The content of a file.
///
/// # Errors
/// There is no such file, or it cannot be read.
pub fn read(path: &Path) -> Result<Vec<u8>> {
    in_memory(|files| files.get(&lexical(path)).cloned().ok_or_else(missing)).unwrap_or_else(|| std::fs::read(path))
}

/// Whether there is such a file.
pub fn is_file(path: &Path) -> bool {
    in_memory(|files| files.contains_key(&lexical(path))).unwrap_or_else(|| path.is_file())
}

/// Whether there is such a folder.
pub fn is_folder(path: &Path) -> bool {
    in_memory(|files| holds_folder(files, &lexical(path))).unwrap_or_else(|| path.is_dir())
}

/// Whether there is such a file or folder.
pub fn exists(path: &Path) -> bool {
    is_file(path) || is_folder(path) || (!are_held() && path.exists())
}

/// The absolute name of what is there, links resolved.
///
/// # Errors
/// There is nothing.
pub fn canonical(path: &Path) -> Result<PathBuf> {
    let held = in_memory(|files| {
        let path = lexical(path);
        if files.contains_key(&path) || holds_folder(files, &path) { Ok(path) } else { Err(missing()) }
    });
    held.unwrap_or_else(|| path.canonicalize())
}

/// The absolute form of a name; nothing need be there.
///
/// # Errors
/// The working directory cannot be told.
pub fn absolute(path: &Path) -> Result<PathBuf> {
    in_memory(|_| Ok(lexical(path))).unwrap_or_else(|| std::path::absolute(path))
}

/// The number of bytes of a file; `None` for a folder.
///
/// # Errors
/// There is nothing.
pub(crate) fn size(path: &Path) -> Result<Option<u64>> {
    let held = in_memory(|files| {
        let path = lexical(path);
        match files.get(&path) {
            Some(bytes) => Ok(Some(bytes.len() as u64)),
            None if holds_folder(files, &path) => Ok(None),
            None => Err(missing()),
        }
    });
    held.unwrap_or_else(|| std::fs::metadata(path).map(|found| found.is_file().then_some(found.len())))
}

/// The files and folders in a folder, in no order; none where there is no such folder.
pub(crate) fn entries(folder: &Path) -> Vec<PathBuf> {
    let held = in_memory(|files| {
        let inside = lexical(folder);
        let mut names: Vec<PathBuf> = files
            .keys()
            .filter_map(|file| Some(folder.join(file.strip_prefix(&inside).ok()?.components().next()?)))
            .collect();
        names.dedup();
        names
    });
    held.unwrap_or_else(|| {
        std::fs::read_dir(folder)
            .map_or_else(|_| Vec::new(), |found| found.flatten().map(|entry| entry.path()).collect())
    })
}

fn in_memory<T>(look: impl FnOnce(&Held) -> T) -> Option<T> {
    HELD.with_borrow(|files| files.as_ref().map(look))
}

fn holds_folder(files: &Held, folder: &Path) -> bool {
    files.range(folder.to_path_buf()..).next().is_some_and(|(file, _)| file.starts_with(folder))
}

fn missing() -> Error {
    Error::from(ErrorKind::NotFound)
}

/// The name from `/` on, without `.` and `..`; nothing is above `/`.
fn lexical(path: &Path) -> PathBuf {
    let mut out = PathBuf::from("/");
    for component in path.components() {
        match component {
            Component::Normal(name) => out.push(name),
            Component::ParentDir => {
                out.pop();
            }
            _ => {}
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Options, PackagePath, Source, expand};

    fn text(name: &str, text: &str) -> (PathBuf, Vec<u8>) {
        (name.into(), text.as_bytes().to_vec())
    }

    #[test]
    fn a_xacro_file_and_its_packages_expand_from_memory() {
        let arm = r#"<robot name="arm" xmlns:xacro="http://ros.org/wiki/xacro">
            <xacro:include filename="$(find tools)/gripper.xacro"/><xacro:include filename="parts/*.xacro"/></robot>"#;
        let part =
            |link: &str| format!("<robot xmlns:xacro=\"http://ros.org/wiki/xacro\"><link name=\"{link}\"/></robot>");
        let files = [
            text("/ros/arm/package.xml", "<package><name>arm</name></package>"),
            text("/ros/arm/arm.xacro", arm),
            text("/ros/arm/parts/one.xacro", &part("one")),
            text("/ros/hand/package.xml", "<package><name>tools</name></package>"),
            text("/ros/hand/gripper.xacro", &part("finger")),
        ];
        let expanded = with_held(files, || expand(&Source::path("/ros/arm/arm.xacro"), &[], &Options::default()));
        let urdf = expanded.unwrap().urdf;
        assert!(urdf.contains("\"finger\"") && urdf.contains("\"one\""), "{urdf}");
        assert!(!are_held());
    }

    #[test]
    fn nothing_of_the_disk_and_nothing_above_the_top_is_seen_while_files_are_held() {
        with_held([text("a/../../b.txt", "b")], || {
            assert_eq!(read(Path::new("/b.txt")).unwrap(), b"b");
            assert!(!exists(Path::new(env!("CARGO_MANIFEST_DIR"))));
            assert!(PackagePath::default().packages().is_empty());
        });
        assert!(exists(Path::new(env!("CARGO_MANIFEST_DIR"))));
    }
}
