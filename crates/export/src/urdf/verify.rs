//! Whether two robots are equal: every shape, centre of mass and tensor at joint values that move all joints.

use super::ExportError;
use super::bodies::Bodies;
use denavit_model::nalgebra::Point3;
use denavit_model::robot::{Joint, JointKind, Link, Origin, Robot};
use denavit_model::screw::{AxisLine, Screw};
use denavit_model::se3::{self, Pose};
use denavit_model::tree::Reading;
use denavit_model::urdf;
use std::collections::HashMap;

/// Allowed deviation of shapes, relative to the robot's size and in rad.
const SAME: f64 = 1e-11;

/// `stays`: the links whose frames must not move.
///
/// # Errors
/// The text is not a URDF, or its robot differs.
pub(crate) fn same_robot(robot: &Robot, bodies: &Bodies, text: &str, stays: &[bool]) -> Result<(), ExportError> {
    let made = urdf::read(&robot.source.file, text)?;
    let made_bodies = Bodies::of(&made, Reading::AsWritten);
    let twins: HashMap<&str, usize> =
        made.links.iter().enumerate().map(|(index, link)| (link.name.as_str(), index)).collect();
    let unfaithful = |what: String| ExportError::Unfaithful { file: robot.source.file.clone(), what };
    for seed in [0.0, 1.0] {
        let value =
            |joint: &Joint| seed * (joint.name.bytes().fold(0.0, |sum, byte| 0.7 * sum + f64::from(byte))).sin();
        let (before, after) = (poses(robot, bodies, &value), poses(&made, &made_bodies, &value));
        for (link, pose) in robot.links.iter().zip(&before) {
            let twin =
                *twins.get(link.name.as_str()).ok_or_else(|| unfaithful(format!("link \"{}\" is lost", link.name)))?;
            if let Some(part) = moved_part((link, pose), (&made.links[twin], &after[twin]), bodies.size, bodies.reading)
            {
                let what = format!("the {part} of link \"{}\" would move", link.name);
                return Err(if is_hidden_from_edits(robot) { unfaithful(what) } else { inexact(robot, what) });
            }
        }
        for (index, link) in robot.links.iter().enumerate().filter(|(index, _)| stays[*index]) {
            let (turned, moved) = se3::difference(&before[index], &after[twins[link.name.as_str()]]);
            if turned > SAME || moved > SAME * bodies.size {
                let what =
                    format!("the frame of link \"{}\" would move by {moved:.1e} m and {turned:.1e} rad", link.name);
                return Err(inexact(robot, what));
            }
        }
    }
    Ok(())
}

/// Whether a part of the text may be out of reach of edits: in an XML entity, or in a second `<inertial>`.
fn is_hidden_from_edits(robot: &Robot) -> bool {
    let text = &robot.source.text;
    let links = robot.links.iter().filter(|link| link.inertial.is_some()).count();
    text.contains("<!ENTITY") || text.matches("<inertial").count() > links
}

fn inexact(robot: &Robot, what: String) -> ExportError {
    ExportError::Inexact { file: robot.source.file.clone(), what }
}

/// root_from_link at the joint values that `value` gives; joints with several values are at zero.
pub(crate) fn poses(robot: &Robot, bodies: &Bodies, value: &dyn Fn(&Joint) -> f64) -> Vec<Pose> {
    let mut poses = vec![Pose::identity(); robot.links.len()];
    for link in &bodies.order {
        let Some(index) = bodies.to_parent[*link] else { continue };
        let joint = &robot.joints[index];
        let line = AxisLine { direction: bodies.axes[index], point: Point3::origin() };
        let motion = match &joint.kind {
            JointKind::Revolute | JointKind::Continuous => Screw::Revolute(line).motion(value(joint)),
            JointKind::Prismatic => Screw::Prismatic(bodies.axes[index]).motion(value(joint)),
            JointKind::Screw(pitch) => Screw::Helical { axis: line, pitch: *pitch }.motion(value(joint)),
            _ => Pose::identity(),
        };
        poses[*link] = poses[joint.parent] * bodies.origins[index].pose() * motion;
    }
    poses
}

fn moved_part(
    (link, pose): (&Link, &Pose),
    (twin, twin_pose): (&Link, &Pose),
    size: f64,
    reading: Reading,
) -> Option<String> {
    let same = |one: &Origin, other: &Origin| {
        let (one, other) = (one.read(reading).pose(), other.read(reading).pose());
        let (turned, moved) = se3::difference(&(pose * one), &(twin_pose * other));
        turned <= SAME && moved <= SAME * (size + one.translation.vector.norm())
    };
    match (&link.inertial, &twin.inertial) {
        (None, None) => {}
        (Some(a), Some(b)) if a.mass == b.mass && a.tensor == b.tensor && same(&a.origin, &b.origin) => {}
        _ => return Some("inertial".into()),
    }
    for (part, shapes, twins) in
        [("visual", &link.visuals, &twin.visuals), ("collision", &link.collisions, &twin.collisions)]
    {
        let alike = shapes.len() == twins.len()
            && shapes.iter().zip(twins).all(|(a, b)| a.geometry == b.geometry && same(&a.origin, &b.origin));
        if !alike {
            return Some(part.into());
        }
    }
    None
}
