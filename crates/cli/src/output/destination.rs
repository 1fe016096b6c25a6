//! Where an output leads: links are followed, and what cannot be written is refused before the work.

use super::staged;
use crate::failure::Failure;
use std::fs::OpenOptions;
use std::io;
use std::path::{Path, PathBuf};

/// Links followed before a path counts as a loop, as Linux has it.
const MOST_LINKS: usize = 40;

/// Where an output goes.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Destination {
    /// `-`, or a name that the system has for it.
    StandardOutput,
    /// What is no regular file (a device, a pipe, an open file by its number): written straight into.
    Stream(PathBuf),
    /// A regular file or none yet, all links followed: replaced as a whole.
    File(PathBuf),
}

impl Destination {
    /// Follows a path as it was given, and refuses what cannot be written.
    pub fn of(given: &Path) -> Result<Self, Failure> {
        let refused = |reason: &str| Failure::Write { file: given.display().to_string(), reason: reason.to_owned() };
        let failed = |error: io::Error| refused(&error.to_string());
        if ["-", "/dev/stdout", "/dev/fd/1"].iter().any(|name| given == Path::new(name)) {
            return Ok(Self::StandardOutput);
        }
        let mut path = given.to_owned();
        for _ in 0..MOST_LINKS {
            let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
            let Some(name) = path.file_name() else { return Err(refused("it is a folder")) };
            let folder = match folder.canonicalize() {
                Ok(folder) if folder.is_dir() => folder,
                _ => return Err(refused(&format!("there is no folder {}", folder.display()))),
            };
            let here = folder.join(name);
            if folder.starts_with("/proc") || folder.starts_with("/dev/fd") {
                let own = Path::new("/proc/self/fd").canonicalize();
                let standard = name == "1" && own.is_ok_and(|own| own == folder);
                return Ok(if standard { Self::StandardOutput } else { Self::Stream(here) });
            }
            match here.symlink_metadata() {
                Ok(found) if found.is_symlink() => path = folder.join(here.read_link().map_err(failed)?),
                Ok(found) if found.is_dir() => return Err(refused("it is a folder")),
                Ok(found) if !found.is_file() => return Ok(Self::Stream(here)),
                Ok(found) => {
                    if found.permissions().readonly() {
                        let fix = "it is read-only; make it writable (chmod u+w) or write to another file";
                        return Err(refused(fix));
                    }
                    OpenOptions::new().write(true).open(&here).map_err(failed)?;
                    staged::temporary(&here, given)?;
                    return Ok(Self::File(here));
                }
                Err(error) if error.kind() == io::ErrorKind::NotFound => {
                    staged::temporary(&here, given)?;
                    return Ok(Self::File(here));
                }
                Err(error) => return Err(failed(error)),
            }
        }
        Err(refused("its links form a loop"))
    }

    /// Whether both are one place that can hold one text only.
    pub fn clashes_with(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::File(one), Self::File(two)) => {
                one == two || Identity::of(one).is_some_and(|one| Some(one) == Identity::of(two))
            }
            (Self::StandardOutput, Self::StandardOutput) => true,
            _ => false,
        }
    }

    /// Whether it is the regular file that `input` names (`-`: the file that standard input comes from).
    pub fn is_input(&self, input: &str) -> bool {
        let Self::File(target) = self else { return false };
        let input = Path::new(if input == "-" { "/dev/stdin" } else { input });
        Identity::of(target).is_some_and(|target| Some(target) == Identity::of(input))
    }
}

/// What makes a regular file the same by whatever name.
#[derive(PartialEq, Eq)]
struct Identity(#[cfg(unix)] (u64, u64), #[cfg(not(unix))] PathBuf);

impl Identity {
    /// `None` where there is no regular file.
    fn of(path: &Path) -> Option<Self> {
        let found = std::fs::metadata(path).ok().filter(std::fs::Metadata::is_file)?;
        #[cfg(unix)]
        {
            use std::os::unix::fs::MetadataExt as _;
            Some(Self((found.dev(), found.ino())))
        }
        #[cfg(not(unix))]
        {
            let _ = found;
            path.canonicalize().ok().map(Self)
        }
    }
}
