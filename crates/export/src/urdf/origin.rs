//! The attributes `xyz` and `rpy`, read and written.

use super::edit::Edits;
use super::written::{Numbers, three, three_over, word};
use denavit_model::nalgebra::{Quaternion, UnitQuaternion, Vector3};
use denavit_model::robot::{Origin, SourceText};
use denavit_model::se3;
use denavit_model::tree::Reading;
use roxmltree::Node;

/// Writes numbers into the attributes `xyz` and `rpy`, which were read as `old`; values equal to rounding keep their text.
pub(crate) fn write(
    source: &SourceText,
    edits: &mut Edits,
    node: Node,
    (old, numbers): (&Numbers, &Numbers),
    scale: f64,
) {
    write_xyz(source, edits, node, numbers.xyz, scale);
    let back = se3::rotation_from_rpy(old.rpy).inverse() * se3::rotation_from_rpy(numbers.rpy);
    if se3::rotation_angle(&back) > 4.0 * f64::EPSILON {
        write_rpy(source, edits, node, numbers.rpy, 1.0);
    }
}

/// The rotation in the notation that the element has: `quat_xyzw` of URDF 1.1, or `rpy`.
fn write_rpy(source: &SourceText, edits: &mut Edits, node: Node, rpy: [f64; 3], scale: f64) {
    if node.has_attribute("quat_xyzw") {
        let turn = se3::rotation_from_rpy(rpy);
        let stays = numbers_of(node).is_some_and(|old| {
            let back = se3::rotation_from_rpy(old.rpy).inverse() * turn;
            se3::rotation_angle(&back) <= 8.0 * f64::EPSILON
        });
        if !stays {
            let text = se3::quaternion_xyzw(&turn).map(word).join(" ");
            edits.attribute(source, node, "quat_xyzw", &text);
        }
        return;
    }
    let written = node.attribute("rpy");
    let text = written.map_or_else(|| three(rpy), |written| three_over(written, rpy, scale));
    if (written.is_some() || rpy != [0.0; 3]) && Some(text.as_str()) != written {
        edits.attribute(source, node, "rpy", &text);
    }
}

pub(crate) fn write_xyz(source: &SourceText, edits: &mut Edits, node: Node, xyz: [f64; 3], scale: f64) {
    let written = node.attribute("xyz");
    let text = written.map_or_else(|| three(xyz), |written| three_over(written, xyz, scale));
    if (written.is_some() || xyz != [0.0; 3]) && Some(text.as_str()) != written {
        edits.attribute(source, node, "xyz", &text);
    }
}

/// Writes a joint's origin, added if missing; text that already is exactly these numbers stays.
pub fn joint_origin(source: &SourceText, edits: &mut Edits, joint: Node, numbers: &Numbers) {
    match joint.children().find(|child| is(child, "origin")) {
        // Values equal to rounding keep their text: exporting an export changes nothing.
        Some(origin) if numbers_of(origin).is_some_and(|old| same_to_rounding(&old, numbers)) => {}
        Some(origin) => {
            write_xyz(source, edits, origin, numbers.xyz, 0.0);
            write_rpy(source, edits, origin, numbers.rpy, 0.0);
        }
        None if *numbers == Numbers::default() => {}
        None => edits.first_child(source, joint, &numbers.element()),
    }
}

/// Whether two origins are alike to the rounding of the products that lead to them.
fn same_to_rounding(one: &Numbers, other: &Numbers) -> bool {
    const ROUNDING: f64 = 16.0 * f64::EPSILON;
    let (a, b) = (Vector3::from(one.xyz), Vector3::from(other.xyz));
    let back = se3::rotation_from_rpy(one.rpy).inverse() * se3::rotation_from_rpy(other.rpy);
    (a - b).amax() <= ROUNDING * (1.0 + a.amax()) && se3::rotation_angle(&back) <= ROUNDING
}

/// A joint's axis as intended, if it differs from the written one.
pub(crate) fn axis_as_meant(source: &SourceText, edits: &mut Edits, joint: Node, axis: [f64; 3]) {
    let found = joint.children().find(|child| is(child, "axis"));
    let written = found.and_then(|axis| several_of::<3>(axis.attribute("xyz")?));
    let stays = written.is_none_or(|written| {
        let length = Vector3::from(written).norm();
        (Vector3::from(written) / length - Vector3::from(axis)).norm() <= 4.0 * f64::EPSILON
    });
    if let (Some(found), false) = (found, stays) {
        edits.attribute(source, found, "xyz", &three(axis));
    }
}

/// A joint's axis as z.
pub(crate) fn joint_axis(source: &SourceText, edits: &mut Edits, joint: Node) {
    const Z: [f64; 3] = [0.0, 0.0, 1.0];
    match joint.children().find(|child| is(child, "axis")) {
        Some(axis) => {
            let written = axis.attribute("xyz");
            if written.and_then(several_of) != Some(Z) {
                edits.attribute(source, axis, "xyz", "0 0 1");
            }
        }
        None => edits.behind_origin(source, joint, "<axis xyz=\"0 0 1\"/>"),
    }
}

pub(crate) fn is(node: &Node, tag: &str) -> bool {
    node.is_element() && node.tag_name().name() == tag
}

fn several_of<const N: usize>(value: &str) -> Option<[f64; N]> {
    let words = value.split(|c: char| c.is_whitespace() || c == ',').filter(|word| !word.is_empty());
    let numbers: Option<Vec<f64>> = words.map(|word| word.parse().ok()).collect();
    numbers?.try_into().ok()
}

/// As [`numbers_of`], angles as written or as intended.
pub(crate) fn numbers_as(node: Node, reading: Reading) -> Option<Numbers> {
    let Numbers { xyz, rpy } = numbers_of(node)?;
    let words = node.attribute("rpy").map(|written| written.split_whitespace().map(str::to_owned).collect());
    let rpy_written = words.and_then(|words: Vec<String>| words.try_into().ok());
    let read = Origin { xyz, rpy, rpy_written, quat_written: None }.read(reading);
    Some(Numbers { xyz, rpy: read.rpy })
}

/// The attributes `xyz` and `rpy` or `quat_xyzw`, 0 where missing; `None` if they are not numbers.
pub fn numbers_of(node: Node) -> Option<Numbers> {
    let three = |name| node.attribute(name).map_or(Some([0.0; 3]), several_of);
    let rpy = match node.attribute("quat_xyzw") {
        Some(written) => {
            let [x, y, z, w] = several_of(written)?;
            let turn = UnitQuaternion::try_new(Quaternion::new(w, x, y, z), f64::MIN_POSITIVE)?;
            se3::written_rpy(&turn.to_rotation_matrix())
        }
        None => three("rpy")?,
    };
    Some(Numbers { xyz: three("xyz")?, rpy })
}
