//! The operations, a file each.

pub(crate) mod attach;
pub(crate) mod calibration;
pub(crate) mod collision;
pub(crate) mod frames;
pub(crate) mod merge;
pub(crate) mod meshes;
pub(crate) mod mirror;
pub(crate) mod part;
pub(crate) mod rename;
pub(crate) mod reroot;
pub(crate) mod scale;
pub(crate) mod sense;
pub(crate) mod snap;

use crate::error::EditError;
use denavit_model::robot::SourceText;
use roxmltree::Document;

/// # Errors
/// The SRDF is no XML.
pub(crate) fn parse_srdf(source: &SourceText) -> Result<Document<'_>, EditError> {
    Document::parse(&source.text).map_err(|error| EditError::Srdf { file: source.file.clone(), why: error.to_string() })
}
