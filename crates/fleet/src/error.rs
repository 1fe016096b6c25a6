//! What ends a fleet's run; what is wrong with one robot is a row of the store instead.

use std::path::{Path, PathBuf};
use thiserror::Error;

/// Why a run over a fleet cannot be done.
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
    /// A file or folder of the store that the system refuses.
    #[error("{}: {reason}; what was finished is kept, run the same command again when this is fixed", file.display())]
    Store {
        /// The file.
        file: PathBuf,
        /// The system's words.
        reason: String,
    },
    /// A file of the store that holds something else.
    #[error("{}: this is no file of a fleet's store: {reason}; take it out of the folder", file.display())]
    NotOurs {
        /// The file.
        file: PathBuf,
        /// What is missing.
        reason: String,
    },
    /// Another run writes the store.
    #[error("{}: another run writes into this store; wait for it, or name another folder", .0.display())]
    Busy(PathBuf),
    /// A folder that has no store.
    #[error("{}: there is no fleet's store in this folder; `denavit fleet run MANIFEST -o FOLDER` makes one", .0.display())]
    NoStore(PathBuf),
    /// A process that computes for another, and sees something else.
    #[error(
        "{0}: its files are not those that the run began with; every machine must see the same files under the same names, \
        have the same version of denavit, and nobody may change them meanwhile; fix that and run it again: what was finished \
        is kept"
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
