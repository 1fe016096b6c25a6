//! Work in a thread of its own, so that the interpreter hears of Ctrl-C while it lasts.

use denavit_linear::stop::Stop;
use pyo3::prelude::*;
use std::ops::ControlFlow;
use std::sync::{Mutex, mpsc};
use std::time::Duration;

/// How long the interpreter is left alone before it is asked whether somebody wants to stop.
const PATIENCE: Duration = Duration::from_millis(20);

/// Tells the thread that waits how far the work is; `Break` where nobody waits any more.
pub type Tell<T> = dyn Fn(T) -> ControlFlow<()> + Sync;

/// Does the work; `hear` is called, with the interpreter, with what it tells. On Ctrl-C, or where `hear` raises, the work is asked
/// to stop, and only when it has stopped does the call return. A panic of the work is one of the caller's, which becomes an
/// exception.
pub fn interruptible<T: Send + 'static, R: Send + 'static>(
    py: Python<'_>,
    stop: &Stop,
    work: impl FnOnce(&Tell<T>) -> R + Send + 'static,
    mut hear: impl FnMut(T) -> PyResult<()>,
) -> PyResult<R> {
    let (tell, told) = mpsc::channel();
    // Behind a lock, as only then may another thread wait for it while the interpreter continues.
    let told = Mutex::new(told);
    let worker = std::thread::spawn(move || {
        work(&move |what| match tell.send(what) {
            Ok(()) => ControlFlow::Continue(()),
            Err(mpsc::SendError(_)) => ControlFlow::Break(()),
        })
    });
    let mut wait = || {
        loop {
            let next = py.detach(|| told.lock().expect("receiving does not panic").recv_timeout(PATIENCE));
            py.check_signals()?;
            match next {
                Ok(what) => hear(what)?,
                Err(mpsc::RecvTimeoutError::Disconnected) => return Ok(()),
                Err(mpsc::RecvTimeoutError::Timeout) => {}
            }
        }
    };
    if let Err(interrupted) = wait() {
        stop.ask();
        // What it ended with, even a panic, is of no interest any more.
        let _ = py.detach(|| worker.join());
        return Err(interrupted);
    }
    Ok(py.detach(|| worker.join()).unwrap_or_else(|panic| std::panic::resume_unwind(panic)))
}
