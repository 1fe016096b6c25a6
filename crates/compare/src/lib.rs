//! Differences between robots with bounds, fingerprints, and rules for URDF files.
//!
//! ```text
//! a, b ──► Mechanism (no link frames) ──► Comparison ──► text · json · junit · sarif · github · markdown · badge
//! a    ──► Mechanism ──► Fingerprint
//! text ──► RULES ──► findings ──► the same reports, or the text with certain fixes applied
//! ```
//! The crate opens no files; the caller provides the lookup of meshes.

mod across;
pub mod compared;
pub mod comparison;
pub mod describe;
pub mod diff;
pub mod fingerprint;
pub mod lint;
pub mod mechanism;
pub mod proof;
pub mod report;
pub mod robots;
pub mod subject;
mod words;

pub use comparison::{Change, Comparison, JointChange, JointDifference, PartDifference, TipDifference, Verdict};
pub use diff::{Options, Range, Scope, compare};
pub use fingerprint::{Fingerprint, FingerprintError, fingerprint, fingerprint_as};
pub use lint::Finding;
pub use subject::Subject;
