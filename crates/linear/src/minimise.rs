//! A minimum within bounds of a smooth function of about twenty numbers with approximately known curvature.
//!
//! Damped Newton steps (Levenberg, Marquardt; Nocedal, Wright 2006, chapters 4 and 10): numbers are logarithms, so that the damping needs no scale.
//! A library would need more lines of adapters than these.

use nalgebra::{DMatrix, DVector};

/// Initial damping, and its factors after a good and after a bad step.
const DAMPING: f64 = 1.0;
const LESS: f64 = 0.2;
const MORE: f64 = 5.0;
/// Fractions of the predicted decrease below which a step is bad and above which it is good (Nocedal, Wright 2006, algorithm 4.1).
const BAD: f64 = 0.25;
const GOOD: f64 = 0.75;
/// Longest step of a number: a factor of seven.
const LONGEST: f64 = 2.0;
/// The damping at which the search for a step ends.
const MOST_DAMPING: f64 = 1e8;

/// The function at a point.
#[derive(Debug, Clone)]
pub struct Local {
    /// Its value.
    pub value: f64,
    /// Its derivatives.
    pub slope: DVector<f64>,
    /// Its second derivatives, or an approximation: not negative in any direction.
    pub curvature: DMatrix<f64>,
}

/// The best point found from `start` within `bounds`, and its value; `None` where the start has none.
///
/// Ends after `most` points, or where all derivatives are below `least`. No step goes to a point without a value.
pub fn minimise(
    objective: &mut dyn FnMut(&[f64]) -> Option<Local>,
    start: &[f64],
    bounds: &[(f64, f64)],
    most: usize,
    least: f64,
) -> Option<(Vec<f64>, f64)> {
    let n = start.len();
    let inside = |x: &DVector<f64>| DVector::from_fn(n, |i, _| x[i].clamp(bounds[i].0, bounds[i].1));
    let mut x = inside(&DVector::from_column_slice(start));
    let mut here = objective(x.as_slice())?;
    let mut damping = DAMPING;
    for _ in 0..most {
        // Numbers that push against their bound are fixed.
        let (low, high) = (|i: usize| x[i] <= bounds[i].0, |i: usize| x[i] >= bounds[i].1);
        let stays = |i: &usize| low(*i) && here.slope[*i] >= 0.0 || high(*i) && here.slope[*i] <= 0.0;
        let free: Vec<usize> = (0..n).filter(|i| !stays(i)).collect();
        let slope = here.slope.select_rows(&free);
        if free.is_empty() || slope.amax() < least || damping > MOST_DAMPING {
            break;
        }
        let curvature = here.curvature.select_rows(&free).select_columns(&free);
        let damped = &curvature + DMatrix::identity(free.len(), free.len()) * damping;
        let Some(factor) = damped.cholesky() else {
            damping *= MORE;
            continue;
        };
        let mut step = DVector::zeros(n);
        let solved = factor.solve(&-&slope);
        free.iter().zip(solved.iter()).for_each(|(&i, own)| step[i] = own.clamp(-LONGEST, LONGEST));
        let there = inside(&(&x + step));
        let step = (&there - &x).select_rows(&free);
        let promise = -(step.dot(&slope) + 0.5 * step.dot(&(&curvature * &step)));
        let found = objective(there.as_slice()).filter(|found| found.value < here.value);
        let share = found.as_ref().map_or(0.0, |found| (here.value - found.value) / promise.max(f64::MIN_POSITIVE));
        if let Some(found) = found {
            (x, here) = (there, found);
        }
        damping *= if share > GOOD {
            LESS
        } else if share < BAD {
            MORE
        } else {
            1.0
        };
    }
    Some((x.as_slice().to_vec(), here.value))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_valley_of_rosenbrock_is_walked_to_its_end_and_bounds_hold() {
        // Sum of squares of r: the curvature uses only the derivatives J of r, 2 Jᵀ J.
        let mut valley = |x: &[f64]| {
            let r = DVector::from_vec(vec![1.0 - x[0], 10.0 * (x[1] - x[0] * x[0])]);
            let j = DMatrix::from_row_slice(2, 2, &[-1.0, 0.0, -20.0 * x[0], 10.0]);
            Some(Local { value: r.norm_squared(), slope: j.tr_mul(&r) * 2.0, curvature: j.tr_mul(&j) * 2.0 })
        };
        let free = [(-5.0, 5.0); 2];
        let (x, value) = minimise(&mut valley, &[-1.2, 1.0], &free, 100, 1e-9).unwrap();
        assert!(value < 1e-10 && (x[0] - 1.0).abs() < 1e-4, "{x:?} {value}");
        let (x, _) = minimise(&mut valley, &[-1.2, 1.0], &[(-5.0, 0.5), (-5.0, 5.0)], 100, 1e-9).unwrap();
        assert!((x[0] - 0.5).abs() < 1e-12 && (x[1] - 0.25).abs() < 1e-4, "{x:?}");
        // Steep in one direction and shallow in another.
        let mut trough = |x: &[f64]| {
            let (a, b) = (x[0], x[1] - 3.0);
            Some(Local {
                value: 5e3 * a * a + 0.5 * b * b,
                slope: DVector::from_vec(vec![1e4 * a, b]),
                curvature: DMatrix::from_diagonal(&DVector::from_vec(vec![1e4, 1.0])),
            })
        };
        let (x, _) = minimise(&mut trough, &[1e-3, 0.0], &free, 40, 0.1).unwrap();
        assert!((x[1] - 3.0).abs() < 0.5, "{x:?}");
        assert!(minimise(&mut |_| None, &[0.0], &[(-1.0, 1.0)], 5, 1e-9).is_none());
    }

    #[test]
    fn no_step_goes_where_there_is_no_value() {
        let mut cut = |x: &[f64]| {
            let slope = DVector::from_element(1, 2.0 * (x[0] + 3.0));
            (x[0] > 0.0).then(|| Local {
                value: (x[0] + 3.0).powi(2),
                slope,
                curvature: DMatrix::from_element(1, 1, 2.0),
            })
        };
        let (x, _) = minimise(&mut cut, &[1.0], &[(-5.0, 5.0)], 60, 1e-9).unwrap();
        assert!(x[0] > 0.0 && x[0] < 0.2, "{x:?}");
    }
}
