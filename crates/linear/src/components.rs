//! The evidence as a function of a few sizes: K = Σ aₖ Cₖ, with one amount aₖ for each kind of column and each source of noise.
//!
//! Computed in the space of the values, n × n: kinds may have any number of columns. Meant for a few hundred values; use a subset of
//! more rows.

use crate::products::{cross_gram, gram_of};
use crate::triangle::{Triangle, dot};
use nalgebra::{DMatrix, DVector};
use std::ops::Range;

/// Cₖ: covariance of the values per unit of a kind's amount.
#[derive(Debug, Clone)]
pub enum Part {
    /// A full covariance: X Xᵀ, n × n.
    All(DMatrix<f64>),
    /// A covariance within rows: noise.
    Rows(Vec<(Range<usize>, DMatrix<f64>)>),
}

/// The factored covariance of the values for some amounts.
#[derive(Debug, Clone)]
pub struct Components {
    /// K⁻¹.
    inverse: DMatrix<f64>,
    /// K⁻¹ y.
    solved: DVector<f64>,
    /// -2 log p(y) without n log 2π: log |K| + yᵀ K⁻¹ y.
    pub evidence: f64,
}

impl Part {
    /// The part of columns of equal variance.
    pub fn of_columns(columns: &DMatrix<f64>) -> Self {
        let n = columns.nrows();
        let across = columns.transpose();
        Self::All(DMatrix::from_vec(n, n, gram_of(across.as_slice(), across.nrows())))
    }

    /// Sum of its variances per unit of its amount.
    pub fn trace(&self) -> f64 {
        match self {
            Self::All(all) => all.trace(),
            Self::Rows(blocks) => blocks.iter().map(|(_, block)| block.trace()).sum(),
        }
    }

    /// Adds to the triangle of a symmetric matrix that holds the cells of each column up to its diagonal.
    fn add_to(&self, amount: f64, all: &mut DMatrix<f64>) {
        let n = all.nrows();
        let mut add = |block: &DMatrix<f64>, first: usize| {
            let size = block.nrows();
            for (k, own) in block.as_slice().chunks_exact(size).enumerate() {
                let column = (first + k) * n + first;
                let cells = &mut all.as_mut_slice()[column..=column + k];
                cells.iter_mut().zip(own).for_each(|(cell, own)| *cell += amount * own);
            }
        };
        match self {
            Self::All(part) => add(part, 0),
            Self::Rows(blocks) => blocks.iter().for_each(|(row, own)| add(own, row.start)),
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

    /// The two terms of the derivative of the evidence by a part's amount, tr(K⁻¹ C) - yᵀ K⁻¹ C K⁻¹ y.
    pub fn pull(&self, part: &Part) -> Pull {
        let n = self.solved.len();
        let (mut wide, mut along) = (0.0, DVector::zeros(n));
        let mut of = |block: &DMatrix<f64>, first: usize| {
            let rows = first..first + block.nrows();
            for (k, cells) in block.as_slice().chunks_exact(block.nrows()).enumerate() {
                let column = &self.inverse.as_slice()[(first + k) * n..(first + k + 1) * n];
                wide += dot(cells, &column[rows.clone()]);
                along[first + k] += dot(cells, &self.solved.as_slice()[rows.clone()]);
            }
        };
        match part {
            Part::All(all) => of(all, 0),
            Part::Rows(blocks) => blocks.iter().for_each(|(row, block)| of(block, row.start)),
        }
        Pull { wide, narrow: along.dot(&self.solved), along }
    }

    /// Aᵀ K⁻¹ A for columns Cₖ K⁻¹ y of [`Pull::along`]: with the amounts, the average of the expected and the observed information about them
    /// (Gilmour, Thompson, Cullis 1995, Biometrics 51, 1440), of twice the log likelihood.
    pub fn information(&self, along: &DMatrix<f64>) -> DMatrix<f64> {
        let (n, count) = along.shape();
        let solved = cross_gram(self.inverse.as_slice(), along.as_slice(), n);
        DMatrix::from_vec(count, count, cross_gram(along.as_slice(), &solved, n))
    }
}

/// The derivative of the evidence by the amount of a part.
#[derive(Debug, Clone)]
pub struct Pull {
    /// tr(K⁻¹ C), which favours a smaller amount; not negative where C is a covariance.
    pub wide: f64,
    /// yᵀ K⁻¹ C K⁻¹ y, which favours a larger one; the same.
    pub narrow: f64,
    /// C K⁻¹ y.
    pub along: DVector<f64>,
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
            let Pull { wide, narrow, .. } = found.pull(&parts[k]);
            assert!((wide - narrow - wanted).abs() < 1e-5 * (1.0 + wanted.abs()));
        }
    }

    #[test]
    fn information_is_the_average_of_what_is_expected_and_observed() {
        let problem = example(6, 9);
        let parts: Vec<Part> =
            [(0, 4), (4, 5)].map(|(from, count)| Part::of_columns(&problem.columns.columns(from, count).into())).into();
        let noise = Part::Rows(problem.rows.iter().cloned().zip(problem.noise.iter().cloned()).collect());
        let at = |amounts: [f64; 2]| {
            Components::of(&problem.data, parts.iter().zip(amounts).chain([(&noise, 1.0)])).unwrap()
        };
        let slope = |amounts: [f64; 2], k: usize| {
            let pull = at(amounts).pull(&parts[k]);
            pull.wide - pull.narrow
        };
        let (amounts, found) = ([0.7, 0.2], at([0.7, 0.2]));
        let along = DMatrix::from_columns(&[0, 1].map(|k| found.pull(&parts[k]).along));
        let average = found.information(&along);
        let whole = |k: usize| {
            let Part::All(part) = &parts[k] else { unreachable!() };
            part.clone()
        };
        for (i, j) in [(0, 0), (0, 1), (1, 1)] {
            let mut moved = [amounts; 2];
            moved[0][j] += 1e-6;
            moved[1][j] -= 1e-6;
            let observed = (slope(moved[0], i) - slope(moved[1], i)) / 2e-6;
            let expected = (&found.inverse * whole(i) * &found.inverse * whole(j)).trace();
            assert!((average[(i, j)] - 0.5 * (observed + expected)).abs() < 1e-5 * (1.0 + expected), "{i} {j}");
        }
    }
}
