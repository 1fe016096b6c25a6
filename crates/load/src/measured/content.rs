//! What a file of measurements holds: read already, or still on the disk where it is larger than anybody wants in memory.

use crate::{LoadError, read_bytes};
use std::borrow::Cow;
use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};

/// A larger file is read row by row from where it lies, bytes.
const LARGE: u64 = 16 << 20;

/// The content of a file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Content {
    /// Its bytes.
    Bytes(Vec<u8>),
    /// Where it lies.
    OnDisk(PathBuf),
}

impl Default for Content {
    fn default() -> Self {
        Self::Bytes(Vec::new())
    }
}

impl<T: Into<Vec<u8>>> From<T> for Content {
    fn from(bytes: T) -> Self {
        Self::Bytes(bytes.into())
    }
}

impl Content {
    /// What to call a file, `-` or `git:REVISION:PATH`, and its content; that of a large file stays on the disk.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn of(name: &str) -> Result<(String, Self), LoadError> {
        let path = Path::new(name);
        let large = path.metadata().is_ok_and(|found| found.is_file() && found.len() > LARGE);
        if large {
            File::open(path).map_err(|error| LoadError::Read { file: name.to_owned(), reason: error.to_string() })?;
            return Ok((name.to_owned(), Self::OnDisk(path.to_owned())));
        }
        let (name, bytes) = read_bytes(name)?;
        Ok((name, Self::Bytes(bytes)))
    }

    /// From its beginning on.
    pub fn open(&self) -> Box<dyn Read + '_> {
        match self {
            Self::Bytes(bytes) => Box::new(&bytes[..]),
            Self::OnDisk(path) => match File::open(path) {
                Ok(file) => Box::new(file),
                Err(error) => Box::new(Unreadable(Some(error))),
            },
        }
    }

    /// All of it.
    pub(super) fn bytes(&self) -> io::Result<Cow<'_, [u8]>> {
        match self {
            Self::Bytes(bytes) => Ok(Cow::Borrowed(bytes)),
            Self::OnDisk(path) => std::fs::read(path).map(Cow::Owned),
        }
    }
}

/// A file that is there no more: the first who reads from it hears why, as of any other trouble of a disk.
struct Unreadable(Option<io::Error>);

impl Read for Unreadable {
    fn read(&mut self, _: &mut [u8]) -> io::Result<usize> {
        self.0.take().map_or(Ok(0), Err)
    }
}
