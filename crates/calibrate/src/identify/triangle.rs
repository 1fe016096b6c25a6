//! Cholesky factors of some hundred unknowns, in rows so that every sum runs along memory, and in blocks so that what is read
//! once is used for several sums.

use crate::identify::gram::add_cross_gram;
use crate::identify::stop::look;
use crate::identify::threads::{available, dealt};
use fearless_simd::{Level, Simd, SimdBase as _, SimdFloat as _, dispatch};

/// Rows and columns that are worked on together.
const BLOCK: usize = 32;
/// Fewer multiplications than this are done sooner than a second thread is there.
const WORTH_A_THREAD: usize = 500_000;

/// The lower triangle L of A = L Lᵀ, or its inverse, row by row.
#[derive(Debug, Clone)]
pub struct Triangle {
    cells: Vec<f64>,
    size: usize,
}

impl Triangle {
    /// Factors a symmetric matrix given row by row, of which the lower triangle is read; `None` unless it is positive.
    pub fn factor(mut cells: Vec<f64>, size: usize) -> Option<Self> {
        for from in (0..size).step_by(BLOCK) {
            look();
            let to = (from + BLOCK).min(size);
            let (above, below) = cells.split_at_mut(to * size);
            let (_, own) = above.split_at_mut(from * size);
            let square = against(own, own, (from, to), size);
            if !factor_block(own, &square, (from, to), size) {
                return None;
            }
            // The rows below each for itself: no sum depends on how many threads there are.
            let threads = if below.len() / size * from * BLOCK < WORTH_A_THREAD { 1 } else { available() };
            dealt(
                below.chunks_mut(BLOCK * size),
                threads,
                || (),
                |(), rows| {
                    let known = against(rows, own, (from, to), size);
                    solve_rows(rows, own, &known, (from, to), size);
                },
            );
        }
        Some(Self { cells, size })
    }

    /// log |A|.
    pub fn log_determinant(&self) -> f64 {
        2.0 * (0..self.size).map(|i| self.cells[i * self.size + i].ln()).sum::<f64>()
    }

    /// L⁻¹ b.
    pub fn forward(&self, b: &[f64]) -> Vec<f64> {
        let mut x = b.to_vec();
        dispatch!(Level::new(), simd => forward_in(simd, &self.cells, self.size, &mut x));
        x
    }

    /// L⁻¹ B, column by column.
    pub fn forward_all(&self, mut columns: Vec<f64>) -> Vec<f64> {
        let size = self.size;
        let solve = |some: &mut [f64]| {
            for from in (0..size).step_by(BLOCK) {
                let to = (from + BLOCK).min(size);
                let own = &self.cells[from * size..to * size];
                let known = against(some, own, (from, to), size);
                solve_rows(some, own, &known, (from, to), size);
            }
        };
        let threads = if columns.len() * size < WORTH_A_THREAD { 1 } else { available() };
        dealt(columns.chunks_mut((BLOCK * size).max(1)), threads, || (), |(), some| solve(some));
        columns
    }

    /// L⁻ᵀ b.
    pub fn backward(&self, b: &[f64]) -> Vec<f64> {
        let mut x = b.to_vec();
        for (i, row) in self.cells.chunks_exact(self.size).enumerate().rev() {
            let (before, own) = x.split_at_mut(i);
            own[0] /= row[i];
            before.iter_mut().zip(row).for_each(|(cell, factor)| *cell -= factor * own[0]);
        }
        x
    }

    /// L⁻¹, column by column: column j from its diagonal on, the cells before it zero.
    pub fn inverse_columns(&self) -> Vec<f64> {
        let size = self.size;
        let mut columns = vec![0.0; size * size];
        let threads = available().min(1 + size / 200);
        // Columns get shorter to the right: neighbours are dealt in turn.
        let each = columns.chunks_mut(BLOCK * size).enumerate();
        dealt(each, threads, || (), |(), (block, columns)| self.invert(block * BLOCK, columns));
        columns
    }

    /// The columns of the inverse from number `first` on.
    fn invert(&self, first: usize, columns: &mut [f64]) {
        let size = self.size;
        let count = columns.len() / size;
        for from in (first..size).step_by(BLOCK) {
            let to = (from + BLOCK).min(size);
            let rows = &self.cells[from * size..to * size];
            let many = to - from;
            let mut known = vec![0.0; many * count];
            if from > first {
                add_cross_gram(
                    &rows[first..],
                    &columns[first..],
                    (size, size),
                    from - first,
                    (many, count),
                    &mut known,
                );
            }
            for (index, column) in columns.chunks_exact_mut(size).enumerate() {
                for row in 0..many {
                    let line = &rows[row * size + from..=row * size + from + row];
                    let one = if from + row == first + index { 1.0 } else { 0.0 };
                    let sum = dot(&line[..row], &column[from..from + row]);
                    column[from + row] = (one - known[index * many + row] - sum) / line[row];
                }
            }
        }
    }
}

/// Products of some rows' first cells with those of the rows of a block, row by row of the former.
fn against(rows: &[f64], block: &[f64], (from, to): (usize, usize), size: usize) -> Vec<f64> {
    let (many, count) = (to - from, rows.len() / size);
    let mut known = vec![0.0; many * count];
    if from > 0 {
        add_cross_gram(block, rows, (size, size), from, (many, count), &mut known);
    }
    known
}

/// Factors a block on the diagonal; `known` is what the columns before it make of it.
fn factor_block(rows: &mut [f64], known: &[f64], (from, to): (usize, usize), size: usize) -> bool {
    let many = to - from;
    for i in 0..many {
        let (before, rest) = rows.split_at_mut(i * size);
        let row = &mut rest[from..to];
        let known = &known[i * many..(i + 1) * many];
        solve_row(&mut row[..i], before, known, from, size);
        let left = row[i] - known[i] - dot(&row[..i], &row[..i]);
        if !(left > 0.0 && left.is_finite()) {
            return false;
        }
        row[i] = left.sqrt();
    }
    true
}

/// The block's columns of the rows below it.
fn solve_rows(rows: &mut [f64], block: &[f64], known: &[f64], (from, to): (usize, usize), size: usize) {
    let many = to - from;
    for (row, known) in rows.chunks_exact_mut(size).zip(known.chunks_exact(many)) {
        solve_row(&mut row[from..to], block, known, from, size);
    }
}

/// The first columns of a row within a block, as far as the row reaches, by the block's rows that are done.
fn solve_row(row: &mut [f64], block: &[f64], known: &[f64], from: usize, size: usize) {
    for j in 0..row.len() {
        let other = &block[j * size + from..=j * size + from + j];
        row[j] = (row[j] - known[j] - dot(&row[..j], &other[..j])) / other[j];
    }
}

/// Σ a b in vectors of the machine, two sums at a time.
#[inline(always)]
fn dot_in<S: Simd>(simd: S, a: &[f64], b: &[f64]) -> f64 {
    let width = S::f64s::LEN;
    let count = a.len().min(b.len());
    let (a, b) = (&a[..count], &b[..count]);
    let mut sums = [S::f64s::splat(simd, 0.0); 4];
    let whole = count - count % (4 * width);
    for at in (0..whole).step_by(4 * width) {
        for (k, sum) in sums.iter_mut().enumerate() {
            let from = at + k * width;
            let left = S::f64s::from_slice(simd, &a[from..from + width]);
            *sum = left.mul_add(S::f64s::from_slice(simd, &b[from..from + width]), *sum);
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
fn forward_in<S: Simd>(simd: S, cells: &[f64], size: usize, x: &mut [f64]) {
    for i in 0..size {
        let row = &cells[i * size..=i * size + i];
        x[i] = (x[i] - dot_in(simd, &row[..i], &x[..i])) / row[i];
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use denavit_model::nalgebra::{Cholesky, DMatrix, DVector};

    #[test]
    fn factor_and_inverse_are_those_of_a_library() {
        for size in [1, 5, 37, 64, 150] {
            known_of(size);
        }
        assert!(Triangle::factor(vec![1.0, 2.0, 2.0, 1.0], 2).is_none());
    }

    fn known_of(size: usize) {
        let raw = DMatrix::from_fn(size, size, |i, k| ((i * 31 + k * 17) as f64 * 0.37).sin());
        let matrix = &raw * raw.transpose() + DMatrix::identity(size, size);
        let factor = Triangle::factor(matrix.transpose().as_slice().to_vec(), size).unwrap();
        let known = Cholesky::new(matrix.clone()).unwrap();
        assert!((factor.log_determinant() - known.l().diagonal().map(|x| 2.0 * x.ln()).sum()).abs() < 1e-10);
        let columns = DMatrix::from_vec(size, size, factor.inverse_columns());
        let inverse = columns.transpose() * &columns;
        assert!((inverse - known.inverse()).amax() < 1e-10);
        let right: Vec<f64> = (0..size).map(|i| i as f64 + 1.0).collect();
        let solved = known.l().solve_lower_triangular(&DVector::from_vec(right.clone())).unwrap();
        assert!((DVector::from_vec(factor.forward(&right)) - &solved).amax() < 1e-9);
        let many: Vec<f64> = (0..size * 40).map(|k| (k as f64 * 0.71).cos()).collect();
        for (all, one) in factor.forward_all(many.clone()).chunks_exact(size).zip(many.chunks_exact(size)) {
            assert!(all.iter().zip(factor.forward(one)).all(|(a, b)| (a - b).abs() < 1e-9));
        }
        let whole = DVector::from_vec(factor.backward(solved.as_slice()));
        assert!((whole - known.solve(&DVector::from_vec(right))).amax() < 1e-9);
    }
}
