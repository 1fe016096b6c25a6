//! Entries that other processes compute: they are handed jobs and hand back Parquet, and one process keeps the store.
//!
//! Only the process that holds the store writes it. So a worker that is lost, or that works on though nobody waits for it any
//! more, can leave nothing half done, and needs no folder that it may write into.

use crate::error::FleetError;
use crate::key::{Robots, key};
use crate::manifest::Entry;
use crate::run::{MERGED_AT, Outcome, RunReport, replaced};
use crate::siblings::Priors;
use crate::store::table::Rows;
use crate::store::{LockedStore, Runs};
use crate::tasks;
use denavit_linear::stop::Stop;
use denavit_linear::threads::par_map;
use serde::{Deserialize, Serialize};
use std::collections::HashSet;

/// An entry that did not succeed yet. As JSON it goes to another process.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Job {
    /// The key of the run.
    pub key: String,
    /// What to do.
    pub entry: Entry,
}

/// What a job found, on its way to the store.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Computed {
    /// Name of each table that has rows, and its Parquet.
    pub tables: Vec<(String, Vec<u8>)>,
    /// Why it was not done: the row of `runs` says it, too.
    pub error: Option<String>,
}

impl Job {
    /// Does the job, on this thread alone; paths are taken from the working directory.
    ///
    /// # Errors
    /// The files that are found here are not those that the key was made of, or this is another version of denavit.
    pub fn compute(&self) -> Result<Computed, FleetError> {
        if key(&self.entry, &Robots::default()) != self.key {
            return Err(FleetError::OtherFiles(self.entry.serial.clone()));
        }
        Ok(self.work(&Stop::default())?.expect("nobody asks it to stop"))
    }

    /// `None`: it was asked to stop.
    pub(crate) fn work(&self, stop: &Stop) -> Result<Option<Computed>, FleetError> {
        let Some((tables, error)) = tasks::rows(&self.entry, &self.key, stop) else { return Ok(None) };
        let filled = tables.iter().filter(|rows| !rows.rows.is_empty());
        let parquet = |rows: &Rows| Ok((rows.table.name.to_owned(), rows.parquet()?));
        Ok(Some(Computed { tables: filled.map(parquet).collect::<Result<_, FleetError>>()?, error }))
    }
}

/// A run over a fleet whose jobs are done elsewhere: what there is to do, and what came back.
#[derive(Debug)]
pub struct Ledger {
    held: LockedStore,
    entries: Vec<Entry>,
    keys: HashSet<String>,
    runs: Runs,
    kept: HashSet<String>,
    /// Continue from their siblings: they are not dealt out yet.
    later: Vec<Entry>,
    report: RunReport,
}

impl Ledger {
    /// The run, and the jobs that are to be done first: each once, in the manifest's order. [`Ledger::go_on`] has those that continue
    /// from their siblings.
    ///
    /// # Errors
    /// A file of the store cannot be read.
    pub fn open(entries: Vec<Entry>, held: LockedStore) -> Result<(Self, Vec<Job>), FleetError> {
        let runs = held.store.runs()?;
        let report = RunReport::of(&held.store, entries.len());
        let (later, first): (Vec<Entry>, Vec<Entry>) = entries.iter().cloned().partition(Entry::learns);
        let mut ledger = Self { held, entries, keys: HashSet::new(), runs, kept: HashSet::new(), later, report };
        let jobs = ledger.undone(first);
        Ok((ledger, jobs))
    }

    /// Those of some entries that are to be done; the others are counted as known.
    fn undone(&mut self, entries: Vec<Entry>) -> Vec<Job> {
        let robots = Robots::default();
        let of_entries = par_map(entries.iter(), threads(), || (), |(), entry| key(entry, &robots));
        let mut jobs = Vec::new();
        for (entry, key) in entries.into_iter().zip(of_entries) {
            if self.keys.insert(key.clone()) && !self.runs.done.contains_key(&key) {
                jobs.push(Job { key, entry });
            } else {
                self.report.count(&entry, &Outcome::Known);
            }
        }
        jobs
    }

    /// Entries that continue from their siblings and are not dealt out yet.
    pub fn later(&self) -> &[Entry] {
        &self.later
    }

    /// The jobs that continue from their siblings, once all others are kept. None while one of those is missing: what siblings know
    /// would depend on which.
    ///
    /// # Errors
    /// A file of the store cannot be read.
    pub fn go_on(&mut self) -> Result<Vec<Job>, FleetError> {
        if self.later.is_empty() || self.is_missing() {
            return Ok(Vec::new());
        }
        let priors = Priors::learned(&self.held.store, &self.entries, &self.keys, threads())?;
        let later = std::mem::take(&mut self.later).iter().map(|entry| priors.given(entry)).collect();
        Ok(self.undone(later))
    }

    /// Whether the result of a job that was dealt out did not come.
    fn is_missing(&self) -> bool {
        self.keys.iter().any(|key| !self.kept.contains(key) && !self.runs.done.contains_key(key))
    }

    /// Writes what a job found. The same job a second time changes nothing.
    ///
    /// # Errors
    /// The store cannot be written; what was kept before stays in it.
    pub fn keep(&mut self, job: &Job, found: &Computed) -> Result<(), FleetError> {
        if !self.kept.insert(job.key.clone()) {
            return Ok(());
        }
        self.held.store.add(&job.key, &found.tables)?;
        self.report.count(&job.entry, &found.error.clone().map_or(Outcome::Done, Outcome::Failed));
        if self.kept.len().is_multiple_of(MERGED_AT) {
            self.held.store.merge(&HashSet::new(), &self.runs)?;
        }
        Ok(())
    }

    /// Ends the run and lets go of the store. Runs of older inputs or options go, but for those whose new result did not come.
    ///
    /// # Errors
    /// The store cannot be written; what was kept before stays in it.
    pub fn close(self) -> Result<RunReport, FleetError> {
        let unfinished = self.is_missing() || !self.later.is_empty();
        let Self { held, entries, keys, runs, report, .. } = self;
        let gone = if unfinished { HashSet::new() } else { replaced(&entries, &runs, &keys) };
        held.store.merge(&gone, &runs)?;
        Ok(report.in_order(gone.len()))
    }
}

fn threads() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from)
}
