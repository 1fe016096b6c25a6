//! Position and orientation of a target in the instrument's frame.
//!
//! The position as in [position](super::position); the orientation's r = log(Rx⁻¹ Rm (R(T) Rt)⁻¹), rad, base frame. Stored as
//! x, y, z and the rotation matrix column by column.

use super::{Discrepancy, Disturbance, Follows, Observe, Rows, Seen, position};
use crate::parameters::{Layout, Sensitivity};
use denavit_measurements::kinds::rotation_of_pose;
use denavit_model::nalgebra::{Matrix3, Rotation3, Vector3};
use denavit_model::se3;

#[derive(Debug)]
pub(super) struct Pose;

impl Observe for Pose {
    fn discrepancy(&self, seen: &Seen<'_>) -> Discrepancy {
        let turned = seen.instrument().rotation.inverse() * rotation_of_pose(seen.values);
        let predicted = seen.tip.rotation * seen.arm.targets[seen.series.target].rotation;
        let turn = se3::rotation_vector(&(turned * predicted.inverse()));
        Discrepancy { place: position::in_base(seen) - seen.predicted, turn }
    }

    fn follows(&self, _seen: &Seen<'_>) -> Follows {
        Follows::Whole
    }

    fn by_effect(&self, seen: &Seen<'_>, effect: &Sensitivity) -> Vector3<f64> {
        position::by_instrument(seen, effect)
    }

    fn own_columns(&self, seen: &Seen<'_>, layout: &Layout, left: &Matrix3<f64>, rows: &mut Rows<'_>) {
        position::instrument_columns(seen, layout, rows);
        let Some(column) = layout.instruments[seen.series.setup] else { return };
        for row in 0..3 {
            rows.put(3 + row, column, &[-left[(row, 0)], -left[(row, 1)], -left[(row, 2)]]);
        }
    }

    fn predict(&self, seen: &Seen<'_>, values: &mut Vec<f64>) {
        position::predict(seen, values);
        let turn = seen.instrument().rotation * seen.tip.rotation * seen.arm.targets[seen.series.target].rotation;
        values.extend(turn.matrix().iter());
    }

    fn disturb(&self, values: &mut [f64], errors: &mut Disturbance<'_>) {
        position::disturb(values, errors);
        let turn = Rotation3::from_scaled_axis(errors.vector(errors.orientation)) * rotation_of_pose(values);
        values[3..].copy_from_slice(turn.matrix().as_slice());
    }
}
