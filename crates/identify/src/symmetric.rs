//! Inverses and factors of symmetric matrices that are positive definite up to rounding.

use denavit_model::nalgebra::DMatrix;

/// Inverse of a covariance or a precision.
///
/// If rounding made it indefinite, eigenvalues are raised to `least` (or to the rounding of the largest, if that is more), which limits
/// the precision of a direction. NaN throughout where the matrix contains NaN.
///
/// # Shape and units
/// Rows and columns scaled to one unit, such as tolerances; `least` in that unit, squared.
pub(crate) fn inverse(matrix: &DMatrix<f64>, least: f64) -> DMatrix<f64> {
    match matrix.clone().cholesky() {
        Some(factor) => factor.inverse(),
        None => by_eigenvalues(matrix, least, f64::recip),
    }
}

/// Lower triangle L with L Lᵀ the matrix, raised as in `inverse`; NaN throughout where the matrix contains NaN.
pub fn lower(matrix: &DMatrix<f64>, least: f64) -> DMatrix<f64> {
    let raised = || by_eigenvalues(matrix, least, |value| value);
    let factor = matrix.clone().cholesky().or_else(|| raised().cholesky());
    factor.map_or_else(|| DMatrix::from_element(matrix.nrows(), matrix.ncols(), f64::NAN), |factor| factor.l())
}

fn by_eigenvalues(matrix: &DMatrix<f64>, least: f64, of: impl Fn(f64) -> f64) -> DMatrix<f64> {
    let size = matrix.nrows();
    if matrix.iter().any(|cell| !cell.is_finite()) {
        return DMatrix::from_element(size, size, f64::NAN);
    }
    let eigen = matrix.clone().symmetric_eigen();
    let rounding = f64::EPSILON * size as f64 * eigen.eigenvalues.amax();
    let raised = eigen.eigenvalues.map(|value| of(value.max(least).max(rounding).max(f64::MIN_POSITIVE)));
    &eigen.eigenvectors * DMatrix::from_diagonal(&raised) * eigen.eigenvectors.transpose()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_rounding_left_below_zero_is_known_as_well_as_the_least_and_no_better() {
        let matrix = DMatrix::from_row_slice(2, 2, &[1.0, 1.0 + 1e-12, 1.0 + 1e-12, 1.0]);
        assert!(matrix.clone().cholesky().is_none());
        let inverse = inverse(&matrix, 1e-6);
        // Along (1, -1)/√2 the variance is `least`.
        assert!((inverse[(0, 0)] - inverse[(0, 1)] - 1e6).abs() < 1.0, "{inverse}");
        let lower = lower(&matrix, 1e-6);
        assert!((&lower * lower.transpose() - matrix).amax() < 1e-6);
    }

    #[test]
    fn what_is_no_number_stays_none() {
        let matrix = DMatrix::from_row_slice(2, 2, &[1.0, f64::NAN, f64::NAN, 1.0]);
        assert!(inverse(&matrix, 0.0).iter().all(|cell| cell.is_nan()));
        assert!(lower(&matrix, 0.0).iter().all(|cell| cell.is_nan()));
    }
}
