//! Linear least squares that may have no unique solution.

use denavit_model::nalgebra::{DMatrix, DVector};

/// The solution of least norm, small singular values left out.
pub(crate) fn least_squares(matrix: DMatrix<f64>, right: &DVector<f64>) -> DVector<f64> {
    let svd = matrix.svd(true, true);
    let limit = 1e-9 * svd.singular_values.max();
    svd.solve(right, limit).expect("both sets of singular vectors were asked for")
}
