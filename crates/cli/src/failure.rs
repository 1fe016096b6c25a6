//! The errors that end a run with exit code 2, each with its fix.

use thiserror::Error;

/// Why a command could not do its work.
#[derive(Debug, Error)]
pub enum Failure {
    /// A file could not be written.
    #[error("{file}: cannot be written: {reason}; nothing was changed")]
    Write {
        /// As given.
        file: String,
        /// The system's words.
        reason: String,
    },
    /// An argument that cannot be.
    #[error("{0}")]
    Argument(String),
    /// A source that is no robot, or has no such chain.
    #[error(transparent)]
    Load(#[from] denavit_load::LoadError),
    /// A comparison whose chain is not there.
    #[error(transparent)]
    Tree(#[from] denavit_model::TreeError),
    /// Not a table's file.
    #[error(transparent)]
    Source(#[from] denavit_export::sources::SourceError),
    /// A robot that cannot be exported.
    #[error(transparent)]
    Export(#[from] denavit_export::urdf::ExportError),
    /// An edit that cannot be made, or does not hold what it says.
    #[error(transparent)]
    Edit(#[from] denavit_edit::EditError),
    /// Not a configuration file.
    #[error(transparent)]
    Check(#[from] denavit_load::CheckError),
    /// Words or files that make no calibration.
    #[cfg(feature = "calibrate")]
    #[error(transparent)]
    Measured(#[from] denavit_load::measured::MeasuredError),
    /// Measurements that cannot be read.
    #[cfg(feature = "calibrate")]
    #[error(transparent)]
    Data(#[from] denavit_measurements::DataError),
    /// A bag that makes no rows.
    #[cfg(feature = "bags")]
    #[error(transparent)]
    Bag(#[from] denavit_bag::BagError),
    /// Measurements that cannot be fitted.
    #[cfg(feature = "calibrate")]
    #[error(transparent)]
    Calibrate(#[from] denavit_calibrate::calibration::CalibrateError),
    /// A chain of more joints than can be identified.
    #[cfg(feature = "calibrate")]
    #[error(transparent)]
    TooManyJoints(#[from] denavit_identify::proportion::TooManyJoints),
    /// Effects that cannot be read.
    #[cfg(feature = "calibrate")]
    #[error(transparent)]
    Effects(#[from] denavit_identify::effects::saved::SavedError),
    /// A fleet that cannot be run, or has no store.
    #[cfg(feature = "fleet")]
    #[error(transparent)]
    Fleet(#[from] denavit_fleet::FleetError),
    /// A calibration that makes no page.
    #[cfg(feature = "calibrate")]
    #[error(transparent)]
    Page(#[from] denavit_calibrate::report::html::PageError),
    /// Poses that cannot be chosen.
    #[cfg(feature = "calibrate")]
    #[error(transparent)]
    Plan(#[from] denavit_calibrate::apply::plan::PlanError),
    /// A calibration that a maker's form cannot hold.
    #[error(transparent)]
    Maker(#[from] denavit_export::makers::MakerError),
    /// Offsets that a form cannot hold.
    #[cfg(feature = "calibrate")]
    #[error(transparent)]
    Offsets(#[from] denavit_export::offsets::OffsetsError),
    /// A chain that makes no code.
    #[error("{file}: {source}")]
    Code {
        /// As given.
        file: String,
        /// Why.
        source: denavit_code::CodeError,
    },
    /// Pairs of poses that give no placement.
    #[cfg(feature = "calibrate")]
    #[error("{file}: {source}")]
    HandEye {
        /// As given.
        file: String,
        /// Why.
        source: denavit_hand_eye::HandEyeError,
    },
    /// Parts that make no chain.
    #[error("{file}: {source}")]
    Chain {
        /// As given.
        file: String,
        /// Why.
        source: denavit_model::ChainError,
    },
    /// A table that a format cannot hold.
    #[error(transparent)]
    Render(#[from] denavit_export::RenderError),
    /// Nobody reads on: no failure.
    #[error("the reader closed the pipe")]
    ClosedPipe,
}

#[cfg(not(all(feature = "bags", feature = "calibrate", feature = "fleet", feature = "lsp")))]
impl Failure {
    /// What this build leaves out, and how to get it.
    pub fn not_built(feature: &str) -> Self {
        Self::Argument(format!(
            "this denavit was built without the feature \"{feature}\"; build it with all features: cargo install --path crates/cli"
        ))
    }
}
