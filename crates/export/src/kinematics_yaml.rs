//! The kinematics file of a factory-calibrated robot: six joint origins, as UR's driver reads them.
//!
//! ```text
//! kinematics:
//!   shoulder: {x, y, z, roll, pitch, yaw}     # base to the frame that joint 1 turns
//!   upper_arm: …                              # that frame to the one that joint 2 turns …
//! base_from_wrist_3(q) = Π origin_i · Rz(q_i)
//! ```
//! **Trap.** The tool that extracts these files from a controller takes its angles as R = Rx(roll) Ry(pitch) Rz(yaw). The
//! URDF that then reads them takes them as R = Rz(yaw) Ry(pitch) Rx(roll). For a real arm the two differ by up to tens
//! of micrometres at the tip. [`AngleOrder`] therefore states the order.

use crate::makers::yaml::Scalars;
use denavit_model::nalgebra::{Point3, Rotation3, Unit, Vector3};
use denavit_model::{AxisLine, Chain, ChainError, ChainJoint, Coordinate, Pose, Quantity, Screw, se3};
use std::fmt::Write;
use thiserror::Error;

/// How three angles make a rotation.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum AngleOrder {
    /// R = Rz(yaw) Ry(pitch) Rx(roll): how a URDF reads the file, and so how a running robot moves.
    #[default]
    Urdf,
    /// R = Rx(roll) Ry(pitch) Rz(yaw): how the vendor's tool computes the angles that it writes.
    Vendor,
}

/// Names of the six origins and of the joints that turn them.
pub const NAMES: [(&str, &str); 6] = [
    ("shoulder", "shoulder_pan_joint"),
    ("upper_arm", "shoulder_lift_joint"),
    ("forearm", "elbow_joint"),
    ("wrist_1", "wrist_1_joint"),
    ("wrist_2", "wrist_2_joint"),
    ("wrist_3", "wrist_3_joint"),
];

const KEYS: [&str; 6] = ["x", "y", "z", "roll", "pitch", "yaw"];

/// The file's content.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct KinematicsFile {
    /// x, y, z (m), roll, pitch, yaw (rad) of each origin, in the order of [`NAMES`].
    pub origins: [[f64; 6]; 6],
    /// The controller's hash of these numbers, if the file has one.
    pub hash: Option<String>,
}

/// Why a text is not a kinematics file, or a chain cannot be written as one.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum KinematicsFileError {
    /// The YAML does not parse.
    #[error("{file}:{line}: this is not well-formed YAML: {what}")]
    Yaml {
        /// The file.
        file: String,
        /// Counted from 1.
        line: usize,
        /// What the parser says.
        what: String,
    },
    /// A number is missing.
    #[error("{file}: {name}.{key} is missing; each origin needs x, y, z, roll, pitch, yaw")]
    Missing {
        /// The file.
        file: String,
        /// The origin.
        name: String,
        /// Which number.
        key: &'static str,
    },
    /// A value is not a number.
    #[error("{file}:{line}: {path} is \"{}\", not a finite number", denavit_model::words::quoted(text))]
    NotANumber {
        /// The file.
        file: String,
        /// Counted from 1.
        line: usize,
        /// Where in the document.
        path: String,
        /// The value.
        text: String,
    },
    /// Not a known kinematics file.
    #[error(
        "{file}: not a known kinematics file: a UR file has kinematics.shoulder …, an xArm file kinematics.joint1 …, \
         a Franka file joint1.kinematic …, an OPW file opw_kinematics_geometric_parameters …, a D-H table rows with \
         theta, d, alpha, a"
    )]
    Unknown {
        /// The file.
        file: String,
    },
    /// A chain that does not fit the format.
    #[error(
        "{robot}: a kinematics file needs six revolute joints without scale or offset, but this chain has {found}; \
         write a table or a URDF"
    )]
    OtherChain {
        /// The robot.
        robot: String,
        /// What it has.
        found: String,
    },
    /// Six revolute joints that are not a UR arm.
    #[error(
        "{robot}: the axes at zero match no Universal Robots arm ({models}), so the kinematics file would \
         describe another robot; write a table or a URDF"
    )]
    OtherArm {
        /// The robot.
        robot: String,
        /// The arms that are known.
        models: String,
    },
    /// A file that looks like a known format but is invalid.
    #[error("{file}: this looks like {form}: {what}")]
    NotThisArm {
        /// The file.
        file: String,
        /// What it looks like.
        form: &'static str,
        /// Why it is invalid, and what to do.
        what: String,
    },
    /// A table in YAML.
    #[error(transparent)]
    Table(#[from] crate::sources::SourceError),
    /// Not a chain.
    #[error(transparent)]
    Chain(#[from] ChainError),
}

/// Reads a kinematics file.
///
/// # Errors
/// The YAML does not parse, or a number is missing or not finite.
pub fn read(file: &str, text: &str) -> Result<KinematicsFile, KinematicsFileError> {
    of_scalars(&Scalars::read(file, text)?)
}

pub(crate) fn of_scalars(scalars: &Scalars) -> Result<KinematicsFile, KinematicsFileError> {
    let mut found = KinematicsFile::default();
    for (origin, (name, _)) in found.origins.iter_mut().zip(NAMES) {
        *origin = scalars.origin(&["kinematics", name])?;
    }
    found.hash = scalars.text(&["kinematics", "hash"]).map(str::to_owned);
    Ok(found)
}

fn rotation([roll, pitch, yaw]: [f64; 3], order: AngleOrder) -> Rotation3<f64> {
    match order {
        AngleOrder::Urdf => se3::rotation_from_rpy([roll, pitch, yaw]),
        // Rx Ry Rz is the inverse of the URDF's product with negative angles.
        AngleOrder::Vendor => se3::rotation_from_rpy([-roll, -pitch, -yaw]).inverse(),
    }
}

fn angles(rotation: &Rotation3<f64>, order: AngleOrder) -> [f64; 3] {
    match order {
        AngleOrder::Urdf => se3::rpy_from_rotation(rotation),
        AngleOrder::Vendor => se3::rpy_from_rotation(&rotation.inverse()).map(|angle| -angle),
    }
}

impl KinematicsFile {
    /// The origins as poses.
    pub fn poses(&self, order: AngleOrder) -> [Pose; 6] {
        self.origins
            .map(|[x, y, z, roll, pitch, yaw]| se3::pose(rotation([roll, pitch, yaw], order), Vector3::new(x, y, z)))
    }

    /// The chain from the base to the frame that joint 6 turns.
    ///
    /// # Errors
    /// A number is not finite.
    pub fn chain(&self, robot: &str, order: AngleOrder) -> Result<Chain, KinematicsFileError> {
        let mut frame = Pose::identity();
        let mut joints = Vec::new();
        for (index, (origin, (_, name))) in self.poses(order).iter().zip(NAMES).enumerate() {
            frame *= origin;
            let direction = Unit::new_normalize(frame.rotation * Vector3::z());
            let point = Point3::from(frame.translation.vector);
            joints.push(ChainJoint {
                name: name.into(),
                screw: Screw::Revolute(AxisLine { direction, point }),
                coordinate: index,
                scale: 1.0,
                offset: 0.0,
            });
        }
        let coordinates = NAMES.iter().map(|(_, name)| Coordinate::unlimited(*name, Quantity::Angle)).collect();
        Ok(Chain::new((robot, "base", "wrist_3_link"), coordinates, joints, frame)?)
    }

    /// The origins that reproduce a chain's motion, and the transform from the frame of joint 6 to the chain's tip.
    ///
    /// Each frame has its z axis on the joint's axis; its origin is the foot of the common normal to the next axis or,
    /// where the two are (nearly) parallel, the point nearest to the frame before; its x axis is that of the previous
    /// frame, turned only as much as z requires. For an ideal UR these are the vendor's own frames.
    ///
    /// # Errors
    /// The chain has other than six plain revolute joints.
    pub fn of(chain: &Chain, order: AngleOrder) -> Result<(Self, Pose), KinematicsFileError> {
        if plain_lines(chain).len() != 6 || chain.joints().len() != 6 {
            let (joints, plain) = (chain.joints().len(), plain_lines(chain).len());
            let found = format!("{joints} joints, {plain} of this kind");
            return Err(KinematicsFileError::OtherChain { robot: chain.name().into(), found });
        }
        let (steps, tool) = origins(chain);
        let mut file = Self::default();
        for (origin, step) in file.origins.iter_mut().zip(&steps) {
            let [roll, pitch, yaw] = angles(&step.rotation, order);
            let place = step.translation.vector;
            *origin = [place.x, place.y, place.z, roll, pitch, yaw];
        }
        Ok((file, tool))
    }

    /// The file's text, every number with all its digits; the `comments` at the top state the order of angles.
    pub fn to_text(&self, order: AngleOrder, comments: &[String]) -> String {
        let mut text = String::new();
        for comment in comments {
            let _ = writeln!(text, "# {}", denavit_model::words::one_line(comment));
        }
        let formula = match order {
            AngleOrder::Urdf => "R = Rz(yaw) Ry(pitch) Rx(roll), as a URDF reads them",
            AngleOrder::Vendor => "R = Rx(roll) Ry(pitch) Rz(yaw), as the vendor's tool writes them",
        };
        let _ = writeln!(text, "# m and rad; {formula}");
        text.push_str("kinematics:\n");
        for ((name, _), origin) in NAMES.iter().zip(&self.origins) {
            let _ = writeln!(text, "  {name}:");
            for (key, value) in KEYS.iter().zip(origin) {
                // Adding zero turns -0 into 0.
                let _ = writeln!(text, "    {key}: {:?}", value + 0.0);
            }
        }
        if let Some(hash) = &self.hash {
            let _ = writeln!(text, "  hash: {}", crate::makers::yaml::key(hash));
        }
        text
    }
}

/// The axes of the revolute joints without scale or offset.
fn plain_lines(chain: &Chain) -> Vec<AxisLine> {
    let plain = |joint: &ChainJoint| match joint.screw {
        Screw::Revolute(line) if joint.scale == 1.0 && joint.offset == 0.0 => Some(line),
        _ => None,
    };
    chain.joints().iter().filter_map(plain).collect()
}

/// Joint origins of a chain of plain revolute joints, placed as in [`KinematicsFile::of`], and the pose of the tip in the
/// last one's frame.
pub(crate) fn origins(chain: &Chain) -> (Vec<Pose>, Pose) {
    let lines = plain_lines(chain);
    let tip = Point3::from(chain.home().translation.vector);
    let mut before = Pose::identity();
    let mut origins = Vec::new();
    let mut reached = Pose::identity();
    for (index, line) in lines.iter().enumerate() {
        let last = Point3::from(before.translation.vector);
        let origin = match lines.get(index + 1) {
            Some(next) => foot(line, next).unwrap_or_else(|| line.nearest_to(&last)),
            None => line.nearest_to(&tip),
        };
        let z = before.rotation * Vector3::z();
        let turn = least_turn(&z, &line.direction, &(before.rotation * Vector3::x()));
        let rotation = se3::orthonormalised(&(turn * before.rotation));
        let frame = se3::pose(rotation, origin.coords);
        let step = before.inverse() * frame;
        origins.push(step);
        reached *= step;
        before = frame;
    }
    (origins, reached.inverse() * chain.home())
}

/// Axes closer to parallel than this have no common normal to speak of, rad.
const NEARLY_PARALLEL: f64 = 0.05;

/// The point of a line nearest to another one; `None` when they are nearly parallel.
fn foot(line: &AxisLine, other: &AxisLine) -> Option<Point3<f64>> {
    let cross = line.direction.cross(&other.direction);
    (cross.norm() > NEARLY_PARALLEL).then(|| {
        let along = (other.point - line.point).cross(&other.direction).dot(&cross) / cross.norm_squared();
        line.point + line.direction.into_inner() * along
    })
}

/// The least rotation from one direction to another; about `fallback` where they are opposite.
fn least_turn(from: &Vector3<f64>, to: &Vector3<f64>, fallback: &Vector3<f64>) -> Rotation3<f64> {
    let opposite = from.cross(to).norm() == 0.0 && from.dot(to) < 0.0;
    if opposite { se3::rotation_about(fallback, std::f64::consts::PI) } else { se3::least_rotation(from, to) }
}
