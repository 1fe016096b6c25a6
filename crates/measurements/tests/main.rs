//! Whole files, read from outside: as unit tests they would compile half of the crate again.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

mod outline;
mod pose_pairs;
mod poses;
