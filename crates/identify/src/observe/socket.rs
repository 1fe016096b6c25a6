//! A ball on the tip in a socket: the same unknown point in all rows of a label.
//!
//! r = s - p, m, base frame, with s the socket and p the ball. No value is read: the joint readings are the measurement.

use super::{Discrepancy, Disturbance, Follows, Observe, Rows, Seen};
use crate::parameters::Layout;
use denavit_model::nalgebra::{Matrix3, Vector3};

#[derive(Debug)]
pub(super) struct Socket;

impl Observe for Socket {
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
}
