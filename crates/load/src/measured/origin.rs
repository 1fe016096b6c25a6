//! Of which files a calibration is made, and when.

use super::rows::{DataFile, RowsAsked};
use super::search::SearchAsked;
use denavit_calibrate::calibration::contract::{FileRead, FileUse, Origin};
use jiff::Timestamp;
use sha2::{Digest as _, Sha256};

/// Seconds since 1970 to be taken for now, so that two runs make the same bytes.
///
/// # Source
/// <https://reproducible-builds.org/specs/source-date-epoch/>.
const CLOCK: &str = "SOURCE_DATE_EPOCH";

/// The files with their hashes, and the day.
pub(super) fn origin(asked: &RowsAsked) -> Origin {
    let sockets = asked.sockets.iter().map(|(_, file)| (file, FileUse::Socket));
    let fitted = asked.data.iter().map(|file| (file, FileUse::Fit)).chain(sockets);
    let all = fitted.chain(asked.test.iter().map(|file| (file, FileUse::Test)));
    let files = all.map(|(file, used)| FileRead { file: file.name.clone(), used, sha256: sha256(file) }).collect();
    Origin { date: Some(today()), files, ..Origin::default() }
}

/// The file of an earlier calibration as the origin lists it.
pub fn prior_read(asked: &SearchAsked) -> Option<FileRead> {
    let read = |file: &DataFile| FileRead { file: file.name.clone(), used: FileUse::Prior, sha256: sha256(file) };
    asked.prior.as_ref().map(read)
}

fn today() -> String {
    let said = std::env::var(CLOCK).ok().and_then(|seconds| Timestamp::from_second(seconds.parse().ok()?).ok());
    said.unwrap_or_else(Timestamp::now).strftime("%Y-%m-%d").to_string()
}

fn sha256(file: &DataFile) -> String {
    base16ct::lower::encode_string(&Sha256::digest(&file.bytes))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_are_known_by_the_hash_that_others_compute() {
        let file =
            |name: &str, bytes: &[u8]| DataFile { name: name.into(), bytes: bytes.into(), ..DataFile::default() };
        let asked = RowsAsked {
            data: vec![file("run.csv", b"abc")],
            sockets: vec![("front/0".into(), file("front.csv", b""))],
            test: Some(file("later.csv", b"abc")),
            ..RowsAsked::default()
        };
        let found = origin(&asked);
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
        assert!(date.len() == 10 && date.starts_with("20"), "{date}");
    }
}
