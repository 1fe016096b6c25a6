//! Levenberg-Marquardt over the normal equations: prior, gauge, noise levels and gross outliers.

use crate::arm::Arm;
use crate::effects::{EffectModel, Statics};
use crate::gauge;
use crate::normal_equations::Sums;
use crate::parameters::{Effects, Known, Layout};
use crate::prior::SHARE_USED;
use crate::residual::ResidualModel;
use crate::symmetric;
use denavit_linear::products::gram_of;
use denavit_linear::triangle::Triangle;
use denavit_measurements::kinds::Part;
use denavit_measurements::{Measurements, Scene, Series};
use denavit_model::nalgebra::{DMatrix, DVector};
use statrs::distribution::{ChiSquared, ContinuousCDF};
use std::cell::Cell;
use std::sync::Arc;

/// Standard deviation of one measured component, by noise channel of the scene: m and rad.
#[derive(Debug, Clone, PartialEq)]
pub struct Noise {
    /// One per channel.
    pub levels: Vec<f64>,
}

impl Noise {
    /// Equal to a hundredth: the prior's weight no longer changes.
    fn near(&self, other: &Self) -> bool {
        self.levels.iter().zip(&other.levels).all(|(a, b)| (a - b).abs() <= 0.01 * b)
    }

    /// The level of the first channel, that of lengths, m.
    pub fn first(&self) -> f64 {
        self.levels.first().copied().unwrap_or(0.0)
    }

    /// Squared residual of an observation over the noise.
    ///
    /// # Shape and units
    /// `square`: of the lengths (m²) and of the angles (rad²).
    pub fn chi_squared(&self, series: &Series, square: [f64; 2]) -> f64 {
        let over = |part: usize| {
            let level = series.channels[part].map_or(0.0, |channel| self.levels[channel]);
            if level > 0.0 { square[part] / level.powi(2) } else { 0.0 }
        };
        over(0) + over(1)
    }
}

/// How a fit treats outliers, and when it stops.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FitOptions {
    /// Weigh down and then reject observations far outside the noise.
    pub robust: bool,
    /// Stop after this many steps.
    pub most_iterations: usize,
    /// Predicted decrease of χ² below which no further step is taken.
    pub least_promise: f64,
    /// Whether the data may widen the drawing's tolerances.
    pub widen: bool,
}

impl Default for FitOptions {
    fn default() -> Self {
        Self { robust: true, most_iterations: 60, least_promise: PROMISE_AT_END, widen: true }
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
    /// Noise of one component, corrected for the number of parameters.
    pub noise: Noise,
    /// 1 or, for rejected observations, 0.
    pub weights: Vec<f64>,
    /// Squared residual norms of all observations, lengths (m²) and angles (rad²).
    pub squares: Vec<[f64; 2]>,
    /// Covariance of the parameters, in their units, the common frame held (see [`gauge`]).
    pub covariance: DMatrix<f64>,
    /// Effective number of parameters: the trace of the hat matrix, by channel.
    pub parameters_used: Vec<f64>,
    /// Values measured and kept, by channel.
    pub values: Vec<f64>,
    /// Steps taken.
    pub iterations: usize,
    /// Number of normal equations formed: one per trial step, one per new placement of frames and targets, one per change of the
    /// weights.
    pub jacobians: usize,
    /// Whether the remaining decrease of the objective is negligible.
    pub converged: bool,
    /// The remaining decrease, where the fit did not converge.
    pub unfinished: Option<Unfinished>,
}

/// Why a fit did not converge.
#[derive(Debug, Clone, PartialEq)]
pub struct Unfinished {
    /// Decrease of χ² that the undamped step at the last state predicts; not finite where the normal equations are not.
    pub promise: f64,
    /// Names of the parameters that this step moves most, each in its tolerance (frames and targets: in m and rad); at most four, the
    /// one that moves most first.
    pub parameters: Vec<String>,
}

/// Always added to the diagonal, which is scaled to 1: fixes unobservable directions, without bias.
const LEAST_DAMPING: f64 = 1e-12;
/// Damping of the first step, in units of the prior's precision: far less than the prior itself.
const FIRST_DAMPING: f64 = 1e-3;
/// Damping after a step that fails is at least this.
const LEAST_AFTER_FAILURE: f64 = 1e-3;
/// Ratio of the damping after a failed step to that before; its inverse after a well predicted step.
const DAMPING_RATIO: f64 = 10.0;
/// Steps tried from one state: the damping of the last is 1e9 times the prior's precision.
const MOST_TRIALS: usize = 12;
/// Fraction of the predicted decrease above which the prediction is good: the damping falls.
const PREDICTED_WELL: f64 = 0.5;
/// Fraction of the predicted decrease below which the prediction is bad: the damping grows although the step is accepted.
const PREDICTED_BADLY: f64 = 0.1;
/// Fraction of the predicted decrease above which frames and targets need no new placement: the problem is nearly linear there.
const NEARLY_LINEAR: f64 = 0.9;
/// Root mean square motion of the measured values by a large coefficient of an effect, m or rad: a tolerance of geometry.
const LARGE_EFFECT: f64 = 1e-3;
/// Weight of the gauge's conditions relative to the scaled diagonal.
const GAUGE_WEIGHT: f64 = 10.0;
/// Noise of the first step as a fraction of the nominal robot's residual. Where prior and data disagree, two noise levels can be
/// self-consistent; starting from below finds that of the data.
const TRUST_AT_START: f64 = 0.03;
/// Smallest noise as a fraction of the robot's size: rounding.
const ROUNDING: f64 = 1e-14;
/// Predicted decrease of χ² below which the next step matters less than a change of the weights.
const PROMISE_NEAR_END: f64 = 1e3;
/// Predicted decrease of χ² at which outliers are finally rejected: a standard deviation, squared.
const PROMISE_FOR_REJECTION: f64 = 1.0;
/// Default predicted decrease of χ² at the end: a thirtieth of a standard deviation, squared.
const PROMISE_AT_END: f64 = 1e-3;
/// A fit has converged where the undamped step predicts a smaller decrease of χ²: no parameter moves by its standard deviation.
const PROMISE_OF_A_RESULT: f64 = 1.0;
/// Number of parameters that the report of an unconverged fit names.
const NAMED_WHEN_UNFINISHED: usize = 4;
/// Steps form a geometric sequence if the squared cosine between them exceeds `ALIKE` and their ratio is in `SHARE`.
const ALIKE: f64 = 0.9;
const SHARE: std::ops::Range<f64> = 0.1..0.9;
/// False positive rate of the test whether a robot's errors exceed its drawing's tolerances.
const FALSELY_WIDER: f64 = 0.05;
/// Largest ratio of the variance of the axes' errors to the tolerances': one robot in twenty has more. A fit starts with it, so that errors
/// far outside the tolerances are not explained as noise.
const WIDEST: f64 = 10.0;
/// Widths that differ by less than this fraction are the same.
const SAME_WIDTH: f64 = 0.02;
/// Degrees of freedom needed to estimate the noise.
pub const DEGREES_FOR_NOISE: f64 = 6.0;
/// Noise that is assumed where the data have too few degrees of freedom to estimate it: fraction of the robot's size (a tenth of a
/// millimetre on a metre, typical of instruments and repeatability together) and rad.
pub const ASSUMED_NOISE: f64 = 1e-4;
/// Probability that a clean file has a rejected row.
pub const FALSE_REJECTIONS: f64 = 0.01;
/// A gross outlier is this many times further out than that: errors of the model are not outliers.
pub const GROSS: f64 = 1.5;
/// If more than this fraction is outside, the observations are not outliers.
const MOST_REJECTIONS: f64 = 0.3;

impl<E> Fit<E> {
    /// The same fit, as that of a model with no effects but the earlier calibration's.
    pub fn with_model(&self, statics: &Statics, earlier: Option<&Arc<EffectModel>>) -> Fit<EffectModel> {
        Fit {
            arm: self.arm.clone(),
            effects: EffectModel::beside(statics, earlier),
            layout: self.layout.clone(),
            noise: self.noise.clone(),
            weights: self.weights.clone(),
            squares: self.squares.clone(),
            covariance: self.covariance.clone(),
            parameters_used: self.parameters_used.clone(),
            values: self.values.clone(),
            iterations: self.iterations,
            jacobians: self.jacobians,
            converged: self.converged,
            unfinished: self.unfinished.clone(),
        }
    }
}

/// Normal equations of numbers y, each parameter being its scale times its y.
struct System {
    matrix: DMatrix<f64>,
    gradient: DVector<f64>,
    scale: DVector<f64>,
    /// Precision of each y by which a step is damped: 1 for each axis parameter in its tolerance, 1 for frames and targets in m and rad.
    /// The diagonal of the normal equations would hardly damp weak, nonlinear directions.
    damped: DVector<f64>,
    gauge: Option<DMatrix<f64>>,
}

/// The last undamped step, each number in its unit.
type Last = Option<Vec<f64>>;

struct State<E> {
    effects: E,
    at: Evaluated,
}

/// What a state's arm and effects give; everything but their evaluation needs no more.
struct Evaluated {
    arm: Arm,
    sums: Sums,
    /// Conditions from other knowledge, and the cost of all priors.
    known: Vec<Known>,
    prior: f64,
}

/// Fit the free numbers of `layout` to the data, starting at `arm`.
///
/// Minimises Σ w |r|²/σ² + δᵀ P δ, σ estimated from the residuals by channel, δ the axes' deviation from the prior mean,
/// P the [prior](crate::prior)'s precision. The deviation of the targets, where the gauge needs it, is relative to
/// the given `arm`.
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
    let jacobians = Cell::new(0);
    let layout = layout.clone();
    Solver { data, layout, reference: arm.clone(), options: *options, jacobians }.run(arm, effects, weights)
}

struct Solver<'a> {
    data: &'a Measurements,
    layout: Layout,
    reference: Arm,
    options: FitOptions,
    jacobians: Cell<usize>,
}

/// A trial step.
struct Step<E> {
    /// The next state; `None` where no step lowers the objective.
    next: Option<State<E>>,
    /// Predicted decrease of χ².
    promise: f64,
    /// The same of the step without damping.
    undamped: f64,
}

impl Solver<'_> {
    fn run<E: Effects>(mut self, arm: &Arm, effects: &E, given: &[f64]) -> Fit<E> {
        let mut weights = given.to_vec();
        if self.may_be_wide() {
            self.layout.prior = self.layout.prior.clone().with_variance(WIDEST);
        }
        let mut state = self.evaluate(arm.clone(), effects.clone(), &weights);
        let mut used = self.unused();
        let mut robust = self.options.robust;
        let mut noise = self.noise_of(&state.at.sums.squares, &weights, &used, robust);
        // The nominal robot's residual is not noise: give the data more weight in the first step.
        noise.levels.iter_mut().for_each(|level| *level *= TRUST_AT_START);
        let (mut damping, mut iterations, mut rounds, mut exact) = (FIRST_DAMPING, 0, 0, false);
        let mut last = None;
        while iterations < self.options.most_iterations {
            iterations += 1;
            let system = self.system(&state.at, &noise);
            let Step { next, promise, undamped } =
                self.step(&state, &system, &noise, &weights, (&mut damping, &mut last));
            let stuck = next.is_none();
            if let Some(next) = next {
                state = next;
            }
            if robust {
                noise = self.noise_of(&state.at.sums.squares, &weights, &used, true);
                if stuck || promise < PROMISE_FOR_REJECTION || noise == self.rounding() || iterations > 12 {
                    robust = false;
                    damping = FIRST_DAMPING;
                    weights = self.kept(&state.at.sums.squares, given, &noise);
                    state = self.evaluate(state.at.arm, state.effects, &weights);
                    used = self.parameters_used(&state.at, &noise);
                    noise = self.noise_of(&state.at.sums.squares, &weights, &used, false);
                } else {
                    weights = self.downweighted(&state.at.sums.squares, given, &noise);
                    if promise < PROMISE_NEAR_END {
                        // New weights matter more than the next step: sums with the old weights would mislead it.
                        state = self.evaluate(state.at.arm, state.effects, &weights);
                    }
                }
                continue;
            }
            used = self.parameters_used(&state.at, &noise);
            let now = self.noise_of(&state.at.sums.squares, &weights, &used, false);
            let wide = self.as_wide(&state.at, &now);
            let same = wide.is_none_or(|wide| (wide / self.layout.prior.widened).ln().abs() < SAME_WIDTH);
            let steady = now.near(&noise) && same;
            noise = now;
            if let Some(wide) = wide.filter(|_| !same) {
                self.layout.prior = self.layout.prior.clone().with_variance(wide);
                state.at.prior = self.prior_cost(&state.at.arm, &state.at.known);
            }
            let rounding = noise == self.rounding();
            let least = self.options.least_promise;
            let ended = undamped < PROMISE_OF_A_RESULT && (stuck || promise < least);
            if (ended || stuck || rounding) && steady {
                let kept = if self.options.robust && rounds < 4 {
                    self.kept(&state.at.sums.squares, given, &noise)
                } else {
                    weights.clone()
                };
                if kept == weights {
                    exact = rounding;
                    break;
                }
                rounds += 1;
                weights = kept;
                state = self.evaluate(state.at.arm, state.effects, &weights);
            }
            if stuck || promise < least {
                // The damping made the step short.
                damping = FIRST_DAMPING;
            }
        }
        self.finish(state, weights, iterations, exact)
    }

    fn finish<E: Effects>(&self, state: State<E>, weights: Vec<f64>, iterations: usize, exact: bool) -> Fit<E> {
        let mut noise = self.noise_of(&state.at.sums.squares, &weights, &self.unused(), false);
        let mut used = self.unused();
        for _ in 0..4 {
            used = self.parameters_used(&state.at, &noise);
            noise = self.noise_of(&state.at.sums.squares, &weights, &used, false);
        }
        let unfinished = if exact { None } else { self.unfinished(&state.at, &noise) };
        let covariance = self.covariance(&state.at, &noise);
        Fit {
            values: state.at.sums.channels.iter().map(|channel| channel.count).collect(),
            arm: state.at.arm,
            effects: state.effects,
            layout: self.layout.clone(),
            noise,
            weights,
            squares: state.at.sums.squares,
            covariance,
            parameters_used: used,
            iterations,
            jacobians: self.jacobians.get(),
            converged: unfinished.is_none(),
            unfinished,
        }
    }

    /// The remaining decrease at a state; `None` where it is negligible.
    fn unfinished(&self, state: &Evaluated, noise: &Noise) -> Option<Unfinished> {
        let system = self.system(state, noise);
        let Some(full) = system.solve(0.0) else {
            return Some(Unfinished { promise: f64::NAN, parameters: Vec::new() });
        };
        let promise = system.decrease(&full);
        // NaN is not a result, either.
        if promise < PROMISE_OF_A_RESULT {
            return None;
        }
        // In tolerances: y² times the precision by which it is damped.
        let size = |&k: &usize| full[k] * full[k] * system.damped[k];
        let mut order: Vec<usize> = (0..full.len()).collect();
        order.sort_by(|a, b| size(b).total_cmp(&size(a)));
        let named = order.iter().take(NAMED_WHEN_UNFINISHED).filter(|k| size(k) > 0.01 * size(&order[0]));
        Some(Unfinished { promise, parameters: named.map(|&k| self.layout.parameters[k].name.clone()).collect() })
    }

    fn scene(&self) -> &Scene {
        &self.data.scene
    }

    fn unused(&self) -> Vec<f64> {
        vec![0.0; self.scene().channels.len()]
    }

    fn evaluate<E: Effects>(&self, arm: Arm, effects: E, weights: &[f64]) -> State<E> {
        self.jacobians.set(self.jacobians.get() + 1);
        let sums = ResidualModel { data: self.data, layout: &self.layout, effects: &effects }.sums(&arm, weights);
        let known = self.layout.known(self.scene(), &arm, &effects.numbers());
        let prior = self.prior_cost(&arm, &known);
        State { effects, at: Evaluated { arm, sums, known, prior } }
    }

    /// The cost of all priors.
    fn prior_cost(&self, arm: &Arm, known: &[Known]) -> f64 {
        self.layout.prior_cost(arm, &self.reference) + known.iter().map(|known| known.residual.powi(2)).sum::<f64>()
    }

    /// Ratio of the variance of the axes' errors to that of the drawing's tolerances: 1 where chance explains their size; none where there is
    /// another prior.
    ///
    /// With γ the number of parameters that the data determine and c² = δᵀ P δ, P by the drawing, the likelihood is largest where c² = κ² γ
    /// (MacKay 1992, "Bayesian interpolation", eq. 28); κ has the same prior as in averaging.
    fn as_wide(&self, state: &Evaluated, noise: &Noise) -> Option<f64> {
        if !self.may_be_wide() {
            return None;
        }
        let (joints, prior) = (self.layout.joints.len(), &self.layout.prior);
        let system = self.system(state, noise);
        let inverse = system.inverse();
        let of_prior =
            |i: usize, k: usize| inverse[(i, k)] * system.scale[i] * system.scale[k] * prior.precision[(i, k)];
        let undetermined: f64 = (0..joints).flat_map(|i| (0..joints).map(move |k| of_prior(i, k))).sum();
        let determined = joints as f64 - undetermined;
        let squares = prior.widened * self.layout.prior_cost(&state.arm, &self.reference);
        if determined < 1.0 || squares < quantile_of_chi_squared(determined, 1.0 - FALSELY_WIDER) {
            return Some(1.0);
        }
        Some((squares / (determined + 0.5 * prior.widened.ln() / SHARE_USED.powi(2))).clamp(1.0, WIDEST))
    }

    /// Whether the axes' errors may exceed the drawing's tolerances: only without other knowledge of them.
    fn may_be_wide(&self) -> bool {
        self.options.widen
            && !self.layout.joints.is_empty()
            && self.layout.effects.is_empty()
            && self.layout.prior.is_of_drawing()
    }

    fn objective(&self, state: &Evaluated, weights: &[f64], noise: &Noise) -> f64 {
        let sizes = self.sizes(&state.sums.squares, noise);
        sizes.zip(weights).map(|(size, weight)| weight * size).sum::<f64>() + state.prior
    }

    fn system(&self, state: &Evaluated, noise: &Noise) -> System {
        let n = self.layout.len();
        let perturbation = self.layout.perturbation(&state.arm, &self.reference);
        let mut matrix = DMatrix::<f64>::zeros(n, n);
        let mut gradient = DVector::<f64>::zeros(n);
        for (channel, sigma) in state.sums.channels.iter().zip(&noise.levels) {
            let weight = sigma.powi(-2);
            for i in 0..n {
                gradient[i] -= weight * channel.gradient[i];
                for k in i..n {
                    matrix[(i, k)] += weight * channel.matrix[i * n + k];
                }
            }
        }
        for known in &state.known {
            for (i, a) in &known.columns {
                gradient[*i] -= a * known.residual;
                for (k, b) in known.columns.iter().filter(|(k, _)| k >= i) {
                    matrix[(*i, *k)] += a * b;
                }
            }
        }
        matrix.fill_lower_triangle_with_upper_triangle();
        // The joints come first in the layout.
        let count = self.layout.joints.len();
        let pull = &self.layout.prior.precision * perturbation;
        let mut block = matrix.view_mut((0, 0), (count, count));
        block += &self.layout.prior.precision;
        let mut joints = gradient.rows_mut(0, count);
        joints -= pull;
        let scale = DVector::from_fn(n, |i, _| if matrix[(i, i)] > 0.0 { matrix[(i, i)].powf(-0.5) } else { 1.0 });
        for i in 0..n {
            for k in 0..n {
                matrix[(i, k)] *= scale[i] * scale[k];
            }
        }
        gradient.component_mul_assign(&scale);
        let damped = DVector::from_fn(n, |i, _| (scale[i] * self.precision(i, state)).powi(2));
        let gauge = self
            .layout
            .axes_are_free()
            .then(|| gauge::in_scaled(gauge::conditions(&self.layout, &self.reference), scale.as_slice()));
        System { matrix, gradient, scale, damped, gauge }
    }

    /// Inverse of a large change of a parameter: its tolerance; 1 m or 1 rad for frames and targets; for an effect's number the change that
    /// moves the measured values by [`LARGE_EFFECT`].
    fn precision(&self, index: usize, state: &Evaluated) -> f64 {
        if self.layout.effects.contains(&index) {
            let n = self.layout.len();
            let mut moved = (0.0, 0.0);
            for channel in &state.sums.channels {
                moved = (moved.0 + channel.matrix[index * n + index], moved.1 + channel.count);
            }
            return if moved.1 > 0.0 { (moved.0 / moved.1).sqrt() / LARGE_EFFECT } else { 1.0 };
        }
        self.layout.parameters[index].tolerance.map_or(1.0, f64::recip)
    }

    /// A step that lowers the objective.
    fn step<E: Effects>(
        &self,
        state: &State<E>,
        system: &System,
        noise: &Noise,
        weights: &[f64],
        (damping, last): (&mut f64, &mut Last),
    ) -> Step<E> {
        let before = self.objective(&state.at, weights, noise);
        let least = self.options.least_promise;
        let undamped = system.solve(0.0).map_or(f64::INFINITY, |full| system.decrease(&full));
        let mut promise = undamped;
        let mut lasting = last.take();
        if undamped < least {
            return Step { next: None, promise, undamped };
        }
        for _ in 0..MOST_TRIALS {
            let Some(scaled) = system.solve(*damping) else {
                *damping = (*damping * DAMPING_RATIO).max(LEAST_AFTER_FAILURE);
                continue;
            };
            promise = system.decrease(&scaled);
            let mut step: Vec<f64> = scaled.iter().zip(system.scale.iter()).map(|(y, s)| y * s).collect();
            let share = lasting.take().and_then(|last| share_of(&step, &last, &system.scale));
            if let Some(share) = share {
                for cell in &mut step {
                    *cell /= 1.0 - share;
                }
            }
            let arm = gauge::centred(&self.layout, &self.layout.stepped(&state.at.arm, &step), &self.reference);
            let effects = state.effects.stepped(&step[self.layout.effects.clone()]);
            let mut next = self.evaluate(arm, effects, weights);
            let mut after = self.objective(&next.at, weights, noise);
            // NaN counts as failed.
            let as_predicted = before - after >= NEARLY_LINEAR * promise;
            if !as_predicted && let Some(placed) = self.placed_again(&next, noise, weights) {
                let found = self.objective(&placed.at, weights, noise);
                if found < after || after.is_nan() {
                    (next, after) = (placed, found);
                }
            }
            if after <= before + 1e-9 * promise.min(1.0) {
                let gained = (before - after) / promise;
                if gained > PREDICTED_WELL {
                    *damping /= DAMPING_RATIO;
                } else if gained < PREDICTED_BADLY {
                    *damping *= DAMPING_RATIO.sqrt();
                }
                *last = Some(step).filter(|_| share.is_none());
                return Step { next: Some(next), promise, undamped };
            }
            if share.is_some() {
                continue;
            }
            if promise < least.max(1e-9 * before) {
                break;
            }
            *damping = (*damping * DAMPING_RATIO).max(LEAST_AFTER_FAILURE);
        }
        Step { next: None, promise, undamped }
    }

    /// The state with frames and targets at their best fit for its axes and effects, to first order; `None` where nothing else is free
    /// or there is no gain.
    fn placed_again<E: Effects>(&self, state: &State<E>, noise: &Noise, weights: &[f64]) -> Option<State<E>> {
        let n = self.layout.len();
        let first = self.layout.effects.end;
        if first == 0 || first == n {
            return None;
        }
        let system = self.system(&state.at, noise);
        let placing = n - first;
        let mut matrix = system.matrix.view((first, first), (placing, placing)).into_owned();
        (0..placing).for_each(|k| matrix[(k, k)] += LEAST_DAMPING);
        let scaled = matrix.cholesky()?.solve(&system.gradient.rows(first, placing));
        let mut step = vec![0.0; n];
        for (k, y) in scaled.iter().enumerate() {
            step[first + k] = y * system.scale[first + k];
        }
        if step.iter().any(|cell| !cell.is_finite()) {
            return None;
        }
        let arm = gauge::centred(&self.layout, &self.layout.stepped(&state.at.arm, &step), &self.reference);
        Some(self.evaluate(arm, state.effects.clone(), weights))
    }

    /// The smallest possible noise.
    fn rounding(&self) -> Noise {
        let least = |part: &Part| if part.unit == "m" { ROUNDING * self.reference.nominal.size() } else { ROUNDING };
        Noise { levels: self.scene().channels.iter().map(least).collect() }
    }

    /// χ² of every observation.
    fn sizes<'s>(&'s self, squares: &'s [[f64; 2]], noise: &'s Noise) -> impl Iterator<Item = f64> + 's {
        squares.iter().enumerate().map(|(at, square)| noise.chi_squared(self.data.series_of(at), *square))
    }

    /// Noise of one component by channel: from the median while outliers are still in, else from the sum of squares
    /// over the remaining degrees of freedom.
    fn noise_of(&self, squares: &[[f64; 2]], weights: &[f64], used: &[f64], robust: bool) -> Noise {
        let mut noise = self.rounding();
        for (channel, level) in noise.levels.iter_mut().enumerate() {
            let degrees = self.scene().channels[channel].height as f64;
            let of_channel = |at: usize| {
                let part = self.data.series_of(at).channels.iter().position(|own| *own == Some(channel))?;
                (weights[at] > 0.0).then_some((squares[at][part], weights[at]))
            };
            let kept = (0..squares.len()).filter_map(of_channel);
            let variance = if robust {
                let mut values: Vec<f64> = kept.map(|(square, _)| square).collect();
                median(&mut values) / median_of_chi_squared(degrees)
            } else {
                let (mut sum, mut count) = (0.0, 0.0);
                for (square, weight) in kept {
                    sum += weight * square;
                    count += weight * degrees;
                }
                // Where few degrees of freedom remain, an assumed noise replaces the missing ones.
                let missing = missing_degrees(count, used[channel]);
                let lengths = self.scene().channels[channel].unit == "m";
                let assumed = ASSUMED_NOISE * if lengths { self.reference.nominal.size() } else { 1.0 };
                (sum + missing * assumed * assumed) / (count - used[channel] + missing)
            };
            *level = variance.sqrt().max(*level);
        }
        noise
    }

    /// For each series, the χ² quantile of an observation at this probability.
    fn limits(&self, share: f64) -> Vec<f64> {
        let degrees = |series: &Series| quantile_of_chi_squared(series.kind.height() as f64, share);
        self.scene().series.iter().map(degrees).collect()
    }

    /// Huber's weights, for observations outside 99 % of the noise.
    fn downweighted(&self, squares: &[[f64; 2]], given: &[f64], noise: &Noise) -> Vec<f64> {
        let limits = self.limits(0.99);
        let weight = |at: usize, size: f64| {
            let limit = limits[self.data.observed.series(at)];
            (limit / size.max(limit)).sqrt()
        };
        let sizes = self.sizes(squares, noise).enumerate();
        sizes.zip(given).map(|((at, size), given)| given * weight(at, size)).collect()
    }

    /// 0 for gross outliers.
    fn kept(&self, squares: &[[f64; 2]], given: &[f64], noise: &Noise) -> Vec<f64> {
        gross(self.data, squares, given, noise)
    }

    fn parameters_used(&self, state: &Evaluated, noise: &Noise) -> Vec<f64> {
        let system = self.system(state, noise);
        let mut used = self.unused();
        let inverse = system.inverse();
        let n = self.layout.len();
        for (k, (channel, sigma)) in state.sums.channels.iter().zip(&noise.levels).enumerate() {
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

    fn covariance(&self, state: &Evaluated, noise: &Noise) -> DMatrix<f64> {
        let system = self.system(state, noise);
        let n = self.layout.len();
        let mut covariance = system.inverse();
        if let Some(conditions) = &system.gauge {
            // The limit of infinite weight of the conditions: they hold exactly.
            let along = &covariance * conditions;
            let inverse = symmetric::inverse(&(conditions.transpose() * &along), 0.0);
            covariance -= &along * inverse * along.transpose();
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
            matrix[(i, i)] += LEAST_DAMPING + damping * self.damped[i];
        }
        matrix
    }

    /// Decrease of χ² that the equations predict for a step.
    fn decrease(&self, scaled: &DVector<f64>) -> f64 {
        2.0 * scaled.dot(&self.gradient) - scaled.dot(&(&self.matrix * scaled))
    }

    /// The scaled step.
    fn solve(&self, damping: f64) -> Option<DVector<f64>> {
        let step = self.damped(damping).cholesky()?.solve(&self.gradient);
        step.iter().all(|x| x.is_finite()).then_some(step)
    }

    /// The covariance of the y. Directions without a positive precision, due to rounding, get the variance of the least damping: the
    /// data do not determine them. NaN where the equations contain NaN.
    fn inverse(&self) -> DMatrix<f64> {
        let matrix = self.damped(0.0);
        let size = matrix.nrows();
        match Triangle::factor(matrix.as_slice().to_vec(), size) {
            Some(factor) => DMatrix::from_vec(size, size, gram_of(&factor.inverse_columns(), size)),
            None => symmetric::inverse(&matrix, LEAST_DAMPING),
        }
    }
}

/// The ratio of a step to the last one, where steps form a geometric sequence: the derivatives lack the effects' influence on their own
/// loads, so steps are too short or too long. All steps to come add up to this step over 1 - ratio (Aitken).
fn share_of(step: &[f64], last: &[f64], scale: &DVector<f64>) -> Option<f64> {
    let product =
        |a: &[f64], b: &[f64]| a.iter().zip(b).zip(scale.iter()).map(|((a, b), s)| a * b / (s * s)).sum::<f64>();
    let (own, along, square) = (product(step, step), product(step, last), product(last, last));
    let share = along / square;
    (along * along > ALIKE * own * square && SHARE.contains(&share.abs())).then_some(share)
}

/// Degrees of freedom that must be assumed, with `count` values of which the parameters use `used`.
pub(crate) fn missing_degrees(count: f64, used: f64) -> f64 {
    if count == 0.0 { 0.0 } else { (DEGREES_FOR_NOISE - (count - used)).max(0.0) }
}

/// Indices of squared residuals (m² and rad²), each with the index of its series, that are gross outliers relative to the median
/// of their channel.
pub fn outside(scene: &Scene, squares: &[(usize, [f64; 2])]) -> Vec<usize> {
    let level = |(channel, part): (usize, &Part)| {
        let own = squares.iter().filter_map(|(series, square)| {
            let place = scene.series[*series].channels.iter().position(|own| *own == Some(channel))?;
            Some(square[place])
        });
        let mut values: Vec<f64> = own.collect();
        (median(&mut values) / median_of_chi_squared(part.height as f64)).sqrt()
    };
    let noise = Noise { levels: scene.channels.iter().enumerate().map(level).collect() };
    let share = 1.0 - FALSE_REJECTIONS / squares.len().max(1) as f64;
    let far = |&index: &usize| {
        let (series, square) = squares[index];
        let series = &scene.series[series];
        let limit = quantile_of_chi_squared(series.kind.height() as f64, share);
        noise.chi_squared(series, square) > GROSS * GROSS * limit
    };
    (0..squares.len()).filter(far).collect()
}

/// The given weights, 0 for gross outliers.
pub fn gross(data: &Measurements, squares: &[[f64; 2]], given: &[f64], noise: &Noise) -> Vec<f64> {
    let count = given.iter().filter(|weight| **weight > 0.0).count().max(1);
    let share = 1.0 - FALSE_REJECTIONS / count as f64;
    let degrees = |series: &Series| quantile_of_chi_squared(series.kind.height() as f64, share);
    let limits: Vec<f64> = data.scene.series.iter().map(degrees).collect();
    let outside: Vec<bool> = squares
        .iter()
        .enumerate()
        .map(|(at, square)| {
            let size = noise.chi_squared(data.series_of(at), *square);
            given[at] > 0.0 && size > GROSS * GROSS * limits[data.observed.series(at)]
        })
        .collect();
    let rejected = outside.iter().filter(|outside| **outside).count();
    if rejected as f64 > MOST_REJECTIONS * count as f64 {
        return given.to_vec();
    }
    outside.iter().zip(given).map(|(outside, given)| if *outside { 0.0 } else { *given }).collect()
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_is_a_share_of_the_last_where_both_lead_one_way() {
        let scale = DVector::from_vec(vec![1.0, 1e-3, 2.0]);
        let last = [0.4, 2e-4, -1.0];
        let times = |share: f64| last.map(|cell| cell * share).to_vec();
        for share in [0.5, -0.6, 0.15] {
            assert!((share_of(&times(share), &last, &scale).unwrap() - share).abs() < 1e-12);
        }
        // Too small to distinguish from 0, growing, or in another direction.
        assert_eq!(share_of(&times(0.02), &last, &scale), None);
        assert_eq!(share_of(&times(1.2), &last, &scale), None);
        assert_eq!(share_of(&[0.4, 2e-4, 1.0], &last, &scale), None);
    }
}
