//! A ball on the tip that sits in a socket: the same point in all rows of a label, wherever that is.
//!
//! r = s - p, m, base frame, with s the socket and p the ball. Nothing is read: the joint readings are the measurement.

use super::{Discrepancy, Disturbance, Follows, Observe, Part, Rows, Seen, Unknowns};
use crate::observation::measurements::MeasurementError;
use crate::observation::parameters::Layout;
use denavit_model::nalgebra::{Matrix3, Vector3};

#[derive(Debug)]
pub(super) struct Socket;

impl Observe for Socket {
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

    fn discrepancy(&self, seen: &Seen<'_>) -> Discrepancy {
        Discrepancy { place: seen.point() - seen.predicted, turn: Vector3::zeros() }
    }

    fn follows(&self, _seen: &Seen<'_>) -> Follows {
        Follows::Whole
    }

    fn own_columns(&self, seen: &Seen<'_>, layout: &Layout, _left: &Matrix3<f64>, rows: &mut Rows<'_>) {
        let Some(column) = seen.series.point.map(|point| layout.points[point]) else { return };
        (0..3).for_each(|row| rows.put(row, column + row, &[1.0]));
    }

    fn points(&self, predicted: &[Vector3<f64>], _values: &[&[f64]]) -> Vec<Vector3<f64>> {
        vec![predicted.iter().sum::<Vector3<f64>>() / predicted.len().max(1) as f64]
    }

    fn predict(&self, _seen: &Seen<'_>, _values: &mut Vec<f64>) {}

    fn disturb(&self, _values: &mut [f64], _errors: &mut Disturbance<'_>) {}

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
