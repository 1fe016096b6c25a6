//! A run over a fleet: in this process, or by jobs for other processes.

#![expect(clippy::needless_pass_by_value, reason = "what Python calls with is handed over by value")]

use crate::errors::{Class, Spot, argument, broken, error, load};
use crate::interruptible::{Tell, interruptible};
use denavit_fleet::manifest::{self, Entry};
use denavit_fleet::store::{LockedStore, Store};
use denavit_fleet::{Computed, FleetError, Job, Ledger, Outcome, RunOptions, RunReport};
use pyo3::prelude::*;
use pyo3::pybacked::PyBackedBytes;
use pyo3::types::PyBytes;
use std::path::Path;
use std::sync::Mutex;

fn fleet(failure: &FleetError) -> PyErr {
    let message = failure.to_string();
    match failure {
        FleetError::Load(failure) => load(failure),
        FleetError::Manifest { .. } => error(Class::Manifest, &message, Spot::default()),
        FleetError::Store { file, .. } | FleetError::NotOurs { file, .. } => {
            error(Class::Store, &message, Spot::file(&file.display().to_string()))
        }
        FleetError::Busy(folder) | FleetError::NoStore(folder) => {
            error(Class::Store, &message, Spot::file(&folder.display().to_string()))
        }
        _ => error(Class::Store, &message, Spot::default()),
    }
}

fn opened(manifest: &str, set: &[(String, String)], store: &Path) -> Result<(Vec<Entry>, LockedStore), FleetError> {
    let entries = manifest::read(manifest, set)?;
    Ok((entries, Store::hold(store)?))
}

fn json(report: &RunReport) -> PyResult<String> {
    serde_json::to_string(report).map_err(|failure| broken(&failure.to_string()))
}

/// A job as JSON.
fn job(text: &str) -> PyResult<Job> {
    serde_json::from_str(text).map_err(|failure| argument(format!("this is not a fleet job: {failure}")))
}

/// Runs a manifest into a store in this process; `progress` is called with each robot that ends and with how many there are.
/// The result is the contract of `denavit fleet run --json`.
#[pyfunction]
#[pyo3(signature = (manifest, set, store, threads, progress))]
pub fn fleet_run(
    py: Python<'_>,
    manifest: &str,
    set: Vec<(String, String)>,
    store: std::path::PathBuf,
    threads: usize,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<String> {
    let (entries, held) = py.detach(|| opened(manifest, &set, &store)).map_err(|failure| fleet(&failure))?;
    let mut options = RunOptions::default();
    if threads > 0 {
        options.threads = threads;
    }
    let (stop, count, mut ended) = (options.stop.clone(), entries.len(), 0);
    let run = move |tell: &Tell<String>| {
        let tell = |entry: &Entry, _: &Outcome| tell(entry.serial.clone());
        denavit_fleet::run(&entries, &held, &options, &tell)
    };
    let report = interruptible(py, &stop, run, |serial| {
        ended += 1;
        progress.map_or(Ok(()), |progress| progress.call1((ended, count, serial)).map(drop))
    })?;
    json(&report.map_err(|failure| fleet(&failure))?)
}

/// Serial, date, task, and the job as JSON.
type JobToDo = (String, Option<String>, &'static str, String);

/// Name and Parquet of each table that has rows, and why the job failed.
type Found<'py> = (Vec<(String, Bound<'py, PyBytes>)>, Option<String>);

/// A run whose jobs other processes do; this one alone writes the store.
#[pyclass(frozen, module = "denavit._denavit")]
pub struct FleetLedger {
    ledger: Mutex<Option<Ledger>>,
    /// Those that are dealt out now.
    jobs: Mutex<Vec<Job>>,
    #[pyo3(get)]
    entries: usize,
}

#[pymethods]
impl FleetLedger {
    /// Locks the store and determines the jobs.
    #[new]
    #[pyo3(signature = (manifest, set, store))]
    fn new(py: Python<'_>, manifest: &str, set: Vec<(String, String)>, store: std::path::PathBuf) -> PyResult<Self> {
        let open = || {
            let (entries, held) = opened(manifest, &set, &store)?;
            Ok((entries.len(), Ledger::open(entries, held)?))
        };
        let (entries, (ledger, jobs)) = py.detach(open).map_err(|failure| fleet(&failure))?;
        Ok(Self { ledger: Mutex::new(Some(ledger)), jobs: Mutex::new(jobs), entries })
    }

    /// Serial, date and task of each job that is to be done, and the job as JSON for `fleet_compute`.
    fn jobs(&self) -> PyResult<Vec<JobToDo>> {
        let of = |job: &Job| {
            let text = serde_json::to_string(job).map_err(|failure| broken(&failure.to_string()))?;
            let Entry { serial, date, task, .. } = &job.entry;
            Ok((serial.clone(), date.map(|day| day.to_string()), task.name(), text))
        };
        self.jobs.lock().expect("reading does not panic").iter().map(of).collect()
    }

    /// Serial, date and task of each entry that continues from its siblings and is not dealt out yet.
    fn later(&self) -> PyResult<Vec<(String, Option<String>, &'static str)>> {
        let ledger = self.ledger.lock().expect("writing does not panic");
        let of = |entry: &Entry| (entry.serial.clone(), entry.date.map(|day| day.to_string()), entry.task.name());
        Ok(ledger.as_ref().ok_or_else(closed)?.later().iter().map(of).collect())
    }

    /// Learns what siblings share, once all jobs are kept; `jobs` then has those that continue from it.
    fn resume(&self, py: Python<'_>) -> PyResult<()> {
        let mut ledger = self.ledger.lock().expect("writing does not panic");
        let ledger = ledger.as_mut().ok_or_else(closed)?;
        let next = py.detach(|| ledger.resume()).map_err(|failure| fleet(&failure))?;
        *self.jobs.lock().expect("reading does not panic") = next;
        Ok(())
    }

    /// Writes what the job at this place of `jobs` found.
    fn keep(
        &self,
        py: Python<'_>,
        index: usize,
        tables: Vec<(String, PyBackedBytes)>,
        error: Option<String>,
    ) -> PyResult<()> {
        let jobs = self.jobs.lock().expect("reading does not panic");
        let job = jobs.get(index).ok_or_else(|| argument(format!("there is no job {index}")))?;
        let mut ledger = self.ledger.lock().expect("writing does not panic");
        let ledger = ledger.as_mut().ok_or_else(closed)?;
        let tables = tables.into_iter().map(|(name, parquet)| (name, parquet.to_vec())).collect();
        py.detach(|| ledger.keep(job, &Computed { tables, error })).map_err(|failure| fleet(&failure))
    }

    /// Ends the run and releases the store; the result is the contract of `denavit fleet run --json`.
    fn close(&self, py: Python<'_>) -> PyResult<String> {
        let ledger = self.ledger.lock().expect("writing does not panic").take().ok_or_else(closed)?;
        json(&py.detach(|| ledger.close()).map_err(|failure| fleet(&failure))?)
    }

    /// Releases the store when the run is interrupted; what was stored stays in it.
    fn leave(&self) {
        drop(self.ledger.lock().expect("writing does not panic").take());
    }
}

fn closed() -> PyErr {
    argument("this run over a fleet has ended")
}

/// Does a job in this process, on one thread: name and Parquet of each table, and why it was not done where it was not.
#[pyfunction]
pub fn fleet_compute<'py>(py: Python<'py>, text: &str) -> PyResult<Found<'py>> {
    let job = job(text)?;
    let Computed { tables, error } = py.detach(|| job.compute()).map_err(|failure| fleet(&failure))?;
    Ok((tables.into_iter().map(|(name, parquet)| (name, PyBytes::new(py, &parquet))).collect(), error))
}
