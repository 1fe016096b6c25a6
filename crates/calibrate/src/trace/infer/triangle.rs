//! Cholesky factors of some hundred unknowns, in rows so that every sum runs along memory.

use crate::identify::stop::look;
use crate::identify::threads::{available, dealt};
use fearless_simd::{Level, Simd, SimdBase as _, SimdFloat as _, dispatch};

/// The lower triangle L of A = L Lᵀ, or its inverse, row by row.
#[derive(Debug, Clone)]
pub struct Triangle {
    cells: Vec<f64>,
    size: usize,
}

impl Triangle {
    /// Factors a symmetric matrix given row by row, of which the lower triangle is read; `None` unless it is positive.
    pub fn factor(mut cells: Vec<f64>, size: usize) -> Option<Self> {
        look();
        dispatch!(Level::new(), simd => factor_in(simd, &mut cells, size)).then_some(Self { cells, size })
    }

    /// log |A|.
    pub fn log_determinant(&self) -> f64 {
        2.0 * (0..self.size).map(|i| self.cells[i * self.size + i].ln()).sum::<f64>()
    }

    /// L⁻¹ b.
    pub fn forward(&self, b: &[f64]) -> Vec<f64> {
        let mut x = b.to_vec();
        dispatch!(Level::new(), simd => forward_in(simd, &self.cells, self.size, &mut x, 0));
        x
    }

    /// L⁻¹, column by column: column j from its diagonal on, the cells before it zero.
    pub fn inverse_columns(&self) -> Vec<f64> {
        let size = self.size;
        let mut columns = vec![0.0; size * size];
        let threads = available().min(1 + size / 200);
        // Columns get shorter to the right: neighbours are dealt in turn.
        let each = columns.chunks_exact_mut(size).enumerate();
        dealt(
            each,
            threads,
            || (),
            |(), (index, column)| {
                column[index] = 1.0;
                dispatch!(Level::new(), simd => forward_in(simd, &self.cells, size, column, index));
            },
        );
        columns
    }
}

/// Σ a b in vectors of the machine, two sums at a time.
#[inline(always)]
fn dot_in<S: Simd>(simd: S, a: &[f64], b: &[f64]) -> f64 {
    let lanes = S::f64s::LEN;
    let count = a.len().min(b.len());
    let (a, b) = (&a[..count], &b[..count]);
    let mut sums = [S::f64s::splat(simd, 0.0); 4];
    let whole = count - count % (4 * lanes);
    for at in (0..whole).step_by(4 * lanes) {
        for (k, sum) in sums.iter_mut().enumerate() {
            let from = at + k * lanes;
            let left = S::f64s::from_slice(simd, &a[from..from + lanes]);
            *sum = left.mul_add(S::f64s::from_slice(simd, &b[from..from + lanes]), *sum);
        }
    }
    let rest: f64 = a[whole..].iter().zip(&b[whole..]).map(|(a, b)| a * b).sum();
    sums.iter().map(|sum| sum.as_slice().iter().sum::<f64>()).sum::<f64>() + rest
}

/// Σ a b.
pub fn dot(a: &[f64], b: &[f64]) -> f64 {
    dispatch!(Level::new(), simd => dot_in(simd, a, b))
}

#[inline(always)]
fn factor_in<S: Simd>(simd: S, cells: &mut [f64], size: usize) -> bool {
    for i in 0..size {
        let (before, rest) = cells.split_at_mut(i * size);
        let row = &mut rest[..size];
        for j in 0..i {
            let other = &before[j * size..=j * size + j];
            row[j] = (row[j] - dot_in(simd, &row[..j], &other[..j])) / other[j];
        }
        let left = row[i] - dot_in(simd, &row[..i], &row[..i]);
        if !(left > 0.0 && left.is_finite()) {
            return false;
        }
        row[i] = left.sqrt();
    }
    true
}

#[inline(always)]
fn forward_in<S: Simd>(simd: S, cells: &[f64], size: usize, x: &mut [f64], first: usize) {
    for i in first..size {
        let row = &cells[i * size..=i * size + i];
        x[i] = (x[i] - dot_in(simd, &row[first..i], &x[first..i])) / row[i];
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use denavit_model::nalgebra::{Cholesky, DMatrix};

    #[test]
    fn factor_and_inverse_are_those_of_a_library() {
        let size = 37;
        let raw = DMatrix::from_fn(size, size, |i, k| ((i * 31 + k * 17) as f64 * 0.37).sin());
        let matrix = &raw * raw.transpose() + DMatrix::identity(size, size);
        let factor = Triangle::factor(matrix.transpose().as_slice().to_vec(), size).unwrap();
        let known = Cholesky::new(matrix.clone()).unwrap();
        assert!((factor.log_determinant() - known.l().diagonal().map(|x| 2.0 * x.ln()).sum()).abs() < 1e-10);
        let columns = DMatrix::from_vec(size, size, factor.inverse_columns());
        let inverse = columns.transpose() * &columns;
        assert!((inverse - known.inverse()).amax() < 1e-10);
        assert!(Triangle::factor(vec![1.0, 2.0, 2.0, 1.0], 2).is_none());
    }
}
