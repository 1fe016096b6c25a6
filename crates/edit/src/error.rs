//! Errors of edits.

use denavit_export::urdf::ExportError;
use denavit_export::urdf::text::Nodes;
use denavit_model::UrdfError;
use denavit_model::notes::Place;
use denavit_model::problems::nearest_name;
use denavit_model::robot::Robot;
use thiserror::Error;

/// Why an edit failed. Nothing is written then.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum EditError {
    /// No link or joint of that name.
    #[error("{file}: the robot has no {kind} \"{name}\"{hint}")]
    NoSuch {
        /// The file.
        file: String,
        /// `link` or `joint`.
        kind: &'static str,
        /// The requested name.
        name: String,
        /// The nearest name, as a question, or how to list them.
        hint: String,
    },
    /// The operation is impossible for this robot.
    #[error("{place}: {what}")]
    Refused {
        /// Where.
        place: Place,
        /// Why, and what to do.
        what: String,
    },
    /// Words that are not an operation.
    #[error("{0}")]
    Words(String),
    /// The result is not what the operation claims: a bug of the edit, or a text out of reach of edits.
    #[error("{operation}: the result would not be as requested: {what}; nothing was written. Please report this file")]
    Unproved {
        /// The operation.
        operation: String,
        /// What does not hold.
        what: String,
    },
    /// The SRDF is not XML.
    #[error("{file}: cannot be read: {why}")]
    Srdf {
        /// The file.
        file: String,
        /// The parser's words.
        why: String,
    },
    /// The text cannot be edited in place.
    #[error(transparent)]
    Text(#[from] ExportError),
    /// The source is not a robot.
    #[error(transparent)]
    Urdf(#[from] UrdfError),
}

/// # Errors
/// No link of this name.
pub(crate) fn link(robot: &Robot, name: &str) -> Result<usize, EditError> {
    let names = robot.links.iter().map(|link| link.name.as_str());
    robot.link_index(name).ok_or_else(|| no_such(robot, "link", name, names))
}

/// # Errors
/// No joint of this name.
pub(crate) fn joint(robot: &Robot, name: &str) -> Result<usize, EditError> {
    let names = robot.joints.iter().map(|joint| joint.name.as_str());
    robot.joint_index(name).ok_or_else(|| no_such(robot, "joint", name, names))
}

fn no_such<'a>(
    robot: &Robot,
    kind: &'static str,
    name: &str,
    names: impl Iterator<Item = &'a str> + Clone,
) -> EditError {
    let hint = nearest_name(name, names.clone()).map_or_else(
        || {
            let first: Vec<&str> = names.take(8).collect();
            format!("; there are {}", first.join(", "))
        },
        |near| format!("; did you mean \"{near}\"?"),
    );
    EditError::NoSuch { file: robot.source.file.clone(), kind, name: name.to_owned(), hint }
}

/// The operation is impossible because of this joint.
pub(crate) fn refused_at_joint(robot: &Robot, joint: usize, what: impl Into<String>) -> EditError {
    EditError::Refused { place: robot.joint_place(joint), what: what.into() }
}

/// # Errors
/// A link that joints name but the text does not declare, so an edit cannot change it.
pub(crate) fn all_declared(robot: &Robot, nodes: &Nodes) -> Result<(), EditError> {
    match (0..robot.links.len()).find(|link| nodes.link(*link).is_none()) {
        None => Ok(()),
        Some(link) => {
            let name = &robot.links[link].name;
            Err(refused_at_link(robot, link, format!("the file does not declare it; add <link name=\"{name}\"/>")))
        }
    }
}

/// The operation is impossible because of this link.
pub(crate) fn refused_at_link(robot: &Robot, link: usize, what: impl Into<String>) -> EditError {
    let link = &robot.links[link];
    EditError::Refused { place: robot.source.place(link.at, format!("link \"{}\"", link.name)), what: what.into() }
}
