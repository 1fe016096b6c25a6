//! Transmissions: joint = actuator / reduction + offset.
//!
//! Source: ROS's `transmission_interface`, `simple_transmission.h`, `differential_transmission.h`,
//! `four_bar_linkage_transmission.h`: reduction and offset of each joint are in its `<joint>`, those of the actuator of
//! a simple transmission in `<actuator>`.

use super::{Sheet, child, text};
use crate::claim::JointMap;
use crate::error::EditError;
use denavit_export::urdf::text::word;
use roxmltree::Node;

/// As ROS 1 and as ros2_control write it.
const REDUCTIONS: [&str; 2] = ["mechanicalReduction", "mechanical_reduction"];

/// Updates a `<transmission>` of the joint, wherever it is.
///
/// # Errors
/// A coupling of several joints that cannot express the reversed sense.
pub(super) fn edit(sheet: &mut Sheet, element: Node, name: &str, map: JointMap) -> Result<(), EditError> {
    let is_joint = |node: &Node| node.is_element() && node.tag_name().name() == "joint";
    let joints: Vec<Node> = element.children().filter(is_joint).collect();
    let Some(place) = joints.iter().position(|joint| joint.attribute("name") == Some(name)) else {
        let within = element.descendants().filter(Node::is_element).skip(1);
        let others =
            within.filter(|node| node.attribute("name") == Some(name) && node.tag_name().name().contains("joint"));
        return match others.count() {
            0 => Ok(()),
            _ => refuse(sheet, element, name),
        };
    };
    let joint = joints[place];
    let kind = kind(element);
    if map.sense < 0.0 {
        sense(sheet, element, (joint, place, joints.len()), &kind, name)?;
    }
    if map.shift != 0.0 || child(joint, "offset").is_some() {
        match child(joint, "offset") {
            // A missing offset means 0.
            Some(offset) if map.shift != 0.0 && stated(offset).is_some_and(|old| map.of(old) == 0.0) => {
                sheet.edits.remove(sheet.source, offset);
            }
            Some(offset) => {
                text(sheet, offset, map);
            }
            None if is_old(element) => {
                let place = sheet.place(element);
                sheet.notes.push(format!(
                    "{place}: this kind of transmission has no offset; the actuator's zero does not follow that of \
                     joint \"{name}\""
                ));
                return Ok(());
            }
            None => {
                let offset = format!("<offset>{}</offset>", word(map.shift));
                sheet.edits.lines_at_end(sheet.source, joint, &[offset]);
            }
        }
    }
    sheet.tally.count("transmission", "transmissions", "updated");
    Ok(())
}

fn stated(node: Node) -> Option<f64> {
    node.text()?.trim().parse().ok()
}

fn kind(element: Node) -> String {
    let written = child(element, "type").or_else(|| child(element, "plugin")).and_then(|node| node.text());
    written.or_else(|| element.attribute("type")).unwrap_or_default().trim().to_owned()
}

/// The form of ROS 1, with everything in attributes and the reduction next to the joint.
fn is_old(element: Node) -> bool {
    element.has_attribute("type") && child(element, "type").is_none()
}

fn sense(
    sheet: &mut Sheet,
    element: Node,
    (joint, place, count): (Node, usize, usize),
    kind: &str,
    name: &str,
) -> Result<(), EditError> {
    let reduction = |node: &Node| node.is_element() && REDUCTIONS.contains(&node.tag_name().name());
    let own = joint.children().find(reduction);
    if count > 1 {
        let coupled = kind.contains("Differential") || kind.contains("FourBar") && place > 0;
        if !coupled {
            return refuse(sheet, element, name);
        }
        match own {
            Some(own) => {
                text(sheet, own, JointMap { sense: -1.0, shift: 0.0 });
            }
            None => add(sheet, element, joint),
        }
        return Ok(());
    }
    let all: Vec<Node> = element.descendants().filter(reduction).collect();
    match all[..] {
        [only] => {
            if !text(sheet, only, JointMap { sense: -1.0, shift: 0.0 }) {
                return refuse(sheet, element, name);
            }
        }
        [] => {
            let actuators: Vec<Node> =
                element.children().filter(|node| node.is_element() && node.tag_name().name() == "actuator").collect();
            match actuators[..] {
                // ros2_control reads it in the joint.
                [] | [_] if is_ros2(element) => add(sheet, element, joint),
                [actuator] => add(sheet, element, actuator),
                _ => return refuse(sheet, element, name),
            }
        }
        // A simple one is read in its actuator, or in ros2_control in its joint.
        [..] => {
            match own.filter(|_| is_ros2(element)).or_else(|| all.iter().copied().find(|node| is_in_actuator(*node))) {
                Some(read) => {
                    text(sheet, read, JointMap { sense: -1.0, shift: 0.0 });
                }
                None => return refuse(sheet, element, name),
            }
        }
    }
    Ok(())
}

fn is_ros2(element: Node) -> bool {
    element.ancestors().any(|above| above.tag_name().name() == "ros2_control")
}

fn is_in_actuator(node: Node) -> bool {
    node.parent().is_some_and(|above| above.tag_name().name() == "actuator")
}

fn add(sheet: &mut Sheet, element: Node, into: Node) {
    let tag = REDUCTIONS[usize::from(is_ros2(element))];
    sheet.edits.lines_at_end(sheet.source, into, &[format!("<{tag}>-1</{tag}>")]);
}

fn refuse(sheet: &Sheet, element: Node, name: &str) -> Result<(), EditError> {
    let what = format!(
        "it couples joint \"{name}\" in a way that cannot express the change; remove the transmission, edit, and add \
         it again"
    );
    Err(EditError::Refused { place: sheet.place(element), what })
}
