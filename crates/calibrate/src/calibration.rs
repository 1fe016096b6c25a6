//! The whole of a calibration: stages on training rows, errors on rows that no stage saw, effects, the report.

use crate::arm::Arm;
use crate::effects::driver::Statics;
use crate::effects::model::EffectModel;
use crate::effects::survey::{with_run_order, with_run_order_after};
use crate::errors::{Errors, Residual, TestError, errors, placed, residuals};
use crate::grid::{self, Rounding};
use crate::identifiability::{Identifiability, identifiability};
use crate::identify::{Identification, IdentifyOptions, identify};
use crate::measurements::Measurements;
use crate::parameters::{Effects, NoEffects};
use crate::report::contract::{
    CalibrationReport, Counts, EffectEntry, Rival, SCHEMA, Samples, Stage, Unexplained, Unidentifiable,
};
use crate::solve::Fit;
use crate::trace::{Finding, Trace, TraceOptions, trace};
use denavit_model::Chain;
use denavit_model::nalgebra::Point3;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use serde_json::{Map, Value, json};
use thiserror::Error;

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
}

impl CalibrateOptions {
    /// Geometry alone, every axis, nothing held out.
    pub fn geometry(chain: &Chain) -> Self {
        Self { identify: IdentifyOptions::axes(chain), hold_out: None, trace: None }
    }
}

/// Why data give no calibration.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum CalibrateError {
    /// Not enough to place the instrument.
    #[error(
        "{file}: {rows} rows hold {values} measured numbers, but placing the instrument and the targets takes {needed} \
         and a few to check them; measure more poses"
    )]
    TooFewRows {
        /// The file.
        file: String,
        /// Its rows.
        rows: usize,
        /// Numbers measured.
        values: usize,
        /// Numbers to find before any geometry.
        needed: usize,
    },
    /// The nominal robot is metres away from what was measured.
    #[error(
        "{file}: the robot as drawn misses what was measured by {left:.3} m rms, wherever the instrument stands \
         (its reach is {reach:.3} m); are the joints in the right columns, the readings in rad (else --units deg), the \
         lengths in m (else --units mm), and --base and --tip right?"
    )]
    Misfit {
        /// The file.
        file: String,
        /// Root mean square, m.
        left: f64,
        /// m.
        reach: f64,
    },
    /// A share that holds out nothing or everything.
    #[error("--hold-out {0}: it is the share of rows to keep for the test, between 0 and 1, and both parts need rows")]
    HoldOutShare(f64),
    /// The test file does not fit the fit.
    #[error(transparent)]
    Test(#[from] TestError),
}

/// Residuals of one stage.
#[derive(Debug, Clone, PartialEq)]
pub struct StageResiduals {
    /// The stage.
    pub name: String,
    /// Of the fitted rows that were kept.
    pub train: Vec<Residual>,
    /// Of the held-out rows.
    pub test: Vec<Residual>,
}

/// A calibration's result.
#[derive(Debug, Clone)]
pub struct Calibration {
    /// The contract.
    pub report: CalibrationReport,
    /// Nominal and geometric fit.
    pub identification: Identification,
    /// What the tracer found, if it was asked.
    pub trace: Option<Trace>,
    /// Counts, and what is untold.
    pub identifiability: Identifiability,
    /// Rounded readings, where there are any.
    pub rounding: Option<Rounding>,
    /// The rows fitted.
    pub train: Measurements,
    /// The rows held out.
    pub test: Option<Measurements>,
    /// Residuals, stage by stage.
    pub residuals: Vec<StageResiduals>,
}

impl Calibration {
    /// The arm at the last stage.
    pub fn arm(&self) -> &Arm {
        self.trace.as_ref().map_or(&self.identification.geometric.arm, |trace| &trace.fit.arm)
    }

    /// The effects at the last stage; none where none was looked for.
    pub fn effects(&self, statics: &Statics) -> EffectModel {
        let none = || EffectModel::new(statics.clone(), Vec::new());
        self.trace.as_ref().map_or_else(none, |trace| trace.fit.effects.clone())
    }
}

/// What a calibration is at.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Progress {
    /// Instrument, targets, axes.
    Geometry,
    /// The search for effects.
    Effects,
    /// Errors of every stage, what the data can tell.
    Judgement,
}

/// Residual of the nominal robot beyond which something else is wrong than geometry, relative to its reach.
const MISFIT: f64 = 0.15;

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
    calibrate_and_tell(chain, statics, data, test, options, &mut |_| {})
}

/// As [`calibrate`], and tells what it starts with.
///
/// # Errors
/// As [`calibrate`].
pub fn calibrate_and_tell(
    chain: &Chain,
    statics: &Statics,
    data: Measurements,
    test: Option<Measurements>,
    options: &CalibrateOptions,
    progress: &mut dyn FnMut(Progress),
) -> Result<Calibration, CalibrateError> {
    let data = with_run_order(data);
    let (train, test) = match (test, options.hold_out) {
        (Some(test), _) => {
            let test = with_run_order_after(test, &data);
            (data, Some(test))
        }
        (None, Some(hold_out)) => split(&data, hold_out)?,
        (None, None) => (data, None),
    };
    enough(&train)?;
    progress(Progress::Geometry);
    let identification = identify(chain, &train, &options.identify);
    fits(chain, &train, &identification)?;
    let found = options.trace.as_ref().map(|options| {
        progress(Progress::Effects);
        trace(statics, &train, &identification.geometric, options)
    });
    progress(Progress::Judgement);
    let mut stages = Stages { train: &train, test: test.as_ref(), done: Vec::new(), residuals: Vec::new() };
    stages.add("nominal".into(), &identification.nominal)?;
    stages.add("geometric".into(), &identification.geometric)?;
    if let Some(found) = &found {
        for (name, fit) in trace_stages(found) {
            stages.add(name, fit)?;
        }
    }
    let (stages, residuals) = (stages.done, stages.residuals);
    let told = identifiability(&train, &identification.geometric.arm, &NoEffects, &options.identify.freedom);
    let weights = found.as_ref().map_or(&identification.geometric.weights, |found| &found.fit.weights);
    let report = CalibrationReport {
        schema: SCHEMA,
        robot: chain.name().into(),
        base: chain.base().into(),
        tip: chain.tip().into(),
        measurement: train.scene.measured(),
        samples: Samples {
            train: train.len(),
            test: test.as_ref().map_or(0, |test| test.locate.iter().filter(|locate| !**locate).count()),
            rejected: rejected(&train, weights),
        },
        identifiability: Counts { expected: told.expected, rank: told.rank },
        unidentifiable: told
            .untold
            .iter()
            .map(|untold| Unidentifiable {
                parameter: untold.parameter.clone(),
                joint: untold.joint.clone(),
                why: untold.why.clone(),
            })
            .collect(),
        stages,
        effects: found.as_ref().map_or_else(Vec::new, |found| found.findings.iter().map(entry).collect()),
        unexplained: found.as_ref().map_or(
            Unexplained { structured: false, p_value: 1.0, places: Vec::new() },
            |found| Unexplained {
                structured: found.leftover.structured,
                p_value: found.leftover.p_value,
                places: found.leftover.places.clone(),
            },
        ),
    };
    let rounding = grid::rounding(&identification.geometric.arm, &train);
    Ok(Calibration { report, identification, trace: found, identifiability: told, rounding, train, test, residuals })
}

fn split(data: &Measurements, hold_out: HoldOut) -> Result<(Measurements, Option<Measurements>), CalibrateError> {
    let held = (hold_out.share * data.len() as f64).round();
    if !(hold_out.share > 0.0 && hold_out.share < 1.0 && held >= 1.0) {
        return Err(CalibrateError::HoldOutShare(hold_out.share));
    }
    let mut random = ChaCha8Rng::seed_from_u64(hold_out.seed);
    let mut order: Vec<(f64, usize)> = (0..data.len()).map(|row| (random.random::<f64>(), row)).collect();
    order.sort_by(|a, b| a.0.total_cmp(&b.0));
    let count = (0..data.len()).take_while(|&k| (k as f64) + 0.5 <= held).count();
    let mut test: Vec<usize> = order[..count].iter().map(|(_, row)| *row).collect();
    let mut train: Vec<usize> = order[count..].iter().map(|(_, row)| *row).collect();
    if train.is_empty() {
        return Err(CalibrateError::HoldOutShare(hold_out.share));
    }
    test.sort_unstable();
    train.sort_unstable();
    Ok((data.subset(&train), Some(data.subset(&test))))
}

fn enough(data: &Measurements) -> Result<(), CalibrateError> {
    let scene = &data.scene;
    let turns = (0..scene.targets.len()).filter(|&target| scene.turns(target)).count();
    let instruments = (0..scene.setups.len()).filter(|&setup| scene.has_instrument(setup)).count();
    let needed = 6 * instruments + 3 * (scene.points.len() + scene.targets.len() + turns);
    let values = data.values();
    if values <= needed {
        return Err(CalibrateError::TooFewRows { file: data.source.clone(), rows: data.len(), values, needed });
    }
    Ok(())
}

fn fits(chain: &Chain, data: &Measurements, found: &Identification) -> Result<(), CalibrateError> {
    let reach = chain.reach_beyond(0, &Point3::origin());
    let left = found.nominal.noise.first();
    if left > MISFIT * reach {
        return Err(CalibrateError::Misfit { file: data.source.clone(), left, reach });
    }
    Ok(())
}

struct Stages<'a> {
    train: &'a Measurements,
    test: Option<&'a Measurements>,
    done: Vec<Stage>,
    residuals: Vec<StageResiduals>,
}

impl Stages<'_> {
    fn add<E: Effects>(&mut self, name: String, fit: &Fit<E>) -> Result<(), TestError> {
        let mut train = residuals(&fit.arm, &fit.effects, self.train);
        train.retain(|residual| fit.weights[residual.observation] > 0.0);
        let mut held_out = Vec::new();
        let mut test_errors: Option<Errors> = None;
        if let Some(test) = self.test {
            let arm = placed(fit, self.train, test)?;
            held_out = residuals(&arm, &fit.effects, test);
            test_errors = Some(errors(&held_out, &test.scene));
        }
        self.done.push(Stage { name: name.clone(), train: errors(&train, &self.train.scene), test: test_errors });
        self.residuals.push(StageResiduals { name, train, test: held_out });
        Ok(())
    }
}

/// Lines of the rows with a rejected value.
fn rejected(data: &Measurements, weights: &[f64]) -> Vec<usize> {
    let out = |row: &usize| data.of_row(*row).any(|observation| weights[observation] == 0.0);
    (0..data.len()).filter(out).map(|row| data.lines[row]).collect()
}

/// Stages of the tracer by what each added; the last one is what it settled on.
fn trace_stages(found: &Trace) -> Vec<(String, &Fit<EffectModel>)> {
    let chain = &found.fit.arm.nominal;
    let name = |fit: &Fit<EffectModel>| {
        let terms = fit
            .effects
            .effects
            .iter()
            .map(|effect| format!(" + {}({})", effect.term.kind.name(), effect.term.carrier.place(chain)));
        format!("geometric{}", terms.collect::<String>())
    };
    let mut stages: Vec<_> = found.stages.iter().map(|fit| (name(fit), fit)).collect();
    if !found.fit.effects.effects.is_empty() && stages.last().is_none_or(|(last, _)| *last != name(&found.fit)) {
        stages.push((name(&found.fit), &found.fit));
    }
    stages
}

fn entry(finding: &Finding) -> EffectEntry {
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
        ambiguous_with: finding
            .ambiguous_with
            .iter()
            .map(|(kind, joint)| Rival { kind: kind.name().into(), joint: joint.clone() })
            .collect(),
    }
}
