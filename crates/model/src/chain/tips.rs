//! Several tips of one tree: one list of all joints, and for each tip the joints on the path to it.
//!
//! With every screw axis in the base frame, a joint that is not on the path to a tip does not affect its pose:
//! base_from_tip(q) is the product of exponentials over its own joints, base to tip, times its own home pose.

use super::{Chain, ChainError, ChainJoint};
use crate::se3::Pose;
use thiserror::Error;

/// A link that is measured, and what moves it.
#[derive(Debug, Clone, PartialEq)]
pub struct Tip {
    /// Name of the link.
    pub name: String,
    /// base_from_tip with every joint value 0.
    pub home: Pose,
    /// For each joint, whether it is on the path to this tip.
    pub joints: Vec<bool>,
    /// For each coordinate, whether it moves one of these joints.
    pub coordinates: Vec<bool>,
}

/// The measured tips of a tree: at least one, all with the same base.
#[derive(Debug, Clone, PartialEq)]
pub struct Tips(Vec<Tip>);

/// Why chains do not form a tree.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum TipsError {
    /// Two chains start at different links.
    #[error(
        "the chain to tip \"{tip}\" starts at \"{base}\", that to tip \"{first}\" at \"{first_base}\"; set ‹base› to one link for all tips"
    )]
    Bases {
        /// A tip.
        tip: String,
        /// Where its chain starts.
        base: String,
        /// The first tip.
        first: String,
        /// Where the first chain starts.
        first_base: String,
    },
    /// A tip is named twice.
    #[error("tip \"{0}\" is named twice; name each tip once")]
    Twice(String),
    /// The paths to two tips have different joints of the same name.
    #[error(
        "joint \"{joint}\" moves tip \"{tip}\" in another way than the tips before it: the chains branch between a rotation and \
         a translation that are one screw joint; calibrate these tips one at a time"
    )]
    Joint {
        /// The joint.
        joint: String,
        /// The tip.
        tip: String,
    },
}

impl Chain {
    /// The joints on the paths from one base to several tips, each once and after the joint that carries it, and the tips.
    ///
    /// The result's own tip and home pose are those of the first chain; its tip's name lists all tips. Axis points stay where the
    /// single chains have them. For a single chain the result is that chain.
    ///
    /// # Errors
    /// The chains have different bases, a tip is named twice, or a joint differs from one chain to another.
    pub fn joined(first: &Self, others: &[Self]) -> Result<(Self, Tips), TipsError> {
        let mut all = first.clone();
        let mut tips = Tips::only(first);
        for chain in others {
            if chain.base != first.base {
                return Err(TipsError::Bases {
                    tip: chain.tip.clone(),
                    base: chain.base.clone(),
                    first: first.tip.clone(),
                    first_base: first.base.clone(),
                });
            }
            if tips.position(&chain.tip).is_some() {
                return Err(TipsError::Twice(chain.tip.clone()));
            }
            let differs = |joint: &str| TipsError::Joint { joint: joint.into(), tip: chain.tip.clone() };
            let mut own =
                Tip { name: chain.tip.clone(), home: chain.home, joints: Vec::new(), coordinates: Vec::new() };
            for joint in &chain.joints {
                let coordinate = &chain.coordinates[joint.coordinate];
                let of_all = all.coordinates.iter().position(|known| known.name == coordinate.name);
                let of_all = of_all.unwrap_or_else(|| {
                    all.coordinates.push(coordinate.clone());
                    all.coordinates.len() - 1
                });
                let joint = ChainJoint { coordinate: of_all, ..joint.clone() };
                let index = match all.joints.iter().position(|known| known.name == joint.name) {
                    Some(known) if all.joints[known] != joint => return Err(differs(&joint.name)),
                    Some(known) => known,
                    None => {
                        all.joints.push(joint);
                        all.joints.len() - 1
                    }
                };
                for (flags, index) in [(&mut own.joints, index), (&mut own.coordinates, of_all)] {
                    flags.resize(flags.len().max(index + 1), false);
                    flags[index] = true;
                }
            }
            all.tip = format!("{}, {}", all.tip, chain.tip);
            tips.0.push(own);
        }
        for tip in &mut tips.0 {
            tip.joints.resize(all.joints.len(), false);
            tip.coordinates.resize(all.coordinates.len(), false);
        }
        Ok((all, tips))
    }
}

impl Tips {
    /// The one tip of a chain.
    pub fn only(chain: &Chain) -> Self {
        Self(vec![Tip {
            name: chain.tip.clone(),
            home: chain.home,
            joints: vec![true; chain.joints.len()],
            coordinates: vec![true; chain.coordinates.len()],
        }])
    }

    /// All of them, in the order in which they were named.
    pub fn all(&self) -> &[Tip] {
        &self.0
    }

    /// Whether there are more than one.
    pub fn several(&self) -> bool {
        self.0.len() > 1
    }

    /// Index of the tip of this name.
    pub fn position(&self, name: &str) -> Option<usize> {
        self.0.iter().position(|tip| tip.name == name)
    }

    /// For each joint, the joint that carries it; `None` for those on the base.
    pub fn carriers(&self) -> Vec<Option<usize>> {
        let before = |tip: &Tip, joint: usize| (0..joint).rev().find(|&other| tip.joints[other]);
        let joints = self.0.first().map_or(0, |tip| tip.joints.len());
        let on_the_way = |joint: usize| self.0.iter().find(|tip| tip.joints[joint]);
        (0..joints).map(|joint| before(on_the_way(joint)?, joint)).collect()
    }

    /// Whether joint `first` carries joint `other`, which may be itself: both are on the path to one tip, `first` not after
    /// `other`.
    pub fn carries(&self, first: usize, other: usize) -> bool {
        first <= other && self.0.iter().any(|tip| tip.joints[first] && tip.joints[other])
    }
}

impl std::ops::Index<usize> for Tips {
    type Output = Tip;

    fn index(&self, index: usize) -> &Tip {
        &self.0[index]
    }
}

impl Tip {
    /// The joints on the path to it, base to tip.
    pub fn on_the_way(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.joints.len()).filter(|&joint| self.joints[joint])
    }

    /// base_from_tip at the coordinates `q` of all; `all` has the joints that the tip was made with.
    ///
    /// # Panics
    /// `q` is shorter than the coordinates of `all`, or `all` has fewer joints.
    pub fn fk(&self, all: &Chain, q: &[f64]) -> Pose {
        let mut reached = Pose::identity();
        for (joint, _) in all.joints.iter().zip(&self.joints).filter(|(_, on_the_way)| **on_the_way) {
            reached *= joint.screw.motion(joint.value(q));
        }
        reached * self.home
    }

    /// The chain to this tip, of the tree that all joints belong to: `all` may have other axes and scales than it was made with.
    ///
    /// # Errors
    /// As [`Chain::new`].
    pub fn chain(&self, all: &Chain) -> Result<Chain, ChainError> {
        let mut coordinates = Vec::new();
        let mut joints = Vec::new();
        let mut of_own = vec![None; all.coordinates.len()];
        for (joint, _) in all.joints.iter().zip(&self.joints).filter(|(_, on_the_way)| **on_the_way) {
            let coordinate = *of_own[joint.coordinate].get_or_insert_with(|| {
                coordinates.push(all.coordinates[joint.coordinate].clone());
                coordinates.len() - 1
            });
            joints.push(ChainJoint { coordinate, ..joint.clone() });
        }
        Chain::new((all.name.clone(), all.base.clone(), self.name.clone()), coordinates, joints, self.home)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Reading, urdf};

    const TWO_ARMS: &str = r#"<robot name="two"><link name="base"/><link name="chest"/><link name="l1"/><link name="l2"/><link name="r1"/>
        <joint name="torso" type="revolute"><axis xyz="0 0 1"/><parent link="base"/><child link="chest"/><limit lower="-1" upper="1"/></joint>
        <joint name="left_1" type="revolute"><origin xyz="0.3 0.2 0.5"/><axis xyz="0 1 0"/><parent link="chest"/><child link="l1"/><limit lower="-1" upper="1"/></joint>
        <joint name="left_2" type="prismatic"><origin xyz="0.1 0 0.5" rpy="0.2 0.1 0"/><axis xyz="1 0 0"/><parent link="l1"/><child link="l2"/><limit lower="-1" upper="1"/></joint>
        <joint name="right_1" type="revolute"><origin xyz="0.3 -0.2 0.5"/><axis xyz="0 1 0"/><parent link="chest"/><child link="r1"/><limit lower="-1" upper="1"/></joint></robot>"#;

    fn chain(tip: &str) -> Chain {
        let robot = urdf::read("two.urdf", TWO_ARMS).unwrap();
        robot.chain(None, Some(tip), Reading::Intended).unwrap().value
    }

    #[test]
    fn joints_of_two_tips_stand_once_each_and_give_the_single_chains_back() {
        let (left, right) = (chain("l2"), chain("r1"));
        let (all, tips) = Chain::joined(&left, std::slice::from_ref(&right)).unwrap();
        let names: Vec<&str> = all.joints().iter().map(|joint| joint.name.as_str()).collect();
        assert_eq!(names, ["torso", "left_1", "left_2", "right_1"]);
        assert_eq!((all.tip(), all.coordinates().len()), ("l2, r1", 4));
        assert_eq!(tips[1].joints, [true, false, false, true]);
        let q = [0.3, -0.4, 0.1, 0.7];
        assert_eq!(tips[1].fk(&all, &q), right.fk(&[q[0], q[3]]));
        assert_eq!((tips[0].chain(&all).unwrap(), tips[1].chain(&all).unwrap()), (left, right));
        assert_eq!(tips.carriers(), [None, Some(0), Some(1), Some(0)]);
        assert!(tips.carries(0, 3) && tips.carries(1, 2) && !tips.carries(1, 3) && !tips.carries(3, 0));
        let (alone, tips) = Chain::joined(&all, &[]).unwrap();
        assert!(alone == all && !tips.several());
    }

    #[test]
    fn chains_that_are_no_tree_are_refused() {
        let left = chain("l2");
        let again = Chain::joined(&left, std::slice::from_ref(&left)).unwrap_err().to_string();
        assert_eq!(again, "tip \"l2\" is named twice; name each tip once");
        let robot = urdf::read("two.urdf", TWO_ARMS).unwrap();
        let from_chest = robot.chain(Some("chest"), Some("r1"), Reading::Intended).unwrap().value;
        let message = Chain::joined(&left, &[from_chest]).unwrap_err().to_string();
        assert!(
            message.starts_with("the chain to tip \"r1\" starts at \"chest\", that to tip \"l2\" at \"base\""),
            "{message}"
        );
    }
}
