//! What can be compared: a whole tree, or the bare chain that a table gives.

use crate::mechanism::Mechanism;
use denavit_model::tree::Reading;
use denavit_model::{Chain, Robot};
use std::collections::HashMap;

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

    /// Line of a byte offset, counted from 1, where the source has lines.
    pub(crate) fn line(&self, at: usize) -> Option<usize> {
        let Self::Robot(robot) = self else { return None };
        Some(robot.source.line(at))
    }

    /// Lines of joints and links in the source, if it has lines.
    pub(crate) fn lines(&self) -> Lines<'_> {
        let Self::Robot(robot) = self else { return Lines::default() };
        let line = |at: usize| robot.source.line(at);
        Lines {
            joints: robot.joints.iter().map(|joint| (joint.name.as_str(), line(joint.at))).collect(),
            links: robot.links.iter().map(|link| (link.name.as_str(), line(link.at))).collect(),
        }
    }
}

/// Lines of elements, counted from 1, by name.
#[derive(Debug, Default)]
pub(crate) struct Lines<'a> {
    joints: HashMap<&'a str, usize>,
    links: HashMap<&'a str, usize>,
}

impl Lines<'_> {
    pub(crate) fn joint(&self, name: &str) -> Option<usize> {
        self.joints.get(name).copied()
    }

    pub(crate) fn link(&self, name: &str) -> Option<usize> {
        self.links.get(name).copied()
    }
}
