//! Values of a joint in `<ros2_control>`: initial values, limits of commands, transmissions.
//!
//! Source: <https://control.ros.org/master/doc/ros2_control/hardware_interface/doc/hardware_components_userdoc.html>.

use super::{Sheet, child, mapped, text, transmission};
use crate::claim::JointMap;
use crate::error::EditError;
use roxmltree::Node;

/// Parts of names of parameters that may depend on a joint's zero or sense.
const SUSPECT: [&str; 8] = ["offset", "zero", "home", "sign", "direction", "invert", "reverse", "initial"];

/// # Errors
/// As of transmissions.
pub(super) fn edit(sheet: &mut Sheet, element: Node, name: &str, map: JointMap) -> Result<(), EditError> {
    for part in element.children().filter(Node::is_element) {
        match part.tag_name().name() {
            "transmission" => transmission::edit(sheet, part, name, map)?,
            "joint" if part.attribute("name") == Some(name) => {
                for own in part.children().filter(Node::is_element) {
                    match own.tag_name().name() {
                        "command_interface" | "state_interface" => interface(sheet, own, map),
                        "param" => parameter(sheet, own, name, map),
                        _ => {}
                    }
                }
            }
            _ => {}
        }
    }
    Ok(())
}

/// Positions depend on zero and sense, speeds, accelerations and efforts only on the sense.
fn interface(sheet: &mut Sheet, interface: Node, map: JointMap) {
    let kind = interface.attribute("name").unwrap_or_default();
    let map = match kind.rsplit('/').next().unwrap_or(kind) {
        "position" => map,
        "velocity" | "acceleration" | "effort" | "torque" | "force" => JointMap { shift: 0.0, ..map },
        _ => return,
    };
    let find = |name: &str| {
        let mut parameters = interface.children().filter(|node| node.is_element() && node.tag_name().name() == "param");
        parameters.find(|node| node.attribute("name") == Some(name))
    };
    if find("initial_value").is_some_and(|initial| text(sheet, initial, map)) {
        sheet.tally.count("initial value", "initial values", "rewritten");
    }
    let texts = ["min", "max"].map(|name| find(name).and_then(|node| node.first_child()).filter(Node::is_text));
    let mut ends = texts;
    if map.sense < 0.0 {
        ends.reverse();
        if texts.iter().filter(|end| end.is_some()).count() == 1 {
            let place = sheet.place(interface);
            sheet.notes.push(format!("{place}: only one of min and max is given, now the other bound; correct it"));
            return;
        }
    }
    let mut any = false;
    for (into, from) in texts.into_iter().zip(ends) {
        let (Some(into), Some(from)) = (into, from) else { continue };
        sheet.edits.replace(into.range(), mapped(from.text().unwrap_or_default(), map));
        any = true;
    }
    if any {
        sheet.tally.count("command range", "command ranges", "rewritten");
    }
}

/// Older files state mimic joints and initial positions as parameters.
fn parameter(sheet: &mut Sheet, node: Node, name: &str, map: JointMap) {
    let parameter = node.attribute("name").unwrap_or_default().to_lowercase();
    if parameter == "initial_position" {
        if text(sheet, node, map) {
            sheet.tally.count("initial value", "initial values", "rewritten");
        }
        return;
    }
    let mimics = node.parent().is_some_and(|joint| {
        joint.children().any(|other| other.attribute("name") == Some("mimic") && child(joint, "param").is_some())
    });
    if parameter == "multiplier" && mimics && map.sense < 0.0 {
        text(sheet, node, JointMap { sense: map.sense, shift: 0.0 });
        return;
    }
    if SUSPECT.iter().any(|word| parameter.contains(word)) {
        let place = sheet.place(node);
        sheet.notes.push(format!(
            "{place}: a parameter of joint \"{name}\" that may depend on its zero or sense; it is not changed; check it"
        ));
    }
}
