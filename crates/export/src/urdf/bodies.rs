//! A robot's links at joint values 0, grouped into rigid bodies.

use denavit_model::PlacedRobot;
use denavit_model::nalgebra::{Unit, Vector3};
use denavit_model::notes::Note;
use denavit_model::robot::{JointKind, Robot};
use denavit_model::se3::Pose;
use denavit_model::tree::Reading;

use super::written::Numbers;

/// Links at joint values 0, and how they form rigid bodies.
pub(crate) struct Bodies {
    /// parent_from_child of each joint, its angles read as requested.
    pub origins: Vec<Numbers>,
    /// Whether a literal of the joint's origin was read as another number.
    pub reread: Vec<bool>,
    /// How literals of angles and axes were read.
    pub reading: Reading,
    /// Each joint's axis in its child link's frame, read as requested.
    pub axes: Vec<Unit<Vector3<f64>>>,
    /// root_from_link.
    pub poses: Vec<Pose>,
    /// The joint that carries each link.
    pub to_parent: Vec<Option<usize>>,
    /// The link that carries the rigid body which each link belongs to.
    pub body: Vec<usize>,
    /// Parents before children.
    pub order: Vec<usize>,
    /// The robot's size: the longest way from the root to a link, slides counted, m; never 0.
    pub size: f64,
    /// Numbers not read as written.
    pub notes: Vec<Note>,
}

/// Whether a joint has one value: it turns, slides, or does both by a screw.
pub(crate) fn has_axis(kind: &JointKind) -> bool {
    kind.has_one_value()
}

impl Bodies {
    pub fn of(robot: &Robot, reading: Reading) -> Self {
        let placed = PlacedRobot::new(robot, reading);
        let links = 0..robot.links.len();
        let reach = reach_below(&placed);
        let (mut origins, mut reread, mut notes) = (Vec::new(), Vec::new(), Vec::new());
        for (index, joint) in robot.joints.iter().enumerate() {
            let read = placed.origin(index);
            origins.push(Numbers { xyz: read.xyz, rpy: read.rpy });
            reread.push(!read.reread.is_empty());
            notes.extend(read.reread.iter().map(|(written, intended)| Note::IntendedAngle {
                place: robot.joint_place(index),
                written: written.clone(),
                read_as: intended.read_as.clone(),
                change: intended.change,
                tip_moves: intended.change.abs() * reach[joint.child],
            }));
            let meant = joint.axis_meant.as_ref().filter(|_| reading == Reading::Intended && has_axis(&joint.kind));
            notes.extend(meant.map(|meant| Note::IntendedAngle {
                place: robot.joint_place(index),
                written: format!("axis {}", meant.written),
                read_as: meant.read_as.clone(),
                change: meant.turned,
                tip_moves: 2.0 * meant.turned * reach[joint.child],
            }));
        }
        let size = if reach[robot.root] > 0.0 { reach[robot.root] } else { 1.0 };
        Self {
            origins,
            reread,
            reading,
            axes: robot.joints.iter().map(|joint| joint.axis_as(reading)).collect(),
            poses: links.clone().map(|link| *placed.pose(link)).collect(),
            to_parent: links.clone().map(|link| placed.carrier(link)).collect(),
            body: links.map(|link| placed.body(link)).collect(),
            order: placed.order().to_vec(),
            size,
            notes,
        }
    }

    /// A joint's origin in the frame of a link of the same rigid body, and the length, m, whose rounding error it
    /// carries in addition: 0 if the joint is on that link itself.
    pub fn seen_from(&self, robot: &Robot, link: usize, joint: usize) -> (Numbers, f64) {
        let parent = robot.joints[joint].parent;
        if parent == link {
            return (self.origins[joint], 0.0);
        }
        let step = self.poses[link].inverse() * self.poses[parent];
        (Numbers::of(&(step * self.origins[joint].pose()), self.size), self.size)
    }
}

/// For each link the longest way down from it, m: origins walked and slides passed.
fn reach_below(placed: &PlacedRobot) -> Vec<f64> {
    let robot = placed.robot();
    let mut reach = vec![0.0; robot.links.len()];
    for link in placed.order().iter().rev() {
        let Some(index) = placed.carrier(*link) else { continue };
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
