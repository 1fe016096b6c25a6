//! Hand-eye calibration from poses only: pairs of a robot's pose and an instrument's observation, without joint readings.
//!
//! An instrument (a camera, a tracker) sees a target (a marker, a probe). One of the two is on the hand, the other in
//! the robot's surroundings. With A the robot's pose (base_from_tip) and B what is seen (instrument_from_target), row by row:
//!
//! ```text
//! instrument stands, target on the hand:   A Z = X B       X base_from_instrument, Z tip_from_target
//! instrument on the hand, target stands:   A Z B = X       X base_from_target,     Z tip_from_instrument
//! ```
//! Both are `B = L⁻¹ M R` with M = A or A⁻¹, which is what is fitted.
//!
//! 1. Closed forms ([`closed_form`]): Park and Martin 1994, Daniilidis 1999, Shah 2013; on all rows, and on triples of rows, of
//!    which the one that most rows agree with counts (least median of squares).
//! 2. Maximum likelihood ([`fit`]): Gauss-Newton on the observations, with one variance of position and one of orientation, both
//!    estimated; rows far beyond them are rejected and listed.
//! 3. What the motion does not determine, standard deviations, and the error on held-out rows.
//!
//! # Examples
//! ```
//! use denavit_hand_eye::{Arrangement, Pair, solve};
//! use denavit_model::se3;
//! let (x, z) = (se3::translation([1.0, 0.2, 0.5].into()), se3::translation([0.0, 0.1, 0.05].into()));
//! let turns = [[0.3, 0.1, 0.0], [-0.4, 0.5, 0.2], [0.9, -0.7, 1.0], [0.1, 1.2, -0.8], [-1.0, 0.2, 0.6]];
//! let pairs = turns.map(|turn| {
//!     let robot = se3::pose(se3::rotation_from_rpy(turn), [0.4, turn[0], turn[1]].into());
//!     Pair { robot, seen: x.inverse() * robot * z }
//! });
//! let found = solve(&pairs, Arrangement::InstrumentStands)?;
//! assert!(se3::difference(&found.base.pose, &x).1 < 1e-12 && se3::difference(&found.tip.pose, &z).1 < 1e-12);
//! # Ok::<(), denavit_hand_eye::HandEyeError>(())
//! ```

pub mod closed_form;
pub mod fit;
mod motion;
pub mod report;
mod solve;

pub use motion::Unknown;
pub use solve::{ClosedForm, Errors, HandEye, HandEyeError, Placed, Residual, solve};

use denavit_model::Pose;
use serde::Serialize;

/// A pose of the robot and the observation there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pair {
    /// base_from_tip, m.
    pub robot: Pose,
    /// instrument_from_target, m.
    pub seen: Pose,
}

/// Which of the two is on the hand.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Arrangement {
    /// The instrument stands, the target is on the hand ("eye to hand").
    InstrumentStands,
    /// The instrument is on the hand, the target stands ("eye in hand").
    InstrumentOnHand,
}

impl Arrangement {
    /// Names of what is unknown: fixed to the base, fixed to the tip.
    pub fn names(self) -> [&'static str; 2] {
        match self {
            Self::InstrumentStands => ["base_from_instrument", "tip_from_target"],
            Self::InstrumentOnHand => ["base_from_target", "tip_from_instrument"],
        }
    }

    /// The rows as `seen = left⁻¹ · moved · right`.
    fn rows(self, pairs: &[Pair]) -> Vec<Row> {
        let moved = |robot: Pose| if self == Self::InstrumentStands { robot } else { robot.inverse() };
        pairs.iter().map(|pair| Row { moved: moved(pair.robot), seen: pair.seen }).collect()
    }

    /// `[left, right]` as `[fixed to the base, fixed to the tip]`, or the other way round.
    fn sorted<T>(self, [left, right]: [T; 2]) -> [T; 2] {
        match self {
            Self::InstrumentStands => [left, right],
            Self::InstrumentOnHand => [right, left],
        }
    }
}

/// `seen = left⁻¹ · moved · right`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Row {
    /// base_from_tip, or its inverse where the instrument is on the hand.
    pub moved: Pose,
    /// instrument_from_target.
    pub seen: Pose,
}
