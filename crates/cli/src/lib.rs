//! Robot models from descriptions: screw axes, Denavit-Hartenberg tables, inverse kinematics, comparison, export and calibration.
//!
//! The root of this crate re-exports what most programs need of its parts, `denavit-model`, `denavit-dh` and so on; its modules are
//! those crates in full. The modules of `calibrate` change without notice, the names at its root do not. `default-features = false`
//! leaves out calibration and inverse kinematics (`Solver`). The program of the same name is in this package.
//!
//! # Quick start
//!
//! Load a robot and compute the pose and the Jacobian of its tip:
//!
//! ```
//! # std::env::set_current_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/../../robots/universal_robots"))?;
//! use denavit::{Options, Selection, load};
//!
//! // URDF, MJCF, SDF, xacro, a table, screw axes, a maker's file, or git:REVISION:PATH.
//! let robot = load("ur5e.urdf", &Options::default())?.robot;
//! let arm = Selection { file: "ur5e.urdf", base: Some("base"), tip: Some("tool0"), ..Selection::default() };
//! let chain = robot.chain(&arm)?.value;
//!
//! let q = [0.0, -1.57, 1.57, 0.0, 0.0, 0.0]; // rad, within chain.coordinates()[i].range()
//! let pose = chain.fk(&q); // base from tip, m
//! let mut columns = vec![denavit::model::nalgebra::Vector6::zeros(); q.len()]; // of the Jacobian: angular first
//! chain.space_jacobian_into(&q, &mut columns);
//! # let _ = pose;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Its table for a document, and the URDF whose link frames are the frames of that table:
//!
//! ```
//! # std::env::set_current_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/../../robots/universal_robots"))?;
//! use denavit::{Convention, NEARLY_PARALLEL, Options, Selection, Sheet, TableOptions, canonical, formats, load};
//!
//! let robot = load("ur5e.urdf", &Options::default())?.robot;
//! let arm = Selection { file: "ur5e.urdf", base: Some("base"), tip: Some("tool0"), ..Selection::default() };
//! let options = TableOptions { convention: Some(Convention::Distal), gauge: None, tolerance: NEARLY_PARALLEL };
//! let made = robot.table(&arm, &options)?;
//! let sheet = Sheet {
//!     table: &made.table.value,
//!     notes: &made.table.notes,
//!     convention: made.convention,
//!     gauge: made.gauge,
//!     units: denavit::export::Units::default(),
//!     source: "ur5e.urdf",
//! };
//! let text = (formats::named("text").expect("it is one of formats::FORMATS").render)(&sheet)?;
//! assert!(text.contains("-0.3922"));
//! let urdf = canonical(&robot, "ur5e.urdf", &denavit::export::urdf::Options::default())?.value;
//! assert!(urdf.starts_with("<?xml"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Whether an edit changed the robot, with a bound for every posture:
//!
//! ```
//! # std::env::set_current_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/../../robots/universal_robots"))?;
//! use denavit::{Options, Verdict, compare, from_text, load};
//!
//! let before = load("ur5e.urdf", &Options::default())?.robot;
//! let edited = std::fs::read_to_string("ur5e.urdf")?.replace("-0.425", "-0.427");
//! let after = from_text("edited.urdf", &edited, &Options::default())?.robot;
//! let found = compare(&before.subject("ur5e.urdf"), &after.subject("edited.urdf"), &denavit::compare::Options::default())?;
//! assert_eq!(found.verdict, Verdict::Different);
//! let tip = found.largest().expect("it moved");
//! assert!(tip.sampled_m <= tip.bound_m && (tip.bound_m - 0.002).abs() < 1e-9);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Errors
//! Every error is one sentence that names the file, the element and the fix. Lengths are m, angles rad, everywhere.

pub use denavit_code as code;
pub use denavit_compare as compare;
pub use denavit_dh as dh;
pub use denavit_edit as edit;
pub use denavit_export as export;
pub use denavit_load as load;
pub use denavit_model as model;

pub use denavit_compare::{Comparison, Fingerprint, Verdict, compare, fingerprint};
pub use denavit_dh::{Convention, Table};
pub use denavit_edit::{Operation, apply};
pub use denavit_export::{Sheet, formats};
pub use denavit_load::{
    LoadError, Loaded, NEARLY_PARALLEL, Opened, Options, Project, Rules, Selection, TableOptions, canonical, from_text,
    load,
};
pub use denavit_model::{Chain, Pose, Reading, Robot};

#[cfg(feature = "calibrate")]
pub use denavit_ik as ik;
#[cfg(feature = "calibrate")]
pub use denavit_ik::Solver;

#[cfg(feature = "calibrate")]
pub use denavit_calibrate as calibrate;
#[cfg(feature = "calibrate")]
pub use denavit_calibrate::{CalibrateOptions, calibrate};
#[cfg(feature = "calibrate")]
pub use denavit_hand_eye as hand_eye;
