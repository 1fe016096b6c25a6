//! A text with its lines, and positions in it as editors count them.

use gen_lsp_types::{Position, Range};
use std::ops::Range as Bytes;

/// The unit of columns.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) enum Encoding {
    /// UTF-16 code units, which every client supports.
    #[default]
    Utf16,
    /// Bytes.
    Utf8,
}

/// A text and where its lines start.
// A text has a text.
#[allow(clippy::struct_field_names)]
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Text {
    pub text: String,
    starts: Vec<usize>,
    encoding: Encoding,
}

impl Text {
    pub fn new(text: impl Into<String>, encoding: Encoding) -> Self {
        let text = text.into();
        let starts = std::iter::once(0).chain(text.match_indices('\n').map(|(at, _)| at + 1)).collect();
        Self { text, starts, encoding }
    }

    /// The bytes of a line (from 0) without its end; of the last line if there is no such line.
    pub fn line(&self, line: usize) -> Bytes<usize> {
        let line = line.min(self.starts.len() - 1);
        let start = self.starts[line];
        let end = self.starts.get(line + 1).map_or(self.text.len(), |next| next - 1);
        start..start + self.text[start..end].trim_end_matches('\r').len()
    }

    /// The same without surrounding white space; the whole line if it is blank.
    pub fn words_of_line(&self, line: usize) -> Bytes<usize> {
        let whole = self.line(line);
        let words = self.text[whole.clone()].trim();
        if words.is_empty() {
            return whole;
        }
        let start = words.as_ptr() as usize - self.text.as_ptr() as usize;
        start..start + words.len()
    }

    /// The line (from 0) of a byte offset.
    pub fn line_of(&self, at: usize) -> usize {
        self.starts.partition_point(|start| *start <= at).saturating_sub(1)
    }

    pub fn position(&self, at: usize) -> Position {
        let at = self.floor(at);
        let line = self.line_of(at);
        let before = &self.text[self.starts[line]..at];
        let character = match self.encoding {
            Encoding::Utf8 => before.len(),
            Encoding::Utf16 => before.chars().map(char::len_utf16).sum(),
        };
        Position { line: small(line), character: small(character) }
    }

    pub fn range(&self, bytes: &Bytes<usize>) -> Range {
        Range { start: self.position(bytes.start), end: self.position(bytes.end) }
    }

    /// The byte offset of a position; positions after a line's end are its end.
    pub fn offset(&self, position: Position) -> usize {
        let line = position.line as usize;
        if line >= self.starts.len() {
            return self.text.len();
        }
        let bytes = self.line(line);
        let mut left = position.character as usize;
        for (at, c) in self.text[bytes.clone()].char_indices() {
            let length = match self.encoding {
                Encoding::Utf8 => c.len_utf8(),
                Encoding::Utf16 => c.len_utf16(),
            };
            if left < length {
                return bytes.start + at;
            }
            left -= length;
        }
        bytes.end
    }

    pub fn bytes(&self, range: Range) -> Bytes<usize> {
        let start = self.offset(range.start);
        start..self.offset(range.end).max(start)
    }

    /// The byte offset of a line and column in characters, both from 1.
    pub fn at_column(&self, line: usize, column: usize) -> usize {
        let bytes = self.line(line.saturating_sub(1));
        let inside = self.text[bytes.clone()].char_indices().nth(column.saturating_sub(1));
        inside.map_or(bytes.end, |(at, _)| bytes.start + at)
    }

    fn floor(&self, at: usize) -> usize {
        let mut at = at.min(self.text.len());
        while !self.text.is_char_boundary(at) {
            at -= 1;
        }
        at
    }
}

fn small(count: usize) -> u32 {
    u32::try_from(count).unwrap_or(u32::MAX)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn positions_and_offsets_agree_in_both_encodings() {
        let words = "a\u{e4}\u{1f916}b\r\n\u{3b8}\nend";
        for encoding in [Encoding::Utf8, Encoding::Utf16] {
            let text = Text::new(words, encoding);
            for (at, c) in words.char_indices().filter(|(_, c)| *c != '\r' && *c != '\n') {
                assert_eq!(text.offset(text.position(at)), at, "{c} {encoding:?}");
            }
            assert_eq!(&words[text.line(0)], "a\u{e4}\u{1f916}b");
            assert_eq!(text.offset(Position { line: 9, character: 9 }), words.len());
            assert_eq!(text.offset(Position { line: 1, character: 9 }), words.find("\nend").unwrap());
        }
        assert_eq!(Text::new(words, Encoding::Utf16).position(7), Position { line: 0, character: 4 });
        assert_eq!(Text::new(words, Encoding::Utf8).position(7), Position { line: 0, character: 7 });
    }
}
