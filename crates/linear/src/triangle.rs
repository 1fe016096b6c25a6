//! Cholesky factors of a few hundred unknowns, row by row and in panels of several columns, so that each value read serves several sums.

use crate::panel::{Line, PANEL, each_sum, lines_of};
use crate::stop::check_cancelled;
use crate::threads::{available, par_map};
use fearless_simd::{Level, Simd, SimdBase as _, SimdFloat as _, dispatch};

/// Rows that a thread takes at once.
const ROWS: usize = 2 * PANEL;
/// Fewest multiplications for which a second thread pays off.
pub const WORTH_A_THREAD: usize = 150_000;

/// The lower triangle L of A = L Lᵀ, row by row.
#[derive(Debug, Clone)]
pub struct Triangle {
    cells: Vec<f64>,
    size: usize,
}

/// Some rows of the factor, in the form that the rows below need for the columns of the same indices.
struct Panel {
    from: usize,
    to: usize,
    /// The cells of these rows before the diagonal block.
    before: Vec<Line>,
    /// The inverse of the block's transpose, row by row.
    inverse: [Line; PANEL],
}

impl Triangle {
    /// Factors a symmetric matrix given row by row, using its lower triangle; `None` unless it is positive.
    pub fn factor(mut cells: Vec<f64>, size: usize) -> Option<Self> {
        for from in (0..size).step_by(PANEL) {
            check_cancelled();
            let to = (from + PANEL).min(size);
            let (above, below) = cells.split_at_mut(to * size);
            let panel = Panel::factored(&mut above[from * size..], (from, to), size)?;
            // The rows below, each separately: no sum depends on the number of threads.
            let threads = if below.len() / size * from * PANEL < WORTH_A_THREAD { 1 } else { available() };
            par_map(below.chunks_mut(ROWS * size), threads, || (), |(), rows| panel.solve(rows, 0, size));
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
        let panels = self.panels();
        let threads = if columns.len() * size < WORTH_A_THREAD { 1 } else { available() };
        let each = columns.chunks_mut((ROWS * size).max(1));
        par_map(each, threads, || (), |(), some| panels.iter().for_each(|panel| panel.solve(some, 0, size)));
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

    /// A⁻¹ b.
    pub fn solve(&self, b: &[f64]) -> Vec<f64> {
        self.backward(&self.forward(b))
    }

    /// L⁻¹, column by column: column j from its diagonal on, the cells before it zero.
    pub fn inverse_columns(&self) -> Vec<f64> {
        let size = self.size;
        let mut columns = vec![0.0; size * size];
        columns.iter_mut().step_by(size + 1).for_each(|cell| *cell = 1.0);
        let panels = self.panels();
        let threads = if size.pow(3) / 6 < WORTH_A_THREAD { 1 } else { available() };
        // Columns get shorter to the right: neighbours are dealt in turn.
        let each = columns.chunks_mut(ROWS * size).enumerate();
        let invert = |block: usize, some: &mut [f64]| {
            let first = block * ROWS;
            panels[first / PANEL..].iter().for_each(|panel| panel.solve(some, first, size));
        };
        par_map(each, threads, || (), |(), (block, some)| invert(block, some));
        columns
    }

    fn panels(&self) -> Vec<Panel> {
        let size = self.size;
        let rows = |from: usize| Panel::of(&self.cells[from * size..(from + PANEL).min(size) * size], from, size);
        (0..size).step_by(PANEL).map(rows).collect()
    }
}

impl Panel {
    /// The panel of factored rows, starting at `from`.
    fn of(own: &[f64], from: usize, size: usize) -> Self {
        let to = from + own.len() / size;
        let mut before = Vec::new();
        lines_of(own.chunks_exact(size), from, &mut before);
        let mut upper = [[0.0; PANEL]; PANEL];
        for (i, row) in own.chunks_exact(size).enumerate() {
            upper.iter_mut().zip(&row[from..=from + i]).for_each(|(line, cell)| line[i] = *cell);
        }
        Self { from, to, before, inverse: inverse_of(&upper, to - from) }
    }

    /// Factors rows whose columns before the diagonal block are done; `None` unless the block is positive.
    fn factored(own: &mut [f64], (from, to): (usize, usize), size: usize) -> Option<Self> {
        let mut before = Vec::new();
        lines_of(own.chunks_exact(size), from, &mut before);
        let mut left = [[0.0; PANEL]; PANEL];
        for (i, (row, left)) in own.chunks_exact(size).zip(&mut left).enumerate() {
            left[..=i].copy_from_slice(&row[from..=from + i]);
        }
        let take = |row: usize, known: &Line| left[row].iter_mut().zip(known).for_each(|(cell, known)| *cell -= known);
        dispatch!(Level::new(), simd => each_sum(simd, own, size, &before, take));
        let upper = factor_block(&mut left, to - from)?;
        for (i, row) in own.chunks_exact_mut(size).enumerate() {
            row[from..=from + i].iter_mut().zip(&upper).for_each(|(cell, line)| *cell = line[i]);
        }
        Some(Self { from, to, before, inverse: inverse_of(&upper, to - from) })
    }

    /// Solves these columns of some rows, with all earlier columns done; before column `first` the rows are 0.
    fn solve(&self, rows: &mut [f64], first: usize, size: usize) {
        dispatch!(Level::new(), simd => self.solve_in(simd, rows, first, size));
    }

    #[inline(always)]
    fn solve_in<S: Simd>(&self, simd: S, rows: &mut [f64], first: usize, size: usize) {
        let own = self.from..self.to;
        let mut left = [0.0; ROWS * PANEL];
        let first = first.min(own.start);
        let lines = left.chunks_exact_mut(PANEL).zip(rows.chunks_exact(size));
        lines.for_each(|(left, row)| left[..own.len()].copy_from_slice(&row[own.clone()]));
        each_sum(simd, &rows[first..], size, &self.before[first..], |row, known| {
            left[row * PANEL..].iter_mut().zip(known).for_each(|(cell, known)| *cell -= known);
        });
        let count = rows.len() / size;
        each_sum(simd, &left[..count * PANEL], PANEL, &self.inverse[..own.len()], |row, solved| {
            rows[row * size..][own.clone()].copy_from_slice(&solved[..own.len()]);
        });
    }
}

/// Lᵀ of a block of this many rows, using its lower triangle; `None` unless it is positive.
fn factor_block(left: &mut [Line; PANEL], many: usize) -> Option<[Line; PANEL]> {
    let mut upper = [[0.0; PANEL]; PANEL];
    for k in 0..many {
        let square = left[k][k];
        if !(square > 0.0 && square.is_finite()) {
            return None;
        }
        let pivot = square.sqrt();
        for i in k..many {
            upper[k][i] = left[i][k] / pivot;
        }
        let line = upper[k];
        for (left, share) in left[..many].iter_mut().zip(line).skip(k + 1) {
            left.iter_mut().zip(&line).for_each(|(cell, other)| *cell -= share * other);
        }
    }
    Some(upper)
}

/// The inverse of an upper triangle of this many rows.
fn inverse_of(upper: &[Line; PANEL], many: usize) -> [Line; PANEL] {
    let mut inverse = [[0.0; PANEL]; PANEL];
    for k in (0..many).rev() {
        let mut line = [0.0; PANEL];
        line[k] = 1.0;
        for (below, share) in inverse[..many].iter().zip(upper[k]).skip(k + 1) {
            line.iter_mut().zip(below).for_each(|(cell, other)| *cell -= share * other);
        }
        inverse[k] = line.map(|cell| cell / upper[k][k]);
    }
    inverse
}

/// Σ a b with SIMD, two sums at a time.
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
    use nalgebra::{Cholesky, DMatrix, DVector};

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
        assert_eq!(factor.solve(&right), factor.backward(&factor.forward(&right)));
        assert!((whole - known.solve(&DVector::from_vec(right))).amax() < 1e-9);
    }
}
