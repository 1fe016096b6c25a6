//! The hyperparameters at which the marginal likelihood is largest.

use crate::infer::evidence::{Model, Slope};
use crate::infer::model::{Hyperparameters, Kernel, LARGEST};
use denavit_linear::threads::each_alone;
use denavit_model::nalgebra::{DMatrix, DVector};

/// A gain of the logarithm that changes no probability by more than a hundredth.
pub const NEGLIGIBLE: f64 = 0.01;
/// The same if the only question is whether a gain is several units.
pub const ROUGH: f64 = 0.1;
/// Smallest information about the logarithm of a hyperparameter: the data give none if the curve is 0.
const LEAST_INFORMATION: f64 = 0.1;
/// Steps of the search; it needs some five to ten.
const MOST_STEPS: usize = 60;
/// Factor by which a step that does not increase the score is shortened, and largest number of such cuts.
const CUT: f64 = 0.3;
const MOST_CUTS: usize = 12;
/// No step changes a hyperparameter by more than this factor's logarithm.
const LONGEST: f64 = 1.5;
/// Initial shares of the variance that the curves explain.
const SHARES: [f64; 3] = [0.05, 0.5, 0.95];
/// Lengths that the search starts from, as shares of the interval's width: some waves over it, and one.
const LENGTHS: [f64; 3] = [0.02, 0.07, 0.25];
/// Upper bound of a curve relative to the residual of geometry: a larger curve would replace geometry.
const MOST: f64 = 100.0;
/// Lower bound of a curve's variance relative to what is detectable: below it the curve is 0.
const NOTHING: f64 = 1e-6;

/// Bounds of each hyperparameter.
#[derive(Debug, Clone)]
struct Bounds {
    low: Vec<f64>,
    high: Vec<f64>,
}

impl Bounds {
    /// A length is at least what the fastest wave can follow, and at most twice the interval, where a curve is nearly a straight
    /// line.
    fn new(model: &Model<'_>) -> Self {
        let (mut low, mut high) = (vec![-30.0], vec![5.0]);
        for (waves, visible) in model.waves.iter().zip(model.visible) {
            low.extend([(visible * NOTHING).ln(), (1.0 / waves.frequency(waves.len() - 1)).ln()]);
            high.extend([
                (visible * MOST).min(LARGEST.powi(2)).ln(),
                (std::f64::consts::TAU / waves.frequency(0)).ln(),
            ]);
        }
        Self { low, high }
    }

    fn clamped(&self, mut at: Vec<f64>) -> Vec<f64> {
        for ((value, low), high) in at.iter_mut().zip(&self.low).zip(&self.high) {
            *value = value.clamp(*low, low.max(*high));
        }
        at
    }
}

/// The maximum, with the score's gradient there, from the best of a few starts and a known one, if any; a step that gains less than
/// `negligible` is the last.
pub fn from_afar(
    model: &Model<'_>,
    known: Option<&Hyperparameters>,
    negligible: f64,
) -> Option<(Slope, Hyperparameters)> {
    let bounds = Bounds::new(model);
    let curves = model.waves.len().max(1) as f64;
    let start = |share: f64, length: f64| {
        let kernels = model.waves.iter().zip(model.visible).map(|(waves, visible)| Kernel {
            log_variance: (visible * share / curves).ln(),
            log_length: (length * std::f64::consts::PI / waves.frequency(0)).ln(),
        });
        Hyperparameters { log_noise: (1.0 - share).ln(), kernels: kernels.collect() }
    };
    let starts = SHARES.iter().flat_map(|&share| LENGTHS.iter().map(move |&length| start(share, length)));
    let starts: Vec<Hyperparameters> =
        starts.chain(known.cloned()).map(|at| Hyperparameters::from_slice(&bounds.clamped(at.to_vec()))).collect();
    let scores = each_alone(&starts, |at| model.score(at));
    let scored = starts.into_iter().zip(scores).filter_map(|(at, score)| Some((score?, at)));
    let best = scored.max_by(|a, b| a.0.total_cmp(&b.0))?;
    ascend(model, &best.1, &bounds, negligible)
}

/// The same near a start.
pub fn from_near(model: &Model<'_>, start: &Hyperparameters, negligible: f64) -> Option<(Slope, Hyperparameters)> {
    ascend(model, start, &Bounds::new(model), negligible)
}

/// Newton steps within bounds, with the average information instead of the curvature.
fn ascend(
    model: &Model<'_>,
    start: &Hyperparameters,
    bounds: &Bounds,
    negligible: f64,
) -> Option<(Slope, Hyperparameters)> {
    let mut at = DVector::from_vec(bounds.clamped(start.to_vec()));
    let slope = |at: &DVector<f64>, least: f64| model.slope(&Hyperparameters::from_slice(at.as_slice()), least);
    let mut here = slope(&at, f64::NEG_INFINITY)?;
    for _ in 0..MOST_STEPS {
        let step = step_from(&here, model, &at, bounds);
        // A next step that promises less than that changes nothing.
        let Some(mut step) = step.filter(|step| along(&here, step) >= negligible) else { break };
        let mut found = None;
        for _ in 0..MOST_CUTS {
            let next = DVector::from_vec(bounds.clamped((&at + &step).as_slice().to_vec()));
            if let Some(there) = slope(&next, here.score) {
                found = Some((next, there));
                break;
            }
            step *= CUT;
        }
        let Some((next, there)) = found else { break };
        let gain = there.score - here.score;
        (at, here) = (next, there);
        if gain < negligible {
            break;
        }
    }
    Some((here, Hyperparameters::from_slice(at.as_slice())))
}

/// Whether hyperparameters lie outside the bounds.
#[cfg(test)]
pub(super) fn is_outside(model: &Model<'_>, at: &[f64]) -> bool {
    Bounds::new(model).clamped(at.to_vec()) != at
}

/// The directional derivative of the score along a step.
fn along(here: &Slope, step: &DVector<f64>) -> f64 {
    here.gradient.iter().zip(step).map(|(slope, step)| slope * step).sum()
}

/// The step to the maximum of the quadratic model; a hyperparameter that would cross its bound is held there.
fn step_from(here: &Slope, model: &Model<'_>, at: &DVector<f64>, bounds: &Bounds) -> Option<DVector<f64>> {
    let (count, gradient) = (at.len(), &here.gradient);
    let held: Vec<bool> = (0..count)
        .map(|k| (at[k] <= bounds.low[k] && gradient[k] < 0.0) || (at[k] >= bounds.high[k] && gradient[k] > 0.0))
        .collect();
    let information = here.information(model);
    let cell = |i: usize, k: usize| if held[i] || held[k] { 0.0 } else { information[(i, k)] };
    // For a curve near 0 the score rises in proportion to its variance: in logarithms a step of about one is right, whatever the slope.
    let least = |k: usize| LEAST_INFORMATION + if k > 0 { gradient[k].abs() } else { 0.0 };
    let matrix = DMatrix::from_fn(count, count, |i, k| cell(i, k) + if i == k { least(i) } else { 0.0 });
    let free = DVector::from_fn(count, |k, _| if held[k] { 0.0 } else { gradient[k] });
    let step = matrix.cholesky()?.solve(&free);
    let short = step.map(|cell| cell.clamp(-LONGEST, LONGEST));
    // If each component is limited by itself, the step need not increase the score.
    Some(if along(here, &short) > 0.0 { short } else { &step * (LONGEST / step.amax().max(LONGEST)) })
}
