//! Identify a robot from measured data.
//!
//! ```text
//! denavit-measurements   measurements.csv ─► Measurements
//! denavit-identify       what an arm predicts of them; residuals, closed-form Jacobian, normal equations ─► fit; effects
//! denavit-trace          effects that act
//! apply                  compensate, plan, tables for controllers
//! calibration            stages on training rows, errors on rows that no stage saw ─► one result
//! report                 that result as text, pages, plots
//! ```
//! Each layer uses those above it. Lengths are m, angles rad, twists angular first. The crate opens no files and prints nothing.
//!
//! The root has what most programs need: [`read`] measurements, [`calibrate`], [`report()`] the result. The other modules are for denavit's
//! other crates and the studies, and change without notice. [`CalibrationReport::to_json`] writes the whole report.

#[doc(hidden)]
pub mod apply;
#[doc(hidden)]
pub mod calibration;
#[doc(hidden)]
pub mod report;

pub use calibration::adoption::Adopted;
pub use calibration::contract::{
    CalibrationReport, CurveEntry, CurvePoint, EffectEntry, FileRead, FileUse, HeldBy, Identified, Origin, Rival,
    SCHEMA, Samples, Stage, Unidentifiable,
};
pub use calibration::diagnosis::Diagnosis;
pub use calibration::rows::{RowEntry, Rows, to_csv as residuals_csv};
pub use calibration::{
    AdoptedFit, CalibrateError, CalibrateOptions, Calibration, HoldOut, Progress, calibrate, calibrate_and_tell,
};
pub use denavit_identify::IdentifyOptions;
pub use denavit_identify::arm::Arm;
pub use denavit_identify::effects::driver::{Conditions, Statics};
pub use denavit_identify::effects::saved::{SavedEffects, SavedError};
pub use denavit_identify::effects::{Correction, EffectModel, Kind};
pub use denavit_identify::parameters::{Freedom, Tolerances};
pub use denavit_identify::posterior::{Earlier, EarlierError};
pub use denavit_identify::proportion::OutOfProportion;
pub use denavit_identify::residual_statistics::{ErrorSummary, Errors, TestError};
pub use denavit_identify::solve::{FitOptions, Unfinished};
pub use denavit_measurements::kinds::Part;
pub use denavit_measurements::{
    Column, ColumnUse, Covariate, Covariates, DataError, DataNote, DataProblem, Loaded, MeasurementError, Measurements,
    MissingColumn, RecordedRow, Units, UnitsError, read, write,
};
pub use denavit_trace::TraceOptions;
pub use denavit_trace::infer::curves::CurveOptions;
#[cfg(feature = "pages")]
pub use report::html::{PageError, page};
pub use report::text::report;
