//! Work on all cores; with a single core, as in a web page, or where the caller keeps the cores busy, no thread is started.

use crate::stop::{carried, check_cancelled};
use std::cell::Cell;
use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::atomic::AtomicBool;
use std::sync::atomic::Ordering::Relaxed;
use std::sync::{Mutex, OnceLock};

/// Number of rows of a stretch.
const ROWS_AT_ONCE: usize = 32;
/// Stack size of a thread, bytes: while it waits for others it may do a part of their work.
const STACK: usize = 8 << 20;

thread_local! {
    /// Whether calls from this thread start no threads of their own.
    static ALONE: Cell<bool> = const { Cell::new(false) };
}

/// Does the work without starting threads: for callers that calibrate one robot on each core.
///
/// Results are bit-identical to those with threads: no sum depends on their number.
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

/// Number of threads that a computation may use, the calling one included.
pub fn available() -> usize {
    // Query the system once: it reads files for the answer.
    static CORES: OnceLock<usize> = OnceLock::new();
    if ALONE.get() { 1 } else { *CORES.get_or_init(|| std::thread::available_parallelism().map_or(1, usize::from)) }
}

/// Does the work with one thread per available core, shared by all its parallel parts: starting new threads each time would take as
/// long as some of the parts. The threads end with the work, so that a process may `fork` before and after.
pub fn with_threads<R: Send>(work: impl FnOnce() -> R + Send) -> R {
    on_threads(available(), work)
}

/// The same with this many threads; uses existing ones, if there are any.
fn on_threads<R: Send>(count: usize, work: impl FnOnce() -> R + Send) -> R {
    if count <= 1 || rayon::current_thread_index().is_some() {
        return work();
    }
    let (mut work, mut result) = (Some(work), None);
    on_new_threads(count, &mut || result = work.take().map(|work| work()));
    result.expect("the work was done")
}

/// Type-erased work, done once: the code that starts threads is compiled once, not for each type of work.
type Work<'a> = dyn FnMut() + Send + 'a;

fn on_new_threads(count: usize, work: &mut Work) {
    match rayon::ThreadPoolBuilder::new().num_threads(count).stack_size(STACK).build() {
        Ok(threads) => threads.install(carried(work)),
        // The system gives no more threads.
        Err(_) => on_this_thread(work),
    }
}

fn side_by_side(one: &mut Work, other: &mut Work) {
    with_threads(|| rayon::join(one, carried(other)));
}

/// Does the work on this many threads at a time. All have ended before a panic continues: none runs when the caller sees it.
fn on_each_of(threads: usize, work: &(dyn Fn() + Sync)) {
    on_threads(threads, || {
        rayon::scope(|scope| {
            for _ in 1..threads {
                let share = carried(work);
                scope.spawn(|_| share());
            }
            work();
        });
    });
}

/// The work done on each item, in the order of the items.
pub fn in_parallel<T: Sync, R: Send>(items: &[T], work: impl Fn(&T) -> R + Sync) -> Vec<R> {
    par_map(items.iter(), available().min(items.len()), || (), |(), item| work(item))
}

/// The same, each item on a thread of its own: for items of many small pieces of work.
pub fn each_alone<T: Sync, R: Send>(items: &[T], work: impl Fn(&T) -> R + Sync) -> Vec<R> {
    // A single item can use all threads.
    if items.len() < 2 {
        items.iter().map(work).collect()
    } else {
        in_parallel(items, |item| on_this_thread(|| work(item)))
    }
}

/// The same on the first items only, until they are enough: the result does not depend on the number of threads.
pub fn each_alone_until<T: Sync, R: Send>(
    items: &[T],
    work: impl Fn(&T) -> R + Sync,
    enough: impl Fn(&[R]) -> bool + Sync,
) -> Vec<R> {
    // Results in the order of the items up to the first missing one, and later ones that finished early.
    let found = Mutex::new((Vec::new(), BTreeMap::new()));
    let ended = AtomicBool::new(false);
    let one = |(): &mut (), (index, item): (usize, &T)| {
        let result = on_this_thread(|| work(item));
        let mut found = found.lock().expect("taking a result does not panic");
        let (first, ahead) = &mut *found;
        ahead.insert(index, result);
        while !ended.load(Relaxed)
            && let Some(next) = ahead.remove(&first.len())
        {
            first.push(next);
            ended.store(enough(first), Relaxed);
        }
    };
    let asked = items.iter().enumerate().take_while(|_| !ended.load(Relaxed));
    par_map(asked, available().min(items.len()), || (), one);
    found.into_inner().expect("taking a result does not panic").0
}

/// Two pieces of work in parallel, if there is a thread for the second.
pub fn join<A: Send, B: Send>(one: impl FnOnce() -> A + Send, other: impl FnOnce() -> B + Send) -> (A, B) {
    if available() == 1 {
        return (one(), other());
    }
    let (mut one, mut first) = (Some(one), None);
    let (mut other, mut second) = (Some(other), None);
    side_by_side(&mut || first = one.take().map(|work| work()), &mut || second = other.take().map(|work| work()));
    first.zip(second).expect("both were done")
}

/// The work done on stretches of this many rows, in their order; `start` makes the initial state of each thread.
pub fn in_stretches<S, R: Send>(
    rows: usize,
    start: impl Fn() -> S + Sync,
    work: impl Fn(&mut S, Range<usize>) -> R + Sync,
) -> Vec<R> {
    let stretches = (0..rows).step_by(ROWS_AT_ONCE).map(|from| from..(from + ROWS_AT_ONCE).min(rows));
    let threads = available().min(stretches.len());
    par_map(stretches, threads, start, work)
}

/// The work done on each item, in the order of the items, by at most `threads` threads, the calling one included. An item starts
/// as soon as a thread is free; `start` makes the initial state of each thread.
pub fn par_map<I: Iterator + Send, S, R: Send>(
    items: I,
    threads: usize,
    start: impl Fn() -> S + Sync,
    work: impl Fn(&mut S, I::Item) -> R + Sync,
) -> Vec<R> {
    if threads <= 1 {
        let mut own = start();
        let one = |item| {
            check_cancelled();
            work(&mut own, item)
        };
        return items.map(one).collect();
    }
    let queue = Mutex::new(items.enumerate());
    let done = Mutex::new(Vec::new());
    let deal = || {
        let mut own: Option<S> = None;
        let mut some = Vec::new();
        loop {
            check_cancelled();
            let next = queue.lock().expect("taking an item does not panic").next();
            let Some((index, item)) = next else { break };
            some.push((index, work(own.get_or_insert_with(&start), item)));
        }
        done.lock().expect("adding results does not panic").append(&mut some);
    };
    on_each_of(threads, &deal);
    let done = done.into_inner().expect("adding results does not panic");
    let mut in_order: Vec<Option<R>> = Vec::new();
    in_order.resize_with(done.len(), || None);
    for (index, result) in done {
        in_order[index] = Some(result);
    }
    in_order.into_iter().map(|result| result.expect("each item is dealt out once")).collect()
}

/// The content of a cell, made if the cell is empty. Threads that come at the same time may each make it: none waits for another, since the
/// other may run a part of this one's work while it waits itself.
pub fn get_or_make<T>(cell: &OnceLock<T>, make: impl FnOnce() -> T) -> &T {
    cell.get().unwrap_or_else(|| {
        let made = make();
        cell.get_or_init(|| made)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn work_within_work_comes_back_in_order_and_waits_for_no_cell_of_its_own() {
        let items: Vec<usize> = (0..40).collect();
        let cell = OnceLock::new();
        // Each needs a value whose computation uses all threads.
        let sum = || in_parallel(&items, |item| item * item).into_iter().sum::<usize>();
        let work = || in_parallel(&items, |item| in_parallel(&items, |other| item * other + *get_or_make(&cell, sum)));
        let expected: Vec<Vec<usize>> =
            items.iter().map(|item| items.iter().map(|other| item * other + 20_540).collect()).collect();
        assert_eq!(work(), expected);
        assert_eq!(on_threads(4, work), expected);
        assert_eq!(on_this_thread(work), expected);
        assert_eq!(on_threads(4, || join(|| 1, || rayon::current_thread_index().is_some())), (1, true));
    }

    #[test]
    fn work_ends_with_the_shortest_row_of_first_results_that_is_enough() {
        let items: Vec<usize> = (0..40).collect();
        let first = |most: usize| {
            let work = |item: &usize| {
                // The first items finish last.
                std::thread::sleep(std::time::Duration::from_micros(if *item == 0 { 3000 } else { 10 }));
                *item
            };
            each_alone_until(&items, work, |found| found.len() >= most)
        };
        for most in [1, 7, 40, 50] {
            let expected = items[..most.min(40)].to_vec();
            assert_eq!(on_threads(4, || first(most)), expected);
            assert_eq!(on_this_thread(|| first(most)), expected);
        }
    }
}
