//! Sums of products with sixteen columns at once: each sum has its own place in the machine's vectors, so none has to be gathered
//! from them at the end.

use fearless_simd::{Simd, SimdBase as _, SimdFloat as _};

/// Columns of a panel.
pub(crate) const PANEL: usize = 16;

/// A cell of each of its columns, side by side.
pub(crate) type Line = [f64; PANEL];

/// The cells of at most [`PANEL`] columns, of which the first `depth` count, line by line; columns that lack are nothing.
pub(crate) fn lines_of<'a>(columns: impl Iterator<Item = &'a [f64]>, depth: usize, lines: &mut Vec<Line>) {
    lines.clear();
    lines.resize(depth, [0.0; PANEL]);
    for (index, column) in columns.enumerate() {
        for (line, cell) in lines.iter_mut().zip(column) {
            line[index] = *cell;
        }
    }
}

/// For several rows Σ row[k] lines[k]: `take` is given the number of each row and its sums.
///
/// # Shape and units
/// `rows`: one after the other, `stride` cells from one to the next, of which as many count as there are lines.
#[inline(always)]
pub(crate) fn each_sum<S: Simd>(simd: S, rows: &[f64], stride: usize, lines: &[Line], take: impl FnMut(usize, &Line)) {
    // As many sums as the machine's registers hold.
    match S::f64s::LEN {
        8 => each_sum_by::<S, 8, 2>(simd, rows, stride, lines, take),
        4 => each_sum_by::<S, 3, 4>(simd, rows, stride, lines, take),
        _ => each_sum_by::<S, 1, 8>(simd, rows, stride, lines, take),
    }
}

#[inline(always)]
fn each_sum_by<S: Simd, const R: usize, const N: usize>(
    simd: S,
    rows: &[f64],
    stride: usize,
    lines: &[Line],
    mut take: impl FnMut(usize, &Line),
) {
    let count = rows.len().div_ceil(stride);
    let row = |index: usize| &rows[index * stride..index * stride + lines.len()];
    let whole = count - count % R;
    for first in (0..whole).step_by(R) {
        let sums = sums::<S, R, N>(simd, std::array::from_fn(|i| row(first + i)), lines);
        sums.iter().enumerate().for_each(|(i, sum)| take(first + i, sum));
    }
    for index in whole..count {
        let [sum] = sums::<S, 1, N>(simd, [row(index)], lines);
        take(index, &sum);
    }
}

/// The sums of `R` rows, each in `N` vectors.
#[inline(always)]
fn sums<S: Simd, const R: usize, const N: usize>(simd: S, rows: [&[f64]; R], lines: &[Line]) -> [Line; R] {
    let width = S::f64s::LEN;
    let mut sums = [[S::f64s::splat(simd, 0.0); N]; R];
    for (k, line) in lines.iter().enumerate() {
        let mut cells = [S::f64s::splat(simd, 0.0); N];
        for n in 0..N {
            cells[n] = S::f64s::from_slice(simd, &line[n * width..(n + 1) * width]);
        }
        for i in 0..R {
            let factor = S::f64s::splat(simd, rows[i][k]);
            for n in 0..N {
                sums[i][n] = factor.mul_add(cells[n], sums[i][n]);
            }
        }
    }
    let mut found = [[0.0; PANEL]; R];
    for i in 0..R {
        for n in 0..N {
            sums[i][n].store_slice(&mut found[i][n * width..(n + 1) * width]);
        }
    }
    found
}
