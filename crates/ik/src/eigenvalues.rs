//! Eigenvalues of a small real matrix without symmetry: Francis' QR algorithm, with the exceptional shifts without which it may run in
//! circles.
//!
//! # Source
//! Golub, Van Loan, Matrix Computations, 4th edition, 7.5; the exceptional shifts of LAPACK's `dhseqr`.

use denavit_model::nalgebra::{Complex, SMatrix, SVector};

/// Steps for one eigenvalue or pair, as LAPACK allows: three are usual, and an exceptional shift comes after ten.
const MOST_STEPS: usize = 300;
const EXCEPTIONAL: usize = 10;

/// Rows and columns of the matrices: solutions of six revolute joints.
const N: usize = 16;

/// All eigenvalues, each of a complex pair; `None` where the matrix is not finite or an eigenvalue does not converge.
pub(crate) fn eigenvalues(matrix: &SMatrix<f64, N, N>) -> Option<SVector<Complex<f64>, N>> {
    if !matrix.iter().all(|x| x.is_finite()) {
        return None;
    }
    let mut h = matrix.hessenberg().unpack_h();
    // Rounding in the matrix as a whole: an entry below the diagonal that is smaller is zero.
    let rounding = f64::EPSILON * h.amax();
    let mut found = SVector::zeros();
    // Rows below `end` are done.
    let (mut end, mut steps) = (N, 0);
    while end > 0 {
        let start = block_start(&h, end, rounding);
        match end - start {
            1 => {
                found[end - 1] = Complex::new(h[(end - 1, end - 1)], 0.0);
                (end, steps) = (end - 1, 0);
            }
            2 => {
                [found[end - 2], found[end - 1]] = of_two(&h, end);
                (end, steps) = (end - 2, 0);
            }
            _ if steps == MOST_STEPS => return None,
            _ => {
                steps += 1;
                let shifts = if steps % EXCEPTIONAL == 0 {
                    exceptional(&h, start, end, steps % (2 * EXCEPTIONAL) == 0)
                } else {
                    usual(&h, end)
                };
                sweep(&mut h, start, end, shifts);
            }
        }
    }
    Some(found)
}

/// Where the last block begins that no zero below the diagonal divides.
fn block_start(h: &SMatrix<f64, N, N>, end: usize, rounding: f64) -> usize {
    (1..end).rev().find(|k| h[(*k, k - 1)].abs() <= rounding).unwrap_or(0)
}

/// The eigenvalues of the 2 × 2 block that ends there.
fn of_two(h: &SMatrix<f64, N, N>, end: usize) -> [Complex<f64>; 2] {
    let (a, b, c, d) = (h[(end - 2, end - 2)], h[(end - 2, end - 1)], h[(end - 1, end - 2)], h[(end - 1, end - 1)]);
    let half = 0.5 * (a - d);
    let square = half * half + b * c;
    if square < 0.0 {
        let im = (-square).sqrt();
        return [Complex::new(d + half, im), Complex::new(d + half, -im)];
    }
    // The larger first: the other from the product loses no digits.
    let far = half + square.sqrt().copysign(half);
    let near = if far == 0.0 { 0.0 } else { -b * c / far };
    [Complex::new(d + far, 0.0), Complex::new(d + near, 0.0)]
}

/// x, y and w of the two shifts, the roots of (s - x)(s - y) = w: the last 2 × 2 block's eigenvalues if they are complex, twice that
/// nearer to its last entry if they are real.
fn usual(h: &SMatrix<f64, N, N>, end: usize) -> [f64; 3] {
    let [near, far] = of_two(h, end);
    let last = h[(end - 1, end - 1)];
    if near.im != 0.0 {
        return [last, h[(end - 2, end - 2)], h[(end - 2, end - 1)] * h[(end - 1, end - 2)]];
    }
    let shift = if (near.re - last).abs() < (far.re - last).abs() { near.re } else { far.re };
    [shift, shift, 0.0]
}

/// Shifts near an end of the block, the ends in turn, as far from its diagonal as the entries below it are large.
fn exceptional(h: &SMatrix<f64, N, N>, start: usize, end: usize, first: bool) -> [f64; 3] {
    let (corner, next) = if first { (start, start) } else { (end - 1, end - 3) };
    let size = h[(next + 1, next)].abs() + h[(next + 2, next + 1)].abs();
    let middle = h[(corner, corner)] + 0.75 * size;
    [middle, middle, -0.4375 * size * size]
}

/// One implicit double-shift step on the block from `start` to `end`.
fn sweep(h: &mut SMatrix<f64, N, N>, start: usize, end: usize, [x, y, w]: [f64; 3]) {
    // The first column of (H - s1)(H - s2) over its last factor: of differences, which are exact where all eigenvalues are alike.
    let (a, b, c, d) = (h[(start, start)], h[(start, start + 1)], h[(start + 1, start)], h[(start + 1, start + 1)]);
    let mut column = [((x - a) * (y - a) - w) / c + b, d - a - (x - a) - (y - a), h[(start + 2, start + 1)]];
    for k in start..end - 1 {
        let rows = 3.min(end - k);
        if k > start {
            column = std::array::from_fn(|n| if n < rows { h[(k + n, k - 1)] } else { 0.0 });
        }
        let Some((v, scale)) = reflector(&column[..rows]) else { continue };
        let v = &v[..rows];
        for j in k.saturating_sub(1).max(start)..end {
            let along = scale * v.iter().enumerate().map(|(n, v)| v * h[(k + n, j)]).sum::<f64>();
            v.iter().enumerate().for_each(|(n, v)| h[(k + n, j)] -= along * v);
        }
        for i in start..end.min(k + 4) {
            let along = scale * v.iter().enumerate().map(|(n, v)| v * h[(i, k + n)]).sum::<f64>();
            v.iter().enumerate().for_each(|(n, v)| h[(i, k + n)] -= along * v);
        }
    }
}

/// v and 2 / v·v of the reflection that takes a column to its first entry.
fn reflector(column: &[f64]) -> Option<([f64; 3], f64)> {
    let length = column.iter().map(|x| x * x).sum::<f64>().sqrt();
    if length == 0.0 || !length.is_finite() {
        return None;
    }
    let mut v = [0.0; 3];
    v[..column.len()].copy_from_slice(column);
    v[0] += length.copysign(column[0]);
    Some((v, 2.0 / v.iter().map(|x| x * x).sum::<f64>()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// The farthest of the expected eigenvalues from the nearest found.
    fn misses(matrix: &SMatrix<f64, N, N>, expected: &[Complex<f64>]) -> f64 {
        let found = eigenvalues(matrix).expect("converges");
        let nearest = |z: &Complex<f64>| found.iter().map(|f| (f - z).norm()).fold(f64::INFINITY, f64::min);
        expected.iter().map(nearest).fold(0.0, f64::max)
    }

    #[test]
    fn a_cycle_of_unit_vectors_has_the_roots_of_unity() {
        // Without exceptional shifts the algorithm does not change this matrix.
        let cycle = SMatrix::<f64, N, N>::from_fn(|i, j| if i == (j + 1) % N { 1.0 } else { 0.0 });
        let roots: Vec<_> =
            (0..N).map(|k| Complex::from_polar(1.0, std::f64::consts::TAU * k as f64 / N as f64)).collect();
        assert!(misses(&cycle, &roots) < 1e-13);
    }

    proptest! {
        #[test]
        fn eigenvalues_of_blocks_are_found_in_any_basis(
            parts in prop::collection::vec((-2.0..2.0f64, -2.0..2.0f64, any::<bool>()), N / 2),
            basis in prop::collection::vec(-1.0..1.0f64, N * N),
        ) {
            let mut blocks = SMatrix::<f64, N, N>::zeros();
            let mut expected = Vec::new();
            for (k, (a, b, real)) in parts.into_iter().enumerate() {
                let at = 2 * k;
                (blocks[(at, at)], blocks[(at + 1, at + 1)]) = if real { (a, b) } else { (a, a) };
                if real {
                    expected.extend([Complex::new(a, 0.0), Complex::new(b, 0.0)]);
                } else {
                    (blocks[(at, at + 1)], blocks[(at + 1, at)]) = (-b, b);
                    expected.extend([Complex::new(a, b), Complex::new(a, -b)]);
                }
            }
            let basis = SMatrix::<f64, N, N>::from_iterator(basis).qr().q();
            prop_assert!(misses(&(basis.transpose() * blocks * basis), &expected) < 1e-12);
        }
    }
}
