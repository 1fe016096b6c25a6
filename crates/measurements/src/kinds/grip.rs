//! A tool that two tips of a robot hold together: both tips must give the same tool pose. Only the joints are read.

use super::{Frame, Part, Recorded, Unknowns};
use crate::MeasurementError;

#[derive(Debug)]
pub(super) struct Grip;

/// Position and orientation of a frame in itself.
const ITSELF: [f64; 12] = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];

impl Recorded for Grip {
    fn name(&self) -> &'static str {
        "grip"
    }

    fn plural(&self) -> &'static str {
        "grips of a tool"
    }

    fn place(&self) -> Part {
        Part { word: "grip", height: 3, unit: "m", by_turn: false }
    }

    fn turn(&self) -> Option<Part> {
        Some(Part { word: "turn of the grip", height: 3, unit: "rad", by_turn: true })
    }

    fn unknowns(&self) -> Unknowns {
        Unknowns { frame: Frame::Grip, turn: true, ..Unknowns::default() }
    }

    fn numbers(&self) -> usize {
        ITSELF.len()
    }

    fn own_target(&self) -> Option<&'static str> {
        Some("grip")
    }

    fn own_setup(&self) -> &'static str {
        "tool"
    }

    fn label(&self) -> Option<&'static str> {
        Some("grip")
    }

    fn holds_the_target(&self) -> bool {
        true
    }

    fn columns(&self, _target: &str) -> Vec<String> {
        Vec::new()
    }

    fn of_cells(&self, _cells: &[f64], values: &mut Vec<f64>) -> Result<f64, MeasurementError> {
        values.extend(ITSELF);
        Ok(0.0)
    }

    fn lengths(&self) -> usize {
        0
    }
}
