//! Kinds of observation: what one kind measures and how a file has it is said in one file, and nowhere else is asked which kind it is.
//!
//! What an arm predicts of it is for the crate that models arms.

mod dial;
mod distance;
mod gravity;
mod grip;
mod pixel;
mod plane;
mod pose;
mod position;
mod socket;

pub use self::pose::rotation as rotation_of_pose;
use crate::{MeasurementError, Series};
use denavit_model::nalgebra::{Rotation3, Vector3};
use serde::{Serialize, Serializer};

/// A kind of observation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ObservationKind {
    /// Position and orientation of a target.
    Pose,
    /// Position of a target.
    Position,
    /// Distance of a target from an anchor.
    Distance,
    /// A ball in a socket.
    Socket,
    /// A corner of a board in a camera's image.
    Pixel,
    /// A ball that touches a plane.
    Plane,
    /// A dial gauge on a plate.
    Dial,
    /// Where gravity pulls, as an accelerometer at rest reads it.
    Gravity,
    /// How far two axes of an inclinometer point above the horizontal.
    Inclination,
    /// A tool that two tips hold.
    Grip,
}

/// Every kind that a file names by its columns; of those whose columns a file has, the first is meant.
pub const KINDS: [ObservationKind; 9] = [
    ObservationKind::Pose,
    ObservationKind::Position,
    ObservationKind::Distance,
    ObservationKind::Socket,
    ObservationKind::Pixel,
    ObservationKind::Plane,
    ObservationKind::Dial,
    ObservationKind::Gravity,
    ObservationKind::Inclination,
];

impl std::ops::Deref for ObservationKind {
    type Target = dyn Recorded;

    fn deref(&self) -> &Self::Target {
        match self {
            Self::Pose => &pose::Pose,
            Self::Position => &position::Position,
            Self::Distance => &distance::Distance,
            Self::Socket => &socket::Socket,
            Self::Pixel => &pixel::Pixel,
            Self::Plane => &plane::Plane,
            Self::Dial => &dial::Dial,
            Self::Gravity => &gravity::Gravity,
            Self::Inclination => &gravity::Inclination,
            Self::Grip => &grip::Grip,
        }
    }
}

impl Serialize for ObservationKind {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.name())
    }
}

/// A part of an observation whose values share a unit and a noise level.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Part {
    /// What its errors are called, such as `position`.
    pub word: &'static str,
    /// Number of values: 1, 2 or 3.
    pub height: usize,
    /// `m` or `rad`.
    pub unit: &'static str,
    /// Whether they follow the target's orientation on the tip.
    pub by_turn: bool,
}

/// What is seen of the frame of a setup.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Frame {
    /// Nothing.
    #[default]
    None,
    /// All of it: that of the instrument, in which it reads.
    Instrument,
    /// All of it: that of a tool which two tips hold, in every row another.
    Grip,
    /// The plane z = 0.
    Plane,
    /// The direction z, which gravity pulls against.
    Level,
}

/// What a kind takes for unknown beside the arm and the place of its target.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Unknowns {
    /// What of its setup's frame.
    pub frame: Frame,
    /// The orientation of the target on the tip.
    pub turn: bool,
    /// A point that stands still in the base frame, and what it is called.
    pub point: Option<&'static str>,
}

/// What one kind of observation is, and how a file has it.
pub trait Recorded: Sync {
    /// As in JSON and on the command line.
    fn name(&self) -> &'static str;

    /// What rows of it are called: `positions`.
    fn plural(&self) -> &'static str;

    /// The part that is a length; of what has none, an angle.
    fn place(&self) -> Part;

    /// The part that is an angle; three values.
    fn turn(&self) -> Option<Part> {
        None
    }

    /// What is unknown beside arm and target.
    fn unknowns(&self) -> Unknowns;

    /// How many numbers one observation is stored in.
    fn numbers(&self) -> usize;

    /// Residual values: the heights of the parts.
    fn height(&self) -> usize {
        self.place().height + self.turn().map_or(0, |turn| turn.height)
    }

    /// Whether it reads the place of its target in a frame at whose origin its instrument stands, as trackers and cameras do.
    fn has_a_line_of_sight(&self) -> bool {
        false
    }

    /// Whether it is the target's position, and orientation where there is that part, in the instrument's frame: the
    /// numbers are then x, y, z and the rotation matrix column by column, and rows can be computed several at a time.
    fn has_simd_residuals(&self) -> bool {
        false
    }

    /// The measured place of the target in the instrument's frame, m, where that is what is measured.
    fn position(&self, _values: &[f64]) -> Option<Vector3<f64>> {
        None
    }

    /// The measured orientation of the target in the instrument's frame, where it is measured.
    fn orientation(&self, _values: &[f64]) -> Option<Rotation3<f64>> {
        None
    }

    /// Whether it is the same wherever its target sits on the tip: how that is turned is all that counts.
    fn is_turned_alone(&self) -> bool {
        false
    }

    /// Where gravity pulls, in the target's own axes, where that is what is measured.
    fn down(&self, _values: &[f64]) -> Option<Vector3<f64>> {
        None
    }

    /// What is as large in every row of a sensor that stands still, in the unit of the cells.
    fn strength(&self, _cells: &[f64]) -> Option<f64> {
        None
    }

    /// The column whose texts tell apart what it is of.
    fn label(&self) -> Option<&'static str> {
        self.unknowns().point
    }

    /// What observations of one target in one row and setup say together, where none of them says it alone: another kind, and
    /// its numbers. A fit starts from it.
    fn together(&self, _seen: &[(&Series, &[f64])]) -> Option<(ObservationKind, Vec<f64>)> {
        None
    }

    /// Whether it is of the corners of a board, whose camera must be known.
    fn of_a_board(&self) -> bool {
        false
    }

    /// What its setup is called beside that of other instruments in the same rows; empty where it is theirs.
    fn own_setup(&self) -> &'static str {
        ""
    }

    /// The target that it is of, where that is another than instruments see; it is the same in every setup.
    fn own_target(&self) -> Option<&'static str> {
        None
    }

    /// Whether what is observed holds the target, so that postures cannot be chosen freely.
    fn holds_the_target(&self) -> bool {
        false
    }

    /// Names of its columns in a file; none where the label of its point says it all.
    fn columns(&self, target: &str) -> Vec<String>;

    /// Whether several targets can be observed at once, some of them not in every row.
    fn of_several(&self) -> bool {
        false
    }

    /// The numbers that cells mean, appended to `values`; returns by how much they were changed to be what they must be.
    ///
    /// # Errors
    /// The cells are no such observation.
    fn of_cells(&self, cells: &[f64], values: &mut Vec<f64>) -> Result<f64, MeasurementError>;

    /// The cells that the numbers are written as.
    fn to_cells(&self, values: &[f64]) -> Vec<f64> {
        values.to_vec()
    }

    /// How many of the first cells are lengths.
    fn lengths(&self) -> usize {
        self.place().height
    }

    /// Whether its cells are angles.
    fn has_angles(&self) -> bool {
        false
    }
}
