//! Identify a robot from measured data.
//!
//! ```text
//! measurements.csv ─► Measurements ─┐
//!                        Chain ─────┼─► nominal fit ─► geometric fit ─► report
//!                                   └─► Problem (residuals, closed-form Jacobian) ─► normal equations ─► fit
//! ```
//! Lengths are m, angles rad, twists angular first. The crate opens no files and prints nothing.

#![expect(clippy::inline_always, reason = "SIMD code must be compiled into the function that enables the instructions")]

pub mod adoption;
pub mod arm;
pub mod calibration;
pub mod compensate;
pub mod delta_table;
pub mod dh_form;
pub mod diagnosis;
pub mod drawing;
pub mod effects;
pub mod errors;
pub mod gauge;
pub mod grid;
pub mod identifiability;
pub mod identify;
pub mod infer;
pub mod intervals;
mod lanes;
pub mod measurements;
pub mod normal;
pub mod observe;
mod panel;
pub mod parameters;
pub mod placement;
pub mod plan;
pub mod prediction;
pub mod prior;
mod products;
pub mod proportion;
pub mod redundancy;
pub mod report;
pub mod residual;
pub mod simulate;
pub mod solve;
pub mod trace;

pub use arm::{Arm, Deviation, Row, RowState};
pub use denavit_export::kinematics_yaml;
pub use identify::{Identification, IdentifyOptions, identify};
pub use measurements::{Measurements, Scene};
pub use observe::ObservationKind;
pub use parameters::{Effects, Freedom, Layout, NoEffects, Parameter, ParameterKind, Sensitivity, Tolerances};
pub use residual::Problem;
pub use solve::{Fit, FitOptions, Noise};
