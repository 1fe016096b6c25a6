//! The distance of a target from a fixed anchor, m: a draw-wire sensor, a ball-bar.

use super::{Part, Recorded, Unknowns};
use crate::MeasurementError;

#[derive(Debug)]
pub(super) struct Distance;

impl Recorded for Distance {
    fn name(&self) -> &'static str {
        "distance"
    }

    fn plural(&self) -> &'static str {
        "distances"
    }

    fn place(&self) -> Part {
        Part { word: "distance", height: 1, unit: "m", by_turn: false }
    }

    fn unknowns(&self) -> Unknowns {
        Unknowns { point: Some("anchor"), ..Unknowns::default() }
    }

    fn numbers(&self) -> usize {
        1
    }

    fn columns(&self, _target: &str) -> Vec<String> {
        vec!["distance".into()]
    }

    fn of_cells(&self, cells: &[f64], values: &mut Vec<f64>) -> Result<f64, MeasurementError> {
        if cells[0] <= 0.0 {
            return Err(MeasurementError::NotPositive(cells[0]));
        }
        values.push(cells[0]);
        Ok(0.0)
    }
}
