//! A robot without its link frames: what is left is what a comparison may look at.
//!
//! Links joined by fixed joints are one body. Everything is given in the root frame with every joint value 0: screw
//! axes, shapes, masses, and the link frames as mere marks. Body 0 stands; body k + 1 is carried by joint k.

mod screws;

use denavit_model::nalgebra::{Matrix3, Point3, Unit, Vector3};
use denavit_model::robot::{Geometry, Inertial, Joint, JointKind, Origin};
use denavit_model::se3::{self, Pose};
use denavit_model::{AxisLine, Chain, Limits, Robot, Screw, intended, tree::Reading};
use std::f64::consts::PI;

/// The gauge-free form of a tree or a chain.
#[derive(Debug, Clone)]
pub struct Mechanism {
    /// The robot's name.
    pub name: String,
    /// Joints that move, parents before children.
    pub joints: Vec<MovingJoint>,
    /// Joints that do not, by name, with the link that they carry.
    pub fixed: Vec<(String, String)>,
    /// The root body, then one body per joint.
    pub bodies: Vec<Body>,
    /// Where joints with coordinates of their own can be.
    pub coordinates: Vec<Interval>,
    /// A length to measure rounding by, m.
    pub size: f64,
    /// Whether it came from a table, which is silent about limits and links.
    pub bare: bool,
}

/// An interval of a coordinate, rad or m.
#[derive(Debug, Clone, PartialEq)]
pub struct Interval {
    /// The joint that has it.
    pub name: String,
    /// Lowest value.
    pub lower: f64,
    /// Highest value.
    pub upper: f64,
    /// Whether limits in the source make it.
    pub limited: bool,
}

/// A joint that moves.
#[derive(Debug, Clone)]
pub struct MovingJoint {
    /// Its name.
    pub name: String,
    /// The word of the source: `revolute`, `continuous`, `prismatic`, `screw`, `planar`, `floating`, …
    pub kind: String,
    /// Its axis in the root frame at zero; `None` where the kind has none (floating, unknown).
    pub screw: Option<Screw>,
    /// Its place in the source, m: used to say *where* an axis was moved.
    pub origin: Point3<f64>,
    /// Index of the joint that carries it; `None` on the root body.
    pub parent: Option<usize>,
    /// The link behind it.
    pub child: String,
    /// value = scale · q\[coordinate\] + offset; `None` where it is held at 0 (planar, floating, broken mimic).
    pub drive: Option<Drive>,
    /// As the source states them; no range where the joint turns without end.
    pub limits: Limits,
    /// As the source states it: joint, multiplier, offset.
    pub mimic: Option<(String, f64, f64)>,
}

/// What moves a joint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Drive {
    /// Index into [`Mechanism::coordinates`].
    pub coordinate: usize,
    /// Factor.
    pub scale: f64,
    /// rad or m.
    pub offset: f64,
}

/// Links that move as one.
#[derive(Debug, Clone, Default)]
pub struct Body {
    /// Its links.
    pub frames: Vec<Frame>,
    /// What is seen and what collides.
    pub shapes: Vec<PlacedShape>,
    /// Sum of the links' inertials.
    pub mass: Option<Mass>,
}

/// A link's frame.
#[derive(Debug, Clone)]
pub struct Frame {
    /// The link's name.
    pub link: String,
    /// root_from_link at zero.
    pub pose: Pose,
    /// The joint that carries the link; `None` for the root.
    pub carrier: Option<String>,
    /// Whether no joint hangs on it.
    pub leaf: bool,
    /// Whether it has a shape or a mass.
    pub matter: bool,
}

/// Which of a link's two lists a shape stands in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Role {
    /// Seen.
    Visual,
    /// Collides.
    Collision,
}

/// A shape and where it sits.
#[derive(Debug, Clone)]
pub struct PlacedShape {
    /// The link that has it.
    pub link: String,
    /// Visual or collision.
    pub role: Role,
    /// What it is.
    pub geometry: Geometry,
    /// root_from_shape at zero.
    pub pose: Pose,
}

/// Mass, centre and tensor about the centre, in the root frame at zero.
#[derive(Debug, Clone)]
pub struct Mass {
    /// The links that have a share, and their shares.
    pub shares: Vec<Share>,
    /// kg.
    pub mass: f64,
    /// m.
    pub centre: Point3<f64>,
    /// kg·m², about the centre, along the root frame's axes.
    pub tensor: Matrix3<f64>,
}

/// A link's share of a body's mass.
#[derive(Debug, Clone)]
pub struct Share {
    /// The link.
    pub link: String,
    /// kg.
    pub mass: f64,
    /// m.
    pub centre: Point3<f64>,
    /// kg·m², about its own centre.
    pub tensor: Matrix3<f64>,
}

impl Mass {
    fn of(link: &str, inertial: &Inertial, root_from_link: &Pose, reading: Reading) -> Self {
        let placed = root_from_link * pose_of(&inertial.origin, reading);
        let r = placed.rotation.matrix();
        let (mass, centre) = (inertial.mass, Point3::from(placed.translation.vector));
        let tensor = r * inertial.tensor * r.transpose();
        Self { shares: vec![Share { link: link.to_owned(), mass, centre, tensor }], mass, centre, tensor }
    }

    /// The whole as if it were one link's, under the first link's name.
    pub(crate) fn sum(&self) -> Share {
        let link = self.shares.first().map_or_else(String::new, |share| share.link.clone());
        Share { link, mass: self.mass, centre: self.centre, tensor: self.tensor }
    }

    /// The same after a motion.
    #[must_use]
    pub(crate) fn moved(&self, motion: &Pose) -> Self {
        let r = motion.rotation.matrix();
        let turned = |tensor: &Matrix3<f64>| r * tensor * r.transpose();
        let shares = self.shares.iter().map(|share| Share {
            centre: motion * share.centre,
            tensor: turned(&share.tensor),
            ..share.clone()
        });
        Self { shares: shares.collect(), mass: self.mass, centre: motion * self.centre, tensor: turned(&self.tensor) }
    }

    /// Both as one rigid body (parallel axis theorem).
    pub(crate) fn joined(mut self, other: Self) -> Self {
        let mass = self.mass + other.mass;
        let centre = if mass == 0.0 {
            self.centre
        } else {
            Point3::from((self.centre.coords * self.mass + other.centre.coords * other.mass) / mass)
        };
        let about = |part: &Self| part.tensor + steiner(part.mass, &(part.centre - centre));
        let tensor = about(&self) + about(&other);
        self.shares.extend(other.shares);
        Self { shares: self.shares, mass, centre, tensor }
    }
}

fn steiner(mass: f64, d: &Vector3<f64>) -> Matrix3<f64> {
    (Matrix3::identity() * d.norm_squared() - d * d.transpose()) * mass
}

/// parent_from_child of an origin, its angles as written or as intended.
fn pose_of(origin: &Origin, reading: Reading) -> Pose {
    let (Reading::Intended, Some(written)) = (reading, &origin.rpy_written) else { return origin.pose() };
    let mut read = origin.clone();
    for (angle, literal) in read.rpy.iter_mut().zip(written) {
        if let Some(intended) = intended::read_as(literal) {
            *angle = intended.angle;
        }
    }
    read.pose()
}

fn screw_of(joint: &Joint, root_from_joint: &Pose) -> Option<Screw> {
    let line = AxisLine { direction: joint.axis, point: Point3::origin() };
    let screw = match &joint.kind {
        JointKind::Revolute | JointKind::Continuous => Screw::Revolute(line),
        JointKind::Screw(pitch) => Screw::Helical { axis: line, pitch: *pitch },
        JointKind::Prismatic | JointKind::Planar => Screw::Prismatic(joint.axis),
        _ => return None,
    };
    Some(screw.moved(root_from_joint))
}

/// Whether a joint of this kind has one value.
fn has_one_value(kind: &JointKind) -> bool {
    matches!(kind, JointKind::Revolute | JointKind::Continuous | JointKind::Prismatic | JointKind::Screw(_))
}

impl Mechanism {
    /// The gauge-free form of a tree.
    ///
    /// Planar and floating joints, joints of unknown kind and mimic joints without a driver are held at 0 when
    /// poses are sampled; what they carry is compared all the same.
    pub fn of_robot(robot: &Robot, reading: Reading) -> Self {
        let mut result = Self {
            name: robot.name.clone(),
            joints: Vec::new(),
            fixed: Vec::new(),
            bodies: vec![Body::default()],
            coordinates: Vec::new(),
            size: 0.0,
            bare: false,
        };
        let mut moving = vec![None; robot.joints.len()];
        let mut carried: Vec<Vec<usize>> = vec![Vec::new(); robot.links.len()];
        for (index, joint) in robot.joints.iter().enumerate() {
            carried[joint.parent].push(index);
        }
        let mut open = vec![(robot.root, 0, Pose::identity(), None)];
        while let Some((link, body, pose, carrier)) = open.pop() {
            result.add_link(robot, link, (body, pose, carrier), carried[link].is_empty(), reading);
            for index in carried[link].iter().rev() {
                let joint = &robot.joints[*index];
                let below = pose * pose_of(&joint.origin, reading);
                result.size += Vector3::from(joint.origin.xyz).norm();
                let next = if joint.kind.moves() {
                    result.add_joint(robot, *index, body, &below);
                    moving[*index] = Some(result.joints.len() - 1);
                    result.joints.len()
                } else {
                    result.fixed.push((joint.name.clone(), robot.links[joint.child].name.clone()));
                    body
                };
                open.push((joint.child, next, below, Some(joint.name.clone())));
            }
        }
        result.connect_drives(robot, &moving);
        result.size = if result.size > 0.0 { result.size } else { 1.0 };
        result
    }

    fn add_link(
        &mut self,
        robot: &Robot,
        link: usize,
        (body, pose, carrier): (usize, Pose, Option<String>),
        leaf: bool,
        reading: Reading,
    ) {
        let link = &robot.links[link];
        let body = &mut self.bodies[body];
        for (role, shapes) in [(Role::Visual, &link.visuals), (Role::Collision, &link.collisions)] {
            body.shapes.extend(shapes.iter().map(|shape| PlacedShape {
                link: link.name.clone(),
                role,
                geometry: shape.geometry.clone(),
                pose: pose * pose_of(&shape.origin, reading),
            }));
        }
        if let Some(inertial) = &link.inertial {
            let share = Mass::of(&link.name, inertial, &pose, reading);
            body.mass = Some(match body.mass.take() {
                Some(mass) => mass.joined(share),
                None => share,
            });
        }
        let weighs = link.inertial.as_ref().is_some_and(|inertial| inertial.mass != 0.0);
        let matter = weighs || !link.visuals.is_empty() || !link.collisions.is_empty();
        body.frames.push(Frame { link: link.name.clone(), pose, carrier, leaf, matter });
    }

    fn add_joint(&mut self, robot: &Robot, index: usize, body: usize, root_from_joint: &Pose) {
        let joint = &robot.joints[index];
        self.joints.push(MovingJoint {
            name: joint.name.clone(),
            kind: joint.kind.word().to_owned(),
            screw: screw_of(joint, root_from_joint),
            origin: Point3::from(root_from_joint.translation.vector),
            parent: body.checked_sub(1),
            child: robot.links[joint.child].name.clone(),
            drive: None,
            limits: joint.limits_in_force(),
            mimic: joint.mimic.as_ref().map(|mimic| (mimic.joint.clone(), mimic.multiplier, mimic.offset)),
        });
        self.bodies.push(Body::default());
    }

    fn connect_drives(&mut self, robot: &Robot, moving: &[Option<usize>]) {
        let mut coordinate_of = vec![None; robot.joints.len()];
        for (index, joint) in robot.joints.iter().enumerate() {
            if joint.mimic.is_none() && has_one_value(&joint.kind) {
                coordinate_of[index] = Some(self.coordinates.len());
                self.coordinates.push(interval_of(joint));
            }
        }
        for (index, moving) in moving.iter().enumerate() {
            let Some(moving) = moving else { continue };
            if !has_one_value(&robot.joints[index].kind) {
                continue;
            }
            let (mut at, mut scale, mut offset) = (Some(index), 1.0, 0.0);
            for _ in 0..=robot.joints.len() {
                let Some(mimic) = at.and_then(|at| robot.joints[at].mimic.as_ref()) else { break };
                offset += scale * mimic.offset;
                scale *= mimic.multiplier;
                at = robot.joint_index(&mimic.joint);
            }
            let coordinate = at.and_then(|at| coordinate_of[at]);
            self.joints[*moving].drive = coordinate.map(|coordinate| Drive { coordinate, scale, offset });
        }
    }

    /// The gauge-free form of a bare chain: its tip link is an empty leaf behind the last joint.
    pub fn of_chain(chain: &Chain) -> Self {
        let coordinates = chain.coordinates().iter().map(|coordinate| {
            let (lower, upper) = coordinate.range();
            Interval { name: coordinate.name.clone(), lower, upper, limited: coordinate.limits.range.is_some() }
        });
        let mut joints: Vec<MovingJoint> = Vec::new();
        let mut bodies = vec![Body::default()];
        bodies[0].frames.push(mark(chain.base(), Pose::identity(), None, false));
        // An offset of a joint that has its own coordinate is geometry: the zero is where the coordinate is 0.
        let mut zeroed = Pose::identity();
        for (index, joint) in chain.joints().iter().enumerate() {
            let coordinate = &chain.coordinates()[joint.coordinate];
            let own = coordinate.name == joint.name;
            let screw = joint.screw.moved(&zeroed);
            let last = joints.last().map_or_else(Point3::origin, |joint| joint.origin);
            let origin = screw.line().map_or(last, |line| line.nearest_to(&last));
            let offset = if own { 0.0 } else { joint.offset };
            if own {
                zeroed = screw.motion(joint.offset) * zeroed;
            }
            // A path that runs up the tree turns against the axis that the joint names.
            let (screw, scale) =
                if own && joint.scale < 0.0 { (reversed(&screw), -joint.scale) } else { (screw, joint.scale) };
            joints.push(MovingJoint {
                name: joint.name.clone(),
                kind: word_of(&screw, own && coordinate.continuous).to_owned(),
                screw: Some(screw),
                origin,
                parent: index.checked_sub(1),
                child: String::new(),
                drive: Some(Drive { coordinate: joint.coordinate, scale, offset }),
                limits: if own { coordinate.limits } else { Limits::default() },
                mimic: (!own).then(|| (coordinate.name.clone(), joint.scale, joint.offset)),
            });
            bodies.push(Body::default());
        }
        let carrier = joints.last().map(|joint| joint.name.clone());
        if let Some(last) = bodies.last_mut() {
            last.frames.push(mark(chain.tip(), zeroed * chain.home(), carrier, true));
        }
        if let Some(last) = joints.last_mut() {
            chain.tip().clone_into(&mut last.child);
        }
        let (name, coordinates, size) = (chain.name().to_owned(), coordinates.collect(), chain.size());
        Self { name, joints, fixed: Vec::new(), bodies, coordinates, size, bare: true }
    }

    /// Joints from the root to the body that joint `last` carries.
    pub fn path(&self, last: Option<usize>) -> Vec<usize> {
        let mut path: Vec<usize> = std::iter::successors(last, |joint| self.joints[*joint].parent).collect();
        path.reverse();
        path
    }

    /// Index of the moving joint of this name.
    pub fn joint_index(&self, name: &str) -> Option<usize> {
        self.joints.iter().position(|joint| joint.name == name)
    }
}

fn mark(link: &str, pose: Pose, carrier: Option<String>, leaf: bool) -> Frame {
    Frame { link: link.to_owned(), pose, carrier, leaf, matter: false }
}

fn word_of(screw: &Screw, continuous: bool) -> &'static str {
    match screw {
        Screw::Revolute(_) if continuous => "continuous",
        Screw::Revolute(_) => "revolute",
        Screw::Prismatic(_) => "prismatic",
        Screw::Helical { .. } => "screw",
    }
}

/// The same axis with the opposite positive direction.
pub(crate) fn reversed(screw: &Screw) -> Screw {
    let flip = |direction: &Unit<Vector3<f64>>| -*direction;
    match screw {
        Screw::Revolute(line) => Screw::Revolute(AxisLine { direction: flip(&line.direction), point: line.point }),
        Screw::Prismatic(direction) => Screw::Prismatic(flip(direction)),
        Screw::Helical { axis, pitch } => {
            Screw::Helical { axis: AxisLine { direction: flip(&axis.direction), point: axis.point }, pitch: *pitch }
        }
    }
}

fn interval_of(joint: &Joint) -> Interval {
    let slides = joint.kind == JointKind::Prismatic;
    let range = joint.limits_in_force().interval();
    let (lower, upper) = range.unwrap_or(if slides { (-1.0, 1.0) } else { (-PI, PI) });
    Interval { name: joint.name.clone(), lower, upper, limited: range.is_some() }
}

/// Where two poses differ: angle (rad) and distance of origins (m).
pub(crate) fn apart(a: &Pose, b: &Pose) -> (f64, f64) {
    se3::difference(a, b)
}
