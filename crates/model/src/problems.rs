//! Why a file is not a valid robot: every problem with its place and fix.

use crate::notes::Place;
use std::fmt;
use thiserror::Error;

/// One thing that is wrong, and where.
#[derive(Debug, Clone, PartialEq)]
pub struct Problem {
    /// Where.
    pub place: Place,
    /// What is wrong, and the fix.
    pub kind: ProblemKind,
}

impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.place, self.kind)
    }
}

/// Everything that is wrong with a file, in the order of the file.
#[derive(Debug, Clone, PartialEq, Error)]
pub struct UrdfError {
    /// At least one.
    pub problems: Vec<Problem>,
}

impl fmt::Display for UrdfError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, problem) in self.problems.iter().enumerate() {
            if index > 0 {
                writeln!(f)?;
            }
            write!(f, "{problem}")?;
        }
        Ok(())
    }
}

/// What can be wrong with a URDF.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum ProblemKind {
    /// The XML parser stopped.
    #[error("not well-formed XML: {0}{hint}", hint = if *.1 { "; this is a git merge conflict: choose a side and remove the markers" } else { "" })]
    Xml(String, bool),
    /// The file holds nothing.
    #[error("the file is empty; a URDF holds one <robot> element")]
    Empty,
    /// Another root element.
    #[error("the root element is <{0}>, not <robot>; is this a URDF?{hint}", hint = if .0 == "sdf" { " SDF has a reader of its own" } else { "" })]
    NoRobot(String),
    /// A robot without links.
    #[error("the robot has no <link>; was a xacro file expanded without its macro being called?")]
    NoLinks,
    /// A link or joint that lacks its name.
    #[error("the attribute `name` is missing; give it one")]
    MissingName,
    /// A name twice.
    #[error("the name is already taken in line {first}; rename one of the two")]
    DuplicateName {
        /// Where the other stands.
        first: usize,
    },
    /// A joint without parent or child.
    #[error("<{0} link=\"…\"/> is missing; name the link")]
    MissingEnd(&'static str),
    /// A joint to a link that is not there.
    #[error("{role} link \"{link}\" does not exist{}", did_you_mean(.near.as_deref()))]
    UnknownLink {
        /// `parent` or `child`.
        role: &'static str,
        /// As written.
        link: String,
        /// The nearest name that exists.
        near: Option<String>,
    },
    /// A link carried by two joints.
    #[error("link \"{link}\" is already carried by joint \"{other}\"; a link has one parent joint")]
    TwoParents {
        /// The link.
        link: String,
        /// The other joint.
        other: String,
    },
    /// Every link has a parent joint, or a part of the tree forms a loop.
    #[error("the joints close a loop through links {links}; a URDF is a tree, so cut the loop at one joint")]
    Cycle {
        /// Names, quoted.
        links: String,
    },
    /// Several links without a parent joint.
    #[error("the robot has {count} root links: {links}; join them by a fixed joint, or remove what is not used")]
    SeveralRoots {
        /// How many.
        count: usize,
        /// Names, quoted.
        links: String,
    },
    /// No `type`.
    #[error("the attribute `type` is missing; write type=\"revolute\", \"prismatic\", \"fixed\", …")]
    MissingType,
    /// A screw joint without its pitch.
    #[error("a screw joint needs <drake:screw_thread_pitch value=\"metres per turn\"/>")]
    MissingThreadPitch,
    /// An axis of length zero on a joint that moves.
    #[error("axis xyz=\"{0}\" has length zero; give the direction that the joint moves along or about")]
    ZeroAxis(String),
    /// A rotation stated twice.
    #[error("<origin> has both rpy=\"{rpy}\" and quat_xyzw=\"{quat_xyzw}\"; remove one of the two")]
    TwoRotations {
        /// As written.
        rpy: String,
        /// As written.
        quat_xyzw: String,
    },
    /// A quaternion of length zero.
    #[error("quat_xyzw=\"{0}\" has length zero; for no rotation write \"0 0 0 1\"")]
    ZeroQuaternion(String),
    /// Not a number.
    #[error("<{element} {attribute}=\"{value}\">: \"{word}\" is not a finite number{}", if .value.contains("${") || .value.contains("$(") { "; the file is xacro that was not expanded" } else { "" })]
    BadNumber {
        /// Tag.
        element: String,
        /// Attribute.
        attribute: &'static str,
        /// Its value.
        value: String,
        /// The word in it.
        word: String,
    },
    /// Too few or too many numbers.
    #[error("<{element} {attribute}=\"{value}\"> has {found} numbers instead of {expected}")]
    WrongCount {
        /// Tag.
        element: String,
        /// Attribute.
        attribute: &'static str,
        /// Its value.
        value: String,
        /// How many there are.
        found: usize,
        /// How many there should be.
        expected: usize,
    },
}

fn did_you_mean(near: Option<&str>) -> String {
    near.map_or_else(|| "; add the link or correct the name".to_owned(), |name| format!("; did you mean \"{name}\"?"))
}

/// Names of more bytes are not compared: nobody types them, and the time grows with the product of the lengths. A file's name has the same
/// limit.
const LONGEST_COMPARED: usize = 255;

/// The candidate that differs from `name` by the fewest edits, if by few enough to be a slip.
pub fn nearest_name<'a>(name: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let is_compared = |name: &str| name.len() <= LONGEST_COMPARED;
    let candidates = candidates.into_iter().filter(|other| is_compared(name) && is_compared(other));
    let (distance, nearest) = candidates.map(|other| (strsim::damerau_levenshtein(name, other), other)).min()?;
    (distance <= 1 + name.chars().count() / 4).then_some(nearest)
}

#[cfg(test)]
mod tests {
    use super::nearest_name;

    #[test]
    fn only_names_that_somebody_types_have_a_nearest() {
        let near = |length: usize| {
            let other = "n".repeat(length - 1) + "m";
            nearest_name(&"n".repeat(length), [other.as_str()]).is_some()
        };
        assert!(near(200) && !near(70_000));
    }
}
