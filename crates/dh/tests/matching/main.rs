//! Matching robots against tables: published ones, our own, and tables made at random.

#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "a test that cannot build its input has failed, and one that cannot run says so"
)]

mod corpus;
mod our_robots;
mod published;
mod refusals;
mod screw_axes_and_wrists;
mod stated_zeros;
mod synthetic;
