//! Text from files inside messages and documents: cut to a readable length, kept on one line.

use std::borrow::Cow;

/// A value from a file is quoted with this many letters at most.
pub const QUOTED: usize = 120;

/// A line of a message has this many letters at most.
pub const LINE: usize = 1200;

/// The text, its middle left out where it has more than `most` letters.
///
/// # Examples
/// ```
/// use denavit_model::words::cut;
/// assert_eq!(cut("q2 - 90°", 20), "q2 - 90°");
/// assert_eq!(cut(&"(".repeat(40_000), 11), "(((((…(((((");
/// ```
pub fn cut(text: &str, most: usize) -> Cow<'_, str> {
    if text.len() <= most || text.chars().count() <= most {
        return Cow::Borrowed(text);
    }
    let end = (most.saturating_sub(1)) / 2;
    let start = most.saturating_sub(1) - end;
    let head: String = text.chars().take(start).collect();
    let tail: Vec<char> = text.chars().rev().take(end).collect();
    Cow::Owned(head + "…" + &tail.into_iter().rev().collect::<String>())
}

/// A value as a message quotes it.
pub fn quoted(text: &str) -> Cow<'_, str> {
    cut(text, QUOTED)
}

/// A message, each of its lines cut to a readable length.
pub fn readable(message: &str) -> Cow<'_, str> {
    if message.lines().all(|line| line.len() <= LINE) {
        return Cow::Borrowed(message);
    }
    Cow::Owned(message.lines().map(|line| cut(line, LINE)).collect::<Vec<_>>().join("\n"))
}

/// Whether a letter ends a line or controls a terminal on some system.
pub fn is_control(letter: char) -> bool {
    letter.is_control() || matches!(letter, '\u{2028}' | '\u{2029}')
}

/// The text without what ends a line: each such letter as its escape, `\n`, `\u{1b}`.
///
/// # Examples
/// ```
/// use denavit_model::words::one_line;
/// assert_eq!(one_line("elbow\nimport os"), "elbow\\nimport os");
/// assert_eq!(one_line("Gelenk-ä"), "Gelenk-ä");
/// ```
pub fn one_line(text: &str) -> Cow<'_, str> {
    if !text.contains(is_control) {
        return Cow::Borrowed(text);
    }
    let escape = |letter: char| -> String {
        if is_control(letter) { letter.escape_default().collect() } else { letter.to_string() }
    };
    Cow::Owned(text.chars().map(escape).collect())
}

/// First characters of what a spreadsheet reads as a formula.
const FORMULA: [char; 6] = ['=', '+', '-', '@', '\t', '\r'];

fn is_formula(text: &str) -> bool {
    text.trim_start_matches('\'').starts_with(FORMULA)
}

/// Text for a cell of a CSV file: what a spreadsheet would read as a formula gets a `'` in front. [`from_cell`] undoes it.
///
/// # Examples
/// ```
/// use denavit_model::words::{from_cell, to_cell};
/// assert_eq!(to_cell("=1+1"), "'=1+1");
/// for name in ["=1+1", "'=1", "-elbow", "@a", "elbow", "'quoted'"] {
///     assert_eq!(from_cell(&to_cell(name)), name);
/// }
/// ```
pub fn to_cell(text: &str) -> Cow<'_, str> {
    if is_formula(text) { Cow::Owned(format!("'{text}")) } else { Cow::Borrowed(text) }
}

/// The text of a cell that [`to_cell`] made.
pub fn from_cell(cell: &str) -> &str {
    cell.strip_prefix('\'').filter(|text| is_formula(text)).unwrap_or(cell)
}
