//! Position and orientation of a target in the instrument's frame.
//!
//! Stored as x, y, z (m) and the rotation matrix column by column.

use super::{Frame, Part, Recorded, Unknowns, position};
use crate::{MeasurementError, QUATERNION_TOLERANCE};
use denavit_model::nalgebra::{Matrix3, Quaternion, Rotation3, UnitQuaternion, Vector3};

#[derive(Debug)]
pub(super) struct Pose;

/// The orientation of a stored pose.
pub fn rotation(values: &[f64]) -> Rotation3<f64> {
    Rotation3::from_matrix_unchecked(Matrix3::from_column_slice(&values[3..12]))
}

impl Recorded for Pose {
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
