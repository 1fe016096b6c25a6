//! Gram matrices: products of columns of numbers with SIMD, several columns at a time.

use crate::panel::{Line, PANEL, each_sum, lines_of};
use crate::threads::{available, par_map};
use crate::triangle::WORTH_A_THREAD;
use fearless_simd::{Level, Simd, SimdBase as _, SimdFloat as _, dispatch};

/// Columns on the left and on the right of a tile of products: as many sums as sixteen registers hold.
pub const TILE: (usize, usize) = (4, 2);
/// The same for machines with vectors of eight numbers, which have thirty-two registers.
const WIDE: (usize, usize) = (4, 4);
const WIDE_VECTOR: usize = 8;

/// Fewest columns on the left and on the right for which a panel pays off.
const FEW: (usize, usize) = (4, 10);
/// Cells of a column per block: a panel then stays in the cache.
const DEPTH: usize = 256;

/// leftᵀ right, of columns of `rows` cells: a product per column of `left`, for each column of `right`.
pub fn cross_gram(left: &[f64], right: &[f64], rows: usize) -> Vec<f64> {
    if rows == 0 {
        return Vec::new();
    }
    let counts = (left.len() / rows, right.len() / rows);
    let mut result = vec![0.0; counts.0 * counts.1];
    if counts.0 < FEW.0 || counts.1 < FEW.1 {
        let sides = (Columns { cells: left, stride: rows }, Columns { cells: right, stride: rows });
        dispatch!(Level::new(), simd => add_cross_gram_in(simd, sides, rows, counts, &mut result));
        return result;
    }
    for (some, result) in right.chunks(PANEL * rows).zip(result.chunks_mut((PANEL * counts.0).max(1))) {
        panel_into(left, some, rows, counts.0, result);
    }
    result
}

/// The products of columns of `rows` cells with each other, square.
pub fn gram_of(columns: &[f64], rows: usize) -> Vec<f64> {
    let count = columns.len() / rows.max(1);
    if count < FEW.1 {
        return cross_gram(columns, columns, rows);
    }
    let mut result = vec![0.0; count * count];
    let panels = columns.chunks(PANEL * rows).zip(result.chunks_mut(PANEL * count)).enumerate();
    let threads = if columns.len() * count / 2 < WORTH_A_THREAD { 1 } else { available() };
    // Each product separately: none depends on the number of threads.
    par_map(
        panels,
        threads,
        || (),
        |(), (panel, (some, result))| {
            let first = panel * PANEL;
            panel_into(&columns[first * rows..], some, rows, count, &mut result[first..]);
        },
    );
    for r in 0..count {
        for l in 0..r {
            result[r * count + l] = result[l * count + r];
        }
    }
    result
}

/// Takes this many times each of these columns from another.
pub fn subtract(columns: &[f64], times: &[f64], from: &mut [f64]) {
    let columns = Columns { cells: columns, stride: from.len() };
    dispatch!(Level::new(), simd => subtract_in(simd, columns, times, from));
}

/// The same of several columns of `rows` cells: `times` holds for each of them how many times each of the columns is taken.
pub fn subtract_each(columns: &[f64], times: &[f64], from: &mut [f64], rows: usize) {
    let count = columns.len() / rows.max(1);
    if count == 0 {
        return;
    }
    for first in (0..rows).step_by(DEPTH) {
        let last = rows.min(first + DEPTH);
        let columns = Columns { cells: &columns[first..], stride: rows };
        for (times, from) in times.chunks_exact(count).zip(from.chunks_exact_mut(rows)) {
            dispatch!(Level::new(), simd => subtract_in(simd, columns, times, &mut from[first..last]));
        }
    }
}

#[inline(always)]
fn subtract_in<S: Simd>(simd: S, columns: Columns, times: &[f64], from: &mut [f64]) {
    const VECTORS: usize = 4;
    let (rows, width) = (from.len(), S::f64s::LEN);
    let whole = rows - rows % (VECTORS * width);
    let cells = |column: usize, first: usize, last: usize| {
        let start = column * columns.stride;
        &columns.cells[start + first..start + last]
    };
    for first in (0..whole).step_by(VECTORS * width) {
        let own = &mut from[first..first + VECTORS * width];
        let mut left = [S::f64s::splat(simd, 0.0); VECTORS];
        for (k, left) in left.iter_mut().enumerate() {
            *left = S::f64s::from_slice(simd, &own[k * width..(k + 1) * width]);
        }
        for (column, times) in times.iter().enumerate() {
            let (times, column) = (S::f64s::splat(simd, -times), cells(column, first, first + VECTORS * width));
            for (k, left) in left.iter_mut().enumerate() {
                *left = times.mul_add(S::f64s::from_slice(simd, &column[k * width..(k + 1) * width]), *left);
            }
        }
        for (k, left) in left.iter().enumerate() {
            left.store_slice(&mut own[k * width..(k + 1) * width]);
        }
    }
    for (column, times) in times.iter().enumerate() {
        let others = cells(column, whole, rows);
        from[whole..].iter_mut().zip(others).for_each(|(cell, other)| *cell -= times * other);
    }
}

/// The products of all columns of `left` with at most [`PANEL`] of `right`, `count` cells for each of the latter.
fn panel_into(left: &[f64], right: &[f64], rows: usize, count: usize, result: &mut [f64]) {
    let mut lines = Vec::with_capacity(DEPTH.min(rows));
    let many = right.len() / rows;
    for from in (0..rows).step_by(DEPTH) {
        let depth = DEPTH.min(rows - from);
        lines_of(right.chunks_exact(rows).map(|column| &column[from..]), depth, &mut lines);
        let take = |l: usize, sums: &Line| {
            let cells = result[l..].iter_mut().step_by(count).zip(&sums[..many]);
            cells.for_each(|(cell, sum)| *cell = if from == 0 { *sum } else { *cell + sum });
        };
        dispatch!(Level::new(), simd => each_sum(simd, &left[from..], rows, &lines, take));
    }
}

#[inline(always)]
fn add_cross_gram_in<S: Simd>(
    simd: S,
    sides: (Columns, Columns),
    rows: usize,
    counts: (usize, usize),
    result: &mut [f64],
) {
    if S::f64s::LEN < WIDE_VECTOR {
        add_cross_gram_by::<S, { TILE.0 }, { TILE.1 }>(simd, sides, rows, counts, result);
    } else {
        add_cross_gram_by::<S, { WIDE.0 }, { WIDE.1 }>(simd, sides, rows, counts, result);
    }
}

#[inline(always)]
fn add_cross_gram_by<S: Simd, const L: usize, const R: usize>(
    simd: S,
    sides: (Columns, Columns),
    rows: usize,
    (count, others): (usize, usize),
    result: &mut [f64],
) {
    let (whole, whole_others) = (count - count % L, others - others % R);
    for r in (0..whole_others).step_by(R) {
        for l in (0..whole).step_by(L) {
            add_tile::<S, L, R>(simd, sides, rows, (l, r), count, result);
        }
        for l in whole..count {
            add_tile::<S, 1, R>(simd, sides, rows, (l, r), count, result);
        }
    }
    for r in whole_others..others {
        for l in (0..whole).step_by(L) {
            add_tile::<S, L, 1>(simd, sides, rows, (l, r), count, result);
        }
        for l in whole..count {
            add_tile::<S, 1, 1>(simd, sides, rows, (l, r), count, result);
        }
    }
}

/// Adds to `sums` the products of columns with those to their right and with themselves.
///
/// # Shape and units
/// `cells`: columns of `stride` cells, of which the first `rows` count; as many columns as [`TILE`] goes into. `sums`:
/// square, the product of columns l ≤ r at `r * count + l`; some other cells change, too.
pub fn add_gram(cells: &[f64], stride: usize, rows: usize, sums: &mut [f64]) {
    dispatch!(Level::new(), simd => add_gram_in(simd, cells, stride, rows, sums));
}

#[inline(always)]
fn add_gram_in<S: Simd>(simd: S, cells: &[f64], stride: usize, rows: usize, sums: &mut [f64]) {
    let count = cells.len() / stride;
    let sides = (Columns { cells, stride }, Columns { cells, stride });
    if S::f64s::LEN < WIDE_VECTOR {
        add_gram_by::<S, { TILE.0 }, { TILE.1 }>(simd, sides, rows, count, sums);
    } else {
        add_gram_by::<S, { WIDE.0 }, { WIDE.1 }>(simd, sides, rows, count, sums);
    }
}

#[inline(always)]
fn add_gram_by<S: Simd, const L: usize, const R: usize>(
    simd: S,
    sides: (Columns, Columns),
    rows: usize,
    count: usize,
    sums: &mut [f64],
) {
    for r in (0..count).step_by(R) {
        for l in (0..r + R).step_by(L) {
            add_tile::<S, L, R>(simd, sides, rows, (l, r), count, sums);
        }
    }
}

#[derive(Clone, Copy)]
struct Columns<'a> {
    cells: &'a [f64],
    stride: usize,
}

impl<'a> Columns<'a> {
    #[inline(always)]
    fn some<const N: usize>(self, first: usize, rows: usize) -> [&'a [f64]; N] {
        let mut columns = [&self.cells[..0]; N];
        for (k, column) in columns.iter_mut().enumerate() {
            *column = &self.cells[(first + k) * self.stride..(first + k) * self.stride + rows];
        }
        columns
    }
}

/// Adds the products of `L` columns from `l` on with `R` from `r` on.
#[inline(always)]
fn add_tile<S: Simd, const L: usize, const R: usize>(
    simd: S,
    (left, right): (Columns, Columns),
    rows: usize,
    (l, r): (usize, usize),
    count: usize,
    result: &mut [f64],
) {
    let width = S::f64s::LEN;
    let (lefts, rights): ([&[f64]; L], [&[f64]; R]) = (left.some(l, rows), right.some(r, rows));
    let mut sums = [[S::f64s::splat(simd, 0.0); R]; L];
    let whole = rows - rows % width;
    for at in (0..whole).step_by(width) {
        let mut b = [S::f64s::splat(simd, 0.0); R];
        for k in 0..R {
            b[k] = S::f64s::from_slice(simd, &rights[k][at..at + width]);
        }
        for i in 0..L {
            let a = S::f64s::from_slice(simd, &lefts[i][at..at + width]);
            for k in 0..R {
                sums[i][k] = a.mul_add(b[k], sums[i][k]);
            }
        }
    }
    for i in 0..L {
        for k in 0..R {
            let rest: f64 = lefts[i][whole..].iter().zip(&rights[k][whole..]).map(|(a, b)| a * b).sum();
            result[(r + k) * count + l + i] += sums[i][k].as_slice().iter().sum::<f64>() + rest;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_are_taken_from_another() {
        let cell = |k: usize| (k as f64 * 0.9).cos();
        for (rows, count) in [(3, 2), (70, 5), (64, 0), (600, 3)] {
            let columns: Vec<f64> = (0..rows * count).map(cell).collect();
            let times: Vec<f64> = (0..count).map(|k| k as f64 - 1.5).collect();
            let mut found: Vec<f64> = (0..rows).map(|k| cell(k + 7)).collect();
            subtract(&columns, &times, &mut found);
            for (row, found) in found.iter().enumerate() {
                let sum: f64 = (0..count).map(|k| columns[k * rows + row] * times[k]).sum();
                assert!((found - (cell(row + 7) - sum)).abs() < 1e-13);
            }
            let mut three: Vec<f64> = (0..3 * rows).map(|k| cell(k + 7)).collect();
            let mut each = three.clone();
            let times: Vec<f64> = (0..3 * count).map(|k| 0.3 * k as f64 - 1.0).collect();
            subtract_each(&columns, &times, &mut each, rows);
            for (own, three) in three.chunks_exact_mut(rows).enumerate() {
                subtract(&columns, &times[own * count..(own + 1) * count], three);
            }
            assert!(each.iter().zip(three).all(|(a, b)| (a - b).abs() < 1e-13));
        }
    }

    #[test]
    fn a_gram_matrix_holds_sums_over_the_rows() {
        let cell = |k: usize| (k as f64 * 0.7).sin();
        for (rows, count, others) in [(1, 1, 1), (19, 5, 3), (32, 9, 4), (7, 3, 10), (300, 21, 35)] {
            let (left, right): (Vec<f64>, Vec<f64>) =
                ((0..rows * count).map(cell).collect(), (0..rows * others).map(|k| cell(k + 50)).collect());
            let found = cross_gram(&left, &right, rows);
            for r in 0..others {
                for l in 0..count {
                    let sum: f64 = (0..rows).map(|i| left[l * rows + i] * right[r * rows + i]).sum();
                    assert!((found[r * count + l] - sum).abs() < 1e-12);
                }
            }
            let whole = gram_of(&left, rows);
            let twice = cross_gram(&left, &left, rows);
            assert!(whole.iter().zip(twice).all(|(a, b)| (a - b).abs() < 1e-12));
        }
    }
}
