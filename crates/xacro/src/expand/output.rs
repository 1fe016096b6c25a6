//! An element that is being produced.

use std::ops::Range;
use std::rc::Rc;

use crate::tree::{Element, Node};

pub(super) struct Output {
    pub element: Element,
    /// Children before this one are not touched by [`Output::drop_comments`] any more.
    barrier: usize,
    /// Whether the element itself is written, and not only its children.
    pub is_written: bool,
}

impl Output {
    pub fn new(element: Element, is_written: bool) -> Self {
        Self { element, barrier: 0, is_written }
    }

    pub fn push(&mut self, node: Node) {
        self.element.children.push(node);
    }

    pub fn extend(&mut self, nodes: impl IntoIterator<Item = Node>) {
        self.element.children.extend(nodes);
    }

    /// Drops the comments right before a xacro element: they describe it and not the result.
    ///
    /// A blank line keeps the comments above it.
    pub fn drop_comments(&mut self) {
        let children = &mut self.element.children;
        let mut at = children.len();
        loop {
            if at > self.barrier
                && matches!(&children[at - 1], Node::Text(text)
                    if text.value.trim().is_empty() && text.value.matches('\n').count() <= 1)
            {
                at -= 1;
            }
            if at > self.barrier && matches!(children[at - 1], Node::Comment(_)) {
                at -= 1;
                children.remove(at);
            } else {
                return;
            }
        }
    }

    /// Marks the end of a xacro element's result.
    pub fn close_directive(&mut self) {
        self.barrier = self.element.children.len();
    }

    /// Takes over namespace declarations; returns those that contradict an existing one.
    pub fn import_namespaces(&mut self, namespaces: &[(Rc<str>, Rc<str>)]) -> Vec<Rc<str>> {
        let mut contradictions = Vec::new();
        for (name, uri) in namespaces.iter().filter(|(name, _)| name.starts_with("xmlns:") && &**name != "xmlns:xacro")
        {
            match self.element.namespaces.iter().find(|(known, _)| known == name) {
                Some((_, known)) if known == uri => {}
                Some(_) => contradictions.push(Rc::clone(name)),
                None => self.element.namespaces.push((Rc::clone(name), Rc::clone(uri))),
            }
        }
        contradictions
    }

    pub fn set_attribute(&mut self, name: Rc<str>, value: Rc<str>, range: Range<usize>) {
        self.element.set_attribute(name, value, range);
    }
}
