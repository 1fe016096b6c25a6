//! Comparisons, rules and reports.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

mod compared;
mod lint;
mod meant;
mod real_files;
mod reports;
mod screws;
