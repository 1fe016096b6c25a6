//! Analyses thousands of robot files: equal and nearly equal mechanisms, rule violations, and the commits that changed them.

mod clusters;
mod files;
mod history;

pub use files::{CorpusFile, Findings, robots_in};
pub use history::{Became, GitChange, changes};

use crate::error::FleetError;
use denavit_linear::threads::par_map;
use serde::Serialize;

/// Options for a corpus.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CorpusOptions {
    /// Tolerance of fingerprints, m and rad: files that agree to this are one mechanism.
    pub same: f64,
    /// m and rad: mechanisms that differ by no more are similar.
    pub near: f64,
    /// Files read at the same time.
    pub threads: usize,
}

impl Default for CorpusOptions {
    fn default() -> Self {
        let threads = std::thread::available_parallelism().map_or(1, usize::from);
        Self { same: denavit_compare::fingerprint::DEFAULT_TOLERANCE, near: 1e-3, threads }
    }
}

/// A corpus.
#[derive(Debug, Clone, Serialize)]
pub struct Corpus {
    /// Every file, in the order given.
    pub files: Vec<CorpusFile>,
    /// Files of the same mechanism, by index in `files`, including mechanisms with one file. The largest first.
    pub mechanisms: Vec<Vec<usize>>,
    /// Groups of at least two similar mechanisms, by index in `mechanisms`.
    pub near: Vec<Near>,
}

/// Similar mechanisms.
#[derive(Debug, Clone, Serialize)]
pub struct Near {
    /// By index in `mechanisms`: each is similar to another of these (single linkage).
    pub mechanisms: Vec<usize>,
    /// The largest displacement of a tip among the similar pairs, m.
    pub tips_apart_m: f64,
}

/// Analyses files; `tell` is called for each file after reading.
///
/// # Errors
/// A file that was read before cannot be read again. Unreadable files are reported in their entries.
pub fn corpus(names: &[String], options: &CorpusOptions, tell: &(dyn Fn(&str) + Sync)) -> Result<Corpus, FleetError> {
    let files = in_parallel(names, options.threads, |name| {
        let file = files::examine(name, options.same);
        tell(name);
        file
    });
    let mechanisms = clusters::mechanisms(&files);
    let near = clusters::near(&files, &mechanisms, options)?;
    Ok(Corpus { files, mechanisms, near })
}

/// The work done on each item by `threads`, in the order of the items.
pub(crate) fn in_parallel<T: Sync, R: Send>(items: &[T], threads: usize, work: impl Fn(&T) -> R + Sync) -> Vec<R> {
    par_map(items.iter(), threads.min(items.len()), || (), |(), item| work(item))
}
