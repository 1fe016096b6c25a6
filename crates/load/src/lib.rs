//! Loads a robot from any source: URDF, MJCF, SDF, xacro, D-H table in CSV, Markdown, JSON or as printed, screw axes in CSV or JSON, a
//! maker's kinematics file, a revision in git.
//!
//! ```text
//! name ──► text ──► what is it? ──► Loaded ──► chain · table · canonical URDF · subject of a comparison
//! ```
//! The command line and the Python package read robots through this crate. It opens the files that it is given and what a
//! xacro file includes; it writes nothing and prints nothing.
//!
//! ```
//! use denavit_load::{Loaded, Options, from_text};
//! let table = "joint,kind,theta,d,alpha,a\nj1,revolute,0,0.4,-90,0.025\nj2,revolute,0,0,0,0.56\n";
//! let opened = from_text("arm.csv", table, &Options::default())?;
//! assert!(matches!(opened.robot, Loaded::Table { .. }));
//! # Ok::<(), denavit_load::LoadError>(())
//! ```

mod canonical;
mod checked;
mod convert;
mod error;
pub mod json;
#[cfg(feature = "calibrate")]
pub mod measured;
mod merged;
mod meshes;
mod project;
mod read;
mod repository;
mod revision;
mod robot;
mod table;
mod translate;
mod urdf_text;

pub use canonical::{canonical, same_table};
pub use checked::{CheckError, CheckOptions, Rules};
pub use convert::{ConvertOptions, convert, sidecar_of, srdf_of};
pub use denavit_xacro::package_name;
pub use error::LoadError;
pub use meshes::{Copies, Copy, MeshFile, Meshes, copies, meshes, triangles};
pub use project::{FILE_NAME, Project, ProjectRobot};
pub use read::{Expanded, STANDARD_INPUT, expanded, expanded_with_trace, from_text, load, read_bytes, read_text};
pub use repository::{Described, Pair, Pairs, pairs};
pub use robot::{Listing, Loaded, Selection};
pub use table::{Made, NEARLY_PARALLEL, TableOptions};
pub use urdf_text::{UrdfText, is_markup, urdf_text, why_a_part};

use denavit_export::sources::Stated;
use denavit_model::Inventory;
use std::path::PathBuf;

/// Options that some sources need, but not a URDF.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Options {
    /// Arguments of a xacro file, name and value.
    pub arguments: Vec<(String, String)>,
    /// Whether the arguments may belong to another source that is read with the same options: a source that is not xacro
    /// then accepts them.
    pub arguments_for_another: bool,
    /// Folders with ROS packages, or packages.
    pub package_path: Vec<PathBuf>,
    /// Whether xacro may read files outside its package and the package path.
    pub allow_any_file: bool,
    /// Whether the angles of a UR kinematics file are read as the vendor's tool means them, Rx Ry Rz.
    pub vendor_angles: bool,
    /// Convention and units of a D-H table whose file does not state them.
    pub stated: Stated,
}

/// A robot, and the notes of reading it.
#[derive(Debug, Clone)]
pub struct Opened {
    /// The robot.
    pub robot: Loaded,
    /// Notes on the expansion of a xacro file, and on assumptions about a table.
    pub notes: Vec<String>,
    /// Whether it is xacro, or another source that takes arguments, so that the arguments are its own.
    pub is_xacro: bool,
    /// Files that the source made us read beside itself: what a xacro file includes, and its yaml.
    pub includes: Vec<PathBuf>,
    /// What became of everything in a table or maker's file.
    pub(crate) read: Inventory,
}

impl Opened {
    /// What became of everything in the source: understood, carried along, reported.
    pub fn inventory(&self) -> Inventory {
        match &self.robot {
            Loaded::Robot(robot) => robot.inventory(),
            Loaded::Table { .. } | Loaded::Poe(_) => self.read.clone(),
        }
    }
}
