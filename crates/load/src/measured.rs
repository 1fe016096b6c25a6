//! From a calibration's options as words to rows and options.
//!
//! Words are those of the command line; messages name its options, and the Python package writes them as its keywords.

mod camera;
mod content;
mod distance;
mod origin;
mod rows;
mod search;
mod tip;
mod within;

pub use camera::sight;
pub use content::Content;
pub use origin::{HashedFile, prior_read};
pub use rows::{DataFile, Rows, RowsAsked, rows};
pub use search::{SearchAsked, earlier, freedom, other_chains, search};
pub use tip::{all_known, taken_at_averages, with_given, without_part_in_the_tip};
pub use within::{corners, moving};

use denavit_identify::posterior::EarlierError;
use denavit_identify::proportion::OutOfProportion;
use denavit_measurements::DataError;
use thiserror::Error;

/// Why words or files make no rows and no options.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum MeasuredError {
    /// An option that cannot be.
    #[error("{0}")]
    Option(String),
    /// A robot larger than anything that is measured.
    #[error(transparent)]
    OutOfProportion(#[from] OutOfProportion),
    /// Measurements that cannot be read.
    #[error(transparent)]
    Data(#[from] DataError),
    /// A file that can no longer be read.
    #[error("{file}: {error}")]
    Unreadable {
        /// The file.
        file: String,
        /// Why.
        error: std::io::Error,
    },
    /// A calibration that nothing can be continued from.
    #[error(transparent)]
    Earlier(#[from] EarlierError),
}
