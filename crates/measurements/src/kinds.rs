//! Kinds of observation: each kind's measured values and file columns are defined in one file, and no other code depends on the kind.
//!
//! Predictions by an arm belong to the crate that models arms.

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
use crate::MeasurementError;
use crate::board::Corner;
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
    /// Direction of gravity, read by an accelerometer at rest.
    Gravity,
    /// Angles of two axes of an inclinometer above the horizontal.
    Inclination,
    /// A tool that two tips hold.
    Grip,
}

/// Every kind that a file's columns can name; if several match, the first applies.
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
    /// Name of its errors, such as `position`.
    pub word: &'static str,
    /// Number of values: 1, 2 or 3.
    pub height: usize,
    /// `m` or `rad`.
    pub unit: &'static str,
    /// Whether they depend on the target's orientation on the tip.
    pub by_turn: bool,
}

/// The observable part of a setup's frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Frame {
    /// Nothing.
    #[default]
    None,
    /// All of it: the instrument's frame.
    Instrument,
    /// All of it: the frame of a tool that two tips hold, different in every row.
    Grip,
    /// The plane z = 0.
    Plane,
    /// The direction z, opposite to gravity.
    Level,
}

/// The unknowns of a kind other than the arm and its target's position.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Unknowns {
    /// Of its setup's frame.
    pub frame: Frame,
    /// The orientation of the target on the tip.
    pub turn: bool,
    /// The name of a point that is fixed in the base frame.
    pub point: Option<&'static str>,
}

/// A kind of observation, and its form in a file.
pub trait Recorded: Sync {
    /// Its name in JSON and on the command line.
    fn name(&self) -> &'static str;

    /// Its plural in texts: `positions`.
    fn plural(&self) -> &'static str;

    /// The part that is a length; for kinds without lengths, an angle.
    fn place(&self) -> Part;

    /// The part that is an angle; three values.
    fn turn(&self) -> Option<Part> {
        None
    }

    /// The unknowns other than arm and target.
    fn unknowns(&self) -> Unknowns;

    /// Number of stored values of one observation.
    fn numbers(&self) -> usize;

    /// Residual values: the heights of the parts.
    fn height(&self) -> usize {
        self.place().height + self.turn().map_or(0, |turn| turn.height)
    }

    /// Whether it measures its target's position in a frame with the instrument at the origin, as trackers and cameras do.
    fn has_a_line_of_sight(&self) -> bool {
        false
    }

    /// Whether it is the target's position, and orientation where there is that part, in the instrument's frame: the
    /// numbers are then x, y, z and the rotation matrix column by column, and rows can be computed several at a time.
    fn has_simd_residuals(&self) -> bool {
        false
    }

    /// The measured position of the target in the instrument's frame, m, if the kind measures it.
    fn position(&self, _values: &[f64]) -> Option<Vector3<f64>> {
        None
    }

    /// The measured orientation of the target in the instrument's frame, if the kind measures it.
    fn orientation(&self, _values: &[f64]) -> Option<Rotation3<f64>> {
        None
    }

    /// Whether it depends only on its target's orientation, not on the target's position on the tip.
    fn is_turned_alone(&self) -> bool {
        false
    }

    /// Direction of gravity in the target's axes, if the kind measures it.
    fn down(&self, _values: &[f64]) -> Option<Vector3<f64>> {
        None
    }

    /// A quantity that is constant for a sensor at rest, in the unit of the cells.
    fn strength(&self, _cells: &[f64]) -> Option<f64> {
        None
    }

    /// The column of labels of its points.
    fn label(&self) -> Option<&'static str> {
        self.unknowns().point
    }

    /// A quantity that several observations of one target in one row and setup determine together, as another kind and its numbers. A
    /// fit starts from it.
    fn together(&self, _seen: &[(&Corner, &[f64])]) -> Option<(ObservationKind, Vec<f64>)> {
        None
    }

    /// Whether it observes corners of a board, with a known camera.
    fn of_a_board(&self) -> bool {
        false
    }

    /// The name of its setup, apart from other instruments in the same rows; empty if it shares theirs.
    fn own_setup(&self) -> &'static str {
        ""
    }

    /// Its target, if different from the instruments' targets; it is the same in every setup.
    fn own_target(&self) -> Option<&'static str> {
        None
    }

    /// Whether the observation constrains the target, so that postures cannot be chosen freely.
    fn holds_the_target(&self) -> bool {
        false
    }

    /// Names of its columns in a file; none if the label of its point is enough.
    fn columns(&self, target: &str) -> Vec<String>;

    /// Whether several targets can be observed at once, some of them not in every row.
    fn of_several(&self) -> bool {
        false
    }

    /// Appends the values of the cells to `values`; returns by how much normalisation changed them.
    ///
    /// # Errors
    /// The cells are not a valid observation.
    fn of_cells(&self, cells: &[f64], values: &mut Vec<f64>) -> Result<f64, MeasurementError>;

    /// The cells of the values in a file.
    fn to_cells(&self, values: &[f64]) -> Vec<f64> {
        values.to_vec()
    }

    /// Number of first cells that are lengths.
    fn lengths(&self) -> usize {
        self.place().height
    }

    /// Whether its cells are angles.
    fn has_angles(&self) -> bool {
        false
    }
}
