//! Descriptions in formats other than URDF: what their readers and writers share.
//!
//! A reader of another format (MJCF, SDF) translates it to URDF text, with a source line for each line of that text, and a list
//! of what URDF cannot state. Both are stored in the text, in one processing instruction after the XML declaration, like a C
//! compiler's `#line`: messages about the URDF then name places in the source, and what was kept is in the robot's
//! [inventory](crate::Robot::inventory).
//!
//! ```text
//! MJCF, SDF ──► Builder: URDF text + places + kept ──► urdf::read ──► Robot     Robot ──► Written: text + losses + sidecar
//! ```

use crate::notes::{Note, Place};
use crate::problems::UrdfError;
use crate::robot::{Robot, SourceText};
use crate::urdf::{self, Loose};
use std::collections::HashMap;
use std::fmt::{self, Write as _};
use thiserror::Error;

/// A format for whole trees of links and joints.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Format {
    /// `<robot>`.
    Urdf,
    /// `<mujoco>`: MuJoCo's models.
    Mjcf,
    /// `<sdf>`: Gazebo's and Drake's models.
    Sdf,
}

impl Format {
    /// Every format.
    pub const ALL: [Self; 3] = [Self::Urdf, Self::Mjcf, Self::Sdf];

    /// The name that people use.
    pub fn name(self) -> &'static str {
        match self {
            Self::Urdf => "URDF",
            Self::Mjcf => "MJCF",
            Self::Sdf => "SDF",
        }
    }

    /// The word on a command line.
    pub fn word(self) -> &'static str {
        match self {
            Self::Urdf => "urdf",
            Self::Mjcf => "mjcf",
            Self::Sdf => "sdf",
        }
    }

    /// The format of a file name's ending where that says it: `.xml` is MJCF's.
    pub fn of_file_name(name: &str) -> Option<Self> {
        match name.rsplit_once('.')?.1.to_ascii_lowercase().as_str() {
            "urdf" => Some(Self::Urdf),
            "xml" | "mjcf" => Some(Self::Mjcf),
            "sdf" | "world" => Some(Self::Sdf),
            _ => None,
        }
    }

    /// The format by the root element of a text; `None` where that is another or there is none.
    ///
    /// # Examples
    /// ```
    /// use denavit_model::formats::Format;
    /// assert_eq!(Format::of_text("<?xml version='1.0'?><!-- <sdf> --> <mujoco model='arm'/>"), Some(Format::Mjcf));
    /// assert_eq!(Format::of_text("joint,d,a"), None);
    /// ```
    pub fn of_text(text: &str) -> Option<Self> {
        match root_element(text)? {
            "robot" => Some(Self::Urdf),
            "mujoco" | "mujocoinclude" => Some(Self::Mjcf),
            "sdf" | "gazebo" => Some(Self::Sdf),
            _ => None,
        }
    }
}

/// The name of a text's first element, comments, declarations and instructions before it skipped.
pub fn root_element(text: &str) -> Option<&str> {
    let mut rest = text.trim_start_matches('\u{feff}').trim_start();
    loop {
        let behind = if rest.starts_with("<?") {
            rest.split_once("?>")?.1
        } else if rest.starts_with("<!--") {
            rest.split_once("-->")?.1
        } else if rest.starts_with("<!") {
            rest.split_once('>')?.1
        } else {
            break;
        };
        rest = behind.trim_start();
    }
    let name = rest.strip_prefix('<')?;
    let end = name.find(|c: char| c.is_whitespace() || c == '>' || c == '/')?;
    (end > 0).then(|| &name[..end])
}

/// Something that one format says and another cannot.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Loss {
    /// Its place in the source.
    pub place: Place,
    /// What it is, such as `<tendon> "split"`.
    pub what: String,
    /// Why the other format cannot state it and what follows, a clause.
    pub why: String,
}

impl fmt::Display for Loss {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}: {}", self.place, self.what, self.why)
    }
}

/// Part of a source that URDF cannot state.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Kept {
    /// What, where and why.
    pub loss: Loss,
    /// The element, with every default written out; empty where it is an attribute of an element that was translated.
    pub text: String,
    /// Whether the reader knows what it means; otherwise a note says that it does not.
    pub understood: bool,
}

/// Where a translated text comes from.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Translation {
    /// The format of the source.
    pub format: Format,
    /// The source, and what it includes.
    pub files: Vec<String>,
    /// For each line of the text behind the instruction: which file, which line (from 1).
    pub lines: Vec<(usize, usize)>,
    /// What URDF cannot state, in the order of the source.
    pub kept: Vec<Kept>,
    /// What was read differently from what is written, or needs a note: place and sentence.
    pub notes: Vec<(Place, String)>,
    /// Notes that are findings of a rule of `check`: its name, place and sentence.
    pub findings: Vec<(String, Place, String)>,
    /// How many elements and attributes were understood.
    pub understood: usize,
    /// How many lines of the text stand up to the end of the instruction.
    header: usize,
}

/// Approximate bytes of a record, without kept elements.
const RECORD: usize = 150;
const OPENS: &str = "<?denavit-source ";
const XML: &str = "<?xml version=\"1.0\"?>\n";

impl Translation {
    /// For a source, still empty.
    pub fn new(format: Format, file: impl Into<String>) -> Self {
        Self {
            format,
            files: vec![file.into()],
            lines: Vec::new(),
            kept: Vec::new(),
            notes: Vec::new(),
            findings: Vec::new(),
            understood: 0,
            header: 0,
        }
    }

    /// The place of the source for a line (from 1) of the text.
    pub fn origin(&self, line: usize) -> (&str, usize) {
        let place = line.checked_sub(self.header + 1).and_then(|line| self.lines.get(line));
        let &(file, line) = place.unwrap_or(&(0, 1));
        (self.files.get(file).map_or("", String::as_str), line)
    }

    /// The translation that a text carries; `None` where it carries none that is whole.
    pub fn of_text(text: &str) -> Option<Self> {
        let (_, before, inside) = instruction(text)?;
        let mut records = inside.lines();
        let word = records.next()?;
        let format = Format::ALL.into_iter().find(|format| format.word() == word)?;
        let mut result = Self::new(format, "");
        result.files.clear();
        let mut reasons: Vec<String> = Vec::new();
        for record in records {
            let (kind, rest) = record.split_once('\t').unwrap_or((record, ""));
            let place = |file, line: &str, element| {
                Some(Place { file: plain(file), line: line.parse().ok()?, element: plain(element) })
            };
            match kind {
                "file" => result.files.push(plain(rest)),
                "why" => reasons.push(plain(rest)),
                "understood" => result.understood = rest.parse().ok()?,
                "lines" => {
                    // Many short words: byte by byte.
                    for pair in rest.as_bytes().split(|byte| *byte == b'\t').filter(|pair| !pair.is_empty()) {
                        let colon = pair.iter().position(|byte| *byte == b':')?;
                        result.lines.push((whole(&pair[..colon])?, whole(&pair[colon + 1..])?));
                    }
                }
                "note" => {
                    let [file, line, element, what] = fields(rest)?;
                    result.notes.push((place(file, line, element)?, plain(what)));
                }
                "finding" => {
                    let [rule, file, line, element, what] = fields(rest)?;
                    result.findings.push((plain(rule), place(file, line, element)?, plain(what)));
                }
                "kept" | "unknown" => {
                    let [file, line, element, what, why, text] = fields(rest)?;
                    let why = reasons.get(why.parse::<usize>().ok()?)?.clone();
                    let loss = Loss { place: place(file, line, element)?, what: plain(what), why };
                    result.kept.push(Kept { loss, text: plain(text), understood: kind == "kept" });
                }
                _ => return None,
            }
        }
        let ends = before + inside.len();
        result.header = text[..ends].matches('\n').count() + 1;
        Some(result)
    }

    /// The notes of the reading, then one note for each kind of thing that is not understood.
    pub(crate) fn reader_notes(&self) -> Vec<Note> {
        let found = self.findings.iter().map(|(_, place, what)| (place, what));
        let own = self.notes.iter().map(|(place, what)| (place, what)).chain(found);
        let own = own.map(|(place, what)| Note::Corrected { place: place.clone(), what: what.clone() });
        let mut notes: Vec<Note> = own.collect();
        let unknown: Vec<&Kept> = self.kept.iter().filter(|kept| !kept.understood).collect();
        let kind = |kept: &Kept| kept.loss.what.split('=').next().unwrap_or_default().to_owned();
        let mut seen: Vec<String> = Vec::new();
        for kept in &unknown {
            let own = kind(kept);
            if seen.contains(&own) {
                continue;
            }
            let count = unknown.iter().filter(|other| kind(other) == own).count();
            let others = if count > 1 { format!(" ({count} times)") } else { String::new() };
            let what = format!("{}{others} {}", kept.loss.what, kept.loss.why);
            notes.push(Note::NotUnderstood { place: kept.loss.place.clone(), what });
            seen.push(own);
        }
        notes
    }

    fn instruction(&self) -> String {
        let kept: usize = self.kept.iter().map(|kept| RECORD + kept.text.len()).sum();
        let mut out = String::with_capacity(RECORD + kept + self.lines.len() * "\t0:1000".len());
        out.extend([OPENS, self.format.word(), "\n"]);
        let mut record = |fields: &[&str]| {
            for (index, field) in fields.iter().enumerate() {
                if index > 0 {
                    out.push('\t');
                }
                quote(&mut out, field);
            }
            out.push('\n');
        };
        for file in &self.files {
            record(&["file", file]);
        }
        record(&["understood", &self.understood.to_string()]);
        for (place, what) in &self.notes {
            record(&["note", &place.file, &place.line.to_string(), &place.element, what]);
        }
        for (rule, place, what) in &self.findings {
            record(&["finding", rule, &place.file, &place.line.to_string(), &place.element, what]);
        }
        // Many things are kept for the same reason.
        let mut reasons: HashMap<&str, String> = HashMap::new();
        for Kept { loss: Loss { place, what, why }, text, understood } in &self.kept {
            let kind = if *understood { "kept" } else { "unknown" };
            let next = reasons.len();
            let why = reasons.entry(why).or_insert_with(|| {
                record(&["why", why]);
                next.to_string()
            });
            record(&[kind, &place.file, &place.line.to_string(), &place.element, what, why, text]);
        }
        out.push_str("lines");
        for (file, line) in &self.lines {
            let _ = write!(out, "\t{file}:{line}");
        }
        out.push_str("\n?>\n");
        out
    }
}

/// Where the instruction is in a text, where its content starts, and its content.
fn instruction(text: &str) -> Option<(std::ops::Range<usize>, usize, &str)> {
    let first = if text.starts_with("<?xml") { text.find("?>")? + "?>".len() } else { 0 };
    let start = first + (text[first..].len() - text[first..].trim_start().len());
    let inside = text[start..].strip_prefix(OPENS)?;
    // No other `>` stands inside: see `quote`.
    let end = inside.find('>')?.checked_sub(1).filter(|end| inside[*end..].starts_with('?'))?;
    let before = start + OPENS.len();
    let ends = before + end + "?>".len();
    let ends = ends + usize::from(text[ends..].starts_with('\n'));
    Some((start..ends, before, &inside[..end]))
}

/// Where the description itself begins in a text: after the places of its source.
pub(crate) fn behind_instruction(text: &str) -> usize {
    instruction(text).map_or(0, |(range, ..)| range.end)
}

/// A translated text as a self-contained URDF, without the places of its source.
pub fn as_urdf(text: &str) -> String {
    match instruction(text) {
        Some((range, ..)) => format!("{}{}", &text[..range.start], &text[range.end..]),
        None => text.to_owned(),
    }
}

/// Adds text inside the instruction: no end of it, no field's or record's end, no tag.
fn quote(out: &mut String, text: &str) {
    let mut rest = text;
    while let Some(at) = rest.bytes().position(|byte| b"\\\n\r\t<>".contains(&byte)) {
        out.push_str(&rest[..at]);
        out.push_str(match rest.as_bytes()[at] {
            b'\\' => "\\\\",
            b'\n' => "\\n",
            b'\r' => "\\r",
            b'\t' => "\\t",
            b'<' => "\\l",
            _ => "\\g",
        });
        rest = &rest[at + 1..];
    }
    out.push_str(rest);
}

/// A whole number in decimal digits, some of them.
fn whole(digits: &[u8]) -> Option<usize> {
    let digit = |number: usize, byte: &u8| {
        let digit = byte.is_ascii_digit().then(|| usize::from(byte - b'0'))?;
        number.checked_mul(10)?.checked_add(digit)
    };
    (!digits.is_empty()).then_some(digits)?.iter().try_fold(0, digit)
}

/// Where a byte of ASCII first is; texts here are short.
fn find(text: &str, byte: u8) -> Option<usize> {
    text.bytes().position(|other| other == byte)
}

fn plain(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(at) = find(rest, b'\\') {
        out.push_str(&rest[..at]);
        let mut chars = rest[at + 1..].chars();
        match chars.next() {
            Some('n') => out.push('\n'),
            Some('r') => out.push('\r'),
            Some('t') => out.push('\t'),
            Some('l') => out.push('<'),
            Some('g') => out.push('>'),
            Some(other) => out.push(other),
            None => {}
        }
        rest = chars.as_str();
    }
    out.push_str(rest);
    out
}

/// The fields of a record; `None` where they are more or less.
fn fields<const N: usize>(record: &str) -> Option<[&str; N]> {
    let mut found = [""; N];
    let mut rest = Some(record);
    for field in &mut found {
        let own = rest?;
        let end = find(own, b'\t');
        *field = &own[..end.unwrap_or(own.len())];
        rest = end.map(|end| &own[end + 1..]);
    }
    rest.is_none().then_some(found)
}

/// Builds the URDF text of a description in another format, line by line.
///
/// # Examples
/// ```
/// use denavit_model::formats::{Builder, Format};
/// let mut builder = Builder::new(Format::Mjcf, "arm.xml");
/// builder.line((0, 1), "<robot name=\"arm\">");
/// builder.line((0, 7), "  <link name=\"base\"/>");
/// builder.line((0, 9), "</robot>");
/// let robot = denavit_model::urdf::read("arm.xml", &builder.text())?;
/// assert_eq!(robot.source.place(robot.links[0].at, "base").to_string(), "arm.xml:7: base");
/// # Ok::<(), denavit_model::UrdfError>(())
/// ```
#[derive(Debug)]
pub struct Builder {
    /// Files, places, what is kept and noted.
    pub translation: Translation,
    /// The tree of the lines as values, where the reader built it too, so that the text need not be parsed. Its offsets
    /// are those of [`Builder::offset`].
    pub tree: Option<Loose>,
    body: String,
}

impl Builder {
    /// For a source, as yet without text.
    pub fn new(format: Format, file: impl Into<String>) -> Self {
        Self { translation: Translation::new(format, file), tree: None, body: String::new() }
    }

    /// Adds a line of URDF, which comes from this file (an index into the translation's files) and line of the source. Line
    /// breaks in the text, which only stand between attributes or in them, become spaces.
    pub fn line(&mut self, origin: (usize, usize), text: &str) {
        self.line_by(origin, |body| body.push_str(text));
    }

    /// As [`Builder::line`], with a text that is added to what is there.
    pub fn line_by(&mut self, origin: (usize, usize), put: impl FnOnce(&mut String)) {
        self.translation.lines.push(origin);
        let first = self.body.len();
        put(&mut self.body);
        let text = &self.body[first..];
        if text.contains('\n') || text.contains('\r') {
            let flat = self.body.split_off(first).replace(['\n', '\r'], " ");
            self.body.push_str(&flat);
        }
        self.body.push('\n');
    }

    /// Where the next line will begin.
    pub fn offset(&self) -> usize {
        self.body.len()
    }

    /// The URDF text, with its places inside.
    pub fn text(&self) -> String {
        [XML, &self.translation.instruction(), &self.body].concat()
    }

    /// The robot: what [`urdf::read`] gives for the [text](Builder::text), with less to read.
    ///
    /// # Errors
    /// Those of [`urdf::read`].
    pub fn robot(mut self, file: &str) -> Result<Robot, UrdfError> {
        let text = self.text();
        let before = text.len() - self.body.len();
        self.translation.header = text[..before].matches('\n').count();
        let source = SourceText::translated(file, text, self.translation);
        match self.tree {
            Some(tree) => urdf::of_values(source, before, tree).or_else(urdf::read_translated),
            None => urdf::read_translated(source),
        }
    }
}

/// A robot as text in some format, and what that format cannot state.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Written {
    /// The description.
    pub text: String,
    /// What the format cannot state, with its place in the source.
    pub losses: Vec<Loss>,
    /// JSON that restores the losses when converting back; `None` where nothing is lost.
    pub sidecar: Option<String>,
    /// The checks made on the text, one line each, with the largest differences.
    pub proof: Vec<String>,
}

/// Why a description is not a valid robot, or a robot cannot be written: each with its place and the fix.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub struct FormatError {
    /// At least one: place and a sentence that says what to do.
    pub problems: Vec<(Place, String)>,
}

impl FormatError {
    /// One problem.
    pub fn one(place: Place, what: impl Into<String>) -> Self {
        Self { problems: vec![(place, what.into())] }
    }
}

impl fmt::Display for FormatError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, (place, what)) in self.problems.iter().enumerate() {
            if index > 0 {
                writeln!(f)?;
            }
            write!(f, "{place}: {what}")?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn builder() -> Builder {
        let mut builder = Builder::new(Format::Sdf, "a \\ file.sdf");
        builder.translation.files.push("part?>.sdf".into());
        builder.translation.understood = 12;
        let place = Place { file: "part?>.sdf".into(), line: 3, element: "plugin \"p\"".into() };
        builder.translation.notes.push((place.clone(), "a\ttab".into()));
        builder.translation.findings.push(("rule".into(), place.clone(), "found".into()));
        builder.translation.kept.push(Kept {
            loss: Loss { place, what: "<plugin>".into(), why: "no word".into() },
            text: "<plugin\n a:b=\"?>\"/>".into(),
            understood: false,
        });
        builder.line((0, 4), "<robot name=\"r\">");
        builder.line((1, 8), "<link\nname=\"a\"/>");
        builder.line((0, 5), "</robot>");
        builder
    }

    #[test]
    fn a_translation_travels_in_its_text() {
        let builder = builder();
        let text = builder.text();
        let read = Translation::of_text(&text).unwrap();
        assert_eq!(Translation { header: 0, ..read.clone() }, builder.translation);
        let robot = crate::urdf::read("shown", &text).unwrap();
        let again = builder.robot("shown").unwrap();
        assert_eq!((&again.links, &again.notes), (&robot.links, &robot.notes));
        assert_eq!((again.source.text, again.source.translation), (text, Some(Box::new(read))));
        assert_eq!(robot.source.place(robot.links[0].at, "x").to_string(), "part?>.sdf:8: x");
        let inventory = robot.inventory();
        assert_eq!(inventory.reported().map(|item| item.what.as_str()).collect::<Vec<_>>(), ["<plugin>"]);
        assert_eq!(robot.notes.len(), 3, "{:?}", robot.notes);
    }

    #[test]
    fn a_urdf_of_its_own_has_no_places_of_another() {
        let text = as_urdf(&builder().text());
        assert!(Translation::of_text(&text).is_none() && text.starts_with(XML) && text.ends_with("</robot>\n"));
        assert_eq!(as_urdf("<robot/>"), "<robot/>");
    }

    #[test]
    fn what_is_no_translation_is_none() {
        for text in ["", "<?xml", "<?denavit-source mjcf", "<?denavit-source mjcf\nlines\tx\n?><robot/>", "<robot/>"] {
            assert_eq!(Translation::of_text(text), None, "{text}");
        }
    }
}
