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
            let reason = format!("no file can be made in {}: {}", folder.display(), error.kind());
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
                    reason: "it belongs to another user or group, which it would not if it were replaced; write to \
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

/// Renames every file to its target; where one fails, those before it get back what they were.
pub fn commit(files: Vec<Staged>) -> Result<(), Failure> {
    let mut pending = pending();
    let several = files.len() > 1;
    let mut done: Vec<(PathBuf, Option<TempPath>)> = Vec::new();
    for Staged { file, target, shown } in files {
        let old = if several { kept(&target) } else { None };
        if let Err(error) = file.persist(&target) {
            for (target, old) in done {
                // What cannot be taken back stays; the message names the file that failed.
                let _ = match old {
                    Some(old) => std::fs::rename(&old, target),
                    None => std::fs::remove_file(target),
                };
            }
            return Err(failed(&shown, &error.error));
        }
        done.push((target, old));
    }
    pending.clear();
    Ok(())
}

/// A second name for the file that is about to be replaced; `None` where there is none, or no second name can be given.
fn kept(target: &Path) -> Option<TempPath> {
    let folder = target.parent()?;
    let name = tempfile::Builder::new().prefix(".denavit-").tempfile_in(folder).ok()?.into_temp_path();
    std::fs::remove_file(&name).ok()?;
    std::fs::hard_link(target, &name).ok()?;
    Some(name)
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
        let files = vec![stage("old"), stage("fresh"), stage("blocked")];
        fs::create_dir_all(at("blocked/by a folder")).expect("a folder");
        assert!(commit(files).is_err());
        assert_eq!(fs::read_to_string(at("old")).expect("the old file"), "old");
        let names: Vec<_> =
            fs::read_dir(folder.path()).expect("a folder").flatten().map(|entry| entry.file_name()).collect();
        assert_eq!(names.len(), 2, "{names:?}");
    }
}
