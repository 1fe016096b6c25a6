//! Every entry of a manifest on every core: finished work is not done again, and a bad robot is a row.

use crate::error::FleetError;
use crate::key::{Robots, key};
use crate::manifest::Entry;
use crate::store::{Held, Slot, Store};
use crate::tasks;
use std::collections::{HashMap, HashSet};
use std::ops::ControlFlow;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// Small files of this many runs are merged into one while others are computed.
const MERGED_AT: usize = 256;

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

/// A run over a fleet, counted.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Tally {
    /// Computed now.
    pub done: usize,
    /// Found in the store.
    pub known: usize,
    /// Rows with an error among those computed now.
    pub failed: usize,
    /// Runs that newer inputs or options replaced, taken out of the store.
    pub replaced: usize,
}

/// How a fleet is run.
#[derive(Debug, Clone, Copy)]
pub struct RunOptions {
    /// Robots computed at the same time; each on one thread, so that nothing depends on how many there are.
    pub threads: usize,
}

impl Default for RunOptions {
    fn default() -> Self {
        Self { threads: std::thread::available_parallelism().map_or(1, usize::from) }
    }
}

/// Runs the entries into the store; `tell` hears of each as it ends, and may break off.
///
/// # Errors
/// The store cannot be written; what was finished stays in it.
pub fn run(
    entries: &[Entry],
    held: &Held,
    options: RunOptions,
    tell: &(dyn Fn(&Entry, &Outcome) -> ControlFlow<()> + Sync),
) -> Result<Tally, FleetError> {
    let store = &held.store;
    let finished = store.finished()?;
    let work = Work {
        entries,
        store,
        finished: &finished,
        robots: Robots::default(),
        next: AtomicUsize::new(0),
        stop: AtomicBool::new(false),
        tally: Mutex::new((Tally::default(), HashSet::new())),
        unmerged: AtomicUsize::new(0),
        merging: Mutex::new(()),
        tell,
    };
    let ended = std::thread::scope(|scope| {
        let threads: Vec<_> =
            (0..options.threads.clamp(1, entries.len().max(1))).map(|_| scope.spawn(|| work.go())).collect();
        threads.into_iter().map(|thread| thread.join().expect("a robot's panic is caught")).collect::<Vec<_>>()
    });
    ended.into_iter().collect::<Result<Vec<()>, FleetError>>()?;
    let stopped = work.stop.load(Ordering::Relaxed);
    let (mut tally, keys) = work.tally.into_inner().expect("counting does not panic");
    let gone = if stopped { HashSet::new() } else { replaced(entries, &finished, &keys) };
    tally.replaced = gone.len();
    store.merge(&gone)?;
    Ok(tally)
}

/// Runs one entry into a store, for an engine that deals entries out to many processes; `known`: keys that need no work.
///
/// Nothing is locked: entries that differ write different files, and one that runs twice writes the same.
///
/// # Errors
/// The store cannot be written.
#[expect(clippy::implicit_hasher, reason = "callers have one kind of set")]
pub fn run_one(entry: &Entry, store: &Store, known: &HashSet<String>) -> Result<Outcome, FleetError> {
    let key = key(entry, &Robots::default());
    if known.contains(&key) { Ok(Outcome::Known) } else { compute(entry, &key, store) }
}

fn compute(entry: &Entry, key: &str, store: &Store) -> Result<Outcome, FleetError> {
    let (tables, error) = tasks::rows(entry, key);
    store.add(key, &tables)?;
    Ok(error.map_or(Outcome::Done, Outcome::Failed))
}

/// Keys of the store whose robot, night and task stand in the manifest with other inputs or options.
fn replaced(entries: &[Entry], finished: &HashMap<String, Slot>, keys: &HashSet<String>) -> HashSet<String> {
    let slot = |entry: &Entry| Slot { serial: entry.serial.clone(), date: entry.date, task: entry.task.name().into() };
    let slots: HashSet<Slot> = entries.iter().map(slot).collect();
    let old = finished.iter().filter(|(key, slot)| !keys.contains(*key) && slots.contains(*slot));
    old.map(|(key, _)| key.clone()).collect()
}

struct Work<'a> {
    entries: &'a [Entry],
    store: &'a Store,
    finished: &'a HashMap<String, Slot>,
    robots: Robots,
    next: AtomicUsize,
    stop: AtomicBool,
    tally: Mutex<(Tally, HashSet<String>)>,
    unmerged: AtomicUsize,
    merging: Mutex<()>,
    tell: &'a (dyn Fn(&Entry, &Outcome) -> ControlFlow<()> + Sync),
}

impl Work<'_> {
    /// One thread's work: entry after entry until none is left.
    fn go(&self) -> Result<(), FleetError> {
        while !self.stop.load(Ordering::Relaxed) {
            let Some(entry) = self.entries.get(self.next.fetch_add(1, Ordering::Relaxed)) else { return Ok(()) };
            let key = key(entry, &self.robots);
            let fresh = self.tally.lock().expect("counting does not panic").1.insert(key.clone());
            let known = !fresh || self.finished.contains_key(&key);
            let outcome = if known { Ok(Outcome::Known) } else { compute(entry, &key, self.store) };
            let outcome = outcome.inspect_err(|_| self.stop.store(true, Ordering::Relaxed))?;
            {
                let tally = &mut self.tally.lock().expect("counting does not panic").0;
                match outcome {
                    Outcome::Known => tally.known += 1,
                    Outcome::Done => tally.done += 1,
                    Outcome::Failed(_) => {
                        tally.done += 1;
                        tally.failed += 1;
                    }
                }
            }
            if (self.tell)(entry, &outcome).is_break() {
                self.stop.store(true, Ordering::Relaxed);
            }
            if !known && (self.unmerged.fetch_add(1, Ordering::Relaxed) + 1).is_multiple_of(MERGED_AT) {
                let _one = self.merging.lock().expect("merging does not panic");
                self.store.merge(&HashSet::new()).inspect_err(|_| self.stop.store(true, Ordering::Relaxed))?;
            }
        }
        Ok(())
    }
}
