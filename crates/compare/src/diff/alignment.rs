//! Pairs the joints of two robots, and finds the pose of each body of b relative to the same body of a.
//!
//! For every body one rigid motion takes a's body (root frame, zero) to b's. It is the motion that makes most
//! features of the body and its descendants - axes, shapes, centres of mass, empty tips - coincide with those of b.
//! An edit at one joint moves all its descendants rigidly, so the motion changes only at that joint.

use crate::diff::Options;
use crate::diff::features::{Features, Precision, alike};
use crate::mechanism::{Mechanism, apart};
use denavit_model::Screw;
use denavit_model::nalgebra::{Matrix3, Point3, Rotation3, Vector3};
use denavit_model::se3::{self, Pose};

/// The joints of b that correspond to those of a, and the motions from a's bodies to b's.
pub(crate) struct Alignment {
    /// For each joint of a.
    pub joint_b: Vec<Option<usize>>,
    /// For each joint of b.
    pub joint_a: Vec<Option<usize>>,
    /// For each body of a: b_from_a.
    pub moved: Vec<Pose>,
    /// For each body of a, the corresponding body of b.
    pub body_b: Vec<usize>,
}

/// Bonus for a body of a that stays where its carrier puts it.
const UNMOVED: f64 = 1.0;
/// The bonus with free zeros, which is small.
const UNMOVED_FREE: f64 = 0.3;
/// Link frames are only a hint: they may be moved at will.
const FRAMES: f64 = 0.25;
/// If this share of all features agrees to rounding, one robot comes from the other by a few edits.
const MOSTLY: f64 = 0.5;
/// Joints on one body that match no name are paired by their axes, at most this many, because all pairs are compared.
const PAIRED: usize = 100;
/// Frames of a body that are compared with those of b, at most.
const FRAMES_HELD: usize = 100;
/// Number of frames and shapes of a body whose motion is tried for the body.
const TRIED: usize = 6;

impl Alignment {
    /// Pairs the joints and finds each body's motion; that of the root body is given.
    pub fn new(a: &Mechanism, b: &Mechanism, root: Pose, options: &Options) -> Self {
        let features = Features::of(a, Precision::Rounding);
        let exact = Self::by(a, b, &features, root, options);
        if features.agreeing(&exact, a, b, options) >= MOSTLY {
            return exact;
        }
        Self::by(a, b, &Features::of(a, Precision::Tolerance), root, options)
    }

    fn by(a: &Mechanism, b: &Mechanism, features: &Features, root: Pose, options: &Options) -> Self {
        let mut result = Self {
            joint_b: vec![None; a.joints.len()],
            joint_a: vec![None; b.joints.len()],
            moved: vec![root; a.bodies.len()],
            body_b: vec![0; a.bodies.len()],
        };
        let named = b.joint_indices();
        for (index, joint) in a.joints.iter().enumerate() {
            if let Some(other) = named.get(joint.name.as_str()) {
                result.pair(index, *other);
            }
        }
        let on = (a.joints_on(), b.joints_on());
        result.pair_children(a, b, &on, None, options);
        for index in 0..a.joints.len() {
            let (body, carrier) = (index + 1, a.joints[index].parent.map_or(0, |parent| parent + 1));
            match result.joint_b[index] {
                None => {
                    result.moved[body] = result.moved[carrier];
                    result.body_b[body] = result.body_b[carrier];
                }
                Some(other) => {
                    result.body_b[body] = other + 1;
                    result.moved[body] = result.motion_of(a, b, features, &on.0, index, options);
                }
            }
            result.pair_children(a, b, &on, Some(index), options);
        }
        result
    }

    fn pair(&mut self, in_a: usize, in_b: usize) {
        self.joint_b[in_a] = Some(in_b);
        self.joint_a[in_b] = Some(in_a);
        self.body_b[in_a + 1] = in_b + 1;
    }

    /// Pairs joints attached to the same body under different names: the nearest axes first.
    fn pair_children(
        &mut self,
        a: &Mechanism,
        b: &Mechanism,
        on: &(Vec<Vec<usize>>, Vec<Vec<usize>>),
        parent: Option<usize>,
        options: &Options,
    ) {
        let parent_b = match parent {
            None => None,
            Some(parent) => match self.joint_b[parent] {
                Some(other) => Some(other),
                None => return,
            },
        };
        let free = |on: &[Vec<usize>], paired: &[Option<usize>], parent: Option<usize>| -> Vec<usize> {
            let hanging = &on[parent.map_or(0, |parent| parent + 1)];
            hanging.iter().copied().filter(|joint| paired[*joint].is_none()).collect()
        };
        let mut in_a = free(&on.0, &self.joint_b, parent);
        let mut in_b = free(&on.1, &self.joint_a, parent_b);
        in_a.truncate(PAIRED);
        in_b.truncate(PAIRED);
        let moved = self.moved[parent.map_or(0, |parent| parent + 1)];
        while let Some((cost, one, other)) = in_a
            .iter()
            .flat_map(|one| in_b.iter().map(move |other| (*one, *other)))
            .map(|(one, other)| (unlikeness(a, b, one, other, &moved), one, other))
            .min_by(|x, y| x.0.total_cmp(&y.0))
        {
            let only = in_a.len() == 1 && in_b.len() == 1;
            let same = cost <= options.tolerance_m.max(options.tolerance_rad) * (1.0 + a.size);
            if !cost.is_finite() || !(only || same || a.joints[one].child == b.joints[other].child) {
                break;
            }
            self.pair(one, other);
            in_a.retain(|k| *k != one);
            in_b.retain(|k| *k != other);
        }
    }

    fn motion_of(
        &self,
        a: &Mechanism,
        b: &Mechanism,
        features: &Features,
        on: &[Vec<usize>],
        joint: usize,
        options: &Options,
    ) -> Pose {
        let body = joint + 1;
        let carried = self.moved[a.joints[joint].parent.map_or(0, |parent| parent + 1)];
        let mut candidates = vec![carried];
        for candidate in self.candidates(a, b, on, (body, &carried), options) {
            let new = candidates.iter().all(|known| {
                let (turned, moved) = apart(known, &candidate);
                turned > TIGHT || moved > TIGHT * a.size
            });
            if new && candidates.len() <= 4 * TRIED {
                candidates.push(candidate);
            }
        }
        if candidates.len() == 1 {
            return carried;
        }
        let unmoved = if options.up_to_zeros { UNMOVED_FREE } else { UNMOVED };
        let mut best = (f64::NEG_INFINITY, carried);
        for (index, candidate) in candidates.iter().enumerate() {
            let bonus = if index == 0 { unmoved } else { 0.0 };
            let score = bonus
                + features.score(self, a, b, body, candidate, options)
                + FRAMES * self.frames_on(a, b, body, candidate);
            if score > best.0 + 1e-9 {
                best = (score, *candidate);
            }
        }
        best.1
    }

    /// Motions that something of this body made between a and b.
    ///
    /// `on`: the joints of a that are attached to each body.
    pub fn candidates(
        &self,
        a: &Mechanism,
        b: &Mechanism,
        on: &[Vec<usize>],
        (body, carried): (usize, &Pose),
        options: &Options,
    ) -> Vec<Pose> {
        let (in_a, in_b) = (&a.bodies[body], &b.bodies[self.body_b[body]]);
        let mut result = Vec::new();
        let named = in_a.frames.iter().filter_map(|frame| {
            let other = in_b.frames.iter().find(|other| other.link == frame.link)?;
            Some(other.pose * frame.pose.inverse())
        });
        result.extend(named.take(TRIED));
        if let ([.., one], [.., other]) = (&in_a.frames[..], &in_b.frames[..])
            && one.leaf
            && other.leaf
        {
            result.push(other.pose * one.pose.inverse());
        }
        let shapes = in_a.shapes.iter().flat_map(|shape| {
            in_b.shapes
                .iter()
                .filter(|other| alike(shape, other, options))
                .map(|other| other.pose * shape.pose.inverse())
                .take(2)
        });
        result.extend(shapes.take(TRIED));
        let Some((joint, other)) = body.checked_sub(1).and_then(|joint| Some((joint, self.joint_b[joint]?))) else {
            return result;
        };
        let (Some(one), Some(two)) = (a.joints[joint].screw, b.joints[other].screw) else { return result };
        result.extend(self.axis_pairs(a, b, &on[body], (joint, &one, &two), carried));
        let origins = (a.joints[joint].origin, b.joints[other].origin);
        result.push(least_motion(&one.moved(carried), &(carried * origins.0), &two) * carried);
        result
    }

    /// Motions that take a's axis and a following one to b's.
    fn axis_pairs(
        &self,
        a: &Mechanism,
        b: &Mechanism,
        behind: &[usize],
        (joint, in_a, in_b): (usize, &Screw, &Screw),
        carried: &Pose,
    ) -> Vec<Pose> {
        let axes = (in_a, in_b);
        let mut result = Vec::new();
        for child in behind.iter().copied().take(2) {
            let Some(other) = self.joint_b[child] else { continue };
            let (Some(one), Some(two)) = (a.joints[child].screw, b.joints[other].screw) else { continue };
            let near = a.joints[joint].origin;
            let frame_a = pair_frame(axes.0, &one, &near, 1.0);
            let sense = if (carried.rotation * axes.0.direction().as_ref()).dot(&axes.1.direction()) < 0.0 {
                -1.0
            } else {
                1.0
            };
            let frame_b = pair_frame(axes.1, &two, &(carried * near), sense);
            if let (Some(frame_a), Some(frame_b)) = (frame_a, frame_b) {
                let half_turn = se3::pose(se3::rotation_about(&Vector3::z(), std::f64::consts::PI), Vector3::zeros());
                result.push(frame_b * frame_a.inverse());
                result.push(frame_b * half_turn * frame_a.inverse());
            }
        }
        result
    }

    /// The share of the body's named frames that the motion takes to where b has them.
    fn frames_on(&self, a: &Mechanism, b: &Mechanism, body: usize, moved: &Pose) -> f64 {
        let in_b = &b.bodies[self.body_b[body]].frames;
        let on = |frame: &&crate::mechanism::Frame| {
            in_b.iter().filter(|other| other.link == frame.link).any(|other| {
                let (turned, distance) = apart(&other.pose, &(moved * frame.pose));
                turned < TIGHT * 10.0 && distance < TIGHT * 10.0 * a.size
            })
        };
        let frames = &a.bodies[body].frames;
        let frames = &frames[..frames.len().min(FRAMES_HELD)];
        frames.iter().filter(on).count() as f64 / frames.len().max(1) as f64
    }
}

/// Candidate motions of the base: those of the root body's frames and shapes, and those that take the first two axes
/// of a branch to those of b.
pub(crate) fn bases(a: &Mechanism, b: &Mechanism, named: &Alignment, options: &Options) -> Vec<Pose> {
    let on = a.joints_on();
    let mut result = named.candidates(a, b, &on, (0, &Pose::identity()), options);
    for joint in on[0].iter().copied().take(2) {
        let Some(other) = named.joint_b[joint] else { continue };
        let (Some(one), Some(two)) = (a.joints[joint].screw, b.joints[other].screw) else { continue };
        let mut pairs = named.axis_pairs(a, b, &on[joint + 1], (joint, &one, &two), &Pose::identity());
        pairs.push(least_motion(&one, &a.joints[joint].origin, &two));
        result.extend(pairs.iter().filter_map(|base| slid_to_tip(a, b, base, &two)));
        result.extend(pairs);
    }
    result
}

/// If all axes are parallel, only the tips determine the position of the base along them.
fn slid_to_tip(a: &Mechanism, b: &Mechanism, base: &Pose, first: &Screw) -> Option<Pose> {
    let tip = |mechanism: &Mechanism| mechanism.bodies.last()?.frames.last().map(|frame| frame.pose.translation.vector);
    let u = first.direction().into_inner();
    let apart = tip(b)? - (base * Point3::from(tip(a)?)).coords;
    Some(se3::translation(u * u.dot(&apart)) * base)
}

/// Rounding: relative to the robot's size for lengths, rad for angles. Values that agree better than this agree exactly.
pub(crate) const TIGHT: f64 = 1e-10;

/// Distance of two joints: infinite if their kinds are incompatible.
fn unlikeness(a: &Mechanism, b: &Mechanism, one: usize, other: usize, moved: &Pose) -> f64 {
    let (one, other) = (&a.joints[one], &b.joints[other]);
    let (Some(in_a), Some(in_b)) = (&one.screw, &other.screw) else {
        return if one.kind == other.kind { 0.0 } else { f64::INFINITY };
    };
    if in_a.line().is_some() != in_b.line().is_some() {
        return f64::INFINITY;
    }
    let in_a = in_a.moved(moved);
    let (u, w) = (in_a.direction(), in_b.direction());
    let turned = se3::angle_between(&u, &w).min(se3::angle_between(&-u.into_inner(), &w));
    let distance = match (in_a.line(), in_b.line()) {
        (Some(_), Some(line)) => {
            let point = moved * one.origin;
            (line.nearest_to(&point) - point).norm()
        }
        _ => 0.0,
    };
    turned + distance
}

/// A frame on axis `one`: z along it, x along the common normal to `two`, origin where that starts.
///
/// `None` if both lie on one line, or if one of the joints is prismatic and both are parallel.
fn pair_frame(one: &Screw, two: &Screw, near: &Point3<f64>, sense: f64) -> Option<Pose> {
    let z = one.direction().into_inner() * sense;
    let w = two.direction().into_inner();
    let across = z.cross(&w);
    let parallel = across.norm() < 1e-6;
    let (origin, x) = match (one.line(), two.line()) {
        (Some(line), Some(other)) => {
            let start = line.nearest_to(near);
            let between = other.point - start;
            if parallel {
                let normal = between - z * between.dot(&z);
                (start, normal.try_normalize(1e-9)?)
            } else {
                // Where the line comes nearest to the other: solved for the parameter along it.
                let along = w.cross(&across).dot(&between) / across.norm_squared();
                (start + z * along, across.normalize())
            }
        }
        _ if parallel => return None,
        (line, _) => (line.map_or(*near, |line| line.nearest_to(near)), across.normalize()),
    };
    let y = z.cross(&x);
    let rotation = Rotation3::from_matrix_unchecked(Matrix3::from_columns(&[x, y, z]));
    Some(se3::pose(rotation, origin.coords))
}

/// The smallest motion that takes one axis to another: a turn about the point `at` of it, then a move across it.
pub(crate) fn least_motion(one: &Screw, at: &Point3<f64>, other: &Screw) -> Pose {
    let (u, mut w) = (one.direction().into_inner(), other.direction().into_inner());
    if u.dot(&w) < 0.0 {
        w = -w;
    }
    let turn = se3::least_rotation(&u, &w);
    let start = one.line().map_or(*at, |line| line.nearest_to(at));
    let end = other.line().map_or(start, |line| line.nearest_to(&start));
    se3::pose(turn, end.coords - turn * start.coords)
}
