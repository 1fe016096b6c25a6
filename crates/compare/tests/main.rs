//! Comparisons, rules and reports, seen from outside: one binary, a module for each subject.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a panic is a failure, and what is printed is read")]

mod compared;
mod lint;
mod meant;
mod real_files;
mod reports;
mod screws;
