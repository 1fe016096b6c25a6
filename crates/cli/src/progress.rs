//! A spinner on standard error during long work; hidden if standard error is not a terminal.

use indicatif::{ProgressBar, ProgressStyle};
use std::time::Duration;

/// Redrawn this often.
const TICK: Duration = Duration::from_millis(100);

/// A message about the present work, shown until it is dropped.
pub struct Spinner(ProgressBar);

impl Spinner {
    /// Starts with what is going on.
    pub fn start(what: &str) -> Self {
        // Hidden by itself where standard error is no terminal.
        let bar = ProgressBar::new_spinner();
        if let Ok(style) = ProgressStyle::with_template("{spinner} {msg} ({elapsed})") {
            bar.set_style(style);
        }
        bar.set_message(what.to_owned());
        bar.enable_steady_tick(TICK);
        Self(bar)
    }

    /// Something else is going on now.
    pub fn say(&self, what: &str) {
        self.0.set_message(what.to_owned());
    }
}

impl Drop for Spinner {
    fn drop(&mut self) {
        self.0.finish_and_clear();
    }
}

/// A progress bar of many equal tasks, with an estimate of the remaining time; hidden if standard error is not a terminal.
pub struct Bar(ProgressBar);

impl Bar {
    /// Starts with none of `count` done.
    pub fn start(count: usize) -> Self {
        let bar = ProgressBar::new(count as u64);
        if let Ok(style) = ProgressStyle::with_template("{wide_bar} {pos}/{len} {msg} ({elapsed}, {eta} left)") {
            bar.set_style(style);
        }
        bar.enable_steady_tick(TICK);
        Self(bar)
    }

    /// One more is done; tasks that were done before do not count for the remaining time.
    pub fn step(&self, what: &str, known: bool) {
        if known {
            self.0.set_length(self.0.length().unwrap_or(1).saturating_sub(1));
            return;
        }
        self.0.set_message(what.to_owned());
        self.0.inc(1);
    }
}

impl Drop for Bar {
    fn drop(&mut self) {
        self.0.finish_and_clear();
    }
}
