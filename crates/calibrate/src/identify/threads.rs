//! Work on all cores; where there is one alone, as in a web page, or where the caller keeps the cores busy, no thread is started.

use crate::identify::stop::{carried, look};
use std::cell::Cell;
use std::ops::Range;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::{Mutex, OnceLock};
use std::thread::ScopedJoinHandle;

/// Rows of a stretch.
const ROWS_AT_ONCE: usize = 128;

thread_local! {
    /// Whether calls from this thread start no threads of their own.
    static ALONE: Cell<bool> = const { Cell::new(false) };
}

/// Does the work without starting threads: for callers that calibrate one robot on each core.
///
/// Results are the same to the bit as with threads: no sum depends on how many there are.
pub fn on_this_thread<R>(work: impl FnOnce() -> R) -> R {
    struct Restore(bool);
    impl Drop for Restore {
        fn drop(&mut self) {
            ALONE.set(self.0);
        }
    }
    let _restore = Restore(ALONE.replace(true));
    work()
}

/// How many threads a computation may use, the calling one included.
pub(crate) fn available() -> usize {
    // The system is asked once: it reads files for the answer.
    static CORES: OnceLock<usize> = OnceLock::new();
    if ALONE.get() { 1 } else { *CORES.get_or_init(|| std::thread::available_parallelism().map_or(1, usize::from)) }
}

/// The work done on each item, in the order of the items.
pub(crate) fn in_parallel<T: Sync, R: Send>(items: &[T], work: impl Fn(&T) -> R + Sync) -> Vec<R> {
    dealt(items.iter(), available().min(items.len()), || (), |(), item| work(item))
}

/// Two pieces of work side by side, where there is a thread for the second.
pub(crate) fn both<A, B: Send>(one: impl FnOnce() -> A, other: impl FnOnce() -> B + Send) -> (A, B) {
    if available() == 1 {
        return (one(), other());
    }
    std::thread::scope(|scope| {
        // The scope waits for it where the first panics.
        let other = scope.spawn(carried(other));
        (one(), other.join().unwrap_or_else(|panic| resume_unwind(panic)))
    })
}

/// The work done on stretches of so many rows, in their order; each thread begins with what `start` makes.
pub(crate) fn in_stretches<S, R: Send>(
    rows: usize,
    start: impl Fn() -> S + Sync,
    work: impl Fn(&mut S, Range<usize>) -> R + Sync,
) -> Vec<R> {
    let stretches = (0..rows).step_by(ROWS_AT_ONCE).map(|from| from..(from + ROWS_AT_ONCE).min(rows));
    let threads = available().min(stretches.len());
    dealt(stretches, threads, start, work)
}

/// The work done on each item, in the order of the items, by `threads` threads, the calling one included. An item is dealt
/// out as soon as a thread is free; each thread begins with what `start` makes.
pub fn dealt<I: Iterator + Send, S, R: Send>(
    items: I,
    threads: usize,
    start: impl Fn() -> S + Sync,
    work: impl Fn(&mut S, I::Item) -> R + Sync,
) -> Vec<R> {
    let queue = Mutex::new(items.enumerate());
    let deal = || {
        let mut own = start();
        let mut done = Vec::new();
        loop {
            look();
            let next = queue.lock().expect("taking an item does not panic").next();
            let Some((index, item)) = next else { return done };
            done.push((index, work(&mut own, item)));
        }
    };
    let mut done = std::thread::scope(|scope| {
        let others: Vec<_> = (1..threads).map(|_| scope.spawn(carried(deal))).collect();
        // All have ended before a panic goes on: none of them runs when the caller is told.
        let own = catch_unwind(AssertUnwindSafe(deal));
        let all: Vec<_> = std::iter::once(own).chain(others.into_iter().map(ScopedJoinHandle::join)).collect();
        all.into_iter().flat_map(|done| done.unwrap_or_else(|panic| resume_unwind(panic))).collect::<Vec<_>>()
    });
    done.sort_by_key(|(index, _)| *index);
    done.into_iter().map(|(_, result)| result).collect()
}
