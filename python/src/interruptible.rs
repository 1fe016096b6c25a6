//! Work in a separate thread, so that the interpreter handles Ctrl-C meanwhile.

use denavit_linear::stop::Stop;
use pyo3::prelude::*;
use std::ops::ControlFlow;
use std::sync::{Mutex, mpsc};
use std::time::Duration;

/// Interval at which the interpreter is checked for an interrupt.
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
    let (tell, heard) = mpsc::channel();
    // Behind a lock, as only then may another thread wait for it while the interpreter continues.
    let heard = Mutex::new(heard);
    let worker = std::thread::spawn(move || {
        work(&move |what| match tell.send(what) {
            Ok(()) => ControlFlow::Continue(()),
            Err(mpsc::SendError(_)) => ControlFlow::Break(()),
        })
    });
    let mut wait = || {
        loop {
            let next = py.detach(|| heard.lock().expect("receiving does not panic").recv_timeout(PATIENCE));
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
        // Its result, even a panic, no longer matters.
        let _ = py.detach(|| worker.join());
        return Err(interrupted);
    }
    Ok(py.detach(|| worker.join()).unwrap_or_else(|panic| std::panic::resume_unwind(panic)))
}
