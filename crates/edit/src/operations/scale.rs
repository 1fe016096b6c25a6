//! Multiplies every length by a factor: for a robot in other units, or of another size.
//!
//! Masses stay; tensors scale with the square of the factor. Values of prismatic joints are lengths, and so are their
//! limits, speeds and mimic values.

use crate::Change;
use crate::claim::{Claim, Compared, Space};
use crate::error::{EditError, refused_at_joint};
use crate::literal::times;
use crate::references;
use crate::tally::Tally;
use crate::values::child;
use denavit_export::urdf::text::{Edits, Nodes, Placing, parse, placing, word};
use denavit_model::posed::{self, Notation};
use denavit_model::robot::{JointKind, Robot, SourceText};
use roxmltree::{Document, Node};
use std::collections::BTreeSet;

/// # Errors
/// An invalid factor, or values of a prismatic joint where they are not understood.
pub(crate) fn scale(robot: &Robot, srdf: Option<&SourceText>, factor: f64) -> Result<Change, EditError> {
    if !(factor.is_finite() && factor > 0.0) {
        return Err(EditError::Words(format!(
            "scale: {factor} is not a factor; write a number above 0, such as 0.001"
        )));
    }
    let document = parse(robot)?;
    let nodes = Nodes::of(robot, &document)?;
    slides_are_understood(robot, &document, srdf)?;
    let mut edits = Edits::default();
    let mut scaled = Scaled { robot, edits: &mut edits, factor };
    let kind = |name: &str| robot.joint_index(name).map(|joint| &robot.joints[joint].kind);
    for (index, joint) in robot.joints.iter().enumerate() {
        let node = nodes.joint(index);
        scaled.origins(node);
        let slides = joint.kind == JointKind::Prismatic;
        if slides {
            for (tag, names) in [
                ("limit", &["lower", "upper", "velocity"][..]),
                ("safety_controller", &["soft_lower_limit", "soft_upper_limit"]),
                ("calibration", &["rising", "falling", "reference_position"]),
            ] {
                if let Some(node) = child(node, tag) {
                    for name in names {
                        scaled.attribute(node, name, factor);
                    }
                }
            }
        }
        if let (Some(mimic), Some(node)) = (&joint.mimic, child(node, "mimic")) {
            let driver_slides = kind(&mimic.joint) == Some(&JointKind::Prismatic);
            let multiplier = match (slides, driver_slides) {
                (true, false) => factor,
                (false, true) => 1.0 / factor,
                _ => 1.0,
            };
            if multiplier != 1.0 {
                let text = times(node.attribute("multiplier").unwrap_or("1"), &[multiplier]);
                scaled.edits.attribute(&robot.source, node, "multiplier", &text);
            }
            if slides {
                scaled.attribute(node, "offset", factor);
            }
        }
        if matches!(joint.kind, JointKind::Screw(_)) {
            let pitch = node.children().find(|child| child.tag_name().name() == "screw_thread_pitch");
            if let Some(pitch) = pitch {
                scaled.attribute(pitch, "value", factor);
            }
        }
    }
    for index in 0..robot.links.len() {
        let Some(node) = nodes.link(index) else { continue };
        for part in node.children().filter(Node::is_element) {
            match part.tag_name().name() {
                "inertial" => {
                    scaled.origins(part);
                    if let Some(inertia) = child(part, "inertia") {
                        for name in ["ixx", "ixy", "ixz", "iyy", "iyz", "izz"] {
                            scaled.attribute(inertia, name, factor * factor);
                        }
                    }
                }
                "visual" | "collision" => {
                    scaled.origins(part);
                    scaled.geometry(part);
                }
                _ => {}
            }
        }
    }
    scaled.others(&document, &nodes);
    let mut tally = Tally::default();
    tally.say(format!("every length times {}", word(factor)));
    let urdf = edits.apply(&robot.source)?;
    let claim = Claim { space: Space { mirrored: None, scale: factor }, compared: Compared::No, ..Claim::same(robot) };
    let notes = vec!["masses, torques and forces stay as they are".into()];
    Ok(Change::of(urdf, srdf, claim, tally, notes))
}

/// Refuses values of prismatic joints outside their own elements, which cannot be scaled.
fn slides_are_understood(robot: &Robot, document: &Document, srdf: Option<&SourceText>) -> Result<(), EditError> {
    for (index, joint) in robot.joints.iter().enumerate().filter(|(_, joint)| joint.kind == JointKind::Prismatic) {
        let name = BTreeSet::from([joint.name.as_str()]);
        let uses = references::uses(document, &BTreeSet::new(), &name);
        let beside = uses.iter().find(|used| {
            used.node.ancestors().any(|above| matches!(above.tag_name().name(), "transmission" | "ros2_control"))
        });
        if beside.is_some() || srdf.is_some_and(|srdf| srdf.text.contains(&format!("\"{}\"", joint.name))) {
            let what = "it is prismatic, and a transmission, ros2_control or the SRDF holds values of it; remove \
                        these first, and add them again";
            return Err(refused_at_joint(robot, index, what));
        }
    }
    Ok(())
}

struct Scaled<'a> {
    robot: &'a Robot,
    edits: &'a mut Edits,
    factor: f64,
}

impl Scaled<'_> {
    fn origins(&mut self, element: Node) {
        for origin in element.children().filter(|node| node.is_element() && node.tag_name().name() == "origin") {
            self.attribute(origin, "xyz", self.factor);
        }
    }

    fn attribute(&mut self, node: Node, name: &str, factor: f64) {
        let Some(written) = node.attribute(name) else { return };
        let text = times(written, &[factor; 3]);
        if text != written {
            self.edits.attribute(&self.robot.source, node, name, &text);
        }
    }

    fn geometry(&mut self, shape: Node) {
        let Some(geometry) = child(shape, "geometry") else { return };
        for part in geometry.children().filter(Node::is_element) {
            for name in ["size", "radius", "length"] {
                self.attribute(part, name, self.factor);
            }
            match (part.tag_name().name(), part.attribute("scale")) {
                ("mesh", None) => {
                    let text = [word(self.factor), word(self.factor), word(self.factor)].join(" ");
                    self.edits.attribute(&self.robot.source, part, "scale", &text);
                }
                ("mesh", Some(_)) => self.attribute(part, "scale", self.factor),
                _ => {}
            }
        }
    }

    fn others(&mut self, document: &Document, nodes: &Nodes) {
        for Placing { element, owner, inside, .. } in placing(self.robot, document, nodes) {
            for posed in posed::in_element(element, owner) {
                let Some(node) = inside.get(posed.node) else { continue };
                match &posed.notation {
                    Notation::Pose { .. } => self.text(*node),
                    Notation::Attributes { .. } => self.attribute(*node, "xyz", self.factor),
                    Notation::Offsets { xyz: Some(xyz), .. } => {
                        if let Some(node) = inside.get(*xyz) {
                            self.text(*node);
                        }
                    }
                    Notation::Text if matches!(posed.placed, posed::Placed::Point(_)) => self.text(*node),
                    Notation::Attribute(name) if matches!(posed.placed, posed::Placed::Point(_)) => {
                        self.attribute(*node, name, self.factor);
                    }
                    _ => {}
                }
            }
        }
    }

    /// The first three numbers of a text.
    fn text(&mut self, node: Node) {
        let Some(inside) = node.children().find(Node::is_text) else { return };
        let written = inside.text().unwrap_or_default();
        let text = times(written, &[self.factor; 3]);
        if text != written {
            self.edits.replace(inside.range(), text);
        }
    }
}
