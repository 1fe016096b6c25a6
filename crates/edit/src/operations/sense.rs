//! Changes the sense or the zero of a joint: the same motion with other joint values.

use crate::claim::{Claim, Compared, JointMap};
use crate::error::{self, EditError};
use crate::literal::negated_where;
use crate::tally::Tally;
use crate::values::{self, Sheet, child};
use crate::{Change, operations};
use denavit_export::urdf::text::{Edits, Nodes, Numbers, joint_origin, parse, word};
use denavit_model::nalgebra::Point3;
use denavit_model::robot::{JointKind, Robot, SourceText};
use denavit_model::screw::{AxisLine, Screw};

/// Reverses the sense of a joint: its axis is reversed, and all its values change sign.
///
/// # Errors
/// No such joint, a joint without a single value, or a transmission that cannot express it.
pub(crate) fn flip(robot: &Robot, srdf: Option<&SourceText>, name: &str) -> Result<Change, EditError> {
    let index = one_value(robot, name, "reversed")?;
    let (mut edits, mut tally, mut notes) = (Edits::default(), Tally::default(), Vec::new());
    let document = parse(robot)?;
    let nodes = Nodes::of(robot, &document)?;
    let node = nodes.joint(index);
    match child(node, "axis").and_then(|axis| Some((axis, axis.attribute("xyz")?))) {
        Some((axis, written)) => edits.attribute(&robot.source, axis, "xyz", &negated_where(written, &[true; 3])),
        // URDF's axis where none is stated is 1 0 0.
        None => match child(node, "axis") {
            Some(axis) => edits.attribute(&robot.source, axis, "xyz", "-1 0 0"),
            None => edits.behind_origin(&robot.source, node, "<axis xyz=\"-1 0 0\"/>"),
        },
    }
    tally.say(format!("{name} reversed"));
    let map = JointMap { sense: -1.0, shift: 0.0 };
    let mut sheet =
        Sheet { source: &robot.source, edits: &mut edits, tally: &mut tally, notes: &mut notes, document: &document };
    values::edit(robot, &nodes, &mut sheet, index, map)?;
    let urdf = edits.apply(&robot.source)?;
    change(robot, srdf, name, map, (urdf, tally, notes))
}

/// Moves the zero of a joint to its old value `zero`, which goes into its origin.
///
/// # Errors
/// As of [`flip`].
pub(crate) fn zero(robot: &Robot, srdf: Option<&SourceText>, name: &str, zero: f64) -> Result<Change, EditError> {
    let index = one_value(robot, name, "given another zero")?;
    let (mut edits, mut tally, mut notes) = (Edits::default(), Tally::default(), Vec::new());
    let document = parse(robot)?;
    let nodes = Nodes::of(robot, &document)?;
    let joint = &robot.joints[index];
    let line = AxisLine { direction: joint.axis, point: Point3::origin() };
    let screw = match joint.kind {
        JointKind::Prismatic => Screw::Prismatic(joint.axis),
        JointKind::Screw(pitch) => Screw::Helical { axis: line, pitch },
        _ => Screw::Revolute(line),
    };
    let moved = joint.origin.pose() * screw.motion(zero);
    let scale = joint.origin.xyz.iter().fold(0.0, |a: f64, b| a.max(b.abs())).max(zero.abs());
    joint_origin(&robot.source, &mut edits, nodes.joint(index), &Numbers::of(&moved, scale));
    tally.say(format!("{name} reads 0 where it read {}", word(zero)));
    let map = JointMap { sense: 1.0, shift: -zero };
    let mut sheet =
        Sheet { source: &robot.source, edits: &mut edits, tally: &mut tally, notes: &mut notes, document: &document };
    values::edit(robot, &nodes, &mut sheet, index, map)?;
    let urdf = edits.apply(&robot.source)?;
    change(robot, srdf, name, map, (urdf, tally, notes))
}

fn one_value(robot: &Robot, name: &str, done: &str) -> Result<usize, EditError> {
    let index = error::joint(robot, name)?;
    let joint = &robot.joints[index];
    if joint.kind.has_one_value() {
        return Ok(index);
    }
    let what = format!("a {} joint has no single value, so it cannot be {done}", joint.kind.word());
    Err(error::refused_at_joint(robot, index, what))
}

fn change(
    robot: &Robot,
    srdf: Option<&SourceText>,
    name: &str,
    map: JointMap,
    (urdf, mut tally, mut notes): (String, Tally, Vec<String>),
) -> Result<Change, EditError> {
    let mut claim = Claim { compared: Compared::UpToZeros, ..Claim::same(robot) };
    if let Some(kept) = claim.joints.get_mut(name) {
        kept.map = map;
    }
    let srdf = match srdf {
        Some(source) => {
            let document = operations::parse_srdf(source)?;
            let mut edits = Edits::default();
            let mut sheet =
                Sheet { source, edits: &mut edits, tally: &mut tally, notes: &mut notes, document: &document };
            values::in_srdf(&mut sheet, name, map);
            Some(edits.apply(source)?)
        }
        None => None,
    };
    Ok(Change { urdf, srdf, claim, second: None, files: Vec::new(), tally, notes })
}
