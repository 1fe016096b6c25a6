//! One entry of a manifest to the rows of the store: every task a file.

mod calibrate;
mod check;
mod compare;
mod table;

use crate::manifest::{Entry, Task};
use crate::store::schema::{AXES, COMMON, CURVES, EFFECTS, INFORMATION, NOTES, PARAMETERS, RESIDUALS, RUNS, TableKind};
use crate::store::table::{Cell, Rows};
use denavit_linear::stop::Stop;
use denavit_linear::threads::on_this_thread;
use denavit_load::{LoadError, Loaded, Options, Selection};
use denavit_model::Reading;
use denavit_model::settings::plain;
use thiserror::Error;

/// Why a task has no result; written to the run's row.
#[derive(Debug, Error)]
pub(crate) enum TaskError {
    #[error(transparent)]
    Load(#[from] LoadError),
    #[error(transparent)]
    Measured(#[from] denavit_load::measured::MeasuredError),
    #[error(transparent)]
    TooManyJoints(#[from] denavit_identify::proportion::TooManyJoints),
    #[error(transparent)]
    Calibrate(#[from] denavit_calibrate::calibration::CalibrateError),
    #[error(transparent)]
    Check(#[from] denavit_load::CheckError),
    #[error(transparent)]
    Tree(#[from] denavit_model::TreeError),
    #[error(
        "prior siblings: the store has fewer than {} other robots of this model that were calibrated without \
         siblings; first calibrate some with more poses and without a prior",
        crate::statistics::hierarchy::LEAST_ROBOTS
    )]
    NoSiblings,
    #[error("units \"{written}\": {reason}")]
    Units { written: String, reason: String },
}

/// The result of a task: tables without the common columns.
#[derive(Debug, Default)]
pub(crate) struct Found {
    pub parameters: Vec<Vec<Cell>>,
    pub effects: Vec<Vec<Cell>>,
    pub curves: Vec<Vec<Cell>>,
    pub residuals: Vec<Vec<Cell>>,
    pub notes: Vec<Vec<Cell>>,
    pub axes: Vec<Vec<Cell>>,
    pub information: Vec<Vec<Cell>>,
    pub summary: Summary,
}

/// The summary of the result in the run's row.
#[derive(Debug, Default)]
pub(crate) struct Summary {
    pub name: String,
    pub verdict: String,
    pub fingerprint: String,
    pub rows_fitted: Option<usize>,
    pub rows_held_out: Option<usize>,
    pub nominal_rms: Option<f64>,
    pub geometric_rms: Option<f64>,
    pub rms: Option<f64>,
    pub structured: Option<bool>,
    pub base: String,
    pub tip: String,
    pub prior_weight: Option<f64>,
}

/// A remark: kind, code, level, place, message.
pub(crate) fn note(kind: &str, code: &str, level: &str, place: &str, message: String) -> Vec<Cell> {
    vec![kind.into(), code.into(), level.into(), place.into(), plain(message).into(), Cell::Empty, Cell::Empty]
}

/// The rows of every table for an entry, done or failed; computed on this thread alone. `None`: it was asked to stop.
pub(crate) fn rows(entry: &Entry, key: &str, stop: &Stop) -> Option<(Vec<Rows>, Option<String>)> {
    let begun = std::time::Instant::now();
    let work = || match entry.task {
        Task::Calibrate => calibrate::run(entry),
        Task::Table => table::run(entry),
        Task::Check => check::run(entry),
        Task::Fingerprint => compare::fingerprint(entry),
        Task::Diff => compare::diff(entry),
    };
    // A mistake of ours in one robot is not the end of the others.
    let done = std::panic::catch_unwind(|| on_this_thread(|| stop.unless_asked(work)));
    let (found, error) = match done {
        Ok(None) => return None,
        Ok(Some(Ok(found))) => (found, None),
        Ok(Some(Err(error))) => (Found::default(), Some(plain(error))),
        Err(panic) => {
            let words = panic.downcast_ref::<String>().map(String::as_str);
            let words = words.or_else(|| panic.downcast_ref::<&str>().copied()).unwrap_or("no message");
            (Found::default(), Some(format!("a bug in denavit: {words}; please report it with these files")))
        }
    };
    let seconds = begun.elapsed().as_secs_f64();
    let summary = found.summary;
    let run = vec![
        entry.robot.as_str().into(),
        summary.name.into(),
        entry.data.join(";").into(),
        entry.event.as_str().into(),
        env!("CARGO_PKG_VERSION").into(),
        error.is_none().into(),
        error.clone().into(),
        summary.verdict.into(),
        summary.fingerprint.into(),
        summary.rows_fitted.into(),
        summary.rows_held_out.into(),
        summary.nominal_rms.into(),
        summary.geometric_rms.into(),
        summary.rms.into(),
        summary.structured.into(),
        summary.base.into(),
        summary.tip.into(),
        entry.prior.as_ref().map(|prior| prior.name().to_owned()).into(),
        summary.prior_weight.into(),
        seconds.into(),
    ];
    let common = || -> Vec<Cell> {
        let day = entry.date.map_or(Cell::Empty, |day| Cell::Day(day.0));
        vec![key.into(), entry.serial.as_str().into(), day, entry.task.name().into()]
    };
    let table = |table: &'static TableKind, own: Vec<Vec<Cell>>| {
        let rows = own.into_iter().map(|own| {
            let row: Vec<Cell> = common().into_iter().chain(own).collect();
            debug_assert_eq!(row.len(), COMMON.len() + table.own.len(), "{}", table.name);
            row
        });
        Rows { table, rows: rows.collect() }
    };
    let tables = vec![
        table(&INFORMATION, found.information),
        table(&AXES, found.axes),
        table(&PARAMETERS, found.parameters),
        table(&EFFECTS, found.effects),
        table(&CURVES, found.curves),
        table(&RESIDUALS, found.residuals),
        table(&NOTES, found.notes),
        table(&RUNS, vec![run]),
    ];
    Some((tables, error))
}

/// Reads a robot of an entry; notes on the reading become remarks.
fn load(entry: &Entry, name: &str, notes: &mut Vec<Vec<Cell>>) -> Result<Loaded, TaskError> {
    let opened = denavit_load::load(name, &source_options(entry))?;
    notes.extend(opened.notes.into_iter().map(|text| note("reading", "", "note", name, text)));
    Ok(opened.robot)
}

/// The chain of an entry's robot; `None` if it has none, which the entry reports itself.
pub(crate) fn chain(entry: &Entry) -> Option<denavit_model::Chain> {
    let loaded = load(entry, &entry.robot, &mut Vec::new()).ok()?;
    Some(loaded.chain(&selection(entry)).ok()?.value)
}

/// How an entry's robots are read.
pub(crate) fn source_options(entry: &Entry) -> Options {
    Options { arguments: entry.options.arguments.clone(), arguments_for_another: true, ..Options::default() }
}

fn selection(entry: &Entry) -> Selection<'_> {
    Selection {
        file: &entry.robot,
        base: entry.options.base.as_deref(),
        tip: entry.options.tip.as_deref(),
        reading: Reading::Intended,
    }
}
