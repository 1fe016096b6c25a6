//! Work on all cores; where there is one alone, as in a web page, no thread is started.

use crate::identify::stop::{carried, look};
use std::panic::resume_unwind;
use std::thread::ScopedJoinHandle;

/// The work done on each item, in the order of the items.
pub(crate) fn in_parallel<T: Sync, R: Send>(items: &[T], work: impl Fn(&T) -> R + Sync) -> Vec<R> {
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
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
