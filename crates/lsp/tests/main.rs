//! Recorded conversations with the server, in memory: question, place, answer.

#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "a test stops where its input cannot be made, and says what it skipped"
)]

mod editor;
mod own;
mod vendor;
