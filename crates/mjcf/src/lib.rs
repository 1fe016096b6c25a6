//! MJCF, the models of MuJoCo, to and from the one tree of links and joints.
//!
//! ```text
//! MJCF text ──► document (includes, classes) ──► bodies ──► URDF text with the places of the MJCF ──► Robot ──► MJCF
//! ```
//! The crate opens no files: what a model includes, and meshes whose volume gives a mass, come through a function of the
//! caller's. Lengths are m, angles rad; the reader converts degrees, MJCF's default.
//!
//! # Source
//! <https://mujoco.readthedocs.io/en/stable/XMLreference.html>
//!
//! # Examples
//! ```
//! let text = r#"<mujoco model="arm"><worldbody><body name="base"> <geom size=".1" mass="2"/>
//!   <body name="tip" pos="0 0 .5"> <joint name="j" axis="0 1 0" range="-90 90"/> <geom size=".1"/> </body> </body>
//!   </worldbody></mujoco>"#;
//! let made = denavit_mjcf::translated("arm.xml", text, &mut |name| Err(format!("{name} is not there")))?;
//! let robot = made.robot("arm.xml")?;
//! assert_eq!(robot.joints[0].limits.range.unwrap().1, std::f64::consts::FRAC_PI_2);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod bodies;
mod document;
mod emit;
mod known;
mod mass;
mod mesh;
mod place;
mod srdf;
mod write;

pub use mesh::triangles as mesh_triangles;
pub use srdf::{Srdf, srdf};
pub use write::{WriteOptions, write};

use denavit_model::formats::{Builder, FormatError};

/// A file that a model names, relative to the model's own folder: its content, or why there is none.
pub type Files<'a> = dyn FnMut(&str) -> Result<Vec<u8>, String> + 'a;

/// The URDF text of a model, which holds the places of its lines and what URDF cannot state: see
/// [`formats`](denavit_model::formats).
///
/// `file` is used in messages; `files` gives what the model includes, and meshes where their volume gives a mass.
///
/// # Errors
/// Everything that is wrong with the model, each with file, line, element and what to do.
pub fn read(file: &str, text: &str, files: &mut Files) -> Result<String, FormatError> {
    Ok(translated(file, text, files)?.text())
}

/// As [`read`], with the tree of the text, so that the text need not be parsed: [`Builder::robot`].
///
/// # Errors
/// Those of [`read`].
pub fn translated(file: &str, text: &str, files: &mut Files) -> Result<Builder, FormatError> {
    let included = document::Included::default();
    let document = document::read(file, text, &included, files)?;
    let model = bodies::model(&document, files)?;
    Ok(emit::urdf(&document, model))
}
