//! Updates everything that states a value of a joint after a change of its values: new = sense · old + shift.
//!
//! Limits, soft limits and calibration positions of the joint; mimic joints on both sides; transmissions; initial values and
//! limits in ros2_control; springs and initial positions for Gazebo; states in an SRDF.

mod control;
mod srdf;
mod transmission;

use crate::claim::JointMap;
use crate::error::EditError;
use crate::literal::{negated, sum};
use crate::tally::Tally;
use denavit_export::urdf::text::{Edits, Nodes, word};
use denavit_model::robot::{Robot, SourceText};
use roxmltree::{Document, Node};

pub(crate) use srdf::edit as in_srdf;

/// A text under edit.
pub(crate) struct Sheet<'a, 'input> {
    pub source: &'a SourceText,
    pub edits: &'a mut Edits,
    pub tally: &'a mut Tally,
    pub notes: &'a mut Vec<String>,
    pub document: &'a Document<'input>,
}

impl Sheet<'_, '_> {
    /// The place of a node, for messages.
    pub fn place(&self, node: Node) -> denavit_model::notes::Place {
        let tag = node.tag_name().name();
        let label = node.attribute("name").map_or_else(|| format!("<{tag}>"), |name| format!("{tag} \"{name}\""));
        self.source.place(node.range().start, label)
    }
}

/// A literal after the edit; non-numbers stay.
pub(crate) fn mapped(literal: &str, map: JointMap) -> String {
    if map.shift == 0.0 {
        return if map.sense < 0.0 { negated(literal) } else { literal.to_owned() };
    }
    match literal.trim().parse::<f64>() {
        Ok(value) if value.is_finite() => word(sum(&[map.sense * value, map.shift])),
        _ if map.sense < 0.0 => negated(literal),
        _ => literal.to_owned(),
    }
}

pub(crate) fn child<'a, 'input>(node: Node<'a, 'input>, tag: &str) -> Option<Node<'a, 'input>> {
    node.children().find(|child| child.is_element() && child.tag_name().name() == tag)
}

/// Rewrites every value of joint `index` in the URDF.
///
/// # Errors
/// A transmission whose coupling cannot express it.
pub(crate) fn edit(
    robot: &Robot,
    nodes: &Nodes,
    sheet: &mut Sheet,
    index: usize,
    map: JointMap,
) -> Result<(), EditError> {
    let node = nodes.joint(index);
    let name = &robot.joints[index].name;
    if child(node, "limit").is_some_and(|limit| range(sheet, limit, ["lower", "upper"], map)) {
        sheet.tally.count("limit", "limits", verb(map));
    }
    let soft = ["soft_lower_limit", "soft_upper_limit"];
    if child(node, "safety_controller").is_some_and(|safety| range(sheet, safety, soft, map)) {
        sheet.tally.count("soft limit", "soft limits", verb(map));
    }
    if let Some(calibration) = child(node, "calibration") {
        calibration_positions(sheet, calibration, map);
    }
    mimics(robot, nodes, sheet, index, map);
    let own = sheet.document.root_element().children().filter(Node::is_element);
    for element in own {
        match element.tag_name().name() {
            "transmission" => transmission::edit(sheet, element, name, map)?,
            "ros2_control" => control::edit(sheet, element, name, map)?,
            "gazebo" => in_gazebo(sheet, element, name, map),
            _ => {}
        }
    }
    Ok(())
}

fn verb(map: JointMap) -> &'static str {
    if map.sense < 0.0 { "exchanged" } else { "shifted" }
}

/// Rewrites both ends of a range in attributes; a missing end is URDF's 0. Returns whether there was a range.
fn range(sheet: &mut Sheet, node: Node, names: [&str; 2], map: JointMap) -> bool {
    let written = names.map(|name| node.attribute(name));
    if written == [None, None] {
        return false;
    }
    let [lower, upper] = written.map(|end| mapped(end.unwrap_or("0"), map));
    let (lower, upper) = if map.sense < 0.0 { (upper, lower) } else { (lower, upper) };
    for (name, value) in names.into_iter().zip([lower, upper]) {
        if node.attribute(name) != Some(value.as_str()) {
            sheet.edits.attribute(sheet.source, node, name, &value);
        }
    }
    true
}

/// A reversed joint meets the falling edge where it met the rising one.
fn calibration_positions(sheet: &mut Sheet, node: Node, map: JointMap) {
    let mut any = false;
    for attribute in node.attributes() {
        let other = match attribute.name() {
            "rising" => "falling",
            "falling" => "rising",
            "reference_position" => "reference_position",
            _ => continue,
        };
        any = true;
        sheet.edits.replace(attribute.range_value(), mapped(attribute.value(), map));
        if map.sense < 0.0 && other != attribute.name() {
            sheet.edits.replace(attribute.range_qname(), other);
        }
    }
    if any {
        sheet.tally.count("calibration position", "calibration positions", "rewritten");
    }
}

/// Updates factor and offset of the joint as a follower, and of the joints that follow it.
fn mimics(robot: &Robot, nodes: &Nodes, sheet: &mut Sheet, index: usize, map: JointMap) {
    let name = &robot.joints[index].name;
    for (other, joint) in robot.joints.iter().enumerate() {
        let Some(mimic) = &joint.mimic else { continue };
        let Some(node) = child(nodes.joint(other), "mimic") else { continue };
        let (mut factor, mut offset) = (node.attribute("multiplier"), node.attribute("offset"));
        let (mut factor_value, mut offset_value) = (mimic.multiplier, mimic.offset);
        let (mut factor_text, mut offset_text);
        let mut changed = false;
        // q_follower = m s q_driver' - m s shift + o
        if mimic.joint == *name {
            factor_value *= map.sense;
            offset_value = sum(&[offset_value, -(factor_value * map.shift)]);
            if map.sense < 0.0 {
                factor_text = negated(factor.unwrap_or("1"));
                factor = Some(&factor_text);
            }
            if map.shift != 0.0 {
                offset_text = word(offset_value);
                offset = Some(&offset_text);
            }
            changed = true;
        }
        // q' = s (m d + o) + shift
        if other == index {
            offset_value = sum(&[map.sense * offset_value, map.shift]);
            let own_factor = factor.unwrap_or("1").to_owned();
            if map.sense < 0.0 {
                factor_text = negated(&own_factor);
                factor = Some(&factor_text);
            }
            if map.shift != 0.0 {
                offset_text = word(offset_value);
                offset = Some(&offset_text);
            } else if let (Some(written), true) = (offset, map.sense < 0.0) {
                offset_text = negated(written);
                offset = Some(&offset_text);
            }
            changed = true;
        }
        if changed {
            for (attribute, value) in [("multiplier", factor), ("offset", offset)] {
                if let Some(value) = value.filter(|value| node.attribute(attribute) != Some(value)) {
                    sheet.edits.attribute(sheet.source, node, attribute, value);
                }
            }
            sheet.tally.count("mimic joint", "mimic joints", "updated");
        }
    }
}

/// Words for a value of the joint in Gazebo's extensions.
const GAZEBO_VALUES: [&str; 4] = ["springReference", "spring_reference", "initial_position", "initialPosition"];

fn in_gazebo(sheet: &mut Sheet, element: Node, name: &str, map: JointMap) {
    let is_own = element.attribute("reference") == Some(name);
    let mut named = Vec::new();
    for node in element.descendants().filter(Node::is_element) {
        let tag = node.tag_name().name();
        if is_own && GAZEBO_VALUES.contains(&tag) && text(sheet, node, map) {
            sheet.tally.count("value for Gazebo", "values for Gazebo", "rewritten");
        } else if node.first_element_child().is_none() && node.text().map(str::trim) == Some(name) {
            named.push(tag.to_owned());
        }
    }
    if let Some(tag) = named.first() {
        let place = sheet.place(element);
        sheet.notes.push(format!(
            "{place}: a plugin names joint \"{name}\" in <{tag}>; the joint values in it are not changed; check them"
        ));
    }
}

/// Rewrites the number in a node's text; returns whether there was one.
fn text(sheet: &mut Sheet, node: Node, map: JointMap) -> bool {
    let Some(inside) = node.first_child().filter(Node::is_text) else { return false };
    let written = inside.text().unwrap_or_default();
    if written.trim().parse::<f64>().is_err() {
        return false;
    }
    let value = mapped(written, map);
    if value != written {
        sheet.edits.replace(inside.range(), value);
    }
    true
}
