//! Results as JSON, as text for a terminal, as a page with plots.

pub mod axes;
pub mod commands;
#[cfg(feature = "pages")]
pub mod curve_plots;
pub mod curves;
pub mod deltas;
pub mod findings;
#[cfg(feature = "pages")]
pub mod html;
pub mod identifiability;
pub mod monitor;
pub mod noise;
#[cfg(feature = "pages")]
pub mod plots;
pub mod rows;
mod summary;
pub mod text;
#[cfg(feature = "pages")]
pub mod trace_plots;
mod trust;
pub mod zeros;

pub use crate::calibration::contract::CalibrationReport;
