//! What reaches half of the crate.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

mod saved;
mod simd;
mod specification;
