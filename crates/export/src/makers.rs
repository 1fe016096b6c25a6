//! Calibration files of manufacturers and ROS packages: read where a file holds complete kinematics, written where a
//! controller or package accepts them.
//!
//! Each format has its own module, which names its public source; `docs/makers.md` lists formats that are not public,
//! which are not supported.

mod franka;
pub(crate) mod opw;
mod origins;
mod pal;
mod robot_calibration;
pub mod techman;
mod ur;
pub mod ur_conf;
pub(crate) mod ur_models;
mod xarm;
pub(crate) mod yaml;

use crate::kinematics_yaml::{self, AngleOrder, KinematicsFileError};
use crate::sources::{self, Read, Source, Stated};
use crate::urdf::ExportError;
use crate::urdf::text::Numbers;
use denavit_model::chain::{Chain, ChainError, ChainJoint, Coordinate, Quantity};
use denavit_model::nalgebra::{Point3, Unit, Vector3};
use denavit_model::notes::Note;
use denavit_model::robot::Robot;
use denavit_model::se3::{self, Pose};
use denavit_model::tree::Reading;
use denavit_model::{AxisLine, Screw};
use thiserror::Error;

/// A manufacturer's file format.
#[derive(Debug, Clone, Copy)]
pub struct Maker {
    /// The word on the command line.
    pub name: &'static str,
    /// Which program uses the file, and under which name.
    pub purpose: &'static str,
    /// Writes it.
    pub render: fn(&Calibrated) -> Result<Written, MakerError>,
}

/// Every format that can be written.
pub const MAKERS: &[Maker] =
    &[ur::MAKER, ur_conf::MAKER, xarm::MAKER, franka::MAKER, pal::MAKER, robot_calibration::MAKER];

/// Requested formats that are not public, with the alternative.
const NOT_PUBLIC: [(&str, &str); 2] = [
    (
        "kinova",
        "Kinova support sends the calibration of an arm on request, but in an unpublished format (ros_kortex, issue \
         318); write it as a D-H table: `denavit edit` reads it with the nominal table",
    ),
    (
        "ros-industrial",
        "the ROS-Industrial drivers apply no offsets and read no offset file (industrial_core, issue 218)",
    ),
];

/// The format with this name.
///
/// # Errors
/// The name is unknown; the message gives the reason and the known names.
pub fn named(name: &str) -> Result<&'static Maker, MakerError> {
    if let Some(maker) = MAKERS.iter().find(|maker| maker.name == name) {
        return Ok(maker);
    }
    let known: Vec<&str> = MAKERS.iter().map(|maker| maker.name).collect();
    let why = NOT_PUBLIC.iter().find(|(own, _)| *own == name).map_or("unknown format", |(_, why)| why);
    Err(MakerError::Unknown { name: name.to_owned(), why, known: known.join(", ") })
}

/// The Universal Robots model (`ur_type`) with these axes, up to the size of a calibration.
pub fn ur_model(chain: &Chain) -> Option<&'static str> {
    ur_models::model_of(chain)
}

/// What a file is made from.
#[derive(Debug, Clone, Copy)]
pub struct Calibrated<'a> {
    /// The calibrated chain.
    pub chain: &'a Chain,
    /// Its nominal tree, and how that was read: link frames are kept as closely as possible.
    pub drawn: Option<(&'a Robot, Reading)>,
    /// Names of non-geometric effects that were found.
    pub effects: &'a [String],
}

/// A file's text, and what the format cannot represent.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Written {
    /// The file.
    pub text: String,
    /// Sentences.
    pub left_out: Vec<String>,
}

/// Why a calibration cannot be written in a format.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum MakerError {
    /// No format with this name.
    #[error("‹out-for›: \"{name}\": {why}; known formats: {known}; ‹urdf› writes the whole robot")]
    Unknown {
        /// The requested name.
        name: String,
        /// Why not.
        why: &'static str,
        /// What there is.
        known: String,
    },
    /// A chain that does not fit the format.
    #[error("‹out-for› {maker}: the format needs {wanted}, but the chain from {base} to {tip} has {found}")]
    OtherChain {
        /// The form.
        maker: &'static str,
        /// What it takes.
        wanted: &'static str,
        /// Base link.
        base: String,
        /// Tip link.
        tip: String,
        /// What the chain has.
        found: String,
    },
    /// A joint does not turn about z of its link.
    #[error(
        "‹out-for› {maker}: joint \"{joint}\" does not turn about the z axis of its link's frame, as the format \
         requires"
    )]
    NotAboutZ {
        /// The form.
        maker: &'static str,
        /// The joint.
        joint: String,
    },
    /// The format needs the tree.
    #[error("‹out-for› {maker}: the format needs the joint origins of a URDF; give the robot as a URDF or xacro")]
    NeedsTree {
        /// The form.
        maker: &'static str,
    },
    /// The calibrated tree could not be made.
    #[error(transparent)]
    Export(#[from] ExportError),
    /// The calibrated tree could not be read back.
    #[error(transparent)]
    Urdf(#[from] denavit_model::UrdfError),
    /// A chain of the tree could not be made.
    #[error(transparent)]
    Tree(#[from] denavit_model::TreeError),
    /// UR's form.
    #[error(transparent)]
    Kinematics(#[from] KinematicsFileError),
}

/// Joint origins from a file that only holds corrections to those of a URDF.
#[derive(Debug, Clone, PartialEq)]
pub struct NewOrigins {
    /// What the file was read as.
    pub form: &'static str,
    /// Indices of the robot's joints, and their origins.
    pub origins: Vec<(usize, Numbers)>,
    /// Parts of the file that are not used.
    pub notes: Vec<Note>,
}

/// Reads PAL's `master_calibration.yaml` and offsets of robot_calibration, which are added to the origins of this robot. `None`
/// where the text is neither.
///
/// # Errors
/// A value is not a finite number, or the file names no joint of the robot.
pub fn new_origins(file: &str, text: &str, robot: &Robot) -> Option<Result<NewOrigins, KinematicsFileError>> {
    let scalars = yaml::Scalars::read(file, text).ok()?;
    let pal = scalars.above(pal::BELOW);
    let (form, read) = match pal.first() {
        Some(above) => ("PAL's corrections of joint origins", pal::read(&scalars, above, robot)),
        None => ("offsets of joint origins (robot_calibration)", robot_calibration::read(&scalars, robot)),
    };
    match read {
        // Any other YAML names no joint so.
        Ok(origins) if origins.is_empty() && pal.is_empty() => None,
        Ok(origins) if origins.is_empty() => {
            Some(Err(not_this_arm(&scalars, form, "no key names a joint of this robot")))
        }
        Ok(origins) => Some(Ok(NewOrigins { form, origins, notes: scalars.account().0 })),
        Err(error) => Some(Err(error)),
    }
}

/// Reads a maker's kinematics file: UR's, an xArm's, a Franka arm's, an OPW file; `order` applies only to UR's.
///
/// # Errors
/// The YAML does not parse, has none of these formats, or a number is missing or not finite.
///
/// # Examples
/// ```
/// use denavit_export::{kinematics_yaml::AngleOrder, makers};
/// let text = "kinematics:\n  joint1: {x: 0, y: 0, z: 0.267, roll: 0, pitch: 0, yaw: 0}\n";
/// let chain = makers::read("xarm1_kinematics_A.yaml", "xarm", text, AngleOrder::Urdf)?;
/// assert_eq!(chain.home().translation.z, 0.267);
/// # Ok::<(), denavit_export::kinematics_yaml::KinematicsFileError>(())
/// ```
pub fn read(file: &str, robot: &str, text: &str, order: AngleOrder) -> Result<Chain, KinematicsFileError> {
    chain_in(&yaml::Scalars::read(file, text)?, robot, order).map(|(chain, _)| chain)
}

/// The same, with the format that was found and an inventory of the file; also a D-H table in YAML, a list of rows
/// with keys theta, d, alpha, a.
///
/// # Errors
/// As [`read`].
pub fn read_whole(
    file: &str,
    robot: &str,
    text: &str,
    order: AngleOrder,
    given: Stated,
) -> Result<Read, KinematicsFileError> {
    let scalars = yaml::Scalars::read(file, text)?;
    if let Some(cells) = scalars.table() {
        let mut read = sources::of_cells(file, &cells, given)?;
        let (notes, inventory) = scalars.account();
        read.notes.extend(notes);
        read.inventory.append(inventory);
        return Ok(read);
    }
    let (chain, form) = chain_in(&scalars, robot, order)?;
    let (notes, inventory) = scalars.account();
    let assumed = vec![format!("{file}: read as {form}")];
    Ok(Read { source: Source::Poe(chain), assumed, notes, inventory })
}

fn chain_in(
    scalars: &yaml::Scalars,
    robot: &str,
    order: AngleOrder,
) -> Result<(Chain, &'static str), KinematicsFileError> {
    if !scalars.above(opw::GEOMETRY).is_empty() {
        return Ok((opw::read(scalars, robot)?, "parameters of opw_kinematics, in m and rad"));
    }
    let (chain, form) = if scalars.has(&["kinematics", "joint1"]) {
        (xarm::read(scalars, robot)?, "the joint origins of an xArm, each joint about z of its frame")
    } else if scalars.has(&["joint1", "kinematic"]) {
        (franka::read(scalars, robot)?, "the joint origins of a Franka arm, each joint about z of its frame")
    } else if scalars.has(&["kinematics"]) {
        let chain = kinematics_yaml::of_scalars(scalars)?.chain(robot, order)?;
        (chain, "the joint origins of a Universal Robots arm")
    } else {
        return Err(KinematicsFileError::Unknown { file: scalars.file.clone() });
    };
    if all_parallel(&chain) {
        return Err(not_this_arm(
            scalars,
            form,
            "every axis would be parallel to the first one; if this arm's xacro defines the axes, give the URDF or \
             xacro instead",
        ));
    }
    Ok((chain, form))
}

fn not_this_arm(scalars: &yaml::Scalars, form: &'static str, what: impl Into<String>) -> KinematicsFileError {
    KinematicsFileError::NotThisArm { file: scalars.file.clone(), form, what: what.into() }
}

/// If all axes are closer to parallel than this, rad, the file does not define the axes.
const PARALLEL: f64 = 0.02;

fn all_parallel(chain: &Chain) -> bool {
    let mut axes = chain.joints().iter().map(|joint| joint.screw.direction());
    let Some(first) = axes.next() else { return false };
    chain.joints().len() > 1 && axes.all(|axis| axis.cross(&first).norm() < PARALLEL)
}

/// The six numbers of an origin as URDF reads them.
const KEYS: [&str; 6] = ["x", "y", "z", "roll", "pitch", "yaw"];

fn six(origin: &Pose) -> [f64; 6] {
    let [roll, pitch, yaw] = se3::rpy_from_rotation(&origin.rotation);
    let place = origin.translation.vector;
    // Adding zero turns -0 into 0.
    [place.x, place.y, place.z, roll, pitch, yaw].map(|value| value + 0.0)
}

fn pose_of([x, y, z, roll, pitch, yaw]: [f64; 6]) -> Pose {
    se3::pose(se3::rotation_from_rpy([roll, pitch, yaw]), Vector3::new(x, y, z))
}

/// A chain of revolute joints about z of their frames.
fn chain_of(names: (&str, &str, &str), origins: &[(String, Pose)], tool: &Pose) -> Result<Chain, ChainError> {
    let mut frame = Pose::identity();
    let mut joints = Vec::new();
    for (index, (name, origin)) in origins.iter().enumerate() {
        frame *= origin;
        let direction = Unit::new_normalize(frame.rotation * Vector3::z());
        let line = AxisLine { direction, point: Point3::from(frame.translation.vector) };
        let screw = Screw::Revolute(line);
        joints.push(ChainJoint { name: name.clone(), screw, coordinate: index, scale: 1.0, offset: 0.0 });
    }
    let coordinates = origins.iter().map(|(name, _)| Coordinate::unlimited(name.clone(), Quantity::Angle));
    Chain::new(names, coordinates.collect(), joints, frame * tool)
}

/// Notes on effects, which no format can represent.
fn without_effects(calibrated: &Calibrated) -> Vec<String> {
    if calibrated.effects.is_empty() {
        return Vec::new();
    }
    let effects = calibrated.effects.join(", ");
    vec![format!("this format holds only geometry, not {effects} (‹effects-out› writes the effects)")]
}

/// A pose in words, unless it is the identity.
pub(crate) fn tool_words(tool: &Pose, size: f64) -> Option<String> {
    let (turned, moved) = se3::difference(tool, &Pose::identity());
    (turned > 1e-12 || moved > 1e-12 * size).then(|| {
        let [x, y, z, roll, pitch, yaw] = six(tool).map(crate::numbers::exact);
        format!("xyz {x} {y} {z}, rpy {roll} {pitch} {yaw}")
    })
}
