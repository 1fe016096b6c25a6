//! What can be compared: a whole tree, or the bare chain that a table gives.

use crate::mechanism::Mechanism;
use denavit_model::tree::Reading;
use denavit_model::{Chain, Robot};

/// One side of a comparison.
#[derive(Debug, Clone, Copy)]
pub enum Subject<'a> {
    /// A tree with everything that it carries.
    Robot(&'a Robot),
    /// A bare chain: joints and a tip, no links, no masses, limits only where stated.
    Chain {
        /// Name of the source, for messages.
        file: &'a str,
        /// The chain.
        chain: &'a Chain,
    },
}

impl Subject<'_> {
    /// Name of the file, for messages.
    pub fn file(&self) -> &str {
        match self {
            Self::Robot(robot) => &robot.source.file,
            Self::Chain { file, .. } => file,
        }
    }

    /// Its gauge-free form.
    pub fn mechanism(&self, reading: Reading) -> Mechanism {
        match self {
            Self::Robot(robot) => Mechanism::of_robot(robot, reading),
            Self::Chain { chain, .. } => Mechanism::of_chain(chain),
        }
    }

    /// Line of a joint's element, counted from 1, where the source has lines.
    pub(crate) fn joint_line(&self, name: &str) -> Option<usize> {
        let Self::Robot(robot) = self else { return None };
        robot.joint_index(name).map(|joint| robot.source.line(robot.joints[joint].at))
    }

    /// Line of a link's element, counted from 1, where the source has lines.
    pub(crate) fn link_line(&self, name: &str) -> Option<usize> {
        let Self::Robot(robot) = self else { return None };
        robot.link_index(name).map(|link| robot.source.line(robot.links[link].at))
    }
}
