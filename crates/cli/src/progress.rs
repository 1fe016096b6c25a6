//! A spinner on standard error while something takes long; nothing where standard error is no terminal.

use indicatif::{ProgressBar, ProgressStyle};
use std::time::Duration;

/// Redrawn this often.
const TICK: Duration = Duration::from_millis(100);

/// What is going on, said while it goes on and taken away when dropped.
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
