//! Joints with another zero, and its size.
//!
//! ```text
//! |pᵢ - pₖ| = |Tᵢ t - Tₖ t|      p measured, T base_from_tip by the drawing, t the target on the tip
//! ```
//! The distance between two measured points does not depend on where the instrument stands. So only the target and one or two zeros are
//! unknown: zeros are scanned, targets follow by least squares, and the best are refined together.

use super::{ITERATIONS_TO_TRY, nominal_misfit, size_of};
use denavit_measurements::Measurements;
use denavit_model::nalgebra::{DMatrix, DVector, Point3};
use denavit_model::{Chain, Pose, Quantity};
use std::f64::consts::{PI, TAU};

/// Zeros that are scanned, rad apart.
const STEP: f64 = PI / 6.0;
/// A smaller zero is fitted as geometry by the calibration.
pub(super) const LEAST_ZERO: f64 = 10.0 * PI / 180.0;
/// Zeros are rounded to multiples of this, rad, if they are this near to a multiple.
const ROUND: f64 = PI / 12.0;
const NEARLY_ROUND: f64 = 1.5 * PI / 180.0;
/// Largest number of targets in the scan.
const TARGETS: usize = 3;
/// Number of results for one joint, and for two.
const SINGLES: usize = 4;
const PAIRS: usize = 3;
/// Pairs of zeros that are refined.
const REFINED: usize = 8;
/// Numbers beyond the unknowns.
const SPARE: usize = 9;

/// Zeros of joints, by index: what is added to a reading to have the angle of the drawing.
pub(super) type Zeros = Vec<(usize, f64)>;

/// Distances between measured points, and where the tip is by the drawing.
struct Distances<'a> {
    chain: &'a Chain,
    data: &'a Measurements,
    /// Two rows, a target, the measured distance in m.
    pairs: Vec<(usize, usize, usize, f64)>,
    targets: usize,
}

impl<'a> Distances<'a> {
    fn of(chain: &'a Chain, data: &'a Measurements) -> Option<Self> {
        let targets = data.scene.targets.len().min(TARGETS);
        let seen = |target: usize, row: usize| {
            let observation = data.of_target(row, target)?;
            let at = data.series_of(observation).kind.position(data.observed.values(observation))?;
            Some((row, data.series_of(observation).setup, at))
        };
        let mut pairs = Vec::new();
        for target in 0..targets {
            let points: Vec<_> = (0..data.len()).filter_map(|row| seen(target, row)).collect();
            for (index, (row, setup, at)) in points.iter().enumerate() {
                let others = points[..index].iter().filter(|other| other.1 == *setup);
                pairs.extend(others.map(|(other, _, there)| (*row, *other, target, (at - there).norm())));
            }
        }
        let rows = data.len();
        (rows > 4 && 3 * rows >= 6 + 3 * targets + SPARE && !pairs.is_empty()).then_some(Self {
            chain,
            data,
            pairs,
            targets,
        })
    }

    fn tips(&self, zeros: &[(usize, f64)]) -> Vec<Pose> {
        let tips = self.data.scene.tips_of(self.chain);
        let mut reading = vec![0.0; self.data.joints.len()];
        let at = |row: usize| {
            reading.copy_from_slice(self.data.reading(row));
            for (joint, zero) in zeros {
                reading[*joint] += zero;
            }
            tips[self.data.tip_of(row)].fk(self.chain, &reading)
        };
        (0..self.data.len()).map(at).collect()
    }

    fn left(&self, tips: &[Pose], targets: &[f64]) -> DVector<f64> {
        let on_tip = |row: usize, target: usize| {
            let t = Point3::new(targets[3 * target], targets[3 * target + 1], targets[3 * target + 2]);
            tips[row] * t
        };
        let left = self
            .pairs
            .iter()
            .map(|(a, b, target, measured)| measured - (on_tip(*a, *target) - on_tip(*b, *target)).norm());
        DVector::from_iterator(self.pairs.len(), left)
    }

    /// The targets for these zeros, and the size of the residual.
    fn placed(&self, zeros: &[(usize, f64)], iterations: usize) -> (Vec<f64>, f64) {
        let tips = self.tips(zeros);
        let start = vec![1e-3 * self.chain.size(); 3 * self.targets];
        let (targets, left) = least_squares(&|targets| self.left(&tips, targets), start, iterations, self.chain.size());
        (targets, median(&left))
    }

    /// Zeros and targets together, from a start.
    fn refined(&self, zeros: &[(usize, f64)]) -> (Zeros, f64) {
        let (mut start, _) = self.placed(zeros, 4);
        start.extend(zeros.iter().map(|(_, zero)| zero));
        let with = |numbers: &[f64]| -> Zeros {
            let own = &numbers[3 * self.targets..];
            zeros.iter().zip(own).map(|((joint, _), zero)| (*joint, *zero)).collect()
        };
        let left = |numbers: &[f64]| self.left(&self.tips(&with(numbers)), numbers);
        let (numbers, left) = least_squares(&left, start, 12, self.chain.size());
        (with(&numbers), median(&left))
    }
}

/// Damped least squares with numerical derivatives: a few unknowns, a few hundred residuals.
fn least_squares(
    left: &dyn Fn(&[f64]) -> DVector<f64>,
    mut numbers: Vec<f64>,
    iterations: usize,
    size: f64,
) -> (Vec<f64>, DVector<f64>) {
    let mut now = left(&numbers);
    let mut damping = 1e-3;
    for _ in 0..iterations {
        let mut slopes = DMatrix::zeros(now.len(), numbers.len());
        for k in 0..numbers.len() {
            let step = 1e-6 * size;
            let mut moved = numbers.clone();
            moved[k] += step;
            slopes.set_column(k, &((left(&moved) - &now) / step));
        }
        let mut matrix = slopes.transpose() * &slopes;
        let gradient = slopes.transpose() * &now;
        for k in 0..numbers.len() {
            matrix[(k, k)] += damping * matrix[(k, k)] + f64::MIN_POSITIVE;
        }
        let Some(step) = matrix.cholesky().map(|factor| factor.solve(&gradient)) else { break };
        let next: Vec<f64> = numbers.iter().zip(step.iter()).map(|(number, step)| number - step).collect();
        let then = left(&next);
        if then.norm_squared() < now.norm_squared() {
            let gained = now.norm_squared() - then.norm_squared();
            let small = gained < 1e-6 * now.norm_squared();
            (numbers, now, damping) = (next, then, damping * 0.1);
            if small {
                break;
            }
        } else {
            damping *= 30.0;
        }
    }
    (numbers, now)
}

fn median(left: &DVector<f64>) -> f64 {
    let mut sizes: Vec<f64> = left.iter().map(|left| left.abs()).collect();
    let middle = sizes.len() / 2;
    if sizes.is_empty() { 0.0 } else { *sizes.select_nth_unstable_by(middle, f64::total_cmp).1 }
}

/// An angle from -π to π.
fn wrapped(angle: f64) -> f64 {
    angle - TAU * (angle / TAU).round()
}

/// The intended zero, if the estimate is near a round one; the drawing's own geometry is within a degree or so.
fn meant(zero: f64) -> f64 {
    let round = (zero / ROUND).round() * ROUND;
    let exact = if (zero - round).abs() < NEARLY_ROUND {
        round
    } else {
        (zero.to_degrees() * 100.0).round().to_radians() / 100.0
    };
    // A half turn is one, whichever way.
    if (exact + PI).abs() < 1e-9 { PI } else { exact }
}

/// Zeros of one joint and of two that explain these rows better than no zero, the best first.
pub(super) fn likely(chain: &Chain, data: &Measurements, pairs_too: bool) -> Vec<Zeros> {
    let angle = |joint: &usize| chain.coordinates()[*joint].quantity == Quantity::Angle && !data.never_moves(*joint);
    let joints: Vec<usize> = (0..data.joints.len()).filter(angle).collect();
    let posed = data.as_poses();
    let data = posed.as_ref().unwrap_or(data);
    let Some(distances) = Distances::of(chain, data) else { return by_fit(chain, data, &joints) };
    let scan = || (1..12).map(|k| wrapped(f64::from(k) * STEP));
    let (_, without) = distances.placed(&[], 8);
    let mut singles: Vec<(f64, Zeros)> = Vec::new();
    for &joint in &joints {
        let scored = scan().map(|zero| (distances.placed(&[(joint, zero)], 4).1, zero));
        let mut scored: Vec<(f64, f64)> = scored.collect();
        scored.sort_by(|a, b| a.0.total_cmp(&b.0));
        let refined = scored.iter().take(2).map(|(_, zero)| distances.refined(&[(joint, *zero)]));
        let best = refined.min_by(|a, b| a.1.total_cmp(&b.1));
        singles.extend(best.map(|(zeros, score)| (score, zeros)));
    }
    let mut found = sorted(singles, without, SINGLES);
    if pairs_too {
        let mut pairs: Vec<(f64, Zeros)> = Vec::new();
        for (index, &b) in joints.iter().enumerate() {
            for &a in &joints[..index] {
                for one in scan() {
                    for other in scan() {
                        let zeros = vec![(a, one), (b, other)];
                        pairs.push((distances.placed(&zeros, 2).1, zeros));
                    }
                }
            }
        }
        pairs.sort_by(|x, y| x.0.total_cmp(&y.0));
        pairs.truncate(REFINED);
        let refined =
            pairs.into_iter().map(|(_, zeros)| distances.refined(&zeros)).map(|(zeros, score)| (score, zeros));
        found.extend(sorted(refined.collect(), without, PAIRS));
    }
    found
}

/// The best, each set of joints once, with the intended zeros.
fn sorted(mut found: Vec<(f64, Zeros)>, without: f64, most: usize) -> Vec<Zeros> {
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut kept: Vec<Zeros> = Vec::new();
    for (score, zeros) in found {
        let zeros: Zeros = zeros.into_iter().map(|(joint, zero)| (joint, meant(wrapped(zero)))).collect();
        let large = zeros.iter().all(|(_, zero)| zero.abs() >= LEAST_ZERO);
        if large && score < without && !kept.contains(&zeros) && kept.len() < most {
            kept.push(zeros);
        }
    }
    kept
}

/// The same where no positions are measured: each zero of one joint by a fit of the robot as drawn.
fn by_fit(chain: &Chain, data: &Measurements, joints: &[usize]) -> Vec<Zeros> {
    if data.values() < 6 + 3 + SPARE + ITERATIONS_TO_TRY {
        return Vec::new();
    }
    let n = data.joints.len();
    let score = |joint: usize, zero: f64| {
        let mut altered = data.clone();
        altered.readings.chunks_exact_mut(n).for_each(|row| row[joint] += zero);
        size_of(nominal_misfit(chain, &altered), chain)
    };
    let without = size_of(nominal_misfit(chain, data), chain);
    let mut found: Vec<(f64, Zeros)> = Vec::new();
    for &joint in joints {
        let scan = (1..12).map(|k| wrapped(f64::from(k) * STEP)).map(|zero| (score(joint, zero), zero));
        let Some((_, zero)) = scan.min_by(|a, b| a.0.total_cmp(&b.0)) else { continue };
        // Thirds of the remaining interval around the best.
        let (mut low, mut high) = (zero - STEP, zero + STEP);
        for _ in 0..14 {
            let third = (high - low) / 3.0;
            if score(joint, low + third) < score(joint, high - third) { high -= third } else { low += third }
        }
        let zero = 0.5 * (low + high);
        found.push((score(joint, zero), vec![(joint, zero)]));
    }
    sorted(found, without, SINGLES)
}
