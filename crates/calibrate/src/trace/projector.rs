//! Taking out of a column what the model can already do, and asking what the rest explains.

use denavit_model::nalgebra::{DMatrix, DVector};

/// A column of the model that is this nearly a sum of others adds nothing.
const DEPENDENT: f64 = 1e-9;
/// A column of which the model leaves less than this share cannot be seen: claiming it would be guessing.
pub const UNSEEN: f64 = 3e-3;

/// An orthonormal basis of what the model can do, and the residual that it leaves.
#[derive(Debug, Clone)]
pub struct Projector {
    basis: DMatrix<f64>,
    /// The residual outside the basis.
    pub residual: DVector<f64>,
    /// Its square.
    pub rss: f64,
}

/// What a block of columns explains beyond the model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gain {
    /// How much the sum of squares falls.
    pub drop: f64,
    /// How many of the block's directions can be seen.
    pub rank: usize,
}

impl Projector {
    /// The basis of these columns together; columns that others imply are left out.
    pub fn new(parts: &[&DMatrix<f64>], residual: &DVector<f64>) -> Self {
        let rows = residual.len();
        let count: usize = parts.iter().map(|part| part.ncols()).sum();
        let mut basis = DMatrix::zeros(rows, count);
        let mut rank = 0;
        for part in parts {
            for column in part.column_iter() {
                let norm = column.norm();
                if norm == 0.0 {
                    continue;
                }
                let mut rest = column / norm;
                for _ in 0..2 {
                    let known = basis.columns(0, rank);
                    let shares = known.tr_mul(&rest);
                    rest.gemv(-1.0, &known, &shares, 1.0);
                }
                let left = rest.norm();
                if left > DEPENDENT {
                    basis.set_column(rank, &(rest / left));
                    rank += 1;
                }
            }
        }
        let basis = basis.columns(0, rank).into_owned();
        let mut result = Self { basis, residual: residual.clone(), rss: 0.0 };
        let shares = result.basis.tr_mul(residual);
        result.residual.gemv(-1.0, &result.basis, &shares, 1.0);
        result.rss = result.residual.norm_squared();
        result
    }

    /// Number of directions that the model has.
    pub fn rank(&self) -> usize {
        self.basis.ncols()
    }

    /// Takes the model's part out of many columns at once.
    pub fn remove_from(&self, columns: &mut DMatrix<f64>) {
        let shares = self.basis.tr_mul(columns);
        columns.gemm(-1.0, &self.basis, &shares, 1.0);
    }

    /// What a block explains; `norms` are its columns' lengths before [`Projector::remove_from`].
    ///
    /// A column of which less than the share `least` is left counts as nothing. The block is overwritten by an
    /// orthonormal basis of what is left of it, zero where nothing is.
    pub fn gain(&self, block: &mut [f64], norms: &[f64], least: f64) -> Gain {
        let rows = self.residual.len();
        let residual = self.residual.as_slice();
        let mut gain = Gain { drop: 0.0, rank: 0 };
        for (k, whole) in norms.iter().enumerate() {
            let (done, rest) = block.split_at_mut(k * rows);
            let column = &mut rest[..rows];
            for other in done.chunks_exact(rows) {
                let share = dot(column, other);
                for (x, y) in column.iter_mut().zip(other) {
                    *x -= share * y;
                }
            }
            let norm = dot(column, column).sqrt();
            if norm <= least * whole {
                column.fill(0.0);
                continue;
            }
            for x in column.iter_mut() {
                *x /= norm;
            }
            gain.drop += dot(column, residual).powi(2);
            gain.rank += 1;
        }
        gain
    }

    /// What a matrix of raw columns explains.
    pub fn gain_of(&self, columns: &DMatrix<f64>) -> Gain {
        self.gain_of_seen(columns, UNSEEN)
    }

    /// The same, with another share of a column that must be left.
    pub fn gain_of_seen(&self, columns: &DMatrix<f64>, least: f64) -> Gain {
        let norms: Vec<f64> = columns.column_iter().map(|column| column.norm()).collect();
        let mut columns = columns.clone();
        self.remove_from(&mut columns);
        self.gain(columns.as_mut_slice(), &norms, least)
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0.0; 4];
    let (a4, b4) = (a.chunks_exact(4), b.chunks_exact(4));
    let rest: f64 = a4.remainder().iter().zip(b4.remainder()).map(|(x, y)| x * y).sum();
    for (x, y) in a4.zip(b4) {
        for k in 0..4 {
            sums[k] += x[k] * y[k];
        }
    }
    sums.iter().sum::<f64>() + rest
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gain_is_the_fall_of_the_least_squares_sum() {
        let model = DMatrix::from_fn(9, 2, |i, k| ((i + 1) as f64 * (k as f64 + 0.7)).sin());
        let block = DMatrix::from_fn(9, 2, |i, k| ((i as f64) * (k as f64 + 1.3) + 0.4).cos());
        let residual = DVector::from_fn(9, |i, _| (i as f64 * 0.9).sin() + 0.3 * i as f64);
        let both = DMatrix::from_fn(9, 4, |i, k| if k < 2 { model[(i, k)] } else { block[(i, k - 2)] });
        let rss = |a: &DMatrix<f64>| {
            let solution = a.clone().svd(true, true).solve(&residual, 1e-14).unwrap();
            (&residual - a * solution).norm_squared()
        };
        let projector = Projector::new(&[&model], &residual);
        let gain = projector.gain_of(&block);
        assert!((gain.drop - (rss(&model) - rss(&both))).abs() < 1e-10 && gain.rank == 2);
    }

    #[test]
    fn what_the_model_can_do_gains_nothing() {
        let model = DMatrix::from_fn(8, 3, |i, k| ((i + 2 * k) as f64).sin());
        let residual = DVector::from_fn(8, |i, _| i as f64);
        let projector = Projector::new(&[&model], &residual);
        let implied = &model * DMatrix::from_column_slice(3, 1, &[1.0, -2.0, 0.5]);
        assert_eq!(projector.gain_of(&implied), Gain { drop: 0.0, rank: 0 });
    }
}
