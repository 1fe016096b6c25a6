//! A robot's links at joint values 0, grouped into rigid bodies.

use denavit_model::intended;
use denavit_model::nalgebra::Vector3;
use denavit_model::notes::Note;
use denavit_model::robot::{Joint, JointKind, Robot};
use denavit_model::se3::Pose;
use denavit_model::tree::Reading;

use super::written::Numbers;

/// Links at joint values 0, and who hangs rigidly on whom.
pub(crate) struct Bodies {
    /// parent_from_child of each joint, its angles read as was asked for.
    pub origins: Vec<Numbers>,
    /// Whether a literal of the joint's origin was read as another number.
    pub reread: Vec<bool>,
    /// root_from_link.
    pub poses: Vec<Pose>,
    /// The joint that carries each link.
    pub to_parent: Vec<Option<usize>>,
    /// The link that carries the rigid body which each link belongs to.
    pub body: Vec<usize>,
    /// Whether a joint turns or slides on something fixed to this link, the link itself counted.
    pub on_the_way: Vec<bool>,
    /// Parents before children.
    pub order: Vec<usize>,
    /// The robot's size: the longest way from the root to a link, slides counted, m; never 0.
    pub size: f64,
    /// What was read otherwise than it is written.
    pub notes: Vec<Note>,
}

/// Whether a joint has one value: it turns, slides, or does both by a screw.
pub(crate) fn has_axis(kind: &JointKind) -> bool {
    matches!(kind, JointKind::Revolute | JointKind::Continuous | JointKind::Prismatic | JointKind::Screw(_))
}

impl Bodies {
    pub fn of(robot: &Robot, reading: Reading) -> Self {
        let (order, to_parent) = (robot.parents_first(), robot.carriers());
        let reach = reach_below(robot, &order, &to_parent);
        let (mut origins, mut reread, mut notes) = (Vec::new(), Vec::new(), Vec::new());
        for index in 0..robot.joints.len() {
            let (numbers, found) = read_origin(robot, index, reading, &reach);
            origins.push(numbers);
            reread.push(!found.is_empty());
            notes.extend(found);
        }
        let mut poses = vec![Pose::identity(); robot.links.len()];
        let mut body: Vec<usize> = (0..robot.links.len()).collect();
        for link in &order {
            let Some(index) = to_parent[*link] else { continue };
            let joint = &robot.joints[index];
            poses[*link] = poses[joint.parent] * origins[index].pose();
            if !joint.kind.moves() {
                body[*link] = body[joint.parent];
            }
        }
        let mut on_the_way = vec![false; robot.links.len()];
        for link in order.iter().rev() {
            let Some(index) = to_parent[*link] else { continue };
            let joint = &robot.joints[index];
            on_the_way[joint.parent] |= has_axis(&joint.kind) || !joint.kind.moves() && on_the_way[*link];
        }
        let size = if reach[robot.root] > 0.0 { reach[robot.root] } else { 1.0 };
        Self { origins, reread, poses, to_parent, body, on_the_way, order, size, notes }
    }
}

/// For each link the longest way down from it, m: origins walked and slides passed.
fn reach_below(robot: &Robot, order: &[usize], to_parent: &[Option<usize>]) -> Vec<f64> {
    let mut reach = vec![0.0; robot.links.len()];
    for link in order.iter().rev() {
        let Some(index) = to_parent[*link] else { continue };
        let joint = &robot.joints[index];
        let slide = match (&joint.kind, joint.limits.range) {
            (JointKind::Prismatic, Some((lower, upper))) => lower.abs().max(upper.abs()),
            _ => 0.0,
        };
        let length: f64 = Vector3::from(joint.origin.xyz).norm() + slide + reach[*link];
        reach[joint.parent] = length.max(reach[joint.parent]);
    }
    reach
}

fn read_origin(robot: &Robot, index: usize, reading: Reading, reach: &[f64]) -> (Numbers, Vec<Note>) {
    let joint = &robot.joints[index];
    let mut numbers = Numbers::read(&joint.origin);
    let mut notes = Vec::new();
    if let (Reading::Intended, Some(written)) = (reading, &joint.origin.rpy_written) {
        for (literal, angle) in written.iter().zip(&mut numbers.rpy) {
            let Some(intended) = intended::read_as(literal) else { continue };
            *angle = intended.angle;
            notes.push(Note::IntendedAngle {
                place: robot.joint_place(index),
                written: literal.clone(),
                read_as: intended.read_as,
                change: intended.change,
                tip_moves: intended.change.abs() * reach[joint.child],
            });
        }
    }
    (numbers, notes)
}

/// Whether a joint's origin has an angle that is read as another number and far fewer digits than a double has.
///
/// One with all of them may be what an export wrote: it stays, though it lies near a multiple of π.
pub(crate) fn has_short_angle(joint: &Joint) -> bool {
    let short = |literal: &String| {
        let mantissa = literal.split(['e', 'E']).next().unwrap_or_default().trim_start_matches(['+', '-', '0', '.']);
        mantissa.bytes().filter(u8::is_ascii_digit).count() < 14 && intended::read_as(literal).is_some()
    };
    joint.origin.rpy_written.as_ref().is_some_and(|written| written.iter().any(short))
}
