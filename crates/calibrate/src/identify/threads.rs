//! Work on all cores; where there is one alone, as in a web page, or where the caller keeps the cores busy, no thread is started.

use crate::identify::stop::{carried, look};
use std::cell::Cell;
use std::panic::resume_unwind;
use std::thread::ScopedJoinHandle;

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
    if ALONE.get() { 1 } else { std::thread::available_parallelism().map_or(1, usize::from) }
}

/// The work done on each item, in the order of the items.
pub(crate) fn in_parallel<T: Sync, R: Send>(items: &[T], work: impl Fn(&T) -> R + Sync) -> Vec<R> {
    let threads = available();
    let work = |item: &T| {
        look();
        work(item)
    };
    if threads == 1 {
        return items.iter().map(work).collect();
    }
    let work = &work;
    std::thread::scope(|scope| {
        let share = items.len().div_ceil(threads).max(1);
        let parts = items.chunks(share);
        let parts = parts.map(|part| scope.spawn(carried(move || part.iter().map(work).collect::<Vec<R>>())));
        let parts: Vec<_> = parts.collect();
        parts.into_iter().flat_map(joined).collect()
    })
}

/// What a thread made; its panic goes on here.
pub(crate) fn joined<R>(thread: ScopedJoinHandle<'_, R>) -> R {
    thread.join().unwrap_or_else(|panic| resume_unwind(panic))
}
