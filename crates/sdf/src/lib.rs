//! SDFormat: from a model in SDF to URDF text that stands for the same robot, and back.
//!
//! ```text
//! SDF ─► sources (includes) ─► model (names) ─► frames (poses) ─► tree (what carries what) ─► URDF text ─► Robot ─► SDF
//! ```
//! The crate opens no files: what a model includes is fetched by the caller. Lengths are m, angles rad.

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
