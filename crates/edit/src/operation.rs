//! The operations, and their words on the command line.

use crate::Change;
use crate::Text;
use crate::error::EditError;
use crate::operations::calibration::{self, Actual};
use crate::operations::collision::{self, Meshes, Simple, Simplified};
use crate::operations::part::Side;
use crate::operations::rename::Renaming;
use crate::operations::{attach, frames, merge, meshes, mirror, part, rename, reroot, scale, sense, snap};
use crate::value::{self, Plane};
use denavit_model::Quantity;
use denavit_model::robot::{JointKind, Robot, SourceText};
use denavit_model::se3::Pose;
use denavit_model::units::Unit;
use std::collections::BTreeMap;
use std::fmt;

/// An edit of a robot.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub enum Operation {
    /// Another link becomes the root.
    Reroot {
        /// It.
        link: String,
    },
    /// Reverse the sense of a joint.
    Flip {
        /// It.
        joint: String,
    },
    /// A joint's old reading becomes its new 0.
    Zero {
        /// It.
        joint: String,
        /// The old reading, a number with or without a unit.
        at: String,
    },
    /// Links and joints get other names.
    Rename {
        /// Old and new.
        names: Vec<Renaming>,
    },
    /// Every link and joint gets a prefix.
    Prefix {
        /// It.
        prefix: String,
    },
    /// Links on fixed joints become parts of the link that carries them.
    Merge {
        /// Fixed joints, or links on them; all if empty.
        joints: Vec<String>,
        /// Links that stay as frames, without mass and shapes.
        keep: Vec<String>,
    },
    /// Attach another robot to a link.
    Attach {
        /// The other robot's URDF.
        other: Text,
        /// The link.
        at: String,
        /// link_from_root of the other robot: `x,y,z` or `x,y,z,roll,pitch,yaw`.
        pose: Option<String>,
        /// Prefix of its names.
        prefix: String,
    },
    /// Make the tree below a link a separate robot.
    Extract {
        /// The link.
        link: String,
    },
    /// Remove the tree below a link, with the joint that carries it.
    Cut {
        /// The link.
        link: String,
    },
    /// The mirror image.
    Mirror {
        /// Through the root link's origin.
        plane: Plane,
        /// Parts of names that are swapped, such as `left` and `right`.
        names: Vec<(String, String)>,
    },
    /// Put a manufacturer's calibration of one arm into the joint origins.
    SetCalibration {
        /// The file that they are from, for messages.
        file: String,
        /// They.
        actual: Box<Actual>,
    },
    /// Move link frames to the D-H frames.
    Canonical,
    /// Move a link's frame on the link.
    Origin {
        /// The link.
        link: String,
        /// In its present frame: `x,y,z` or `x,y,z,roll,pitch,yaw`.
        to: String,
    },
    /// Move link frames to the mass.
    Recentre {
        /// Links; all if empty.
        links: Vec<String>,
    },
    /// Replace collision meshes by simple enclosing shapes.
    SimplifyCollision(Box<Simplified>),
    /// Change the names of mesh files.
    Meshes {
        /// The requested folder.
        folder: String,
        /// New names by the old ones, as the text writes them.
        names: BTreeMap<String, String>,
    },
    /// Replace angles and axes that clearly mean round values by these values.
    Snap,
    /// Multiply every length by a factor.
    Scale {
        /// New length over old.
        factor: f64,
    },
}

/// An operation, for help and documents.
#[derive(Debug, Clone, Copy)]
pub struct OperationHelp {
    /// Its name.
    pub name: &'static str,
    /// With its words.
    pub usage: &'static str,
    /// What it does, and what stays the same.
    pub purpose: &'static str,
}

/// Every operation, in the order of the documents.
pub const OPERATIONS: &[OperationHelp] = &[
    OperationHelp {
        name: "flip",
        usage: "flip JOINT",
        purpose: "reverse a joint's sense and update limits, mimic joints, transmissions and states",
    },
    OperationHelp {
        name: "zero",
        usage: "zero JOINT=VALUE",
        purpose: "make the old joint value VALUE the new 0; values in rad or m, or with a unit (=90deg)",
    },
    OperationHelp {
        name: "reroot",
        usage: "reroot LINK",
        purpose: "make LINK the root; relative motion of links and their frames stay the same",
    },
    OperationHelp {
        name: "rename",
        usage: "rename OLD=NEW …",
        purpose: "rename links and joints everywhere; link:OLD=NEW or joint:OLD=NEW if both have the name",
    },
    OperationHelp { name: "prefix", usage: "prefix PREFIX", purpose: "put a prefix before every link and joint" },
    OperationHelp {
        name: "merge",
        usage: "merge [JOINT …] [--keep LINK …]",
        purpose: "merge links on fixed joints into the link that carries them; masses add up, shapes stay in place",
    },
    OperationHelp {
        name: "attach",
        usage: "attach FILE --at LINK [--pose POSE] [--prefix PREFIX]",
        purpose: "put another robot on a link, at x,y,z,roll,pitch,yaw",
    },
    OperationHelp { name: "extract", usage: "extract LINK", purpose: "keep only LINK and what it carries" },
    OperationHelp { name: "cut", usage: "cut LINK", purpose: "remove LINK and what it carries" },
    OperationHelp {
        name: "mirror",
        usage: "mirror xz [--names left=right]",
        purpose: "mirror the robot: equal joint values give mirrored poses; --names swaps parts of names",
    },
    OperationHelp {
        name: "set-calibration",
        usage: "set-calibration FILE [--nominal FILE]",
        purpose: "put a manufacturer's calibration of one arm into the joint origins; frames, meshes and names stay",
    },
    OperationHelp {
        name: "canonical",
        usage: "canonical",
        purpose: "move link frames to the D-H frames, as `export` does",
    },
    OperationHelp {
        name: "origin",
        usage: "origin LINK --to POSE",
        purpose: "move a link's frame to POSE, given in its present frame; nothing else moves",
    },
    OperationHelp {
        name: "recentre",
        usage: "recentre [LINK …]",
        purpose: "move link frames to the centre of mass, or to the nearest point of the link's joint axis",
    },
    OperationHelp {
        name: "simplify-collision",
        usage: "simplify-collision SHAPE [LINK …] [--to FOLDER]",
        purpose: "replace each collision mesh by an enclosing box, cylinder, sphere, the smallest of these, or its \
                  hull; hulls go to FOLDER",
    },
    OperationHelp {
        name: "meshes",
        usage: "meshes --to FOLDER",
        purpose: "copy mesh files and the files that they refer to into FOLDER, and update the paths",
    },
    OperationHelp {
        name: "snap",
        usage: "snap",
        purpose: "replace angles and axes that clearly mean round values by these values; each is listed with its \
                  bound",
    },
    OperationHelp {
        name: "scale",
        usage: "scale FACTOR",
        purpose: "multiply every length by FACTOR, and tensors by its square; masses stay",
    },
    OperationHelp {
        name: "units",
        usage: "units UNIT",
        purpose: "convert the file's lengths from UNIT (mm, in …) to m",
    },
];

/// The words of one operation, and their options.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Words {
    /// `flip`, `elbow_joint`.
    pub words: Vec<String>,
    /// The file named by the second word.
    pub other: Option<Text>,
    /// A link.
    pub at: Option<String>,
    /// `x,y,z` or `x,y,z,roll,pitch,yaw`.
    pub pose: Option<String>,
    /// Prefix of names.
    pub prefix: Option<String>,
    /// Links that stay.
    pub keep: Vec<String>,
    /// `left=right`.
    pub names: Vec<String>,
    /// Where something goes.
    pub to: Option<String>,
    /// A manufacturer's calibration, named by the second word.
    pub actual: Option<Actual>,
    /// The contents of the robot's mesh files, and the prefix of the names of new ones.
    pub meshes: Meshes,
    /// As `meshes`: the prefix of the names of files in the folder of `to`.
    pub folder: Option<String>,
    /// New names of mesh files by their old ones.
    pub copies: BTreeMap<String, String>,
}

impl Words {
    /// The words of a command line: `attach gripper.urdf --at tool0 --prefix g_`.
    ///
    /// # Errors
    /// An unknown option, or an option without its value.
    pub fn of(line: impl IntoIterator<Item = String>) -> Result<Self, EditError> {
        let mut words = Self::default();
        let mut rest = line.into_iter();
        while let Some(word) = rest.next() {
            let Some(option) = word.strip_prefix("--") else {
                words.words.push(word);
                continue;
            };
            let (name, value) = match option.split_once('=') {
                Some((name, value)) => (name.to_owned(), Some(value.to_owned())),
                None => (option.to_owned(), rest.next()),
            };
            let Some(value) = value else { return Err(EditError::Words(format!("--{name} needs a value"))) };
            match name.as_str() {
                "at" => words.at = Some(value),
                "pose" => words.pose = Some(value),
                "prefix" => words.prefix = Some(value),
                "keep" => words.keep.push(value),
                "names" => words.names.push(value),
                "to" => words.to = Some(value),
                _ => {
                    return Err(EditError::Words(format!(
                        "--{name} is not an option of an operation; options are --at, --pose, --prefix, --keep, \
                         --names, --to"
                    )));
                }
            }
        }
        Ok(words)
    }

    /// Whether the second word names a URDF that is read before the operation is made.
    pub fn takes_a_robot(&self) -> bool {
        self.words.first().is_some_and(|name| name == "attach")
    }

    /// Whether the second word names a manufacturer's calibration of one arm.
    pub fn takes_a_calibration(&self) -> bool {
        self.words.first().is_some_and(|name| name == "set-calibration")
    }

    /// Whether the triangles of the robot's meshes are needed.
    pub fn takes_meshes(&self) -> bool {
        self.words.first().is_some_and(|name| name == "simplify-collision")
    }

    /// Whether the robot's mesh files are copied to the folder of `to`.
    pub fn copies_meshes(&self) -> bool {
        self.words.first().is_some_and(|name| name == "meshes")
    }

    /// The first option that this operation does not accept.
    fn stray(&self) -> Option<&'static str> {
        let name = self.words.first().map_or("", String::as_str);
        let given = [
            ("--at", self.at.is_some(), &["attach"][..]),
            ("--pose", self.pose.is_some(), &["attach"]),
            ("--prefix", self.prefix.is_some(), &["attach"]),
            ("--keep", !self.keep.is_empty(), &["merge"]),
            ("--to", self.to.is_some(), &["origin", "meshes", "simplify-collision"]),
            ("--names", !self.names.is_empty(), &["mirror"]),
        ];
        given.into_iter().find(|(_, given, users)| *given && !users.contains(&name)).map(|(option, ..)| option)
    }
}

impl Operation {
    /// The operation given by the words.
    ///
    /// # Errors
    /// No such operation, or too few or too many words.
    pub fn of(words: &Words) -> Result<Self, EditError> {
        let mut rest = words.words.iter().map(String::as_str);
        let name = rest.next().unwrap_or_default();
        let rest: Vec<&str> = rest.collect();
        let Some(help) = OPERATIONS.iter().find(|known| known.name == name) else {
            let names = OPERATIONS.iter().map(|known| known.name);
            let hint = denavit_model::problems::nearest_name(name, names.clone())
                .map_or_else(String::new, |near| format!("; did you mean {near}?"));
            let known: Vec<&str> = names.collect();
            return Err(EditError::Words(format!("\"{name}\" is not an operation{hint}; try {}", known.join(", "))));
        };
        if let Some(option) = words.stray() {
            return Err(EditError::Words(format!("{name} takes no {option}; write {}", help.usage)));
        }
        let wrong = || EditError::Words(format!("{}: write {}", words.words.join(" "), help.usage));
        let only = || match rest[..] {
            [only] => Ok(only.to_owned()),
            _ => Err(wrong()),
        };
        Ok(match name {
            "reroot" => Self::Reroot { link: only()? },
            "flip" => Self::Flip { joint: only()? },
            "zero" => {
                let (joint, at) =
                    only()?.rsplit_once('=').map(|(a, b)| (a.to_owned(), b.to_owned())).ok_or_else(wrong)?;
                Self::Zero { joint, at }
            }
            "rename" => {
                let names: Option<Vec<Renaming>> = rest.iter().map(|word| renaming(word)).collect();
                Self::Rename { names: names.filter(|names| !names.is_empty()).ok_or_else(wrong)? }
            }
            "merge" => {
                Self::Merge { joints: rest.iter().map(|word| (*word).to_owned()).collect(), keep: words.keep.clone() }
            }
            "attach" => {
                let (Some(other), Some(at)) = (words.other.clone(), words.at.clone()) else { return Err(wrong()) };
                only()?;
                let prefix = words.prefix.clone().unwrap_or_default();
                Self::Attach { other, at, pose: words.pose.clone(), prefix }
            }
            "extract" => Self::Extract { link: only()? },
            "cut" => Self::Cut { link: only()? },
            "mirror" => {
                let plane = Plane::of(&only()?).ok_or_else(wrong)?;
                let pair = |word: &String| {
                    let (one, other) = word.split_once('=')?;
                    (!one.is_empty() && !other.is_empty() && one != other).then(|| (one.to_owned(), other.to_owned()))
                };
                let names: Option<Vec<(String, String)>> = words.names.iter().map(pair).collect();
                Self::Mirror { plane, names: names.ok_or_else(wrong)? }
            }
            "set-calibration" => {
                let file = only()?;
                Self::SetCalibration { file, actual: Box::new(words.actual.clone().ok_or_else(wrong)?) }
            }
            "recentre" => Self::Recentre { links: rest.iter().map(|word| (*word).to_owned()).collect() },
            "simplify-collision" => {
                let (shape, links) = rest.split_first().ok_or_else(wrong)?;
                let shape = Simple::of(shape).ok_or_else(|| {
                    EditError::Words(format!(
                        "{name}: \"{shape}\" is not a shape; write box, cylinder, sphere, smallest or hull"
                    ))
                })?;
                let links = links.iter().map(|word| (*word).to_owned()).collect();
                let (meshes, folder) = (words.meshes.clone(), words.folder.clone());
                Self::SimplifyCollision(Box::new(Simplified { shape, links, meshes, folder }))
            }
            "meshes" if rest.is_empty() => {
                Self::Meshes { folder: words.to.clone().ok_or_else(wrong)?, names: words.copies.clone() }
            }
            "canonical" if rest.is_empty() => Self::Canonical,
            "snap" if rest.is_empty() => Self::Snap,
            "canonical" | "snap" | "meshes" => return Err(wrong()),
            "origin" => Self::Origin { link: only()?, to: words.to.clone().ok_or_else(wrong)? },
            "scale" => Self::Scale { factor: only()?.parse().map_err(|_| wrong())? },
            "units" => {
                let unit = Unit::of(&only()?, Quantity::Length).ok_or_else(wrong)?;
                Self::Scale { factor: unit.in_si() }
            }
            _ => Self::Prefix { prefix: only()? },
        })
    }

    /// The new text, not yet proved.
    pub(crate) fn change(&self, robot: &Robot, srdf: Option<&SourceText>) -> Result<Change, EditError> {
        match self {
            Self::Reroot { link } => reroot::reroot(robot, srdf, link),
            Self::Flip { joint } => sense::flip(robot, srdf, joint),
            Self::Zero { joint, at } => {
                let slides = robot.joints.iter().any(|of| of.name == *joint && of.kind == JointKind::Prismatic);
                let quantity = if slides { Quantity::Length } else { Quantity::Angle };
                sense::zero(robot, srdf, joint, value::number(at, quantity)?)
            }
            Self::Rename { names } => rename::rename(robot, srdf, names),
            Self::Prefix { prefix } => rename::prefix(robot, srdf, prefix),
            Self::Merge { joints, keep } => merge::merge(robot, srdf, joints, keep),
            Self::Attach { other, at, pose, prefix } => {
                let pose = pose.as_deref().map(value::pose).transpose()?.unwrap_or_else(Pose::identity);
                attach::attach(robot, srdf, other, at, &pose, prefix)
            }
            Self::Extract { link } => part::part(robot, srdf, link, Side::Below),
            Self::Cut { link } => part::part(robot, srdf, link, Side::Above),
            Self::Mirror { plane, names } => mirror::mirror(robot, srdf, *plane, names),
            Self::SetCalibration { file, actual } => calibration::set(robot, srdf, file, actual),
            Self::Canonical => frames::canonical(robot, srdf),
            Self::Origin { link, to } => frames::origin(robot, srdf, link, &value::pose(to)?),
            Self::Recentre { links } => frames::recentre(robot, srdf, links),
            Self::SimplifyCollision(asked) => collision::simplify(robot, srdf, asked),
            Self::Meshes { names, .. } => meshes::meshes(robot, srdf, names),
            Self::Snap => snap::snap(robot, srdf),
            Self::Scale { factor } => scale::scale(robot, srdf, *factor),
        }
    }
}

fn renaming(word: &str) -> Option<Renaming> {
    let (old, new) = word.split_once('=')?;
    let (kind, old) = match old.split_once(':') {
        Some(("link", name)) => (Some("link"), name),
        Some(("joint", name)) => (Some("joint"), name),
        _ => (None, old),
    };
    Some(Renaming { kind, old: old.to_owned(), new: new.to_owned() })
}

fn listed(f: &mut fmt::Formatter<'_>, operation: &str, names: &[String]) -> fmt::Result {
    f.write_str(operation)?;
    names.iter().try_for_each(|name| write!(f, " {name}"))
}

impl fmt::Display for Operation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Reroot { link } => write!(f, "reroot {link}"),
            Self::Flip { joint } => write!(f, "flip {joint}"),
            Self::Zero { joint, at } => write!(f, "zero {joint}={at}"),
            Self::Rename { names } => {
                f.write_str("rename")?;
                names.iter().try_for_each(|name| write!(f, " {}={}", name.old, name.new))
            }
            Self::Prefix { prefix } => write!(f, "prefix {prefix}"),
            Self::Merge { joints, .. } => listed(f, "merge", joints),
            Self::Attach { other, at, .. } => write!(f, "attach {} at {at}", other.file),
            Self::Extract { link } => write!(f, "extract {link}"),
            Self::Cut { link } => write!(f, "cut {link}"),
            Self::Mirror { plane, .. } => write!(f, "mirror {}", plane.name()),
            Self::SetCalibration { file, .. } => write!(f, "set-calibration {file}"),
            Self::Canonical => f.write_str("canonical"),
            Self::Origin { link, to } => write!(f, "origin {link} to {to}"),
            Self::Recentre { links } => listed(f, "recentre", links),
            Self::SimplifyCollision(asked) => {
                listed(f, &format!("simplify-collision {}", asked.shape.name()), &asked.links)
            }
            Self::Meshes { folder, .. } => write!(f, "meshes to {folder}"),
            Self::Snap => f.write_str("snap"),
            Self::Scale { factor } => write!(f, "scale {factor}"),
        }
    }
}
