//! Levenberg-Marquardt over the normal equations: prior, gauge, noise levels and gross outliers.

use crate::arm::Arm;
use crate::gauge;
use crate::measurements::{MeasurementKind, Measurements};
use crate::normal::Sums;
use crate::parameters::{Effects, Layout};
use crate::residual::Problem;
use denavit_model::nalgebra::{DMatrix, DVector};
use statrs::distribution::{ChiSquared, ContinuousCDF};

/// Standard deviation of one measured component.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Noise {
    /// Of a position's x, y or z, or of a distance, m.
    pub position: f64,
    /// Of a rotation vector's component, rad; 0 unless poses are measured.
    pub orientation: f64,
}

impl Noise {
    /// Equal to a hundredth: the prior's weight will not change any more.
    fn near(self, other: Self) -> bool {
        let near = |a: f64, b: f64| (a - b).abs() <= 0.01 * b;
        near(self.position, other.position) && near(self.orientation, other.orientation)
    }
}

/// How a fit treats outliers, and when it stops.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FitOptions {
    /// Weigh down and then reject what lies far outside the noise.
    pub robust: bool,
    /// Stop after this many steps.
    pub most_iterations: usize,
}

impl Default for FitOptions {
    fn default() -> Self {
        Self { robust: true, most_iterations: 60 }
    }
}

/// A fit's result.
#[derive(Debug, Clone)]
pub struct Fit<E> {
    /// The arm as identified.
    pub arm: Arm,
    /// The effects as identified.
    pub effects: E,
    /// Which numbers were free.
    pub layout: Layout,
    /// Noise of one component, freed of the parameters' share.
    pub noise: Noise,
    /// 1 or, for rejected or unseen observations, 0; row by row, target by target.
    pub weights: Vec<f64>,
    /// Squared residual norms of all observations, m² and rad².
    pub squares: Vec<[f64; 2]>,
    /// Covariance of the parameters, in their units, the common frame held (see [`gauge`]).
    pub covariance: DMatrix<f64>,
    /// Parameters that the data pay for: the trace of the hat matrix, by channel.
    pub parameters_used: [f64; 2],
    /// Values measured and kept, by channel.
    pub values: [f64; 2],
    /// Steps taken.
    pub iterations: usize,
    /// Whether the last step was too small to matter.
    pub converged: bool,
}

/// Damping that is always there, relative to the scaled diagonal: holds what the data do not see at all, biases nothing.
const LEAST_DAMPING: f64 = 1e-12;
/// Weight of the gauge's conditions relative to the scaled diagonal.
const GAUGE_WEIGHT: f64 = 10.0;
/// Share of the nominal robot's residual that the first step takes for noise. Where prior and data disagree two noise
/// levels can explain themselves; from below the data's is found.
const TRUST_AT_START: f64 = 0.03;
/// Noise is never taken to be smaller than this share of the robot's size: rounding.
const ROUNDING: f64 = 1e-14;
/// χ² of a step after which the next is small beside a change of the weights.
const PROMISE_NEAR_END: f64 = 1e3;
/// χ² that a step may still promise when outliers are told from the rest for good: a standard deviation, squared.
const PROMISE_FOR_REJECTION: f64 = 1.0;
/// χ² that the last step may promise: a hundredth of a standard deviation, squared. What is left after it is far less.
const PROMISE_AT_END: f64 = 1e-4;
/// Measured values beyond the parameters that it takes to tell the noise.
pub const DEGREES_FOR_NOISE: f64 = 6.0;
/// Noise that is taken where the data have too few degrees of freedom to tell it: share of the robot's size (a tenth of a
/// millimetre on a metre, what instruments and repeatability make together) and rad.
pub const ASSUMED_NOISE: f64 = 1e-4;
/// One clean file in a hundred may have a row that far out.
const FALSE_REJECTIONS: f64 = 0.01;
/// Gross means this many times further out than that: what the model lacks is no outlier.
const GROSS: f64 = 1.5;
/// If more than this share lies outside, it is not outliers.
const MOST_REJECTIONS: f64 = 0.3;

struct System {
    matrix: DMatrix<f64>,
    gradient: DVector<f64>,
    scale: DVector<f64>,
    gauge: Option<DMatrix<f64>>,
}

struct State<E> {
    arm: Arm,
    effects: E,
    sums: Sums,
    prior: f64,
}

/// Fit the free numbers of `layout` to the data, starting at `arm`.
///
/// Minimises Σ w |r|²/σ² + ηᵀ P η, σ estimated from the residuals by channel, η the axes' departure from nominal, P
/// the [prior](crate::prior). The departure of the
/// targets, where the gauge asks for it, is taken from the `arm` given.
///
/// # Shape and units
/// `weights`: one per observation, 0 for what is to be left out from the start.
pub fn fit<E: Effects>(
    data: &Measurements,
    layout: &Layout,
    arm: &Arm,
    effects: &E,
    weights: &[f64],
    options: &FitOptions,
) -> Fit<E> {
    Solver { data, layout, reference: arm.clone(), options: *options }.run(arm, effects, weights)
}

struct Solver<'a> {
    data: &'a Measurements,
    layout: &'a Layout,
    reference: Arm,
    options: FitOptions,
}

impl Solver<'_> {
    fn run<E: Effects>(&self, arm: &Arm, effects: &E, given: &[f64]) -> Fit<E> {
        let given: Vec<f64> = given.iter().enumerate().map(|(k, w)| if self.seen(k) { *w } else { 0.0 }).collect();
        let mut weights = given.clone();
        let mut state = self.evaluate(arm.clone(), effects.clone(), &weights);
        let mut used = [0.0; 2];
        let mut robust = self.options.robust;
        let mut noise = self.noise_of(&state.sums.squares, &weights, used, robust);
        // The nominal robot's residual is not noise: trust the data more than that in the first step.
        noise.position *= TRUST_AT_START;
        noise.orientation *= TRUST_AT_START;
        let (mut damping, mut iterations, mut rounds, mut converged) = (LEAST_DAMPING, 0, 0, false);
        while iterations < self.options.most_iterations {
            iterations += 1;
            let system = self.system(&state, noise);
            let (next, promise) = self.step(&state, &system, noise, &weights, &mut damping);
            let stuck = next.is_none();
            if let Some(next) = next {
                state = next;
            }
            if robust {
                noise = self.noise_of(&state.sums.squares, &weights, used, true);
                if stuck || promise < PROMISE_FOR_REJECTION || noise == self.rounding() || iterations > 12 {
                    robust = false;
                    weights = self.kept(&state.sums.squares, &given, noise);
                    state = self.evaluate(state.arm, state.effects, &weights);
                    used = self.parameters_used(&state, noise);
                    noise = self.noise_of(&state.sums.squares, &weights, used, false);
                } else {
                    weights = self.downweighted(&state.sums.squares, &given, noise);
                    if promise < PROMISE_NEAR_END {
                        // The next step gains less than other weights change: sums with the old ones would mislead it.
                        state = self.evaluate(state.arm, state.effects, &weights);
                    }
                }
                continue;
            }
            used = self.parameters_used(&state, noise);
            let settled = self.noise_of(&state.sums.squares, &weights, used, false);
            let steady = settled.near(noise);
            noise = settled;
            let rounding = noise == self.rounding();
            if (stuck || promise < PROMISE_AT_END || rounding) && steady {
                let kept = if self.options.robust && rounds < 4 {
                    self.kept(&state.sums.squares, &given, noise)
                } else {
                    weights.clone()
                };
                if kept == weights {
                    converged = true;
                    break;
                }
                rounds += 1;
                weights = kept;
                state = self.evaluate(state.arm, state.effects, &weights);
            }
        }
        self.finish(state, weights, iterations, converged)
    }

    fn finish<E: Effects>(&self, state: State<E>, weights: Vec<f64>, iterations: usize, converged: bool) -> Fit<E> {
        let mut noise = self.noise_of(&state.sums.squares, &weights, [0.0; 2], false);
        let mut used = [0.0; 2];
        for _ in 0..4 {
            used = self.parameters_used(&state, noise);
            noise = self.noise_of(&state.sums.squares, &weights, used, false);
        }
        let covariance = self.covariance(&state, noise);
        let count = |channel: usize| state.sums.channels.get(channel).map_or(0.0, |c| c.count);
        Fit {
            values: [count(0), count(1)],
            arm: state.arm,
            effects: state.effects,
            layout: self.layout.clone(),
            noise,
            weights,
            squares: state.sums.squares,
            covariance,
            parameters_used: used,
            iterations,
            converged,
        }
    }

    fn seen(&self, observation: usize) -> bool {
        self.data.kind != MeasurementKind::Position || self.data.positions[observation].is_some()
    }

    /// Degrees of freedom of an observation by channel.
    fn degrees(&self) -> [f64; 2] {
        degrees_of(self.data.kind)
    }

    fn evaluate<E: Effects>(&self, arm: Arm, effects: E, weights: &[f64]) -> State<E> {
        let sums = Problem { data: self.data, layout: self.layout, effects: &effects }.sums(&arm, weights);
        let prior = self.layout.prior_cost(&arm, &self.reference);
        State { arm, effects, sums, prior }
    }

    fn objective<E>(state: &State<E>, weights: &[f64], noise: Noise) -> f64 {
        let cost: f64 = state.sums.squares.iter().zip(weights).map(|(s, w)| w * chi_squared(*s, noise)).sum();
        cost + state.prior
    }

    fn system<E: Effects>(&self, state: &State<E>, noise: Noise) -> System {
        let n = self.layout.len();
        let departure = DVector::from_vec(self.layout.departure(&state.arm, &self.reference));
        let mut matrix = DMatrix::<f64>::zeros(n, n);
        let mut gradient = DVector::<f64>::zeros(n);
        for (channel, sigma) in state.sums.channels.iter().zip([noise.position, noise.orientation]) {
            let weight = sigma.powi(-2);
            for i in 0..n {
                gradient[i] -= weight * channel.gradient[i];
                for k in i..n {
                    matrix[(i, k)] += weight * channel.matrix[i * n + k];
                }
            }
        }
        matrix.fill_lower_triangle_with_upper_triangle();
        // The joints come first in the layout.
        let count = self.layout.joints.len();
        let pull = &self.layout.prior * departure.rows(0, count);
        let mut block = matrix.view_mut((0, 0), (count, count));
        block += &self.layout.prior;
        let mut joints = gradient.rows_mut(0, count);
        joints -= pull;
        let scale = DVector::from_fn(n, |i, _| if matrix[(i, i)] > 0.0 { matrix[(i, i)].powf(-0.5) } else { 1.0 });
        for i in 0..n {
            for k in 0..n {
                matrix[(i, k)] *= scale[i] * scale[k];
            }
        }
        gradient.component_mul_assign(&scale);
        let gauge = (!self.layout.joints.is_empty())
            .then(|| gauge::in_scaled(gauge::conditions(self.layout, &self.reference), scale.as_slice()));
        System { matrix, gradient, scale, gauge }
    }

    /// A step that lowers the objective, and the χ² that it promised; `None` when there is none.
    fn step<E: Effects>(
        &self,
        state: &State<E>,
        system: &System,
        noise: Noise,
        weights: &[f64],
        damping: &mut f64,
    ) -> (Option<State<E>>, f64) {
        let before = Self::objective(state, weights, noise);
        let mut promise = 0.0;
        for _ in 0..12 {
            let Some(scaled) = system.solve(*damping) else {
                *damping = (*damping * 10.0).max(1e-10);
                continue;
            };
            promise = scaled.dot(&(&system.matrix * &scaled));
            if promise < PROMISE_AT_END {
                return (None, promise);
            }
            let step: Vec<f64> = scaled.iter().zip(system.scale.iter()).map(|(y, s)| y * s).collect();
            let arm = gauge::centred(self.layout, &self.layout.stepped(&state.arm, &step), &self.reference);
            let effects = state.effects.stepped(&step[self.layout.effects.clone()]);
            let next = self.evaluate(arm, effects, weights);
            let after = Self::objective(&next, weights, noise);
            if after <= before + 1e-9 * promise.min(1.0) {
                *damping = (*damping * 0.1).max(LEAST_DAMPING);
                return (Some(next), promise);
            }
            if promise < PROMISE_AT_END.max(1e-9 * before) {
                break;
            }
            *damping = (*damping * 10.0).max(1e-6);
        }
        (None, promise)
    }

    /// The least noise that there can be.
    fn rounding(&self) -> Noise {
        let [_, orientation] = self.degrees();
        Noise {
            position: ROUNDING * self.reference.nominal.size(),
            orientation: if orientation > 0.0 { ROUNDING } else { 0.0 },
        }
    }

    /// Noise of one component by channel: from the median while outliers are still in, else from the sum of squares
    /// over the degrees of freedom that the parameters leave.
    fn noise_of(&self, squares: &[[f64; 2]], weights: &[f64], used: [f64; 2], robust: bool) -> Noise {
        let degrees = self.degrees();
        let floor = self.rounding();
        let of = |channel: usize| {
            if degrees[channel] == 0.0 {
                return 0.0;
            }
            let kept = squares.iter().zip(weights).filter(|(_, weight)| **weight > 0.0);
            let variance = if robust {
                let mut values: Vec<f64> = kept.map(|(square, _)| square[channel]).collect();
                median(&mut values) / median_of_chi_squared(degrees[channel])
            } else {
                let (mut sum, mut count) = (0.0, 0.0);
                for (square, weight) in kept {
                    sum += weight * square[channel];
                    count += weight * degrees[channel];
                }
                // Where few degrees of freedom are left, an assumed noise stands in for those that are missing.
                let missing = missing_degrees(count, used[channel]);
                let assumed = if channel == 0 { ASSUMED_NOISE * self.reference.nominal.size() } else { ASSUMED_NOISE };
                (sum + missing * assumed * assumed) / (count - used[channel] + missing)
            };
            variance.sqrt().max(if channel == 0 { floor.position } else { floor.orientation })
        };
        Noise { position: of(0), orientation: of(1) }
    }

    /// Huber's weights, for what lies outside 99 % of the noise.
    fn downweighted(&self, squares: &[[f64; 2]], given: &[f64], noise: Noise) -> Vec<f64> {
        let limit = quantile_of_chi_squared(self.degrees().iter().sum(), 0.99);
        let weight = |square: &[f64; 2]| (limit / chi_squared(*square, noise).max(limit)).sqrt();
        squares.iter().zip(given).map(|(square, given)| given * weight(square)).collect()
    }

    /// 0 for gross outliers.
    fn kept(&self, squares: &[[f64; 2]], given: &[f64], noise: Noise) -> Vec<f64> {
        let count = given.iter().filter(|weight| **weight > 0.0).count().max(1);
        let quantile = quantile_of_chi_squared(self.degrees().iter().sum(), 1.0 - FALSE_REJECTIONS / count as f64);
        let limit = GROSS * GROSS * quantile;
        let outside = |(square, given): (&[f64; 2], &f64)| *given > 0.0 && chi_squared(*square, noise) > limit;
        let rejected = squares.iter().zip(given).filter(|pair| outside(*pair)).count();
        if rejected as f64 > MOST_REJECTIONS * count as f64 {
            return given.to_vec();
        }
        squares.iter().zip(given).map(|pair| if outside(pair) { 0.0 } else { *pair.1 }).collect()
    }

    fn parameters_used<E: Effects>(&self, state: &State<E>, noise: Noise) -> [f64; 2] {
        let system = self.system(state, noise);
        let Some(inverse) = system.inverse() else { return [0.0; 2] };
        let n = self.layout.len();
        let mut used = [0.0; 2];
        for (k, (channel, sigma)) in state.sums.channels.iter().zip([noise.position, noise.orientation]).enumerate() {
            for i in 0..n {
                for j in 0..n {
                    let (low, high) = (i.min(j), i.max(j));
                    let scaled = channel.matrix[low * n + high] * system.scale[i] * system.scale[j] / (sigma * sigma);
                    used[k] += inverse[(i, j)] * scaled;
                }
            }
        }
        used
    }

    fn covariance<E: Effects>(&self, state: &State<E>, noise: Noise) -> DMatrix<f64> {
        let system = self.system(state, noise);
        let n = self.layout.len();
        let mut covariance = system.inverse().unwrap_or_else(|| DMatrix::zeros(n, n));
        if let Some(conditions) = &system.gauge {
            // The limit of ever heavier conditions: they hold exactly.
            let along = &covariance * conditions;
            if let Some(inverse) = (conditions.transpose() * &along).try_inverse() {
                covariance -= &along * inverse * along.transpose();
            }
        }
        for i in 0..n {
            for k in 0..n {
                covariance[(i, k)] *= system.scale[i] * system.scale[k];
            }
        }
        covariance
    }
}

impl System {
    fn damped(&self, damping: f64) -> DMatrix<f64> {
        let mut matrix = self.matrix.clone();
        if let Some(conditions) = &self.gauge {
            matrix.gemm(GAUGE_WEIGHT, conditions, &conditions.transpose(), 1.0);
        }
        for i in 0..matrix.nrows() {
            matrix[(i, i)] += damping;
        }
        matrix
    }

    /// The scaled step.
    fn solve(&self, damping: f64) -> Option<DVector<f64>> {
        let step = self.damped(damping).cholesky()?.solve(&self.gradient);
        step.iter().all(|x| x.is_finite()).then_some(step)
    }

    fn inverse(&self) -> Option<DMatrix<f64>> {
        Some(self.damped(LEAST_DAMPING).cholesky()?.inverse())
    }
}

/// Degrees of freedom that must be assumed beside `count` values of which the parameters use `used`.
pub(crate) fn missing_degrees(count: f64, used: f64) -> f64 {
    if count == 0.0 { 0.0 } else { (DEGREES_FOR_NOISE - (count - used)).max(0.0) }
}

/// Indices of squared residuals (m² and rad²) that are gross outliers beside the median of all.
pub(crate) fn outside(kind: MeasurementKind, squares: &[[f64; 2]]) -> Vec<usize> {
    let degrees = degrees_of(kind);
    let of = |channel: usize| {
        if degrees[channel] == 0.0 {
            return 0.0;
        }
        let mut values: Vec<f64> = squares.iter().map(|square| square[channel]).collect();
        (median(&mut values) / median_of_chi_squared(degrees[channel])).sqrt().max(f64::MIN_POSITIVE.sqrt())
    };
    let noise = Noise { position: of(0), orientation: of(1) };
    let count = squares.len().max(1) as f64;
    let limit = GROSS * GROSS * quantile_of_chi_squared(degrees.iter().sum(), 1.0 - FALSE_REJECTIONS / count);
    (0..squares.len()).filter(|&index| chi_squared(squares[index], noise) > limit).collect()
}

/// Degrees of freedom of an observation by channel.
fn degrees_of(kind: MeasurementKind) -> [f64; 2] {
    match kind {
        MeasurementKind::Pose => [3.0, 3.0],
        MeasurementKind::Position => [3.0, 0.0],
        MeasurementKind::Distance => [1.0, 0.0],
    }
}

/// Squared residual of an observation over the noise.
pub fn chi_squared(square: [f64; 2], noise: Noise) -> f64 {
    let orientation = if noise.orientation > 0.0 { square[1] / noise.orientation.powi(2) } else { 0.0 };
    square[0] / noise.position.powi(2) + orientation
}

fn median(values: &mut [f64]) -> f64 {
    if values.is_empty() {
        return 0.0;
    }
    let middle = values.len() / 2;
    *values.select_nth_unstable_by(middle, f64::total_cmp).1
}

fn quantile_of_chi_squared(degrees: f64, share: f64) -> f64 {
    ChiSquared::new(degrees).expect("an observation has at least one value").inverse_cdf(share)
}

fn median_of_chi_squared(degrees: f64) -> f64 {
    quantile_of_chi_squared(degrees, 0.5)
}
