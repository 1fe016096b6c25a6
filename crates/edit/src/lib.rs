//! Edits of a URDF's text, each with a proof of what stays the same.
//!
//! ```text
//! Files (URDF, SRDF) ──► Operation ──► Change (new text, claim) ──► proof ──► Files, reports
//! ```
//! An operation changes the text where it must; what it does not touch stays byte for byte. With the new text it returns a
//! [`Claim`]: where every link, joint and mass of the old robot is in the new one. The proof reads the new text as
//! any reader would and checks the claim at joint values that move all joints; if the claim is false, there is no
//! result. The crate opens no files.
//!
//! ```
//! use denavit_edit::{Files, Operation, apply};
//! let text = r#"<robot name="r"> <link name="base"/> <link name="tip"/>
//!   <joint name="j" type="revolute"> <parent link="base"/> <child link="tip"/> <limit lower="-1" upper="2"/> </joint> </robot>"#;
//! let done = apply(&Files::urdf("r.urdf", text), &[Operation::Flip { joint: "j".into() }])?;
//! assert!(done.files.urdf.text.contains(r#"<limit lower="-2" upper="1"/>"#));
//! assert!(done.files.urdf.text.contains(r#"<axis xyz="-1 0 0"/>"#));
//! # Ok::<(), denavit_edit::EditError>(())
//! ```

mod claim;
mod error;
mod json;
mod literal;
mod operation;
mod operations;
mod proof;
mod references;
mod solids;
mod tally;
mod value;
mod values;

pub use claim::{Claim, JointMap, Space};
pub use error::EditError;
pub use json::{SCHEMA, to_json};
pub use operation::{OPERATIONS, Operation, OperationHelp, Words};
pub use operations::calibration::{Actual, Frames};
pub use operations::collision::{Meshes, Simple, Simplified};
pub use operations::rename::Renaming;
pub use proof::Proof;
pub use references::{Kind, named_by_attribute, named_by_text};
pub use solids::Triangle;
pub use value::Plane;

use denavit_model::robot::{Robot, SourceText};
use denavit_model::urdf;
use tally::Tally;

/// A file's name, for messages, and its text.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Text {
    /// As the user named it.
    pub file: String,
    /// Its content.
    pub text: String,
}

/// What is edited together.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Files {
    /// The robot.
    pub urdf: Text,
    /// Its SRDF for MoveIt, if given: names and joint values in it are updated.
    pub srdf: Option<Text>,
}

impl Files {
    /// A robot alone.
    pub fn urdf(file: impl Into<String>, text: impl Into<String>) -> Self {
        Self { urdf: Text { file: file.into(), text: text.into() }, srdf: None }
    }
}

/// What one operation did.
#[derive(Debug, Clone, PartialEq)]
pub struct Report {
    /// The requested operation.
    pub operation: String,
    /// Its claim about everything in the old robot.
    pub claim: Claim,
    /// How accurately the claim holds.
    pub proof: Proof,
    /// What changed: `joint_3 reversed`, `2 limits exchanged`.
    pub changes: Vec<String>,
    /// What the edit could not update, or changed in addition; sentences.
    pub notes: Vec<String>,
}

impl std::fmt::Display for Report {
    /// `flip joint_3: moves as before within 1e-16 m; joint_3 reversed; 2 limits exchanged`
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}: {}", self.operation, self.proof)?;
        self.changes.iter().try_for_each(|change| write!(f, "; {change}"))
    }
}

/// The edited files, and a report on each operation.
#[derive(Debug, Clone, PartialEq)]
pub struct Done {
    /// The new texts.
    pub files: Files,
    /// One for each operation, in order.
    pub reports: Vec<Report>,
    /// Mesh files that are new, by the names that the robot's text has for them.
    pub meshes: Vec<Text>,
}

/// The new text of an operation, before it is proved.
#[derive(Debug)]
pub(crate) struct Change {
    urdf: String,
    srdf: Option<String>,
    claim: Claim,
    /// Another robot that is part of the new one, and where.
    second: Option<(Robot, Claim)>,
    /// Mesh files that the text names.
    files: Vec<Text>,
    tally: Tally,
    notes: Vec<String>,
}

impl Change {
    /// Of the robot alone: the SRDF stays.
    fn of(urdf: String, srdf: Option<&SourceText>, claim: Claim, tally: Tally, notes: Vec<String>) -> Self {
        let srdf = srdf.map(|srdf| srdf.text.clone());
        Self { urdf, srdf, claim, second: None, files: Vec::new(), tally, notes }
    }
}

/// Applies the operations in order, and proves each.
///
/// # Errors
/// The text is not a robot, an operation is impossible (with the reason), or the result violates its claim.
pub fn apply(files: &Files, operations: &[Operation]) -> Result<Done, EditError> {
    let mut files = files.clone();
    let (mut reports, mut meshes) = (Vec::new(), Vec::new());
    for operation in operations {
        let robot = urdf::read(&files.urdf.file, &files.urdf.text)?;
        let srdf = files.srdf.as_ref().map(|srdf| SourceText::new(&srdf.file, &srdf.text));
        let change = operation.change(&robot, srdf.as_ref())?;
        let made = urdf::read(&files.urdf.file, &change.urdf)
            .map_err(|error| EditError::Unproved { operation: operation.to_string(), what: error.to_string() })?;
        let proof = proof::prove(&robot, &made, &change.claim)
            .map_err(|what| EditError::Unproved { operation: operation.to_string(), what })?;
        if let Some((other, claim)) = &change.second {
            proof::prove(other, &made, claim)
                .map_err(|what| EditError::Unproved { operation: operation.to_string(), what })?;
        }
        reports.push(Report {
            operation: operation.to_string(),
            claim: change.claim,
            proof,
            changes: change.tally.said(),
            notes: change.notes,
        });
        files.urdf.text = change.urdf;
        meshes.extend(change.files);
        if let (Some(srdf), Some(text)) = (files.srdf.as_mut(), change.srdf) {
            srdf.text = text;
        }
    }
    Ok(Done { files, reports, meshes })
}

/// The differences of two texts as `diff -u` prints them; empty where they are the same.
pub fn unified_diff(before: &Text, after: &Text) -> String {
    if before.text == after.text {
        return String::new();
    }
    let diff = similar::TextDiff::from_lines(&before.text, &after.text);
    diff.unified_diff().header(&before.file, &after.file).to_string()
}

/// The second robot of an operation.
///
/// # Errors
/// The text is not a robot.
pub fn robot_of(text: &Text) -> Result<Robot, EditError> {
    Ok(urdf::read(&text.file, &text.text)?)
}
