//! The XML tree that is expanded: immutable, shared, each node with its place.

use std::ops::Range;
use std::rc::Rc;

use crate::error::{ErrorKind, XacroError};
use crate::place::{SourceFile, Spot};

/// Elements nested deeper than this are refused, since the reader recurses.
const DEEPEST: usize = 1000;

#[derive(Debug, Clone)]
pub(crate) enum Node {
    Element(Rc<Element>),
    Text(Text),
    /// Characters that were written as `<![CDATA[…]]>`, which xacro leaves alone.
    Cdata(Rc<str>),
    Comment(Text),
    Instruction {
        target: Rc<str>,
        value: Rc<str>,
    },
}

#[derive(Debug, Clone)]
pub(crate) struct Text {
    pub value: Rc<str>,
    pub spot: Spot,
}

#[derive(Debug, Clone)]
pub(crate) struct Element {
    /// As written, with its prefix.
    pub name: Rc<str>,
    /// `xmlns` and `xmlns:…` that are declared here.
    pub namespaces: Vec<(Rc<str>, Rc<str>)>,
    pub attributes: Vec<Attribute>,
    pub children: Vec<Node>,
    pub file: Rc<SourceFile>,
    /// The element's name in the start tag.
    pub range: Range<usize>,
    /// Of an element that was produced: the macros that it was produced in.
    pub calls: Option<Rc<Call>>,
}

/// A macro call that is being expanded, and the one around it.
#[derive(Debug)]
pub(crate) struct Call {
    pub name: Rc<str>,
    pub defined: Spot,
    pub called: Spot,
    pub around: Option<Rc<Call>>,
}

#[derive(Debug, Clone)]
pub(crate) struct Attribute {
    pub name: Rc<str>,
    pub value: Rc<str>,
    /// Of the value, quotes not included.
    pub range: Range<usize>,
    pub name_range: Range<usize>,
}

/// A document: what stands before and after the root is kept too.
#[derive(Debug)]
pub(crate) struct Document {
    pub before: Vec<Node>,
    pub root: Rc<Element>,
    pub after: Vec<Node>,
}

impl Element {
    pub fn spot(&self) -> Spot {
        Spot::new(&self.file, self.range.clone())
    }

    pub fn attribute(&self, name: &str) -> Option<&Attribute> {
        self.attributes.iter().find(|attribute| &*attribute.name == name)
    }

    pub fn spot_of(&self, attribute: &Attribute) -> Spot {
        Spot::new(&self.file, attribute.range.clone())
    }

    pub fn elements(&self) -> impl Iterator<Item = &Rc<Element>> {
        self.children.iter().filter_map(|node| match node {
            Node::Element(element) => Some(element),
            _ => None,
        })
    }

    /// The same element without its attributes and children.
    pub fn bare(&self) -> Self {
        Self {
            name: Rc::clone(&self.name),
            namespaces: Vec::new(),
            attributes: Vec::new(),
            children: Vec::new(),
            file: Rc::clone(&self.file),
            range: self.range.clone(),
            calls: None,
        }
    }

    pub fn set_attribute(&mut self, name: Rc<str>, value: Rc<str>, range: Range<usize>) {
        match self.attributes.iter_mut().find(|attribute| attribute.name == name) {
            Some(attribute) => {
                attribute.value = value;
                attribute.range = range;
            }
            None => self.attributes.push(Attribute { name, value, name_range: range.clone(), range }),
        }
    }
}

/// Reads XML.
pub(crate) fn read(file: &Rc<SourceFile>) -> Result<Document, Box<XacroError>> {
    let options = roxmltree::ParsingOptions { allow_dtd: true, ..Default::default() };
    let text = file.text.as_str();
    let document = roxmltree::Document::parse_with_options(text, options).map_err(|error| {
        let position = error.pos();
        let offset = offset(text, position.row as usize, position.col as usize);
        let words = error.to_string();
        // The place is printed before the message and need not be repeated in it.
        let words = words.rsplit_once(" at ").map_or(words.as_str(), |(words, _)| words);
        XacroError::new(ErrorKind::Xml, format!("this is not well-formed XML: {words}"))
            .at(&Spot::new(file, offset..offset + 1))
    })?;
    let root = document.root_element();
    let mut before = Vec::new();
    let mut after = Vec::new();
    for node in document.root().children().filter(|node| !node.is_element()) {
        if let Some(kept) = convert(file, node, 0)? {
            if node.range().start < root.range().start { &mut before } else { &mut after }.push(kept);
        }
    }
    Ok(Document { before, root: Rc::new(element(file, root, 0)?), after })
}

fn offset(text: &str, line: usize, column: usize) -> usize {
    let start = text.split_inclusive('\n').take(line.saturating_sub(1)).map(str::len).sum::<usize>();
    text.get(start..)
        .unwrap_or_default()
        .char_indices()
        .nth(column.saturating_sub(1))
        .map_or(text.len(), |(at, _)| start + at)
}

fn convert(
    file: &Rc<SourceFile>,
    node: roxmltree::Node<'_, '_>,
    depth: usize,
) -> Result<Option<Node>, Box<XacroError>> {
    let range = node.range();
    Ok(match node.node_type() {
        roxmltree::NodeType::Root => None,
        roxmltree::NodeType::Element => Some(Node::Element(Rc::new(element(file, node, depth)?))),
        // The reader lets a second XML declaration pass as an instruction.
        roxmltree::NodeType::PI => node.pi().filter(|pi| !pi.target.eq_ignore_ascii_case("xml")).map(|instruction| {
            Node::Instruction { target: instruction.target.into(), value: instruction.value.unwrap_or_default().into() }
        }),
        roxmltree::NodeType::Comment => Some(Node::Comment(Text {
            value: node.text().unwrap_or_default().into(),
            spot: Spot::new(file, range.start + "<!--".len()..range.end),
        })),
        roxmltree::NodeType::Text => {
            let value: Rc<str> = node.text().unwrap_or_default().into();
            Some(if file.text[range.clone()].starts_with("<![CDATA[") {
                Node::Cdata(value)
            } else {
                Node::Text(Text { value, spot: Spot::new(file, range) })
            })
        }
    })
}

fn element(file: &Rc<SourceFile>, node: roxmltree::Node<'_, '_>, depth: usize) -> Result<Element, Box<XacroError>> {
    let start = node.range().start + 1;
    let rest = file.text.get(start..).unwrap_or_default();
    let length = rest.find(|c: char| c.is_ascii_whitespace() || c == '>' || c == '/').unwrap_or(rest.len());
    let range = start..start + length;
    if depth > DEEPEST {
        return Err(XacroError::new(ErrorKind::Limit, format!("elements are nested more than {DEEPEST} deep"))
            .at(&Spot::new(file, range)));
    }
    let parent_namespaces: Vec<(Option<&str>, &str)> = node
        .parent_element()
        .map(|parent| parent.namespaces().map(|n| (n.name(), n.uri())).collect())
        .unwrap_or_default();
    let namespaces = node
        .namespaces()
        .map(|namespace| (namespace.name(), namespace.uri()))
        .filter(|namespace| !parent_namespaces.contains(namespace) && namespace.0 != Some("xml"))
        .map(|(prefix, uri)| {
            let name = prefix.map_or_else(|| "xmlns".to_owned(), |prefix| format!("xmlns:{prefix}"));
            (name.into(), uri.into())
        })
        .collect();
    let attributes = node
        .attributes()
        .map(|attribute| Attribute {
            name: file.text[attribute.range_qname()].into(),
            value: attribute.value().into(),
            range: attribute.range_value(),
            name_range: attribute.range_qname(),
        })
        .collect();
    let mut children = Vec::new();
    for child in node.children() {
        children.extend(convert(file, child, depth + 1)?);
    }
    Ok(Element {
        name: rest[..length].into(),
        namespaces,
        attributes,
        children,
        file: Rc::clone(file),
        range,
        calls: None,
    })
}
