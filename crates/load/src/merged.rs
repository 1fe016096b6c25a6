//! Merges edits of a converted description into its original.
//!
//! ```text
//! URDF ──► MJCF, as it was written ──► `before`
//!              │ somebody edits it
//!              └──► as it is now ────► `after`       URDF + (after - before) = the URDF with the edits
//! ```
//! The edits are the differences between `before` and `after`, both read by the same reader. Only they are written into the original,
//! each value in its place; everything else is unchanged, with what the other format could not express. The same holds for the other
//! formats, with fewer values.

mod mjcf;
mod sdf;
mod urdf;

use denavit_model::Robot;
use denavit_model::formats::{Format, Loss};
use denavit_model::robot::{Inertial, Joint, Link};
use denavit_model::se3;
use denavit_model::write::numbers;
use roxmltree::{Document, Node, ParsingOptions};
use std::ops::Range;

/// A description with edits, and what of them it does not have.
pub(crate) struct Merged {
    pub text: String,
    /// How many values, elements, or joints and links with all that is in them were changed.
    pub changes: usize,
    pub lost: Vec<Loss>,
}

/// Puts the edits between `before` and `after` into the description that `before` was made of; `None` where that cannot be read,
/// or nothing of them can be put there.
pub(crate) fn merged(format: Format, file: &str, text: &str, before: &Robot, after: &Robot) -> Option<Merged> {
    match format {
        Format::Mjcf => mjcf::merged(text, before, after),
        Format::Sdf => sdf::merged(text, before, after),
        _ => urdf::merged(file, text, before, after),
    }
}

/// The joint that carries a link of this name: joints that do not move have no names in every format.
fn carrier<'r>(robot: &'r Robot, link: &str) -> Option<&'r Joint> {
    robot.joints.iter().find(|joint| robot.links[joint.child].name == link)
}

fn link<'r>(robot: &'r Robot, name: &str) -> Option<&'r Link> {
    robot.links.iter().find(|link| link.name == name)
}

fn joint<'r>(robot: &'r Robot, name: &str) -> Option<&'r Joint> {
    robot.joints.iter().find(|joint| joint.name == name)
}

fn child<'n>(node: Node<'n, 'n>, tag: &str) -> Option<Node<'n, 'n>> {
    node.children().find(|child| child.is_element() && child.tag_name().name() == tag)
}

fn parsed(text: &str) -> Option<Document<'_>> {
    let options = ParsingOptions { allow_dtd: true, ..ParsingOptions::default() };
    Document::parse_with_options(text, options).ok()
}

/// The only element of a tag and name.
fn named<'n>(document: &'n Document<'n>, tag: &str, name: &str) -> Option<Node<'n, 'n>> {
    let mut found = document.descendants().filter(|node| {
        let tags = node.tag_name().name() == tag;
        tags && node.attribute("name") == Some(name)
            && node.ancestors().all(|above| above.tag_name().name() != "default")
    });
    let (only, None) = (found.next()?, found.next()) else { return None };
    Some(only)
}

/// Mass, centre and tensor about it along the link's own axes: x, y, z; xx, yy, zz, xy, xz, yz.
fn along_link(inertial: &Inertial) -> (f64, [f64; 3], [f64; 6]) {
    let turn = se3::rotation_from_rpy(inertial.origin.rpy);
    let t = turn.matrix() * inertial.tensor * turn.matrix().transpose();
    (inertial.mass, inertial.origin.xyz, [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)].map(|at| t[at]))
}

/// Pieces of a text and what stands there instead.
struct Edits<'a> {
    text: &'a str,
    pieces: Vec<(Range<usize>, String)>,
}

impl<'a> Edits<'a> {
    fn of(text: &'a str) -> Self {
        Self { text, pieces: Vec::new() }
    }

    fn replace(&mut self, range: Range<usize>, new: impl Into<String>) {
        self.pieces.push((range, new.into()));
    }

    /// Puts `new` where the first element of a tag is, or as the last in its parent; takes it out where it is empty.
    fn set(&mut self, parent: Node<'a, 'a>, tag: &str, new: String) {
        if let Some(old) = child(parent, tag) {
            self.replace(old.range(), new);
        } else if !new.is_empty() {
            self.append(parent, &new);
        }
    }

    fn append(&mut self, parent: Node<'a, 'a>, new: &str) {
        let range = parent.range();
        let text = &self.text[range.clone()];
        if let Some(at) = text.rfind("</").filter(|_| !text.ends_with("/>")) {
            let at = range.start + at;
            self.replace(at..at, new);
        } else {
            let tag = text[1..].split(|c: char| c.is_whitespace() || c == '/' || c == '>').next().unwrap_or_default();
            self.replace(range.end - 2..range.end, format!(">{new}</{tag}>"));
        }
    }

    fn set_attribute(&mut self, node: Node<'a, 'a>, name: &str, value: &str) {
        if let Some(attribute) = node.attribute_node(name) {
            self.replace(attribute.range_value(), value);
        } else {
            let start = node.range().start;
            let rest = &self.text[start + 1..];
            let at = start + 1 + rest.find(|c: char| c.is_whitespace() || c == '/' || c == '>').unwrap_or(0);
            self.replace(at..at, format!(" {name}=\"{value}\""));
        }
    }

    fn remove_attribute(&mut self, node: Node<'a, 'a>, name: &str) {
        if let Some(attribute) = node.attribute_node(name) {
            self.replace(attribute.range(), "");
        }
    }

    /// Sets the text of an element below a path of tags; elements that are missing are put there.
    fn set_text(&mut self, node: Node<'a, 'a>, path: &[&str], value: &str) {
        let mut node = node;
        for (index, tag) in path.iter().enumerate() {
            let Some(next) = child(node, tag) else {
                let opens = path[index..].iter().map(|tag| format!("<{tag}>")).collect::<Vec<_>>().concat();
                let closes = path[index..].iter().rev().map(|tag| format!("</{tag}>")).collect::<Vec<_>>().concat();
                self.append(node, &format!("{opens}{value}{closes}"));
                return;
            };
            node = next;
        }
        match node.first_child().filter(Node::is_text) {
            Some(text) => self.replace(text.range(), value),
            None => self.append(node, value),
        }
    }

    /// The text with every edit, and how many there were; what is in an element that is taken out, too.
    fn finished(mut self) -> Option<(String, usize)> {
        self.pieces.sort_by_key(|(range, _)| (range.start, range.end));
        let (mut out, mut at, changes) = (String::with_capacity(self.text.len()), 0, self.pieces.len());
        for (range, new) in self.pieces {
            if range.start < at {
                continue;
            }
            out.push_str(self.text.get(at..range.start)?);
            out.push_str(&new);
            at = range.end;
        }
        out.push_str(self.text.get(at..)?);
        Some((out, changes))
    }
}

/// Numbers of a place, each so that it reads back as itself.
fn words(values: &[f64]) -> String {
    let values: Vec<f64> = values.iter().map(|value| value + 0.0).collect();
    numbers(&values)
}
