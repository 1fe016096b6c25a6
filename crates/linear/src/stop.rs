//! Work that nobody wants any more.
//!
//! Long work looks now and then whether it is asked to stop; where it is, it unwinds to where it began, as from a panic that says
//! nothing. So whatever is in between need not know of it.

use std::cell::RefCell;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Asks work to stop; clones ask the same work.
#[derive(Debug, Clone, Default)]
pub struct Stop(Arc<AtomicBool>);

/// What unwinds.
struct Stopped;

thread_local! {
    /// Who may stop what this thread does.
    static HERE: RefCell<Option<Stop>> = const { RefCell::new(None) };
}

impl Stop {
    /// Asks.
    pub fn ask(&self) {
        self.0.store(true, Ordering::Relaxed);
    }

    /// The result of work, or `None` where it was asked to stop before it came to its end.
    ///
    /// A program that is compiled to abort where it panics must not ask.
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

/// Ends the work here where it was asked to stop.
pub fn check_cancelled() {
    if HERE.with_borrow(|stop| stop.as_ref().is_some_and(|stop| stop.0.load(Ordering::Relaxed))) {
        resume_unwind(Box::new(Stopped));
    }
}

/// The same work for another thread, which stops with this one.
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
        // Outside of it nothing is stopped.
        check_cancelled();
        assert_eq!(Stop::default().unless_asked(|| in_parallel(&items, |item| *item)), Some(items));
    }

    #[test]
    fn a_panic_stays_one() {
        let panicked = catch_unwind(|| Stop::default().unless_asked::<()>(|| resume_unwind(Box::new("a mistake"))));
        assert_eq!(panicked.unwrap_err().downcast_ref::<&str>(), Some(&"a mistake"));
    }
}
