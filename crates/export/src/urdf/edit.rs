//! Edits of a source text by byte ranges: text without edits stays byte for byte.

use super::ExportError;
use denavit_model::robot::SourceText;
use roxmltree::Node;
use std::ops::Range;

/// Replacements and insertions, applied all at once.
#[derive(Debug, Default)]
pub struct Edits {
    pieces: Vec<(Range<usize>, String)>,
}

impl Edits {
    /// Replaces the bytes `range` by `text`; an empty range inserts.
    pub fn replace(&mut self, range: Range<usize>, text: impl Into<String>) {
        self.pieces.push((range, text.into()));
    }

    /// Sets an attribute: in place, or as a new attribute after the others.
    pub fn attribute(&mut self, source: &SourceText, node: Node, name: &str, value: &str) {
        if let Some(attribute) = node.attribute_node(name) {
            self.replace(attribute.range_value(), escaped(value));
            return;
        }
        let at = node
            .attributes()
            .map(|attribute| attribute.range().end)
            .max()
            .unwrap_or_else(|| name_end(&source.text, node.range().start));
        self.replace(at..at, format!(" {name}=\"{}\"", escaped(value)));
    }

    /// Inserts an element before the other children, with the white space of the first of them.
    pub fn first_child(&mut self, source: &SourceText, node: Node, element: &str) {
        let text = &source.text;
        let Some(open) = open_tag_end(text, node.range().start) else { return };
        if text[..open].ends_with("/>") {
            let tag = written_tag(source, node);
            self.replace(open - 2..open, format!(">{element}</{tag}>"));
            return;
        }
        let space = &text[open..open + text[open..].len() - text[open..].trim_start().len()];
        self.replace(open..open, format!("{}{element}", last_line_break(space)));
    }

    /// Inserts an element after the `<origin>` child, or before the other children if there is none.
    pub fn behind_origin(&mut self, source: &SourceText, node: Node, element: &str) {
        match node.children().find(|child| child.is_element() && child.tag_name().name() == "origin") {
            Some(origin) => self.lines_behind(source, origin, &[element.to_owned()]),
            None => self.first_child(source, node, element),
        }
    }

    /// Inserts lines after an element, each with the element's indentation.
    pub fn lines_behind(&mut self, source: &SourceText, node: Node, lines: &[String]) {
        let (start, end) = (node.range().start, node.range().end);
        let before = &source.text[..start];
        let space = last_line_break(&before[before.trim_end().len()..]);
        self.replace(end..end, lines.iter().flat_map(|line| [space, line]).collect::<String>());
    }

    /// Inserts lines before the end of an element with children, each indented like the last of them.
    pub fn lines_at_end(&mut self, source: &SourceText, node: Node, lines: &[String]) {
        match node.last_element_child() {
            Some(last) => self.lines_behind(source, last, lines),
            None => self.first_child(source, node, &lines.concat()),
        }
    }

    /// Removes an element, with the white space from the last line break before it: the inverse of [`Edits::lines_behind`].
    pub fn remove(&mut self, source: &SourceText, node: Node) {
        let range = with_line_break(&source.text, node);
        self.replace(range, "");
    }

    /// Whether there are no edits.
    pub fn is_empty(&self) -> bool {
        self.pieces.is_empty()
    }

    /// The original text of `source` with the edits; unchanged if there are none.
    ///
    /// # Errors
    /// Two edits change the same bytes: an XML entity that is used in two places.
    pub fn apply(mut self, source: &SourceText) -> Result<String, ExportError> {
        self.pieces.push((source.declared.clone(), String::new()));
        // Stable: insertions at one place keep their order.
        self.pieces.sort_by_key(|(range, _)| (range.start, range.end));
        let mut result = source.dropped_before.clone();
        let mut at = 0;
        for (range, piece) in &self.pieces {
            let before = source.text.get(at..range.start).ok_or_else(|| ExportError::Unfaithful {
                file: source.file.clone(),
                what: format!("one piece of text in line {} defines two elements", source.line(range.start)),
            })?;
            result.push_str(before);
            result.push_str(piece);
            at = range.end;
        }
        result.push_str(&source.text[at..]);
        Ok(result)
    }
}

/// White space from its last line break on: the indentation of an element on its own line.
fn last_line_break(space: &str) -> &str {
    match space.rfind('\n') {
        Some(at) if space[..at].ends_with('\r') => &space[at - 1..],
        Some(at) => &space[at..],
        None => space,
    }
}

/// The bytes of an element and of the white space from the last line break before it.
pub fn with_line_break(text: &str, node: Node) -> Range<usize> {
    let before = &text[..node.range().start];
    let space = last_line_break(&before[before.trim_end().len()..]);
    node.range().start - space.len()..node.range().end
}

fn name_start(node: Node) -> usize {
    node.range().start + 1
}

/// A tag as written, with its prefix.
pub fn written_tag<'a>(source: &'a SourceText, node: Node) -> &'a str {
    &source.text[name_start(node)..name_end(&source.text, node.range().start)]
}

/// Byte offset after the name of the tag that opens at `start`.
fn name_end(text: &str, start: usize) -> usize {
    let name = &text[start + 1..];
    start + 1 + name.find(|c: char| c.is_whitespace() || c == '>' || c == '/').unwrap_or(name.len())
}

/// Byte offset after the `>` of the tag that opens at `start`.
pub(crate) fn open_tag_end(text: &str, start: usize) -> Option<usize> {
    let mut quote = None;
    for (at, c) in text[start..].char_indices() {
        match (quote, c) {
            (None, '"' | '\'') => quote = Some(c),
            (Some(open), _) if open == c => quote = None,
            (None, '>') => return Some(start + at + 1),
            _ => {}
        }
    }
    None
}

/// A name or value escaped for double quotes.
pub fn escaped(value: &str) -> String {
    value.replace('&', "&amp;").replace('<', "&lt;").replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;
    use roxmltree::Document;

    fn check(text: &str, expected: &str, edit: impl Fn(&mut Edits, &SourceText, Node)) {
        let mut source = SourceText::new("f", text);
        (source.dropped_before, source.declared) = ("\u{feff}".into(), 2..2);
        let document = Document::parse(text).unwrap();
        let mut edits = Edits::default();
        edit(&mut edits, &source, document.root_element());
        assert_eq!(edits.apply(&source).unwrap(), format!("\u{feff}{expected}"));
    }

    #[test]
    fn attributes_are_replaced_or_added() {
        check("<a x = '1' y=\"2\"  />", "<a x = '3' y=\"2\"  />", |e, s, n| e.attribute(s, n, "x", "3"));
        check("<a x='1'  />", "<a x='1' z=\"3\"  />", |e, s, n| e.attribute(s, n, "z", "3"));
        check("<a/>", "<a z=\"3\"/>", |e, s, n| e.attribute(s, n, "z", "3"));
        check("<a>t</a>", "<a z=\"3\">t</a>", |e, s, n| e.attribute(s, n, "z", "3"));
    }

    #[test]
    fn children_are_put_in_on_lines_of_their_own() {
        check("<a k='>'>\r\n\r\n  <b/>\n</a>", "<a k='>'>\r\n  <o/>\r\n\r\n  <b/>\n</a>", |e, s, n| {
            e.first_child(s, n, "<o/>");
        });
        check("<a><b/></a>", "<a><o/><b/></a>", |e, s, n| e.first_child(s, n, "<o/>"));
        check("<a k=''/>", "<a k=''><o/></a>", |e, s, n| e.first_child(s, n, "<o/>"));
        check("<a>\n  <b/>\n</a>", "<a>\n  <b/>\n  <l/>\n  <j/>\n</a>", |e, s, n| {
            e.lines_behind(s, n.first_element_child().unwrap(), &["<l/>".into(), "<j/>".into()]);
        });
    }

    #[test]
    fn what_was_declared_for_the_parser_is_taken_out() {
        let mut source = SourceText::new("f", "<robot xmlns:x='u'/>");
        (source.dropped_before, source.declared) = (" ".into(), 6..18);
        assert_eq!(Edits::default().apply(&source).unwrap(), " <robot/>");
    }
}
