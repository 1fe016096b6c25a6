//! A robot with everything that follows from its tree, computed once.
//!
//! Which joint carries which link, angles as they are read, where every link is with every joint value 0, what moves as
//! one, and whose value moves each joint. Used by chains, comparison, export, drawings and statics.

use crate::chain::Quantity;
use crate::notes::Noted;
use crate::problems::nearest_name;
use crate::robot::{Inertial, Joint, JointKind, Origin, ReadOrigin, Robot};
use crate::screw::{AxisLine, Screw};
use crate::se3::Pose;
use crate::tree::{Reading, TreeError};
use nalgebra::{Matrix3, Point3};
use std::collections::HashMap;

/// A robot and what follows from its tree; linear in the number of links, and cheap compared to reading the file.
#[derive(Debug, Clone)]
pub struct PlacedRobot<'a> {
    robot: &'a Robot,
    reading: Reading,
    carriers: Vec<Option<usize>>,
    carried: Vec<Vec<usize>>,
    order: Vec<usize>,
    origins: Vec<ReadOrigin>,
    poses: Vec<Pose>,
    bodies: Vec<usize>,
    drives: Vec<Result<Drive, NoDrive>>,
}

/// What moves a joint: value = scale · value of joint `driver` + offset.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Drive {
    /// The joint whose value is free; `None` where nothing moves this one.
    pub driver: Option<usize>,
    /// Factor.
    pub scale: f64,
    /// rad or m.
    pub offset: f64,
}

/// Where a joint's mimics lead.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Follows {
    /// A joint whose value is free: itself, where it mimics none.
    Joint(usize),
    /// A joint that does not move, or one by a multiplier of 0.
    Nothing,
    /// Each other.
    Itself,
    /// A joint that does not exist, or has several values.
    Unknown,
}

/// Why a mimic joint has no joint to follow.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct NoDrive {
    /// The joint whose `mimic` leads nowhere: the joint itself, or one that it follows.
    at: usize,
    why: Why,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Why {
    Missing,
    SeveralValues,
    Circle,
}

/// A link's mass in the root frame with every joint value 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlacedMass {
    /// kg.
    pub mass: f64,
    /// m.
    pub centre: Point3<f64>,
    /// About the centre, along the root frame's axes, kg·m².
    pub tensor: Matrix3<f64>,
}

impl<'a> PlacedRobot<'a> {
    /// Places a robot, the angles of its origins as written or as intended.
    pub fn new(robot: &'a Robot, reading: Reading) -> Self {
        let (carriers, carried) = (robot.carriers(), robot.carried());
        let origins: Vec<ReadOrigin> = robot.joints.iter().map(|joint| joint.origin.read(reading)).collect();
        let mut poses = vec![Pose::identity(); robot.links.len()];
        let mut bodies: Vec<usize> = (0..robot.links.len()).collect();
        let mut order = Vec::with_capacity(robot.links.len());
        let mut open = vec![robot.root];
        while let Some(link) = open.pop() {
            order.push(link);
            for index in carried[link].iter().rev() {
                let joint = &robot.joints[*index];
                poses[joint.child] = poses[link] * origins[*index].pose();
                if !joint.kind.moves() {
                    bodies[joint.child] = bodies[link];
                }
                open.push(joint.child);
            }
        }
        let drives = drives(robot);
        Self { robot, reading, carriers, carried, order, origins, poses, bodies, drives }
    }

    /// The robot.
    pub fn robot(&self) -> &'a Robot {
        self.robot
    }

    /// How its angles were read.
    pub fn reading(&self) -> Reading {
        self.reading
    }

    /// Every link, each branch to its end before the next, in the order of the file.
    pub fn order(&self) -> &[usize] {
        &self.order
    }

    /// The joint that carries a link; `None` for the root.
    pub fn carrier(&self, link: usize) -> Option<usize> {
        self.carriers[link]
    }

    /// The joints that a link carries, in the order of the file.
    pub fn carried(&self, link: usize) -> &[usize] {
        &self.carried[link]
    }

    /// A joint's origin as it is read.
    pub fn origin(&self, joint: usize) -> &ReadOrigin {
        &self.origins[joint]
    }

    /// root_from_link with every joint value 0.
    pub fn pose(&self, link: usize) -> &Pose {
        &self.poses[link]
    }

    /// The first link of the rigid body that a link belongs to: the one after the nearest moving joint.
    pub fn body(&self, link: usize) -> usize {
        self.bodies[link]
    }

    /// root_from_part of what sits at an origin in a link: a shape, a centre of mass.
    pub fn part(&self, link: usize, origin: &Origin) -> Pose {
        self.poses[link] * origin.read(self.reading).pose()
    }

    /// A link's mass, where it has an `inertial`.
    pub fn mass(&self, link: usize) -> Option<PlacedMass> {
        let Inertial { origin, mass, tensor } = self.robot.links[link].inertial.as_ref()?;
        let placed = self.part(link, origin);
        let r = placed.rotation.matrix();
        let tensor = r * tensor * r.transpose();
        Some(PlacedMass { mass: *mass, centre: Point3::from(placed.translation.vector), tensor })
    }

    /// A joint's screw axis in the root frame; `None` where its kind has none. For a planar joint: the direction of its normal.
    pub fn screw(&self, joint: usize) -> Option<Screw> {
        let joint = &self.robot.joints[joint];
        let screw = joint.kind.screw(joint, self.reading).or_else(|| {
            let planar = joint.kind == JointKind::Planar;
            planar.then_some(Screw::Prismatic(joint.axis_as(self.reading)))
        })?;
        Some(screw.moved(&self.poses[joint.child]))
    }

    /// What moves a joint, mimic joints followed to the joint whose value is free.
    ///
    /// # Errors
    /// It follows a joint that does not exist, that has several values, or that follows it in turn.
    pub fn drive(&self, joint: usize) -> Result<Drive, TreeError> {
        self.drives[joint].map_err(|NoDrive { at, why }| {
            let place = self.robot.joint_place(joint);
            let name = |joint: usize| {
                let mimic = self.robot.joints[joint].mimic.as_ref();
                mimic.map(|mimic| mimic.joint.clone()).unwrap_or_default()
            };
            match why {
                Why::Missing => {
                    let names = self.robot.joints.iter().map(|joint| joint.name.as_str());
                    let near = nearest_name(&name(at), names).map(str::to_owned);
                    TreeError::NoDriver { place, driver: name(at), near }
                }
                Why::SeveralValues => {
                    let why = "it has more than one value; follow a revolute or prismatic joint";
                    TreeError::BadDriver { place, driver: name(at), why }
                }
                Why::Circle => {
                    let why = "the two follow each other; free one of them";
                    TreeError::BadDriver { place, driver: name(joint), why }
                }
            }
        })
    }

    /// Where a joint's mimics lead.
    pub fn follows(&self, joint: usize) -> Follows {
        match self.drives[joint] {
            Ok(Drive { driver: Some(driver), .. }) => Follows::Joint(driver),
            Ok(_) => Follows::Nothing,
            Err(NoDrive { why: Why::Circle, .. }) => Follows::Itself,
            Err(_) => Follows::Unknown,
        }
    }

    /// The joint whose value moves a joint: itself, or the one that it follows in the end; `None` where none does.
    pub fn driver(&self, joint: usize) -> Option<usize> {
        self.drives[joint].ok()?.driver
    }

    /// The chain from `base` to `tip`, as [`Robot::chain`] describes it.
    ///
    /// # Errors
    /// As [`Robot::chain`].
    pub fn chain(&self, base: Option<&str>, tip: Option<&str>) -> Result<Noted<crate::Chain>, TreeError> {
        crate::tree::chain(self, base, tip)
    }
}

impl JointKind {
    /// The screw axis of a joint of this kind in its own frame; `None` where it has not exactly one value.
    pub(crate) fn screw(&self, joint: &Joint, reading: Reading) -> Option<Screw> {
        let axis = joint.axis_as(reading);
        let line = AxisLine { direction: axis, point: Point3::origin() };
        match self {
            Self::Revolute | Self::Continuous => Some(Screw::Revolute(line)),
            Self::Screw(pitch) => Some(Screw::Helical { axis: line, pitch: *pitch }),
            Self::Prismatic => Some(Screw::Prismatic(axis)),
            _ => None,
        }
    }

    /// Whether a joint of this kind has one value: it turns, slides, or does both by a screw.
    pub fn has_one_value(&self) -> bool {
        matches!(self, Self::Revolute | Self::Continuous | Self::Prismatic | Self::Screw(_))
    }

    /// The quantity of the value of a joint of this kind.
    pub fn quantity(&self) -> Quantity {
        if *self == Self::Prismatic { Quantity::Length } else { Quantity::Angle }
    }
}

/// Every joint's drive, each once, followers after the joint that they follow.
fn drives(robot: &Robot) -> Vec<Result<Drive, NoDrive>> {
    let still = Drive { driver: None, scale: 1.0, offset: 0.0 };
    let own = |index: usize| Drive { driver: robot.joints[index].kind.moves().then_some(index), ..still };
    if robot.joints.iter().all(|joint| joint.mimic.is_none()) {
        return (0..robot.joints.len()).map(|index| Ok(own(index))).collect();
    }
    let names: HashMap<&str, usize> =
        robot.joints.iter().enumerate().map(|(index, joint)| (joint.name.as_str(), index)).collect();
    let mut found: Vec<Option<Result<Drive, NoDrive>>> = vec![None; robot.joints.len()];
    let mut on_the_way = vec![false; robot.joints.len()];
    for start in 0..robot.joints.len() {
        let mut way = Vec::new();
        let mut at = start;
        let mut last = loop {
            if let Some(known) = found[at] {
                break known;
            }
            if on_the_way[at] {
                break Err(NoDrive { at, why: Why::Circle });
            }
            let joint = &robot.joints[at];
            let Some(mimic) = joint.mimic.as_ref().filter(|_| joint.kind.moves()) else {
                found[at] = Some(Ok(own(at)));
                break Ok(own(at));
            };
            on_the_way[at] = true;
            way.push(at);
            let Some(next) = names.get(mimic.joint.as_str()) else { break Err(NoDrive { at, why: Why::Missing }) };
            if matches!(robot.joints[*next].kind, JointKind::Planar | JointKind::Floating | JointKind::Unknown(_)) {
                break Err(NoDrive { at, why: Why::SeveralValues });
            }
            at = *next;
        };
        for follower in way.into_iter().rev() {
            on_the_way[follower] = false;
            if let (Some(mimic), Ok(drive)) = (&robot.joints[follower].mimic, &mut last) {
                drive.offset = mimic.offset + mimic.multiplier * drive.offset;
                drive.scale *= mimic.multiplier;
                if drive.scale == 0.0 {
                    drive.driver = None;
                }
            }
            found[follower] = Some(last);
        }
    }
    found.into_iter().map(|drive| drive.unwrap_or(Ok(still))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::urdf;
    use std::fmt::Write as _;

    const TREE: &str = r#"<robot name="r"><link name="root"/><link name="a"/><link name="b"><inertial><mass value="2"/>
        <origin xyz="0 1 0" rpy="0 0 1.57"/><inertia ixx="1" iyy="2" izz="3" ixy="0" ixz="0" iyz="0"/></inertial></link>
        <link name="c"/>
        <joint name="j" type="revolute"><origin rpy="0 0 1.57"/><parent link="root"/><child link="a"/></joint>
        <joint name="f" type="fixed"><origin xyz="1 0 0"/><parent link="a"/><child link="b"/></joint>
        <joint name="k" type="prismatic"><parent link="root"/><child link="c"/><mimic joint="j" multiplier="2"/></joint>
        </robot>"#;

    #[test]
    fn links_bodies_masses_and_drives_stand_where_the_tree_puts_them() {
        let robot = urdf::read("r.urdf", TREE).unwrap();
        let placed = PlacedRobot::new(&robot, Reading::Intended);
        assert_eq!(placed.order(), [0, 1, 2, 3]);
        assert_eq!((placed.body(2), placed.carrier(2)), (1, Some(1)));
        assert!((placed.pose(2).translation.vector - nalgebra::Vector3::new(0.0, 1.0, 0.0)).norm() < 1e-15);
        let mass = placed.mass(2).unwrap();
        // Two quarter turns: behind the joint's, and about the inertial's own.
        assert!((mass.centre - Point3::new(-1.0, 1.0, 0.0)).norm() < 1e-15);
        assert!((mass.tensor - Matrix3::from_diagonal(&nalgebra::Vector3::new(1.0, 2.0, 3.0))).norm() < 1e-14);
        assert_eq!(placed.drive(2).unwrap(), Drive { driver: Some(0), scale: 2.0, offset: 0.0 });
        let written = PlacedRobot::new(&robot, Reading::AsWritten);
        assert!((written.mass(2).unwrap().centre - mass.centre).norm() > 1e-4);
    }

    #[test]
    fn long_rows_of_mimics_take_no_longer_than_their_length() {
        let mut joints = String::new();
        for k in 0..5000 {
            let next = k + 1;
            let mimic = if k < 4999 { format!("<mimic joint=\"j{next}\"/>") } else { String::new() };
            let _ = write!(
                joints,
                "<link name=\"l{next}\"/><joint name=\"j{k}\" type=\"revolute\"><parent link=\"l{k}\"/><child \
                 link=\"l{next}\"/>{mimic}</joint>"
            );
        }
        let robot = urdf::read("r.urdf", &format!("<robot name=\"r\"><link name=\"l0\"/>{joints}</robot>")).unwrap();
        let chain = robot.chain(None, None, Reading::Intended).unwrap().value;
        assert_eq!((chain.joints().len(), chain.coordinates().len()), (5000, 1));
    }
}
