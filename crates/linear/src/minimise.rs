//! A minimum within bounds of a smooth function of some twenty numbers.
//!
//! Quasi-Newton steps with the whole matrix of Broyden, Fletcher, Goldfarb and Shanno (Nocedal, Wright 2006, chapter 6): with so few numbers
//! its limited-memory form saves nothing, and bounds are kept by leaving out the numbers that press against one. A library for it would bring
//! more lines of adapters than these.

use nalgebra::{DMatrix, DVector};

/// Halvings of a step before none is found.
const HALVINGS: usize = 12;
/// Share of the promised decrease that a step must bring (Armijo).
const ARMIJO: f64 = 1e-4;

/// What to minimise: value and gradient; `None` where there is none, which no step goes to.
pub type Objective<'f> = dyn FnMut(&[f64]) -> Option<(f64, Vec<f64>)> + 'f;

/// The best point found from `start` on within `bounds`, and its value; `None` where the start has none.
///
/// Ends after `most` steps, or where the value falls by less than `least` per unit of any number. That a step gains little is no end: it may be a
/// short one, by a matrix that does not know the valley yet.
pub fn minimise(
    objective: &mut Objective<'_>,
    start: &[f64],
    bounds: &[(f64, f64)],
    most: usize,
    least: f64,
) -> Option<(Vec<f64>, f64)> {
    let n = start.len();
    let inside = |x: &DVector<f64>| DVector::from_fn(n, |i, _| x[i].clamp(bounds[i].0, bounds[i].1));
    let mut x = inside(&DVector::from_column_slice(start));
    let (mut value, slope) = objective(x.as_slice())?;
    let mut slope = DVector::from_vec(slope);
    let first = |slope: &DVector<f64>| DMatrix::identity(n, n) * (1.0 / slope.norm().max(1.0));
    let mut inverse = first(&slope);
    let mut fresh = true;
    for _ in 0..most {
        // What presses against its bound stays.
        let free = |i: usize| !(x[i] <= bounds[i].0 && slope[i] > 0.0 || x[i] >= bounds[i].1 && slope[i] < 0.0);
        let downhill = DVector::from_fn(n, |i, _| if free(i) { -slope[i] } else { 0.0 });
        let mut step = &inverse * &downhill;
        (0..n).filter(|&i| !free(i)).for_each(|i| step[i] = 0.0);
        if step.dot(&downhill) <= 0.0 {
            inverse = first(&slope);
            step = &inverse * &downhill;
        }
        let promise = step.dot(&downhill);
        if promise <= 0.0 || downhill.amax() < least {
            break;
        }
        let mut share = 1.0;
        let mut next = None;
        for _ in 0..HALVINGS {
            let there = inside(&(&x + &step * share));
            if let Some((lower, slope)) =
                objective(there.as_slice()).filter(|(v, _)| *v <= value - ARMIJO * share * promise)
            {
                next = Some((there, lower, DVector::from_vec(slope)));
                break;
            }
            share *= 0.4;
        }
        let Some((there, lower, new_slope)) = next else { break };
        let (moved, changed) = (&there - &x, &new_slope - &slope);
        (x, value, slope) = (there, lower, new_slope);
        let along = moved.dot(&changed);
        if along > 1e-10 * moved.norm() * changed.norm() {
            if fresh {
                // The size of the curvature, before anything is known of its shape (Nocedal, Wright 2006, equation 6.20).
                inverse = DMatrix::identity(n, n) * (along / changed.norm_squared());
                fresh = false;
            }
            let curved = &inverse * &changed;
            let factor = (1.0 + changed.dot(&curved) / along) / along;
            inverse += &moved * moved.transpose() * factor
                - (&curved * moved.transpose() + &moved * curved.transpose()) / along;
        }
    }
    Some((x.as_slice().to_vec(), value))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_valley_of_rosenbrock_is_walked_to_its_end_and_bounds_hold() {
        let mut valley = |x: &[f64]| {
            let (a, b) = (1.0 - x[0], x[1] - x[0] * x[0]);
            Some((a * a + 100.0 * b * b, vec![-2.0 * a - 400.0 * b * x[0], 200.0 * b]))
        };
        let free = [(-5.0, 5.0); 2];
        let (x, value) = minimise(&mut valley, &[-1.2, 1.0], &free, 200, 1e-14).unwrap();
        assert!(value < 1e-10 && (x[0] - 1.0).abs() < 1e-4, "{x:?} {value}");
        let (x, _) = minimise(&mut valley, &[-1.2, 1.0], &[(-5.0, 0.5), (-5.0, 5.0)], 200, 1e-14).unwrap();
        assert!((x[0] - 0.5).abs() < 1e-12 && (x[1] - 0.25).abs() < 1e-4, "{x:?}");
        // Steep one way and shallow another: the first steps gain little, the way is long.
        let mut trough = |x: &[f64]| {
            let (a, b) = (x[0], x[1] - 3.0);
            Some((5e3 * a * a + 0.5 * b * b, vec![1e4 * a, b]))
        };
        let (x, _) = minimise(&mut trough, &[1e-3, 0.0], &free, 40, 0.1).unwrap();
        assert!((x[1] - 3.0).abs() < 0.5, "{x:?}");
        assert_eq!(minimise(&mut |_| None, &[0.0], &[(-1.0, 1.0)], 5, 1e-9), None);
    }
}
