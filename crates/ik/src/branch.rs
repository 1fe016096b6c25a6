//! Names of the branches of a six-joint arm.

use crate::arm::SixR;
use denavit_model::Pose;
use denavit_model::nalgebra::Vector3;
use std::fmt;

/// Which of the arm's postures a solution is: by the signs of the factors whose zeros are its singularities.
///
/// For an arm with a vertical first axis whose second and third turn about the same horizontal direction these are the words of
/// the field; for others they still name each branch of the classes with eight of them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Branch {
    /// The wrist is before the first axis, seen from the second; else behind it (the shoulder is turned round).
    pub front: bool,
    /// The elbow is above the line from shoulder to wrist, seen along the second axis.
    pub elbow_up: bool,
    /// The last but one joint is on the other side of its zero.
    pub flipped: bool,
}

impl fmt::Display for Branch {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let shoulder = if self.front { "front" } else { "back" };
        let elbow = if self.elbow_up { "elbow up" } else { "elbow down" };
        let wrist = if self.flipped { "wrist flipped" } else { "wrist not flipped" };
        write!(f, "{shoulder}, {elbow}, {wrist}")
    }
}

impl Branch {
    /// The branch of an arm at its joint values, `arm` seen from the end at which its class stands.
    pub(crate) fn of(arm: &SixR, values: &[f64; 6], wrist: bool) -> Self {
        let mut reached = Pose::identity();
        let mut directions = [Vector3::zeros(); 6];
        let mut points = [Vector3::zeros(); 6];
        for k in 0..6 {
            directions[k] = reached.rotation * arm.axes[k].direction;
            points[k] = reached.rotation * arm.axes[k].point + reached.translation.vector;
            reached *= arm.axes[k].motion(values[k]);
        }
        // The elbow bends towards the wrist's centre, or towards the last of the parallel axes.
        let end = if wrist { points[5] } else { points[3] };
        let elbow = directions[1].dot(&(points[2] - points[1]).cross(&(end - points[2])));
        let shoulder = directions[1].dot(&directions[0].cross(&(points[5] - points[0])));
        let wrist = directions[3].dot(&directions[4].cross(&directions[5]));
        Self { front: shoulder >= 0.0, elbow_up: elbow >= 0.0, flipped: wrist < 0.0 }
    }
}
