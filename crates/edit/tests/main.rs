//! Operations over files and over random trees.

#![expect(clippy::unwrap_used, clippy::print_stdout, reason = "tests may stop at once, and say what they saw")]

mod corpus;
mod parts;
mod properties;
mod support;
