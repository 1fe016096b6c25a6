//! Thousands of robots' files: which are the same mechanism, which nearly, which break rules, and which commits changed them.

mod clusters;
mod files;
mod history;

pub use files::{CorpusFile, Findings, robots_in};
pub use history::{Became, GitChange, changes};

use crate::error::FleetError;
use denavit_linear::threads::par_map;
use serde::Serialize;

/// How a corpus is looked at.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CorpusOptions {
    /// Of fingerprints, m and rad: files that agree to this are one mechanism.
    pub same: f64,
    /// m and rad: mechanisms that differ by no more are nearly alike.
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
    /// Files that are the same mechanism, by place in `files`; a mechanism with one file too. The largest first.
    pub mechanisms: Vec<Vec<usize>>,
    /// Mechanisms that are nearly alike, by place in `mechanisms`; where there are at least two.
    pub near: Vec<Near>,
}

/// Mechanisms that are nearly alike.
#[derive(Debug, Clone, Serialize)]
pub struct Near {
    /// By place in `mechanisms`: each is near to another of these, and through it to all.
    pub mechanisms: Vec<usize>,
    /// The largest displacement of a tip among the pairs that are near, m.
    pub tips_apart_m: f64,
}

/// Looks at files; `tell` hears of each as it is read.
///
/// # Errors
/// A file that was read before cannot be read again. What cannot be read at all is said of the file.
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
