//! Place and orientation of a target in the instrument's frame.
//!
//! The place as a [position](super::position); of the orientation r = log(Rx⁻¹ Rm (R(T) Rt)⁻¹), rad, base frame. Stored as
//! x, y, z and the rotation matrix column by column.

use super::{Discrepancy, Disturbance, Follows, Frame, Observe, Part, Rows, Seen, Unknowns, position};
use crate::observation::measurements::{MeasurementError, QUATERNION_TOLERANCE};
use crate::observation::parameters::{Layout, Sensitivity};
use denavit_model::nalgebra::{Matrix3, Quaternion, Rotation3, UnitQuaternion, Vector3};
use denavit_model::se3;

#[derive(Debug)]
pub(super) struct Pose;

fn rotation(values: &[f64]) -> Rotation3<f64> {
    Rotation3::from_matrix_unchecked(Matrix3::from_column_slice(&values[3..12]))
}

impl Observe for Pose {
    fn name(&self) -> &'static str {
        "pose"
    }

    fn plural(&self) -> &'static str {
        "poses"
    }

    fn place(&self) -> Part {
        position::PART
    }

    fn turn(&self) -> Option<Part> {
        Some(Part { word: "orientation", height: 3, unit: "rad", by_turn: true })
    }

    fn unknowns(&self) -> Unknowns {
        Unknowns { frame: Frame::Instrument, turn: true, ..Unknowns::default() }
    }

    fn numbers(&self) -> usize {
        12
    }

    fn discrepancy(&self, seen: &Seen<'_>) -> Discrepancy {
        let turned = seen.instrument().rotation.inverse() * rotation(seen.values);
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

    fn has_a_line_of_sight(&self) -> bool {
        true
    }

    fn has_simd_residuals(&self) -> bool {
        true
    }

    fn position(&self, values: &[f64]) -> Option<Vector3<f64>> {
        Some(Vector3::new(values[0], values[1], values[2]))
    }

    fn orientation(&self, values: &[f64]) -> Option<Rotation3<f64>> {
        Some(rotation(values))
    }

    fn predict(&self, seen: &Seen<'_>, values: &mut Vec<f64>) {
        position::predict(seen, values);
        let turn = seen.instrument().rotation * seen.tip.rotation * seen.arm.targets[seen.series.target].rotation;
        values.extend(turn.matrix().iter());
    }

    fn disturb(&self, values: &mut [f64], errors: &mut Disturbance<'_>) {
        position::disturb(values, errors);
        let turn = Rotation3::from_scaled_axis(errors.vector(errors.orientation)) * rotation(values);
        values[3..].copy_from_slice(turn.matrix().as_slice());
    }

    fn columns(&self, target: &str) -> Vec<String> {
        ["x", "y", "z", "qx", "qy", "qz", "qw"].map(|name| format!("{name}{target}")).into()
    }

    fn of_cells(&self, cells: &[f64], values: &mut Vec<f64>) -> Result<f64, MeasurementError> {
        let quaternion = Quaternion::new(cells[6], cells[3], cells[4], cells[5]);
        let length = quaternion.norm();
        if length.is_nan() || (length - 1.0).abs() > QUATERNION_TOLERANCE {
            return Err(MeasurementError::NotAUnitQuaternion { length });
        }
        values.extend_from_slice(&cells[..3]);
        values.extend(UnitQuaternion::new_normalize(quaternion).to_rotation_matrix().matrix().iter());
        Ok((length - 1.0).abs())
    }

    fn to_cells(&self, values: &[f64]) -> Vec<f64> {
        let quaternion = UnitQuaternion::from_rotation_matrix(&rotation(values));
        values[..3].iter().chain(quaternion.coords.iter()).copied().collect()
    }
}
