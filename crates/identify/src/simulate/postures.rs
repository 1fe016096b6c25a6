//! Postures of a simulated arm in which a target is at a required place.

use denavit_model::Chain;
use denavit_model::nalgebra::{DMatrix, SVector};

/// Newton's steps.
const STEPS: usize = 60;
/// Step of the derivatives, rad or m.
const DIFFERENCE: f64 = 1e-6;
/// Largest step of a joint, rad or m.
const MOST: f64 = 0.3;
/// Tolerance of the solution, m and rad.
const THERE: f64 = 1e-12;

/// The posture near `q`, within the limits, in which `off` (m, rad) is 0; `None` where there is none.
pub fn brought_to<const N: usize>(
    chain: &Chain,
    off: impl Fn(&[f64]) -> SVector<f64, N>,
    mut q: Vec<f64>,
) -> Option<Vec<f64>> {
    for _ in 0..STEPS {
        let left = off(&q);
        if left.norm() < THERE {
            break;
        }
        let jacobian = DMatrix::from_fn(N, q.len(), |row, k| {
            let mut moved = q.clone();
            moved[k] += DIFFERENCE;
            (left - off(&moved))[row] / DIFFERENCE
        });
        let step = jacobian.svd(true, true).solve(&left, 1e-6).expect("both factors are asked for");
        let most = step.amax().max(MOST) / MOST;
        q.iter_mut().zip(step.iter()).for_each(|(value, by)| *value += by / most);
    }
    let within = chain.coordinates().iter().zip(&q).all(|(coordinate, value)| {
        let (lower, upper) = coordinate.range();
        (lower..=upper).contains(value)
    });
    (within && off(&q).norm() < 1e3 * THERE).then_some(q)
}
