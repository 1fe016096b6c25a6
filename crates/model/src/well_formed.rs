//! Converts text to a form that an XML parser accepts and from which the original can be restored.

use crate::formats::{Translation, behind_instruction};
use crate::notes::{Note, Place};
use crate::robot::SourceText;

/// Splits off what is not allowed before the XML declaration, and declares unbound namespace prefixes.
///
/// Where the text comes from is read from it, or given as `translation`.
pub(crate) fn prepare(file: &str, original: &str, translation: Option<Translation>) -> (SourceText, Vec<Note>) {
    let mut notes = Vec::new();
    let mut corrected = |line, what: String| {
        notes.push(Note::Corrected { place: Place { file: file.to_owned(), line, element: "file".into() }, what });
    };
    let mut start = 0;
    if original.starts_with('\u{feff}') {
        start = '\u{feff}'.len_utf8();
    }
    let rest = &original[start..];
    let blank = rest.len() - rest.trim_start().len();
    if blank > 0 && rest[blank..].starts_with("<?xml") {
        start += blank;
        corrected(1, "white space before the XML declaration is skipped".into());
    }
    let (dropped_before, text) = original.split_at(start);
    let mut source = match translation {
        Some(translation) => SourceText::translated(file, text.to_owned(), translation),
        None => SourceText::new(file, text),
    };
    dropped_before.clone_into(&mut source.dropped_before);
    let unbound = unbound_prefixes(&text[behind_instruction(text)..]);
    if !unbound.is_empty()
        && let Some(at) = root_name_end(text)
    {
        let declarations: Vec<String> =
            unbound.iter().map(|prefix| format!(" xmlns:{prefix}=\"urn:unbound:{prefix}\"")).collect();
        let declaration = declarations.concat();
        corrected(
            source.line(at),
            format!("namespace prefix {} is not declared; read as part of the name", unbound.join(", ")),
        );
        source.insert(at, &declaration);
        source.declared = at..at + declaration.len();
    }
    (source, notes)
}

/// Byte offset just behind `<robot`, if the text has one.
fn root_name_end(text: &str) -> Option<usize> {
    let at = text.find("<robot")? + "<robot".len();
    text[at..].starts_with(|c: char| c.is_whitespace() || c == '>' || c == '/').then_some(at)
}

/// Prefixes of tags and attributes that no `xmlns:` in the text declares, in order of first use.
pub fn unbound_prefixes(text: &str) -> Vec<&str> {
    let mut unbound: Vec<&str> = Vec::new();
    let mut declared: Vec<&str> = vec!["xml", "xmlns"];
    let names = |piece: &'_ str| {
        piece.len() - piece.trim_start_matches(|c: char| c.is_alphanumeric() || "_-.".contains(c)).len()
    };
    for (at, _) in text.match_indices(':').filter(|(at, _)| text[..*at].ends_with("xmlns")) {
        let name = &text[at + 1..];
        declared.push(&name[..names(name)]);
    }
    let mut markup = Markup::default();
    for (at, _) in text.match_indices(':') {
        let before = &text[..at];
        let length = before.len() - before.trim_end_matches(|c: char| c.is_alphanumeric() || "_-.".contains(c)).len();
        let prefix = &before[at - length..];
        let opens = before[..at - length].ends_with(['<', '/', ' ', '\t', '\n', '\r']);
        if length == 0 || !opens || declared.contains(&prefix) || unbound.contains(&prefix) || !markup.in_tag(text, at)
        {
            continue;
        }
        unbound.push(prefix);
    }
    unbound
}

/// Where a place in the text stands, followed from its start so that large files are read once.
#[derive(Default)]
struct Markup {
    scanned: usize,
    tag: Option<usize>,
    /// Since the last `<`: a `>`, and unclosed quotes of either kind.
    closed: bool,
    quoted: [bool; 2],
    comment_opened: Option<usize>,
    comment_closed: Option<usize>,
}

impl Markup {
    /// Whether `at`, not before the last one asked for, stands inside a tag and outside its attribute values.
    fn in_tag(&mut self, text: &str, at: usize) -> bool {
        let bytes = text.as_bytes();
        for place in self.scanned..at {
            match bytes[place] {
                b'<' => {
                    (self.tag, self.closed, self.quoted) = (Some(place), false, [false; 2]);
                    if bytes[place..at].starts_with(b"<!--") {
                        self.comment_opened = Some(place);
                    }
                }
                b'>' => {
                    self.closed = true;
                    if bytes[..=place].ends_with(b"-->") {
                        self.comment_closed = Some(place - 2);
                    }
                }
                b'"' => self.quoted[0] = !self.quoted[0],
                b'\'' => self.quoted[1] = !self.quoted[1],
                _ => {}
            }
        }
        self.scanned = at;
        let markup = self.tag.is_some_and(|tag| !bytes[tag..].starts_with(b"<!") && !bytes[tag..].starts_with(b"<?"));
        markup && !self.closed && self.quoted == [false; 2] && self.comment_opened <= self.comment_closed
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_original_can_be_had_back() {
        for original in [
            "<robot name='a'/>",
            "\u{feff}<robot/>",
            "\n  <?xml version='1.0'?>\n<robot/>",
            "<robot><xacro:include a:b='c:d'/></robot>",
            "<robot xmlns:gazebo='u'><gazebo:x/><!-- e:f g -->w:h</robot>",
        ] {
            let (source, _) = prepare("f", original, None);
            let mut text = source.text.clone();
            text.replace_range(source.declared.clone(), "");
            assert_eq!(source.dropped_before.clone() + &text, original);
        }
    }

    #[test]
    fn only_unbound_prefixes_are_declared() {
        let unbound = |text| unbound_prefixes(text).join(" ");
        assert_eq!(unbound("<robot xmlns:gazebo='u'><gazebo:x/><!-- e:f g -->w:h</robot>"), "");
        assert_eq!(unbound("<robot><xacro:include a:b='c:d' e=' g:h'/></xacro:include></robot>"), "xacro a");
        assert_eq!(unbound("<robot><!-- <a b='c> d:e --><!-- '> -- f:g --> h:i <j k:l='\"'/></robot>"), "k");
    }
}
