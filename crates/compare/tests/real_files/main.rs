//! What comparing says of real robots: the vendor corpus beside the workspace and the robots in it.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

mod mutations;
mod real_pairs;
mod support;
