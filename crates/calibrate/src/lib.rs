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
//!
//! The root names the everyday path: [`read`] measurements, [`calibrate`], [`report()`] the result. The rooms behind it are private unless the feature
//! `unstable` is on, which also shows fields and methods whose types have no name here. What it opens is for denavit's other crates and
//! the studies, and changes without notice. [`CalibrationReport::to_json`] writes everything that a report holds.

#![cfg_attr(
    not(feature = "unstable"),
    allow(
        dead_code,
        unused_imports,
        clippy::struct_field_names,
        clippy::trivially_copy_pass_by_ref,
        reason = "much of a closed room is for those that open it, and is named and passed as they need it"
    )
)]
#![expect(clippy::inline_always, reason = "SIMD code must be compiled into the function that enables the instructions")]

#[cfg(feature = "unstable")]
pub mod apply;
#[cfg(feature = "unstable")]
pub mod calibration;
#[cfg(feature = "unstable")]
pub mod effects;
#[cfg(feature = "unstable")]
pub mod identify;
#[cfg(feature = "unstable")]
pub mod observation;
#[cfg(feature = "unstable")]
pub mod report;
#[cfg(feature = "unstable")]
pub mod trace;

#[cfg(not(feature = "unstable"))]
mod apply;
#[cfg(not(feature = "unstable"))]
mod calibration;
#[cfg(not(feature = "unstable"))]
mod effects;
#[cfg(not(feature = "unstable"))]
mod identify;
#[cfg(not(feature = "unstable"))]
mod observation;
#[cfg(not(feature = "unstable"))]
mod report;
#[cfg(not(feature = "unstable"))]
mod trace;

pub use calibration::adoption::Adopted;
pub use calibration::contract::{
    CalibrationReport, CurveEntry, CurvePoint, EffectEntry, FileRead, FileUse, HeldBy, Identified, Origin, Rival,
    SCHEMA, Samples, Stage, Unidentifiable,
};
pub use calibration::diagnosis::Diagnosis;
pub use calibration::rows::{RowEntry, Rows, to_csv as residuals_csv};
pub use calibration::{
    CalibrateError, CalibrateOptions, Calibration, HoldOut, Progress, calibrate, calibrate_and_tell,
};
pub use effects::driver::{Conditions, Statics};
pub use effects::saved::{SavedEffects, SavedError};
pub use effects::{EffectModel, Kind};
pub use identify::IdentifyOptions;
pub use identify::posterior::{Earlier, EarlierError};
pub use identify::proportion::OutOfProportion;
pub use identify::residual_statistics::{ErrorSummary, Errors, TestError};
pub use identify::solve::{FitOptions, Unfinished};
pub use observation::arm::Arm;
pub use observation::kinds::Part;
pub use observation::measurements::{
    Column, ColumnUse, Covariate, Covariates, DataError, DataNote, DataProblem, Loaded, MeasurementError, Measurements,
    MissingColumn, RecordedRow, Units, UnitsError, read, write,
};
pub use observation::parameters::{Freedom, Tolerances};
#[cfg(feature = "pages")]
pub use report::html::{PageError, page};
pub use report::text::report;
pub use trace::TraceOptions;
pub use trace::infer::curves::CurveOptions;

#[cfg(feature = "unstable")]
pub use denavit_export::kinematics_yaml;
#[cfg(feature = "unstable")]
pub use identify::residual::ResidualModel;
#[cfg(feature = "unstable")]
pub use identify::solve::{Fit, Noise};
#[cfg(feature = "unstable")]
pub use identify::{Identification, identify};
#[cfg(feature = "unstable")]
pub use observation::arm::{Perturbation, Perturbed, Row, RowState};
#[cfg(feature = "unstable")]
pub use observation::kinds::ObservationKind;
#[cfg(feature = "unstable")]
pub use observation::measurements::Scene;
#[cfg(feature = "unstable")]
pub use observation::parameters::{Effects, Layout, NoEffects, Parameter, ParameterKind, Sensitivity};
