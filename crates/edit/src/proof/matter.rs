//! Checks masses, tensors and shapes: each is in place, or in the link that it was merged into.

use super::Pair;
use crate::claim::{Masses, Shapes, Space};
use crate::solids;
use denavit_model::nalgebra::{Matrix3, Point3, Vector3};
use denavit_model::robot::{Geometry, Link, Shape};
use denavit_model::se3::{self, Pose};

/// Allowed displacement of shapes and centres, relative to the robot's size and in rad.
const SAME: f64 = 1e-11;

/// Masses and tensors may differ by this, relative.
const SAME_MASS: f64 = 1e-9;

/// Mass about the origin of a link's frame.
#[derive(Clone, Copy)]
struct Mass {
    /// kg
    total: f64,
    /// kg·m
    moment: Vector3<f64>,
    /// About the frame's origin, kg·m².
    tensor: Matrix3<f64>,
}

const NOTHING: Mass = Mass {
    total: 0.0,
    moment: Vector3::new(0.0, 0.0, 0.0),
    tensor: Matrix3::new(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0),
};

impl Mass {
    /// Of a link, in a frame that `offset` leads to.
    fn of(link: &Link, offset: &Pose, space: &Space) -> Self {
        let Some(inertial) = &link.inertial else { return NOTHING };
        let pose = offset * space.pose(&inertial.origin.pose());
        let mut tensor = inertial.tensor * space.scale.powi(2);
        if let Some(index) = space.mirrored {
            for other in (0..3).filter(|other| *other != index) {
                tensor[(index, other)] = -tensor[(index, other)];
                tensor[(other, index)] = -tensor[(other, index)];
            }
        }
        let rotation = pose.rotation.matrix();
        let centre = pose.translation.vector;
        let central = rotation * tensor * rotation.transpose();
        let parallel = Matrix3::identity() * centre.norm_squared() - centre * centre.transpose();
        Self { total: inertial.mass, moment: centre * inertial.mass, tensor: central + parallel * inertial.mass }
    }

    fn plus(self, other: Self) -> Self {
        Self { total: self.total + other.total, moment: self.moment + other.moment, tensor: self.tensor + other.tensor }
    }

    fn is_like(&self, other: &Self) -> bool {
        let near = |difference: f64, size: f64| difference <= SAME_MASS * size + f64::MIN_POSITIVE;
        near((self.total - other.total).abs(), self.total.abs())
            && near((self.moment - other.moment).norm(), self.moment.norm() + self.total.abs())
            && near((self.tensor - other.tensor).norm(), self.tensor.norm() + self.moment.norm() + self.total.abs())
    }
}

/// # Errors
/// What is missing, new or elsewhere.
pub(super) fn check(pair: &Pair) -> Result<(), String> {
    let size = super::motion::size(pair.before) * pair.claim.space.scale.max(1.0);
    for (index, link) in pair.after.links.iter().enumerate() {
        let came: Vec<(&Link, &Pose)> = pair
            .places
            .iter()
            .zip(&pair.before.links)
            .filter_map(|(place, from)| {
                let (at, kept) = (*place)?;
                match &kept.matter {
                    Some((name, offset)) => (*name == link.name).then_some((from, offset)),
                    None => (at == index).then_some((from, &kept.offset)),
                }
            })
            .collect();
        let known = pair.places.iter().flatten().any(|(at, _)| *at == index);
        if !known && pair.claim.foreign {
            continue;
        }
        let space = &pair.claim.space;
        if pair.claim.masses == Masses::Kept {
            let sum = came.iter().fold(NOTHING, |sum, (from, offset)| sum.plus(Mass::of(from, offset, space)));
            if !sum.is_like(&Mass::of(link, &Pose::identity(), &Space::SAME)) {
                return Err(format!("the mass of link \"{}\" would change", link.name));
            }
        }
        let of = |shapes: fn(&Link) -> &Vec<Shape>| -> Vec<(Pose, &Shape)> {
            let placed = came.iter().flat_map(|(from, offset)| {
                shapes(from).iter().map(move |shape| (*offset * space.pose(&shape.origin.pose()), shape))
            });
            placed.collect()
        };
        if !alike(pair, &of(|link| &link.visuals), &link.visuals, size) {
            return Err(format!("a visual of link \"{}\" would be lost or moved", link.name));
        }
        let collisions_stay = pair.claim.shapes != Shapes::CollisionsChange;
        if collisions_stay && !alike(pair, &of(|link| &link.collisions), &link.collisions, size) {
            return Err(format!("a collision shape of link \"{}\" would be lost or moved", link.name));
        }
        if !collisions_stay {
            only_enclosing_ones_differ(pair, &of(|link| &link.collisions), link, size)?;
        }
    }
    Ok(())
}

/// Collision shapes are unchanged, one by one, except those that enclose the shape that they replace.
fn only_enclosing_ones_differ(pair: &Pair, came: &[(Pose, &Shape)], link: &Link, size: f64) -> Result<(), String> {
    if came.len() != link.collisions.len() {
        return Err(format!("a collision shape of link \"{}\" would be lost", link.name));
    }
    for (index, (before, after)) in came.iter().zip(&link.collisions).enumerate() {
        let enclosed = pair.claim.enclosed.iter().find(|of| of.link == link.name && of.index == index);
        let Some(enclosed) = enclosed else {
            if !alike(pair, std::slice::from_ref(before), std::slice::from_ref(after), size) {
                return Err(format!("a collision shape of link \"{}\" would be moved", link.name));
            }
            continue;
        };
        let back = after.origin.pose().inverse();
        let far = enclosed.points.iter().map(|point| point.coords.amax()).fold(0.0, f64::max);
        let planes = match (&after.geometry, &enclosed.hull) {
            (Geometry::Mesh { scale, .. }, Some(hull)) => {
                solids::planes(hull, *scale, far.max(back.translation.vector.amax()))
            }
            _ => Vec::new(),
        };
        let outside = |point: &&Point3<f64>| !solids::holds(&after.geometry, &planes, &(back * **point).coords);
        if let Some(point) = enclosed.points.iter().find(outside) {
            let name = &link.name;
            return Err(format!(
                "a vertex of a mesh of link \"{name}\" would be outside its new shape, at {:?}",
                point.coords
            ));
        }
    }
    Ok(())
}

/// Whether both are the same shapes in the same places, in any order.
fn alike(pair: &Pair, came: &[(Pose, &Shape)], found: &[Shape], size: f64) -> bool {
    let mut left: Vec<&Shape> = found.iter().collect();
    for (pose, shape) in came {
        let same = left.iter().position(|other| {
            let other_pose = other.origin.pose();
            let (turned, moved) = se3::difference(pose, &other_pose);
            let length = size + pose.translation.vector.norm();
            let turned = turned <= SAME || pair.claim.shapes == Shapes::Turned;
            turned && moved <= SAME * length && same_geometry(pair, &shape.geometry, &other.geometry)
        });
        let Some(same) = same else { return false };
        left.remove(same);
    }
    left.is_empty()
}

fn same_geometry(pair: &Pair, old: &Geometry, new: &Geometry) -> bool {
    let factor = pair.claim.space.scale;
    let near = |a: f64, b: f64| (a * factor - b).abs() <= 1e-12 * b.abs();
    match (old, new) {
        (Geometry::Box(a), Geometry::Box(b)) => a.iter().zip(b).all(|(a, b)| near(*a, *b)),
        (Geometry::Sphere(a), Geometry::Sphere(b)) => near(*a, *b),
        (Geometry::Cylinder { radius: a, length: c }, Geometry::Cylinder { radius: b, length: d })
        | (Geometry::Capsule { radius: a, length: c }, Geometry::Capsule { radius: b, length: d }) => {
            near(*a, *b) && near(*c, *d)
        }
        (Geometry::Mesh { filename: a, scale: c }, Geometry::Mesh { filename: b, scale: d }) => {
            let names = pair.claim.files.get(a.trim()).unwrap_or(a) == b;
            let sign = |index: usize| if pair.claim.space.mirrored == Some(index) { -1.0 } else { 1.0 };
            names && (0..3).all(|index| near(c[index] * sign(index), d[index]))
        }
        (old, new) => old == new,
    }
}
