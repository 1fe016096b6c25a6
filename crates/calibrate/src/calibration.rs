//! The whole of a calibration: stages on training rows, errors on rows that no stage saw, effects, the report.

pub mod adoption;
pub mod contract;
pub mod diagnosis;
pub mod drawing_differences;
pub mod expected;
mod joint_zeros;
pub mod monitor;
pub(crate) mod open;
pub mod placed_anew;
pub(crate) mod prediction;
mod result;
pub mod rows;
mod stage_residuals;
mod stages;
mod tips;

pub use self::adoption::AdoptedFit;
pub use self::result::Calibration;
pub use self::stage_residuals::StageResiduals;

use self::diagnosis::explained::{Explained, explained};
use self::diagnosis::{Corrected, Diagnosis};
use self::placed_anew::PlacedAnew;
use crate::calibration::adoption::Adopted;
use crate::calibration::contract::{
    CalibrationReport, Continued, Counts, CurveEntry, EffectEntry, FieldEntry, HeldBy, Identified, Origin, ReadAs,
    Rival, SCHEMA, Samples, Unexplained, Unidentifiable,
};
use crate::calibration::drawing_differences::{DrawingDifference, drawing_differences};
use crate::calibration::expected::Expected;
use crate::calibration::rows::Rows;
use crate::calibration::stages::{Beyond, Stages, beyond, geometric_stages, kept};
use denavit_identify::averaging::{Averaging, Named, NotAveraged, averaged};
use denavit_identify::carried::{self, Carried};
use denavit_identify::effects::curve::Curve;
use denavit_identify::effects::driver::Statics;
use denavit_identify::effects::model::Term;
use denavit_identify::effects::survey::{Survey, with_run_order, with_run_order_after};
use denavit_identify::identifiability::{Identifiability, UnidentifiableParameter, identifiability};
use denavit_identify::information::Information;
use denavit_identify::known_effects::EffectsPosterior;
use denavit_identify::lack_of_fit::lack_of_fit;
use denavit_identify::noise::{HeldCurve, NoiseModel, noise_model};
use denavit_identify::parameters::{Freedom, NoEffects};
use denavit_identify::posterior::{KnownParameter, Posterior};
use denavit_identify::proportion::{OutOfProportion, within_proportion};
use denavit_identify::quantization;
use denavit_identify::redundancy::{Redundancy, different};
use denavit_identify::residual_statistics::{Residual, TestError, bound_later};
use denavit_identify::solve::{Fit, Unfinished, outside};
use denavit_identify::{Identification, IdentifyOptions, identify};
use denavit_linear::threads::join;
use denavit_measurements::Measurements;
use denavit_model::Chain;
use denavit_trace::infer::curves::{CurveFit, CurveOptions, fit_curves};
use denavit_trace::infer::model::Kernel;
use denavit_trace::loads::undeclared_loads;
use denavit_trace::masses::link_masses;
use denavit_trace::{Finding, Trace, TraceOptions, trace};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use serde_json::{Map, Value, json};
use std::ops::ControlFlow;
use std::sync::Arc;
use thiserror::Error;

/// Readings of one joint that differ by more than this are two postures, rad or m.
const MOVED: f64 = 1e-3;

/// Rows to hold out of a single file.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HoldOut {
    /// Share of the rows, between 0 and 1.
    pub share: f64,
    /// Same seed, same rows.
    pub seed: u64,
}

/// How to calibrate.
#[derive(Debug, Clone, PartialEq)]
pub struct CalibrateOptions {
    /// What is free, the prior, outliers.
    pub identify: IdentifyOptions,
    /// Rows to hold out where there is no test file.
    pub hold_out: Option<HoldOut>,
    /// Search for effects; `None`: geometry alone.
    pub trace: Option<TraceOptions>,
    /// Fit error curves of the joints if there is no search for effects.
    pub curves: Option<CurveOptions>,
    /// Predict with the average over all possible models, unless the last stage predicts left-out postures better.
    pub average: bool,
    /// Estimate the components of the noise.
    pub noise: bool,
    /// Other chains of the same robot that the data may belong to; tried if this one cannot explain them.
    pub other_chains: Vec<Chain>,
}

impl CalibrateOptions {
    /// Geometry alone, every axis, nothing held out, the noise as a number.
    pub fn geometry(chain: &Chain) -> Self {
        Self {
            identify: IdentifyOptions::axes(chain),
            hold_out: None,
            trace: None,
            curves: None,
            average: false,
            noise: false,
            other_chains: Vec::new(),
        }
    }
}

/// Why data give no calibration.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum CalibrateError {
    /// Not enough to place the instrument.
    #[error(
        "{file}: {} {values} measured numbers{}, but {needed} are needed to place the instrument and the targets, \
         and a few more as a check; measure more poses",
        if *rows == 1 { "1 row holds".to_owned() } else { format!("{rows} rows hold") },
        in_postures(*rows, *postures)
    )]
    TooFewRows {
        /// The file.
        file: String,
        /// Its rows.
        rows: usize,
        /// Different postures among them.
        postures: usize,
        /// Numbers measured.
        values: usize,
        /// Numbers to find before any geometry.
        needed: usize,
    },
    /// The data do not belong to this robot, or not as written.
    #[error(transparent)]
    Diagnosis(#[from] Diagnosis),
    /// A robot larger than anything that is measured.
    #[error(transparent)]
    OutOfProportion(#[from] OutOfProportion),
    /// The geometric fit did not converge.
    #[error(
        "{file}: the fit of the geometry did not converge in {iterations} steps, so there is no result: {}",
        why_unfinished(unfinished.as_ref(), file)
    )]
    NotConverged {
        /// The file.
        file: String,
        /// Steps taken.
        iterations: usize,
        /// The remaining gain, and the parameters that still change.
        unfinished: Option<Unfinished>,
    },
    /// A share that holds out nothing or everything.
    #[error(
        "‹hold-out› {0}: give the share of rows to keep for the test, between 0 and 1; both parts need postures of their own"
    )]
    HoldOutShare(f64),
    /// A total mass for a robot whose masses are known.
    #[error("‹mass›: the description already has masses; leave ‹mass› out")]
    MassesKnown,
    /// The test file does not fit the fit.
    #[error(transparent)]
    Test(#[from] TestError),
    /// The masses are known on other paths than those to the tips of the rows.
    #[error(
        "{0}: the search for effects and error curves needs the masses on the paths to all tips of the rows, but they were given \
         for other paths; see `Statics::placed_tips`"
    )]
    StaticsOfOtherTips(String),
    /// A tip without rows.
    #[error("{file}: no row is of tip \"{tip}\"; measure some, or name only the other tips")]
    NoRowsOfTip {
        /// The file.
        file: String,
        /// The tip.
        tip: String,
    },
    /// The progress callback stopped it.
    #[error("stopped before the end")]
    Stopped,
}

/// Which parameters still change, and what to do.
fn why_unfinished(unfinished: Option<&Unfinished>, file: &str) -> String {
    let say = format!("`denavit identify ‹data› {file}` prints what the rows determine");
    match unfinished {
        Some(Unfinished { promise, parameters }) if promise.is_finite() && !parameters.is_empty() => format!(
            "{} still {} (the next step is expected to lower chi-squared by {promise:.0}); the rows hardly determine {}: add poses \
             in which all joints move further and the tool is turned in other directions; {say}",
            parameters.join(", "),
            if parameters.len() == 1 { "changes" } else { "change" },
            if parameters.len() == 1 { "it" } else { "them" },
        ),
        _ => format!(
            "the equations of the fit have no solution; remove rows with extreme values, and check the units of all columns; {say}"
        ),
    }
}

fn in_postures(rows: usize, postures: usize) -> String {
    match (rows, postures) {
        (rows, postures) if rows == postures => String::new(),
        (_, 1) => " in one posture, measured repeatedly".into(),
        (_, postures) => format!(" in {postures} different postures"),
    }
}

/// The present phase of a calibration.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Progress {
    /// Instrument, targets, axes.
    Geometry,
    /// The search for effects.
    Effects,
    /// Error curves of the joints.
    Curves,
    /// Errors of every stage, and identifiability.
    Judgement,
}

/// Calibrate a chain.
///
/// # Errors
/// Too few rows, data that cannot belong to this robot, a test file that does not fit.
pub fn calibrate(
    chain: &Chain,
    statics: &Statics,
    data: Measurements,
    test: Option<Measurements>,
    options: &CalibrateOptions,
) -> Result<Calibration, CalibrateError> {
    calibrate_and_tell(chain, statics, data, test, options, &mut |_| ControlFlow::Continue(()))
}

/// As [`calibrate`], and reports the start of each phase, where it can be stopped.
///
/// # Errors
/// As [`calibrate`]; [`CalibrateError::Stopped`].
#[expect(clippy::too_many_lines, reason = "the stages one after the other")]
pub fn calibrate_and_tell(
    chain: &Chain,
    statics: &Statics,
    data: Measurements,
    test: Option<Measurements>,
    options: &CalibrateOptions,
    progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
) -> Result<Calibration, CalibrateError> {
    let mut begin = |stage| if progress(stage).is_break() { Err(CalibrateError::Stopped) } else { Ok(()) };
    let Fresh { data, test, stale, copies, test_copies } = fresh(data, test)?;
    let (mut train, mut test) = rows_of(data, test, statics, options)?;
    begin(Progress::Geometry)?;
    within_proportion(chain)?;
    let mut identification = identify(chain, &train, &options.identify);
    let mut corrected = diagnosis::judge(chain, &train, &identification, &options.identify, &options.other_chains)?;
    if let Some(zeros) =
        corrected.as_ref().and_then(|corrected| free_zeros(chain, corrected, &options.identify.freedom))
    {
        // A zero that is fitted is not a mistake: the fit starts from there.
        let started = IdentifyOptions { start_zeros: zeros, ..options.identify.clone() };
        identification = identify(chain, &train, &started);
        corrected = None;
    }
    if let Some(corrected) = &corrected {
        train = corrected.applied(chain, train);
        test = test.map(|test| corrected.applied(chain, test));
        identification = identify(chain, &train, &options.identify);
    }
    let of_spread = explained(&identification.geometric, &train);
    if corrected.is_some() {
        diagnosis::explains_something(chain, &train, &of_spread)?;
    }
    let geometric = &identification.geometric;
    if !geometric.converged_or_exact() {
        let (iterations, unfinished) = (geometric.iterations, geometric.unfinished.clone());
        return Err(CalibrateError::NotConverged { file: train.source.clone(), iterations, unfinished });
    }
    let identifiable = identifiability(&train, &geometric.arm, &NoEffects, &options.identify.freedom);
    let redundancy = Redundancy::of(&train, identifiable.rank);
    let asks_loads = options.trace.is_some() && redundancy.enough_for_effects;
    let loads = if asks_loads { undeclared_loads(statics, &train, geometric) } else { None };
    if let Some(loads) = &loads {
        train = loads.applied(train);
        test = test.map(|test| loads.applied(test));
    }
    let total = options.trace.as_ref().and_then(|trace| trace.total_mass);
    if total.is_some() && statics.masses.from_inertials {
        return Err(CalibrateError::MassesKnown);
    }
    let scaled = total.map(|total| statics.of_total(total));
    let statics = scaled.as_ref().unwrap_or(statics);
    let asks_masses = asks_loads && identification.earlier.is_none();
    let masses = if asks_masses { link_masses(statics, &train, geometric, total.is_some()) } else { None };
    let weighed = masses.as_ref().map(|masses| masses.applied(statics));
    let statics = weighed.as_ref().unwrap_or(statics);
    // Geometry alone is wanted where neither effects nor curves are.
    let carried = options.trace.is_some() || options.curves.is_some();
    let carried = carried.then(|| carried::carried(&train, &identification, &options.identify)).flatten();
    let weight = carried.as_ref().map(|carried| carried.weight);
    let weight = weight.or_else(|| identification.earlier.as_ref().map(|earlier| earlier.weight));
    let searched = Searched { statics, data: &train, geometric, carried: carried.as_ref(), weight };
    let (found, curves) = searched.run(options, redundancy.enough_for_effects, &mut begin)?;
    if let (Some(test), Some(found)) = (&test, &found) {
        bound_later(&found.fit.effects, &train, test)?;
    }
    begin(Progress::Judgement)?;
    let beyond = beyond(carried.as_ref(), curves.as_ref(), found.as_ref());
    let of_geometry = geometric_stages(&identification, carried.is_some());
    let placed_anew = test.as_ref().and_then(|test| PlacedAnew::find(&identification.geometric, &train, test));
    let mut stages = Stages::new(&train, test.as_ref(), placed_anew.as_ref());
    stages.add_all(&of_geometry, &beyond)?;
    let last = stages.last();
    let reached = last.checked_sub(of_geometry.len()).map(|index| &beyond[index]);
    let geometry = of_geometry[last.min(of_geometry.len() - 1)];
    let averaging = || {
        if !options.average {
            return Err(NotAveraged::NotAsked);
        }
        let before = (found.as_ref(), beyond.iter().rev().find(|before| before.fit.converged_or_exact()));
        averaging(statics, &train, &identification, &options.identify, before).map(Box::new)
    };
    let noise = || options.noise.then(|| noise_of(reached, geometry.2, &train)).flatten();
    let named = reached.map_or(geometry.1, |reached| reached.adopted);
    let found_here = found.as_ref().filter(|_| named == Adopted::Effects);
    let entries = |of: bool| entries(found_here, of, chain);
    let one_of = entries(false);
    let prospect = || {
        let (found, reached) = (found_here.filter(|_| !one_of.is_empty())?, reached?);
        let fit = || reached.fit.clone().into_owned();
        open::prospect(&open::open(Some(found), statics, &train, fit, &geometric.arm), &train)
    };
    let (averaging, (noise, prospect)) = join(averaging, || join(noise, prospect));
    if let Ok(averaging) = &averaging {
        stages.add_averaged(&averaging.fit)?;
    }
    let recommended = stages.adopt();
    let Stages { done: stages, mut held_out, .. } = stages;
    let held_out = held_out.swap_remove(recommended);
    let (weights, information, (parameters, posterior, differs)) = match reached {
        Some(Beyond { fit, deflections, modes, .. }) => {
            let (parameters, posterior, differs) = identified(fit);
            let effects = EffectsPosterior::of(fit, deflections.len(), modes);
            let posterior = posterior.map(|posterior| Posterior { effects, ..posterior });
            (&fit.weights, Information::of(fit), (parameters, posterior, differs))
        }
        None => (&geometry.2.weights, Information::of(geometry.2), identified(geometry.2)),
    };
    let plain = &identification.geometric;
    let (adopted, information, (parameters, posterior, differs)) = match &averaging {
        // The calibrated robot has the geometry of the geometric fit; the next calibration continues from the named causes.
        Ok(_) => (Adopted::Averaged, Information::of(plain), of_geometric_stage(plain, parameters, posterior)),
        Err(_) => (named, information, (parameters, posterior, differs)),
    };
    let left = || match (&averaging, reached) {
        (Ok(averaging), _) => kept(&averaging.fit, &train),
        (Err(_), Some(reached)) => kept(&reached.fit, &train),
        (Err(_), None) => kept(geometry.2, &train),
    };
    let repeats = lack_of_fit(&train, left, identifiable.rank);
    let joint_zeros =
        joint_zeros::joint_zeros(chain, &train, &identification, &options.identify, |fit| self::identified(fit).0);
    let report = CalibrationReport {
        schema: SCHEMA,
        origin: Origin::default(),
        robot: chain.name().into(),
        base: chain.base().into(),
        tip: chain.tip().into(),
        tips: tips::entries(chain, (&train, left), test.as_ref().map(|test| (test, &held_out[..]))),
        measurement: train.scene.measured(),
        columns: Vec::new(),
        read_as: corrected.as_ref().map(ReadAs::of),
        undeclared_loads: loads,
        masses,
        placed_anew: placed_anew.clone(),
        poorly_explained: of_spread.into_iter().filter(Explained::poorly).collect(),
        samples: Samples {
            train: train.len(),
            test: test.as_ref().map_or(0, |test| test.locate.iter().filter(|locate| !**locate).count()),
            rejected: rejected(&train, weights),
            stale,
            copies,
            test_copies,
            test_outliers: test.as_ref().map_or_else(Vec::new, |test| far_off(test, &held_out)),
        },
        redundancy,
        repeats,
        noise,
        identifiability: Counts { expected: identifiable.expected, rank: identifiable.rank },
        unidentifiable: unidentifiable(&identifiable, &parameters),
        stages,
        adopted,
        placements: None,
        rows: Rows::default(),
        parameters,
        posterior,
        earlier: weight.map(|weight| Continued {
            weight,
            effects: carried.as_ref().map_or_else(Vec::new, |carried| carried.parts.clone()),
        }),
        differs_from_drawing: differs,
        joint_zeros,
        effects: entries(true),
        one_of,
        prospect,
        prediction: averaging.as_ref().ok().map(|averaging| Expected::of(averaging, &train)),
        curves: reached.map_or_else(Vec::new, |reached| CurveEntry::of_fit(&reached.fit, &reached.gains)),
        fields: reached.map_or_else(Vec::new, |reached| FieldEntry::of_fit(&train, &reached.fit, &reached.deflections)),
        unexplained: unexplained(found.as_ref()),
    };
    let rounding = quantization::rounding(&identification.geometric.arm, &train);
    let mut result = Calibration {
        report,
        information,
        identification,
        beyond: reached.map(|reached| Box::new(reached.fit.clone().into_owned())),
        averaging,
        trace: found,
        curves,
        carried,
        identifiability: identifiable,
        rounding,
        train: Arc::new(train),
        test: test.map(Arc::new),
    };
    describe(&mut result);
    Ok(result)
}

/// The offsets of each coordinate's reading by the mistakes, if these are all zeros that are free.
fn free_zeros(chain: &Chain, corrected: &Corrected, freedom: &Freedom) -> Option<Vec<f64>> {
    let each = corrected.mistakes.iter().map(|mistake| mistake.zeros(chain)).collect::<Option<Vec<_>>>()?;
    let sum = |k: usize| each.iter().map(|zeros| zeros[k]).sum::<f64>();
    let zeros: Vec<f64> = (0..chain.coordinates().len()).map(sum).collect();
    let free = |k: usize| (0..chain.joints().len()).any(|j| freedom.zeros[j] && chain.joints()[j].coordinate == k);
    (0..zeros.len()).all(|k| zeros[k] == 0.0 || free(k)).then_some(zeros)
}

/// The inputs of the search for effects and curves, and prior knowledge.
struct Searched<'a> {
    statics: &'a Statics,
    data: &'a Measurements,
    geometric: &'a Fit<NoEffects>,
    carried: Option<&'a Carried>,
    /// How much an earlier calibration counts.
    weight: Option<f64>,
}

impl Searched<'_> {
    /// Effects, or curves alone, as requested and if the rows are `enough`; in addition to those of an earlier calibration.
    fn run(
        &self,
        options: &CalibrateOptions,
        enough: bool,
        begin: &mut dyn FnMut(Progress) -> Result<(), CalibrateError>,
    ) -> Result<(Option<Trace>, Option<CurveFit>), CalibrateError> {
        let beside = self.carried.map(Carried::beside);
        let statics = beside.as_ref().map_or(self.statics, |beside| &beside.statics);
        let updated = self.carried.map(Carried::geometry);
        let geometric = updated.as_ref().unwrap_or(self.geometric);
        if let Some(options) = options.trace.as_ref().filter(|_| enough) {
            begin(Progress::Effects)?;
            let mut options = TraceOptions { earlier: beside.clone(), ..options.clone() };
            counted(&mut options.identify, self.weight);
            let found = trace(statics, self.data, geometric, &options);
            let curves = found.curves.clone();
            return Ok((Some(found), Some(curves)));
        }
        let Some(options) = options.curves.as_ref().filter(|_| enough) else { return Ok((None, None)) };
        begin(Progress::Curves)?;
        let survey = Survey::of(statics, self.data, Vec::new());
        let start = geometric.with_model(statics, beside.as_ref());
        Ok((None, Some(fit_curves(&survey, self.data, &start, &geometric.arm, options))))
    }
}

/// The average over the possible models, if it predicts left-out postures better than the last stage before.
fn averaging(
    statics: &Statics,
    train: &Measurements,
    identification: &Identification,
    options: &IdentifyOptions,
    (found, before): (Option<&Trace>, Option<&Beyond<'_>>),
) -> Result<Averaging, NotAveraged> {
    let findings = || found.iter().flat_map(|found| &found.findings);
    let causes: Vec<Term> = findings().filter(|finding| finding.named).map(|finding| finding.term.clone()).collect();
    let curves = before.map_or_else(Vec::new, |before| held_curves(&before.fit.effects.curves));
    let named = before.map(|before| Named { fit: &before.fit, curves: &curves });
    averaged(statics, train, identification, options, (&causes, named))
}

/// Curves with the priors of their waves.
fn held_curves(curves: &[Curve]) -> Vec<HeldCurve<'_>> {
    let held = |curve| {
        let variances = Kernel::of(curve).variances(&curve.waves).into_iter().map(|(variance, _)| variance).collect();
        HeldCurve { curve, variances }
    };
    curves.iter().map(held).collect()
}

/// The parts of the report that concern the whole result.
fn describe(result: &mut Calibration) {
    result.report.placements = Some(rows::placements(result.arm(), &result.train.scene));
    let (train, test) = (&result.train, result.test.as_ref());
    result.report.rows = Rows::of(result.fit(), (train, test), result.report.placed_anew.as_ref());
}

/// The components of the noise of the adopted fit, which may have error curves.
fn noise_of(reached: Option<&Beyond<'_>>, geometry: &Fit<NoEffects>, train: &Measurements) -> Option<NoiseModel> {
    let Some(Beyond { fit, own_curves, .. }) = reached else { return noise_model(geometry, train, &[]) };
    noise_model(fit.as_ref(), train, &held_curves(&fit.effects.curves[..*own_curves]))
}

/// The search continues from the earlier calibration as far as the fit before it does.
fn counted(options: &mut IdentifyOptions, weight: Option<f64>) {
    if let (Some(known), Some(weight)) = (&mut options.earlier, weight) {
        known.weight = weight;
    }
}

/// Training and test rows.
fn rows_of(
    data: Measurements,
    test: Option<Measurements>,
    statics: &Statics,
    options: &CalibrateOptions,
) -> Result<(Measurements, Option<Measurements>), CalibrateError> {
    // Only effects and error curves follow the order, and a million rows are large enough without it.
    let in_order = options.trace.is_some() || options.curves.is_some();
    let data = if in_order { with_run_order(data) } else { data };
    let (train, test) = match (test, options.hold_out) {
        (Some(test), _) => {
            let test = if in_order { with_run_order_after(test, &data) } else { test };
            (data, Some(test))
        }
        (None, Some(hold_out)) => split(&data, hold_out)?,
        (None, None) => (data, None),
    };
    tips::check(&train, statics, options)?;
    enough(&train)?;
    if let (Some(test), Some(_)) = (&test, &options.trace) {
        recorded_too(&train, test, |name| has_a_meaning(&train, name))?;
    }
    Ok((train, test))
}

/// Unexplained structure, as an entry of the report.
fn unexplained(found: Option<&Trace>) -> Unexplained {
    let none = || Unexplained { structured: false, p_value: 1.0, places: Vec::new() };
    found.map_or_else(none, |found| Unexplained {
        structured: found.unexplained.structured,
        p_value: found.unexplained.p_value,
        places: found.unexplained.places.clone(),
    })
}

/// Unidentifiable parameters, as entries of the report.
fn unidentifiable(identifiable: &Identifiability, parameters: &[Identified]) -> Vec<Unidentifiable> {
    let entry = |unidentifiable: &UnidentifiableParameter| Unidentifiable {
        parameter: unidentifiable.parameter.clone(),
        joint: unidentifiable.joint.clone(),
        why: unidentifiable.why.clone(),
        held: held(parameters, &unidentifiable.parameter),
    };
    identifiable.unidentifiable.iter().map(entry).collect()
}

/// The joints' parameters of a fit with their intervals, their covariance, and those that are far from the drawing.
fn identified<E>(fit: &Fit<E>) -> (Vec<Identified>, Option<Posterior>, Vec<DrawingDifference>) {
    let difference = fit.layout.difference(&fit.arm, &fit.arm);
    let joints = fit.arm.nominal.joints();
    let of = |index: usize| {
        let parameter = &fit.layout.parameters[index];
        Identified {
            parameter: parameter.name.clone(),
            joint: parameter.kind.joint().map_or_else(String::new, |joint| joints[joint].name.clone()),
            change: difference[index],
            std: fit.deviation(index),
            half_interval_95: fit.half_interval(index, 0.95),
            unit: parameter.unit,
            held_by_prior: fit.held_by_prior(index),
        }
    };
    (fit.layout.joints.clone().map(of).collect(), Posterior::of(fit), drawing_differences(fit))
}

/// The geometric fit's parameters; the posterior stays that of the stage with named causes, with parameters of its own where they differ.
fn of_geometric_stage(
    geometric: &Fit<NoEffects>,
    parameters: Vec<Identified>,
    posterior: Option<Posterior>,
) -> (Vec<Identified>, Option<Posterior>, Vec<DrawingDifference>) {
    let (own, of_own, differs) = identified(geometric);
    if own == parameters {
        return (own, posterior.or(of_own), differs);
    }
    let known = |parameter: Identified| KnownParameter {
        parameter: parameter.parameter,
        change: parameter.change,
        std: parameter.std,
        unit: parameter.unit.into(),
    };
    let posterior =
        posterior.map(|posterior| Posterior { parameters: parameters.into_iter().map(known).collect(), ..posterior });
    (own, posterior, differs)
}

/// What holds a parameter that the data cannot identify.
fn held(parameters: &[Identified], name: &str) -> HeldBy {
    match parameters.iter().find(|parameter| parameter.parameter == name) {
        None => HeldBy::Nominal,
        Some(_) => HeldBy::Prior,
    }
}

/// Whether a column's name states its meaning; columns that effects follow come first.
fn has_a_meaning(data: &Measurements, name: &str) -> bool {
    let of_joint = name.rsplit_once('.').is_some_and(|(joint, _)| data.joints.iter().any(|known| known == joint));
    ["time", "temperature", "payload"].contains(&name) || of_joint
}

/// Every wanted column of the fitted rows that varies must be in the held-out rows.
fn recorded_too(train: &Measurements, test: &Measurements, wanted: impl Fn(&str) -> bool) -> Result<(), TestError> {
    let varies = |values: &[f64]| values.iter().any(|value| *value != values[0]);
    let missing = train
        .covariates
        .iter()
        .find(|column| wanted(&column.name) && varies(&column.values) && test.covariate(&column.name).is_none());
    match missing {
        None => Ok(()),
        Some(column) => Err(TestError::MissingColumn {
            file: test.source.clone(),
            column: column.name.clone(),
            fitted: train.source.clone(),
        }),
    }
}

/// Lines of held-out rows with gross errors.
fn far_off(data: &Measurements, residuals: &[Residual]) -> Vec<usize> {
    let squares: Vec<(usize, [f64; 2])> =
        residuals.iter().map(|r| (r.series, [r.place.norm_squared(), r.turn.norm_squared()])).collect();
    let mut lines: Vec<usize> =
        outside(&data.scene, &squares).into_iter().map(|index| data.lines[residuals[index].row]).collect();
    lines.dedup();
    lines
}

fn split(data: &Measurements, hold_out: HoldOut) -> Result<(Measurements, Option<Measurements>), CalibrateError> {
    let held = (hold_out.share * data.len() as f64).round();
    if !(hold_out.share > 0.0 && hold_out.share < 1.0 && held >= 1.0) {
        return Err(CalibrateError::HoldOutShare(hold_out.share));
    }
    let mut random = ChaCha8Rng::seed_from_u64(hold_out.seed);
    let drawn: Vec<f64> = (0..data.len()).map(|_| random.random::<f64>()).collect();
    // Rows of one posture go together: a fit that has seen the posture is not tested by it.
    let first = data.first_of_posture();
    let mut size = vec![0usize; data.len()];
    for posture in &first {
        size[*posture] += 1;
    }
    let mut order: Vec<usize> = (0..data.len()).filter(|&row| first[row] == row).collect();
    order.sort_by(|a, b| drawn[*a].total_cmp(&drawn[*b]));
    let mut is_test = vec![false; data.len()];
    let mut count = 0;
    for &posture in &order {
        if count as f64 + 0.5 * size[posture] as f64 > held {
            continue;
        }
        count += size[posture];
        is_test[posture] = true;
    }
    let (test, train): (Vec<usize>, Vec<usize>) = (0..data.len()).partition(|&row| is_test[first[row]]);
    if train.is_empty() || test.is_empty() {
        return Err(CalibrateError::HoldOutShare(hold_out.share));
    }
    Ok((data.subset(&train), Some(data.subset(&test))))
}

fn enough(data: &Measurements) -> Result<(), CalibrateError> {
    let needed = diagnosis::needed_to_place(&data.scene);
    let (postures, values) = different(data);
    if values <= needed {
        let (file, rows) = (data.source.clone(), data.len());
        return Err(CalibrateError::TooFewRows { file, rows, postures, values, needed });
    }
    Ok(())
}

/// Both files without redundant rows, and the lines of the latter.
struct Fresh {
    data: Measurements,
    test: Option<Measurements>,
    /// Rows with a late reading.
    stale: Vec<usize>,
    /// Exact copies of other rows.
    copies: Vec<usize>,
    /// Test rows that are copies of other test rows, or of fitted ones.
    test_copies: Vec<usize>,
}

/// Leaves out exact copies and rows whose reading came late.
///
/// # Errors
/// The test has only fitted rows.
fn fresh(data: Measurements, test: Option<Measurements>) -> Result<Fresh, TestError> {
    let without =
        |data: Measurements, copies: &[usize]| if copies.is_empty() { data } else { data.leaving_out(copies) };
    let lines = |data: &Measurements, copies: &[usize]| copies.iter().map(|&row| data.lines[row]).collect::<Vec<_>>();
    let (mut test_copies, mut left) = (Vec::new(), None);
    if let Some(test) = test {
        let found = test.copies(Some(&data));
        if found.len() == test.len() {
            return Err(TestError::SameRows { file: test.source, fitted: data.source });
        }
        test_copies = lines(&test, &found);
        left = Some(without(test, &found));
    }
    let found = data.copies(None);
    let copies = lines(&data, &found);
    let (data, mut stale) = without_stale_rows(without(data, &found));
    let test = left.map(|test| {
        let (test, more) = without_stale_rows(test);
        stale.extend(more);
        test
    });
    Ok(Fresh { data, test, stale, copies, test_copies })
}

/// Whether a row has the measured values of the row before, digit for digit, although a joint moved.
fn repeats_the_row_before(data: &Measurements, row: usize) -> bool {
    let values = |row: usize| -> Vec<f64> {
        data.of_row(row).flat_map(|observation| data.observed.values(observation).to_vec()).collect()
    };
    if row == 0 {
        return false;
    }
    let (before, here) = (values(row - 1), values(row));
    let moved = data.reading(row - 1).iter().zip(data.reading(row)).any(|(a, b)| (a - b).abs() > MOVED);
    moved && here.len() >= 3 && before == here && !data.locate[row]
}

/// The rows without those that repeat the measured values of the row before, digit for digit, although a joint moved: the
/// instrument's reading is then that of the posture before. Also the lines of those rows.
///
/// A single number may repeat by chance: only rows of three and more are examined.
fn without_stale_rows(data: Measurements) -> (Measurements, Vec<usize>) {
    let (stale, kept): (Vec<usize>, Vec<usize>) = (0..data.len()).partition(|&row| repeats_the_row_before(&data, row));
    // If many rows repeat, that is the way the file is written, not a late reading.
    if stale.is_empty() || 20 * stale.len() > data.len() {
        return (data, Vec::new());
    }
    let lines = stale.iter().map(|&row| data.lines[row]).collect();
    (data.subset(&kept), lines)
}

/// Lines of the rows with a rejected value.
fn rejected(data: &Measurements, weights: &[f64]) -> Vec<usize> {
    let out = |row: &usize| data.of_row(*row).any(|observation| weights[observation] == 0.0);
    (0..data.len()).filter(out).map(|row| data.lines[row]).collect()
}

/// The effects that are named, or those that are not.
fn entries(found: Option<&Trace>, named: bool, chain: &Chain) -> Vec<EffectEntry> {
    let findings = found.iter().flat_map(|found| &found.findings);
    findings.filter(|finding| finding.named == named).map(|finding| entry(finding, chain)).collect()
}

fn entry(finding: &Finding, chain: &Chain) -> EffectEntry {
    let joint = finding.term.carrier.joint().map(|_| finding.place.clone());
    let place = joint.is_none().then(|| finding.place.clone());
    let mut parameters = Map::new();
    for value in &finding.values {
        let mut number = Map::new();
        number.insert("value".into(), json!(value.value));
        number.insert("std".into(), json!(value.std));
        number.insert("unit".into(), json!(value.unit));
        parameters.insert(value.name.clone(), Value::Object(number));
    }
    EffectEntry {
        kind: finding.term.kind.name().into(),
        joint,
        place,
        covariate: finding.term.driver.covariate().map(String::from),
        parameters,
        p_value: finding.p_value,
        delta_bic: finding.delta_bic,
        probability: finding.probability,
        found_again: finding.found_again,
        driven_by: finding.driven_by().map(|driver| chain.joints()[driver].name.clone()),
        ambiguous_with: finding
            .rivals
            .iter()
            .map(|rival| Rival {
                kind: rival.kind.name().into(),
                joint: rival.place.clone(),
                probability: rival.probability,
            })
            .collect(),
    }
}
