//! Kinematics of one robot as source code: a single file without dependencies, numbers and structure written out.
//!
//! ```text
//! Table ──► Program (unrolled, constants folded) ──► C · C++ · Rust · Python · MATLAB
//! ```
//! The rows of a Denavit-Hartenberg table are multiplied out symbolically. Products with 0 and ±1 vanish, quarter turns become
//! signs, so that a 6R arm takes some 150 multiplications with its Jacobian. No loop, no heap, no branch: the code takes the
//! same time for every posture. [`effects`] of a calibration are functions of their own. Each file holds postures, poses and Jacobians of its own, and a self-test that compares them.

mod batch;
mod correction;
pub mod effects;
mod evaluate;
mod geometry;
mod inverse;
mod program;
mod render;
mod render_effects;
mod spread;

pub use render::{CodeError, LANGUAGES, Language, Options, Precision, code, code_with_effects};
