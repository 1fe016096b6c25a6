//! What comparing says of real robots: the vendor corpus beside the workspace and the robots in it.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]
#![allow(clippy::print_stdout, reason = "figures and the reason for skipping are for whoever runs the tests")]

mod gauge;
mod mutations;
mod real_pairs;
mod rules;
mod support;
