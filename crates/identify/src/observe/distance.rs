//! The distance of a target from a fixed anchor: a draw-wire sensor, a ball-bar.
//!
//! r = m - (1 + scale) |p - anchor|, m.

use super::{Discrepancy, Disturbance, Follows, Observe, Rows, Seen};
use crate::least_squares::least_squares;
use crate::parameters::{Layout, Sensitivity};
use denavit_model::nalgebra::{DMatrix, DVector, Matrix3, Vector3};

#[derive(Debug)]
pub(super) struct Distance;

fn from_anchor(seen: &Seen<'_>) -> Vector3<f64> {
    seen.predicted - seen.point() - seen.perturbation.anchor
}

/// Direction from the anchor, with the instrument's scale as its length.
fn along(seen: &Seen<'_>) -> Vector3<f64> {
    let from_anchor = from_anchor(seen);
    let distance = from_anchor.norm();
    if distance > 0.0 { from_anchor * ((1.0 + seen.perturbation.scale) / distance) } else { Vector3::zeros() }
}

impl Observe for Distance {
    fn discrepancy(&self, seen: &Seen<'_>) -> Discrepancy {
        let stretched = (1.0 + seen.perturbation.scale) * from_anchor(seen).norm();
        let left = seen.values[0] - stretched - seen.perturbation.reading;
        Discrepancy { place: Vector3::new(left, 0.0, 0.0), turn: Vector3::zeros() }
    }

    fn follows(&self, seen: &Seen<'_>) -> Follows {
        Follows::Line(along(seen))
    }

    fn by_effect(&self, seen: &Seen<'_>, effect: &Sensitivity) -> Vector3<f64> {
        let moved = along(seen).dot(&effect.anchor);
        Vector3::new(moved - effect.scale * from_anchor(seen).norm() - effect.reading, 0.0, 0.0)
    }

    fn own_columns(&self, seen: &Seen<'_>, layout: &Layout, _left: &Matrix3<f64>, rows: &mut Rows<'_>) {
        if let Some(point) = seen.series.point {
            rows.put(0, layout.points[point], along(seen).as_slice());
        }
    }

    fn points(&self, predicted: &[Vector3<f64>], values: &[&[f64]]) -> Vec<Vector3<f64>> {
        let distances: Vec<f64> = values.iter().map(|values| values[0]).collect();
        let middle = predicted.iter().sum::<Vector3<f64>>() / predicted.len().max(1) as f64;
        let distance = distances.iter().sum::<f64>() / distances.len().max(1) as f64;
        let mut anchors = vec![linear_anchor(predicted, &distances)];
        // Both sides of flat data.
        for k in 0..3 {
            anchors.push(middle + Vector3::ith(k, distance));
            anchors.push(middle - Vector3::ith(k, distance));
        }
        anchors
    }

    fn predict(&self, seen: &Seen<'_>, values: &mut Vec<f64>) {
        values.push(from_anchor(seen).norm() * (1.0 + seen.perturbation.scale) + seen.perturbation.reading);
    }

    fn disturb(&self, values: &mut [f64], errors: &mut Disturbance<'_>) {
        values[0] = values[0] + errors.gross.norm() + (errors.draw)(errors.position);
    }
}

/// The anchor from |p|² - d² = 2 p·a - |a|², linear in a and |a|².
fn linear_anchor(points: &[Vector3<f64>], distances: &[f64]) -> Vector3<f64> {
    let mut matrix = DMatrix::<f64>::zeros(4, 4);
    let mut right = DVector::<f64>::zeros(4);
    for (p, d) in points.iter().zip(distances) {
        let coefficients = DVector::from_row_slice(&[2.0 * p.x, 2.0 * p.y, 2.0 * p.z, -1.0]);
        matrix.ger(1.0, &coefficients, &coefficients, 1.0);
        right.axpy(p.norm_squared() - d * d, &coefficients, 1.0);
    }
    let solution = least_squares(matrix, &right);
    Vector3::new(solution[0], solution[1], solution[2])
}
