//! Every measured row predicted from all others, without a new fit.

use crate::gram::Gram;
use nalgebra::{DMatrix, DVector};

/// A row predicted from all others.
#[derive(Debug, Clone, PartialEq)]
pub struct LeftOut {
    /// Measured minus predicted.
    pub residual: DVector<f64>,
    /// Its covariance: of the prediction plus the row's own noise.
    pub covariance: DMatrix<f64>,
}

impl Gram {
    /// With K = I + B Bᵀ, e = K⁻¹ z and L the row's noise: e₋ₙ = L (K⁻¹ₙₙ)⁻¹ eₙ, with the covariance L (K⁻¹ₙₙ)⁻¹ Lᵀ.
    ///
    /// `None` where a block of K⁻¹ is not positive, due to rounding.
    pub fn leave_out(&self) -> Option<Vec<LeftOut>> {
        let e = self.solve(&self.whitened);
        let blocks = self.inverse_blocks();
        let one = |((row, lower), block): ((&std::ops::Range<usize>, &DMatrix<f64>), DMatrix<f64>)| {
            let factor = block.cholesky()?;
            let own = factor.solve(&e.rows(row.start, row.len()).into_owned());
            Some(LeftOut { residual: lower * own, covariance: lower * factor.inverse() * lower.transpose() })
        };
        self.rows.iter().zip(&self.noise).zip(blocks).map(one).collect()
    }
}

#[cfg(test)]
mod tests {
    use crate::gram::tests::example;

    #[test]
    fn a_row_left_out_is_as_if_it_had_never_been_there() {
        for (rows, coefficients) in [(5, 30), (20, 6)] {
            let problem = example(rows, coefficients);
            let found = problem.clone().gram().unwrap().leave_out().unwrap();
            for (out, found) in found.iter().enumerate() {
                let mut rest = problem.clone();
                rest.columns = rest.columns.remove_rows(2 * out, 2);
                rest.data = rest.data.remove_rows(2 * out, 2);
                rest.noise.remove(out);
                rest.rows.pop();
                let own = problem.columns.rows(2 * out, 2).into_owned();
                let (mean, covariance) = rest.gram().unwrap().posterior().predict(&own);
                let measured = problem.data.rows(2 * out, 2);
                assert!((&found.residual - (measured - mean)).norm() < 1e-9);
                assert!((&found.covariance - (covariance + &problem.noise[out])).norm() < 1e-9);
            }
        }
    }
}
