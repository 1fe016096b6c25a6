//! Runs every entry of a manifest on all cores: successful work is not repeated, and a failed robot is a row.

use crate::error::FleetError;
use crate::job::{Computed, Job};
use crate::key::{Robots, key};
use crate::manifest::Entry;
use crate::siblings::Priors;
use crate::store::{LockedStore, Runs, Slot, Store};
use denavit_linear::stop::Stop;
use serde::Serialize;
use std::collections::HashSet;
use std::ops::ControlFlow;
use std::path::PathBuf;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// The small files of this many runs are merged into one while others are computed.
pub(crate) const MERGED_AT: usize = 256;

/// How an entry ended.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Outcome {
    /// It was computed now.
    Done,
    /// It was in the store.
    Known,
    /// It was computed now, and is a row with its error.
    Failed(String),
}

/// The result of a fleet run; the contract of `denavit fleet run --json`.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize)]
pub struct RunReport {
    /// Folder of the store.
    pub store: PathBuf,
    /// Entries of the manifest.
    pub entries: usize,
    /// Computed now.
    pub done: usize,
    /// Found in the store, where they succeeded.
    pub known: usize,
    /// Rows with an error among those computed now.
    pub failed: usize,
    /// Runs that newer inputs or options replaced, removed from the store.
    pub replaced: usize,
    /// The rows with an error, by robot, night and task.
    pub failures: Vec<FailedEntry>,
}

/// A row with its error.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Serialize)]
pub struct FailedEntry {
    /// The robot.
    pub serial: String,
    /// The night.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub date: Option<String>,
    /// What was to be done.
    pub task: &'static str,
    /// Why it failed.
    pub error: String,
}

impl RunReport {
    pub(crate) fn of(store: &Store, entries: usize) -> Self {
        Self { store: store.folder().to_owned(), entries, ..Self::default() }
    }

    pub(crate) fn count(&mut self, entry: &Entry, outcome: &Outcome) {
        match outcome {
            Outcome::Known => self.known += 1,
            Outcome::Done => self.done += 1,
            Outcome::Failed(error) => {
                self.done += 1;
                self.failed += 1;
                let date = entry.date.map(|day| day.to_string());
                let (serial, task, error) = (entry.serial.clone(), entry.task.name(), error.clone());
                self.failures.push(FailedEntry { serial, date, task, error });
            }
        }
    }

    pub(crate) fn in_order(mut self, replaced: usize) -> Self {
        self.failures.sort();
        self.replaced = replaced;
        self
    }
}

/// How a fleet is run.
#[derive(Debug, Clone)]
pub struct RunOptions {
    /// Robots computed in parallel; each on one thread, so that results do not depend on this number.
    pub threads: usize,
    /// Asks running computations to stop; their results are discarded.
    pub stop: Stop,
}

impl Default for RunOptions {
    fn default() -> Self {
        Self { threads: std::thread::available_parallelism().map_or(1, usize::from), stop: Stop::default() }
    }
}

/// Runs the entries into the store; `tell` is called for each as it ends, and may stop the run.
///
/// # Errors
/// The store cannot be written; finished results stay in it.
pub fn run(
    entries: &[Entry],
    held: &LockedStore,
    options: &RunOptions,
    tell: &(dyn Fn(&Entry, &Outcome) -> ControlFlow<()> + Sync),
) -> Result<RunReport, FleetError> {
    let store = &held.store;
    let runs = store.runs()?;
    let work = Work {
        store,
        runs: &runs,
        robots: Robots::default(),
        broken_off: AtomicBool::new(false),
        stop: &options.stop,
        report: Mutex::new((RunReport::of(store, entries.len()), HashSet::new())),
        unmerged: AtomicUsize::new(0),
        merging: Mutex::new(()),
        tell,
    };
    let (later, first): (Vec<&Entry>, Vec<&Entry>) = entries.iter().partition(|entry| entry.learns());
    work.all(&first, options.threads)?;
    if !later.is_empty() && !work.broken_off.load(Ordering::Relaxed) {
        // The siblings prior is learned after all robots without this prior are calibrated, so that it is independent of
        // the order of work.
        let keys = work.report.lock().expect("counting does not panic").1.clone();
        let priors = Priors::learned(store, entries, &keys, options.threads)?;
        let later: Vec<Entry> = later.into_iter().map(|entry| priors.given(entry)).collect();
        work.all(&later.iter().collect::<Vec<_>>(), options.threads)?;
    }
    let broken_off = work.broken_off.load(Ordering::Relaxed);
    let (report, keys) = work.report.into_inner().expect("counting does not panic");
    let gone = if broken_off { HashSet::new() } else { replaced(entries, &runs, &keys) };
    store.merge(&gone, &runs)?;
    Ok(report.in_order(gone.len()))
}

/// The robot, night and task of an entry.
pub(crate) fn slot(entry: &Entry) -> Slot {
    Slot { serial: entry.serial.clone(), date: entry.date, task: entry.task.name().into() }
}

/// Keys of the store whose robot, night and task are in the manifest with other inputs or options.
pub(crate) fn replaced<'a>(
    entries: impl IntoIterator<Item = &'a Entry>,
    runs: &Runs,
    keys: &HashSet<String>,
) -> HashSet<String> {
    let slots: HashSet<Slot> = entries.into_iter().map(slot).collect();
    let old = runs.slots().filter(|(key, slot)| !keys.contains(*key) && slots.contains(*slot));
    old.map(|(key, _)| key.clone()).collect()
}

struct Work<'a> {
    store: &'a Store,
    runs: &'a Runs,
    robots: Robots,
    broken_off: AtomicBool,
    stop: &'a Stop,
    report: Mutex<(RunReport, HashSet<String>)>,
    unmerged: AtomicUsize,
    merging: Mutex<()>,
    tell: &'a (dyn Fn(&Entry, &Outcome) -> ControlFlow<()> + Sync),
}

impl Work<'_> {
    /// Some entries, on this many threads.
    fn all(&self, entries: &[&Entry], threads: usize) -> Result<(), FleetError> {
        let next = AtomicUsize::new(0);
        let ended = std::thread::scope(|scope| {
            let threads: Vec<_> =
                (0..threads.clamp(1, entries.len().max(1))).map(|_| scope.spawn(|| self.go(entries, &next))).collect();
            threads.into_iter().map(|thread| thread.join().expect("a robot's panic is caught")).collect::<Vec<_>>()
        });
        ended.into_iter().collect()
    }

    /// One thread's work: entry after entry until none is left.
    fn go(&self, entries: &[&Entry], next: &AtomicUsize) -> Result<(), FleetError> {
        while !self.broken_off.load(Ordering::Relaxed) {
            let Some(&entry) = entries.get(next.fetch_add(1, Ordering::Relaxed)) else { return Ok(()) };
            let key = key(entry, &self.robots);
            let fresh = self.report.lock().expect("counting does not panic").1.insert(key.clone());
            let known = !fresh || self.runs.done.contains_key(&key);
            let outcome = if known { Ok(Some(Outcome::Known)) } else { self.compute(entry, key) };
            let outcome = outcome.inspect_err(|_| self.broken_off.store(true, Ordering::Relaxed))?;
            let Some(outcome) = outcome else {
                self.broken_off.store(true, Ordering::Relaxed);
                return Ok(());
            };
            self.report.lock().expect("counting does not panic").0.count(entry, &outcome);
            if (self.tell)(entry, &outcome).is_break() {
                self.broken_off.store(true, Ordering::Relaxed);
            }
            if !known && (self.unmerged.fetch_add(1, Ordering::Relaxed) + 1).is_multiple_of(MERGED_AT) {
                let _one = self.merging.lock().expect("merging does not panic");
                self.store
                    .merge(&HashSet::new(), self.runs)
                    .inspect_err(|_| self.broken_off.store(true, Ordering::Relaxed))?;
            }
        }
        Ok(())
    }

    /// `None`: it was asked to stop.
    fn compute(&self, entry: &Entry, key: String) -> Result<Option<Outcome>, FleetError> {
        let job = Job { key, entry: entry.clone() };
        let Some(Computed { tables, error }) = job.work(self.stop)? else { return Ok(None) };
        self.store.add(&job.key, &tables)?;
        Ok(Some(error.map_or(Outcome::Done, Outcome::Failed)))
    }
}
