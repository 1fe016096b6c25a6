//! Names of the branches of a six-joint arm.

use crate::arm::Axis;
use std::fmt;

/// The branch of a solution, by the signs of the factors whose zeros are the arm's singularities.
///
/// For an arm with a vertical first axis whose second and third turn about the same horizontal direction these are the words of
/// the field; for others they still name each branch of the classes with eight of them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Branch {
    /// The wrist is before the first axis, seen from the second; else behind it (the shoulder is turned round).
    pub front: bool,
    /// The elbow is above the line from shoulder to wrist, seen along the second axis.
    pub elbow_up: bool,
    /// The second-last joint is on the other side of its zero.
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
    /// The branch of an arm with these axes, in order from the end that its class is defined from.
    pub(crate) fn of(axes: [&Axis; 6], wrist: bool) -> Self {
        let [first, second, third, fourth, fifth, sixth] = axes;
        // The elbow bends towards the wrist's centre, or towards the last of the parallel axes.
        let end = if wrist { sixth.point } else { fourth.point };
        let elbow = second.direction.dot(&(third.point - second.point).cross(&(end - third.point)));
        let shoulder = second.direction.dot(&first.direction.cross(&(sixth.point - first.point)));
        let wrist = fourth.direction.dot(&fifth.direction.cross(&sixth.direction));
        Self { front: shoulder >= 0.0, elbow_up: elbow >= 0.0, flipped: wrist < 0.0 }
    }
}
