//! The operations, a file each.

pub(crate) mod attach;
pub(crate) mod calibration;
pub(crate) mod collision;
pub(crate) mod frames;
pub(crate) mod merge;
pub(crate) mod meshes;
pub(crate) mod mirror;
pub(crate) mod part;
pub(crate) mod rename;
pub(crate) mod reroot;
pub(crate) mod scale;
pub(crate) mod sense;
pub(crate) mod snap;

use crate::error::EditError;
use denavit_export::urdf::text::Nodes;
use denavit_model::element::Element;
use denavit_model::robot::{Robot, SourceText};
use roxmltree::{Document, Node};
use std::collections::BTreeMap;

/// # Errors
/// The SRDF is no XML.
pub(crate) fn parse_srdf(source: &SourceText) -> Result<Document<'_>, EditError> {
    Document::parse(&source.text).map_err(|error| EditError::Srdf { file: source.file.clone(), why: error.to_string() })
}

/// An element beside links and joints that may place something.
pub(crate) struct Placing<'a, 'input> {
    pub(crate) element: &'a Element,
    /// The link that holds it, if one does.
    pub(crate) owner: Option<&'a str>,
    pub(crate) top: Node<'a, 'input>,
    /// `top` and all elements in it, as in [`Element::nodes`].
    pub(crate) inside: Vec<Node<'a, 'input>>,
}

/// Those of the robot and those of its links.
pub(crate) fn placing<'a, 'input>(
    robot: &'a Robot,
    document: &'a Document<'input>,
    nodes: &Nodes<'a, 'input>,
) -> Vec<Placing<'a, 'input>> {
    let elements = document.root_element().children().chain(nodes.links().flat_map(|link| link.children()));
    let by_start: BTreeMap<usize, Node> =
        elements.filter(Node::is_element).map(|node| (node.range().start, node)).collect();
    let own = robot.elements.iter().map(|element| (element, None));
    let of_links =
        robot.links.iter().flat_map(|link| link.elements.iter().map(|element| (element, Some(link.name.as_str()))));
    let found = own.chain(of_links).filter_map(|(element, owner)| {
        let top = *by_start.get(&element.at)?;
        Some(Placing { element, owner, top, inside: top.descendants().filter(Node::is_element).collect() })
    });
    found.collect()
}
