//! What can be wrong with an SDF, each with the fix.

use denavit_model::Place;
use thiserror::Error;

/// One thing that is wrong, and where.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct SdfProblem {
    /// Where.
    pub place: Place,
    /// What, with the fix.
    pub kind: SdfProblemKind,
}

/// What can be wrong with an SDF.
#[derive(Debug, Clone, PartialEq, Error)]
pub(crate) enum SdfProblemKind {
    /// The XML parser stopped.
    #[error("not well-formed XML: {0}")]
    Xml(String),
    /// Another root element.
    #[error("the root element is <{0}>, not <sdf>; is this an SDF file?")]
    NoSdf(String),
    /// No model.
    #[error("the file has no <model>; a robot is one model")]
    NoModel,
    /// Several models.
    #[error("there are {count} models: {names}; a robot is one model, so put it into a file of its own")]
    SeveralModels {
        /// How many.
        count: usize,
        /// Their names, quoted.
        names: String,
    },
    /// A model without links.
    #[error("the model has no <link>; add one, or include a model that has")]
    NoLinks,
    /// An element without a name.
    #[error("the attribute `name` is missing; give it one")]
    MissingName,
    /// Something that a joint needs.
    #[error("<{0}> is missing; add it")]
    MissingElement(&'static str),
    /// No joint type.
    #[error("the attribute `type` is missing; write type=\"revolute\", \"prismatic\", \"fixed\", …")]
    MissingType,
    /// A joint type that SDF does not know.
    #[error(
        "the joint type \"{0}\" is unknown; SDF knows revolute, continuous, prismatic, screw, fixed, universal, revolute2, ball and gearbox"
    )]
    UnknownType(String),
    /// A frame that does not exist.
    #[error("{what} \"{name}\" does not exist in this model{}", did_you_mean(.near.as_deref()))]
    UnknownFrame {
        /// What names it: `parent link`, `relative_to`.
        what: &'static str,
        /// As written.
        name: String,
        /// The nearest name that exists.
        near: Option<String>,
    },
    /// Frames that depend on each other.
    #[error("frames depend on each other: {0}; define one of them in a frame that does not depend on it")]
    FrameCycle(String),
    /// The world as a child.
    #[error("the child of a joint is \"world\"; swap parent and child")]
    WorldAsChild,
    /// Parent and child are one link.
    #[error("parent and child are both on link \"{0}\"; a joint needs two links")]
    SameLink(String),
    /// A joint below an included model that was not found.
    #[error(
        "its parent is in the model {uri}, which was not found ({reason}); add the folder that holds it to ‹package-path›"
    )]
    MissingInclude {
        /// As written.
        uri: String,
        /// Why.
        reason: String,
    },
    /// A model that includes itself.
    #[error("the model {0} includes itself; remove one of the includes")]
    IncludeCycle(String),
    /// Not a number.
    #[error("<{element}>{value}</{element}>: \"{word}\" is not a {wanted}")]
    BadNumber {
        /// Tag.
        element: String,
        /// Its text.
        value: String,
        /// The word in it.
        word: String,
        /// What belongs there.
        wanted: &'static str,
    },
    /// Too few or too many numbers.
    #[error("<{element}>{value}</{element}> has {found} numbers instead of {expected}")]
    WrongCount {
        /// Tag.
        element: String,
        /// Its text.
        value: String,
        /// How many there are.
        found: usize,
        /// How many belong there.
        expected: usize,
    },
    /// A rotation format that is not known.
    #[error("rotation_format=\"{0}\" is unknown; write euler_rpy or quat_xyzw")]
    UnknownRotation(String),
    /// A quaternion of length zero.
    #[error("the quaternion in <pose>{0}</pose> has length zero; for no rotation write \"0 0 0 1\"")]
    ZeroQuaternion(String),
    /// An axis of length zero.
    #[error("the axis <xyz>{0}</xyz> has length zero; give the direction that the joint moves along or about")]
    ZeroAxis(String),
    /// A pitch of zero or beyond all numbers.
    #[error("<{element}>{value}</{element}> is not a valid pitch; write screw_thread_pitch in m per turn, not 0")]
    BadPitch {
        /// Tag.
        element: &'static str,
        /// As written.
        value: String,
    },
}

fn did_you_mean(near: Option<&str>) -> String {
    near.map_or_else(|| "; add it or correct the name".to_owned(), |name| format!("; did you mean \"{name}\"?"))
}
