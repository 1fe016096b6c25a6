//! Homogeneous matrices, row by row.

use crate::arrays::Configurations;
use crate::errors::argument;
use denavit_model::nalgebra::{Matrix3, Rotation3, Vector3};
use denavit_model::{Pose, se3};
use pyo3::prelude::*;

/// A rotation's products of columns may be off by this: matrices that are written with three digits are.
const NO_ROTATION: f64 = 5e-3;

/// An argument error where `matrices`, sixteen numbers each, are no poses.
#[pyfunction]
pub fn check_poses(name: &str, matrices: &Bound<'_, PyAny>) -> PyResult<()> {
    let matrices = Configurations::of(matrices, 16)?;
    let values = matrices.values()?;
    if !values.iter().all(|value| value.is_finite()) {
        return Err(argument(format!("{name} has a number that is not finite")));
    }
    if !values.as_chunks::<16>().0.iter().all(is_rotation) {
        let what = "the upper left 3 × 3 of a pose is no rotation; give columns of length 1 at right angles";
        return Err(argument(what));
    }
    Ok(())
}

fn is_rotation(matrix: &[f64; 16]) -> bool {
    let rotation = rotation(matrix);
    (rotation.tr_mul(&rotation) - Matrix3::identity()).amax() <= NO_ROTATION && rotation.determinant() > 0.0
}

fn rotation(matrix: &[f64; 16]) -> Matrix3<f64> {
    Matrix3::from_fn(|row, column| matrix[4 * row + column])
}

/// The pose whose rotation is the nearest to the matrix's.
pub fn pose(matrix: &[f64; 16]) -> Pose {
    let rotation = Rotation3::from_matrix_unchecked(rotation(matrix));
    se3::pose(se3::orthonormalised(&rotation), Vector3::new(matrix[3], matrix[7], matrix[11]))
}
