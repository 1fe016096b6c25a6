//! The files of a revision in git, in place of those of the working tree.

use denavit_xacro::files::{self, FileOverlay};
use denavit_xacro::{Frame, XacroError};
use std::cell::RefCell;
use std::io;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::Arc;

/// Where a source is, and what is around it: the disk, or a revision in git.
#[derive(Debug, Clone)]
pub(crate) struct Home {
    /// The source as a file; of a revision where it is in the working tree, whether or not it is there now.
    pub path: PathBuf,
    revision: Option<Revision>,
}

#[derive(Debug, Clone)]
struct Revision {
    /// As written: `HEAD`; empty for the index.
    name: String,
    /// The top folder of the working tree.
    top: PathBuf,
    files: Arc<FileOverlay>,
}

impl Home {
    /// Of a source as it is named: `arm.xacro`, `git:HEAD:arm.xacro`.
    ///
    /// # Errors
    /// Git cannot be asked, or does not have the revision.
    pub fn of(source: &str) -> Result<Self, String> {
        let Some((name, path)) = object_of(source) else { return Ok(Self { path: source.into(), revision: None }) };
        // The repository of a path that says where it is may be another than the one around us.
        let above =
            Path::new(path).is_absolute().then(|| Path::new(path).ancestors().skip(1).find(|above| above.is_dir()));
        let folder = above.flatten().unwrap_or(Path::new("."));
        let shown = |arguments: &[&str]| git(folder, arguments).map(|bytes| line(&bytes));
        // A repository without a working tree has its files where it is itself.
        let top = shown(&["rev-parse", "--show-toplevel"]).or_else(|_| shown(&["rev-parse", "--absolute-git-dir"]))?;
        let top = PathBuf::from(top);
        let relative = path.starts_with("./") || path.starts_with("../") || path == "." || path == "..";
        if Path::new(path).is_absolute() {
            let real = folder.canonicalize().map_err(|error| error.to_string())?;
            let rest = Path::new(path).strip_prefix(folder).map_err(|error| error.to_string())?;
            let (path, files) = (real.join(rest), files_of(name, &top)?);
            return Ok(Self { path, revision: Some(Revision { name: name.to_owned(), top, files }) });
        }
        let from = if relative { top.join(shown(&["rev-parse", "--show-prefix"])?) } else { top.clone() };
        let files = files_of(name, &top)?;
        let path = from.join(path);
        Ok(Self { path, revision: Some(Revision { name: name.to_owned(), top, files }) })
    }

    /// Runs `work` where the files of the revision stand in place of the working tree's.
    pub fn within<T>(&self, work: impl FnOnce() -> T) -> T {
        match &self.revision {
            Some(revision) => files::with(Some(Arc::clone(&revision.files)), work),
            None => work(),
        }
    }

    /// Whether the source is of a revision.
    pub fn is_revision(&self) -> bool {
        self.revision.is_some()
    }

    /// Whether a file that was read is one of the revision's.
    pub fn holds(&self, file: &Path) -> bool {
        self.revision.as_ref().is_some_and(|revision| file.starts_with(&revision.top))
    }

    /// What messages call a file: `git:HEAD:urdf/arm.xacro`.
    fn shown(&self, file: &Path) -> PathBuf {
        let Some(revision) = &self.revision else { return file.to_path_buf() };
        match file.strip_prefix(&revision.top) {
            Ok(path) => format!("git:{}:{}", revision.name, path.display()).into(),
            Err(_) => file.to_path_buf(),
        }
    }

    /// A text in which the files of the working tree are called by the revision.
    pub fn shown_in(&self, text: &str) -> String {
        match &self.revision {
            Some(revision) => text.replace(&format!("{}/", revision.top.display()), &format!("git:{}:", revision.name)),
            None => text.to_owned(),
        }
    }

    /// An error whose places are those of the revision.
    pub fn error(&self, mut error: XacroError) -> XacroError {
        error.message = self.shown_in(&error.message);
        if let Some(place) = &mut error.place {
            place.file = self.shown(&place.file);
        }
        for frame in &mut error.stack {
            match frame {
                Frame::Macro { defined, called, .. } => {
                    defined.file = self.shown(&defined.file);
                    called.file = self.shown(&called.file);
                }
                Frame::Include { file, at } => {
                    *file = self.shown(file);
                    at.file = self.shown(&at.file);
                }
                Frame::Property { used, .. } => used.file = self.shown(&used.file),
                _ => {}
            }
        }
        error
    }
}

/// Revision and path of `git:REVISION:PATH`.
pub(crate) fn object_of(source: &str) -> Option<(&str, &str)> {
    source.strip_prefix("git:")?.split_once(':')
}

/// What git prints, or why it does not.
pub(crate) fn git(folder: &Path, arguments: &[&str]) -> Result<Vec<u8>, String> {
    let run = Command::new("git").arg("-C").arg(folder).args(arguments).output();
    let run = run.map_err(|error| format!("git could not be run: {error}"))?;
    if run.status.success() { Ok(run.stdout) } else { Err(String::from_utf8_lossy(&run.stderr).trim().to_owned()) }
}

pub(crate) fn line(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).trim_end_matches(['\n', '\r']).to_owned()
}

/// A working tree, what its revision is called, and the files of that.
type Listed = (PathBuf, Vec<u8>, Arc<FileOverlay>);

thread_local! {
    /// The revision that was listed last: a source is looked at several times.
    static LAST: RefCell<Option<Listed>> = const { RefCell::new(None) };
}

/// Every file of a revision by its name in the working tree; of the index where the name is empty.
fn files_of(revision: &str, top: &Path) -> Result<Arc<FileOverlay>, String> {
    if revision.starts_with('-') {
        return Err("a revision may not begin with \"-\"".into());
    }
    let listed = if revision.is_empty() {
        git(top, &["ls-files", "--stage", "-z"])?
    } else {
        git(top, &["ls-tree", "-r", "-z", "--full-tree", revision])?
    };
    let known = LAST.with_borrow(|last| {
        last.as_ref().filter(|(of, list, _)| of == top && *list == listed).map(|(.., files)| Arc::clone(files))
    });
    if let Some(files) = known {
        return Ok(files);
    }
    let mut held = FileOverlay::below(top);
    for entry in listed.split(|byte| *byte == 0).filter(|entry| !entry.is_empty()) {
        let entry = String::from_utf8_lossy(entry);
        // "MODE blob ID\tPATH" of a tree, "MODE ID STAGE\tPATH" of the index.
        let Some((head, path)) = entry.split_once('\t') else { continue };
        let words: Vec<&str> = head.split(' ').collect();
        let (mode, id) = match words[..] {
            [mode, "blob" | "commit", id] | [mode, id, "0"] => (mode, id.to_owned()),
            _ => continue,
        };
        let name = top.join(path);
        let folder = top.to_path_buf();
        let read = move || git(&folder, &["cat-file", "blob", &id]).map_err(io::Error::other);
        match mode {
            "160000" => held.refuse(
                &name,
                format!(
                    "it is in the submodule {path}, whose files are not in this revision; compare inside the submodule"
                ),
            ),
            "120000" => held.add_link(&name, read),
            _ => held.add_later(&name, read),
        }
    }
    let held = Arc::new(held);
    LAST.set(Some((top.to_path_buf(), listed, Arc::clone(&held))));
    Ok(held)
}
