//! Sources of a fit's noise: the instrument (isotropic, along its line of sight, across it, in orientation) and the repeatability of
//! each joint.
//!
//! The residuals of a row have the covariance
//!
//! ```text
//! V = σ² I + ω² I (of orientations) + range² u uᵀ + angle² d² (I - u uᵀ) + Σ_j ρ_j² J_j J_jᵀ
//! ```
//! with u and d the direction and distance of the target from the origin of the instrument's frame and J_j the change of the values per
//! unit of coordinate j. The variances are estimated together by restricted maximum likelihood ([`reml`]). A source is *claimed* if the
//! likelihood without it, all others free, is significantly smaller. Without the source the ratio is half a χ² with one degree of freedom,
//! because a variance is not negative (Self and Liang, Journal of the American Statistical Association 82 (1987), 605); the level is divided
//! by the number of sources tried (Bonferroni). Noise of positions may be correlated with that of orientations (`lever`). Intervals come from
//! the profile likelihood; a source that is not claimed has only an upper bound. With heavy tails a normal likelihood is overconfident:
//! ratios are divided by the variance of the rows' scores relative to that of normal rows, if that is above 1.

mod lever;
pub mod reml;
mod rows;
mod source;

use self::lever::Arms;
pub use self::lever::Lever;
use self::reml::{Likeliest, Reml, Slope, Tied, of_numbers};
pub use self::rows::HeldCurve;
use self::rows::Prepared;
use self::source::{Place, Source};
use crate::parameters::Effects;
use crate::solve::Fit;
use crate::symmetric;
use denavit_linear::threads::each_alone;
use denavit_measurements::Measurements;
use denavit_model::nalgebra::{DMatrix, Vector3};
use serde::Serialize;
use statrs::distribution::{ChiSquared, ContinuousCDF, Normal};
use std::borrow::Cow;

/// Fraction of files in which a source may be claimed falsely, in the limit of many rows. With a hundred rows the rate is about three
/// times as high: the allowed one in a hundred.
const FALSE_CLAIMS: f64 = 0.003;
/// Rise of the deviance at the ends of a 95 % interval: χ² with one degree of freedom.
const AT_THE_ENDS: f64 = 3.841_458_820_694_124;
/// The same at a one-sided 95 % bound.
const AT_THE_BOUND: f64 = 2.705_543_454_095_404;
/// Values needed per source, beyond those that the free numbers use up, to distinguish the sources.
const VALUES_PER_SOURCE: f64 = 3.0;
/// Relative tolerance of an interval's end.
const END: f64 = 1e-2;
/// Within this distance of an end, in roots of the deviance, one more Newton step is accurate to [`END`].
const NEARLY: f64 = 0.3;
/// Tolerance of the deviance where likelihoods are compared.
const GOOD: f64 = 1e-2;
/// A source is negligible if the square of its size is less than this many times its variance: one absent source in a hundred exceeds it.
const FOR_NOTHING: f64 = 6.0;
/// Alternations between variances and lever, at most.
const MOST_TURNS: usize = 20;
/// Evaluations for an interval's end, at most.
const MOST_TRIALS: usize = 40;
/// Noise below this fraction of the robot's size (or of 1 rad) is rounding, and has no sources.
const EXACT: f64 = 1e-9;
/// A source that could be this many times the whole noise is not identifiable.
const NOT_TOLD: f64 = 1e4;
/// Significance level of the test for correlation between neighbours in the run.
const FALSE_ORDER: f64 = 0.01;

/// The sources of a fit's noise.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct NoiseModel {
    /// Rows used for the estimate.
    pub rows: usize,
    /// Rows that were fitted; if more than `rows`, some were left out at regular intervals to save time.
    pub of_rows: usize,
    /// The sources that were tried.
    pub components: Vec<Component>,
    /// How the noise of positions is correlated with that of orientations; absent if it is not.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lever: Option<Lever>,
    /// Whether neighbours in the run are correlated; absent if there are too few.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub run_order: Option<RunOrder>,
    /// Fourth moment of the whitened residuals divided by the square of the second: 3 for a normal distribution, more with heavy tails.
    pub kurtosis: f64,
}

/// A source of noise.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Component {
    /// Kind, such as `position`, `range`, `angle` or `repeatability`.
    pub name: Cow<'static, str>,
    /// The joint, for `repeatability`; absent if one value holds for all joints.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub joint: Option<String>,
    /// `m` or `rad`.
    pub unit: &'static str,
    /// Standard deviation, in the unit.
    pub value: f64,
    /// Lower end of the 95 % interval; 0 if not claimed.
    pub low: f64,
    /// Upper end; if not claimed, the upper 95 % bound. Absent if the data do not determine it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub high: Option<f64>,
    /// Whether the data support it.
    pub claimed: bool,
    /// Probability of such data without it, not corrected for the number of sources tried; absent if not tested.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub p_value: Option<f64>,
}

/// Correlation between the residuals of consecutive rows.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct RunOrder {
    /// Autocorrelation of lag 1, -1 to 1, of the whitened residuals.
    pub lag_1: f64,
    /// Lower end of its 95 % interval.
    pub low: f64,
    /// Upper end.
    pub high: f64,
    /// Probability of a correlation at least this large if rows are independent.
    pub p_value: f64,
    /// Whether it is significant.
    pub claimed: bool,
}

/// The sources of a fit's noise; `None` if there is no noise beyond rounding, or too few values.
///
/// # Shape and units
/// `curves`: the error curves in the fit besides its free numbers.
pub fn noise_model<E: Effects>(fit: &Fit<E>, data: &Measurements, curves: &[HeldCurve<'_>]) -> Option<NoiseModel> {
    let size = fit.arm.nominal.size();
    let exact = |(part, level): (&denavit_measurements::kinds::Part, &f64)| {
        *level <= EXACT * if part.unit == "m" { size } else { 1.0 }
    };
    if data.scene.channels.iter().zip(&fit.noise.levels).any(exact) || fit.assumed_degrees() > 0.0 {
        return None;
    }
    let prepared = rows::prepared(fit, data, curves)?;
    let (mut judged, variances) = judge(&prepared.reml, &prepared.sources)?;
    if let Some(with) = prepared.arms.as_ref().and_then(|arms| turning(&prepared, arms, &variances)) {
        judged = with;
    }
    Some(NoiseModel { rows: prepared.rows, of_rows: prepared.of, ..judged })
}

/// The noise if that of orientations also moves positions; `None` if this is not significant.
///
/// Variances estimated without a lever include its part, so variances and lever are estimated alternately.
fn turning(prepared: &Prepared, arms: &Arms, variances: &[f64]) -> Option<NoiseModel> {
    let p_value = arms.p_value(&prepared.reml, variances);
    if p_value >= FALSE_CLAIMS {
        return None;
    }
    let all = Tied::each(prepared.sources.len());
    let mut found = arms.likeliest(&prepared.reml, variances, Vector3::zeros())?;
    let mut variances = variances.to_vec();
    for _ in 0..MOST_TURNS {
        variances = found.reml.likeliest(&all, &variances, &[], GOOD)?.numbers;
        let next = arms.likeliest(&prepared.reml, &variances, found.at)?;
        let same = next.same(&found);
        found = next;
        if same {
            break;
        }
    }
    let noise = judge(&found.reml, &prepared.sources)?.0;
    Some(NoiseModel { lever: Some(arms.lever(&found, p_value)), ..noise })
}

fn is_level(source: &Source) -> bool {
    matches!(source.place, Place::Level(_))
}

/// Answers for each of `count` sources.
fn for_each<R: Send>(count: usize, asked: impl Fn(usize) -> R + Sync) -> Vec<R> {
    each_alone(&(0..count).collect::<Vec<usize>>(), |&source| asked(source))
}

/// The sources' variances, intervals and claims; and the variances of the model without negligible sources.
///
/// Claims are tested in the model with all sources. Sizes and intervals come from the model without negligible ones: a variance is not
/// negative, so an absent source would always take something from those that act.
fn judge(reml: &Reml, sources: &[Source]) -> Option<(NoiseModel, Vec<f64>)> {
    let count = sources.len();
    let levels = sources.iter().filter(|source| is_level(source)).count();
    let start: Vec<f64> = sources
        .iter()
        .map(|source| if is_level(source) { 0.8 } else { 0.2 / (count - levels).max(1) as f64 })
        .collect();
    let full = Study { reml, tied: Tied::each(count), best: reml.likeliest(&Tied::each(count), &start, &[], 0.0)? };
    if reml.values() as f64 - full.best.slope.used < VALUES_PER_SOURCE * count as f64 {
        return None;
    }
    let joints: Vec<usize> = (0..count).filter(|&k| matches!(sources[k].place, Place::Joint(_))).collect();
    let together = together(sources, &joints);
    let tried = count - levels + usize::from(together.is_some());
    let limit = FALSE_CLAIMS / tried as f64;
    let mut p_values: Vec<Option<f64>> = for_each(count, |k| (!is_level(&sources[k])).then(|| full.p_value_without(k)));
    let mut claimed: Vec<bool> = p_values.iter().map(|p_value| p_value.is_none_or(|p_value| p_value < limit)).collect();
    let mut sources = sources.to_vec();
    let mut model = full.kept(&claimed);
    let mut all_alike = None;
    if let Some((source, tied)) = together.filter(|_| !joints.iter().any(|&k| claimed[k])) {
        all_alike = Some(tied.clone());
        let mut start = model.best.numbers.clone();
        start.push(joints.iter().map(|&k| full.best.numbers[k]).sum::<f64>() / joints.len() as f64);
        if let Some(best) = reml.likeliest(&tied, &start, &[], GOOD) {
            let study = Study { reml, tied, best };
            let p_value = study.p_value_without(count);
            sources.push(source);
            p_values.push(Some(p_value));
            claimed.push(p_value < limit);
            if p_value < limit {
                model = study.kept(&claimed);
            }
        }
    }
    let model = model.refined()?;
    let open = reml.slope(&model.tied.variances(&model.best.numbers))?;
    let beside = Beside { open: &open, together: all_alike.as_ref() };
    let component = |k: usize| model.component(k, &sources[k], &beside, claimed[k], p_values[k]);
    let mut components: Vec<Component> = for_each(sources.len(), component);
    // A level is tested again without the sources that are not claimed.
    let open: Vec<usize> = (0..count).filter(|&k| is_level(&sources[k]) && !components[k].claimed).collect();
    if !open.is_empty()
        && let Some(sure) = model.only(&claimed)
    {
        for k in open {
            let beside = Beside { open: &sure.best.slope, together: None };
            components[k] = sure.component(k, &sources[k], &beside, true, None);
        }
    }
    let slope = &model.best.slope;
    let (squares, fourth) = slope.powers;
    let kurtosis = reml.values() as f64 * fourth / (squares * squares);
    let variances = model.tied.variances(&model.best.numbers);
    let noise = NoiseModel { rows: 0, of_rows: 0, components, lever: None, run_order: run_order(slope), kurtosis };
    Some((noise, variances))
}

/// One repeatability for all joints that turn, instead of one for each; `None` if there is only one such joint.
fn together(sources: &[Source], joints: &[usize]) -> Option<(Source, Tied)> {
    let turning: Vec<usize> = joints.iter().copied().filter(|&k| sources[k].unit == "rad").collect();
    if turning.len() < 2 {
        return None;
    }
    let count = sources.len();
    let unit = turning.iter().map(|&k| sources[k].unit_size).fold(f64::INFINITY, f64::min);
    let of = |k: usize| {
        let own = turning.contains(&k);
        if own { Some((count, (unit / sources[k].unit_size).powi(2))) } else { Some((k, 1.0)) }
    };
    let source = Source { place: Place::Joint(usize::MAX), name: String::new(), unit: "rad", unit_size: unit };
    Some((source, Tied { of: (0..count).map(of).collect(), count: count + 1 }))
}

/// The model to which a source that it lacks is added.
struct Beside<'a> {
    /// The slope at the model's variances with respect to all sources.
    open: &'a Slope,
    /// How the sources are tied if all joints share one number.
    together: Option<&'a Tied>,
}

/// The likeliest variances, and the shape of the likelihood around them.
struct Study<'a> {
    reml: &'a Reml,
    tied: Tied,
    best: Likeliest,
}

impl<'a> Study<'a> {
    /// The model without negligible sources: the weakest source that is not claimed is removed as long as the likelihood hardly falls.
    fn kept(&self, claimed: &[bool]) -> Study<'a> {
        let mut model = Study { reml: self.reml, tied: self.tied.clone(), best: self.best.clone() };
        loop {
            let idle: Vec<usize> = (0..model.tied.count)
                .filter(|&k| !claimed.get(k).copied().unwrap_or(false) && model.has(k) && model.best.numbers[k] <= 0.0)
                .collect();
            // Removing a source of size 0 changes nothing.
            for k in idle {
                model.tied = model.tied.at_zero(k);
            }
            let open = (0..model.tied.count).filter(|&k| !claimed.get(k).copied().unwrap_or(false) && model.has(k));
            let least = open
                .map(|k| (model.pull_of(k) / model.tails(k), k))
                .filter(|(ratio, _)| *ratio < FOR_NOTHING)
                .min_by(|a, b| a.0.total_cmp(&b.0));
            let Some((_, k)) = least else { return model };
            let tied = model.tied.at_zero(k);
            let start = model.profile(k).beside(&model.best.numbers, 0.0);
            let Some(best) = self.reml.likeliest(&tied, &start, &[], GOOD) else { return model };
            // The estimate from the curvature alone may be wrong.
            if best.slope.deviance - model.best.slope.deviance >= FOR_NOTHING * model.tails(k) {
                return model;
            }
            model = Study { reml: self.reml, tied, best };
        }
    }

    /// The model with claimed sources only.
    fn only(&self, claimed: &[bool]) -> Option<Study<'a>> {
        let open = (0..self.tied.count).filter(|&k| !claimed.get(k).copied().unwrap_or(false));
        let tied = open.fold(self.tied.clone(), |tied, k| tied.at_zero(k));
        let best = self.reml.likeliest(&tied, &self.best.numbers, &[], 0.0)?;
        Some(Study { reml: self.reml, tied, best })
    }

    /// The same, fully converged.
    fn refined(self) -> Option<Study<'a>> {
        let best = self.reml.likeliest(&self.tied, &self.best.numbers, &[], 0.0)?;
        Some(Study { best, ..self })
    }

    /// Whether a source follows this number.
    fn has(&self, number: usize) -> bool {
        self.tied.of.iter().flatten().any(|(own, _)| *own == number)
    }

    /// The square of a number divided by its variance from the curvature.
    fn pull_of(&self, number: usize) -> f64 {
        let (inside, inverse) = self.spread_of(number);
        let at = inside.iter().position(|k| *k == number);
        let variance = at.map_or(f64::INFINITY, |at| 2.0 * inverse[(at, at)]);
        self.best.numbers[number].powi(2) / variance
    }

    /// The numbers that are not at their bound, including this one, and the inverse of their information.
    fn spread_of(&self, number: usize) -> (Vec<usize>, DMatrix<f64>) {
        let (_, information) = of_numbers(&self.tied, &self.best.slope);
        let inside: Vec<usize> =
            (0..self.tied.count).filter(|&k| (k == number || self.best.numbers[k] > 0.0) && self.has(k)).collect();
        let own = information.select_rows(&inside).select_columns(&inside);
        // A direction without information is undetermined.
        let inverse = own.clone().try_inverse().unwrap_or_else(|| symmetric::inverse(&own, 0.0));
        (inside, inverse)
    }

    /// Value and interval of one source; a source outside the model is added first.
    fn component(
        &self,
        number: usize,
        source: &Source,
        beside: &Beside<'_>,
        claimed: bool,
        p_value: Option<f64>,
    ) -> Component {
        let own;
        let study = if self.has(number) {
            self
        } else {
            own = self.with(number, beside);
            own.as_ref().unwrap_or(self)
        };
        let tails = study.tails(number);
        let rise = if claimed { AT_THE_ENDS } else { AT_THE_BOUND } * tails;
        let high = study.has(number).then(|| study.end(number, rise, true)).flatten();
        let low = if claimed { study.end(number, rise, false).unwrap_or(0.0) } else { 0.0 };
        let size = |variance: f64| source.unit_size * variance.sqrt();
        let (name, joint) = match source.place {
            Place::Joint(index) => ("repeatability".into(), (index != usize::MAX).then(|| source.name.clone())),
            _ => (Cow::Owned(source.name.clone()), None),
        };
        let value = if study.has(number) { size(study.best.numbers[number]) } else { 0.0 };
        // A level that the other sources explain is not claimed.
        let claimed = claimed && (p_value.is_some() || low > 0.0);
        Component { name, joint, unit: source.unit, value, low: size(low), high: high.map(size), claimed, p_value }
    }

    /// The model with one more number.
    fn with(&self, number: usize, beside: &Beside<'_>) -> Option<Study<'a>> {
        let mut tied = self.tied.clone();
        let mut start = self.best.numbers.clone();
        if number < tied.of.len() {
            tied.of[number] = Some((number, 1.0));
        } else {
            let all = beside.together?;
            for (own, of) in tied.of.iter_mut().zip(&all.of).filter(|(_, of)| of.is_some_and(|(own, _)| own == number))
            {
                *own = *of;
            }
            tied.count = all.count;
            start.resize(tied.count, 0.0);
        }
        // A joint that used the number shared by all joints starts elsewhere.
        let same = tied.variances(&start) == self.tied.variances(&self.best.numbers);
        let best = if same {
            self.reml.likeliest_from(&tied, (&start, beside.open.clone()), &[], GOOD)?
        } else {
            self.reml.likeliest(&tied, &start, &[], GOOD)?
        };
        Some(Study { reml: self.reml, tied, best })
    }

    /// Probability of a likelihood ratio at least this large if the source is absent.
    fn p_value_without(&self, number: usize) -> f64 {
        if self.best.numbers[number] <= 0.0 {
            return 1.0;
        }
        let start = self.profile(number).beside(&self.best.numbers, 0.0);
        let rest = self.reml.likeliest(&self.tied.at_zero(number), &start, &[], GOOD);
        let ratio = rest.map_or(f64::INFINITY, |rest| rest.slope.deviance - self.best.slope.deviance);
        half_chi_squared(ratio.max(0.0) / self.tails(number))
    }

    /// Variance of the rows' scores relative to that of normal rows, for this number with all others free; at least 1.
    fn tails(&self, number: usize) -> f64 {
        let slope = &self.best.slope;
        let (inside, inverse) = self.spread_of(number);
        let Some(at) = inside.iter().position(|k| *k == number) else { return 1.0 };
        let mut weights = vec![0.0; slope.scores.nrows()];
        for (k, of) in self.tied.of.iter().enumerate() {
            if let Some((place, factor)) = of.and_then(|(own, f)| Some((inside.iter().position(|i| *i == own)?, f))) {
                weights[k] = factor * inverse[(at, place)];
            }
        }
        let weights = DMatrix::from_row_slice(1, weights.len(), &weights);
        let influence = weights * &slope.scores;
        let mean = influence.mean();
        let spread: f64 = influence.iter().map(|own| (own - mean).powi(2)).sum();
        let normal = 2.0 * inverse[(at, at)];
        if normal > 0.0 && spread.is_finite() { (spread / normal).max(1.0) } else { 1.0 }
    }

    /// Where the profile of the deviance has risen by `rise`, above or below the likeliest value; `None` if it never does.
    ///
    /// Newton steps: the slope of the profile is that of the deviance with all other numbers at their optimum, and the root of the rise is
    /// nearly linear in the standard deviation. A step out of the bracket is replaced by linear interpolation between its ends.
    fn end(&self, number: usize, rise: f64, above: bool) -> Option<f64> {
        let best = self.best.numbers[number].max(0.0);
        let profile = self.profile(number);
        let guess = if above { best + profile.reach(rise) } else { (best - profile.reach(rise)).max(0.0) };
        let (mut inner, mut outer) = ((best.sqrt(), -rise.sqrt()), None);
        let (mut at, mut near) = (guess.sqrt(), self.best.numbers.clone());
        for _ in 0..MOST_TRIALS {
            let start = profile.beside(&near, at * at);
            let held = self.reml.likeliest(&self.tied, &start, &[number], GOOD);
            let risen = held.as_ref().map_or(f64::INFINITY, |held| held.slope.deviance - self.best.slope.deviance);
            let risen = risen.max(0.0).sqrt();
            let excess = risen - rise.sqrt();
            if excess.abs() < END || excess < 0.0 && at <= 0.0 {
                return Some(at * at);
            }
            if excess > 0.0 {
                outer = Some((at, excess));
            } else if at * at > NOT_TOLD {
                return None;
            } else {
                inner = (at, excess);
            }
            if outer.is_some_and(|(outer, _)| (outer - inner.0).abs() <= END * outer.max(inner.0)) {
                break;
            }
            let slope = held.as_ref().map_or(0.0, |held| of_numbers(&self.tied, &held.slope).0[number] * at / risen);
            let newton = at - excess / slope;
            if excess.abs() < NEARLY && newton.is_finite() && newton > 0.0 {
                return Some(newton * newton);
            }
            let within = |(outer, _): (f64, f64)| (newton - inner.0) * (newton - outer) < 0.0;
            at = match outer {
                Some(outer) if newton.is_finite() && within(outer) => newton,
                Some((outer, over)) if over.is_finite() => inner.0 - inner.1 / (over - inner.1) * (outer - inner.0),
                Some((outer, _)) => 0.5 * (inner.0 + outer),
                // At most twice as far in one step.
                None if above && newton > at => newton.min(2.0 * at),
                None if above => 1.5 * at,
                None if newton < at => newton.max(0.0),
                None => 0.0,
            };
            near = held.map_or(near, |held| held.numbers);
        }
        Some((0.5 * (inner.0 + outer.map_or(inner.0, |(outer, _)| outer))).powi(2))
    }

    /// How the deviance and the other numbers change with one number, by slope and curvature at the likeliest.
    fn profile(&self, number: usize) -> Profile {
        let (inside, inverse) = self.spread_of(number);
        let at = inside.iter().position(|k| *k == number).filter(|&at| inverse[(at, at)] > 0.0);
        let (gradient, information) = of_numbers(&self.tied, &self.best.slope);
        let own = information[(number, number)].max(f64::MIN_POSITIVE);
        let curvature = at.map_or(own, |at| 1.0 / inverse[(at, at)]);
        let ways = at.map_or_else(Vec::new, |at| {
            let others = inside.iter().enumerate().filter(|(_, k)| **k != number);
            others.map(|(place, &k)| (k, inverse[(place, at)] * curvature)).collect()
        });
        Profile { number, slope: gradient[number].max(0.0), curvature, ways }
    }
}

/// The deviance of a profile to second order.
struct Profile {
    number: usize,
    slope: f64,
    curvature: f64,
    /// Change of each other number per unit of this one.
    ways: Vec<(usize, f64)>,
}

impl Profile {
    /// Change of the number at which the deviance has risen by `rise`.
    fn reach(&self, rise: f64) -> f64 {
        // ½ h x² + g x = rise, without cancellation.
        2.0 * rise / (self.slope + (self.slope * self.slope + 2.0 * self.curvature * rise).sqrt())
    }

    /// These numbers with this one at another value, and the others at their likeliest values then.
    fn beside(&self, near: &[f64], value: f64) -> Vec<f64> {
        let mut numbers = near.to_vec();
        let by = value - near[self.number];
        for (k, way) in &self.ways {
            numbers[*k] = (numbers[*k] + way * by).max(0.0);
        }
        numbers[self.number] = value;
        numbers
    }
}

/// Probability of a ratio at least this large if half of all ratios are 0 and the others χ² with one degree of freedom.
fn half_chi_squared(ratio: f64) -> f64 {
    if ratio <= 0.0 {
        return 1.0;
    }
    let chi = ChiSquared::new(1.0).expect("one degree of freedom is positive");
    0.5 * chi.sf(ratio)
}

/// Correlation between the residuals of neighbours in the run.
fn run_order(slope: &Slope) -> Option<RunOrder> {
    let (sum, count) = slope.lag;
    if count < 30.0 {
        return None;
    }
    let lag_1 = (sum / count).clamp(-0.999, 0.999);
    let normal = Normal::standard();
    let p_value = 2.0 * normal.sf(lag_1.abs() * count.sqrt());
    let within = |side: f64| (lag_1.atanh() + side * 1.96 / count.sqrt()).tanh();
    Some(RunOrder { lag_1, low: within(-1.0), high: within(1.0), p_value, claimed: p_value < FALSE_ORDER })
}
