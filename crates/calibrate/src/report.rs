//! Results as JSON, as text for a terminal, as a page with plots.

pub mod contract;
pub mod html;
pub mod plots;
pub mod text;

pub use contract::CalibrationReport;
