//! The program from the user's side, golden files, house rules, and the oracle: one binary, a module each.

#![allow(clippy::unwrap_used, reason = "a test that cannot make its input has failed")]
#![allow(clippy::print_stdout, reason = "tests say what they measured and what they skipped")]
#![allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "places in sorted lists")]

mod architecture;
mod command_line;
mod compare;
mod corpus;
mod failed;
mod failures;
mod golden;
mod measured;
mod oracle;
mod quirky;
mod readme;
mod support;
mod tables;
mod trials;
mod words;
