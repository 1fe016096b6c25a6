//! A measurement run before it is made: which poses to measure, and simulated results.

#![expect(clippy::needless_pass_by_value, reason = "what Python calls with is handed over by value")]

use crate::chain::Chain;
use crate::errors::{argument, measured};
use crate::measured::{Fit, kind, prior_file};
use crate::robot::reading;
use denavit_calibrate::apply::plan::{PlanOptions, plan as planned};
use denavit_identify::effects::SavedEffects;
use denavit_identify::simulate::effect_specification::EffectSpecification;
use denavit_identify::simulate::files::{FilesAsked, FilesError, files};
use denavit_identify::simulate::{SimulationOptions, TRIES, commanded_readings};
use denavit_load::measured::{corners, earlier, moving, sight};
use denavit_measurements::Units;
use denavit_measurements::kinds::ObservationKind;
use numpy::{PyArray1, PyArray2, PyArrayMethods as _, PyReadonlyArray2, PyUntypedArrayMethods as _};
use pyo3::prelude::*;

/// Joint values row by row; refused where they are not of this chain.
pub fn joint_rows(
    name: &str,
    array: &PyReadonlyArray2<'_, f64>,
    chain: &denavit_model::Chain,
) -> PyResult<Vec<Vec<f64>>> {
    let (width, expected) = (array.shape()[1], chain.coordinates().len());
    if width != expected || array.shape()[0] == 0 {
        let [rows, columns] = [array.shape()[0], width];
        return Err(argument(format!(
            "{name} has shape ({rows}, {columns}); write one row or more of {expected} joint values each"
        )));
    }
    let values = array.as_slice().map_err(|failure| argument(format!("{name}: {failure}")))?;
    if let Some(at) = values.iter().position(|value| !value.is_finite()) {
        return Err(argument(format!(
            "{name}[{}, {}] is {}; write a finite number",
            at / width,
            at % width,
            values[at]
        )));
    }
    Ok(values.chunks(width).map(<[f64]>::to_vec).collect())
}

fn finite(name: &str, values: &[f64]) -> PyResult<()> {
    let good = values.iter().all(|value| value.is_finite());
    if good { Ok(()) } else { Err(argument(format!("{name}: {values:?}; write finite numbers"))) }
}

fn spreads(name: &str, pair: (f64, f64)) -> PyResult<[f64; 2]> {
    let good = [pair.0, pair.1].iter().all(|value| value.is_finite() && *value >= 0.0);
    let wrong = || argument(format!("{name} is {pair:?}; write two numbers of 0 or more, m and rad"));
    if good { Ok(pair.into()) } else { Err(wrong()) }
}

/// At least one, and no more than fit into memory by a mistake.
fn count(name: &str, value: usize) -> PyResult<usize> {
    let wrong = || argument(format!("{name} is {value}; write a number from 1 to 1000000"));
    if (1..=1_000_000).contains(&value) { Ok(value) } else { Err(wrong()) }
}

/// JSON, CSV and text of `denavit plan`, and the poses.
type PlanMade<'py> = (String, String, String, Bound<'py, PyArray2<f64>>);

/// Poses to measure.
#[pyfunction]
#[pyo3(signature = (chain, wanted, measure, candidates, spread, r#box, target, anchor, prior, seed))]
#[expect(clippy::too_many_arguments, reason = "each is a keyword of the Python function")]
pub fn plan<'py>(
    py: Python<'py>,
    chain: &Chain,
    wanted: usize,
    measure: &str,
    candidates: Option<PyReadonlyArray2<'_, f64>>,
    spread: usize,
    r#box: Vec<f64>,
    target: [f64; 3],
    anchor: Option<[f64; 3]>,
    prior: Option<(String, String)>,
    seed: u64,
) -> PyResult<PlanMade<'py>> {
    let nominal = &chain.chain;
    moving(&chain.file, nominal).map_err(|failure| measured(&failure))?;
    let kind = kind(measure)?;
    finite("target", &target)?;
    finite("anchor", anchor.as_ref().map_or(&[], |anchor| anchor))?;
    let known = prior.map(prior_file).map(|file| earlier(&file, nominal)).transpose();
    let usual = PlanOptions::new(nominal, count("count", wanted)?, kind);
    let options = PlanOptions {
        candidates: candidates.map(|array| joint_rows("candidates", &array, nominal)).transpose()?,
        spread: count("spread", spread)?,
        allowed: corners(&r#box).map_err(|failure| measured(&failure))?,
        target: target.into(),
        anchor: anchor.map_or(usual.anchor, Into::into),
        earlier: known.map_err(|failure| measured(&failure))?,
        seed,
        ..usual
    };
    let found = py.detach(|| planned(nominal, &options)).map_err(|failure| argument(failure.to_string()))?;
    let poses = PyArray1::from_iter(py, found.poses.iter().flatten().copied());
    let poses = poses.reshape([found.poses.len(), nominal.coordinates().len()])?;
    Ok((found.to_json(nominal, kind), found.to_csv(nominal, Units::default()), found.to_text(), poses))
}

/// The same of poses that distinguish causes: `denavit plan --tell-apart`.
#[pyfunction]
#[pyo3(signature = (fit, wanted, candidates, spread, r#box, seed))]
pub fn tell_apart<'py>(
    py: Python<'py>,
    fit: &Fit,
    wanted: usize,
    candidates: Option<PyReadonlyArray2<'_, f64>>,
    spread: usize,
    r#box: Vec<f64>,
    seed: u64,
) -> PyResult<PlanMade<'py>> {
    let (result, statics) = fit.result();
    let nominal = &result.arm().nominal;
    let options = PlanOptions {
        candidates: candidates.map(|array| joint_rows("candidates", &array, nominal)).transpose()?,
        spread: count("spread", spread)?,
        allowed: corners(&r#box).map_err(|failure| measured(&failure))?,
        seed,
        ..PlanOptions::new(nominal, count("count", wanted)?, ObservationKind::Position)
    };
    let found = py.detach(|| result.tell_apart(statics, &options));
    let found = found.map_err(|failure| argument(failure.to_string()))?;
    let poses = PyArray1::from_iter(py, found.poses.iter().flatten().copied());
    let poses = poses.reshape([found.poses.len(), nominal.coordinates().len()])?;
    Ok((found.to_json(nominal), found.to_csv(nominal, Units::default()), found.to_text(), poses))
}

/// Files of a simulated run: rows to fit, rows measured later, and the true values.
#[pyfunction]
#[pyo3(signature = (chain, rows, test_rows, measure, targets, seed, geometry_error, noise, outliers, effects, saved, columns, q, camera, board, on_hand, pixel_noise, sight_noise, repeatability))]
#[expect(clippy::too_many_arguments, reason = "each is a keyword of the Python function")]
pub fn simulate(
    py: Python<'_>,
    chain: &Chain,
    rows: usize,
    test_rows: Option<usize>,
    measure: &str,
    targets: usize,
    seed: u64,
    geometry_error: (f64, f64),
    noise: (f64, f64),
    outliers: f64,
    effects: Vec<String>,
    saved: Option<String>,
    columns: Vec<String>,
    q: Option<PyReadonlyArray2<'_, f64>>,
    camera: Option<(String, String)>,
    board: Option<String>,
    on_hand: bool,
    pixel_noise: f64,
    sight_noise: (f64, f64),
    repeatability: Vec<f64>,
) -> PyResult<(String, Option<String>, String)> {
    let nominal = &chain.chain;
    moving(&chain.file, nominal).map_err(|failure| measured(&failure))?;
    let [shift, turn] = spreads("geometry_error", geometry_error)?;
    let [noise_position, noise_orientation] = spreads("noise", noise)?;
    let [noise_range, noise_angle] = spreads("(range_noise, angle_noise)", sight_noise)?;
    if let Some(size) = repeatability.iter().find(|size| !(size.is_finite() && **size >= 0.0)) {
        return Err(argument(format!("repeatability is {size}; write numbers of 0 or more, rad, and m for slides")));
    }
    if !(0.0..=1.0).contains(&outliers) {
        return Err(argument(format!("outliers is {outliers}; it is a fraction of the rows, write 0 to 1")));
    }
    if !(pixel_noise.is_finite() && pixel_noise >= 0.0) {
        return Err(argument(format!("pixel_noise is {pixel_noise}; write a number of 0 or more, px")));
    }
    let camera = camera.map(|(file, text)| sight(&file, &text, board.as_deref(), on_hand));
    let camera = camera.transpose().map_err(|failure| measured(&failure))?;
    if camera.as_ref().is_some_and(|sight| sight.board.is_none()) {
        return Err(argument("a camera needs a board; give its squares as board, such as \"7x5:30mm\""));
    }
    let kind = if camera.is_some() { ObservationKind::Pixel } else { kind(measure)? };
    let rows = if q.is_some() { rows } else { count("rows", rows)? };
    let tries = if kind.of_a_board() { TRIES } else { 1 };
    let readings = match &q {
        Some(array) => joint_rows("q", array, nominal)?,
        None => commanded_readings(nominal, rows * tries, seed),
    };
    let options = SimulationOptions {
        kind,
        rows: if q.is_some() { readings.len() } else { rows },
        sight: camera,
        noise_pixel: pixel_noise,
        targets: count("targets", targets)?,
        seed,
        turn,
        shift,
        noise_position,
        noise_orientation,
        noise_range,
        noise_angle,
        // Nothing is drawn where every joint comes back.
        repeatability: if repeatability.iter().all(|size| *size == 0.0) { Vec::new() } else { repeatability },
        outliers,
        covariates: Vec::new(),
        readings: Some(readings),
        tips: None,
        before: None,
    };
    let specifications = effects.iter().map(|text| text.parse::<EffectSpecification>()).collect::<Result<Vec<_>, _>>();
    let specifications = specifications.map_err(|failure| argument(format!("effects: {failure}")))?;
    let test_rows = test_rows.map(|rows| count("test_rows", rows)).transpose()?;
    let asked = FilesAsked { options, specifications, columns, test_rows, truth: true };
    let statics = chain.loaded.statics(nominal, reading(chain.exact));
    let model = match saved {
        None => SavedEffects::none(statics.clone()),
        Some(text) => SavedEffects::from_json("effects", &text, &statics).map_err(|f| argument(f.to_string()))?,
    };
    let made = py.detach(|| files(nominal, &statics, model, &asked)).map_err(|failure| {
        argument(match failure {
            FilesError::Effect(failure) => format!("effects: {failure}"),
            FilesError::Column(failure) => format!("columns: {failure}"),
            FilesError::OutOfSight { .. } => format!("camera: {failure}"),
            FilesError::Targets(count) => format!("targets is {count}; {failure}"),
            other => format!("effects: {other}"),
        })
    })?;
    Ok((made.data, made.test, made.truth.unwrap_or_default()))
}
