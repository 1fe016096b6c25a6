//! Errors that end a fleet run; an error of one robot is a row of the store instead.

use std::path::{Path, PathBuf};
use thiserror::Error;

/// Why a fleet run is impossible.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum FleetError {
    /// Not a manifest.
    #[error("{place}: {message}")]
    Manifest {
        /// File, and line or entry.
        place: String,
        /// What is wrong and the fix.
        message: String,
    },
    /// An operating system error for a file or folder of the store.
    #[error("{}: {reason}; finished results are kept; fix this and run the same command again", file.display())]
    Store {
        /// The file.
        file: PathBuf,
        /// The system's words.
        reason: String,
    },
    /// A file of the store with other content.
    #[error("{}: this is not a file of a fleet store: {reason}; remove it from the folder", file.display())]
    NotOurs {
        /// The file.
        file: PathBuf,
        /// What is missing.
        reason: String,
    },
    /// Another run writes the store.
    #[error("{}: another run is writing to this store; wait for it, or name another folder", .0.display())]
    Busy(PathBuf),
    /// A folder that has no store.
    #[error("{}: this folder has no fleet store; `denavit fleet run MANIFEST -o FOLDER` makes one", .0.display())]
    NoStore(PathBuf),
    /// A worker process that sees other files or has another version.
    #[error(
        "{0}: its files differ from those at the start of the run; every machine needs the same files under the same \
         names and the same version of denavit, and the files must not change during the run; fix this and run again: \
         finished results are kept"
    )]
    OtherFiles(String),
    /// A source that cannot be read.
    #[error(transparent)]
    Load(#[from] denavit_load::LoadError),
    /// Git refuses.
    #[error("{0}")]
    Git(String),
    /// A page that cannot be made.
    #[error("the page cannot be made: {0}")]
    Page(#[from] minijinja::Error),
}

impl FleetError {
    /// For a file of the store.
    pub(crate) fn store(file: &Path) -> impl FnOnce(std::io::Error) -> Self + '_ {
        move |error| Self::Store { file: file.to_owned(), reason: error.to_string() }
    }

    /// For an entry of a manifest.
    pub(crate) fn manifest(place: impl Into<String>, message: impl Into<String>) -> Self {
        Self::Manifest { place: place.into(), message: message.into() }
    }
}
