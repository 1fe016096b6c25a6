//! Elements other than links and joints: what is in `<gazebo>` is SDF and goes back to its original place.

use super::names::Names;
use crate::known::{JOINT, LINK, MODEL};
use crate::names::fresh;
use denavit_model::Robot;
use denavit_model::element::Element;
use denavit_model::formats::Loss;
use denavit_model::robot::Shape;
use denavit_model::write;
use std::collections::{BTreeSet, HashSet};

/// Attributes of URDF's `<dynamics>` that are elements of SDF's.
pub(crate) const DYNAMICS: [&str; 4] = ["damping", "friction", "spring_reference", "spring_stiffness"];

/// Elements other than links and joints.
pub(crate) struct Further<'a> {
    /// In a link: its name, the element.
    links: Vec<(&'a str, Element)>,
    joints: Vec<(&'a str, Element)>,
    model: Vec<Element>,
    lost: Vec<(usize, String, String)>,
}

/// Whether SDF has this element in a link.
pub(crate) fn is_of_link(tag: &str) -> bool {
    LINK.carried.contains(&tag)
}

/// The elements that stand directly in an element.
pub(crate) fn children(element: &Element) -> Vec<Element> {
    let mut found: Vec<Element> = Vec::new();
    for node in element.nodes.iter().skip(1) {
        let mut node = node.clone();
        node.depth -= 1;
        if node.depth == 0 {
            found.push(Element { nodes: vec![node], at: element.at });
        } else if let Some(last) = found.last_mut() {
            last.nodes.push(node);
        }
    }
    found
}

impl<'a> Further<'a> {
    pub fn of(robot: &'a Robot) -> Self {
        let mut further = Self { links: Vec::new(), joints: Vec::new(), model: Vec::new(), lost: Vec::new() };
        for element in &robot.elements {
            if element.tag() != "gazebo" {
                if element.tag() != "material" {
                    further.lost.push((element.at, element.label(), "SDF has no such element".into()));
                }
                continue;
            }
            let reference = element.attribute("reference");
            let link = robot.links.iter().find(|link| Some(link.name.as_str()) == reference);
            let joint = robot.joints.iter().find(|joint| Some(joint.name.as_str()) == reference);
            for child in children(element) {
                let tag = child.tag().to_owned();
                let in_joint = JOINT.carried.contains(&tag.as_str()) || JOINT.child(&tag).is_some();
                let in_link = LINK.carried.contains(&tag.as_str()) || LINK.child(&tag).is_some();
                let in_model = MODEL.carried.contains(&tag.as_str())
                    || ["joint", "pose", "static", "frame"].contains(&tag.as_str());
                let is_end = |end: &&Element| ["parent", "child"].contains(&end.tag());
                let is_there = |end: &Element| {
                    let name = end.nodes.first().map_or("", |node| node.text.as_str());
                    name == "world" || robot.links.iter().any(|link| link.name == name)
                };
                if reference.is_none() && tag == "joint" && !children(&child).iter().filter(is_end).all(is_there) {
                    let why = "it joins a link that the robot does not have";
                    further.lost.push((element.at, format!("{} in {}", child.label(), element.label()), why.into()));
                    continue;
                }
                match (reference, link, joint) {
                    (None, ..) if in_model => further.model.push(child),
                    (Some(_), _, Some(joint)) if in_joint && (link.is_none() || !in_link) => {
                        further.joints.push((&joint.name, child));
                    }
                    (Some(_), Some(link), _) if in_link => further.links.push((&link.name, child)),
                    _ => {
                        let what = format!("<{tag}> in {}", element.label());
                        further.lost.push((element.at, what, "it exists only in URDF's <gazebo>, not in SDF".into()));
                    }
                }
            }
        }
        further
    }

    /// Joints, frames and links inside `<gazebo>` get names that the model has not taken.
    pub fn rename(&mut self, names: &Names) {
        let mut known: HashSet<String> = names.links.iter().chain(&names.joints).cloned().collect();
        for element in &mut self.model {
            let at = element.at;
            let Some(node) = element.nodes.first_mut() else { continue };
            if !["joint", "frame", "link", "model"].contains(&node.tag.as_str()) {
                continue;
            }
            let Some((_, name)) = node.attributes.iter_mut().find(|(name, _)| name == "name") else { continue };
            let wanted = name.clone();
            *name = fresh(&mut known, &wanted);
            if *name != wanted {
                let what = format!("name of {} \"{wanted}\" in gazebo", node.tag);
                let why =
                    format!("names of links, joints and frames must be unique in SDF: it is called \"{name}\" there");
                self.lost.push((at, what, why));
            }
        }
    }

    pub fn on_link(&self, name: &str) -> bool {
        self.links.iter().any(|(link, _)| *link == name)
    }

    /// Elements of the model with these tags; without tags, all others.
    pub fn of_model(&self, tags: &[&str]) -> Vec<String> {
        let first = ["pose", "static"];
        let wanted = |tag: &str| if tags.is_empty() { !first.contains(&tag) } else { tags.contains(&tag) };
        self.model.iter().filter(|element| wanted(element.tag())).map(write::element).collect()
    }

    /// What is in a link, except what is merged into its inertial and shapes.
    pub fn of_link(&self, link: &str, visuals: &[Shape], collisions: &[Shape]) -> Vec<String> {
        let named = |shapes: &[Shape], element: &Element| {
            shapes.iter().any(|shape| shape.name.as_deref() == element.attribute("name"))
        };
        let own = self.links.iter().filter(|(name, _)| *name == link).map(|(_, element)| element);
        let own = own.filter(|element| match element.tag() {
            "inertial" | "pose" => false,
            "visual" => !named(visuals, element),
            "collision" => !named(collisions, element),
            _ => true,
        });
        own.map(write::element).collect()
    }

    /// What is in a joint, except what is merged into its axis.
    pub fn of_joint(&self, joint: &str) -> Vec<String> {
        let own = self.joints.iter().filter(|(name, element)| *name == joint && element.tag() != "axis");
        own.map(|(_, element)| write::element(element)).collect()
    }

    /// What is merged into a part of a link or joint: its inertial, a shape by name, its axis or the limits in that.
    pub fn inside(&self, owner: &str, tag: &str, name: Option<&str>) -> Vec<String> {
        let (place, of_axis) = match tag {
            "axis" | "limit" => (&self.joints, true),
            _ => (&self.links, false),
        };
        let parts = place.iter().filter(|(known, element)| {
            *known == owner
                && element.tag() == if of_axis { "axis" } else { tag }
                && (name.is_none() || element.attribute("name") == name)
        });
        let within = parts.flat_map(|(_, element)| children(element));
        let within: Vec<Element> = match tag {
            "limit" => within.filter(|child| child.tag() == "limit").flat_map(|limit| children(&limit)).collect(),
            "axis" => within.filter(|child| child.tag() != "limit").collect(),
            "visual" | "collision" => within.filter(|child| child.tag() != "geometry").collect(),
            _ => within.collect(),
        };
        within.iter().map(write::element).collect()
    }

    /// What is merged into the mesh of a shape.
    pub fn in_mesh(&self, owner: &str, tag: &str, name: Option<&str>) -> Vec<String> {
        let parts = self
            .links
            .iter()
            .filter(|(known, element)| *known == owner && element.tag() == tag && element.attribute("name") == name);
        let inside = |elements: Vec<Element>, tag: &str| -> Vec<Element> {
            elements.iter().filter(|child| child.tag() == tag).flat_map(children).collect()
        };
        let shapes = inside(parts.flat_map(|(_, element)| children(element)).collect(), "geometry");
        inside(shapes, "mesh").iter().map(write::element).collect()
    }

    /// Namespace prefixes in use.
    pub fn prefixes(&self) -> Vec<String> {
        let placed = self.links.iter().chain(&self.joints).map(|(_, element)| element).chain(&self.model);
        let names = placed.flat_map(|element| &element.nodes).flat_map(|node| {
            std::iter::once(node.tag.as_str()).chain(node.attributes.iter().map(|(name, _)| name.as_str()))
        });
        let found: BTreeSet<&str> = names.filter_map(|name| Some(name.split_once(':')?.0)).collect();
        found.into_iter().filter(|prefix| !["xml", "xmlns"].contains(prefix)).map(str::to_owned).collect()
    }

    /// What SDF cannot state.
    pub fn losses(&mut self, robot: &Robot) -> Vec<Loss> {
        let lost = std::mem::take(&mut self.lost).into_iter();
        lost.map(|(at, what, why)| Loss { place: robot.source.place(at, what.clone()), what, why }).collect()
    }
}
