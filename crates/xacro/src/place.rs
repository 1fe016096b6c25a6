//! Places: files that were read, byte ranges in them, lines and columns for people.

use std::fmt;
use std::ops::Range;
use std::path::PathBuf;
use std::rc::Rc;

/// A position in a file, as an editor shows it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Place {
    /// The file as it was named on the way to it; for standard input the name that the caller gave.
    pub file: PathBuf,
    /// Line, from 1.
    pub line: usize,
    /// Column in characters, from 1.
    pub column: usize,
}

impl fmt::Display for Place {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "{}:{}:{}", self.file.display(), self.line, self.column)
    }
}

/// A file in memory.
#[derive(Debug)]
pub(crate) struct SourceFile {
    pub path: PathBuf,
    pub text: String,
}

/// A byte range of a file.
#[derive(Debug, Clone)]
pub(crate) struct Spot {
    pub file: Rc<SourceFile>,
    pub range: Range<usize>,
}

impl Spot {
    pub fn new(file: &Rc<SourceFile>, range: Range<usize>) -> Self {
        Self { file: Rc::clone(file), range }
    }

    pub fn place(&self) -> Place {
        let before = &self.file.text[..self.start()];
        Place {
            file: self.file.path.clone(),
            line: before.matches('\n').count() + 1,
            column: before.chars().rev().take_while(|&c| c != '\n').count() + 1,
        }
    }

    /// The whole line that the range begins in, and how many of its characters the range covers.
    pub fn line(&self) -> (&str, usize) {
        let text = &self.file.text;
        let start = self.start();
        let first = text[..start].rfind('\n').map_or(0, |at| at + 1);
        let last = text[start..].find('\n').map_or(text.len(), |at| start + at);
        let end = self.range.end.clamp(start, last);
        let covered = text.get(start..end).map_or(1, |part| part.chars().count());
        (text[first..last].trim_end_matches('\r'), covered.max(1))
    }

    /// The part of this text at `inner`, where `value` is what the XML reader made of it.
    ///
    /// Entities and line breaks change lengths, so the offsets are valid only where the text was read unchanged;
    /// otherwise the part is searched for by its own words.
    pub fn within(&self, value: &str, inner: Range<usize>) -> Self {
        let raw = self.file.text.get(self.range.clone()).unwrap_or_default();
        let offset = if raw.starts_with(value) {
            Some(inner.start)
        } else {
            value.get(inner.clone()).and_then(|part| raw.find(part))
        };
        match offset {
            Some(at) => {
                let start = self.range.start + at;
                Self::new(&self.file, start..start + inner.len())
            }
            None => self.clone(),
        }
    }

    fn start(&self) -> usize {
        let mut start = self.range.start.min(self.file.text.len());
        while !self.file.text.is_char_boundary(start) {
            start -= 1;
        }
        start
    }
}
