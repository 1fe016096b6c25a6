//! Cancellation of long work.
//!
//! Long work checks from time to time whether it was cancelled; if so, it unwinds to its start, like a silent panic. The
//! code in between need not handle cancellation.

use std::cell::RefCell;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Cancels work; clones cancel the same work.
#[derive(Debug, Clone, Default)]
pub struct Stop(Arc<AtomicBool>);

/// The payload of the unwinding.
struct Stopped;

thread_local! {
    /// The handle that may cancel this thread's work.
    static HERE: RefCell<Option<Stop>> = const { RefCell::new(None) };
}

impl Stop {
    /// Cancels the work.
    pub fn ask(&self) {
        self.0.store(true, Ordering::Relaxed);
    }

    /// The result of work, or `None` if it was cancelled before its end.
    ///
    /// A program compiled with `panic = "abort"` must not cancel.
    pub fn unless_asked<R>(&self, work: impl FnOnce() -> R) -> Option<R> {
        let before = HERE.replace(Some(self.clone()));
        let done = catch_unwind(AssertUnwindSafe(work));
        HERE.set(before);
        match done {
            Ok(done) => Some(done),
            Err(why) if why.is::<Stopped>() => None,
            Err(panic) => resume_unwind(panic),
        }
    }
}

/// Ends the work here if it was cancelled.
pub fn check_cancelled() {
    if HERE.with_borrow(|stop| stop.as_ref().is_some_and(|stop| stop.0.load(Ordering::Relaxed))) {
        resume_unwind(Box::new(Stopped));
    }
}

/// The same work for another thread, cancelled together with this one.
pub fn carried<R>(work: impl FnOnce() -> R) -> impl FnOnce() -> R {
    let stop = HERE.with_borrow(Clone::clone);
    move || {
        HERE.set(stop);
        work()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::threads::in_parallel;
    use std::sync::atomic::AtomicUsize;

    #[test]
    fn work_stops_where_it_looks_and_on_all_threads() {
        let (stop, done) = (Stop::default(), AtomicUsize::new(0));
        let items: Vec<usize> = (0..1000).collect();
        let work = || {
            in_parallel(&items, |_| {
                if done.fetch_add(1, Ordering::Relaxed) == 10 {
                    stop.ask();
                }
            })
        };
        assert!(stop.unless_asked(work).is_none());
        assert!(done.load(Ordering::Relaxed) < 500, "{done:?} of 1000 were done");
        // Outside cancellable work nothing is cancelled.
        check_cancelled();
        assert_eq!(Stop::default().unless_asked(|| in_parallel(&items, |item| *item)), Some(items));
    }

    #[test]
    fn a_panic_stays_one() {
        let panicked = catch_unwind(|| Stop::default().unless_asked::<()>(|| resume_unwind(Box::new("a mistake"))));
        assert_eq!(panicked.unwrap_err().downcast_ref::<&str>(), Some(&"a mistake"));
    }
}
