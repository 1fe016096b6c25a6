//! Predictions of observations: each kind's model is one file, and no other code depends on the kind.
//!
//! A kind compares a measured value with the model's prediction for a target on the tip. A change of the arm has the same
//! form for all kinds: it moves and turns the target, and the kind gives the derivative of its residual ([`Follows`]). Other
//! data of a kind (an instrument's frame, an anchor, a socket) come from the [`Scene`](denavit_measurements::Scene).

mod dial;
mod distance;
mod gravity;
mod grip;
mod pixel;
mod plane;
mod pose;
mod position;
mod socket;

use crate::arm::{Arm, Perturbation};
use crate::parameters::{Layout, Sensitivity};
use denavit_measurements::Series;
use denavit_measurements::kinds::ObservationKind;
use denavit_model::Pose;
use denavit_model::nalgebra::{Matrix3, Vector3};

/// The model of a kind of observation.
pub fn model_of(kind: ObservationKind) -> &'static dyn Observe {
    match kind {
        ObservationKind::Pose => &pose::Pose,
        ObservationKind::Position => &position::Position,
        ObservationKind::Distance => &distance::Distance,
        ObservationKind::Socket => &socket::Socket,
        ObservationKind::Pixel => &pixel::Pixel,
        ObservationKind::Plane => &plane::Plane,
        ObservationKind::Dial => &dial::Dial,
        ObservationKind::Gravity => &gravity::Gravity,
        ObservationKind::Inclination => &gravity::Inclination,
        ObservationKind::Grip => &grip::Grip,
    }
}

/// One observation, and the arm's state there.
#[derive(Debug, Clone, Copy)]
pub struct Seen<'a> {
    /// The arm, the frames and the points.
    pub arm: &'a Arm,
    /// base_from_tip.
    pub tip: &'a Pose,
    /// The perturbation by effects in this row.
    pub perturbation: &'a Perturbation,
    /// What is observed.
    pub series: &'a Series,
    /// The numbers that were measured.
    pub values: &'a [f64],
    /// The predicted position of the target, base frame, m.
    pub predicted: Vector3<f64>,
    /// Whether the values are weighted in the instrument's own axes.
    pub weighed: bool,
}

impl<'a> Seen<'a> {
    /// The observation of `series` with these values at this tip pose.
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

    /// The kind's point, base frame, m.
    pub fn point(&self) -> Vector3<f64> {
        self.series.point.map_or_else(Vector3::zeros, |point| self.arm.points[point])
    }
}

/// Measured minus predicted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Discrepancy {
    /// Of lengths, m; a single number is in x.
    pub place: Vector3<f64>,
    /// Of the orientation, a rotation vector in the base frame, rad.
    pub turn: Vector3<f64>,
}

/// Derivative of a residual by a velocity v of the target, base frame.
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

/// The model of one kind of observation.
pub trait Observe: Sync {
    /// Measured minus predicted.
    fn discrepancy(&self, seen: &Seen<'_>) -> Discrepancy;

    /// The derivative of the lengths by a motion of the target.
    fn follows(&self, seen: &Seen<'_>) -> Follows;

    /// The lengths per unit of an effect, apart from its motion of tip and target.
    fn by_effect(&self, _seen: &Seen<'_>, _effect: &Sensitivity) -> Vector3<f64> {
        Vector3::zeros()
    }

    /// Columns of the instrument and the points, into rows in which these are 0; `left` is the inverse left Jacobian of
    /// SO(3) at the residual of the orientation.
    fn own_columns(&self, seen: &Seen<'_>, layout: &Layout, left: &Matrix3<f64>, rows: &mut Rows<'_>);

    /// Possible positions of the point, the likeliest first, given predicted positions of the target (m, base frame) and the
    /// measured values.
    fn points(&self, _predicted: &[Vector3<f64>], _values: &[&[f64]]) -> Vec<Vector3<f64>> {
        Vec::new()
    }

    /// The frame of the plane, given predicted positions of the target (m, base frame) and the measured values.
    fn plane(&self, _predicted: &[Vector3<f64>], _values: &[&[f64]]) -> Option<Pose> {
        None
    }

    /// Whether the target is visible there.
    fn in_view(&self, _seen: &Seen<'_>) -> bool {
        true
    }

    /// Appends the reading of a perfect instrument to `values`.
    fn predict(&self, seen: &Seen<'_>, values: &mut Vec<f64>);

    /// Adds errors to such a reading.
    fn disturb(&self, values: &mut [f64], errors: &mut Disturbance<'_>);
}
