//! Columns, prior and noise, scaled to unit noise and unit variance, and factored on the smaller side.

use crate::products::{cross_gram, gram_of};
use crate::triangle::Triangle;
use nalgebra::{DMatrix, DVector};
use std::ops::Range;

/// `y = X b + e` before it is factored.
///
/// # Shape and units
/// n values, p coefficients; values of one measured row are adjacent. Units are the caller's: `columns` are values per
/// coefficient, `variances` squares of coefficients, `noise` products of values.
#[derive(Debug, Clone)]
pub struct Problem {
    /// X, n × p.
    pub columns: DMatrix<f64>,
    /// y, n.
    pub data: DVector<f64>,
    /// The values of each row, in order and without gaps.
    pub rows: Vec<Range<usize>>,
    /// Covariance of each row's noise.
    pub noise: Vec<DMatrix<f64>>,
    /// Prior variance of each coefficient, p.
    pub variances: DVector<f64>,
}

/// The factored model. With L Lᵀ = R and D = diag √v: B = L⁻¹ X D and z = L⁻¹ y, so that z = B u + unit noise, u ~ N(0, I).
#[derive(Debug, Clone)]
pub struct Gram {
    /// B, n × p.
    pub(crate) scaled: DMatrix<f64>,
    /// z, n.
    pub(crate) whitened: DVector<f64>,
    /// √v, p.
    pub(crate) deviations: DVector<f64>,
    /// The values of each row.
    pub(crate) rows: Vec<Range<usize>>,
    /// L of each row.
    pub(crate) noise: Vec<DMatrix<f64>>,
    pub(crate) factor: Triangle,
    /// Whether the factor is that of I + B Bᵀ, n × n, used if there are fewer values than coefficients; else of I + Bᵀ B, p × p.
    pub(crate) in_rows: bool,
}

impl Problem {
    /// Factored; `None` where a covariance is not positive or a number not finite.
    pub fn gram(self) -> Option<Gram> {
        let (mut scaled, mut whitened) = (self.columns, self.data);
        let deviations = self.variances.map(f64::sqrt);
        for (mut column, deviation) in scaled.column_iter_mut().zip(deviations.iter()) {
            column.scale_mut(*deviation);
        }
        let mut noise = Vec::with_capacity(self.rows.len());
        for (row, covariance) in self.rows.iter().zip(&self.noise) {
            let lower = covariance.clone().cholesky()?.unpack();
            lower.solve_lower_triangular_mut(&mut scaled.rows_mut(row.start, row.len()));
            lower.solve_lower_triangular_mut(&mut whitened.rows_mut(row.start, row.len()));
            noise.push(lower);
        }
        if scaled.iter().chain(whitened.iter()).any(|cell| !cell.is_finite()) {
            return None;
        }
        let in_rows = scaled.nrows() < scaled.ncols();
        let factor = if in_rows { one_more(&scaled.transpose()) } else { one_more(&scaled) }?;
        Some(Gram { scaled, whitened, deviations, rows: self.rows, noise, factor, in_rows })
    }
}

/// The factored model without its values: for steps to the most probable coefficients of nearby problems.
#[derive(Debug, Clone)]
pub struct Curvature {
    /// B, where the factor is that of I + B Bᵀ.
    scaled: Option<DMatrix<f64>>,
    deviations: DVector<f64>,
    rows: Vec<Range<usize>>,
    noise: Vec<DMatrix<f64>>,
    factor: Triangle,
}

impl Curvature {
    /// L⁻¹ of values: in units of their noise.
    pub fn in_noise(&self, values: &DVector<f64>) -> DVector<f64> {
        let mut values = values.clone();
        for (row, lower) in self.rows.iter().zip(&self.noise) {
            lower.solve_lower_triangular_mut(&mut values.rows_mut(row.start, row.len()));
        }
        values
    }

    /// The step from coefficients `at` to the most probable ones of a problem with `residual` there; its columns are those `chosen` of
    /// `columns`. Noise, priors and curvature are this one's: where columns change little, such steps converge without a new factor. With its
    /// own columns and values one step leads to the posterior mean.
    pub fn step(
        &self,
        (columns, chosen): (&DMatrix<f64>, &[usize]),
        residual: &DVector<f64>,
        at: &DVector<f64>,
    ) -> DVector<f64> {
        let mut weighted = self.in_noise(residual);
        for (row, lower) in self.rows.iter().zip(&self.noise) {
            lower.tr_solve_lower_triangular_mut(&mut weighted.rows_mut(row.start, row.len()));
        }
        let by_values = |k: usize, _| columns.column(chosen[k]).dot(&weighted) * self.deviations[k];
        let downhill = DVector::from_fn(chosen.len(), by_values) - at.component_div(&self.deviations);
        let solved = |b: &DVector<f64>| DVector::from_vec(self.factor.solve(b.as_slice()));
        let step = match &self.scaled {
            // (I + Bᵀ B)⁻¹ = I - Bᵀ (I + B Bᵀ)⁻¹ B.
            Some(scaled) => &downhill - scaled.tr_mul(&solved(&(scaled * &downhill))),
            None => solved(&downhill),
        };
        step.component_mul(&self.deviations)
    }
}

/// The factor of I + Cᵀ C.
fn one_more(columns: &DMatrix<f64>) -> Option<Triangle> {
    let size = columns.ncols();
    let mut cells = gram_of(columns.as_slice(), columns.nrows());
    cells.iter_mut().step_by(size + 1).for_each(|cell| *cell += 1.0);
    Triangle::factor(cells, size)
}

impl Gram {
    /// Number of values and of coefficients.
    pub fn size(&self) -> (usize, usize) {
        self.scaled.shape()
    }

    /// K⁻¹ z with K = I + B Bᵀ: on the side of the coefficients z - B (I + Bᵀ B)⁻¹ Bᵀ z.
    pub(crate) fn solve(&self, z: &DVector<f64>) -> DVector<f64> {
        let solved = |b: &DVector<f64>| DVector::from_vec(self.factor.solve(b.as_slice()));
        if self.in_rows { solved(z) } else { z - &self.scaled * solved(&self.scaled.tr_mul(z)) }
    }

    /// The curvature for steps.
    pub fn curvature(self) -> Curvature {
        let Self { scaled, deviations, rows, noise, factor, in_rows, .. } = self;
        Curvature { scaled: in_rows.then_some(scaled), deviations, rows, noise, factor }
    }

    /// C with `Cᵀ C` = Bᵀ K⁻¹ B (in rows) or = I - Bᵀ K⁻¹ B = (I + Bᵀ B)⁻¹ (in columns), p columns.
    pub(crate) fn root(&self) -> DMatrix<f64> {
        let (n, p) = self.size();
        if self.in_rows {
            DMatrix::from_vec(n, p, self.factor.forward_all(self.scaled.as_slice().to_vec()))
        } else {
            DMatrix::from_vec(p, p, self.factor.inverse_columns())
        }
    }

    /// Fraction of each coefficient's prior variance that the data remove: diagonal of Bᵀ K⁻¹ B.
    pub(crate) fn shrunk(&self) -> DVector<f64> {
        let squares = DVector::from_iterator(self.size().1, self.root().column_iter().map(|c| c.norm_squared()));
        if self.in_rows { squares } else { squares.map(|left| 1.0 - left) }
    }

    /// The inverse of I + B Bᵀ, n × n: only the diagonal blocks of the rows.
    pub(crate) fn inverse_blocks(&self) -> Vec<DMatrix<f64>> {
        let n = self.size().0;
        let block = |row: &Range<usize>| {
            let count = row.len();
            if self.in_rows {
                let mut unit = vec![0.0; count * n];
                (0..count).for_each(|k| unit[k * n + row.start + k] = 1.0);
                let half = self.factor.forward_all(unit);
                DMatrix::from_vec(count, count, cross_gram(&half, &half, n))
            } else {
                let part = self.scaled.rows(row.start, count).transpose();
                let half = self.factor.forward_all(part.as_slice().to_vec());
                DMatrix::identity(count, count)
                    - DMatrix::from_vec(count, count, cross_gram(&half, &half, part.nrows()))
            }
        };
        self.rows.iter().map(block).collect()
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// Some problem of n rows of two values and p coefficients, filled with numbers that look random.
    pub(crate) fn example(rows: usize, coefficients: usize) -> Problem {
        let number = |k: usize| ((k * 37 + 11) as f64 * 0.731).sin();
        let noise = |k: usize| {
            let a = DMatrix::from_fn(2, 2, |i, j| 0.3 * number(7 * k + 2 * i + j));
            &a * a.transpose() + DMatrix::identity(2, 2) * 0.2
        };
        Problem {
            columns: DMatrix::from_fn(2 * rows, coefficients, |i, k| number(i * coefficients + k)),
            data: DVector::from_fn(2 * rows, |i, _| number(1000 + i)),
            rows: (0..rows).map(|k| 2 * k..2 * k + 2).collect(),
            noise: (0..rows).map(noise).collect(),
            variances: DVector::from_fn(coefficients, |k, _| 0.1 + number(k).powi(2)),
        }
    }

    /// X V Xᵀ + R.
    pub(crate) fn covariance(problem: &Problem) -> DMatrix<f64> {
        let mut all = &problem.columns * DMatrix::from_diagonal(&problem.variances) * problem.columns.transpose();
        for (row, noise) in problem.rows.iter().zip(&problem.noise) {
            let mut block = all.view_mut((row.start, row.start), noise.shape());
            block += noise;
        }
        all
    }

    #[test]
    fn both_sides_agree_on_what_is_solved() {
        for (rows, coefficients) in [(4, 30), (20, 6)] {
            let gram = example(rows, coefficients).gram().unwrap();
            let all = DMatrix::identity(2 * rows, 2 * rows) + &gram.scaled * gram.scaled.transpose();
            let wanted = all.clone().cholesky().unwrap().solve(&gram.whitened);
            assert!((gram.solve(&gram.whitened) - wanted).norm() < 1e-10);
            let inverse = all.try_inverse().unwrap();
            for (row, block) in gram.rows.iter().zip(gram.inverse_blocks()) {
                assert!((block - inverse.view((row.start, row.start), (2, 2))).norm() < 1e-10);
            }
        }
    }

    #[test]
    fn steps_lead_to_the_posterior_mean_from_anywhere_and_with_the_curvature_of_a_neighbour() {
        for (rows, coefficients) in [(4, 30), (20, 6)] {
            let problem = example(rows, coefficients);
            let wanted = problem.clone().gram().unwrap().mean();
            let own = problem.clone().gram().unwrap().curvature();
            let all: Vec<usize> = (0..coefficients).collect();
            let mut near = problem.clone();
            near.columns.iter_mut().enumerate().for_each(|(k, cell)| *cell += 0.01 * (k as f64).cos());
            let near = near.gram().unwrap().curvature();
            for (curvature, steps) in [(&own, 1), (&near, 25)] {
                let mut at = DVector::from_fn(coefficients, |k, _| (k as f64).sin());
                for _ in 0..steps {
                    at += curvature.step((&problem.columns, &all), &(&problem.data - &problem.columns * &at), &at);
                }
                assert!((&at - &wanted).amax() < 1e-8, "{steps}: {}", (&at - &wanted).amax());
            }
        }
    }

    #[test]
    fn noise_that_is_no_covariance_gives_no_gram() {
        let mut problem = example(3, 4);
        problem.noise[1] = -DMatrix::identity(2, 2);
        assert!(problem.clone().gram().is_none());
        problem = example(3, 4);
        problem.columns[(0, 0)] = f64::NAN;
        assert!(problem.gram().is_none());
    }
}
