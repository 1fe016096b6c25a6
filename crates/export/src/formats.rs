//! The list of formats for tables. One file a format; everything that lists formats walks [`FORMATS`].

pub mod csv;
pub mod json;
pub mod latex;
pub mod markdown;
pub mod matlab;
pub mod opw;
pub mod robotics_toolbox;
pub mod text;
pub mod ur_kinematics;

use crate::sheet::Sheet;
use thiserror::Error;

/// A way to write a table.
pub struct Format {
    /// The word on the command line.
    pub name: &'static str,
    /// Usual extension of its files, without the dot.
    pub extension: &'static str,
    /// What it is for, a few words.
    pub purpose: &'static str,
    /// Writes it.
    pub render: fn(&Sheet) -> Result<String, RenderError>,
}

/// Every format, in the order of `--help`.
pub const FORMATS: &[Format] = &[
    text::FORMAT,
    markdown::FORMAT,
    csv::FORMAT,
    json::FORMAT,
    latex::FORMAT,
    robotics_toolbox::FORMAT,
    matlab::FORMAT,
    ur_kinematics::FORMAT,
    opw::FORMAT,
];

/// The format of this name.
pub fn named(name: &str) -> Option<&'static Format> {
    FORMATS.iter().find(|format| format.name == name)
}

/// Why a table cannot be written in a format.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum RenderError {
    /// The format is for other robots.
    #[error("{format}: {why}")]
    OtherRobots {
        /// The format's name.
        format: &'static str,
        /// What it takes and what the robot has.
        why: String,
    },
    /// The format cannot represent something in the table.
    #[error("{format} has no {what}; {instead}")]
    CannotHold {
        /// The format's name.
        format: &'static str,
        /// What it lacks.
        what: &'static str,
        /// What to do.
        instead: &'static str,
    },
}
