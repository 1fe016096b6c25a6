//! The evidence as a function of some few sizes: K = Σ aₖ Cₖ, with one amount aₖ for each kind of column and each source of noise.
//!
//! All is done in the space of the values, n × n: kinds may have any number of columns. Meant for some hundred values; of more rows
//! take some.

use crate::products::gram_of;
use crate::triangle::Triangle;
use nalgebra::{DMatrix, DVector};
use std::ops::Range;

/// Cₖ: what a kind adds to the covariance of the values per unit of its amount.
#[derive(Debug, Clone)]
pub enum Part {
    /// Any values may vary together: X Xᵀ, n × n.
    All(DMatrix<f64>),
    /// Values of one row alone: noise.
    Rows(Vec<(Range<usize>, DMatrix<f64>)>),
}

/// The factored covariance of the values for some amounts.
#[derive(Debug, Clone)]
pub struct Components {
    /// K⁻¹.
    inverse: DMatrix<f64>,
    /// K⁻¹ y.
    solved: DVector<f64>,
    /// -2 log p(y) but for n log 2π: log |K| + yᵀ K⁻¹ y.
    pub evidence: f64,
}

impl Part {
    /// That of columns of equal variance.
    pub fn of_columns(columns: &DMatrix<f64>) -> Self {
        let n = columns.nrows();
        let across = columns.transpose();
        Self::All(DMatrix::from_vec(n, n, gram_of(across.as_slice(), across.nrows())))
    }

    /// Sum of the variances that it adds per unit of its amount.
    pub fn trace(&self) -> f64 {
        match self {
            Self::All(all) => all.trace(),
            Self::Rows(blocks) => blocks.iter().map(|(_, block)| block.trace()).sum(),
        }
    }

    fn add_to(&self, amount: f64, all: &mut DMatrix<f64>) {
        match self {
            Self::All(part) => all.iter_mut().zip(part.iter()).for_each(|(cell, own)| *cell += amount * own),
            Self::Rows(blocks) => {
                for (row, own) in blocks {
                    let mut block = all.view_mut((row.start, row.start), own.shape());
                    block += own * amount;
                }
            }
        }
    }
}

impl Components {
    /// For these parts and amounts; `None` where their sum is not positive.
    pub fn of<'p>(data: &DVector<f64>, parts: impl IntoIterator<Item = (&'p Part, f64)>) -> Option<Self> {
        let n = data.len();
        let mut all = DMatrix::zeros(n, n);
        parts.into_iter().for_each(|(part, amount)| part.add_to(amount, &mut all));
        let factor = Triangle::factor(all.as_slice().to_vec(), n)?;
        let roots = factor.inverse_columns();
        let inverse = DMatrix::from_vec(n, n, gram_of(&roots, n));
        let solved = &inverse * data;
        let evidence = factor.log_determinant() + data.dot(&solved);
        evidence.is_finite().then_some(Self { inverse, solved, evidence })
    }

    /// How the evidence rises per unit of a part's amount: tr(K⁻¹ C) - yᵀ K⁻¹ C K⁻¹ y.
    pub fn slope(&self, part: &Part) -> f64 {
        let [wide, narrow] = self.pulls(part);
        wide - narrow
    }

    /// The two sides of that slope: tr(K⁻¹ C), by which a smaller amount is better, and yᵀ K⁻¹ C K⁻¹ y, by which a larger one is. Neither is
    /// negative where C is a covariance.
    pub fn pulls(&self, part: &Part) -> [f64; 2] {
        let of = |block: &DMatrix<f64>, first: usize| {
            let mut sums = [0.0; 2];
            for (k, column) in block.column_iter().enumerate() {
                let inverse = self.inverse.column(first + k);
                let own = self.solved[first + k];
                for (i, cell) in column.iter().enumerate() {
                    sums[0] += cell * inverse[first + i];
                    sums[1] += cell * own * self.solved[first + i];
                }
            }
            sums
        };
        match part {
            Part::All(all) => of(all, 0),
            Part::Rows(blocks) => blocks.iter().fold([0.0; 2], |sums, (row, block)| {
                let own = of(block, row.start);
                [sums[0] + own[0], sums[1] + own[1]]
            }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gram::tests::example;
    use std::f64::consts::TAU;

    #[test]
    fn evidence_and_slopes_are_those_of_the_gram() {
        let problem = example(6, 9);
        let noise = Part::Rows(problem.rows.iter().cloned().zip(problem.noise.iter().cloned()).collect());
        let parts = [
            Part::of_columns(&problem.columns.columns(0, 4).into()),
            Part::of_columns(&problem.columns.columns(4, 5).into()),
            noise,
        ];
        let at = |amounts: [f64; 3]| {
            let mut with = problem.clone();
            with.variances = DVector::from_fn(9, |k, _| amounts[usize::from(k >= 4)]);
            with.noise.iter_mut().for_each(|noise| *noise *= amounts[2]);
            with.gram().unwrap().evidence() - 12.0 * TAU.ln()
        };
        let amounts = [0.7, 0.2, 1.3];
        let found = Components::of(&problem.data, parts.iter().zip(amounts)).unwrap();
        assert!((found.evidence - at(amounts)).abs() < 1e-9);
        for k in 0..3 {
            let moved = |by: f64| {
                let mut moved = amounts;
                moved[k] += by;
                at(moved)
            };
            let wanted = (moved(1e-6) - moved(-1e-6)) / 2e-6;
            assert!((found.slope(&parts[k]) - wanted).abs() < 1e-5 * (1.0 + wanted.abs()));
        }
    }
}
