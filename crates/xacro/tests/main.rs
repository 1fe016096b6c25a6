//! Expansion from the outside: features, errors, limits, packages, vendors' files.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]
#![allow(clippy::print_stdout, reason = "a test says what it measured or why it is skipped")]
#![allow(clippy::format_push_string, reason = "documents are put together line by line")]

mod account;
mod errors;
mod features;
mod limits;
mod mutation;
mod packages;
#[path = "../../../tests/seeded.rs"]
mod seeded;
mod support;
mod vendor;
mod xml;
