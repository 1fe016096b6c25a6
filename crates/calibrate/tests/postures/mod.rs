//! Postures of a simulated arm in which something is where it is wanted.

use denavit_model::Chain;
use denavit_model::nalgebra::{DMatrix, SVector};

/// The posture near `q`, within the limits, in which what is `off` (m, rad) is nothing.
pub fn brought_to<const N: usize>(
    chain: &Chain,
    off: impl Fn(&[f64]) -> SVector<f64, N>,
    mut q: Vec<f64>,
) -> Option<Vec<f64>> {
    const STEP: f64 = 1e-6;
    for _ in 0..60 {
        let left = off(&q);
        if left.norm() < 1e-12 {
            break;
        }
        let jacobian = DMatrix::from_fn(N, q.len(), |row, k| {
            let mut moved = q.clone();
            moved[k] += STEP;
            (left - off(&moved))[row] / STEP
        });
        let step = jacobian.svd(true, true).solve(&left, 1e-6).ok()?;
        let most = step.amax().max(0.3) / 0.3;
        q.iter_mut().zip(step.iter()).for_each(|(value, by)| *value += by / most);
    }
    let within = chain.coordinates().iter().zip(&q).all(|(coordinate, value)| {
        let (lower, upper) = coordinate.range();
        (lower..=upper).contains(value)
    });
    (within && off(&q).norm() < 1e-9).then_some(q)
}
