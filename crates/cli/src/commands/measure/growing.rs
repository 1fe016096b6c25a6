//! A text that grows: a file that is polled, or standard input. An incomplete last line waits for its end.

use crate::failure::Failure;
use crate::source;
use std::fs;
use std::io::{self, BufRead as _};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::thread;
use std::time::{Duration, SystemTime};

/// What became of the text.
pub enum News {
    /// Nothing.
    Nothing,
    /// Something that must be known.
    Said(String),
    /// What was there is not there any more, and why: the text begins anew.
    Anew(String),
    /// Whole lines more: all lines so far.
    Rows(Vec<u8>),
    /// The whole text: nothing more will come.
    End(Vec<u8>),
}

/// A text that grows.
pub enum Growing {
    /// Read once.
    Whole(String),
    /// A file.
    File(File),
    /// Standard input, line by line.
    Input { lines: Receiver<io::Result<Vec<u8>>>, text: Vec<u8> },
}

impl Growing {
    /// `-` is standard input. A file is read once unless it is to be watched.
    pub fn open(name: &str, watch: bool) -> Self {
        if name == "-" {
            let (give, lines) = channel();
            thread::spawn(move || {
                let mut input = io::stdin().lock();
                loop {
                    let mut line = Vec::new();
                    match input.read_until(b'\n', &mut line) {
                        Ok(0) => break,
                        read => {
                            let failed = read.is_err();
                            if give.send(read.map(|_| line)).is_err() || failed {
                                break;
                            }
                        }
                    }
                }
            });
            return Self::Input { lines, text: Vec::new() };
        }
        if watch { Self::File(File::new(name)) } else { Self::Whole(name.into()) }
    }

    /// Waits no longer than this for news.
    pub fn wait(&mut self, most: Duration) -> Result<News, Failure> {
        match self {
            Self::Whole(name) => Ok(News::End(source::read_bytes(name)?.1)),
            Self::File(file) => {
                let news = file.poll()?;
                if matches!(news, News::Nothing) {
                    thread::sleep(most);
                }
                Ok(news)
            }
            Self::Input { lines, text } => {
                let mut next = lines.recv_timeout(most);
                let mut any = false;
                loop {
                    match next {
                        Ok(line) => {
                            let failed = |error: io::Error| Failure::Argument(format!("standard input: {error}"));
                            text.extend(line.map_err(failed)?);
                            any = true;
                        }
                        Err(RecvTimeoutError::Disconnected) => return Ok(News::End(text.clone())),
                        Err(RecvTimeoutError::Timeout) if any => return Ok(News::Rows(whole_lines(text).to_vec())),
                        Err(RecvTimeoutError::Timeout) => return Ok(News::Nothing),
                    }
                    next = lines.recv_timeout(Duration::ZERO);
                }
            }
        }
    }
}

/// A file that is watched.
pub struct File {
    name: String,
    /// Whole lines that were given.
    given: Vec<u8>,
    /// Length and time of change when it was read last.
    seen: Option<(u64, Option<SystemTime>)>,
    is_missing: bool,
}

impl File {
    fn new(name: &str) -> Self {
        Self { name: name.into(), given: Vec::new(), seen: None, is_missing: false }
    }

    fn poll(&mut self) -> Result<News, Failure> {
        let unreadable = |error: io::Error| Failure::Argument(format!("{}: cannot be read: {error}", self.name));
        let found = fs::metadata(&self.name).and_then(|found| {
            let seen = (found.len(), found.modified().ok());
            if self.seen == Some(seen) { Ok(None) } else { Ok(Some((seen, fs::read(&self.name)?))) }
        });
        let (seen, bytes) = match found {
            Ok(None) => return Ok(News::Nothing),
            Ok(Some(read)) => read,
            Err(error) if error.kind() == io::ErrorKind::NotFound => {
                if std::mem::replace(&mut self.is_missing, true) {
                    return Ok(News::Nothing);
                }
                self.seen = None;
                return Ok(News::Said(format!("{}: there is no such file now; waiting for it", self.name)));
            }
            Err(error) => return Err(unreadable(error)),
        };
        self.is_missing = false;
        let lines = whole_lines(&bytes);
        if !lines.starts_with(&self.given) {
            let why = if self.given.starts_with(lines) {
                "the file is shorter than before"
            } else {
                "the file has other content than before"
            };
            self.given.clear();
            // The new lines are given when it is looked at again.
            self.seen = None;
            return Ok(News::Anew(why.into()));
        }
        self.seen = Some(seen);
        if lines.len() == self.given.len() {
            return Ok(News::Nothing);
        }
        self.given = lines.to_vec();
        Ok(News::Rows(self.given.clone()))
    }
}

/// The lines that end; in UTF-16, too.
fn whole_lines(bytes: &[u8]) -> &[u8] {
    let wide = |feed: [u8; 2]| {
        let end = bytes.chunks_exact(2).rposition(|pair| pair == feed).map_or(0, |at| 2 * at + 2);
        &bytes[..end]
    };
    match bytes {
        [0xff, 0xfe, ..] => wide([b'\n', 0]),
        [0xfe, 0xff, ..] => wide([0, b'\n']),
        _ => &bytes[..bytes.iter().rposition(|byte| *byte == b'\n').map_or(0, |at| at + 1)],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_a_line_waits() {
        assert_eq!(whole_lines(b"a,b\n1,2\n3"), b"a,b\n1,2\n");
        assert_eq!(whole_lines(b"a,b"), b"");
        // U+0A0D has a byte that looks like a line's end.
        assert_eq!(whole_lines(b"\xff\xfea\0\n\0\x0d\x0ab\0"), b"\xff\xfea\0\n\0");
        assert_eq!(whole_lines(b"\xfe\xff\0a\0\n\x0a\x0d"), b"\xfe\xff\0a\0\n");
    }

    #[test]
    fn a_file_that_grows_shrinks_and_goes_is_followed() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("run.csv");
        let mut file = File::new(path.to_str().unwrap());
        let mut next = || match file.poll().unwrap() {
            News::Nothing => "nothing".to_owned(),
            News::Said(what) => what.rsplit_once(": ").unwrap().1.to_owned(),
            News::Anew(why) => why,
            News::Rows(text) | News::End(text) => String::from_utf8(text).unwrap(),
        };
        assert_eq!([next(), next()], ["there is no such file now; waiting for it", "nothing"]);
        fs::write(&path, "a\n1").unwrap();
        assert_eq!([next(), next()], ["a\n", "nothing"]);
        fs::write(&path, "a\n12\n").unwrap();
        assert_eq!([next(), next()], ["a\n12\n", "nothing"]);
        fs::write(&path, "a\n").unwrap();
        assert_eq!([next(), next(), next()], ["the file is shorter than before", "a\n", "nothing"]);
        fs::write(&path, "b\n3\n").unwrap();
        assert_eq!([next(), next()], ["the file has other content than before", "b\n3\n"]);
        fs::remove_file(&path).unwrap();
        assert_eq!(next(), "there is no such file now; waiting for it");
        fs::write(&path, "b\n3\n4\n").unwrap();
        assert_eq!(next(), "b\n3\n4\n");
    }
}
