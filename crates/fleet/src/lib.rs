//! Calibration runs over many robots and nights, and their statistics.
//!
//! ```text
//! manifest ──► run (all cores, a robot each) ──► store: Parquet ──► watch · report · priors
//!                 calibrate · table · check · fingerprint · diff
//! ```
//! The crate writes only into the folder of its store, every file as a whole; it prints nothing. The statistics do not
//! use the store: plain numbers in, plain numbers out.

pub mod corpus;
mod day;
mod error;
mod job;
mod key;
pub mod manifest;
pub mod nights;
pub mod report;
mod run;
pub mod siblings;
pub mod statistics;
pub mod store;
mod tasks;

pub use day::Day;
pub use error::FleetError;
pub use job::{Computed, Job, Ledger};
pub use run::{FailedEntry, Outcome, RunOptions, RunReport, run};
