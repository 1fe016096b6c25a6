//! What a match says.

use super::vendor::{DhNumber, VendorNumber};
use crate::conventions::RowLabel;
use denavit_model::chain::{Chain, ChainError, ChainJoint};
use denavit_model::se3::Pose;
use thiserror::Error;

/// How well a robot and a table agree, by the largest distance between their tips.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Verdict {
    /// Below 1e-8 m: the same numbers.
    Exact,
    /// Below 0.2 mm: one of the two is rounded.
    Rounded,
    /// Below 10 mm: slightly different arms.
    Close,
    /// Not the same arm.
    Mismatch,
}

impl Verdict {
    /// The verdict on a largest tip error, m.
    pub fn of(position_error: f64) -> Self {
        match position_error {
            error if error < 1e-8 => Self::Exact,
            error if error < 2e-4 => Self::Rounded,
            error if error < 1e-2 => Self::Close,
            _ => Self::Mismatch,
        }
    }

    /// `exact`, `rounded`, `close` or `mismatch`.
    pub fn word(self) -> &'static str {
        match self {
            Self::Exact => "exact",
            Self::Rounded => "rounded",
            Self::Close => "close",
            Self::Mismatch => "mismatch",
        }
    }
}

/// Whether a joint of the robot and of the table have the same positive direction.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sense {
    /// They do.
    Same,
    /// They have opposite positive directions.
    Reversed,
}

impl Sense {
    /// 1 or -1.
    pub fn sign(self) -> f64 {
        match self {
            Self::Same => 1.0,
            Self::Reversed => -1.0,
        }
    }
}

/// Sense and zero of a joint: its value in the table is sense · |scale| · q + zero.
#[derive(Debug, Clone, PartialEq)]
pub struct JointMatch {
    /// The robot's name for it.
    pub name: String,
    /// Its sense.
    pub sense: Sense,
    /// The table's joint value where the robot's coordinate is 0, rad or m. Where the base frame is free the first
    /// joint's is 0 by choice, and where the tool frame is free the last one's.
    pub zero: f64,
}

/// The transformation from a table to the robot, and the remaining error.
#[derive(Debug, Clone, PartialEq)]
pub struct Placement {
    /// From base to tip.
    pub joints: Vec<JointMatch>,
    /// robot's base_from_table's base: B.
    pub base: Pose,
    /// table's tip_from_robot's tip: E.
    pub tool: Pose,
    /// Largest distance of the tips over random configurations, m.
    pub position_error: f64,
    /// Largest rotation between the tips over the same configurations, rad.
    pub rotation_error: f64,
}

impl Placement {
    /// The robot's chain in the table's frames, zeros and senses: to compare with the table's numbers.
    ///
    /// # Errors
    /// As [`Chain::new`]; does not happen for a chain that was one.
    pub fn in_frames_of_the_table(&self, chain: &Chain) -> Result<Chain, ChainError> {
        let back = self.base.inverse();
        // robot(q) = exp(S (q + o)) …; with v = s q + z that is exp(s S (v - z + s o)).
        let joints = chain.joints().iter().zip(&self.joints).map(|(joint, lies)| {
            let sense = lies.sense.sign();
            let screw = joint.screw.moved(&back);
            let screw = if sense < 0.0 { screw.reversed() } else { screw };
            ChainJoint { screw, offset: sense * joint.offset - lies.zero, ..joint.clone() }
        });
        let names = (chain.name(), chain.base(), chain.tip());
        let home = back * chain.home() * self.tool.inverse();
        Chain::new(names, chain.coordinates().to_vec(), joints.collect(), home)
    }
}

/// A number of the table beside the robot's own in the same gauge.
#[derive(Debug, Clone, PartialEq)]
pub struct NumberMatch {
    /// Which.
    pub number: DhNumber,
    /// The vendor's, rad or m.
    pub vendor: VendorNumber,
    /// The robot's, rad or m.
    pub robot: f64,
    /// The two differ by at most the vendor's last place, or by the error of an exact or rounded match.
    pub agrees: bool,
}

/// A row of the table beside the robot's own.
#[derive(Debug, Clone, PartialEq)]
pub struct RowMatch {
    /// Which row.
    pub label: RowLabel,
    /// The numbers that the row has.
    pub numbers: Vec<NumberMatch>,
}

/// How a number differs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Nature {
    /// The same amount on the other side of the axis.
    Sign,
    /// The robot has the length on the other side of the joint: it is 0 here, and across the neighbouring row's length,
    /// which is then the hypotenuse of the two.
    OtherSideOfJoint {
        /// The row that has it.
        with: RowLabel,
    },
    /// Another amount.
    Amount,
}

/// A number in which robot and table differ.
#[derive(Debug, Clone, PartialEq)]
pub struct Difference {
    /// Its row.
    pub label: RowLabel,
    /// Which number of the row.
    pub number: DhNumber,
    /// The vendor's, rad or m.
    pub vendor: f64,
    /// The robot's, rad or m.
    pub robot: f64,
    /// How it differs.
    pub nature: Nature,
}

/// The fewest numbers found that, changed, make the table the robot's.
#[derive(Debug, Clone, PartialEq)]
pub struct Explanation {
    /// In the order of the table.
    pub differences: Vec<Difference>,
    /// How the changed table fits the robot.
    pub placement: Placement,
}

/// The answer.
#[derive(Debug, Clone, PartialEq)]
pub struct Match {
    /// By the largest tip error of `placement`.
    pub verdict: Verdict,
    /// The best fit of the unchanged vendor's table to the robot.
    pub placement: Placement,
    /// The vendor's numbers and the robot's own, row by row.
    pub rows: Vec<RowMatch>,
    /// Where the verdict is close or a mismatch: what differs; `None` where no change of the numbers makes them the same.
    pub explanation: Option<Explanation>,
}

/// Why robot and table cannot be compared.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum MatchError {
    /// They have different numbers of joints.
    #[error(
        "the chain from \"{base}\" to \"{tip}\" has {robot} moving joints and the table has {vendor}; choose another ‹base› \
         or ‹tip›, or another table"
    )]
    Count {
        /// The chain's base link.
        base: String,
        /// The chain's tip link.
        tip: String,
        /// Joints of the robot.
        robot: usize,
        /// Joint rows of the table.
        vendor: usize,
    },
    /// One turns and the other slides.
    #[error(
        "row {row}: joint \"{joint}\" of the robot is {robot} and the table's is {vendor}; both must be of the same kind"
    )]
    Kind {
        /// Counted from 1.
        row: usize,
        /// The robot's joint.
        joint: String,
        /// Its kind.
        robot: &'static str,
        /// The table's kind.
        vendor: &'static str,
    },
    /// The table names the robot's joints in another order.
    #[error(
        "row {row} is named \"{vendor}\", but joint {row} from the base is \"{robot}\"; put the rows in the chain's order"
    )]
    Order {
        /// Counted from 1.
        row: usize,
        /// The robot's joint at that place.
        robot: String,
        /// The row's name.
        vendor: String,
    },
    /// A number is infinite or not a number.
    #[error("row {row}: {number} is not finite")]
    NotFinite {
        /// Counted from 1; 0 for the base, one more than there are joints for the tool.
        row: usize,
        /// Which number.
        number: &'static str,
    },
    /// A proximal table cannot hold Hayati's beta.
    #[error("row {row}: beta belongs to the hayati convention")]
    Beta {
        /// Counted from 1.
        row: usize,
    },
}

impl NumberMatch {
    /// The robot's number in the vendor's unit and to the vendor's places: the vendor's own text where the two agree,
    /// as many places as show the difference where not.
    pub fn printed(&self) -> String {
        let Some(written) = &self.vendor.written else {
            return format!("{}", if self.agrees { self.vendor.value } else { self.robot });
        };
        if self.agrees {
            return written.text.clone();
        }
        let most = self.vendor.places().map_or(0, |places| usize::try_from(places).unwrap_or(0)).max(6);
        let (robot, vendor) = (self.robot / written.unit, self.vendor.value / written.unit);
        format!("{:.*}", if (robot - vendor).abs() < 1e-6 { 12 } else { most.min(12) }, robot)
    }
}

impl Match {
    /// Whether every number of the table prints back as the vendor wrote it.
    pub fn prints_back(&self) -> bool {
        self.rows.iter().flat_map(|row| &row.numbers).all(|number| number.agrees)
    }
}
