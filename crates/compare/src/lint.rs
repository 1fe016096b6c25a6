//! Rules for URDF files.

use crate::report::Level;
use denavit_model::Place;
use serde::Serialize;

/// What a rule found.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Finding {
    /// The rule's code.
    pub rule: &'static str,
    /// How serious it is.
    pub level: Level,
    /// Where.
    pub place: Place,
    /// What is wrong, with the value; the mend.
    pub message: String,
    /// An edit that mends it without doubt.
    pub fix: Option<Edit>,
}

/// A piece of the text and what belongs there.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Edit {
    /// Byte offset of its start.
    pub start: usize,
    /// Byte offset behind its end.
    pub end: usize,
    /// What belongs there.
    pub text: String,
}
