//! What the crate must do, seen from outside: one binary, a module for each subject.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a panic is a failure, and what is printed is read")]

mod averaging;
mod bad_input;
mod camera;
mod contact;
mod covariates;
mod coverage;
mod curves;
mod deltas;
mod diagnosis;
mod drawn;
mod exports;
mod factory;
mod honesty;
mod identifiability;
mod incidence;
mod jacobian;
mod large_files;
mod measured;
mod mixes;
mod monitor;
mod noise;
mod oracle;
mod other_rows;
mod page;
mod pairs;
mod placing;
mod plan_and_compensate;
mod prior;
mod prior_effects;
mod real;
mod recovery;
mod redundancy;
mod repeats;
mod retold;
mod rows;
mod runs;
mod statistics;
mod tell_apart;
mod tips;
mod tracing;
mod warmth;
mod webcam;
mod zeros;
