//! A ball on the tip that touches a plane: a plate, a table, a wall, of which only the flatness is known.
//!
//! r = -(X p)·z, m, with X the frame of the plane z = 0, and p the centre of the ball. No value is read: the
//! joint readings are the measurement. The ball's radius is part of the plane's estimated position.

use super::{Discrepancy, Disturbance, Follows, Observe, Rows, Seen};
use crate::parameters::{Layout, Sensitivity};
use denavit_model::nalgebra::{Matrix2, Matrix3, Point3, Rotation3, Vector2, Vector3};
use denavit_model::{Pose, se3};

#[derive(Debug)]
pub(super) struct Plane;

/// The target in the plane's own frame, m.
pub(super) fn in_plane(seen: &Seen<'_>) -> Vector3<f64> {
    (seen.instrument() * Point3::from(seen.predicted)).coords
}

/// Direction of the plane's normal, base frame.
pub(super) fn normal(seen: &Seen<'_>) -> Vector3<f64> {
    seen.instrument().rotation.inverse() * Vector3::z()
}

/// Columns of the plane with heights scaled by `stretched`: rotations about its x and y, shift along its z.
pub(super) fn plane_columns(seen: &Seen<'_>, layout: &Layout, stretched: f64, rows: &mut Rows<'_>) {
    let Some(column) = layout.planes[seen.series.setup] else { return };
    let there = in_plane(seen);
    rows.put(0, column, &[-there.y * stretched, there.x * stretched, -stretched]);
}

/// Gauss-Newton steps from the direction of least spread to the least squares of the heights.
const STEPS: usize = 20;

/// The least squares plane for these positions (m, base frame) and heights above it, m: from the direction of least spread, with
/// either sign.
pub(super) fn through(places: &[Vector3<f64>], heights: &[f64]) -> Option<Pose> {
    let count = places.len() as f64;
    if places.is_empty() {
        return None;
    }
    let middle = places.iter().sum::<Vector3<f64>>() / count;
    let height = heights.iter().sum::<f64>() / count;
    let spread = places.iter().map(|place| (place - middle) * (place - middle).transpose()).sum::<Matrix3<f64>>();
    let along = spread.symmetric_eigen();
    let normal = along.eigenvectors.column(along.eigenvalues.imin()).normalize();
    let left = |normal: &Vector3<f64>| -> f64 {
        let pairs = places.iter().zip(heights);
        pairs.map(|(place, read)| (read - height - normal.dot(&(place - middle))).powi(2)).sum()
    };
    let mut normal = if left(&-normal) < left(&normal) { -normal } else { normal };
    for _ in 0..STEPS {
        let across = normal.cross(&Vector3::ith(normal.iamin(), 1.0)).normalize();
        let beside = normal.cross(&across);
        let (mut square, mut pull) = (Matrix2::zeros(), Vector2::zeros());
        for (place, read) in places.iter().zip(heights) {
            let from_middle = place - middle;
            let column = Vector2::new(across.dot(&from_middle), beside.dot(&from_middle));
            square += column * column.transpose();
            pull += column * (read - height - normal.dot(&from_middle));
        }
        let Some(step) = square.try_inverse().map(|inverse| inverse * pull) else { break };
        normal = (normal + across * step.x + beside * step.y).normalize();
    }
    let rotation = se3::least_rotation(&normal, &Vector3::z());
    let rotation = Rotation3::from_matrix_unchecked(*rotation.matrix());
    Some(se3::pose(rotation, Vector3::new(0.0, 0.0, height) - rotation * middle))
}

impl Observe for Plane {
    fn discrepancy(&self, seen: &Seen<'_>) -> Discrepancy {
        Discrepancy { place: Vector3::new(-in_plane(seen).z, 0.0, 0.0), turn: Vector3::zeros() }
    }

    fn follows(&self, seen: &Seen<'_>) -> Follows {
        Follows::Line(normal(seen))
    }

    fn own_columns(&self, seen: &Seen<'_>, layout: &Layout, _left: &Matrix3<f64>, rows: &mut Rows<'_>) {
        plane_columns(seen, layout, 1.0, rows);
    }

    fn plane(&self, predicted: &[Vector3<f64>], _values: &[&[f64]]) -> Option<Pose> {
        through(predicted, &vec![0.0; predicted.len()])
    }

    fn predict(&self, _seen: &Seen<'_>, _values: &mut Vec<f64>) {}

    fn disturb(&self, _values: &mut [f64], _errors: &mut Disturbance<'_>) {}

    fn by_effect(&self, _seen: &Seen<'_>, _effect: &Sensitivity) -> Vector3<f64> {
        Vector3::zeros()
    }
}
