//! Entries that other processes compute: they are handed jobs and hand back Parquet, and one process keeps the store.
//!
//! Only the process that holds the store writes it. A worker that is lost, or that continues although nobody waits for
//! it, therefore leaves nothing half done, and needs no writable folder.

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

/// The result of a job, before it is stored.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Computed {
    /// Name of each table that has rows, and its Parquet.
    pub tables: Vec<(String, Vec<u8>)>,
    /// Why it failed; also in the row of `runs`.
    pub error: Option<String>,
}

impl Job {
    /// Runs the job on this thread only; paths are relative to the working directory.
    ///
    /// # Errors
    /// The files here differ from those of the key, or this is another version of denavit.
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

/// A fleet run with jobs computed elsewhere: pending jobs and returned results.
#[derive(Debug)]
pub struct Ledger {
    held: LockedStore,
    entries: Vec<Entry>,
    keys: HashSet<String>,
    runs: Runs,
    kept: HashSet<String>,
    /// Entries with a siblings prior, not handed out yet.
    later: Vec<Entry>,
    report: RunReport,
}

impl Ledger {
    /// The run, and its first jobs: each once, in the manifest's order. [`Ledger::resume`] returns those with a siblings
    /// prior.
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

    /// The jobs of the entries without a result; the others are counted as known.
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

    /// Entries with a siblings prior that are not handed out yet.
    pub fn later(&self) -> &[Entry] {
        &self.later
    }

    /// The jobs with a siblings prior, after all other results are stored. None while one is missing: the prior would
    /// depend on which.
    ///
    /// # Errors
    /// A file of the store cannot be read.
    pub fn resume(&mut self) -> Result<Vec<Job>, FleetError> {
        if self.later.is_empty() || self.is_missing() {
            return Ok(Vec::new());
        }
        let priors = Priors::learned(&self.held.store, &self.entries, &self.keys, threads())?;
        let later = std::mem::take(&mut self.later).iter().map(|entry| priors.given(entry)).collect();
        Ok(self.undone(later))
    }

    /// Whether the result of a job that was handed out is missing.
    fn is_missing(&self) -> bool {
        self.keys.iter().any(|key| !self.kept.contains(key) && !self.runs.done.contains_key(key))
    }

    /// Stores the result of a job. Storing it a second time changes nothing.
    ///
    /// # Errors
    /// The store cannot be written; earlier results stay in it.
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

    /// Ends the run and releases the store. Runs with older inputs or options are removed, except where the new result is missing.
    ///
    /// # Errors
    /// The store cannot be written; earlier results stay in it.
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
