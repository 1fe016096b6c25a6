//! What a rule found, and fixing it.

use crate::lint::{Rule, Sheet};
use crate::report::Level;
use denavit_model::Place;
use denavit_model::formats::Format;
use serde::Serialize;
use std::fmt;

/// What a rule found.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Finding {
    /// The rule's code.
    pub rule: &'static str,
    /// How serious it is.
    pub level: Level,
    /// Where.
    pub place: Place,
    /// What is wrong, with the value; the fix.
    pub message: String,
    /// Edits of the original text that certainly fix it; otherwise empty.
    pub fix: Vec<Edit>,
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Place { file, line, element } = &self.place;
        write!(f, "{file}:{line}: {} {element}: {}", self.rule, self.message)
    }
}

/// A part of the original text and its replacement.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Edit {
    /// Byte offset of its start.
    pub start: usize,
    /// Byte offset after its end.
    pub end: usize,
    /// The replacement.
    pub text: String,
}

/// A finding as a rule's code creates it.
pub(super) struct Found {
    place: Where,
    message: String,
    fix: Vec<Edit>,
}

enum Where {
    /// Byte offset into the read text, and the element.
    Offset(usize, String),
    Place(Place),
}

impl Found {
    pub fn at(offset: usize, element: impl Into<String>, message: impl Into<String>) -> Self {
        Self { place: Where::Offset(offset, element.into()), message: message.into(), fix: Vec::new() }
    }

    pub fn placed(place: Place, message: impl Into<String>) -> Self {
        Self { place: Where::Place(place), message: message.into(), fix: Vec::new() }
    }

    /// With edits of the read text.
    pub fn fixed_by(mut self, edits: Vec<Edit>) -> Self {
        self.fix = edits;
        self
    }

    pub fn finding(self, rule: &Rule, level: Level, sheet: &Sheet) -> Finding {
        let place = match self.place {
            Where::Offset(at, element) => sheet.place(at, element),
            Where::Place(place) => place,
        };
        // For another format, the text that was read is not the user's text.
        let own = sheet.format() == Format::Urdf;
        let fix = self.fix.into_iter().filter(|_| own).map(|edit| sheet.in_original(edit)).collect();
        Finding { rule: rule.code, level, place, message: self.message, fix }
    }
}

/// The text with every certain fix applied, and their number; of overlapping edits, the first is applied.
///
/// `text` is the text that was checked.
pub fn fix(text: &str, findings: &[Finding]) -> (String, usize) {
    let mut edits: Vec<&Edit> = findings.iter().flat_map(|finding| &finding.fix).collect();
    edits.sort_by_key(|edit| (edit.start, edit.end));
    let (mut out, mut at, mut made) = (String::with_capacity(text.len()), 0, 0);
    for edit in edits {
        if edit.start < at || edit.end < edit.start {
            continue;
        }
        let (Some(before), Some(_)) = (text.get(at..edit.start), text.get(edit.start..edit.end)) else { continue };
        out.push_str(before);
        out.push_str(&edit.text);
        at = edit.end;
        made += 1;
    }
    out.push_str(&text[at..]);
    (out, made)
}
