//! Identify a robot from measured data.
//!
//! ```text
//! observation   measurements.csv ─► Measurements; Arm, Parameters: what an observation is, and what the arm predicts of it
//! effects       what moves a joint or a link beyond its geometry
//! identify      residuals, closed-form Jacobian, normal equations ─► fit, what the data can identify
//! trace         selection of effects
//! apply         compensate, plan, simulate, tables for controllers
//! calibration   stages on training rows, errors on rows that no stage saw ─► one result
//! report        that result as text, pages, plots
//! ```
//! Each room knows those above it. Lengths are m, angles rad, twists angular first. The crate opens no files and prints
//! nothing.

#![expect(clippy::inline_always, reason = "SIMD code must be compiled into the function that enables the instructions")]

pub mod apply;
pub mod calibration;
pub mod effects;
pub mod identify;
pub mod observation;
pub mod report;
pub mod trace;

pub use denavit_export::kinematics_yaml;
pub use identify::residual::ResidualModel;
pub use identify::solve::{Fit, FitOptions, Noise, Unfinished};
pub use identify::{Identification, IdentifyOptions, identify};
pub use observation::arm::{Arm, Perturbation, Perturbed, Row, RowState};
pub use observation::kinds::ObservationKind;
pub use observation::measurements::{Measurements, Scene};
pub use observation::parameters::{
    Effects, Freedom, Layout, NoEffects, Parameter, ParameterKind, Sensitivity, Tolerances,
};
