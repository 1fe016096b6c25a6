//! The XML elements of a robot's links and joints.

use super::ExportError;
use denavit_model::robot::Robot;
use roxmltree::{Document, Node};
use std::collections::BTreeMap;

/// Elements by link and joint.
pub struct Nodes<'a, 'input> {
    links: Vec<Option<Node<'a, 'input>>>,
    joints: Vec<Node<'a, 'input>>,
}

impl<'a, 'input> Nodes<'a, 'input> {
    /// Of a robot's document, see [`super::parse`].
    ///
    /// # Errors
    /// A joint's element is not at its place in the text, as with XML entities.
    pub fn of(robot: &Robot, document: &'a Document<'input>) -> Result<Self, ExportError> {
        let top = document.root_element().children().filter(Node::is_element);
        let by_start: BTreeMap<usize, Node> = top.map(|node| (node.range().start, node)).collect();
        let find = |at: usize, tag: &str, name: &str| {
            let node = by_start.get(&at)?;
            (node.tag_name().name() == tag && node.attribute("name") == Some(name)).then_some(*node)
        };
        let links = robot.links.iter().map(|link| find(link.at, "link", &link.name)).collect();
        let joints: Option<Vec<Node>> = robot.joints.iter().map(|joint| find(joint.at, "joint", &joint.name)).collect();
        let joints = joints.ok_or_else(|| ExportError::Unfaithful {
            file: robot.source.file.clone(),
            what: "joint elements are not in the text itself".into(),
        })?;
        Ok(Self { links, joints })
    }

    /// `None` for a link that the text does not declare.
    pub fn link(&self, index: usize) -> Option<Node<'a, 'input>> {
        self.links[index]
    }

    /// The elements of links that the text declares.
    pub fn links(&self) -> impl Iterator<Item = Node<'a, 'input>> + '_ {
        self.links.iter().flatten().copied()
    }

    /// A joint's element.
    pub fn joint(&self, index: usize) -> Node<'a, 'input> {
        self.joints[index]
    }
}
