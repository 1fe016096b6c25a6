//! The result of a comparison, as plain values.

use crate::words::{self, Signed};
use serde::Serialize;
use std::fmt;

/// Whether two robots are the same within the stated tolerances.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// No difference above the tolerances.
    Same,
    /// At least one.
    Different,
}

/// One of the two robots.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Side {
    /// Name of the file, as the user gave it.
    pub file: String,
    /// The robot's name.
    pub robot: String,
    /// How many joints move.
    pub joints: usize,
}

/// The answer to "is it still the same robot?".
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Comparison {
    /// Same or different.
    pub verdict: Verdict,
    /// The reference.
    pub a: Side,
    /// What is compared with it.
    pub b: Side,
    /// Below this, lengths count as equal, m.
    pub tolerance_m: f64,
    /// Below this, angles count as equal, rad.
    pub tolerance_rad: f64,
    /// Joints with changes, in a's order from the root.
    pub joints: Vec<JointDifference>,
    /// Every leaf link that both have, by how far it moved.
    pub tips: Vec<TipDifference>,
    /// Joints and links that only one of the two has, and what they carry.
    pub parts: Vec<PartDifference>,
    /// Notes on changes without effect on motion: renamed, moved frames.
    pub notes: Vec<String>,
}

/// A joint and what changed about it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct JointDifference {
    /// Its name in a.
    pub joint: String,
    /// Its name in b, if it differs.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub renamed: Option<String>,
    /// Line of its element in b's file.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub line: Option<usize>,
    /// At least one.
    pub changes: Vec<Change>,
}

/// A change and whether it makes the robots different under the options of the comparison.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Change {
    /// What.
    #[serde(flatten)]
    pub what: JointChange,
    /// `false` if an option ignores it.
    pub counts: bool,
}

/// What can change about a joint. Axis changes are relative to the link that carries the joint.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(tag = "change", rename_all = "snake_case")]
#[non_exhaustive]
pub enum JointChange {
    /// The axis has another direction.
    AxisTurned {
        /// Angle between old and new direction.
        rad: f64,
    },
    /// The axis is displaced.
    AxisMoved {
        /// Distance between old and new line near the joint.
        m: f64,
    },
    /// The child is displaced along the axis.
    SlidAlongAxis {
        /// In the axis' direction.
        m: f64,
    },
    /// At joint value 0 the child is turned about (revolute) or moved along (prismatic) the axis.
    ZeroShifted {
        /// rad, or m for a prismatic joint.
        by: f64,
        /// `rad` or `m`.
        unit: &'static str,
    },
    /// The positive direction is reversed.
    SenseReversed,
    /// The child is displaced on the joint, beyond the changes of the axis.
    LinkMoved {
        /// Turned by.
        rad: f64,
        /// Moved by.
        m: f64,
    },
    /// Metres per radian of a screw joint.
    PitchChanged {
        /// In a.
        from: f64,
        /// In b.
        to: f64,
    },
    /// Joint value per unit of its coordinate.
    ScaleChanged {
        /// In a.
        from: f64,
        /// In b.
        to: f64,
    },
    /// Another kind of joint.
    KindChanged {
        /// In a.
        from: String,
        /// In b.
        to: String,
    },
    /// A limit.
    LimitChanged {
        /// `lower`, `upper`, `velocity` or `effort`.
        limit: &'static str,
        /// In a; `None` where a states none.
        from: Option<f64>,
        /// In b; `None` where b states none.
        to: Option<f64>,
    },
    /// Damping, friction or a soft limit.
    PropertyChanged {
        /// Which.
        property: &'static str,
        /// In a.
        from: String,
        /// In b.
        to: String,
    },
    /// The driver, multiplier or offset of the mimic changed.
    MimicChanged {
        /// In a.
        from: String,
        /// In b.
        to: String,
    },
    /// It is attached to another joint's link.
    CarriedByOther {
        /// The joint that carries it in a; empty on the root.
        from: String,
        /// The joint that carries it in b; empty on the root.
        to: String,
    },
    /// b has no such joint.
    Removed,
    /// a has no such joint.
    Added,
}

impl fmt::Display for JointChange {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::AxisTurned { rad } => write!(f, "axis turned by {}", words::angle(*rad)),
            Self::AxisMoved { m } => write!(f, "axis moved by {}", words::length(*m)),
            Self::SlidAlongAxis { m } => {
                write!(f, "moved along its axis by {}", Signed(&words::length(m.abs()), *m))
            }
            Self::ZeroShifted { by, unit: "m" } => {
                write!(f, "zero shifted by {}", Signed(&words::length(by.abs()), *by))
            }
            Self::ZeroShifted { by, .. } => write!(f, "zero shifted by {}", Signed(&words::angle(by.abs()), *by)),
            Self::SenseReversed => write!(f, "sense reversed"),
            Self::LinkMoved { rad, m } => {
                write!(f, "its link is displaced on it: {}", words::displacement((*rad, *m), 0.0, 0.0))
            }
            Self::PitchChanged { from, to } => {
                write!(f, "pitch {} to {} per rad", words::length(*from), words::length(*to))
            }
            Self::ScaleChanged { from, to } => write!(f, "scale {from} to {to}"),
            Self::KindChanged { from, to } => write!(f, "kind {from} to {to}"),
            Self::LimitChanged { limit, from, to } => {
                write!(f, "{limit} limit {} to {}", words::stated(*from), words::stated(*to))
            }
            Self::PropertyChanged { property, from, to } => write!(f, "{property} {from} to {to}"),
            Self::MimicChanged { from, to } => write!(f, "mimic: {from} to {to}"),
            Self::CarriedByOther { from, to } => {
                write!(f, "carried by {} instead of {}", words::carrier(to), words::carrier(from))
            }
            Self::Removed => write!(f, "removed"),
            Self::Added => write!(f, "added"),
        }
    }
}

/// How far a leaf link's frame is displaced, in the root frame.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TipDifference {
    /// The link.
    pub tip: String,
    /// Largest displacement found by sampling and ascent, m.
    pub sampled_m: f64,
    /// The joint values (rad, m) at which it occurs.
    pub at: Vec<JointValue>,
    /// No configuration within the joint ranges displaces the tip by more, m.
    pub bound_m: f64,
}

/// A joint and its value.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct JointValue {
    /// The joint.
    pub joint: String,
    /// rad or m.
    pub value: f64,
}

/// A difference that is not one of a moving joint.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PartDifference {
    /// `link "tool0"`, `joint "flange"`.
    pub part: String,
    /// A sentence.
    pub what: String,
    /// What kind of part it is.
    pub kind: PartKind,
    /// Line of its element in b's file, where it has one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub line: Option<usize>,
    /// `false` if an option ignores it.
    pub counts: bool,
    /// The link, where it is one.
    #[serde(skip)]
    pub link: Option<String>,
}

/// Kinds of part.
#[non_exhaustive]
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum PartKind {
    /// A frame that only fixed joints place.
    Frame,
    /// Mass, centre of mass, inertia tensor.
    Inertial,
    /// A visual shape.
    Visual,
    /// A collision shape.
    Collision,
    /// A name.
    Name,
    /// An element other than links and joints, or inside them: a transmission, a simulator's settings, calibration.
    Element,
}

impl Comparison {
    /// The largest sampled displacement over all tips, m.
    pub fn largest(&self) -> Option<&TipDifference> {
        self.tips.iter().max_by(|a, b| a.sampled_m.total_cmp(&b.sampled_m))
    }
}

impl Change {
    pub(crate) fn counted(what: JointChange) -> Self {
        Self { what, counts: true }
    }
}
