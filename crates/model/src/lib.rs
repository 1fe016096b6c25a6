//! From a URDF to a tree of links and joints, and from there to a chain of screw axes.
//!
//! ```text
//! URDF text ──► Robot (tree, everything kept) ──► Chain (screw axes, home pose) ──► forward kinematics, Jacobian
//! ```
//! The crate opens no files and does not handle Denavit-Hartenberg parameters. Lengths are in m, angles in rad.

pub mod chain;
pub mod compiled;
pub mod element;
pub mod examples;
mod fk;
pub mod formats;
pub mod forms;
pub mod hull;
pub mod intended;
pub mod inventory;
pub mod loops;
pub mod notes;
pub mod placed;
pub mod posed;
pub mod problems;
pub mod robot;
pub mod screw;
pub mod se3;
pub mod settings;
pub mod tree;
pub mod units;
pub mod urdf;
#[cfg(feature = "urdf-rs")]
pub mod urdf_rs_robot;
pub mod well_formed;
pub mod words;
pub mod write;

pub use chain::{Chain, ChainError, ChainJoint, Coordinate, Limits, Quantity, Tip, Tips, TipsError};
pub use compiled::{CompiledChain, JacobianFrame};
pub use element::Element;
pub use inventory::{Inventory, Item, Outcome};
pub use nalgebra;
pub use notes::{Note, Noted, Place};
pub use placed::PlacedRobot;
pub use problems::{Problem, ProblemKind, UrdfError};
pub use robot::{Joint, JointKind, Link, Robot};
pub use screw::{AxisLine, Pitch, Screw, TwistError};
pub use se3::Pose;
pub use tree::{Reading, TreeError};
