//! Joints as bodies: a cylinder turns, a block slides, a threaded cylinder does both.

use denavit_dh::Motion;
use denavit_model::nalgebra::{Point3, Unit, Vector3};
use denavit_model::se3::{Pose, rotation_about};

const CORNERS: usize = 36;

/// A convex body: its faces as polygons with outward normals, and lines drawn on it.
pub(crate) struct Solid {
    pub middle: Point3<f64>,
    pub faces: Vec<Face>,
    pub thread: Vec<Point3<f64>>,
    pub class: &'static str,
}

/// A flat face.
pub(crate) struct Face {
    pub corners: Vec<Point3<f64>>,
    pub normal: Vector3<f64>,
    /// Side faces of a cylinder have no edges.
    pub outlined: bool,
}

impl Solid {
    /// The body of a joint whose axis is z of `frame`, at the frame's origin; `pixel`: m per px.
    pub fn joint(motion: Motion, frame: &Pose, pixel: f64) -> Self {
        let middle = Point3::from(frame.translation.vector);
        let axis = |k: usize| frame.rotation.matrix().column(k).into_owned();
        match motion {
            Motion::Revolute => Self::cylinder(middle, axis(2), 10.0 * pixel, 13.0 * pixel),
            Motion::Prismatic => Self::block(middle, [axis(0) * 9.0, axis(1) * 9.0, axis(2) * 15.0].map(|v| v * pixel)),
            Motion::Helical(_) => {
                let (radius, half) = (10.0 * pixel, 16.0 * pixel);
                let mut body = Self::cylinder(middle, axis(2), radius, half);
                let about = Unit::new_normalize(axis(2));
                let turns = 3.0;
                body.thread = (0..=72)
                    .map(|k| {
                        let part = f64::from(k) / 72.0;
                        let around = rotation_about(&about, part * turns * std::f64::consts::TAU) * (axis(0) * radius);
                        middle + axis(2) * (half * (2.0 * part - 1.0)) + around
                    })
                    .collect();
                body
            }
        }
    }

    /// The ground under the base frame.
    pub fn disc(middle: Point3<f64>, normal: Vector3<f64>, radius: f64) -> Self {
        let mut disc = Self::cylinder(middle - normal * (0.14 * radius), normal, radius, 0.1 * radius);
        disc.class = "ground";
        disc
    }

    fn cylinder(middle: Point3<f64>, axis: Vector3<f64>, radius: f64, half: f64) -> Self {
        let about = Unit::new_normalize(axis);
        let least = about.iamin();
        let across = about.cross(&Vector3::ith(least, 1.0)).normalize();
        let rim: Vec<Vector3<f64>> = (0..CORNERS)
            .map(|k| rotation_about(&about, k as f64 * std::f64::consts::TAU / CORNERS as f64) * across * radius)
            .collect();
        let cap = |side: f64| Face {
            corners: rim.iter().map(|spoke| middle + about.as_ref() * (half * side) + spoke).collect(),
            normal: about.as_ref() * side,
            outlined: true,
        };
        let mut faces = vec![cap(1.0), cap(-1.0)];
        for k in 0..CORNERS {
            let (one, other) = (rim[k], rim[(k + 1) % CORNERS]);
            let end = about.as_ref() * half;
            let corners = vec![middle + one - end, middle + other - end, middle + other + end, middle + one + end];
            faces.push(Face { corners, normal: (one + other).normalize(), outlined: false });
        }
        Self { middle, faces, thread: Vec::new(), class: "joint" }
    }

    fn block(middle: Point3<f64>, half: [Vector3<f64>; 3]) -> Self {
        let mut faces = Vec::new();
        for k in 0..3 {
            let (normal, one, other) = (half[k], half[(k + 1) % 3], half[(k + 2) % 3]);
            for side in [1.0, -1.0] {
                let face = middle + normal * side;
                let corners = vec![face + one + other, face + one - other, face - one - other, face - one + other];
                faces.push(Face { corners, normal: normal.normalize() * side, outlined: true });
            }
        }
        Self { middle, faces, thread: Vec::new(), class: "joint" }
    }
}
