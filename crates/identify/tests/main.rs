//! Candidates, priors, files of effects, specified effects and sums of residuals, seen from outside: as unit tests they would compile half of the crate again.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

mod candidates;
mod prior;
mod saved;
mod simd;
mod specification;
