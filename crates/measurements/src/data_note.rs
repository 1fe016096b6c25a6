//! What a user must know about a file that was read.

use super::rows::MOST_PROBLEMS;
use std::fmt;

/// A finding that is not an error but must be reported.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum DataNote {
    /// How the file or one of its columns was read.
    ReadAs(String),
    /// A target that repeats another in every row: counted once.
    DuplicateTarget {
        /// The one left out.
        target: String,
        /// The one that it repeats.
        of: String,
    },
    /// A joint with one reading in all rows.
    NeverMoves {
        /// The joint.
        joint: String,
        /// Its reading, rad or m.
        at: f64,
    },
    /// Readings outside the joint's limits.
    OutsideLimits {
        /// The joint.
        joint: String,
        /// How many rows.
        rows: usize,
    },
    /// Quaternions were normalised.
    Normalised {
        /// The largest deviation from 1.
        by: f64,
    },
    /// Rows whose gravity differs in size from that of the others.
    UnevenGravity {
        /// In most rows, in the file's unit.
        usual: f64,
        /// The largest deviation, relative.
        by: f64,
        /// Their lines.
        lines: Vec<usize>,
    },
    /// Rows in which nothing was measured.
    NothingMeasured {
        /// Their lines.
        lines: Vec<usize>,
    },
    /// A target that no row sees: left out.
    NeverSeen {
        /// The target.
        target: String,
    },
}

impl fmt::Display for DataNote {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::ReadAs(said) => f.write_str(said),
            Self::DuplicateTarget { target, of } => {
                write!(f, "target {target} repeats target {of} in every row; it is counted once")
            }
            Self::NeverMoves { joint, at } => {
                write!(
                    f,
                    "joint \"{joint}\" is at {at} in every row; the data cannot separate its axis from its neighbours'"
                )
            }
            Self::OutsideLimits { joint, rows } => {
                write!(f, "joint \"{joint}\" is outside its limits in {rows} rows")
            }
            Self::Normalised { by } => {
                write!(f, "quaternions were normalised; their lengths differed from 1 by up to {by:.1e}")
            }
            Self::UnevenGravity { usual, by, lines } => write!(
                f,
                "gravity reads {usual:.4} in most rows but is up to {:.1} % off in {} rows, lines {}; only its direction is \
                 used: did the sensor stand still, and is it calibrated?",
                by * 100.0,
                lines.len(),
                listed(lines)
            ),
            Self::NothingMeasured { lines } => {
                write!(f, "nothing was measured in {} rows, lines {}", lines.len(), listed(lines))
            }
            Self::NeverSeen { target } => write!(f, "no row sees target {target}; it is left out"),
        }
    }
}

/// The first lines of a note.
fn listed(lines: &[usize]) -> String {
    let shown: Vec<String> = lines.iter().take(MOST_PROBLEMS).map(usize::to_string).collect();
    let more = if lines.len() > MOST_PROBLEMS { ", …" } else { "" };
    format!("{}{more}", shown.join(", "))
}
