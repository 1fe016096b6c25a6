//! What an operation says of its result, for the proof to compare with it.

use denavit_model::hull::Hull;
use denavit_model::nalgebra::{Point3, Vector3};
use denavit_model::se3::{self, Pose};
use std::collections::BTreeMap;

/// How a joint's value reads after an edit: new = sense · old + shift.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JointMap {
    /// 1, or -1 for a joint that counts the other way.
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
    /// Whether parent and child are exchanged.
    pub reversed: bool,
}

/// A link of the old robot in the new one.
#[derive(Debug, Clone, PartialEq)]
pub struct KeptLink {
    /// Its name, or that of the link it was merged into.
    pub name: String,
    /// new_from_old: the old frame in the new one.
    pub offset: Pose,
    /// The link that its shapes and mass are in, and new_from_old there; `None`: with its frame.
    pub matter: Option<(String, Pose)>,
}

/// What the edit does to space.
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

/// Where everything of the old robot is in the new one.
#[derive(Debug, Clone, PartialEq)]
pub struct Claim {
    /// Old link names; those that are missing are not part of the new robot.
    pub links: BTreeMap<String, KeptLink>,
    /// Old joint names; those that are missing are not part of the new robot, or no longer move.
    pub joints: BTreeMap<String, KeptJoint>,
    /// What happens to space.
    pub space: Space,
    /// The old link whose frame the motion is looked at from.
    pub seen_from: String,
    /// How masses and tensors are compared: an edit of the shapes alone, or of the masses.
    pub masses: Masses,
    /// Whether shapes must be the same.
    pub shapes: Shapes,
    /// Length, m, by which frames may move on purpose.
    pub moves: Option<f64>,
    /// Whether `denavit diff` finds the two the same, and what it is told to leave out.
    pub compared: Compared,
    /// Links of the new robot that hold what comes from elsewhere.
    pub foreign: bool,
    /// New names of mesh files by their old ones.
    pub files: BTreeMap<String, String>,
    /// Points that collision shapes of the new robot must hold.
    pub(crate) enclosed: Vec<Enclosed>,
}

/// Points that a collision shape of the new robot must hold.
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
    /// The same but for zeros and senses.
    UpToZeros,
    /// The same but for frames that are gone, and what names them.
    UpToFrames,
    /// The same with every literal read as it is meant.
    AsMeant,
    /// Not to be compared so: another base, a part, a mirror image.
    No,
}

/// What must be true of masses.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Masses {
    /// Every link has the sum of what came into it.
    Kept,
    /// Not held.
    Free,
}

/// What must be true of shapes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shapes {
    /// All are there, where they were.
    Kept,
    /// Those that are seen are; those that collide are other ones.
    CollisionsChange,
    /// All are there, turned by as much as a literal was off what it means.
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
