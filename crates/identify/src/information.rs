//! Information of a fit's rows on the joints' parameters, without the prior: it can be pooled over robots of one drawing.
//!
//! At the end of a fit the pull of the rows on the parameters balances that of the prior. With C the joints' covariance, P the
//! prior's precision, δ the deviation from the prior's mean, in the directions that the common frame does not absorb,
//!
//! ```text
//! information Λ = C⁻¹ - P      pull η = Λ θ + P δ
//! ```
//! so that the rows' own likelihood is exp(-½ θᵀ Λ θ + ηᵀ θ) near the fit. Directions that the rows do not determine have no
//! information, and need no large standard deviation. Instruments, targets and effects are free.

use crate::prior::free_of_common_motions;
use crate::solve::Fit;
use denavit_model::nalgebra::{DMatrix, DVector};

/// Information matrix and vector of the joints' parameters.
#[derive(Debug, Clone, PartialEq)]
pub struct Information {
    /// Names of the parameters, such as `elbow_joint.turn_x`.
    pub parameters: Vec<String>,
    /// Λ, a row and a column for each, in 1 over the product of their units.
    pub matrix: DMatrix<f64>,
    /// η, in 1 over the parameters' units.
    pub pull: DVector<f64>,
}

impl Information {
    /// The information of a fit's rows; `None` where it has no free axes or nothing is identifiable.
    pub fn of<E>(fit: &Fit<E>) -> Option<Self> {
        let count = fit.layout.joints.len();
        if count == 0 {
            return None;
        }
        let parameters = &fit.layout.parameters[fit.layout.joints.clone()];
        let unit = DVector::from_fn(count, |k, _| parameters[k].tolerance.unwrap_or(1.0));
        let free = free_of_common_motions(parameters, &fit.layout.bases, &fit.layout.frames);
        if free.ncols() == 0 {
            return None;
        }
        let prior = &fit.layout.prior;
        let covariance = DMatrix::from_fn(count, count, |i, k| fit.covariance[(i, k)] / (unit[i] * unit[k]));
        let precision = DMatrix::from_fn(count, count, |i, k| prior.precision[(i, k)] * unit[i] * unit[k]);
        let inverse = (free.transpose() * covariance * &free).cholesky()?.inverse();
        let matrix = inverse - free.transpose() * &precision * &free;
        let eigen = (0.5 * (&matrix + matrix.transpose())).symmetric_eigen();
        let known = eigen.eigenvalues.map(|value| value.max(0.0));
        let matrix = &eigen.eigenvectors * DMatrix::from_diagonal(&known) * eigen.eigenvectors.transpose();
        let change = fit.layout.difference(&fit.arm, &fit.arm);
        let change = DVector::from_fn(count, |k, _| change[k] / unit[k]);
        let perturbation = fit.layout.perturbation(&fit.arm, &fit.arm).component_div(&unit);
        let pull = &matrix * (free.transpose() * change) + free.transpose() * (precision * perturbation);
        let whole = &free * matrix * free.transpose();
        Some(Self {
            parameters: parameters.iter().map(|parameter| parameter.name.clone()).collect(),
            matrix: DMatrix::from_fn(count, count, |i, k| whole[(i, k)] / (unit[i] * unit[k])),
            pull: (&free * pull).component_div(&unit),
        })
    }
}
