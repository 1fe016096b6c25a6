//! Joint error curves, fitted together with geometry, frames and known effects: linearise, maximise the marginal likelihood, step,
//! repeat.

mod channel_misfit;

use crate::blocks::Block;
use crate::infer::contest::{Contest, Member, Unnamed};
use crate::infer::deflection::{self, Expected};
use crate::infer::evidence::{Model, Posterior, Slope};
use crate::infer::gaps;
use crate::infer::gram::{Columns, Gram};
use crate::infer::maximum::{self, NEGLIGIBLE};
use crate::infer::model::{Hyperparameters, Kernel};
use crate::infer::replicates;
use crate::linear::{Linear, linearise};
use crate::scorer::CandidateScorer;
use denavit_identify::arm::Arm;
use denavit_identify::effects::candidates::Candidate;
use denavit_identify::effects::carrier::Carrier;
use denavit_identify::effects::curve::{Curve, Waves};
use denavit_identify::effects::curve_modes::CurveModes;
use denavit_identify::effects::model::EffectModel;
use denavit_identify::effects::survey::Survey;
use denavit_identify::gauge;
use denavit_identify::residual::ResidualModel;
use denavit_identify::residual_statistics;
use denavit_identify::solve::{Fit, Noise, gross};
use denavit_linear::threads::{each_alone, in_parallel, with_threads};
use denavit_linear::triangle::dot;
use denavit_measurements::Measurements;
use denavit_model::nalgebra::DMatrix;
use std::ops::Range;

/// The fastest wave of a curve has this many periods per turn; a slide: as many over its range. Time grows with its cube.
const HIGHEST_ORDER: f64 = 60.0;
/// Smallest number of measured values per parameter. With fewer, a wave only repeats the prior, and the cost grows with the cube.
const VALUES_PER_NUMBER: usize = 6;
/// A curve has at least this many waves, twenty periods over its range: its band does not cover faster errors, and a faster periodic
/// error would be named without a curve as its rival. Curves of six joints then cost less than those of four hundred positions.
const FEWEST_WAVES: usize = 48;
/// Largest number of linearisations: one may only leave out curves; after that the second changes little, and the third hardly
/// anything unless an effect makes the model nonlinear.
const ROUNDS: usize = 10;
/// A round that gains less than this changes no probability by a tenth.
const CONVERGED: f64 = 0.1;
/// A round also ends the iteration if it gains less than this times the root of the number of values: the noise then changes by a
/// quarter of its standard deviation, and borderline outliers come and go. The step of that round is still taken.
const CONVERGED_NOISE: f64 = 0.25;
/// Number of stretches of the run in each part, if there are parts: enough that each part has rows of everything that was moved in
/// turn, and each long compared with the correlation time of the errors.
const STRETCHES: usize = 4;
/// A step is not cut shorter than this share of it.
const LEAST_SHARE: f64 = 0.1;
/// The mean of a curve is constrained to a thousandth of what is detectable in the noise.
const FIRM: f64 = 1e6;
/// Accepted share of clean files that show a curve: one in a hundred.
const FALSE_CURVES: f64 = 0.01;

/// Options of the search for curves.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CurveOptions {
    /// Share of clean files in which a curve may be shown.
    pub false_curves: f64,
}

impl Default for CurveOptions {
    fn default() -> Self {
        Self { false_curves: FALSE_CURVES }
    }
}

/// Geometry, effects and curves, fitted together.
#[derive(Debug, Clone)]
pub struct CurveFit {
    /// The model; its effects hold the curves.
    pub fit: Fit<EffectModel>,
    /// Logarithm of the marginal likelihood.
    pub score: f64,
    /// For each curve, its increase of that.
    pub gains: Vec<f64>,
    /// The same for deflections of joints under gravity: the last effects of the model.
    pub deflections: Vec<f64>,
    /// Uncertainty of the curves.
    pub modes: CurveModes,
}

/// Adds to `fit` a curve for each moving joint and the deflections of joints under gravity (`deflection`); those that the data do not
/// support are left out.
///
/// # Shape and units
/// `reference`: the arm that the geometric fit started from, see [`denavit_identify::solve::fit`].
pub fn fit_curves(
    survey: &Survey,
    data: &Measurements,
    fit: &Fit<EffectModel>,
    reference: &Arm,
    options: &CurveOptions,
) -> CurveFit {
    with_threads(|| fit_curves_near(survey, data, fit, reference, *options, &[]))
}

/// As [`fit_curves`], if curves of a similar model are known: the search also starts from them.
pub(crate) fn fit_curves_near(
    survey: &Survey,
    data: &Measurements,
    fit: &Fit<EffectModel>,
    reference: &Arm,
    options: CurveOptions,
    near: &[Curve],
) -> CurveFit {
    let (with, begun) = with_deflections(survey, data, fit, reference, options, near);
    let state = State { causes: fit.effects.effects.len(), ..State::new(survey, data, &with) };
    let found = until_converged(data, state, reference, options, begun.as_ref(), near);
    let fitted = found.is_ok();
    let found = found.ok().flatten().filter(|found| !found.state.joints.is_empty());
    let found = found.and_then(|found| found.finish(data, reference, fit.effects.effects.len()));
    // Without a curve the fit is as it was given.
    found.unwrap_or_else(|| CurveFit {
        fit: Fit { converged: fit.converged && fitted, ..fit.clone() },
        score: f64::NEG_INFINITY,
        gains: Vec::new(),
        deflections: Vec::new(),
        modes: CurveModes::none(fit.layout.len()),
    })
}

/// A state with its hyperparameters, and the posterior of its parameters at the last step.
struct Converged {
    state: State,
    hyper: Hyperparameters,
    posterior: Option<Posterior>,
}

/// No part of the first step stays in the linear range.
struct NoStep;

/// Iterates from a state until the score converges: `None` if no curve is supported, or the system cannot be solved.
fn until_converged(
    data: &Measurements,
    mut state: State,
    reference: &Arm,
    options: CurveOptions,
    begun: Option<&Hyperparameters>,
    near: &[Curve],
) -> Result<Option<Converged>, NoStep> {
    let mut found: Option<(f64, Hyperparameters)> = None;
    let mut posterior = None;
    for _ in 0..ROUNDS {
        let round = Round::new(data, &state, reference);
        let model = round.model();
        let reached = match found.as_ref().map(|(_, last)| last).or(begun) {
            None => maximum::from_afar(&model, round.known(&state, near).as_ref(), NEGLIGIBLE),
            Some(last) => maximum::from_near(&model, last, NEGLIGIBLE),
        };
        let Some((here, hyper)) = reached else { break };
        let (hyper, kept) = asked_for(&model, &here, &hyper, options);
        if kept.contains(&false) {
            state.keep(&kept);
            if state.joints.is_empty() {
                break;
            }
            found = Some((f64::NEG_INFINITY, hyper));
            posterior = None;
            continue;
        }
        // Each round is in units of its own noise: this is the score of the values in m and rad.
        let score = here.score + round.units();
        let said = here.posterior();
        let enough = CONVERGED.max(CONVERGED_NOISE * (round.linear.values() as f64).sqrt());
        if !round.step(data, &mut state, (&hyper, &said), enough) {
            // Parameters that the rows hardly distinguish leave the linear range here: the state before is the last valid one.
            if posterior.is_none() {
                return Err(NoStep);
            }
            state.fit.converged = false;
            break;
        }
        posterior = Some(said);
        let converged = found.as_ref().is_some_and(|(last, _)| (score - last).abs() < enough);
        found = Some((score, hyper));
        state.fit.converged = converged;
        if converged {
            break;
        }
    }
    Ok(found.map(|(_, hyper)| Converged { state, hyper, posterior }))
}

/// The fit with the deflections that the data support next to curves, all 0 at first, and the hyperparameters with them.
fn with_deflections(
    survey: &Survey,
    data: &Measurements,
    fit: &Fit<EffectModel>,
    reference: &Arm,
    options: CurveOptions,
    near: &[Curve],
) -> (Fit<EffectModel>, Option<Hyperparameters>) {
    let Some(all) = deflection::all(survey, fit) else { return (fit.clone(), None) };
    let first = fit.effects.effects.len();
    let state = State { causes: first, ..State::new(survey, data, &all) };
    let round = Round::new(data, &state, reference);
    let blocks = deflection::columns(round.always, &all.effects, first);
    let least = (blocks.len() as f64 / options.false_curves).ln();
    let known = round.known(&state, near);
    let (kept, hyper) = deflection::asked_for(&round.model(), &blocks, least, known.as_ref());
    let terms = all.effects.effects[first..].iter().zip(kept).filter(|(_, kept)| *kept);
    (deflection::with_terms(fit, terms.map(|(effect, _)| effect.term.clone())), hyper)
}

/// The model at one point of the iteration.
pub(super) struct State {
    pub(super) fit: Fit<EffectModel>,
    /// How many of its effects are causes; deflections under gravity come after them.
    causes: usize,
    /// Joints that have a curve.
    pub(super) joints: Vec<usize>,
    pub(super) waves: Vec<Waves>,
    ranges: Vec<(f64, f64)>,
    /// What each curve is a function of, row by row.
    pub(super) readings: Vec<Vec<f64>>,
    pub(super) groups: Vec<Vec<usize>>,
}

impl State {
    pub(super) fn new(survey: &Survey, data: &Measurements, fit: &Fit<EffectModel>) -> Self {
        let joints: Vec<usize> = survey.moving().collect();
        let values: f64 = fit.values.iter().sum();
        // Counts of values are far below 2^53.
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
        let most = (values as usize / VALUES_PER_NUMBER).saturating_sub(fit.layout.len()) / joints.len().max(1);
        let chain = &survey.statics.chain;
        let waves = |&joint: &usize| {
            let (low, high) = survey.ranges[joint];
            let slides = survey.slides(joint);
            let highest = if slides { HIGHEST_ORDER * std::f64::consts::TAU / (high - low) } else { HIGHEST_ORDER };
            let continuous = chain.coordinates()[chain.joints()[joint].coordinate].continuous;
            Waves::over(low, high, continuous, highest, most.max(FEWEST_WAVES))
        };
        let reading = |&joint: &usize| -> Vec<f64> {
            (0..data.len()).map(|row| chain.joints()[joint].value(data.reading(row))).collect()
        };
        Self {
            waves: joints.iter().map(waves).collect(),
            ranges: joints.iter().map(|&joint| survey.ranges[joint]).collect(),
            readings: joints.iter().map(reading).collect(),
            groups: replicates::groups(data),
            causes: fit.effects.effects.len(),
            fit: fit.clone(),
            joints,
        }
    }

    pub(super) fn keep(&mut self, kept: &[bool]) {
        fn of<T: Clone>(list: &[T], kept: &[bool]) -> Vec<T> {
            list.iter().zip(kept).filter(|(_, kept)| **kept).map(|(item, _)| item.clone()).collect()
        }
        self.waves = of(&self.waves, kept);
        self.ranges = of(&self.ranges, kept);
        self.readings = of(&self.readings, kept);
        self.joints = of(&self.joints, kept);
        let joints = &self.joints;
        self.fit.effects.curves.retain(|curve| joints.contains(&curve.joint));
    }
}

impl Converged {
    /// The fit with the covariance and noise of the whole model. From index `first` on, its effects are deflections under gravity.
    fn finish(self, data: &Measurements, reference: &Arm, first: usize) -> Option<CurveFit> {
        let Self { mut state, hyper, posterior: last } = self;
        let round = Round::new(data, &state, reference);
        let model = round.model();
        let here = model.slope(&hyper, f64::NEG_INFINITY)?;
        let (score, posterior) = (here.score, here.posterior());
        round.spread_into(&mut state, last.as_ref().unwrap_or(&posterior), &hyper);
        let order = round.layout_order(&state);
        let count = order.len();
        state.fit.covariance = DMatrix::from_fn(count, count, |i, k| posterior.covariance(order[i], order[k]));
        let less = |columns: &[usize], curves: &[usize]| here.score_without(&model, columns, curves);
        let gain = |columns: &[usize], curves: &[usize]| score - less(columns, curves).unwrap_or(f64::NEG_INFINITY);
        let curves: Vec<usize> = (0..state.waves.len()).collect();
        let gains = each_alone(&curves, |&curve| gain(&[], &[curve]));
        let fields = deflection::columns(round.always, &state.fit.effects, first);
        let deflections = each_alone(&fields, |block| gain(&block.clone().collect::<Vec<_>>(), &[]));
        let mut first = round.gram.plain;
        let mut places = Vec::new();
        for waves in &state.waves {
            places.push(first..first + waves.len());
            first += waves.len();
        }
        let modes = CurveModes::of(|i, k| posterior.covariance(i, k), &places, &order);
        Some(CurveFit { fit: state.fit, score, gains, deflections, modes })
    }
}

/// Which curves raise the score by more than chance does at the accepted false alarm rate. By chance, the best variance and length gain
/// more than g with a probability of e^-g (half a χ² of two degrees of freedom, and half nothing at all).
fn asked_for(
    model: &Model<'_>,
    here: &Slope,
    hyper: &Hyperparameters,
    options: CurveOptions,
) -> (Hyperparameters, Vec<bool>) {
    let least = (model.waves.len() as f64 / options.false_curves).ln();
    let mut kept = vec![true; hyper.kernels.len()];
    let (mut score, mut gone) = (here.score, Vec::new());
    loop {
        let without = |&curve: &usize| {
            let all: Vec<usize> = gone.iter().copied().chain([curve]).collect();
            (here.score_without(model, &[], &all).unwrap_or(f64::NEG_INFINITY), curve)
        };
        let left: Vec<usize> = (0..kept.len()).filter(|&curve| kept[curve]).collect();
        let weakest = each_alone(&left, without).into_iter().max_by(|a, b| a.0.total_cmp(&b.0));
        let Some((left, curve)) = weakest.filter(|(left, _)| score - left < least) else { break };
        kept[curve] = false;
        gone.push(curve);
        score = left;
    }
    let kernels = hyper.kernels.iter().zip(&kept).filter(|(_, kept)| **kept).map(|(kernel, _)| *kernel).collect();
    (Hyperparameters { log_noise: hyper.log_noise, kernels }, kept)
}

/// A linearisation with the columns of the model in its rows.
pub(super) struct Laid {
    pub(super) linear: Linear,
    /// Geometry and frames, then effects: those of the fit, or candidates and other columns.
    pub(super) plain: Vec<Vec<f64>>,
    /// Of the curves' joints.
    pub(super) joints: Vec<Vec<f64>>,
    /// How many are of geometry and frames.
    always: usize,
    /// Columns of each candidate, then of each other block.
    candidates: Vec<Range<usize>>,
}

impl Laid {
    /// Columns by value; without candidates the effects of the fit are among them.
    pub(super) fn of(
        data: &Measurements,
        fit: &Fit<EffectModel>,
        joints: &[usize],
        reference: &Arm,
        candidates: Option<&[Candidate]>,
        others: &[Block],
    ) -> Self {
        let mut carriers: Vec<Carrier> = joints.iter().map(|&joint| Carrier::Joint(joint)).collect();
        let wanted = candidates.unwrap_or_default().iter().map(|candidate| candidate.term.carrier);
        for carrier in wanted.chain(others.iter().map(|block| block.carrier)) {
            if !carriers.contains(&carrier) {
                carriers.push(carrier);
            }
        }
        let linear = linearise(data, fit, reference, &carriers);
        let values = linear.values();
        let column = |matrix: &'_ DMatrix<f64>, index: usize| -> Vec<f64> {
            matrix.column(index).rows(0, values).iter().map(|cell| -cell).collect()
        };
        let always = linear.geometry.ncols();
        let mut plain: Vec<Vec<f64>> = (0..always).map(|k| column(&linear.geometry, k)).collect();
        let joints: Vec<Vec<f64>> = (0..joints.len()).map(|k| column(&linear.carriers, k)).collect();
        if candidates.is_none() {
            plain.extend((0..linear.effects.ncols()).map(|k| column(&linear.effects, k)));
        }
        let scorer = CandidateScorer { data, statics: &fit.effects.statics, linear: &linear };
        let mut ranges = Vec::new();
        let columns = candidates.unwrap_or_default().iter().map(|candidate| scorer.columns(&candidate.term));
        for columns in columns.chain(others.iter().map(|block| block.columns(&scorer))) {
            ranges.push(plain.len()..plain.len() + columns.ncols());
            plain.extend((0..columns.ncols()).map(|k| column(&columns, k)));
        }
        Self { linear, plain, joints, always, candidates: ranges }
    }
}

/// One linearisation with its products.
pub(super) struct Round {
    pub(super) linear: Linear,
    /// The residual, the plain columns and those of the curves' joints.
    pub(super) explained: Vec<f64>,
    pub(super) plain: Vec<Vec<f64>>,
    pub(super) joints: Vec<Vec<f64>>,
    /// Logarithms of the values' noise levels, the units of everything here, summed.
    log_units: f64,
    /// Of all values.
    pub(super) gram: Gram,
    /// The same by part of the run.
    pub(super) parts: Vec<Gram>,
    pub(super) waves: Vec<Waves>,
    /// Columns of geometry and frames.
    pub(super) always: usize,
    /// Columns of each candidate.
    pub(super) candidates: Vec<Range<usize>>,
    pub(super) precision: DMatrix<f64>,
    pub(super) pull: Vec<f64>,
    pub(super) charge: f64,
    log_precision: f64,
    pub(super) means: Vec<Vec<f64>>,
    pub(super) firm: Vec<f64>,
    /// For each curve the variance, rad² or m², at which it is as large as the noise.
    visible: Vec<f64>,
    /// For each curve its prior in gaps between rows.
    gaps: Vec<Vec<f64>>,
}

impl Round {
    /// The model at a state, its effects and curves as free as geometry is.
    pub(super) fn new(data: &Measurements, state: &State, reference: &Arm) -> Self {
        Self::beside(data, state, reference, None, &[], 1)
    }

    /// The same with candidates and other columns instead of the state's effects, and products by part of the run: stretches
    /// of rows are assigned to the parts in turn.
    ///
    /// # Shape and units
    /// `others`: in units of the noise, as [`linearise`] has them at this state.
    pub(super) fn beside(
        data: &Measurements,
        state: &State,
        reference: &Arm,
        candidates: Option<&[Candidate]>,
        others: &[Block],
        parts: usize,
    ) -> Self {
        let mut fit = state.fit.clone();
        if !state.groups.is_empty() || data.scene.series.len() > 1 {
            let residuals = residual_statistics::residuals(&fit.arm, &fit.effects, data);
            for (weight, shared) in fit.weights.iter_mut().zip(replicates::weights(data, &state.groups, &residuals)) {
                *weight *= shared;
            }
        }
        let Laid { linear, plain, joints, always, candidates: ranges } =
            Laid::of(data, &fit, &state.joints, reference, candidates, others);
        let values = linear.values();
        // Effects and curves enter with their values, not with their changes.
        let mut explained: Vec<f64> = linear.residual.rows(0, values).iter().copied().collect();
        let coefficients = fit.effects.effects.iter().flat_map(|effect| effect.coefficients.iter().copied());
        for (index, coefficient) in coefficients.enumerate() {
            for (y, x) in explained.iter_mut().zip(linear.effects.column(index).iter()) {
                *y -= x * coefficient;
            }
        }
        for curve in &fit.effects.curves {
            let Some(index) = state.joints.iter().position(|&joint| joint == curve.joint) else { continue };
            let at: Vec<f64> = state.readings[index].iter().map(|&reading| curve.value(reading)).collect();
            for ((y, x), row) in explained.iter_mut().zip(&joints[index]).zip(&linear.rows) {
                *y += x * at[*row];
            }
        }
        let expected = if candidates.is_none() { deflection::expected(&fit.effects, state.causes) } else { Vec::new() };
        let (precision, pull, charge, log_precision) = prior(&linear, &fit, reference, &plain, &expected);
        let visible: Vec<f64> = joints
            .iter()
            .map(|column| values as f64 / column.iter().map(|x| x * x).sum::<f64>().max(f64::MIN_POSITIVE))
            .collect();
        let means = state.waves.iter().zip(&state.readings).map(|(waves, readings)| mean_of(waves, readings)).collect();
        let firm = visible.iter().map(|visible| FIRM / visible).collect();
        let gap = |(joint, readings): (&usize, &Vec<f64>)| {
            let before = fit.effects.curves.iter().find(|curve| curve.joint == *joint);
            before.map_or_else(Vec::new, |curve| gaps::precision(curve, readings))
        };
        let gaps = state.joints.iter().zip(&state.readings).map(gap).collect();
        let columns = Columns {
            explained: &explained,
            plain: &borrowed(&plain),
            joints: &borrowed(&joints),
            rows: &linear.rows,
            weights: &linear.weights,
        };
        // Repeats of a posture belong to the part of its first row.
        let stands = if parts > 1 { data.first_of_posture() } else { Vec::new() };
        let stretches = in_stretches(data.len(), parts);
        let part_of = |row: usize| stretches(stands[row]);
        let parts = by_part(&columns, &state.waves, &state.readings, parts, &part_of);
        let gram = Gram::weighted(&parts, &vec![1.0; parts.len()]);
        let waves = state.waves.clone();
        let log_units = log_units(&linear, &fit.noise);
        Self {
            linear,
            explained,
            plain,
            joints,
            log_units,
            gram,
            parts,
            waves,
            always,
            candidates: ranges,
            precision,
            pull,
            charge,
            log_precision,
            means,
            firm,
            visible,
            gaps,
        }
    }

    /// Difference between the score in units of the noise and that of the values in m and rad.
    fn units(&self) -> f64 {
        -self.log_units
    }

    pub(super) fn model(&self) -> Model<'_> {
        Model {
            gram: &self.gram,
            precision: &self.precision,
            pull: &self.pull,
            charge: self.charge,
            log_precision: self.log_precision,
            waves: &self.waves,
            means: &self.means,
            firm: &self.firm,
            visible: &self.visible,
            gaps: &self.gaps,
        }
    }

    /// The comparison of sets of these members, with curves of these kernels and with structure.
    pub(super) fn contest<'a>(
        &'a self,
        kernels: &'a [Vec<Kernel>],
        unnamed: &'a [Unnamed],
        members: &'a [Member],
    ) -> Contest<'a> {
        Contest {
            always: self.always,
            precision: &self.precision,
            pull: &self.pull,
            charge: self.charge,
            waves: &self.waves,
            means: &self.means,
            firm: &self.firm,
            kernels,
            unnamed,
            members,
        }
    }

    /// For each number of the layout its place among the plain columns: geometry without effects, then effects.
    fn layout_order(&self, state: &State) -> Vec<usize> {
        let effects = state.fit.layout.effects.clone();
        let geometry = self.linear.geometry.ncols();
        (0..state.fit.layout.len())
            .map(|index| {
                if effects.contains(&index) {
                    geometry + index - effects.start
                } else if index < effects.start {
                    index
                } else {
                    index - effects.len()
                }
            })
            .collect()
    }

    /// Writes the uncertainty of each curve over its range.
    fn spread_into(&self, state: &mut State, posterior: &Posterior, hyper: &Hyperparameters) {
        let mut first = self.gram.plain;
        for ((curve, kernel), range) in state.fit.effects.curves.iter_mut().zip(&hyper.kernels).zip(&state.ranges) {
            let prior: Vec<f64> = kernel.variances(&curve.waves).into_iter().map(|(variance, _)| variance).collect();
            curve.spread = spread(posterior, first, &curve.waves, &prior, kernel.log_variance.exp(), *range);
            first += curve.waves.len();
        }
    }

    /// The curves at the posterior mean, without their uncertainty as yet.
    fn curves(&self, state: &State, posterior: &Posterior, hyper: &Hyperparameters) -> Vec<Curve> {
        let mut first = self.gram.plain;
        let mut curves = Vec::new();
        for (index, (waves, kernel)) in state.waves.iter().zip(&hyper.kernels).enumerate() {
            let weights = posterior.mean[first..first + waves.len()].to_vec();
            curves.push(Curve {
                joint: state.joints[index],
                range: state.ranges[index],
                size: (0.5 * kernel.log_variance).exp(),
                length: kernel.log_length.exp(),
                spread: Vec::new(),
                waves: waves.clone(),
                weights,
            });
            first += waves.len();
        }
        curves
    }

    /// The hyperparameters of known curves, if any; joints without a known curve get a zero curve.
    fn known(&self, state: &State, near: &[Curve]) -> Option<Hyperparameters> {
        let kernel = |(index, joint): (usize, &usize)| {
            let own = near.iter().find(|curve| curve.joint == *joint);
            let nothing = Kernel { log_variance: f64::MIN, log_length: -self.waves[index].frequency(0).ln() };
            own.map_or(nothing, Kernel::of)
        };
        let kernels = state.joints.iter().enumerate().map(kernel).collect();
        (!near.is_empty()).then_some(Hyperparameters { log_noise: 0.0, kernels })
    }

    /// The columns' coefficients at the present state: 0 for geometry and frames, the present values of effects and curves.
    fn numbers(&self, state: &State) -> Vec<f64> {
        let mut numbers = vec![0.0; self.always];
        numbers.extend(state.fit.effects.effects.iter().flat_map(|effect| &effect.coefficients));
        for (joint, waves) in state.joints.iter().zip(&self.waves) {
            let had = state.fit.effects.curves.iter().find(|curve| curve.joint == *joint);
            let same = had.map(|curve| &curve.weights).filter(|weights| weights.len() == waves.len());
            numbers.extend(same.map_or_else(|| vec![0.0; waves.len()], Vec::clone));
        }
        numbers
    }

    /// Moves the state to the posterior's mean, with its noise and its outliers, or a fraction of that step. Returns false, and keeps the
    /// state, if every fraction increases the cost by more than `enough`.
    fn step(
        &self,
        data: &Measurements,
        state: &mut State,
        (hyper, posterior): (&Hyperparameters, &Posterior),
        enough: f64,
    ) -> bool {
        let model = self.model();
        let curves = self.curves(state, posterior, hyper);
        let order = self.layout_order(state);
        let had = self.numbers(state);
        let fit = &mut state.fit;
        // The prior counts next to the misfit: the prior in gaps is new for a curve that did not exist before.
        let cost = |squares: &[[f64; 2]], numbers: &[f64]| {
            let kept = squares.iter().zip(&fit.weights).enumerate().filter(|(_, (_, weight))| **weight > 0.0);
            let chi: f64 =
                kept.map(|(at, (square, weight))| weight * fit.noise.chi_squared(data.series_of(at), *square)).sum();
            chi * (-hyper.log_noise).exp() + model.cost(hyper, numbers)
        };
        let before = cost(&ResidualModel { data, layout: &fit.layout, effects: &fit.effects }.squares(&fit.arm), &had);
        // The model may not be linear over a long step: the step is halved then.
        let mut share = 1.0;
        let (arm, effects, squares) = loop {
            if share < LEAST_SHARE {
                return false;
            }
            let numbers: Vec<f64> =
                had.iter().zip(&posterior.mean).map(|(old, new)| old + (new - old) * share).collect();
            let part: Vec<f64> = order.iter().map(|&index| numbers[index]).collect();
            let arm = gauge::centred(&fit.layout, &fit.layout.stepped(&fit.arm, &part), &fit.arm);
            let mut effects = fit.effects.clone();
            let mut values = part[fit.layout.effects.clone()].iter();
            for effect in &mut effects.effects {
                for (coefficient, value) in effect.coefficients.iter_mut().zip(&mut values) {
                    *coefficient = *value;
                }
            }
            effects.curves.clone_from(&curves);
            let mut weights = numbers[self.gram.plain..].iter();
            for curve in &mut effects.curves {
                for (weight, value) in curve.weights.iter_mut().zip(&mut weights) {
                    *weight = *value;
                }
            }
            let squares = ResidualModel { data, layout: &fit.layout, effects: &effects }.squares(&arm);
            if cost(&squares, &numbers) <= before + enough {
                break (arm, effects, squares);
            }
            share *= 0.5;
        };
        (fit.arm, fit.effects) = (arm, effects);
        // Noise of each channel: remaining squares over remaining degrees of freedom.
        let channel_misfits = self.channel_misfits(data, state, (posterior, &curves), (-hyper.log_noise).exp());
        let fit = &mut state.fit;
        let mut levels = fit.noise.levels.clone();
        for (level, channel) in levels.iter_mut().zip(&channel_misfits) {
            let free = (channel.count - channel.used).max(1.0);
            *level *= (channel.misfit / free).max(f64::MIN_POSITIVE).sqrt();
        }
        fit.noise = Noise { levels };
        fit.parameters_used = channel_misfits.iter().map(|channel| channel.used).collect();
        fit.values = channel_misfits.iter().map(|channel| channel.count).collect();
        fit.weights = gross(data, &squares, &vec![1.0; data.observations()], &fit.noise);
        fit.squares = squares;
        true
    }
}

pub(super) fn borrowed(columns: &[Vec<f64>]) -> Vec<&[f64]> {
    columns.iter().map(Vec::as_slice).collect()
}

/// Products by part of the run.
pub(super) fn by_part(
    columns: &Columns<'_>,
    waves: &[Waves],
    readings: &[Vec<f64>],
    parts: usize,
    part_of: &(dyn Fn(usize) -> usize + Sync),
) -> Vec<Gram> {
    fn pick<T: Copy>(list: &[T], own: &[usize]) -> Vec<T> {
        own.iter().map(|&value| list[value]).collect()
    }
    if parts == 1 {
        return vec![Gram::of(columns, waves, readings)];
    }
    let of_part = |&part: &usize| {
        let own: Vec<usize> = (0..columns.rows.len()).filter(|value| part_of(columns.rows[*value]) == part).collect();
        let all = columns.plain.iter().chain(columns.joints);
        let picked: Vec<Vec<f64>> = all.map(|column| pick(column, &own)).collect();
        let picked = borrowed(&picked);
        let (plain, joints) = picked.split_at(columns.plain.len());
        let columns = Columns {
            explained: &pick(columns.explained, &own),
            plain,
            joints,
            rows: &pick(columns.rows, &own),
            weights: &pick(columns.weights, &own),
        };
        Gram::of(&columns, waves, readings)
    };
    in_parallel(&(0..parts).collect::<Vec<usize>>(), of_part)
}

/// Stretches of rows are assigned to the parts in turn.
pub(super) fn in_stretches(rows: usize, parts: usize) -> impl Fn(usize) -> usize {
    let stretch = rows.div_ceil(STRETCHES * parts).max(1);
    move |row| (row / stretch) % parts
}

/// Logarithms of the values' noise levels, summed.
fn log_units(linear: &Linear, noise: &Noise) -> f64 {
    let level = |(channel, weight): (&usize, &f64)| {
        let level = noise.levels.get(*channel).copied().unwrap_or(1.0);
        if level > 0.0 { weight * level.ln() } else { 0.0 }
    };
    linear.channels.iter().zip(&linear.weights).map(level).sum()
}

/// Mean of each wave over the rows.
fn mean_of(waves: &Waves, readings: &[f64]) -> Vec<f64> {
    let mut values = vec![0.0; waves.len()];
    let mut sums = vec![0.0; waves.len()];
    for &reading in readings {
        waves.values_into(reading, &mut values);
        for (sum, value) in sums.iter_mut().zip(&values) {
            *sum += value / readings.len() as f64;
        }
    }
    sums
}

/// Standard deviation of a curve over its range: that of the waves' posterior, and the kernel's part that the waves leave out.
fn spread(
    posterior: &Posterior,
    first: usize,
    waves: &Waves,
    prior: &[f64],
    variance: f64,
    range: (f64, f64),
) -> Vec<f64> {
    let count = waves.len();
    let block: Vec<f64> =
        (0..count * count).map(|k| posterior.covariance(first + k / count, first + k % count)).collect();
    let mut values = vec![0.0; count];
    Curve::places(range)
        .map(|reading| {
            waves.values_into(reading, &mut values);
            let known: f64 = block.chunks_exact(count).zip(&values).map(|(row, own)| own * dot(row, &values)).sum();
            let carried: f64 = prior.iter().zip(&values).map(|(v, b)| v * b * b).sum();
            (known + (variance - carried).max(0.0)).max(0.0).sqrt()
        })
        .collect()
}

/// Prior of the plain columns about the present state: precision, gradient, penalty, and log |Λ| of the effects.
fn prior(
    linear: &Linear,
    fit: &Fit<EffectModel>,
    reference: &Arm,
    plain: &[Vec<f64>],
    expected: &[Expected],
) -> (DMatrix<f64>, Vec<f64>, f64, f64) {
    let geometry = linear.geometry.ncols();
    let mut precision = DMatrix::zeros(plain.len(), plain.len());
    let joints = fit.layout.joints.len();
    let firm = &fit.layout.prior.precision;
    precision.view_mut((0, 0), (joints, joints)).copy_from(firm);
    let perturbation = fit.layout.perturbation(&fit.arm, reference);
    let mut pull = vec![0.0; plain.len()];
    let mut charge = 0.0;
    for i in 0..joints {
        pull[i] = -(0..joints).map(|k| firm[(i, k)] * perturbation[k]).sum::<f64>();
        charge -= pull[i] * perturbation[i];
    }
    // The common frame is held as in a fit: these rows come last in the linearisation.
    let held = linear.geometry.nrows() - linear.values() - joints;
    let frame = linear.geometry.rows(linear.geometry.nrows() - held, held);
    let holding = frame.transpose() * frame;
    let mut block = precision.view_mut((0, 0), (geometry, geometry));
    block += holding;
    // Unit information: the prior has the precision of one average measured value, but no larger variance than machines have.
    let mut log_precision = 0.0;
    let values = linear.values() as f64;
    for (offset, column) in plain[geometry..].iter().enumerate() {
        let unit = column.iter().map(|x| x * x).sum::<f64>() / values;
        let information = match expected.get(offset) {
            Some(Expected::UnitInformation(least)) => unit.max(*least),
            Some(Expected::OrAsNow(now)) => unit.min(now.powi(-2)),
            None => unit,
        }
        .max(f64::MIN_POSITIVE);
        precision[(geometry + offset, geometry + offset)] = information;
        log_precision += information.ln();
    }
    (precision, pull, charge, log_precision)
}
