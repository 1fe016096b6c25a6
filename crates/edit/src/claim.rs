//! What an operation claims about its result; the proof checks it.

use denavit_model::hull::Hull;
use denavit_model::nalgebra::{Point3, Vector3};
use denavit_model::se3::{self, Pose};
use std::collections::BTreeMap;

/// A joint's value after an edit: new = sense · old + shift.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JointMap {
    /// 1, or -1 for a reversed joint.
    pub sense: f64,
    /// rad or m.
    pub shift: f64,
}

impl JointMap {
    /// The value stays.
    pub const SAME: Self = Self { sense: 1.0, shift: 0.0 };

    /// The new value of an old one.
    pub fn of(self, old: f64) -> f64 {
        self.sense * old + self.shift
    }
}

/// A joint of the old robot in the new one.
#[derive(Debug, Clone, PartialEq)]
pub struct KeptJoint {
    /// Its name in the new robot.
    pub name: String,
    /// Its value there.
    pub map: JointMap,
    /// Whether parent and child are swapped.
    pub reversed: bool,
}

/// A link of the old robot in the new one.
#[derive(Debug, Clone, PartialEq)]
pub struct KeptLink {
    /// Its name, or that of the link it was merged into.
    pub name: String,
    /// new_from_old: the old frame in the new one.
    pub offset: Pose,
    /// The link with its shapes and mass, and new_from_old for them; `None`: the same as its frame.
    pub matter: Option<(String, Pose)>,
}

/// How the edit transforms space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Space {
    /// The coordinate (0, 1, 2) that changes its sign.
    pub mirrored: Option<usize>,
    /// Factor on every length.
    pub scale: f64,
}

impl Space {
    /// Nothing.
    pub const SAME: Self = Self { mirrored: None, scale: 1.0 };

    /// A vector of the new robot from one of the old.
    pub fn vector(&self, vector: Vector3<f64>) -> Vector3<f64> {
        let mut vector = vector * self.scale;
        if let Some(index) = self.mirrored {
            vector[index] = -vector[index];
        }
        vector
    }

    /// A pose of the new robot from one of the old: M T M.
    pub fn pose(&self, pose: &Pose) -> Pose {
        let mut rotation = pose.rotation.into_inner();
        if let Some(index) = self.mirrored {
            for other in (0..3).filter(|other| *other != index) {
                rotation[(index, other)] = -rotation[(index, other)];
                rotation[(other, index)] = -rotation[(other, index)];
            }
        }
        let rotation = denavit_model::nalgebra::Rotation3::from_matrix_unchecked(rotation);
        se3::pose(rotation, self.vector(pose.translation.vector))
    }
}

/// Where everything in the old robot is in the new one.
#[derive(Debug, Clone, PartialEq)]
pub struct Claim {
    /// Old link names; those that are missing are not part of the new robot.
    pub links: BTreeMap<String, KeptLink>,
    /// Old joint names; those that are missing are not part of the new robot, or no longer move.
    pub joints: BTreeMap<String, KeptJoint>,
    /// The transformation of space.
    pub space: Space,
    /// The old link whose frame is the reference of the motion.
    pub seen_from: String,
    /// How masses and tensors are compared: an edit of the shapes alone, or of the masses.
    pub masses: Masses,
    /// Whether shapes must be the same.
    pub shapes: Shapes,
    /// Length, m, by which frames may move intentionally.
    pub moves: Option<f64>,
    /// Whether `denavit diff` finds the two the same, and with which options.
    pub compared: Compared,
    /// Links of the new robot that come from another robot.
    pub foreign: bool,
    /// New names of mesh files by their old ones.
    pub files: BTreeMap<String, String>,
    /// Points that collision shapes of the new robot must contain.
    pub(crate) enclosed: Vec<Enclosed>,
}

/// Points that a collision shape of the new robot must contain.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Enclosed {
    /// Its link's new name.
    pub link: String,
    /// Which of the link's collision shapes.
    pub index: usize,
    /// In the link's frame, m.
    pub points: Vec<Point3<f64>>,
    /// What the shape's file holds, where it is a mesh.
    pub hull: Option<Hull>,
}

/// What `denavit diff` must find.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Compared {
    /// The same robot.
    Same,
    /// The same except zeros and senses.
    UpToZeros,
    /// The same except removed frames and references to them.
    UpToFrames,
    /// The same with every literal read as intended.
    AsMeant,
    /// Not comparable: another base, a part, a mirror image.
    No,
}

/// What must be true of masses.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Masses {
    /// Every link has the sum of the masses merged into it.
    Kept,
    /// Not checked.
    Free,
}

/// What must be true of shapes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shapes {
    /// All are there, where they were.
    Kept,
    /// Visual shapes are unchanged; collision shapes are replaced.
    CollisionsChange,
    /// All are there, turned by the deviation of literals from their intended values.
    Turned,
}

impl Claim {
    /// Every link and joint under its own name, nothing moved.
    pub fn same(robot: &denavit_model::Robot) -> Self {
        let link = |name: &String| KeptLink { name: name.clone(), offset: Pose::identity(), matter: None };
        let joint = |name: &String| KeptJoint { name: name.clone(), map: JointMap::SAME, reversed: false };
        Self {
            links: robot.links.iter().map(|of| (of.name.clone(), link(&of.name))).collect(),
            joints: robot.joints.iter().map(|of| (of.name.clone(), joint(&of.name))).collect(),
            space: Space::SAME,
            seen_from: robot.links[robot.root].name.clone(),
            masses: Masses::Kept,
            shapes: Shapes::Kept,
            moves: None,
            compared: Compared::Same,
            foreign: false,
            files: BTreeMap::new(),
            enclosed: Vec::new(),
        }
    }
}
