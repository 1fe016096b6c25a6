//! A ball on the tip that touches a plane: a plate, a table, a wall, of which only the flatness is known. Only the joints are read;
//! the ball's radius is part of the plane's estimated position.

use super::{Frame, Part, Recorded, Unknowns};
use crate::MeasurementError;

#[derive(Debug)]
pub(super) struct Plane;

impl Recorded for Plane {
    fn name(&self) -> &'static str {
        "plane"
    }

    fn plural(&self) -> &'static str {
        "readings on planes"
    }

    fn place(&self) -> Part {
        Part { word: "height", height: 1, unit: "m", by_turn: false }
    }

    fn unknowns(&self) -> Unknowns {
        Unknowns { frame: Frame::Plane, ..Unknowns::default() }
    }

    fn numbers(&self) -> usize {
        0
    }

    fn own_target(&self) -> Option<&'static str> {
        Some("ball")
    }

    fn own_setup(&self) -> &'static str {
        "plane"
    }

    fn holds_the_target(&self) -> bool {
        true
    }

    fn label(&self) -> Option<&'static str> {
        Some("plane")
    }

    fn columns(&self, _target: &str) -> Vec<String> {
        Vec::new()
    }

    fn of_cells(&self, _cells: &[f64], _values: &mut Vec<f64>) -> Result<f64, MeasurementError> {
        Ok(0.0)
    }

    fn lengths(&self) -> usize {
        0
    }
}
