//! Sums of products with sixteen columns at once: each sum has its own SIMD lane, so none needs a horizontal sum at the
//! end.

use fearless_simd::{Simd, SimdBase as _, SimdFloat as _};

/// Columns of a panel.
pub const PANEL: usize = 16;

/// A cell of each of its columns, side by side.
pub type Line = [f64; PANEL];

/// The first `depth` cells of at most [`PANEL`] columns, line by line; missing columns are 0.
pub fn lines_of<'a>(columns: impl Iterator<Item = &'a [f64]>, depth: usize, lines: &mut Vec<Line>) {
    lines.clear();
    lines.resize(depth, [0.0; PANEL]);
    for (index, column) in columns.enumerate() {
        for (line, cell) in lines.iter_mut().zip(column) {
            line[index] = *cell;
        }
    }
}

/// For several rows `Σ row[k] lines[k]`: `take` receives the number of each row and its sums.
///
/// # Shape and units
/// `rows`: one after the other, with a stride of `stride` cells; each row uses as many cells as there are lines.
#[inline(always)]
pub fn each_sum<S: Simd>(simd: S, rows: &[f64], stride: usize, lines: &[Line], take: impl FnMut(usize, &Line)) {
    // As many sums as the registers hold.
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

/// The sums of `R` rows, each in `N` SIMD vectors.
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

#[cfg(test)]
mod tests {
    use super::*;
    use fearless_simd::{Level, dispatch};

    /// SIMD levels of the machine: its full width, and, where available, half and a quarter of it.
    fn levels() -> Vec<Level> {
        let native = Level::new();
        #[cfg(target_arch = "x86_64")]
        let others = [native.as_avx2().map(Level::Avx2), native.as_sse4_2().map(Level::Sse4_2)];
        #[cfg(not(target_arch = "x86_64"))]
        let others = [None; 2];
        std::iter::once(native).chain(others.into_iter().flatten()).collect()
    }

    #[test]
    fn sums_are_those_of_the_products_written_out_whatever_the_vectors() {
        let cell = |k: usize| (k as f64 * 0.83).sin();
        for (count, depth, columns) in [(1, 1, 16), (11, 40, 16), (20, 7, 5), (3, 0, 2)] {
            let stride = depth + 3;
            let rows: Vec<f64> = (0..(count - 1) * stride + depth.max(1)).map(cell).collect();
            let own: Vec<f64> = (0..columns * depth.max(1)).map(|k| cell(k + 9)).collect();
            let mut lines = Vec::new();
            lines_of(own.chunks_exact(depth.max(1)), depth, &mut lines);
            for level in levels() {
                let mut taken = 0;
                dispatch!(level, simd => each_sum(simd, &rows, stride, &lines, |row, sums| {
                    taken += 1;
                    for (column, found) in sums.iter().enumerate() {
                        let product = |k: usize| rows[row * stride + k] * own[column * depth + k];
                        let sum: f64 = if column < columns { (0..depth).map(product).sum() } else { 0.0 };
                        assert!((found - sum).abs() < 1e-12, "{level:?} {row} {column}");
                    }
                }));
                assert_eq!(taken, count);
            }
        }
    }
}
