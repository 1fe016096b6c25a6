//! A ball on the tip in a socket: the same unknown point in all rows of a label. Only the joints are read.

use super::{Part, Recorded, Unknowns};
use crate::MeasurementError;

#[derive(Debug)]
pub(super) struct Socket;

impl Recorded for Socket {
    fn name(&self) -> &'static str {
        "socket"
    }

    fn plural(&self) -> &'static str {
        "readings in sockets"
    }

    fn place(&self) -> Part {
        Part { word: "spread", height: 3, unit: "m", by_turn: false }
    }

    fn unknowns(&self) -> Unknowns {
        Unknowns { point: Some("socket"), ..Unknowns::default() }
    }

    fn numbers(&self) -> usize {
        0
    }

    fn columns(&self, _target: &str) -> Vec<String> {
        Vec::new()
    }

    fn of_cells(&self, _cells: &[f64], _values: &mut Vec<f64>) -> Result<f64, MeasurementError> {
        Ok(0.0)
    }

    fn holds_the_target(&self) -> bool {
        true
    }

    fn own_target(&self) -> Option<&'static str> {
        Some("ball")
    }
}
