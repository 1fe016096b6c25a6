//! Results as JSON, as text for a terminal, as a page with plots.

pub mod axes;
pub mod commands;
pub mod contract;
pub mod curves;
pub mod findings;
pub mod html;
pub mod plots;
pub mod text;
pub mod told;
pub mod trace_plots;
pub mod trust;

pub use contract::CalibrationReport;
