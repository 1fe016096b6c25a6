//! Why a source is no robot.

use thiserror::Error;

/// Why a source is no robot, or has no such chain or table.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum LoadError {
    /// A file could not be read.
    #[error("{file}: cannot be read: {reason}")]
    Read {
        /// As given.
        file: String,
        /// The system's words.
        reason: String,
    },
    /// Bytes that are no text.
    #[error("{file}:{line}: not UTF-8 text; save the file as UTF-8")]
    NotText {
        /// As given.
        file: String,
        /// Counted from 1.
        line: usize,
    },
    /// Text that is no source.
    #[error(
        "{file}: this is not a robot in a known format: neither XML (URDF, MJCF, SDF, xacro), nor a table with columns theta, d, alpha, a, nor \
         JSON, nor a maker's kinematics file; it begins with \"{begins}\""
    )]
    NoRobot {
        /// As given.
        file: String,
        /// Its first line.
        begins: String,
    },
    /// Not a URDF.
    #[error(transparent)]
    Urdf(#[from] denavit_model::UrdfError),
    /// A description in another format that is no robot.
    #[error(transparent)]
    Format(#[from] denavit_model::formats::FormatError),
    /// A chain that is not there.
    #[error(transparent)]
    Tree(#[from] denavit_model::TreeError),
    /// Not a table's file.
    #[error(transparent)]
    Source(#[from] denavit_export::sources::SourceError),
    /// A xacro file that does not expand.
    #[error(transparent)]
    Xacro(#[from] denavit_xacro::XacroError),
    /// Arguments of a xacro file for another source.
    #[error(
        "{file}: this is not a xacro file, so it takes no argument {argument}; leave the argument out, or name the xacro file \
         that the robot is made from"
    )]
    NoXacro {
        /// As given.
        file: String,
        /// The first argument, NAME:=VALUE.
        argument: String,
    },
    /// Not a UR kinematics file.
    #[error(transparent)]
    Kinematics(#[from] denavit_export::kinematics_yaml::KinematicsFileError),
    /// Parts that make no chain.
    #[error("{file}: {source}")]
    Chain {
        /// As given.
        file: String,
        /// Why.
        source: denavit_model::ChainError,
    },
    /// Tips that make no tree.
    #[error("{file}: {source}")]
    Tips {
        /// As given.
        file: String,
        /// Why.
        source: denavit_model::TipsError,
    },
    /// A robot that cannot be exported.
    #[error(transparent)]
    Export(#[from] denavit_export::urdf::ExportError),
    /// A base or tip where the file has one chain only.
    #[error("{file}: {option} chooses a link of a URDF; this file has one chain, ending at \"{tip}\"")]
    OneChain {
        /// As given.
        file: String,
        /// `--base` or `--tip`.
        option: &'static str,
        /// Where the chain ends.
        tip: String,
    },
}
