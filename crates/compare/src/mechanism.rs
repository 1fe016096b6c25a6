//! A robot without its link frames: the basis of comparisons.
//!
//! Links joined by fixed joints are one body. Everything is given in the root frame with every joint value 0: screw
//! axes, shapes, masses, and the link frames only as markers. Body 0 is fixed; joint k carries body k + 1.

mod parts;
mod screws;

pub(crate) use parts::by_path;

use denavit_model::chain::Coordinate;
use denavit_model::nalgebra::{Matrix3, Point3, Vector3};
use denavit_model::placed::PlacedMass;
use denavit_model::robot::{Calibration, Dynamics, Geometry, Joint, SoftLimits};
use denavit_model::se3::{self, Pose};
use denavit_model::{Chain, Limits, PlacedRobot, Robot, Screw, tree::Reading};
use std::collections::HashMap;

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
    /// Reference length for rounding, m.
    pub size: f64,
    /// Whether it came from a table, which has no links and may lack limits.
    pub bare: bool,
    /// Other elements of the source, and parts of links and joints that are not understood, each with the body that it
    /// refers to.
    pub elements: Vec<PlacedElement>,
}

/// An element of the source that is compared value by value.
#[derive(Debug, Clone)]
pub struct PlacedElement {
    /// What it belongs to and what it is, such as `link "foot"/contact` or `transmission "elbow"`.
    pub label: String,
    /// The same without names.
    pub kind: String,
    /// Every value by the path to it, but for those of `parts`; see [`denavit_model::Element::entries`].
    pub entries: Vec<(String, String)>,
    /// Its poses, by path.
    pub parts: Vec<PlacedPart>,
    /// The body of the joint or link that it is about; the root body where it names none.
    pub body: usize,
    /// Byte offset in the source text.
    pub at: usize,
}

/// A pose in an element: of a sensor, of a light, of the point at which a plugin measures.
#[derive(Debug, Clone)]
pub struct PlacedPart {
    /// The path to the pose, or to where it would be.
    pub path: String,
    /// The body that it moves with.
    pub body: usize,
    /// Where it is.
    pub place: PartPlace,
}

/// Where something is, in the root frame with every joint value 0.
#[derive(Debug, Clone)]
pub enum PartPlace {
    /// `root_from_part`.
    Pose(Pose),
    /// m.
    Point(Point3<f64>),
    /// Of length 1.
    Direction(Vector3<f64>),
    /// Relative to the enclosing part of the element.
    Inside(Pose),
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
    /// Whether it comes from limits in the source.
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
    /// Its child link.
    pub child: String,
    /// value = scale · q\[coordinate\] + offset; `None` where it is held at 0 (planar, floating, broken mimic).
    pub drive: Option<Drive>,
    /// As in the source; no range for a continuous joint.
    pub limits: Limits,
    /// The range in the source of a continuous joint, rad.
    pub idle_range: Option<(f64, f64)>,
    /// As the source states it: joint, multiplier, offset.
    pub mimic: Option<(String, f64, f64)>,
    /// Damping and friction.
    pub dynamics: Dynamics,
    /// A controller's limits, where stated.
    pub soft_limits: Option<SoftLimits>,
    /// Where a reference sensor switches, where stated.
    pub calibration: Option<Calibration>,
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
    /// Whether no joint is attached to it.
    pub leaf: bool,
    /// Whether it has a shape or a mass.
    pub matter: bool,
}

/// Which of a link's two lists a shape is in.
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
    fn of(placed: &PlacedRobot, link: usize) -> Option<Self> {
        let PlacedMass { mass, centre, tensor } = placed.mass(link)?;
        let link = placed.robot().links[link].name.clone();
        Some(Self { shares: vec![Share { link, mass, centre, tensor }], mass, centre, tensor })
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

impl Mechanism {
    /// The gauge-free form of a tree.
    ///
    /// Planar and floating joints, joints of unknown kind and mimic joints without a driver are held at 0 when
    /// poses are sampled; what they carry is compared all the same.
    pub fn of_robot(robot: &Robot, reading: Reading) -> Self {
        let placed = PlacedRobot::new(robot, reading);
        let mut result = Self {
            name: robot.name.clone(),
            joints: Vec::new(),
            fixed: Vec::new(),
            bodies: vec![Body::default()],
            coordinates: Vec::new(),
            size: 0.0,
            bare: false,
            elements: Vec::new(),
        };
        let mut moving = vec![None; robot.joints.len()];
        // The body of each link, by the link that carries the body.
        let mut body_of = vec![0; robot.links.len()];
        for link in placed.order() {
            let body = body_of[placed.body(*link)];
            result.add_link(&placed, *link, body);
            for index in placed.carried(*link).iter().rev() {
                let joint = &robot.joints[*index];
                result.size += Vector3::from(joint.origin.xyz).norm();
                if joint.kind.moves() {
                    result.add_joint(&placed, *index, body);
                    moving[*index] = Some(result.joints.len() - 1);
                    body_of[joint.child] = result.joints.len();
                } else {
                    result.fixed.push((joint.name.clone(), robot.links[joint.child].name.clone()));
                }
            }
        }
        result.connect_drives(&placed, &moving);
        result.add_elements(&placed, &body_of);
        result.size = if result.size > 0.0 { result.size } else { 1.0 };
        result
    }

    fn add_link(&mut self, placed: &PlacedRobot, index: usize, body: usize) {
        let link = &placed.robot().links[index];
        let body = &mut self.bodies[body];
        for (role, shapes) in [(Role::Visual, &link.visuals), (Role::Collision, &link.collisions)] {
            body.shapes.extend(shapes.iter().map(|shape| PlacedShape {
                link: link.name.clone(),
                role,
                geometry: shape.geometry.clone(),
                pose: placed.part(index, &shape.origin),
            }));
        }
        if let Some(share) = Mass::of(placed, index) {
            body.mass = Some(match body.mass.take() {
                Some(mass) => mass.joined(share),
                None => share,
            });
        }
        let weighs = link.inertial.as_ref().is_some_and(|inertial| inertial.mass != 0.0);
        let matter = weighs || !link.visuals.is_empty() || !link.collisions.is_empty();
        let leaf = placed.carried(index).is_empty();
        let carrier = placed.carrier(index).map(|joint| placed.robot().joints[joint].name.clone());
        body.frames.push(Frame { link: link.name.clone(), pose: *placed.pose(index), carrier, leaf, matter });
    }

    fn add_joint(&mut self, placed: &PlacedRobot, index: usize, body: usize) {
        let joint = &placed.robot().joints[index];
        self.joints.push(MovingJoint {
            name: joint.name.clone(),
            kind: joint.kind.word().to_owned(),
            screw: placed.screw(index),
            origin: Point3::from(placed.pose(joint.child).translation.vector),
            parent: body.checked_sub(1),
            child: placed.robot().links[joint.child].name.clone(),
            drive: None,
            limits: joint.limits_in_force(),
            idle_range: joint.limits.range.filter(|_| joint.limits_in_force().range.is_none()),
            mimic: joint.mimic.as_ref().map(|mimic| (mimic.joint.clone(), mimic.multiplier, mimic.offset)),
            dynamics: joint.dynamics(),
            soft_limits: joint.soft_limits(),
            calibration: joint.calibration(),
        });
        self.bodies.push(Body::default());
    }

    fn connect_drives(&mut self, placed: &PlacedRobot, moving: &[Option<usize>]) {
        let robot = placed.robot();
        let mut coordinate_of = vec![None; robot.joints.len()];
        for (index, joint) in robot.joints.iter().enumerate() {
            if joint.mimic.is_none() && joint.kind.has_one_value() {
                coordinate_of[index] = Some(self.coordinates.len());
                self.coordinates.push(interval_of(joint));
            }
        }
        for (index, moving) in moving.iter().enumerate() {
            let Some(moving) = moving.filter(|_| robot.joints[index].kind.has_one_value()) else { continue };
            let Ok(drive) = placed.drive(index) else { continue };
            let coordinate = drive.driver.and_then(|driver| coordinate_of[driver]);
            let (scale, offset) = (drive.scale, drive.offset);
            self.joints[moving].drive = coordinate.map(|coordinate| Drive { coordinate, scale, offset });
        }
    }

    /// The gauge-free form of a bare chain: its tip link is an empty leaf after the last joint.
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
                if own && joint.scale < 0.0 { (screw.reversed(), -joint.scale) } else { (screw, joint.scale) };
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
                idle_range: None,
                dynamics: Dynamics::default(),
                soft_limits: None,
                calibration: None,
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
        Self { name, joints, fixed: Vec::new(), bodies, coordinates, size, bare: true, elements: Vec::new() }
    }

    /// Joints from the root to the body that joint `last` carries.
    pub fn path(&self, last: Option<usize>) -> Vec<usize> {
        let mut path: Vec<usize> = std::iter::successors(last, |joint| self.joints[*joint].parent).collect();
        path.reverse();
        path
    }

    /// The joint whose value moves joint `index`, itself where it is free, with factor and offset; `None` where none does.
    pub(crate) fn driver(&self, index: usize, named: &HashMap<&str, usize>) -> Option<(usize, f64, f64)> {
        let Drive { coordinate, scale, offset } = self.joints[index].drive?;
        let driver = named.get(self.coordinates.get(coordinate)?.name.as_str())?;
        Some((*driver, scale, offset))
    }

    /// Where each moving joint is, by name.
    pub fn joint_indices(&self) -> HashMap<&str, usize> {
        self.joints.iter().enumerate().map(|(index, joint)| (joint.name.as_str(), index)).collect()
    }

    /// For each body the joints attached to it.
    pub fn joints_on(&self) -> Vec<Vec<usize>> {
        let mut on = vec![Vec::new(); self.bodies.len()];
        for (index, joint) in self.joints.iter().enumerate() {
            on[joint.parent.map_or(0, |parent| parent + 1)].push(index);
        }
        on
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

fn interval_of(joint: &Joint) -> Interval {
    let limits = joint.limits_in_force();
    let coordinate = Coordinate { limits, ..Coordinate::unlimited(joint.name.clone(), joint.kind.quantity()) };
    let (lower, upper) = coordinate.range();
    Interval { name: coordinate.name, lower, upper, limited: limits.range.is_some() }
}

/// Where two poses differ: angle (rad) and distance of origins (m).
pub(crate) fn apart(a: &Pose, b: &Pose) -> (f64, f64) {
    se3::difference(a, b)
}
