//! Angles that are written in degrees.

use crate::lint::finding::Found;
use crate::lint::sheet::words;
use crate::lint::{Rule, Sheet};
use crate::report::Level;
use denavit_model::JointKind;
use denavit_model::formats::Format;
use denavit_model::robot::Joint;
use roxmltree::Node;
use std::f64::consts::TAU;

pub(super) const RULE: Rule = Rule {
    code: "D017",
    name: "degrees",
    level: Level::Warning,
    summary: "An angle exceeds one turn and is a round number: it is in degrees, but URDF uses radians",
    why: "`rpy=\"90 0 0\"` turns by 90 rad, which is 14.3 turns and ends at 116.6°; limits of ±180 allow 57 turns. \
          Write radians. There is no automatic fix, because other programs read these numbers as radians, too.",
    bad: "<link name=\"base\"/>\n<link name=\"arm\"/>\n<joint name=\"j\" type=\"revolute\">\n  <origin rpy=\"90 0 0\"/>\n  <axis xyz=\"0 0 1\"/>\n  <limit lower=\"-170\" upper=\"170\" effort=\"10\" velocity=\"90\"/>\n  <parent link=\"base\"/>\n  <child link=\"arm\"/>\n</joint>",
    good: "<link name=\"base\"/>\n<link name=\"arm\"/>\n<joint name=\"j\" type=\"revolute\">\n  <origin rpy=\"1.5707963267948966 0 0\"/>\n  <axis xyz=\"0 0 1\"/>\n  <limit lower=\"-2.96706\" upper=\"2.96706\" effort=\"10\" velocity=\"1.5708\"/>\n  <parent link=\"base\"/>\n  <child link=\"arm\"/>\n</joint>",
    fixable: false,
    check,
};

/// Largest plausible angle in degrees: two turns.
const MOST_DEGREES: f64 = 2.0 * 360.0;

/// Beyond a turn in radians, and a multiple of half a degree.
fn is_round(value: f64) -> bool {
    let size = value.abs();
    size > TAU + 1e-3 && size <= MOST_DEGREES && (2.0 * size).fract() == 0.0
}

/// 10, 100: more often "no limit" than degrees.
fn is_power_of_ten(value: f64) -> bool {
    [10.0, 100.0].contains(&value.abs())
}

fn check(sheet: &Sheet) -> Vec<Found> {
    let mut found = Vec::new();
    // An MJCF states its unit, and has a separate rule.
    if sheet.format() == Format::Mjcf {
        return found;
    }
    // A robot of which one joint is in degrees is in degrees.
    let surely = sheet.joints().iter().any(|joint| range_in_degrees(joint, false));
    for joint in sheet.joints() {
        found.extend(limits(sheet, joint, surely));
        found.extend(soft_limits(sheet, joint, surely));
        found.extend(offset(sheet, joint));
    }
    for node in sheet.elements() {
        found.extend(rpy(node));
    }
    found
}

fn turns(joint: &Joint) -> bool {
    matches!(joint.kind, JointKind::Revolute | JointKind::Continuous | JointKind::Screw(_))
}

/// Joints may make two turns, or stop after 12 rad; larger limits are not radians.
const SMALLEST_RANGE: f64 = 15.0;

/// Whether a range is in degrees: some of it is round and beyond a turn. `surely`: the robot's others are.
fn is_range(lower: f64, upper: f64, surely: bool) -> bool {
    let is_degrees = |bound: f64| {
        let alone = bound.abs() >= SMALLEST_RANGE && !is_power_of_ten(bound);
        is_round(bound) && (surely || alone)
    };
    lower.abs().max(upper.abs()) <= MOST_DEGREES && (is_degrees(lower) || is_degrees(upper))
}

/// A bound in radians; a bound that is not a round number already is in radians.
fn in_radians(bound: f64) -> f64 {
    if (2.0 * bound).fract() == 0.0 { bound.to_radians() } else { bound }
}

fn range_in_degrees(joint: &Joint, surely: bool) -> bool {
    turns(joint) && joint.limits.range.is_some_and(|(lower, upper)| is_range(lower, upper, surely))
}

fn limits(sheet: &Sheet, joint: &Joint, surely: bool) -> Option<Found> {
    let at = sheet.below(joint.at, &["limit"]);
    let range = joint.limits.range.filter(|_| range_in_degrees(joint, surely));
    let speed =
        joint.limits.velocity.filter(|speed| turns(joint) && speed_in_degrees(joint, *speed, range.is_some(), surely));
    let mut parts = Vec::new();
    if let Some((lower, upper)) = range {
        let (low, high) = (in_radians(lower), in_radians(upper));
        parts.push(format!("lower {lower} and upper {upper} look like degrees; write {low} and {high}"));
    }
    if let Some(speed) = speed {
        let per_second = speed.to_radians();
        parts.push(format!("velocity {speed} looks like degrees per second; write {per_second}"));
    }
    let what = format!("<limit> uses radians: {}", parts.join("; "));
    (!parts.is_empty()).then(|| Found::at(at, format!("joint \"{}\"", joint.name), what))
}

/// Speeds of 10 to 50 rad/s are real, and 100, 200, 500 stand for "no limit" in many files.
fn speed_in_degrees(joint: &Joint, speed: f64, with_range: bool, surely: bool) -> bool {
    const SLOWEST: f64 = 60.0;
    let for_no_limit = [100.0, 200.0, 500.0].contains(&speed);
    let plain = is_round(speed) && speed >= SLOWEST && speed % 5.0 == 0.0 && !for_no_limit;
    // A wheel may make 60 rad/s.
    let alone = plain && joint.kind == JointKind::Revolute;
    alone || ((with_range || surely) && is_round(speed))
}

fn soft_limits(sheet: &Sheet, joint: &Joint, surely: bool) -> Option<Found> {
    let (lower, upper) = joint.soft_limits()?.range?;
    if !turns(joint) || !is_range(lower, upper, surely) {
        return None;
    }
    let at = sheet.below(joint.at, &["safety_controller"]);
    let (low, high) = (in_radians(lower), in_radians(upper));
    let what = format!(
        "<safety_controller> uses radians: soft limits {lower} and {upper} are round numbers of degrees; write {low} \
         and {high}"
    );
    Some(Found::at(at, format!("joint \"{}\"", joint.name), what))
}

fn offset(sheet: &Sheet, joint: &Joint) -> Option<Found> {
    let offset = joint.mimic.as_ref().map(|mimic| mimic.offset)?;
    if !turns(joint) || !is_round(offset) {
        return None;
    }
    let at = sheet.below(joint.at, &["mimic"]);
    let radians = offset.to_radians();
    let what = format!("<mimic> uses radians: offset {offset} is a round number of degrees; write {radians}");
    Some(Found::at(at, format!("joint \"{}\"", joint.name), what))
}

/// The angles of any `rpy`, and of a `<pose>` that does not say that it is in degrees.
fn rpy(node: Node) -> Option<Found> {
    let (name, written, first) = match node.attribute("rpy") {
        Some(written) => ("rpy", written, 0),
        None if node.tag_name().name() == "pose" && !node.has_attribute("degrees") => {
            ("pose", node.text().filter(|_| !node.has_attribute("rotation_format"))?, 3)
        }
        None => return None,
    };
    let values: Option<Vec<f64>> = words(written).map(|(_, word)| word.parse().ok()).collect();
    let values = values.filter(|values| values.len() == first + 3)?;
    let angles = &values[first..];
    if !angles.iter().any(|angle| is_round(*angle)) {
        return None;
    }
    let radians: Vec<String> = angles.iter().map(|angle| in_radians(*angle).to_string()).collect();
    let shown: Vec<String> = angles.iter().map(f64::to_string).collect();
    let what = format!("{name} uses radians: {} looks like degrees; write {}", shown.join(" "), radians.join(" "));
    Some(Found::at(node.range().start, super::owner(node), what))
}
