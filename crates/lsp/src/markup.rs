//! XML while it is being typed: every element and attribute with its byte range, complete or broken.

use std::ops::Range;

/// An attribute.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Attribute {
    pub name: Range<usize>,
    /// Quotes not included.
    pub value: Range<usize>,
}

/// An element.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Tag {
    /// With its prefix.
    pub name: Range<usize>,
    /// From `<` to after `>`.
    pub start: Range<usize>,
    pub attributes: Vec<Attribute>,
    /// Index of the element around it.
    pub parent: Option<usize>,
    /// The end tag, if any.
    pub close: Option<Range<usize>>,
    pub has_children: bool,
}

/// Where in the markup a byte is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Spot {
    /// In an element's name, in its start or end tag.
    Name(usize),
    /// In an attribute's name.
    AttributeName(usize, usize),
    /// In an attribute's value.
    Value(usize, usize),
    /// Between the attributes of a start tag.
    Inside(usize),
    /// In the text of an element.
    Text(usize),
    /// In a comment, or outside of everything.
    Elsewhere,
}

/// A text's elements in their order, and its comments.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(crate) struct Markup {
    pub tags: Vec<Tag>,
    /// Comments, instructions and character data.
    pub others: Vec<Range<usize>>,
}

fn is_space(byte: u8) -> bool {
    matches!(byte, b' ' | b'\t' | b'\n' | b'\r')
}

/// Reads a text, even a broken one.
pub(crate) fn scan(text: &str) -> Markup {
    let mut markup = Markup::default();
    let mut open: Vec<usize> = Vec::new();
    let mut at = 0;
    while let Some(found) = text[at..].find('<') {
        let start = at + found;
        let rest = &text[start..];
        let skipped = [("<!--", "-->"), ("<![CDATA[", "]]>"), ("<?", "?>"), ("<!", ">")];
        if let Some((opens, closes)) = skipped.into_iter().find(|(opens, _)| rest.starts_with(opens)) {
            let end =
                rest[opens.len()..].find(closes).map_or(text.len(), |end| start + opens.len() + end + closes.len());
            markup.others.push(start..end);
            at = end;
        } else if rest.starts_with("</") {
            let end = rest.find('>').map_or(text.len(), |end| start + end + 1);
            let name = text[start + 2..end].trim_end_matches('>').trim();
            if let Some(depth) = open.iter().rposition(|tag| &text[markup.tags[*tag].name.clone()] == name) {
                markup.tags[open[depth]].close = Some(start..end);
                open.truncate(depth);
            }
            at = end;
        } else {
            let (mut tag, is_open) = start_tag(text, start);
            at = tag.start.end;
            tag.parent = open.last().copied();
            if let Some(parent) = tag.parent {
                markup.tags[parent].has_children = true;
            }
            if is_open {
                open.push(markup.tags.len());
            }
            markup.tags.push(tag);
        }
    }
    markup
}

/// The start tag at `start`, and whether something may be in it.
fn start_tag(text: &str, start: usize) -> (Tag, bool) {
    let bytes = text.as_bytes();
    let word = |from: usize| {
        let ends = |byte: &u8| is_space(*byte) || b"<>/=\"'".contains(byte);
        bytes[from..].iter().position(ends).map_or(text.len(), |length| from + length)
    };
    let spaces =
        |from: usize| bytes[from..].iter().position(|byte| !is_space(*byte)).map_or(text.len(), |length| from + length);
    let name = start + 1..word(start + 1);
    let mut at = name.end;
    let mut attributes = Vec::new();
    let tag = |end: usize, attributes| Tag {
        name: name.clone(),
        start: start..end,
        attributes,
        parent: None,
        close: None,
        has_children: false,
    };
    loop {
        at = spaces(at);
        match bytes.get(at) {
            // Nothing is in an element whose start tag is still being typed.
            None | Some(b'<') => return (tag(at, attributes), false),
            Some(b'>') => return (tag(at + 1, attributes), true),
            Some(b'/') if bytes.get(at + 1) == Some(&b'>') => return (tag(at + 2, attributes), false),
            Some(b'/' | b'=' | b'"' | b'\'') => at += 1,
            Some(_) => {
                let own = at..word(at);
                at = spaces(own.end);
                if bytes.get(at) != Some(&b'=') {
                    attributes.push(Attribute { value: own.end..own.end, name: own });
                    continue;
                }
                at = spaces(at + 1);
                let quote = bytes.get(at).copied().filter(|byte| b"\"'".contains(byte));
                let Some(quote) = quote else {
                    attributes.push(Attribute { value: at..at, name: own });
                    continue;
                };
                let value = at + 1;
                // An unclosed value ends before the next element.
                let end = bytes[value..].iter().position(|byte| *byte == quote || *byte == b'<');
                let end = end.map_or(text.len(), |length| value + length);
                attributes.push(Attribute { name: own, value: value..end });
                at = if bytes.get(end) == Some(&quote) { end + 1 } else { end };
            }
        }
    }
}

impl Tag {
    /// Where the element ends.
    pub fn end(&self) -> usize {
        self.close.as_ref().map_or(self.start.end, |close| close.end)
    }

    /// The text of an element without elements in it.
    pub fn inside(&self) -> Option<Range<usize>> {
        let close = self.close.as_ref().filter(|_| !self.has_children)?;
        Some(self.start.end..close.start)
    }

    pub fn attribute<'t>(&self, text: &'t str, name: &str) -> Option<&'t str> {
        let found = self.attributes.iter().find(|attribute| &text[attribute.name.clone()] == name)?;
        Some(&text[found.value.clone()])
    }
}

impl Markup {
    /// The name of an element without its prefix.
    pub fn local<'t>(&self, text: &'t str, tag: usize) -> &'t str {
        let name = &text[self.tags[tag].name.clone()];
        name.rsplit(':').next().unwrap_or(name)
    }

    /// The elements around one, the innermost first.
    pub fn around(&self, tag: usize) -> impl Iterator<Item = usize> + '_ {
        std::iter::successors(self.tags[tag].parent, |tag| self.tags[*tag].parent)
    }

    /// The element whose name in the start tag begins at a byte.
    pub fn named_at(&self, at: usize) -> Option<usize> {
        self.tags.binary_search_by_key(&at, |tag| tag.name.start).ok()
    }

    /// The markup at a byte, which may be after the last letter of a name.
    pub fn spot(&self, at: usize) -> Spot {
        if self.others.iter().any(|other| other.start < at && at < other.end) {
            return Spot::Elsewhere;
        }
        let touches = |range: &Range<usize>| range.start <= at && at <= range.end;
        let before = self.tags.partition_point(|tag| tag.start.start < at);
        for (index, tag) in self.tags[..before].iter().enumerate().rev() {
            if touches(&tag.name) {
                return Spot::Name(index);
            }
            if at < tag.start.end {
                for (number, attribute) in tag.attributes.iter().enumerate() {
                    if touches(&attribute.name) {
                        return Spot::AttributeName(index, number);
                    }
                    if attribute.value.start > attribute.name.end && touches(&attribute.value) {
                        return Spot::Value(index, number);
                    }
                }
                return Spot::Inside(index);
            }
            if let Some(close) = &tag.close {
                if close.start < at && at < close.end {
                    return Spot::Name(index);
                }
                if at <= close.start {
                    return Spot::Text(index);
                }
            } else if tag.start.end <= at && !tag.has_children && index + 1 == before {
                return self.tags[index].parent.map_or(Spot::Elsewhere, Spot::Text);
            }
        }
        Spot::Elsewhere
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ARM: &str = "<robot name='arm'>\n <!-- <link> --> <link name=\"base\"/>\n <child>tip</child>\n</robot>";

    #[test]
    fn elements_have_their_bytes_and_what_is_around_them() {
        let markup = scan(ARM);
        let names: Vec<&str> = markup.tags.iter().map(|tag| &ARM[tag.name.clone()]).collect();
        assert_eq!(names, ["robot", "link", "child"]);
        assert_eq!(markup.tags[1].parent, Some(0));
        assert_eq!(markup.tags[1].attribute(ARM, "name"), Some("base"));
        assert_eq!(&ARM[markup.tags[2].inside().unwrap()], "tip");
        assert_eq!(markup.tags[0].end(), ARM.len());
        let at = |words: &str| markup.spot(ARM.find(words).unwrap() + 1);
        assert_eq!(at("base"), Spot::Value(1, 0));
        assert_eq!(at("link> "), Spot::Elsewhere);
        assert_eq!(at("tip"), Spot::Text(2));
        assert_eq!(at("child>\n"), Spot::Name(2));
        assert_eq!(markup.spot(ARM.find("\n <child").unwrap() + 1), Spot::Text(0));
    }

    #[test]
    fn every_beginning_of_a_text_can_be_read() {
        for end in (0..ARM.len()).filter(|end| ARM.is_char_boundary(*end)) {
            let part = &ARM[..end];
            let markup = scan(part);
            for at in 0..=end {
                let _ = markup.spot(at);
            }
            assert!(markup.tags.iter().all(|tag| tag.end() <= end));
        }
        let broken = "<robot><link name=\"a<joint name='j' type=/><";
        let markup = scan(broken);
        assert_eq!(markup.tags[1].attribute(broken, "name"), Some("a"));
        assert_eq!(markup.tags[2].attribute(broken, "name"), Some("j"));
        assert_eq!(markup.spot(broken.len()), Spot::Name(3));
    }
}
