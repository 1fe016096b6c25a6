//! Results as JSON, as text for a terminal, as a page with plots.

pub(crate) mod axes;
pub mod commands;
#[cfg(feature = "pages")]
pub(crate) mod curve_plots;
pub(crate) mod curves;
pub mod deltas;
pub mod findings;
#[cfg(feature = "pages")]
pub mod html;
pub mod identifiability;
pub mod monitor;
pub(crate) mod noise;
#[cfg(feature = "pages")]
pub mod plots;
pub mod rows;
mod summary;
pub mod tables;
pub mod text;
#[cfg(feature = "pages")]
pub(crate) mod trace_plots;
mod trust;
pub(crate) mod zeros;

pub use crate::calibration::contract::CalibrationReport;
