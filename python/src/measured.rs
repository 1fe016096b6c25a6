//! Calibration, and what its result is asked for.

use crate::chain::Chain;
use crate::errors::{Class, Spot, broken, calibration, error, measured};
use crate::given_file::Given;
use crate::robot::reading;
use denavit_calibrate::ObservationKind;
use denavit_calibrate::calibration::{
    CalibrateError, CalibrateOptions, Calibration, HoldOut, Progress, calibrate_and_tell,
};
use denavit_calibrate::effects::driver::Statics;
use denavit_calibrate::identify::residual_statistics::Residual;
use denavit_calibrate::identify::stop::Stop;
use denavit_calibrate::observation::kinds::KINDS;
use denavit_calibrate::observation::measurements::Measurements;
use denavit_calibrate::report::{html, text};
use denavit_export::{poe, urdf};
use denavit_load::Loaded;
use denavit_load::measured::{DataFile, Rows, RowsAsked, SearchAsked, moving, other_chains, prior_read, rows, search};
use denavit_model::nalgebra::Vector3;
use numpy::{PyArray1, PyArray2, PyArrayMethods as _};
use pyo3::prelude::*;
use std::ops::ControlFlow;
use std::sync::{Arc, mpsc};
use std::time::Duration;

/// What is fitted and what it is judged by.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct RowsGiven {
    data: Vec<Given>,
    sockets: Vec<(String, Given)>,
    distances: Vec<String>,
    test: Option<Given>,
    hold_out_setups: Vec<String>,
}

/// What is looked for.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct SearchGiven {
    scales: Vec<String>,
    pitches: Vec<String>,
    effects: Vec<String>,
    max_effects: usize,
    gear_ratios: Vec<String>,
    prior: Option<(String, String)>,
    hold_out: Option<f64>,
    seed: u64,
}

/// The kind of measurement that a word means.
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
    statics: Statics,
    loaded: Arc<Loaded>,
    exact: bool,
    #[pyo3(get)]
    notes: Vec<String>,
}

#[pymethods]
impl Fit {
    /// The contract of `denavit calibrate --json`.
    fn json(&self) -> String {
        self.result.report.to_json() + "\n"
    }

    /// What `denavit calibrate` prints.
    fn text(&self) -> String {
        text::report(&self.result)
    }

    /// The page with plots.
    fn html(&self, py: Python<'_>) -> PyResult<String> {
        let page = py.detach(|| html::page(&self.result));
        page.map_err(|failure| error(Class::Export, &failure.to_string(), Spot::default()))
    }

    /// The calibrated URDF, the name of its tip and what must be said of it; `None` where the source is no tree.
    fn urdf(&self) -> PyResult<Option<(String, String, Vec<String>)>> {
        let Loaded::Robot(tree) = &*self.loaded else { return Ok(None) };
        let calibrated = self.result.arm().chain();
        let written = urdf::with_chain(tree, &calibrated, reading(self.exact));
        let written = written.map_err(|failure| error(Class::Export, &failure.to_string(), Spot::default()))?;
        let again = denavit_model::urdf::read("the calibrated URDF", &written.value);
        let again = again.map_err(|failure| broken(&failure.to_string()))?;
        let old = |name: &String| tree.links.iter().any(|link| link.name == *name);
        let tip = again.links.iter().map(|link| &link.name).find(|name| !old(name)).cloned();
        let notes = written.notes.iter().map(ToString::to_string).collect();
        Ok(Some((written.value, tip.unwrap_or_else(|| self.chain.tip().to_owned()), notes)))
    }

    /// The calibrated screw axes as JSON.
    fn poe(&self) -> String {
        poe::json(&self.result.arm().chain(), &[])
    }

    /// The effects as JSON, as `denavit calibrate --effects-out` writes them.
    fn effects(&self) -> String {
        self.result.effects(&self.statics).to_json()
    }

    /// Each stage: name, residuals on the fitted rows that were kept, residuals on the held-out rows.
    fn residuals<'py>(&self, py: Python<'py>) -> PyResult<Vec<(String, Residuals<'py>, Residuals<'py>)>> {
        let stage = |stage: &denavit_calibrate::calibration::StageResiduals| {
            Ok((stage.name.clone(), arrays(py, &stage.train)?, arrays(py, &stage.test)?))
        };
        self.result.residuals.iter().map(stage).collect()
    }

    /// Errors of the adopted model on rows measured later, as JSON, and their residuals.
    fn predict<'py>(&self, py: Python<'py>, later: Given) -> PyResult<(String, Residuals<'py>)> {
        let name = later.name.clone();
        let asked = RowsAsked { data: vec![later.file()?], ..RowsAsked::default() };
        let found = rows(&asked, &self.chain).map_err(|failure| measured(&failure))?;
        let found = py.detach(|| self.result.predict(found.data));
        let found = found.map_err(|failure| calibration(&failure.to_string(), &name))?;
        let json = serde_json::to_string(&found.errors).map_err(|failure| broken(&failure.to_string()))?;
        Ok((json, arrays(py, &found.residuals)?))
    }
}

/// From measured data to a calibrated model; `progress` is called with what is going on.
#[pyfunction]
#[pyo3(signature = (chain, rows, search, progress))]
pub fn calibrate(
    py: Python<'_>,
    chain: &Chain,
    rows: RowsGiven,
    search: SearchGiven,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<Fit> {
    let nominal = &chain.chain;
    moving(&chain.file, nominal).map_err(|failure| measured(&failure))?;
    let hold_out = search.hold_out.map(|share| HoldOut { share, seed: search.seed });
    let asked = SearchAsked {
        scales: search.scales,
        pitches: search.pitches,
        effects: search.effects,
        max_effects: search.max_effects,
        gear_ratios: search.gear_ratios,
        prior: search.prior.map(prior_file),
        hold_out,
    };
    let prior = prior_read(&asked);
    let mut options = self::search(&asked, nominal).map_err(|failure| measured(&failure))?;
    let file = rows.data.first().map_or_else(String::new, |given| given.name.clone());
    let asked = RowsAsked {
        data: rows.data.into_iter().map(Given::file).collect::<PyResult<_>>()?,
        sockets: rows.sockets.into_iter().map(|(label, given)| Ok((label, given.file()?))).collect::<PyResult<_>>()?,
        distances: rows.distances,
        test: rows.test.map(Given::file).transpose()?,
        hold_out_setups: rows.hold_out_setups,
    };
    let read = py.detach(|| self::rows(&asked, nominal));
    let Rows { data, test, columns, notes, origin } = read.map_err(|failure| measured(&failure))?;
    options.other_chains = other_chains(&chain.loaded, nominal, &data);
    let statics = chain.loaded.statics(nominal, reading(chain.exact));
    let result = fitted(py, Work { chain: nominal.clone(), statics: statics.clone(), data, test, options }, progress)?;
    let mut result = result.map_err(|failure| calibration(&failure.to_string(), &file))?;
    result.report.columns = columns;
    result.report.origin = origin;
    result.report.origin.files.extend(prior);
    let (chain, loaded, exact) = (nominal.clone(), Arc::clone(&chain.loaded), chain.exact);
    Ok(Fit { result, chain, statics, loaded, exact, notes })
}

/// An earlier calibration: what to call it, and its JSON.
pub fn prior_file((name, text): (String, String)) -> DataFile {
    DataFile { name, bytes: text.into_bytes(), ..DataFile::default() }
}

/// What a calibration is made of.
struct Work {
    chain: denavit_model::Chain,
    statics: Statics,
    data: Measurements,
    test: Option<Measurements>,
    options: CalibrateOptions,
}

/// How long the interpreter is left alone before it is asked whether somebody wants to stop.
const PATIENCE: Duration = Duration::from_millis(20);

/// Fits in a thread of its own, so that the interpreter hears of Ctrl-C while it lasts. A fit that nobody waits for any more is
/// asked to stop, which it does within some hundredths of a second; only then does Ctrl-C return.
fn fitted(
    py: Python<'_>,
    work: Work,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<Result<Calibration, CalibrateError>> {
    let (tell, mut told) = mpsc::channel();
    let stop = Stop::default();
    let asked = stop.clone();
    let fit = std::thread::spawn(move || {
        let Work { chain, statics, data, test, options } = work;
        let mut tell = |stage| match tell.send(stage) {
            Ok(()) => ControlFlow::Continue(()),
            Err(mpsc::SendError(_)) => ControlFlow::Break(()),
        };
        let fit = || calibrate_and_tell(&chain, &statics, data, test, &options, &mut tell);
        asked.unless_asked(fit).unwrap_or(Err(CalibrateError::Stopped))
    });
    let mut wait = || {
        loop {
            let told = &mut told;
            let stage = py.detach(move || told.recv_timeout(PATIENCE));
            py.check_signals()?;
            match (stage, progress) {
                (Ok(stage), Some(progress)) => {
                    progress.call1((words(stage),))?;
                }
                (Err(mpsc::RecvTimeoutError::Disconnected), _) => return Ok(()),
                _ => {}
            }
        }
    };
    if let Err(interrupted) = wait() {
        stop.ask();
        // What it ended with, even a panic, is of no interest any more.
        let _ = py.detach(|| fit.join());
        return Err(interrupted);
    }
    // A panic of the fit is one of the caller's, which becomes an exception.
    Ok(py.detach(|| fit.join()).unwrap_or_else(|panic| std::panic::resume_unwind(panic)))
}

fn words(stage: Progress) -> &'static str {
    match stage {
        Progress::Geometry => "geometry",
        Progress::Effects => "effects",
        Progress::Curves => "curves",
        Progress::Judgement => "judgement",
    }
}
