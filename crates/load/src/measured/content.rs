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

/// A file that is there no more: the first who reads from it hears why, as of any other error of a disk.
struct Unreadable(Option<io::Error>);

impl Read for Unreadable {
    fn read(&mut self, _: &mut [u8]) -> io::Result<usize> {
        self.0.take().map_or(Ok(0), Err)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measured::{DataFile, HashedFile, RowsAsked, rows};
    use denavit_identify::parameters::NoEffects;
    use denavit_identify::simulate::{SimulationOptions, simulate};
    use denavit_measurements::write;
    use denavit_model::examples;

    #[test]
    fn a_large_file_stays_on_the_disk_and_gives_the_same_rows() {
        let chain = examples::puma_like();
        let text = write(&simulate(&chain, &SimulationOptions::default(), &NoEffects).data, &[]);
        // Comments make it large.
        let comment = format!("# {}\n", "a word about the measurement ".repeat(100));
        let count = usize::try_from(LARGE).unwrap() / comment.len() + 1;
        let text = format!("{text}{}", comment.repeat(count));
        let file = std::env::temp_dir().join(format!("denavit-content-{}.csv", std::process::id()));
        std::fs::write(&file, &text).unwrap();
        let (name, large) = Content::of(file.to_str().unwrap()).unwrap();
        assert_eq!(large, Content::OnDisk(file.clone()));
        assert_eq!(&*large.bytes().unwrap(), text.as_bytes());
        let asked = |content: Content| {
            let data = vec![DataFile { name: name.clone(), content, ..DataFile::default() }];
            RowsAsked { data, ..RowsAsked::default() }
        };
        let (on_disk, in_memory) = (asked(large), asked(text.as_str().into()));
        let (one, other) = (rows(&on_disk, &chain).unwrap(), rows(&in_memory, &chain).unwrap());
        assert_eq!((one.data, &one.notes, &one.columns), (other.data, &other.notes, &other.columns));
        assert_eq!(one.origin.files, other.origin.files);
        assert_eq!(one.origin.files[0].sha256, HashedFile::of(&name, text.as_bytes()).sha256);
        // It is taken away before it is read.
        std::fs::remove_file(&file).unwrap();
        let error = rows(&on_disk, &chain).unwrap_err().to_string();
        assert!(error.contains(&name) && error.contains("No such file"), "{error}");
    }
}
