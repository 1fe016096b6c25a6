//! Inverse kinematics from screw axes: every branch of the nominal robot in closed form, refined for the calibrated robot by Newton's
//! method.
//!
//! ```text
//! Chain ──► class (wrist, three parallel axes, general; either end) ──► nominal arm ──► candidates ──► Newton on the chain ──► Solutions
//! ```
//! A calibrated arm's axes are nearly, not exactly, parallel or concurrent: the nearest exact arm gives the branches, and Newton's method
//! refines each for the real arm. Lengths are in m, angles in rad. Nothing is allocated per pose once [`Solutions`] has grown.

mod arm;
mod branch;
mod circles;
mod class;
mod eigenvalues;
mod general;
mod newton;
mod parallel;
mod quartic;
mod seven;
mod six;
mod solver;
mod wrist;

pub use branch::Branch;
pub use class::Class;
pub use solver::{Found, Method, Solutions, Solver};
