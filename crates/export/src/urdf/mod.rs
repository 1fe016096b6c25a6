//! Writes URDF: the canonical form of a robot, a URDF of a table, and a URDF with calibrated joint origins.
//!
//! ```text
//! Robot ──► canonical   link frames are D-H frames, the rest of the text stays byte for byte
//! Table ──► from_table  a URDF that any viewer shows; read_off returns the same table
//! Robot, Chain ──► with_chain   joint origins changed so that the robot moves like the chain
//! ```
//!
//! **Canonical form.** A joint's child link frame lies on the joint's axis (z), x along the common normal with the
//! axis before, and the joint's origin is the row that leads there: rpy="alpha 0 theta", xyz="a·cos(theta)
//! a·sin(theta) d". The axis before is that of the joint which carries the rigid body, or z of the root link. So
//! - only links between two moving joints get new frames: the root link, the tip of the table, links that carry nothing further (tips, fingers,
//!   wheels), links on fixed joints (flange, tool0, cameras, mounts), and links after floating, planar and unknown joints
//!   keep theirs;
//! - the origin of a joint on a link that is fixed to the body leads from that link to the end of the row;
//! - the table of the result is the table of the source, along the same chain;
//! - no joint's zero or sense moves: limits, mimics, transmissions and controllers stay as they are;
//! - where neighbouring axes are nearly parallel and the common normal would lie far away, the origin has a small pitch
//!   (Hayati's row), with a note: the motion is never changed for rounder numbers;
//! - joints already in this form are not changed.

mod bodies;
mod calibrated;
mod edit;
mod frames;
mod from_table;
mod keep;
mod markers;
mod nodes;
mod origin;
mod placing;
mod read_off;
mod reframe;
mod shape;
mod verify;
mod written;

/// Edits of a URDF's text, for other crates.
pub mod text {
    pub use super::edit::{Edits, escaped, with_line_break};
    pub use super::nodes::Nodes;
    pub use super::origin::{joint_origin, numbers_of};
    pub use super::parse;
    pub use super::placing::{Placing, placing};
    pub use super::reframe::Moves;
    pub use super::written::{Numbers, clean, three, word};
}

pub(crate) use calibrated::zeros_taken_in;
pub use calibrated::{with_chain, with_chains};
pub use from_table::from_table;
pub use read_off::read_off;

use bodies::Bodies;
use denavit_dh::{Gauge, Parallelism};
use denavit_model::UrdfError;
use denavit_model::chain::ChainError;
use denavit_model::notes::{Noted, Place};
use denavit_model::robot::Robot;
use denavit_model::tree::{Reading, TreeError};
use edit::Edits;
use frames::Plan;
use roxmltree::{Document, ParsingOptions};
use thiserror::Error;

/// Where on a joint's axis its child link's frame lies.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Frames {
    /// At the foot of the common normal with the axis before: a joint's origin is a row of the distal (standard) table.
    #[default]
    Distal,
    /// At the foot of the common normal with the next axis: a joint's origin is Rx(alpha) Tx(a) Rz(theta) Tz(d), a row
    /// of the proximal (modified) table. At a branch of the tree the first path decides.
    Proximal,
}

/// How the file represents the frames of the canonical form.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum LinkFrames {
    /// The links themselves get these frames.
    #[default]
    Replace,
    /// New links get these frames; the old links keep theirs, fixed to the new ones.
    Keep,
    /// Marker links dh_0 … dh_n show the frames of one chain; nothing moves.
    MarkOnly,
}

/// Options of the export.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Options {
    /// Which links get the frames.
    pub link_frames: LinkFrames,
    /// Where on the axes they lie.
    pub frames: Frames,
    /// How the file's angles are read; angles read as intended are also written as intended.
    pub reading: Reading,
    /// Choice that the geometry does not determine.
    pub gauge: Gauge,
    /// Which neighbouring axes are too close to parallel for a D-H row.
    pub parallelism: Parallelism,
    /// Base link of the chain whose table the frames follow, which keeps its frame; `None`: that of
    /// [`Robot::default_chain`].
    pub base: Option<String>,
    /// Tip link of that chain; `None`: that of [`Robot::default_chain`].
    pub tip: Option<String>,
}

/// Why a URDF could not be made.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum ExportError {
    /// No link of that name.
    #[error("{file}: the robot has no link \"{name}\"; `denavit chains` lists base and tip links")]
    NoSuchLink {
        /// The file.
        file: String,
        /// The requested name.
        name: String,
    },
    /// The joints do not form a chain.
    #[error("{file}: {source}")]
    Chain {
        /// The file.
        file: String,
        /// Why.
        source: ChainError,
    },
    /// No such chain in the tree.
    #[error(transparent)]
    Tree(#[from] TreeError),
    /// Another element already has a name that is needed.
    #[error("{place}: the export needs this name for a frame; rename this element")]
    NameTaken {
        /// Who has it.
        place: Place,
    },
    /// Something refers to a link's frame that changes, and cannot be expressed in the new frame.
    #[error("{place}: {what}")]
    NotCarried {
        /// Where.
        place: Place,
        /// What, and what to do.
        what: String,
    },
    /// The text differs from the element tree, or the result does not move like the source: a part of the text is out of
    /// reach of edits, such as an XML entity.
    #[error("{file}: {what}; expand XML entities and give each link one <inertial>, then export again")]
    Unfaithful {
        /// The file.
        file: String,
        /// What differs.
        what: String,
    },
    /// The result differs from the robot by more than rounding, although the text can be edited: a bug of the export.
    #[error("{file}: {what}; nothing was written. Try ‹keep-link-frames› or ‹exact›, and please report this file")]
    Inexact {
        /// The file.
        file: String,
        /// What differs.
        what: String,
    },
    /// The result is not a URDF.
    #[error("the exported text is not a valid URDF: {0}")]
    Unreadable(#[from] UrdfError),
    /// A table has something that URDF cannot express.
    #[error("joint \"{joint}\": {what}")]
    NotInUrdf {
        /// The joint.
        joint: String,
        /// What is wrong, and the fix.
        what: String,
    },
}

/// The URDF of a robot in canonical form; see the module's description.
///
/// # Errors
/// A link or name is missing or taken, or the text has parts that edits cannot reach. The result is read back and
/// compared with the source before it is returned.
///
/// # Examples
/// ```
/// use denavit_export::urdf::{Options, canonical};
/// let robot = denavit_model::urdf::read("slide.urdf", r#"<robot name="slide">
///   <link name="base"/> <link name="carriage"/> <link name="tip"/>
///   <joint name="rail" type="prismatic"> <parent link="base"/> <child link="carriage"/> <axis xyz="0 1 0"/> </joint>
///   <joint name="turn" type="continuous"> <parent link="carriage"/> <child link="tip"/> <axis xyz="1 0 0"/> </joint>
/// </robot>"#)?;
/// let text = canonical(&robot, &Options::default())?.value;
/// assert!(text.contains(r#"<axis xyz="0 0 1"/>"#));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn canonical(robot: &Robot, options: &Options) -> Result<Noted<String>, ExportError> {
    let bodies = Bodies::of(robot, options.reading);
    let document = parse(robot)?;
    let mut edits = Edits::default();
    let mut notes = bodies.notes.clone();
    let mut stays = vec![true; robot.links.len()];
    match options.link_frames {
        LinkFrames::MarkOnly => {
            notes.clear();
            // Their frames stay as written, regardless of intended angles.
            stays.fill(false);
            notes.extend(markers::add(robot, &document, options, &mut edits)?);
        }
        LinkFrames::Replace => {
            let plan = Plan::of(robot, &bodies, options)?;
            notes.extend(reframe::edit(robot, &document, &bodies, &plan, &mut edits)?);
            stays.clone_from(&plan.kept);
            notes.extend(plan.notes);
        }
        LinkFrames::Keep => {
            let plan = Plan::of(robot, &bodies, options)?;
            keep::edit(robot, &document, &bodies, &plan, &mut edits)?;
            notes.extend(plan.notes);
        }
    }
    let changed = !edits.is_empty();
    let value = edits.apply(&robot.source)?;
    if changed {
        verify::same_robot(robot, &bodies, &value, &stays)?;
    }
    Ok(Noted { value, notes })
}

/// The elements of a robot's text.
///
/// # Errors
/// The text cannot be parsed.
pub fn parse(robot: &Robot) -> Result<Document<'_>, ExportError> {
    let options = ParsingOptions { allow_dtd: true, ..ParsingOptions::default() };
    Document::parse_with_options(&robot.source.text, options).map_err(|error| ExportError::Unfaithful {
        file: robot.source.file.clone(),
        what: format!("the text cannot be parsed again: {error}"),
    })
}
