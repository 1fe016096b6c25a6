//! Calibration and its results.

use crate::chain::Chain;
use crate::errors::{Class, Spot, broken, calibration, error, load, measured, said};
use crate::given_file::Given;
use crate::interruptible::{Tell, interruptible};
use crate::robot::reading;
use denavit_calibrate::calibration::{
    CalibrateError, CalibrateOptions, Calibration, HoldOut, Progress, calibrate_and_tell,
};
use denavit_calibrate::report::{html, text};
use denavit_export::{poe, urdf};
use denavit_identify::effects::driver::Statics;
use denavit_identify::residual_statistics::Residual;
use denavit_linear::stop::Stop;
use denavit_load::measured::{DataFile, Rows, RowsAsked, SearchAsked, moving, other_chains, prior_read, rows, search};
use denavit_load::{Loaded, Selection};
use denavit_measurements::Measurements;
use denavit_measurements::kinds::KINDS;
use denavit_measurements::kinds::ObservationKind;
use denavit_model::Tips;
use denavit_model::nalgebra::Vector3;
use numpy::{PyArray1, PyArray2, PyArrayMethods as _};
use pyo3::prelude::*;
use std::sync::Arc;

/// Training and test data.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct RowsGiven {
    data: Vec<Given>,
    sockets: Vec<(String, Given)>,
    distances: Vec<String>,
    test: Option<Given>,
    hold_out_setups: Vec<String>,
    tips: Vec<String>,
}

/// What is looked for.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct SearchGiven {
    scales: Vec<String>,
    pitches: Vec<String>,
    zeros: Vec<String>,
    effects: Vec<String>,
    max_effects: Option<usize>,
    mass: Option<f64>,
    gear_ratios: Vec<String>,
    prior: Option<(String, String)>,
    hold_out: Option<f64>,
    seed: u64,
}

/// The kind of measurement for a word.
pub fn kind(word: &str) -> PyResult<ObservationKind> {
    let measured = || KINDS.iter().filter(|kind| ["poses", "positions", "distances"].contains(&kind.plural()));
    let known = || measured().map(|kind| kind.plural()).collect::<Vec<_>>().join(", ");
    measured().find(|kind| kind.plural() == word).copied().ok_or_else(|| {
        error(Class::Argument, &format!("measure is \"{word}\"; write one of {}", known()), Spot::default())
    })
}

/// Index of each row, lengths (k, 3), turns (k, 3).
type Residuals<'py> = (Bound<'py, PyArray1<usize>>, Bound<'py, PyArray2<f64>>, Bound<'py, PyArray2<f64>>);

fn arrays<'py>(py: Python<'py>, residuals: &[Residual]) -> PyResult<Residuals<'py>> {
    let vectors = |of: fn(&Residual) -> Vector3<f64>| {
        let numbers = residuals.iter().flat_map(|residual| <[f64; 3]>::from(of(residual)));
        PyArray1::from_iter(py, numbers).reshape([residuals.len(), 3])
    };
    let rows = PyArray1::from_iter(py, residuals.iter().map(|residual| residual.row));
    Ok((rows, vectors(|residual| residual.place)?, vectors(|residual| residual.turn)?))
}

/// A calibration's result.
#[pyclass(frozen, module = "denavit._denavit")]
pub struct Fit {
    result: Calibration,
    chain: denavit_model::Chain,
    tips: Arc<Tips>,
    tip: String,
    statics: Statics,
    loaded: Arc<Loaded>,
    exact: bool,
    #[pyo3(get)]
    notes: Vec<String>,
}

impl Fit {
    /// The calibration, and what gravity acts on.
    pub fn result(&self) -> (&Calibration, &Statics) {
        (&self.result, &self.statics)
    }
}

#[pymethods]
impl Fit {
    /// The contract of `denavit calibrate --json`.
    fn json(&self) -> String {
        self.result.report.to_json() + "\n"
    }

    /// What `denavit calibrate` prints.
    fn text(&self) -> String {
        said(text::report(&self.result))
    }

    /// The page with plots.
    fn html(&self, py: Python<'_>) -> PyResult<String> {
        let page = py.detach(|| html::page(&self.result));
        page.map_err(|failure| error(Class::Export, &failure.to_string(), Spot::default()))
    }

    /// The calibrated URDF, the name of its tip and its notes; `None` where the source is not a tree.
    fn urdf(&self) -> PyResult<Option<(String, String, Vec<String>)>> {
        let Loaded::Robot(tree) = &*self.loaded else { return Ok(None) };
        let arm = self.result.arm();
        let calibrated: Vec<_> = (0..arm.tips.all().len()).map(|tip| arm.chain_to(tip)).collect();
        let written = urdf::with_chains(tree, &calibrated, reading(self.exact));
        let written = written.map_err(|failure| error(Class::Export, &failure.to_string(), Spot::default()))?;
        let again = denavit_model::urdf::read("the calibrated URDF", &written.value);
        let again = again.map_err(|failure| broken(&failure.to_string()))?;
        let moved = format!("{}_calibrated", self.tip);
        let has = |robot: &denavit_model::Robot| robot.links.iter().any(|link| link.name == moved);
        let tip = (has(&again) && !has(tree)).then_some(moved);
        let notes = written.notes.iter().map(said).collect();
        Ok(Some((written.value, tip.unwrap_or_else(|| self.tip.clone()), notes)))
    }

    /// The calibrated screw axes as JSON.
    fn poe(&self) -> String {
        poe::json(&self.result.arm().chain_to(0), &[])
    }

    /// The effects as JSON, as `denavit calibrate --effects-out` writes them; of several tips those of the chain's.
    fn effects(&self) -> String {
        self.result.effects(&self.statics).to_tip(self.tips.position(&self.tip).unwrap_or(0)).to_json()
    }

    /// Each stage: name, residuals on the fitted rows that were kept, residuals on the held-out rows.
    fn residuals<'py>(&self, py: Python<'py>) -> PyResult<Vec<(String, Residuals<'py>, Residuals<'py>)>> {
        let stage = |stage: &denavit_calibrate::calibration::StageResiduals| {
            Ok((stage.name.clone(), arrays(py, &stage.train)?, arrays(py, &stage.test)?))
        };
        self.result.residuals().iter().map(stage).collect()
    }

    /// Errors of the adopted model on rows measured later, as JSON, and their residuals.
    fn predict<'py>(&self, py: Python<'py>, later: Given) -> PyResult<(String, Residuals<'py>)> {
        let name = later.name.clone();
        let asked = RowsAsked { data: vec![of_tips(later.file()?, &self.tips)], ..RowsAsked::default() };
        let found = rows(&asked, &self.chain).map_err(|failure| measured(&failure))?;
        let found = py.detach(|| self.result.predict(found.data));
        let found = found.map_err(|failure| calibration(&failure.to_string(), &name))?;
        let json = serde_json::to_string(&found.errors).map_err(|failure| broken(&failure.to_string()))?;
        Ok((json, arrays(py, &found.residuals)?))
    }
}

/// From measured data to a calibrated model; `progress` is called with the current step.
#[pyfunction]
#[pyo3(signature = (chain, rows, search, progress))]
pub fn calibrate(
    py: Python<'_>,
    chain: &Chain,
    rows: RowsGiven,
    search: SearchGiven,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<Fit> {
    let tips = rows.tips.clone();
    let (nominal, tips) = tree(chain, &tips)?;
    let nominal = &nominal;
    moving(&chain.file, nominal).map_err(|failure| measured(&failure))?;
    let hold_out = search.hold_out.map(|share| HoldOut { share, seed: search.seed });
    let asked = SearchAsked {
        scales: search.scales,
        pitches: search.pitches,
        zeros: search.zeros,
        effects: search.effects,
        max_effects: search.max_effects,
        mass: search.mass,
        gear_ratios: search.gear_ratios,
        prior: search.prior.map(prior_file),
        hold_out,
    };
    let prior = prior_read(&asked).map_err(|failure| measured(&failure))?;
    if tips.several() && !rows.sockets.is_empty() {
        let message = "socket: its rows do not name their tip; calibrate one tip at a time";
        return Err(error(Class::Argument, message, Spot::default()));
    }
    let mut options = self::search(&asked, nominal).map_err(|failure| measured(&failure))?;
    let file = rows.data.first().map_or_else(String::new, |given| given.name.clone());
    let asked = RowsAsked {
        data: rows.data.into_iter().map(|given| Ok(of_tips(given.file()?, &tips))).collect::<PyResult<_>>()?,
        sockets: rows.sockets.into_iter().map(|(label, given)| Ok((label, given.file()?))).collect::<PyResult<_>>()?,
        distances: rows.distances,
        test: rows.test.map(|given| Ok::<_, PyErr>(of_tips(given.file()?, &tips))).transpose()?,
        hold_out_setups: rows.hold_out_setups,
    };
    let read = py.detach(|| self::rows(&asked, nominal));
    let Rows { data, test, columns, notes, origin } = read.map_err(|failure| measured(&failure))?;
    if !tips.several() {
        options.other_chains = other_chains(&chain.loaded, nominal, &data);
    }
    let statics = chain.loaded.statics_to(nominal, &tips, reading(chain.exact));
    let result = fitted(py, Work { chain: nominal.clone(), statics: statics.clone(), data, test, options }, progress)?;
    let mut result = result.map_err(|failure| calibration(&failure.to_string(), &file))?;
    result.report.columns = columns;
    result.report.origin = origin;
    result.report.origin.files.extend(prior);
    let (tip, loaded, exact) = (chain.chain.tip().to_owned(), Arc::clone(&chain.loaded), chain.exact);
    Ok(Fit {
        result,
        chain: nominal.clone(),
        tips,
        tip,
        statics,
        loaded,
        exact,
        notes: notes.iter().map(said).collect(),
    })
}

/// The joints on the ways from the chain's base to these tips; to its own where none is named.
fn tree(chain: &Chain, tips: &[String]) -> PyResult<(denavit_model::Chain, Arc<Tips>)> {
    if tips.is_empty() {
        return Ok((chain.chain.clone(), Arc::new(Tips::only(&chain.chain))));
    }
    if !tips.iter().any(|tip| tip == chain.chain.tip()) {
        let message = format!("tips: the chain ends at \"{}\"; name it among them", chain.chain.tip());
        return Err(error(Class::Argument, &message, Spot::default()));
    }
    let base = Some(chain.chain.base());
    let selection = Selection { file: &chain.file, base, tip: None, reading: reading(chain.exact) };
    let joined = chain.loaded.chain_to(&selection, tips).map_err(|failure| load(&failure))?;
    Ok((joined.value.0, Arc::new(joined.value.1)))
}

/// The file, its column `tip` read where there are several.
fn of_tips(mut file: DataFile, tips: &Arc<Tips>) -> DataFile {
    file.import.tips = tips.several().then(|| tips.clone());
    file
}

/// An earlier calibration: what to call it, and its JSON.
pub fn prior_file((name, text): (String, String)) -> DataFile {
    DataFile { name, content: text.into(), ..DataFile::default() }
}

/// The inputs of a calibration.
struct Work {
    chain: denavit_model::Chain,
    statics: Statics,
    data: Measurements,
    test: Option<Measurements>,
    options: CalibrateOptions,
}

/// Fits; a fit that nobody waits for any more is asked to stop, which it does within some hundredths of a second.
fn fitted(
    py: Python<'_>,
    work: Work,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<Result<Calibration, CalibrateError>> {
    let stop = Stop::default();
    let asked = stop.clone();
    let fit = move |tell: &Tell<Progress>| {
        let Work { chain, statics, data, test, options } = work;
        let fit = || calibrate_and_tell(&chain, &statics, data, test, &options, &mut |stage| tell(stage));
        asked.unless_asked(fit).unwrap_or(Err(CalibrateError::Stopped))
    };
    interruptible(py, &stop, fit, |stage| progress.map_or(Ok(()), |progress| progress.call1((words(stage),)).map(drop)))
}

fn words(stage: Progress) -> &'static str {
    match stage {
        Progress::Geometry => "geometry",
        Progress::Effects => "effects",
        Progress::Curves => "curves",
        Progress::Judgement => "judgement",
    }
}
