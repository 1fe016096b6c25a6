//! Inverse kinematics from screw axes: every branch of the drawn robot in closed form, carried to the calibrated robot by Newton's
//! method.
//!
//! ```text
//! Chain ──► class (wrist, three parallel axes, general; either end) ──► drawn arm ──► candidates ──► Newton on the chain ──► Solutions
//! ```
//! A calibrated arm's axes are nearly, not exactly, parallel or concurrent: the nearest exact arm gives the branches, Newton's method
//! carries each to the arm as it is. Lengths are m, angles rad. Nothing is allocated per pose once [`Solutions`] has grown.

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
