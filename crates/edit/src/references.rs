//! Names of links and joints wherever a URDF or an SRDF uses them.

use denavit_export::urdf::text::{Edits, escaped};
use roxmltree::{Attribute, Document, Node};
use std::collections::{BTreeMap, BTreeSet};

/// Old names and new ones.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(crate) struct Names {
    pub links: BTreeMap<String, String>,
    pub joints: BTreeMap<String, String>,
}

/// What a name may refer to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// A link.
    Link,
    /// A joint.
    Joint,
    /// A link, or a joint if no link has the name.
    Either,
}

const LINK_ATTRIBUTES: [&str; 13] = [
    "link",
    "link1",
    "link2",
    "parent_link",
    "child_link",
    "base_link",
    "tip_link",
    "link_name",
    "body",
    "body1",
    "body2",
    "parent",
    "child",
];
const JOINT_ATTRIBUTES: [&str; 5] = ["joint", "joint1", "joint2", "joint_name", "mimic_joint"];
const EITHER_ATTRIBUTES: [&str; 3] = ["reference", "relative_to", "frame"];

/// Tags that end in `joint` but define their own name.
const OWN_NAME: [&str; 3] = ["virtual_joint", "loop_joint", "ball_constraint"];

/// Parts of a tag whose text names a link.
const LINK_WORDS: [&str; 7] = ["link", "body", "frame", "parent", "child", "reference", "base"];

impl Names {
    /// The new name of what an attribute or text names, if it is renamed.
    fn of(&self, kind: Kind, name: &str) -> Option<&str> {
        let found = match kind {
            Kind::Link => self.links.get(name),
            Kind::Joint => self.joints.get(name),
            Kind::Either => self.links.get(name).or_else(|| self.joints.get(name)),
        };
        found.map(String::as_str)
    }

    /// The inverse mapping of names.
    pub fn back(&self) -> Self {
        let turned = |names: &BTreeMap<String, String>| {
            names.iter().map(|(old, new)| (new.clone(), old.clone())).collect::<BTreeMap<_, _>>()
        };
        Self { links: turned(&self.links), joints: turned(&self.joints) }
    }

    fn is_known(&self, name: &str) -> bool {
        self.links.contains_key(name) || self.joints.contains_key(name)
    }
}

fn attribute_kind(node: Node, attribute: &Attribute) -> Option<Kind> {
    named_by_attribute(node.tag_name().name(), attribute.name())
}

/// What the value of an attribute of a URDF or SRDF names, by its element's tag and its own name, both without prefixes; `None`
/// where it names neither link nor joint.
///
/// # Examples
/// ```
/// use denavit_edit::{Kind, named_by_attribute};
/// assert_eq!(named_by_attribute("parent", "link"), Some(Kind::Link));
/// assert_eq!(named_by_attribute("gazebo", "reference"), Some(Kind::Either));
/// assert_eq!(named_by_attribute("origin", "xyz"), None);
/// ```
pub fn named_by_attribute(tag: &str, name: &str) -> Option<Kind> {
    match (tag, name) {
        ("link", "name") => Some(Kind::Link),
        (tag, "name") if tag.ends_with("joint") && !OWN_NAME.contains(&tag) => Some(Kind::Joint),
        _ if LINK_ATTRIBUTES.contains(&name) => Some(Kind::Link),
        _ if JOINT_ATTRIBUTES.contains(&name) => Some(Kind::Joint),
        _ if EITHER_ATTRIBUTES.contains(&name) => Some(Kind::Either),
        _ => None,
    }
}

/// What the text of an element names, by its tag, or by the name of a parameter.
fn text_kind(node: Node) -> Option<Kind> {
    named_by_text(node.tag_name().name(), node.attribute("name"))
}

/// What the words in an element name, by its tag and its attribute `name`; `None` where they name neither link nor joint.
pub fn named_by_text(tag: &str, name: Option<&str>) -> Option<Kind> {
    let word = if tag == "param" { name.unwrap_or_default() } else { tag }.to_lowercase();
    if word.contains("joint") || word == "mimic" {
        Some(Kind::Joint)
    } else if LINK_WORDS.iter().any(|part| word.contains(part)) {
        Some(Kind::Link)
    } else {
        None
    }
}

/// A place where a link or joint is named.
pub(crate) struct Named<'a, 'input> {
    /// The element that names it.
    pub node: Node<'a, 'input>,
    /// The name.
    pub name: String,
    /// Whether it is in the text of an element, for another program.
    pub in_text: bool,
}

/// Every use of one of these names, except `<link name>` and the ends of joints.
pub(crate) fn uses<'a, 'input>(
    document: &'a Document<'input>,
    links: &BTreeSet<&str>,
    joints: &BTreeSet<&str>,
) -> Vec<Named<'a, 'input>> {
    let map = |names: &BTreeSet<&str>| names.iter().map(|name| ((*name).to_owned(), String::new())).collect();
    let names = Names { links: map(links), joints: map(joints) };
    let mut found = Vec::new();
    for node in document.descendants().filter(Node::is_element) {
        for attribute in node.attributes() {
            let Some(kind) = attribute_kind(node, &attribute) else { continue };
            if names.of(kind, attribute.value()).is_some() {
                found.push(Named { node, name: attribute.value().to_owned(), in_text: false });
            }
        }
        if let (Some(kind), Some(inside)) = (text_kind(node), leaf_text(node)) {
            for word in inside.text().unwrap_or_default().split([',', ' ', '\t', '\n', '\r']) {
                let word = word.rsplit("::").next().unwrap_or(word);
                if names.of(kind, word).is_some() {
                    found.push(Named { node, name: word.to_owned(), in_text: true });
                }
            }
        }
    }
    found
}

fn leaf_text<'a, 'input>(node: Node<'a, 'input>) -> Option<Node<'a, 'input>> {
    if node.first_element_child().is_some() {
        return None;
    }
    node.children().find(Node::is_text)
}

/// Writes the new names; returns the number of references, and text that looks like a name but was not changed.
pub(crate) fn rename(document: &Document, names: &Names, edits: &mut Edits) -> (usize, Vec<String>) {
    rename_where(document, names, edits, &|_| true)
}

/// As [`rename`], in these elements.
pub(crate) fn rename_where(
    document: &Document,
    names: &Names,
    edits: &mut Edits,
    stays: &dyn Fn(Node) -> bool,
) -> (usize, Vec<String>) {
    let (mut count, mut left) = (0, Vec::new());
    for node in document.descendants().filter(|node| node.is_element() && stays(*node)) {
        for attribute in node.attributes() {
            let Some(kind) = attribute_kind(node, &attribute) else { continue };
            if let Some(new) = names.of(kind, attribute.value()) {
                edits.replace(attribute.range_value(), escaped(new));
                count += 1;
            }
        }
        let Some(inside) = leaf_text(node) else { continue };
        let written = inside.text().unwrap_or_default();
        match text_kind(node) {
            Some(kind) => {
                let changed = words(written, |word| names.of(kind, word));
                if changed != written {
                    edits.replace(inside.range(), escaped(&changed));
                    count += 1;
                }
            }
            None if names.is_known(written.trim()) => {
                left.push(format!(
                    "<{}> holds \"{}\", which may be the old name",
                    node.tag_name().name(),
                    written.trim()
                ));
            }
            None => {}
        }
    }
    (count, left)
}

/// A text with some of its words replaced; in `model::link` the last part is a name.
fn words<'a>(text: &str, new: impl Fn(&str) -> Option<&'a str>) -> String {
    let mut result = String::with_capacity(text.len());
    for piece in text.split_inclusive([',', ' ', '\t', '\n', '\r']) {
        let word = piece.trim_end_matches([',', ' ', '\t', '\n', '\r']);
        let at = word.rfind("::").map_or(0, |at| at + 2);
        match new(&word[at..]).filter(|_| !word.is_empty()) {
            Some(name) => {
                result.push_str(&word[..at]);
                result.push_str(name);
                result.push_str(&piece[word.len()..]);
            }
            None => result.push_str(piece),
        }
    }
    result
}
