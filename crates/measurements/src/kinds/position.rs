//! The position of a target in the instrument's frame, m.

use super::{Frame, Part, Recorded, Unknowns};
use crate::MeasurementError;
use denavit_model::nalgebra::Vector3;

#[derive(Debug)]
pub(super) struct Position;

pub(super) const PART: Part = Part { word: "position", height: 3, unit: "m", by_turn: false };

impl Recorded for Position {
    fn name(&self) -> &'static str {
        "position"
    }

    fn plural(&self) -> &'static str {
        "positions"
    }

    fn place(&self) -> Part {
        PART
    }

    fn unknowns(&self) -> Unknowns {
        Unknowns { frame: Frame::Instrument, ..Unknowns::default() }
    }

    fn numbers(&self) -> usize {
        3
    }

    fn has_a_line_of_sight(&self) -> bool {
        true
    }

    fn has_simd_residuals(&self) -> bool {
        true
    }

    fn position(&self, values: &[f64]) -> Option<Vector3<f64>> {
        Some(Vector3::new(values[0], values[1], values[2]))
    }

    fn columns(&self, target: &str) -> Vec<String> {
        ["x", "y", "z"].map(|axis| format!("{axis}{target}")).into()
    }

    fn of_several(&self) -> bool {
        true
    }

    fn of_cells(&self, cells: &[f64], values: &mut Vec<f64>) -> Result<f64, MeasurementError> {
        values.extend_from_slice(cells);
        Ok(0.0)
    }
}
