//! Elements other than links and joints, which may contain a pose in the frame of a link.

use super::nodes::Nodes;
use denavit_model::element::Element;
use denavit_model::robot::Robot;
use roxmltree::{Document, Node};
use std::collections::BTreeMap;

/// An element other than a link or joint that may contain a pose.
pub struct Placing<'a, 'input> {
    /// As it was read.
    pub element: &'a Element,
    /// The link that holds it, if one does.
    pub owner: Option<&'a str>,
    /// The element itself in the text.
    pub top: Node<'a, 'input>,
    /// `top` and all elements in it, as in [`Element::nodes`].
    pub inside: Vec<Node<'a, 'input>>,
}

/// Those of the robot and those of its links.
pub fn placing<'a, 'input>(
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
