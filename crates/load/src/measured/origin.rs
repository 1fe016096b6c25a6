//! Of which files a calibration is made, and when.

use super::MeasuredError;
use super::rows::{DataFile, RowsAsked};
use super::search::SearchAsked;
use denavit_calibrate::calibration::contract::{FileRead, FileUse, Origin};
use jiff::Timestamp;
use sha2::{Digest as _, Sha256};
use std::io::Read;
use std::path::Path;

/// Bytes of a large file that are read at a time.
const PART: usize = 1 << 20;

/// Environment variable with the time to use as now, s since 1970, so that two runs give the same bytes.
///
/// # Source
/// <https://reproducible-builds.org/specs/source-date-epoch/>.
const CLOCK: &str = "SOURCE_DATE_EPOCH";

/// A file by its name and the SHA-256 of its bytes, hexadecimal.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct HashedFile {
    /// What messages call it.
    pub file: String,
    /// Hexadecimal.
    pub sha256: String,
}

impl HashedFile {
    /// Of a file that was read.
    pub fn of(file: &str, bytes: &[u8]) -> Self {
        Self { file: file.into(), sha256: base16ct::lower::encode_string(&Sha256::digest(bytes)) }
    }

    /// Of a file that is not kept as a whole: a bag may be larger than the memory.
    ///
    /// # Errors
    /// It cannot be read.
    pub fn read(file: &Path) -> std::io::Result<Self> {
        Self::of_all(&file.display().to_string(), std::fs::File::open(file)?)
    }

    fn of_all(file: &str, mut input: impl Read) -> std::io::Result<Self> {
        let (mut hash, mut part) = (Sha256::new(), vec![0; PART]);
        loop {
            match input.read(&mut part)? {
                0 => break,
                count => hash.update(&part[..count]),
            }
        }
        Ok(Self { file: file.into(), sha256: base16ct::lower::encode_string(&hash.finalize()) })
    }

    fn of_data(file: &DataFile) -> Result<Self, MeasuredError> {
        let unreadable = |error| MeasuredError::Unreadable { file: file.name.clone(), error };
        Self::of_all(&file.name, file.content.open()).map_err(unreadable)
    }
}

/// The bytes of a file, hashed while somebody else reads them: a large one is read once.
pub(super) struct Hashing<'a> {
    file: &'a DataFile,
    input: Box<dyn Read + 'a>,
    hash: Sha256,
}

impl<'a> Hashing<'a> {
    pub fn of(file: &'a DataFile) -> Self {
        Self { file, input: file.content.open(), hash: Sha256::new() }
    }

    /// The hash of the whole content, including what was not read.
    ///
    /// # Errors
    /// The rest cannot be read.
    pub fn finish(mut self) -> Result<HashedFile, MeasuredError> {
        let name = &self.file.name;
        std::io::copy(&mut self, &mut std::io::sink())
            .map_err(|error| MeasuredError::Unreadable { file: name.clone(), error })?;
        Ok(HashedFile { file: name.clone(), sha256: base16ct::lower::encode_string(&self.hash.finalize()) })
    }
}

impl Read for Hashing<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
        let count = self.input.read(buffer)?;
        self.hash.update(&buffer[..count]);
        Ok(count)
    }
}

/// The files with their hashes, and the day; `hashed`: training, sockets, test, in this order.
pub(super) fn origin(asked: &RowsAsked, hashed: Vec<HashedFile>) -> Origin {
    let sockets = asked.sockets.iter().map(|(_, file)| (file, FileUse::Socket));
    let fitted = asked.data.iter().map(|file| (file, FileUse::Fit)).chain(sockets);
    let all = || fitted.clone().chain(asked.test.iter().map(|file| (file, FileUse::Test)));
    let read = |file: HashedFile, used| FileRead { file: file.file, used, sha256: file.sha256 };
    let mut files: Vec<FileRead> = Vec::new();
    for ((file, used), hashed) in all().zip(hashed) {
        if file.bag.is_empty() {
            files.push(read(hashed, used));
        }
        files.extend(file.bag.iter().map(|part| read(part.clone(), used)));
    }
    for camera in all().filter_map(|(file, _)| file.camera.clone()).map(|camera| read(camera, FileUse::Camera)) {
        if !files.contains(&camera) {
            files.push(camera);
        }
    }
    Origin { date: Some(today()), files, ..Origin::default() }
}

/// The file of an earlier calibration as the origin lists it.
///
/// # Errors
/// It cannot be read.
pub fn prior_read(asked: &SearchAsked) -> Result<Option<FileRead>, MeasuredError> {
    let read = |file: &DataFile| {
        let HashedFile { file, sha256 } = HashedFile::of_data(file)?;
        Ok(FileRead { file, used: FileUse::Prior, sha256 })
    };
    asked.prior.as_ref().map(read).transpose()
}

fn today() -> String {
    let said = std::env::var(CLOCK).ok().and_then(|seconds| Timestamp::from_second(seconds.parse().ok()?).ok());
    said.unwrap_or_else(Timestamp::now).strftime("%Y-%m-%d").to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_are_known_by_the_hash_that_others_compute() {
        let file =
            |name: &str, bytes: &[u8]| DataFile { name: name.into(), content: bytes.into(), ..DataFile::default() };
        let asked = RowsAsked {
            data: vec![file("run.csv", b"abc")],
            sockets: vec![("front/0".into(), file("front.csv", b""))],
            test: Some(file("later.csv", b"abc")),
            ..RowsAsked::default()
        };
        let hash = |file: &DataFile| {
            let mut input = Hashing::of(file);
            // Somebody reads a part of it.
            let _ = input.read(&mut [0; 2]).unwrap();
            input.finish().unwrap()
        };
        let found =
            origin(&asked, [&asked.data[0], &asked.sockets[0].1, asked.test.as_ref().unwrap()].map(hash).into());
        // FIPS 180-4, appendix B.1, and of nothing.
        let (abc, nothing) = (
            "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad",
            "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855",
        );
        let read: Vec<_> = found.files.iter().map(|read| (&read.file[..], read.used, &read.sha256[..])).collect();
        let expected = [
            ("run.csv", FileUse::Fit, abc),
            ("front.csv", FileUse::Socket, nothing),
            ("later.csv", FileUse::Test, abc),
        ];
        assert_eq!(read, expected);
        let date = found.date.unwrap();
        // A bag stands by its own files, a camera once.
        let part = concat!(env!("CARGO_MANIFEST_DIR"), "/Cargo.toml");
        let hashed = HashedFile::read(Path::new(part)).unwrap();
        assert_eq!(hashed, HashedFile::of(part, &std::fs::read(part).unwrap()));
        let bag = vec![HashedFile { sha256: abc.into(), ..hashed }];
        let camera = Some(HashedFile::of("webcam.yaml", b""));
        let first = DataFile { bag, camera: camera.clone(), ..file("run", b"rows made of it") };
        let second = DataFile { camera, ..file("corners.csv", b"") };
        let hashes = [&first, &second].map(hash).into();
        let found = origin(&RowsAsked { data: vec![first], test: Some(second), ..RowsAsked::default() }, hashes);
        let read: Vec<_> = found.files.iter().map(|read| (&read.file[..], read.used, &read.sha256[..])).collect();
        let expected = [
            (part, FileUse::Fit, abc),
            ("corners.csv", FileUse::Test, nothing),
            ("webcam.yaml", FileUse::Camera, nothing),
        ];
        assert_eq!(read, expected);
        assert!(date.len() == 10 && date.starts_with("20"), "{date}");
    }
}
