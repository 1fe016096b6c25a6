//! SDFormat: from a model in SDF to URDF text of the same robot, and back.
//!
//! ```text
//! SDF ─► sources (includes) ─► model (names) ─► frames (poses) ─► tree (what carries what) ─► URDF text ─► Robot ─► SDF
//! ```
//! The crate opens no files: the caller fetches what a model includes. Lengths are in m, angles in rad.

mod error;
mod frames;
mod gearbox;
pub mod includes;
mod inertia;
mod joints;
mod known;
mod model;
mod names;
mod pose;
mod read;
mod shapes;
mod sources;
mod tree;
mod write;

pub use read::{read, translated};
pub use write::write;
