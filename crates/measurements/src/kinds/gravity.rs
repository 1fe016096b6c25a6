//! The direction of gravity in a sensor on the tip: an accelerometer at rest (a direction), or an inclinometer with two axes (rad above
//! the horizontal). The sensor's position on its link is not observable.

use super::{Frame, Part, Recorded, Unknowns};
use crate::MeasurementError;
use denavit_model::nalgebra::{Vector2, Vector3};

#[derive(Debug)]
pub(super) struct Gravity;

#[derive(Debug)]
pub(super) struct Inclination;

/// Smallest norm of a direction, in the unit of the reading.
const NO_DIRECTION: f64 = 1e-9;
/// Rounding of the readings of two axes at right angles.
const ROUNDING: f64 = 1e-3;

const UNKNOWNS: Unknowns = Unknowns { frame: Frame::Level, turn: true, point: None };

impl Recorded for Gravity {
    fn name(&self) -> &'static str {
        "gravity"
    }

    fn plural(&self) -> &'static str {
        "directions of gravity"
    }

    fn place(&self) -> Part {
        Part { word: "gravity", height: 2, unit: "rad", by_turn: true }
    }

    fn unknowns(&self) -> Unknowns {
        UNKNOWNS
    }

    fn numbers(&self) -> usize {
        3
    }

    fn own_setup(&self) -> &'static str {
        "gravity"
    }

    fn own_target(&self) -> Option<&'static str> {
        Some("accelerometer")
    }

    fn is_turned_alone(&self) -> bool {
        true
    }

    fn down(&self, values: &[f64]) -> Option<Vector3<f64>> {
        Some(Vector3::new(values[0], values[1], values[2]))
    }

    fn strength(&self, cells: &[f64]) -> Option<f64> {
        Some(Vector3::new(cells[0], cells[1], cells[2]).norm())
    }

    fn columns(&self, _target: &str) -> Vec<String> {
        ["x", "y", "z"].map(|axis| format!("gravity_{axis}")).into()
    }

    fn of_cells(&self, cells: &[f64], values: &mut Vec<f64>) -> Result<f64, MeasurementError> {
        let read = Vector3::new(cells[0], cells[1], cells[2]);
        let direction = read.try_normalize(NO_DIRECTION).ok_or(MeasurementError::NoDirection)?;
        values.extend(direction.iter());
        Ok(0.0)
    }

    fn lengths(&self) -> usize {
        0
    }
}

impl Recorded for Inclination {
    fn name(&self) -> &'static str {
        "inclination"
    }

    fn plural(&self) -> &'static str {
        "inclinations"
    }

    fn place(&self) -> Part {
        Part { word: "inclination", height: 2, unit: "rad", by_turn: true }
    }

    fn unknowns(&self) -> Unknowns {
        UNKNOWNS
    }

    fn numbers(&self) -> usize {
        2
    }

    fn own_setup(&self) -> &'static str {
        "gravity"
    }

    fn own_target(&self) -> Option<&'static str> {
        Some("inclinometer")
    }

    fn is_turned_alone(&self) -> bool {
        true
    }

    fn down(&self, values: &[f64]) -> Option<Vector3<f64>> {
        let level = Vector2::new(values[0].sin(), values[1].sin());
        Some(Vector3::new(-level.x, -level.y, -(1.0 - level.norm_squared()).max(0.0).sqrt()))
    }

    fn columns(&self, _target: &str) -> Vec<String> {
        ["x", "y"].map(|axis| format!("inclination_{axis}")).into()
    }

    fn of_cells(&self, cells: &[f64], values: &mut Vec<f64>) -> Result<f64, MeasurementError> {
        let right = std::f64::consts::FRAC_PI_2 + ROUNDING;
        let level = cells[0].sin().powi(2) + cells[1].sin().powi(2);
        if cells.iter().any(|angle| angle.abs() > right) || level > 1.0 + ROUNDING {
            return Err(MeasurementError::NotTwoInclinations([cells[0], cells[1]]));
        }
        values.extend_from_slice(cells);
        Ok(0.0)
    }

    fn lengths(&self) -> usize {
        0
    }

    fn has_angles(&self) -> bool {
        true
    }
}
