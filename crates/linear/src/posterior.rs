//! The posterior of the coefficients, and the prediction of other rows.

use crate::gram::Gram;
use nalgebra::{DMatrix, DVector};

/// Mean and covariance of the coefficients given the data.
#[derive(Debug, Clone, PartialEq)]
pub struct Posterior {
    /// m = D Bᵀ (I + B Bᵀ)⁻¹ z, p.
    pub mean: DVector<f64>,
    /// S = D (I - Bᵀ (I + B Bᵀ)⁻¹ B) D, p × p.
    pub covariance: DMatrix<f64>,
}

impl Gram {
    /// m, without the cost of a covariance.
    pub fn mean(&self) -> DVector<f64> {
        self.scaled.tr_mul(&self.solve(&self.whitened)).component_mul(&self.deviations)
    }

    /// Mean and covariance of the coefficients.
    pub fn posterior(&self) -> Posterior {
        let root = self.root();
        let p = root.ncols();
        let mut covariance = DMatrix::from_vec(p, p, crate::products::gram_of(root.as_slice(), root.nrows()));
        if self.in_rows {
            covariance = DMatrix::identity(p, p) - covariance;
        }
        for i in 0..p {
            for k in 0..p {
                covariance[(i, k)] *= self.deviations[i] * self.deviations[k];
            }
        }
        Posterior { mean: self.mean(), covariance }
    }
}

impl Posterior {
    /// Mean Z m and covariance Z S Zᵀ of noise-free rows with these columns.
    pub fn predict(&self, columns: &DMatrix<f64>) -> (DVector<f64>, DMatrix<f64>) {
        (columns * &self.mean, columns * &self.covariance * columns.transpose())
    }

    /// The same of some coefficients, whatever the others are.
    #[must_use]
    pub fn marginal(&self, kept: &[usize]) -> Self {
        let covariance = self.covariance.select_rows(kept).select_columns(kept);
        Self { mean: DVector::from_fn(kept.len(), |k, _| self.mean[kept[k]]), covariance }
    }
}

#[cfg(test)]
mod tests {
    use crate::gram::tests::{covariance, example};
    use nalgebra::DMatrix;

    #[test]
    fn posterior_is_that_of_joint_normal_numbers() {
        for (rows, coefficients) in [(4, 30), (20, 6)] {
            let problem = example(rows, coefficients);
            let prior = DMatrix::from_diagonal(&problem.variances);
            let gain = &prior * problem.columns.transpose() * covariance(&problem).try_inverse().unwrap();
            let found = problem.clone().gram().unwrap().posterior();
            assert!((&found.mean - &gain * &problem.data).norm() < 1e-10);
            let wanted = &prior - &gain * &problem.columns * &prior;
            assert!((&found.covariance - wanted).norm() < 1e-10);
            let (mean, spread) = found.predict(&problem.columns);
            assert!((mean - &problem.columns * &gain * &problem.data).norm() < 1e-10);
            assert!(spread.diagonal().iter().all(|variance| *variance > 0.0));
            let some = found.marginal(&[2, 0]);
            assert_eq!((some.mean[1], some.covariance[(0, 1)]), (found.mean[0], found.covariance[(2, 0)]));
        }
    }
}
