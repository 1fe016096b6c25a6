//! A dial gauge on the tip that touches a plate: height of its point above the plate, from an unknown zero.
//!
//! r = m - (1 + scale) (X p)·z, m, with X the frame of the plate, whose plane z = 0 is where the gauge reads 0, and p the
//! gauge's point when it reads 0. Readings of one setup are differences along the plate's normal, which is fitted too: a
//! direction known to a milliradian would cause errors of a tenth of a millimetre over a hand's breadth.

use super::plane::{in_plane, normal, plane_columns, through};
use super::{Discrepancy, Disturbance, Follows, Observe, Rows, Seen};
use crate::parameters::{Layout, Sensitivity};
use denavit_model::Pose;
use denavit_model::nalgebra::{Matrix3, Vector3};

#[derive(Debug)]
pub(super) struct Dial;

fn predicted(seen: &Seen<'_>) -> f64 {
    (1.0 + seen.perturbation.scale) * in_plane(seen).z + seen.perturbation.reading
}

impl Observe for Dial {
    fn discrepancy(&self, seen: &Seen<'_>) -> Discrepancy {
        Discrepancy { place: Vector3::new(seen.values[0] - predicted(seen), 0.0, 0.0), turn: Vector3::zeros() }
    }

    fn follows(&self, seen: &Seen<'_>) -> Follows {
        Follows::Line(normal(seen) * (1.0 + seen.perturbation.scale))
    }

    fn by_effect(&self, seen: &Seen<'_>, effect: &Sensitivity) -> Vector3<f64> {
        Vector3::new(-effect.scale * in_plane(seen).z - effect.reading, 0.0, 0.0)
    }

    fn own_columns(&self, seen: &Seen<'_>, layout: &Layout, _left: &Matrix3<f64>, rows: &mut Rows<'_>) {
        plane_columns(seen, layout, 1.0 + seen.perturbation.scale, rows);
    }

    fn plane(&self, predicted: &[Vector3<f64>], values: &[&[f64]]) -> Option<Pose> {
        through(predicted, &values.iter().map(|values| values[0]).collect::<Vec<f64>>())
    }

    fn predict(&self, seen: &Seen<'_>, values: &mut Vec<f64>) {
        values.push(predicted(seen));
    }

    fn disturb(&self, values: &mut [f64], errors: &mut Disturbance<'_>) {
        values[0] = values[0] + errors.gross.norm() + (errors.draw)(errors.position);
    }
}
