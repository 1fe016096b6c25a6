//! Kinds of observation: what one kind measures is said in one file, and nowhere else is asked which kind it is.
//!
//! A kind compares a measured value with what the model predicts for a target on the tip. How a change of the arm enters is
//! the same for all: it moves and turns the target, and the kind says how its residual follows ([`Follows`]). What a kind
//! knows beside the target (an instrument's frame, an anchor, a socket) it takes from the [`Scene`](crate::observation::measurements::Scene).

mod dial;
mod distance;
mod gravity;
mod grip;
mod pixel;
mod plane;
mod pose;
mod position;
mod socket;

use crate::observation::arm::{Arm, Perturbation};
use crate::observation::measurements::{MeasurementError, Series};
use crate::observation::parameters::{Layout, Sensitivity};
use denavit_model::Pose;
use denavit_model::nalgebra::{Matrix3, Rotation3, Vector3};
use serde::{Serialize, Serializer};
use std::fmt;

/// Position and orientation of a target.
pub const POSE: ObservationKind = ObservationKind(&pose::Pose);
/// Position of a target.
pub const POSITION: ObservationKind = ObservationKind(&position::Position);
/// Distance of a target from an anchor.
pub const DISTANCE: ObservationKind = ObservationKind(&distance::Distance);

/// A ball in a socket.
pub const SOCKET: ObservationKind = ObservationKind(&socket::Socket);

/// A corner of a board in a camera's image.
pub const PIXEL: ObservationKind = ObservationKind(&pixel::Pixel);

/// A ball that touches a plane.
pub const PLANE: ObservationKind = ObservationKind(&plane::Plane);

/// A dial gauge on a plate.
pub const DIAL: ObservationKind = ObservationKind(&dial::Dial);

/// Where gravity pulls, as an accelerometer at rest reads it.
pub const GRAVITY: ObservationKind = ObservationKind(&gravity::Gravity);

/// How far two axes of an inclinometer point above the horizontal.
pub const INCLINATION: ObservationKind = ObservationKind(&gravity::Inclination);

/// A tool that two tips hold.
pub const GRIP: ObservationKind = ObservationKind(&grip::Grip);

/// Every kind that a file names by its columns; of those whose columns a file has, the first is meant.
pub const KINDS: [ObservationKind; 9] = [POSE, POSITION, DISTANCE, SOCKET, PIXEL, PLANE, DIAL, GRAVITY, INCLINATION];

/// A kind of observation, by reference to its definition.
#[derive(Clone, Copy)]
pub struct ObservationKind(&'static dyn Observe);

impl std::ops::Deref for ObservationKind {
    type Target = dyn Observe;

    fn deref(&self) -> &Self::Target {
        self.0
    }
}

impl fmt::Debug for ObservationKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl PartialEq for ObservationKind {
    fn eq(&self, other: &Self) -> bool {
        self.name() == other.name()
    }
}

impl Eq for ObservationKind {}

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

/// One observation, and the arm as it stands there.
#[derive(Debug, Clone, Copy)]
pub struct Seen<'a> {
    /// The arm, the frames and the points.
    pub arm: &'a Arm,
    /// base_from_tip.
    pub tip: &'a Pose,
    /// What effects do in this row.
    pub perturbation: &'a Perturbation,
    /// What is observed.
    pub series: &'a Series,
    /// The numbers that were measured.
    pub values: &'a [f64],
    /// Where the target is predicted, base frame, m.
    pub predicted: Vector3<f64>,
    /// Whether the values are weighed in the instrument's own axes.
    pub weighed: bool,
}

impl<'a> Seen<'a> {
    /// The observation of `series` with these values where the tip stands so.
    pub fn new(
        arm: &'a Arm,
        tip: &'a Pose,
        perturbation: &'a Perturbation,
        series: &'a Series,
        values: &'a [f64],
        weighed: bool,
    ) -> Self {
        let on_tip = arm.targets[series.target].translation.vector + perturbation.target;
        let predicted = tip.rotation * on_tip + tip.translation.vector;
        Self { arm, tip, perturbation, series, values, predicted, weighed }
    }

    /// instrument_from_base.
    pub fn instrument(&self) -> &'a Pose {
        &self.arm.instruments[self.series.setup]
    }

    /// The point that the kind asks for, base frame, m.
    pub fn point(&self) -> Vector3<f64> {
        self.series.point.map_or_else(Vector3::zeros, |point| self.arm.points[point])
    }
}

/// Measured less predicted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Discrepancy {
    /// Of lengths, m; what is one number is in x.
    pub place: Vector3<f64>,
    /// Of the orientation, a rotation vector in the base frame, rad.
    pub turn: Vector3<f64>,
}

/// How a residual follows a velocity v of the target, base frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Follows {
    /// Three values: -v.
    Whole,
    /// One value: -line · v.
    Line(Vector3<f64>),
    /// Two values: -line · v for each, v being the velocity of this point (base frame, m) as if it sat on the tip.
    Lines {
        /// The point.
        point: Vector3<f64>,
        /// The lines.
        lines: [Vector3<f64>; 2],
    },
    /// Two values: -line · ω for each, ω being the angular velocity of the tip, base frame.
    Turns([Vector3<f64>; 2]),
}

/// Rows of a Jacobian, a column per parameter.
#[derive(Debug)]
pub struct Rows<'a> {
    /// Row by row.
    pub cells: &'a mut [f64],
    /// Length of a row.
    pub columns: usize,
}

impl Rows<'_> {
    /// Puts consecutive numbers of a row, from `column` on.
    pub fn put(&mut self, row: usize, column: usize, values: &[f64]) {
        let start = row * self.columns + column;
        self.cells[start..start + values.len()].copy_from_slice(values);
    }
}

/// The errors that an instrument makes.
pub struct Disturbance<'a> {
    /// A gross error, m; 0 in most rows.
    pub gross: Vector3<f64>,
    /// Standard deviation of a length's component, m.
    pub position: f64,
    /// Standard deviation of a rotation vector's component, rad.
    pub orientation: f64,
    /// Standard deviation of a pixel's component, px.
    pub pixel: f64,
    /// Draws from a normal distribution of this standard deviation.
    pub draw: &'a mut dyn FnMut(f64) -> f64,
}

impl Disturbance<'_> {
    fn vector(&mut self, deviation: f64) -> Vector3<f64> {
        Vector3::new((self.draw)(deviation), (self.draw)(deviation), (self.draw)(deviation))
    }
}

/// What one kind of observation is.
pub trait Observe: Sync {
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

    /// Measured less predicted.
    fn discrepancy(&self, seen: &Seen<'_>) -> Discrepancy;

    /// How the lengths follow a motion of the target.
    fn follows(&self, seen: &Seen<'_>) -> Follows;

    /// The lengths per unit of an effect, what it does to the tip and the target left out.
    fn by_effect(&self, _seen: &Seen<'_>, _effect: &Sensitivity) -> Vector3<f64> {
        Vector3::zeros()
    }

    /// Columns of the instrument and the points, into rows in which these are 0; `left` is the inverse left Jacobian of
    /// SO(3) at the residual of the orientation.
    fn own_columns(&self, seen: &Seen<'_>, layout: &Layout, left: &Matrix3<f64>, rows: &mut Rows<'_>);

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

    /// Places where the point may stand, the likeliest first, given predicted places of the target (m, base frame) and what
    /// was measured there.
    fn points(&self, _predicted: &[Vector3<f64>], _values: &[&[f64]]) -> Vec<Vector3<f64>> {
        Vec::new()
    }

    /// The frame of the plane, given predicted places of the target (m, base frame) and what was measured there.
    fn plane(&self, _predicted: &[Vector3<f64>], _values: &[&[f64]]) -> Option<Pose> {
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

    /// Whether it can be seen there at all.
    fn in_view(&self, _seen: &Seen<'_>) -> bool {
        true
    }

    /// Whether it is of the corners of a board, whose camera must be known.
    fn of_a_board(&self) -> bool {
        false
    }

    /// What its setup is called beside that of other instruments in the same rows; empty where it is theirs.
    fn own_setup(&self) -> &'static str {
        ""
    }

    /// What an instrument without errors reads, appended to `values`.
    fn predict(&self, seen: &Seen<'_>, values: &mut Vec<f64>);

    /// Adds errors to such a reading.
    fn disturb(&self, values: &mut [f64], errors: &mut Disturbance<'_>);

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
