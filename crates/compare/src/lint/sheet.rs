//! A file prepared for the rules: the robot, its XML, and the mapping to the original text.

use crate::lint::{Edit, Lookup};
use denavit_model::formats::Format;
use denavit_model::robot::{Joint, Link, SourceText};
use denavit_model::{Place, Problem, Robot, UrdfError};
use roxmltree::{Document, Node, NodeId, ParsingOptions};
use std::cell::OnceCell;
use std::collections::HashMap;

/// A file as the rules see it.
pub struct Sheet<'a> {
    file: &'a str,
    read: &'a Result<Robot, UrdfError>,
    document: Option<Document<'a>>,
    lookup: &'a dyn Fn(&str) -> Lookup,
    /// Elements by the byte offset at which they start.
    starts: OnceCell<HashMap<usize, NodeId>>,
}

impl<'a> Sheet<'a> {
    pub(super) fn new(file: &'a str, read: &'a Result<Robot, UrdfError>, lookup: &'a dyn Fn(&str) -> Lookup) -> Self {
        let document = read.as_ref().ok().and_then(|robot| {
            let options = ParsingOptions { allow_dtd: true, ..ParsingOptions::default() };
            Document::parse_with_options(&robot.source.text, options).ok()
        });
        Self { file, read, document, lookup, starts: OnceCell::new() }
    }

    /// The robot, where the file is one.
    pub(super) fn robot(&self) -> Option<&'a Robot> {
        self.read.as_ref().ok()
    }

    /// Why it is invalid.
    pub(super) fn problems(&self) -> &'a [Problem] {
        self.read.as_ref().err().map_or(&[], |error| &error.problems)
    }

    /// Joints, where the file is a robot.
    pub(super) fn joints(&self) -> &'a [Joint] {
        self.robot().map_or(&[], |robot| &robot.joints)
    }

    /// Links, where the file is a robot.
    pub(super) fn links(&self) -> &'a [Link] {
        self.robot().map_or(&[], |robot| &robot.links)
    }

    /// The format that the robot was written in.
    pub(super) fn format(&self) -> Format {
        self.source().map_or(Format::Urdf, SourceText::format)
    }

    /// What states a joint's bounds in that format.
    pub(super) fn limit_word(&self) -> &'static str {
        if self.format() == Format::Mjcf { "range" } else { "<limit>" }
    }

    /// Every element of the file.
    pub(super) fn elements(&self) -> impl Iterator<Item = Node<'_, 'a>> {
        self.document.iter().flat_map(Document::descendants).filter(Node::is_element)
    }

    /// The `<robot>`.
    pub(super) fn root(&self) -> Option<Node<'_, 'a>> {
        self.document.as_ref().map(Document::root_element)
    }

    /// The element that starts at a byte offset.
    pub(super) fn element_at(&self, offset: usize) -> Option<Node<'_, 'a>> {
        let starts = self.starts.get_or_init(|| self.elements().map(|node| (node.range().start, node.id())).collect());
        self.document.as_ref()?.get_node(*starts.get(&offset)?)
    }

    /// The first element below the one at `offset` along a path of tags, as far as the path exists.
    pub(super) fn below(&self, offset: usize, path: &[&str]) -> usize {
        let Some(mut node) = self.element_at(offset) else { return offset };
        for tag in path {
            match node.children().find(|child| child.tag_name().name() == *tag) {
                Some(child) => node = child,
                None => break,
            }
        }
        node.range().start
    }

    /// The edit that replaces the value of an attribute of the element at `offset` by `text`.
    pub(super) fn set_attribute(&self, offset: usize, name: &str, text: String) -> Option<Edit> {
        let range = self.element_at(offset)?.attribute_node(name)?.range_value();
        Some(Edit { start: range.start, end: range.end, text })
    }

    /// The value of an attribute as it is in the file, and where it starts.
    pub(super) fn written(&self, offset: usize, name: &str) -> Option<(&'a str, usize)> {
        let range = self.element_at(offset)?.attribute_node(name)?.range_value();
        Some((self.robot()?.source.text.get(range.clone())?, range.start))
    }

    pub(super) fn look_up(&self, mesh: &str) -> Lookup {
        (self.lookup)(mesh)
    }

    fn source(&self) -> Option<&SourceText> {
        self.robot().map(|robot| &robot.source)
    }

    pub(super) fn place(&self, offset: usize, element: String) -> Place {
        match self.source() {
            Some(source) => source.place(offset, element),
            None => Place { file: self.file.to_owned(), line: 1, element },
        }
    }

    /// An edit of the text that was read, as one of the original.
    pub(super) fn in_original(&self, edit: Edit) -> Edit {
        let Some(source) = self.source() else { return edit };
        let shift = |at: usize| {
            let declared = if at >= source.declared.end { source.declared.len() } else { 0 };
            at + source.dropped_before.len() - declared
        };
        Edit { start: shift(edit.start), end: shift(edit.end), text: edit.text }
    }
}

/// Words of an attribute value with their places in it.
pub(super) fn words(value: &str) -> impl Iterator<Item = (usize, &str)> {
    let separators = |c: char| c.is_whitespace() || c == ',';
    let base = value.as_ptr() as usize;
    value.split(separators).filter(|word| !word.is_empty()).map(move |word| (word.as_ptr() as usize - base, word))
}
