//! The evidence: the probability of the data, averaged over the coefficients.

use crate::gram::Gram;
use nalgebra::DVector;
use std::f64::consts::TAU;

impl Gram {
    /// -2 log p(y) = n log 2π + log |R| + log |I + B Bᵀ| + zᵀ (I + B Bᵀ)⁻¹ z.
    ///
    /// With a wide prior of some coefficients (frames, targets) it is the restricted likelihood up to a constant.
    pub fn evidence(&self) -> f64 {
        let of_noise: f64 =
            self.noise.iter().flat_map(|lower| lower.diagonal().iter().map(|d| d.ln()).collect::<Vec<_>>()).sum();
        let fit = self.whitened.dot(&self.solve(&self.whitened));
        self.size().0 as f64 * TAU.ln() + 2.0 * of_noise + self.factor.log_determinant() + fit
    }

    /// Derivatives of [`Gram::evidence`] by the logarithm of each prior variance: sᵢ - uᵢ², with s the diagonal of Bᵀ K⁻¹ B, u = Bᵀ K⁻¹ z.
    pub fn evidence_by_variances(&self) -> DVector<f64> {
        let u = self.scaled.tr_mul(&self.solve(&self.whitened));
        self.shrunk() - u.component_mul(&u)
    }
}

#[cfg(test)]
mod tests {
    use crate::gram::tests::{covariance, example};
    use std::f64::consts::TAU;

    #[test]
    fn evidence_is_that_of_the_normal_distribution() {
        for (rows, coefficients) in [(4, 30), (20, 6), (1, 1)] {
            let problem = example(rows, coefficients);
            let factor = covariance(&problem).cholesky().unwrap();
            let determinant = 2.0 * factor.l().diagonal().iter().map(|d| d.ln()).sum::<f64>();
            let wanted = 2.0 * rows as f64 * TAU.ln() + determinant + problem.data.dot(&factor.solve(&problem.data));
            assert!((problem.clone().gram().unwrap().evidence() - wanted).abs() < 1e-9);
        }
    }

    #[test]
    fn derivatives_are_those_of_finite_differences() {
        for (rows, coefficients) in [(4, 12), (12, 5)] {
            let problem = example(rows, coefficients);
            let found = problem.clone().gram().unwrap().evidence_by_variances();
            for k in 0..coefficients {
                let at = |step: f64| {
                    let mut moved = problem.clone();
                    moved.variances[k] *= f64::exp(step);
                    moved.gram().unwrap().evidence()
                };
                let wanted = (at(1e-5) - at(-1e-5)) / 2e-5;
                assert!((found[k] - wanted).abs() < 1e-6 * (1.0 + wanted.abs()), "{k}: {} {wanted}", found[k]);
            }
        }
    }
}
