//! Features that determine the pose of a body: joint axes on it, shapes, centre of mass, empty leaf frames.

use crate::diff::Options;
use crate::diff::alignment::{Alignment, TIGHT};
use crate::mechanism::{Mass, Mechanism, PlacedShape, apart};
use denavit_model::Screw;
use denavit_model::nalgebra::{Point3, Vector3};
use denavit_model::robot::Geometry;
use denavit_model::se3::{self, Pose};

/// One of them, by index.
#[derive(Debug, Clone, Copy)]
enum Feature {
    /// The axis of a joint of a attached to the body.
    Axis(usize),
    /// A shape of the body.
    Shape(usize),
    /// The centre of mass.
    Centre,
    /// A frame of the body that has no content but its pose.
    Tip(usize),
}

/// The features of every body of a, and the tree of bodies.
pub(crate) struct Features {
    precision: Precision,
    of_body: Vec<Vec<Feature>>,
    /// For each body those attached to it directly.
    next: Vec<Vec<usize>>,
}

/// How well features must agree to locate a body.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Precision {
    /// To rounding: for robots that differ only by a few edits.
    Rounding,
    /// Within the tolerances: for robots that were written down independently.
    Tolerance,
}

/// Number of descendants used to locate a body; the far end of a longer arm adds nothing.
const BEHIND: usize = 256;
/// Number of shapes used to locate a body; enough for a robot made of hundreds of spheres.
const SHAPES: usize = 8;

impl Features {
    pub fn of(a: &Mechanism, precision: Precision) -> Self {
        let mut of_body: Vec<Vec<Feature>> = Vec::new();
        for body in &a.bodies {
            let mut features: Vec<Feature> = (0..body.shapes.len().min(SHAPES)).map(Feature::Shape).collect();
            features.extend(body.mass.as_ref().filter(|mass| mass.mass != 0.0).map(|_| Feature::Centre));
            let empty = body.frames.iter().enumerate().filter(|(_, frame)| frame.leaf && !frame.matter);
            features.extend(empty.map(|(index, _)| Feature::Tip(index)));
            of_body.push(features);
        }
        let mut next = vec![Vec::new(); a.bodies.len()];
        for (index, joint) in a.joints.iter().enumerate() {
            let carrier = joint.parent.map_or(0, |parent| parent + 1);
            of_body[carrier].push(Feature::Axis(index));
            next[carrier].push(index + 1);
        }
        Self { precision, of_body, next }
    }

    /// The share of all features that agree to rounding where the bodies were found to be.
    pub fn agreeing(&self, at: &Alignment, a: &Mechanism, b: &Mechanism, options: &Options) -> f64 {
        let all =
            || self.of_body.iter().enumerate().flat_map(|(body, own)| own.iter().map(move |feature| (body, *feature)));
        let exact = all()
            .filter(|(body, feature)| self.agreement(at, a, b, (*body, *feature), &at.moved[*body], options) > 0.5);
        exact.count() as f64 / all().count().max(1) as f64
    }

    /// A body and its descendants, the nearest first, as many as are used.
    fn behind(&self, body: usize) -> Vec<usize> {
        let mut result = vec![body];
        let mut at = 0;
        while at < result.len() && result.len() < BEHIND {
            result.extend(&self.next[result[at]]);
            at += 1;
        }
        result.truncate(BEHIND);
        // In the order of the joints, so that sums do not depend on the search order.
        result.sort_unstable();
        result
    }

    /// How many features of a body and its descendants a motion takes to those of b; those that agree to
    /// rounding count a little more than those that agree within tolerance.
    pub fn score(
        &self,
        at: &Alignment,
        a: &Mechanism,
        b: &Mechanism,
        body: usize,
        moved: &Pose,
        options: &Options,
    ) -> f64 {
        let of_body = |body: &usize| -> f64 {
            self.of_body[*body].iter().map(|feature| self.agreement(at, a, b, (*body, *feature), moved, options)).sum()
        };
        self.behind(body).iter().map(of_body).sum()
    }

    /// 1 to rounding, 0.9 within tolerance, otherwise 0; a little less for an axis of reversed sense.
    fn agreement(
        &self,
        at: &Alignment,
        a: &Mechanism,
        b: &Mechanism,
        (body, feature): (usize, Feature),
        moved: &Pose,
        options: &Options,
    ) -> f64 {
        let (in_a, in_b) = (&a.bodies[body], &b.bodies[at.body_b[body]]);
        let (turned, distance, weight) = match feature {
            Feature::Axis(joint) => {
                let Some(other) = at.joint_b[joint] else { return 0.0 };
                let (one, other) = (&a.joints[joint], &b.joints[other]);
                let (Some(screw), Some(screw_b)) = (&one.screw, &other.screw) else { return 0.0 };
                let (turned, distance, reversed) =
                    axes_apart(&screw.moved(moved), &(moved * one.origin), screw_b, &other.origin);
                (turned, distance, if reversed { 0.98 } else { 1.0 })
            }
            Feature::Shape(index) => {
                let shape = &in_a.shapes[index];
                let placed = moved * shape.pose;
                let alike = in_b.shapes.iter().filter(|other| alike(shape, other, options));
                let nearest = alike
                    .map(|other| shape_apart(&shape.geometry, &placed, &other.pose))
                    .min_by(|x, y| (x.0 * a.size + x.1).total_cmp(&(y.0 * a.size + y.1)));
                let Some((turned, distance)) = nearest else { return 0.0 };
                (turned, distance, 1.0)
            }
            Feature::Centre => {
                let (Some(one), Some(other)) = (&in_a.mass, &in_b.mass) else { return 0.0 };
                let turned = if same_tensor(one, other, moved, options.tolerance_mass) { 1.0 } else { 0.6 };
                (0.0, (moved * one.centre - other.centre).norm(), turned)
            }
            Feature::Tip(index) => {
                let frame = &in_a.frames[index];
                let mut leaves = in_b.frames.iter().filter(|other| other.leaf);
                let other = leaves.clone().find(|other| other.link == frame.link).or_else(|| leaves.next());
                let Some(other) = other else { return 0.0 };
                let (turned, distance) = apart(&(moved * frame.pose), &other.pose);
                (turned, distance, 1.0)
            }
        };
        if turned < TIGHT && distance < TIGHT * a.size {
            weight
        } else if self.precision == Precision::Tolerance
            && turned < options.tolerance_rad
            && distance < options.tolerance_m
        {
            0.9 * weight
        } else {
            0.0
        }
    }
}

/// How far two axes are apart: angle (rad), distance of the lines near the joints (m), whether they point oppositely.
pub(crate) fn axes_apart(one: &Screw, at: &Point3<f64>, other: &Screw, at_other: &Point3<f64>) -> (f64, f64, bool) {
    let (u, w) = (one.direction().into_inner(), other.direction().into_inner());
    let reversed = u.dot(&w) < 0.0;
    let turned = se3::angle_between(&u, &if reversed { -w } else { w });
    let distance = match (one.line(), other.line()) {
        (Some(line), Some(line_b)) => {
            let (start, end) = (line.nearest_to(at), line_b.nearest_to(at_other));
            (line_b.nearest_to(&start) - start).norm().min((line.nearest_to(&end) - end).norm())
        }
        _ => 0.0,
    };
    (turned, distance, reversed)
}

/// Whether two shapes can correspond to each other.
pub(crate) fn alike(one: &PlacedShape, other: &PlacedShape, options: &Options) -> bool {
    one.role == other.role && same_size(&one.geometry, &other.geometry, options.tolerance_m)
}

/// Whether two shapes are of one kind and, within the tolerance (m; for scales of meshes relative), of one size.
pub(crate) fn same_size(one: &Geometry, other: &Geometry, tolerance_m: f64) -> bool {
    let near = |x: f64, y: f64| (x - y).abs() <= tolerance_m;
    match (one, other) {
        (Geometry::Box(a), Geometry::Box(b)) => a.iter().zip(b).all(|(x, y)| near(*x, *y)),
        (Geometry::Sphere(a), Geometry::Sphere(b)) => near(*a, *b),
        (Geometry::Cylinder { radius, length }, Geometry::Cylinder { radius: r, length: l })
        | (Geometry::Capsule { radius, length }, Geometry::Capsule { radius: r, length: l }) => {
            near(*radius, *r) && near(*length, *l)
        }
        (Geometry::Mesh { filename, scale }, Geometry::Mesh { filename: file, scale: factors }) => {
            let same = |x: f64, y: f64| (x - y).abs() <= tolerance_m * x.abs();
            filename == file && scale.iter().zip(factors).all(|(x, y)| same(*x, *y))
        }
        _ => one == other,
    }
}

/// How far two poses of one shape are apart, its symmetry taken into account: rad and m.
pub(crate) fn shape_apart(geometry: &Geometry, one: &Pose, other: &Pose) -> (f64, f64) {
    let (turned, distance) = apart(one, other);
    match geometry {
        Geometry::Sphere(_) => (0.0, distance),
        Geometry::Cylinder { .. } | Geometry::Capsule { .. } => {
            let (u, w) = (one.rotation * Vector3::z(), other.rotation * Vector3::z());
            (se3::angle_between(&u, &w).min(se3::angle_between(&-u, &w)), distance)
        }
        _ => (turned, distance),
    }
}

/// Whether the tensors agree once a's is turned with the body; relative to the larger.
pub(crate) fn same_tensor(one: &Mass, other: &Mass, moved: &Pose, tolerance: f64) -> bool {
    let r = moved.rotation.matrix();
    let turned = r * one.tensor * r.transpose();
    // A tensor is as precise as what a link of this mass and lever would have: parallel axes cancel.
    let scale = turned.norm().max(other.tensor.norm());
    (turned - other.tensor).norm() <= tolerance * scale
}
