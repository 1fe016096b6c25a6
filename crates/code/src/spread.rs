//! A covariance as the squares of some sums: the variance for z is Σ (row · z)².

use crate::effects::Spread;
use denavit_model::nalgebra::DMatrix;

/// A remaining variance below this fraction of the original counts as 0.
const NOTHING: f64 = 1e-13;

/// A table of a function.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    pub name: String,
    /// How many rows: row k begins at column k.
    pub rows: usize,
    pub columns: usize,
    pub values: Vec<f64>,
}

impl Table {
    /// The weights of a curve's waves.
    pub fn weights(index: usize, weights: &[f64]) -> Self {
        Self { name: format!("weights{index}"), rows: 1, columns: weights.len(), values: weights.to_vec() }
    }

    /// Of a matrix whose cells before column k of row k are 0.
    fn of(name: String, factor: &DMatrix<f64>) -> Self {
        let (rows, columns) = factor.shape();
        let values = (0..rows).flat_map(|row| (row..columns).map(move |column| factor[(row, column)])).collect();
        Self { name, rows, columns, values }
    }

    /// The rows, each without the columns before it.
    pub fn each_row(&self) -> impl Iterator<Item = &[f64]> {
        let mut rest = &self.values[..];
        (0..self.rows).map(move |row| {
            let (own, after) = rest.split_at(self.columns - row);
            rest = after;
            own
        })
    }
}

/// Rows whose squares make a covariance of these numbers and those `beside` them (Cholesky).
///
/// Numbers that the spread does not have are sure.
pub fn factor(index: usize, spread: &Spread, numbers: &[usize], beside: usize) -> Table {
    let places: Vec<Option<usize>> = numbers
        .iter()
        .map(|number| spread.kept.iter().position(|kept| kept == number))
        .chain((0..beside).map(|k| Some(spread.kept.len() + k)))
        .collect();
    let size = places.len();
    let mut left = DMatrix::from_fn(size, size, |i, k| match (places[i], places[k]) {
        (Some(i), Some(k)) => spread.covariance[(i, k)],
        _ => 0.0,
    });
    let variances = left.diagonal();
    let mut factor = DMatrix::zeros(size, size);
    for k in 0..size {
        if left[(k, k)] <= NOTHING * variances[k] {
            continue;
        }
        let mut row = left.column(k) / left[(k, k)].sqrt();
        row.rows_mut(0, k).fill(0.0);
        left.ger(-1.0, &row, &row, 1.0);
        factor.row_mut(k).copy_from(&row.transpose());
    }
    Table::of(format!("spread{index}"), &factor)
}
