//! Files in the making: full beside their targets before the first target changes, and gone if the run ends before.

use crate::failure::Failure;
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, Once, PoisonError};
use tempfile::{NamedTempFile, TempPath};

/// Temporary files that would be left behind by a run that is interrupted now. Locked while files are renamed, so that an
/// interruption comes before all of that or after it.
static PENDING: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

/// Exit code of a run that was interrupted, as shells have it.
const INTERRUPTED: i32 = 130;

fn pending() -> MutexGuard<'static, Vec<PathBuf>> {
    PENDING.lock().unwrap_or_else(PoisonError::into_inner)
}

/// From the first temporary file on, Ctrl-C and its like take them away.
fn clean_up_when_interrupted() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        // Without a handler an interrupted run leaves its temporary files; no reason not to do the work.
        let _ = ctrlc::set_handler(|| {
            let pending = pending();
            for path in pending.iter() {
                let _ = std::fs::remove_file(path);
            }
            #[expect(clippy::exit, reason = "the run was interrupted, and its main thread does not know")]
            std::process::exit(INTERRUPTED);
        });
    });
}

fn failed(shown: &Path, error: &io::Error) -> Failure {
    Failure::Write { file: shown.display().to_string(), reason: error.to_string() }
}

/// An empty file beside `target` with the owner and mode that `target` has, or with those of any new file.
pub fn temporary(target: &Path, shown: &Path) -> Result<NamedTempFile, Failure> {
    clean_up_when_interrupted();
    let folder = target.parent().unwrap_or(Path::new("."));
    let file = {
        let mut pending = pending();
        let file = tempfile::Builder::new().prefix(".denavit-").tempfile_in(folder);
        let file = file.map_err(|error| {
            let reason = format!("no file can be created in {}: {}", folder.display(), error.kind());
            Failure::Write { file: shown.display().to_string(), reason }
        })?;
        pending.push(file.path().to_owned());
        file
    };
    like_the_old_one(target, &file, shown)?;
    Ok(file)
}

#[cfg(unix)]
fn like_the_old_one(target: &Path, file: &NamedTempFile, shown: &Path) -> Result<(), Failure> {
    use std::os::unix::fs::{MetadataExt as _, PermissionsExt as _, fchown};
    let made = file.as_file().metadata().map_err(|error| failed(shown, &error))?;
    let mode = match std::fs::metadata(target) {
        Ok(old) => {
            if (old.uid(), old.gid()) != (made.uid(), made.gid()) {
                fchown(file.as_file(), Some(old.uid()), Some(old.gid())).map_err(|_| Failure::Write {
                    file: shown.display().to_string(),
                    reason: "it belongs to another user or group, and replacing it would change its owner; write to \
                             another file"
                        .to_owned(),
                })?;
            }
            old.permissions()
        }
        // Temporary files are closed to others; a new file is not.
        Err(_) => std::fs::Permissions::from_mode(0o666 & !umask(target)),
    };
    file.as_file().set_permissions(mode).map_err(|error| failed(shown, &error))
}

/// The rights that new files do not get. Linux tells; elsewhere the usual ones.
#[cfg(unix)]
fn umask(_: &Path) -> u32 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("Umask:"));
    line.and_then(|octal| u32::from_str_radix(octal.trim(), 8).ok()).unwrap_or(0o022)
}

/// Windows gives a new file the rights of its folder.
#[cfg(not(unix))]
fn like_the_old_one(_: &Path, _: &NamedTempFile, _: &Path) -> Result<(), Failure> {
    Ok(())
}

/// A file that is full and waits to take its target's place.
pub struct Staged {
    file: NamedTempFile,
    target: PathBuf,
    shown: PathBuf,
}

impl Staged {
    /// Fills a temporary file.
    pub fn full(target: &Path, shown: &Path, content: &[u8]) -> Result<Self, Failure> {
        let mut file = temporary(target, shown)?;
        file.write_all(content).and_then(|()| file.flush()).map_err(|error| failed(shown, &error))?;
        Ok(Self { file, target: target.to_owned(), shown: shown.to_owned() })
    }
}

/// What was at a target before it was replaced.
enum Before {
    /// No file.
    Nothing,
    /// This one, under a second name.
    File(TempPath),
}

/// Renames every file to its target; where one fails, those before it get back what they were.
pub fn commit(files: Vec<Staged>) -> Result<(), Failure> {
    let mut pending = pending();
    // Everything that can be taken back is at hand before the first file changes. One file needs nothing: its renaming is done or not.
    let several = files.len() > 1;
    let mut staged = Vec::new();
    for file in files {
        let before =
            if several { Some(before(&file.target).map_err(|error| failed(&file.shown, &error))?) } else { None };
        staged.push((file, before));
    }
    let mut done: Vec<(PathBuf, Before)> = Vec::new();
    for (Staged { file, target, shown }, before) in staged {
        if let Err(error) = file.persist(&target) {
            let left = done.into_iter().rev().filter_map(taken_back).collect::<Vec<_>>();
            let reason = std::iter::once(error.error.to_string()).chain(left).collect::<Vec<_>>().join("; ");
            return Err(Failure::Write { file: shown.display().to_string(), reason });
        }
        done.extend(before.map(|before| (target, before)));
    }
    pending.clear();
    Ok(())
}

/// Gives a target back what it was; what to say where that fails.
fn taken_back((target, before): (PathBuf, Before)) -> Option<String> {
    match before {
        Before::Nothing => {
            let error = std::fs::remove_file(&target).err()?;
            Some(format!("{} is new and could not be removed: {error}", target.display()))
        }
        Before::File(old) => {
            let error = std::fs::rename(&old, &target).err()?;
            let kept = match old.keep() {
                Ok(path) => format!("it is kept as {}", path.display()),
                Err(error) => format!("it could not be kept, either: {}", error.error),
            };
            Some(format!("{} could not be restored: {error}; {kept}", target.display()))
        }
    }
}

/// What is at a target now: a second name for it, or a copy where the file system knows no second names.
fn before(target: &Path) -> io::Result<Before> {
    match std::fs::symlink_metadata(target) {
        Ok(_) => {}
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(Before::Nothing),
        Err(error) => return Err(error),
    }
    let folder = target.parent().unwrap_or(Path::new("."));
    let second = tempfile::Builder::new().prefix(".denavit-").make_in(folder, |name| std::fs::hard_link(target, name));
    let second = if let Ok(linked) = second {
        linked.into_temp_path()
    } else {
        let copy = tempfile::Builder::new().prefix(".denavit-").tempfile_in(folder)?.into_temp_path();
        std::fs::copy(target, &copy)?;
        copy
    };
    Ok(Before::File(second))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    #[test]
    fn a_rename_that_fails_takes_back_those_before_it() {
        let folder = tempfile::tempdir().expect("a folder");
        let at = |name: &str| folder.path().join(name);
        fs::write(at("old"), "old").expect("a file");
        let stage = |name: &str| Staged::full(&at(name), &at(name), b"new").expect("a temporary file");
        let files = vec![stage("old"), stage("fresh"), stage("lost")];
        fs::remove_file(files[2].file.path()).expect("the temporary file");
        assert!(commit(files).is_err());
        assert_eq!(fs::read_to_string(at("old")).expect("the old file"), "old");
        let names: Vec<_> =
            fs::read_dir(folder.path()).expect("a folder").flatten().map(|entry| entry.file_name()).collect();
        assert_eq!(names.len(), 1, "{names:?}");
    }

    #[test]
    fn a_target_of_which_nothing_can_be_kept_stops_the_run_before_any_file_changes() {
        let folder = tempfile::tempdir().expect("a folder");
        let at = |name: &str| folder.path().join(name);
        fs::write(at("first"), "old").expect("a file");
        let stage = |name: &str| Staged::full(&at(name), &at(name), b"new").expect("a temporary file");
        let files = vec![stage("first"), stage("second")];
        // Neither a second name nor a copy can be had of a folder.
        fs::create_dir(at("second")).expect("a folder");
        assert!(commit(files).is_err());
        assert_eq!(fs::read_to_string(at("first")).expect("the old file"), "old");
        let names: Vec<_> =
            fs::read_dir(folder.path()).expect("a folder").flatten().map(|entry| entry.file_name()).collect();
        assert_eq!(names.len(), 2, "{names:?}");
    }
}
