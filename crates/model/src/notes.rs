//! Places in a file, and findings that are not failures but must be reported.

use std::fmt;

/// A place in a file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Place {
    /// The file's name, as the user gave it.
    pub file: String,
    /// Counted from 1.
    pub line: usize,
    /// The element, such as `joint "elbow"`.
    pub element: String,
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}: {}", self.file, self.line, self.element)
    }
}

/// What was read differently from what is written, or what a user must know about a result.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Note {
    /// Something that the format does not allow was read as it was clearly meant.
    Corrected {
        /// Where.
        place: Place,
        /// What was done, a sentence.
        what: String,
    },
    /// Something in the source is not understood, and was ignored.
    NotUnderstood {
        /// Where.
        place: Place,
        /// What it is and what the user can do, a sentence.
        what: String,
    },
    /// An angle was read as the multiple of π that it stands for.
    IntendedAngle {
        /// Where.
        place: Place,
        /// The literal in the file.
        written: String,
        /// The multiple, such as `π/2`.
        read_as: String,
        /// Change, rad.
        change: f64,
        /// No point of the tip frame's origin moves by more, over the whole joint range, m.
        tip_moves: f64,
    },
    /// Two neighbouring axes closer to parallel than the tolerance were made parallel.
    TreatedAsParallel {
        /// The two, by name.
        joints: (String, String),
        /// How far from parallel they were, rad.
        angle: f64,
        /// No point of the tip frame's origin moves by more, over the whole joint range, m.
        tip_moves: f64,
    },
    /// A table has a number far beyond the robot's own size.
    FarNumber {
        /// The two neighbours whose common normal is far away.
        joints: (String, String),
        /// The angle between their axes, rad.
        angle: f64,
        /// The number, m.
        length: f64,
        /// The robot's size, m.
        size: f64,
    },
    /// A joint of the robot became several joints of the chain (a planar joint).
    Split {
        /// Where.
        place: Place,
        /// What became of it, a sentence.
        what: String,
    },
    /// No tip was named, and the chain ends before the fingers of the hand that it carries.
    EndsAtTool {
        /// The link at its end.
        tip: String,
        /// The end of the longest chain.
        finger: String,
    },
}

impl Note {
    /// The largest motion of the tip due to what the note reports, m; 0 where nothing moves.
    pub fn tip_moves(&self) -> f64 {
        match self {
            Self::IntendedAngle { tip_moves, .. } | Self::TreatedAsParallel { tip_moves, .. } => *tip_moves,
            _ => 0.0,
        }
    }
}

impl fmt::Display for Note {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Corrected { place, what } | Self::NotUnderstood { place, what } | Self::Split { place, what } => {
                write!(f, "{place}: {what}")
            }
            Self::IntendedAngle { place, written, read_as, change, tip_moves } => {
                write!(
                    f,
                    "{place}: {written} read as {read_as}; the tip {}",
                    Motion { moves: *tip_moves, turns: *change }
                )
            }
            Self::TreatedAsParallel { joints: (one, other), angle, tip_moves } => write!(
                f,
                "axes of \"{one}\" and \"{other}\" are {angle:.1e} rad from parallel and treated as parallel; the tip {}",
                Motion { moves: *tip_moves, turns: *angle }
            ),
            Self::EndsAtTool { tip, finger } => write!(
                f,
                "no tip was given: the chain ends at \"{tip}\" because the joints below it belong to a hand; ‹tip› \"{finger}\" \
                 continues to a finger"
            ),
            Self::FarNumber { joints: (one, other), angle, length, size } => write!(
                f,
                "axes of \"{one}\" and \"{other}\" are {angle:.1e} rad from parallel, so their common normal is {} \
                 away (robot size {}); if they are meant to be parallel, raise ‹tolerance›, otherwise use \
                 ‹convention› hayati",
                Length(length.abs()),
                Length(*size)
            ),
        }
    }
}

/// How far a tip moves, m; where it does not move, how far it turns, rad.
struct Motion {
    moves: f64,
    turns: f64,
}

impl fmt::Display for Motion {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.moves == 0.0 {
            return write!(f, "turns by at most {:.1e} rad and does not move", self.turns.abs());
        }
        write!(f, "moves by at most {}", Length(self.moves))
    }
}

/// A length in the unit that reads best.
struct Length(f64);

impl fmt::Display for Length {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let metres = self.0;
        match metres.abs() {
            0.0 => write!(f, "0 m"),
            m if m < 1e-6 => write!(f, "{metres:.1e} m"),
            m if m < 1e-3 => write!(f, "{:.1} µm", metres * 1e6),
            m if m < 1.0 => write!(f, "{:.2} mm", metres * 1e3),
            m if m < 1e4 => write!(f, "{metres:.3} m"),
            _ => write!(f, "{:.0} km", metres / 1e3),
        }
    }
}

/// A value and its notes.
#[derive(Debug, Clone, PartialEq)]
pub struct Noted<T> {
    /// The value.
    pub value: T,
    /// In the order in which they were found.
    pub notes: Vec<Note>,
}
