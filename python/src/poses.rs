//! Homogeneous matrices, row by row.

use crate::arrays::{contiguous, in_order, shape_words};
use crate::errors::argument;
use denavit_model::nalgebra::{Matrix3, Rotation3, Vector3};
use denavit_model::{Pose, se3};
use numpy::{PyArrayDyn, PyArrayMethods as _, PyReadonlyArrayDyn, PyUntypedArrayMethods as _};
use pyo3::prelude::*;
use std::ops::Deref as _;

/// A rotation's products of columns may be off by this: matrices that are written with three digits are.
const NO_ROTATION: f64 = 5e-3;

/// One or many homogeneous matrices: the last two axes are theirs.
pub struct Matrices<'py> {
    array: PyReadonlyArrayDyn<'py, f64>,
}

impl<'py> Matrices<'py> {
    /// An argument error where `name` has another shape, or is not a pose.
    pub fn of(name: &str, given: &Bound<'py, PyAny>) -> PyResult<Self> {
        let array = match in_order(given) {
            Some(array) => array,
            None => {
                contiguous(given).map_err(|error| argument(format!("{name} is not an array of numbers ({error})")))?
            }
        };
        if !array.shape().ends_with(&[4, 4]) {
            let shape = shape_words(array.shape());
            return Err(argument(format!("{name} has shape {shape}; give homogeneous matrices, shape (..., 4, 4)")));
        }
        let array = array.try_readonly().map_err(|error| argument(format!("{name}: {error}")))?;
        let matrices = Self { array };
        let each = matrices.each()?;
        if !each.as_flattened().iter().all(|value| value.is_finite()) {
            return Err(argument(format!("{name} contains a number that is not finite")));
        }
        if !each.iter().all(is_rotation) {
            let what = "the upper left 3 × 3 of a pose is not a rotation; give orthogonal columns of length 1";
            return Err(argument(what));
        }
        Ok(matrices)
    }

    /// The sixteen numbers of each, row by row.
    pub fn each(&self) -> PyResult<&[[f64; 16]]> {
        let values = self.array.as_slice().map_err(|error| argument(format!("poses: {error}")))?;
        Ok(values.as_chunks::<16>().0)
    }

    /// The array's shape without its last two axes, then `more`.
    pub fn shape(&self, more: &[usize]) -> Vec<usize> {
        let shape = self.array.shape();
        [&shape[..shape.len() - 2], more].concat()
    }
}

/// Homogeneous matrices as an array of shape `(..., 4, 4)`; an argument error where they are not poses.
#[pyfunction]
pub fn pose_matrices<'py>(name: &str, poses: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
    Ok(Matrices::of(name, poses)?.array.deref().clone())
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
