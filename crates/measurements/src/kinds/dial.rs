//! A dial gauge on the tip that touches a plate: height of its point above the plate, from an unknown zero, m.

use super::{Frame, Part, Recorded, Unknowns};
use crate::MeasurementError;

#[derive(Debug)]
pub(super) struct Dial;

impl Recorded for Dial {
    fn name(&self) -> &'static str {
        "dial"
    }

    fn plural(&self) -> &'static str {
        "readings of a dial gauge"
    }

    fn place(&self) -> Part {
        Part { word: "dial", height: 1, unit: "m", by_turn: false }
    }

    fn unknowns(&self) -> Unknowns {
        Unknowns { frame: Frame::Plane, ..Unknowns::default() }
    }

    fn numbers(&self) -> usize {
        1
    }

    fn holds_the_target(&self) -> bool {
        true
    }

    fn own_target(&self) -> Option<&'static str> {
        Some("gauge")
    }

    fn own_setup(&self) -> &'static str {
        "plate"
    }

    fn columns(&self, _target: &str) -> Vec<String> {
        vec!["dial".into()]
    }

    fn of_cells(&self, cells: &[f64], values: &mut Vec<f64>) -> Result<f64, MeasurementError> {
        values.push(cells[0]);
        Ok(0.0)
    }
}
