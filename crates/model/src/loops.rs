//! Closed loops that a file states in addition to its tree: they are recognised and kept, but not solved.
//!
//! URDF's tree has no loops. Files state loops in other ways: `<constraint>` (URDF 1.2's proposal), Drake's `<loop_joint>` and
//! constraints, a `<joint>` between two links inside `<gazebo>` (SDF's), an `<equality>` inside `<mujoco>`.

use crate::element::{Element, ElementNode};
use crate::robot::Robot;
use std::collections::HashSet;

/// Something that closes a loop.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Loop {
    /// What it is: `loop_joint "knee"`.
    pub label: String,
    /// Byte offset of the element that holds it in the source text.
    pub at: usize,
    /// The links that it joins, as far as it names links.
    pub between: Vec<String>,
}

/// Tags without a prefix, beside links and joints, that close a loop; so does every tag that ends in `_constraint`.
const CLOSING: [&str; 6] = ["constraint", "loop_joint", "loop", "closed_loop", "loop_closure", "linear_bushing_rpy"];

/// No format states a loop deeper inside an element than this.
const DEEP: usize = 8;

impl Robot {
    /// Every closed loop that the file states beside the tree, in the order of the file.
    pub fn loops(&self) -> Vec<Loop> {
        if self.elements.iter().all(|element| !may_close(element)) {
            return Vec::new();
        }
        let links: HashSet<&str> = self.links.iter().map(|link| link.name.as_str()).collect();
        self.elements.iter().flat_map(|element| loops_in(element, &links)).collect()
    }
}

fn may_close(element: &Element) -> bool {
    closes(local(element.tag())) || matches!(local(element.tag()), "gazebo" | "mujoco")
}

fn closes(tag: &str) -> bool {
    CLOSING.contains(&tag) || tag.ends_with("_constraint")
}

fn local(tag: &str) -> &str {
    tag.rsplit(':').next().unwrap_or(tag)
}

fn loops_in(element: &Element, links: &HashSet<&str>) -> Vec<Loop> {
    let nodes = &element.nodes;
    if closes(local(element.tag())) {
        return vec![Loop { label: element.label(), at: element.at, between: names_in(nodes, links) }];
    }
    if !may_close(element) {
        return Vec::new();
    }
    let inside = nodes.iter().enumerate().skip(1).filter_map(|(index, node)| {
        let candidate = matches!(node.tag.as_str(), "joint" | "connect" | "weld") && node.depth <= DEEP;
        let part = candidate.then(|| {
            let end = nodes[index + 1..].iter().position(|next| next.depth <= node.depth);
            &nodes[index..end.map_or(nodes.len(), |end| index + 1 + end)]
        })?;
        let has = |tag: &str| part.iter().any(|inner| inner.depth == node.depth + 1 && inner.tag == tag);
        // SDF's joint, which a simulator adds to the tree; MuJoCo's equalities, but for those of two joints' values.
        let found = match node.tag.as_str() {
            "joint" => has("parent") && has("child"),
            _ => nodes[..index].iter().any(|above| above.tag == "equality"),
        };
        let label = |name: &str| format!("{} in {}", named(node, name), element.label());
        found.then(|| Loop {
            label: label(node.attribute("name").unwrap_or_default()),
            at: element.at,
            between: names_in(part, links),
        })
    });
    inside.collect()
}

fn named(node: &ElementNode, name: &str) -> String {
    if name.is_empty() { node.tag.clone() } else { format!("{} \"{name}\"", node.tag) }
}

/// Links that attributes or texts name, each once.
fn names_in(nodes: &[ElementNode], links: &HashSet<&str>) -> Vec<String> {
    let mut found: Vec<String> = Vec::new();
    for node in nodes {
        let values = node.attributes.iter().filter(|(name, _)| name != "name").map(|(_, value)| value.as_str());
        for value in values.chain([node.text.as_str()]) {
            if links.contains(value) && !found.iter().any(|known| known == value) {
                found.push(value.to_owned());
            }
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use crate::urdf;

    const LINKS: &str = r#"<link name="a"/><link name="b"/><link name="c"/>
        <joint name="j" type="revolute"><parent link="a"/><child link="b"/></joint>
        <joint name="k" type="revolute"><parent link="a"/><child link="c"/></joint>"#;

    fn notes(further: &str) -> Vec<String> {
        let text = format!("<robot name=\"r\" xmlns:drake=\"http://drake.mit.edu\">{LINKS}\n{further}</robot>");
        urdf::read("r.urdf", &text).unwrap().notes.iter().map(ToString::to_string).collect()
    }

    #[test]
    fn every_way_to_close_a_loop_is_said_not_to_be_solved() {
        for further in [
            r#"<constraint name="l" type="revolute"><parent link="b"/><child link="c"/></constraint>"#,
            r#"<loop_joint name="l" type="revolute"><link1 link="b"/><link2 link="c"/></loop_joint>"#,
            r#"<drake:linear_bushing_rpy name="l"><drake:bushing_frameA name="b"/><drake:bushing_frameC name="c"/></drake:linear_bushing_rpy>"#,
            r#"<gazebo><joint name="l" type="revolute"><parent>b</parent><child>c</child></joint></gazebo>"#,
            r#"<mujoco><equality><connect name="l" body1="b" body2="c" anchor="0 0 0"/></equality></mujoco>"#,
            r#"<drake:ball_constraint name="l"><drake:ball_constraint_body_A name="b"/></drake:ball_constraint>"#,
            r#"<loop name="l"><link name="b"/></loop>"#,
        ] {
            let notes = notes(further);
            assert_eq!(notes.len(), 1, "{further}: {notes:?}");
            assert!(notes[0].starts_with("r.urdf:4: ") && notes[0].contains("not solved"), "{}", notes[0]);
        }
        let between = notes(r#"<constraint name="l"><parent link="b"/><child link="c"/></constraint>"#);
        assert!(between[0].contains("constraint \"l\": closes a loop between \"b\" and \"c\""), "{between:?}");
    }

    #[test]
    fn what_closes_nothing_is_not_called_a_loop() {
        for further in [
            r#"<transmission name="t"><joint name="j"/></transmission>"#,
            r#"<gazebo reference="b"><sensor name="s" type="contact"/></gazebo>"#,
            r#"<mujoco><equality><joint joint1="j" joint2="k"/></equality></mujoco>"#,
        ] {
            assert_eq!(notes(further), Vec::<String>::new());
        }
    }
}
