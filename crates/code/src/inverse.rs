//! Inverse kinematics in closed form: which arms have one, and the constants of the code.

use denavit_model::nalgebra::{Unit, Vector3};
use denavit_model::{Chain, Pose, Screw};

/// Axes count as parallel, and as meeting, within this, rad or share of the arm's size: the written code is exact, so a
/// calibrated arm has no closed form.
const EXACT: f64 = 1e-9;
/// Axes that enclose a smaller angle, rad, leave a subproblem without a solution.
const APART: f64 = 1e-3;

/// Which closed form.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Class {
    /// Axes 2 and 3 are parallel, axes 4, 5 and 6 meet in a point.
    SphericalWrist,
    /// Axes 2, 3 and 4 are parallel, axes 5 and 6 meet in a point.
    ThreeParallel,
}

/// An arm of six revolute joints with a closed form.
///
/// # Source
/// Paden 1986, Kahan 1983 (subproblems of screw axes); Elias, Wen 2022 (subproblem 4 for the arms' classes).
#[derive(Debug, Clone)]
pub struct Inverse {
    pub class: Class,
    /// Directions of the axes at zero, in the base frame.
    pub axes: [Vector3<f64>; 6],
    /// A point of each, m.
    pub points: [Vector3<f64>; 6],
    /// Where the last axes meet at zero, m.
    pub centre: Vector3<f64>,
    /// base_from_tip at zero.
    pub home: Pose,
    /// A unit vector across axis 6, or across axis 2.
    pub side: Vector3<f64>,
    /// +1 or -1: axes 3 and 4 along axis 2, or against it.
    pub along: [f64; 2],
}

impl Inverse {
    /// The closed form of a chain, or why there is none.
    pub fn of(chain: &Chain) -> Result<Self, &'static str> {
        let own = |(index, joint): (usize, &denavit_model::ChainJoint)| {
            joint.coordinate == index && joint.scale == 1.0 && joint.offset == 0.0
        };
        if chain.joints().len() != 6 || chain.coordinates().len() != 6 || !chain.joints().iter().enumerate().all(own) {
            return Err("it does not have six joints, each with its own coordinate");
        }
        let mut axes = [Vector3::zeros(); 6];
        let mut points = [Vector3::zeros(); 6];
        for (index, joint) in chain.joints().iter().enumerate() {
            let Screw::Revolute(line) = &joint.screw else { return Err("one of its joints is not purely revolute") };
            (axes[index], points[index]) = (line.direction.into_inner(), line.point.coords);
        }
        let size = chain.size();
        let crossed = |a: usize, b: usize| axes[a].cross(&axes[b]).norm();
        let is_parallel = |a: usize, b: usize| crossed(a, b) < EXACT;
        if !is_parallel(1, 2) || crossed(0, 1) < APART || crossed(4, 5) < APART || crossed(3, 4) < APART {
            return Err("its axes 2 and 3 are not exactly parallel, or other neighbouring axes are");
        }
        let centre = meeting(&axes, &points, 4, 5, size).ok_or("its axes 5 and 6 do not meet in a point")?;
        let to_fourth = axes[3].cross(&(centre - points[3])).norm();
        let class = if to_fourth < EXACT * size {
            Class::SphericalWrist
        } else if is_parallel(1, 3) {
            Class::ThreeParallel
        } else {
            return Err("its axes 4, 5 and 6 do not meet in a point, and axes 2, 3 and 4 are not exactly parallel");
        };
        let reach = match class {
            Class::SphericalWrist => centre,
            Class::ThreeParallel => points[3],
        };
        let across = |from: Vector3<f64>, to: Vector3<f64>| axes[1].cross(&(to - from)).norm();
        if across(points[1], points[2]) < APART * size || across(points[2], reach) < APART * size {
            return Err("one of its two long links has no length");
        }
        let around = if class == Class::SphericalWrist { axes[5] } else { axes[1] };
        // The unit vector least along the axis, without its part along it.
        let least = Vector3::ith(around.iamin(), 1.0);
        let side = Unit::new_normalize(least - around * around.dot(&least)).into_inner();
        let along = [2, 3].map(|index: usize| axes[index].dot(&axes[1]).signum());
        Ok(Self { class, axes, points, centre, home: *chain.home(), side, along })
    }
}

/// Where two axes meet.
fn meeting(
    axes: &[Vector3<f64>; 6],
    points: &[Vector3<f64>; 6],
    a: usize,
    b: usize,
    size: f64,
) -> Option<Vector3<f64>> {
    let (between, normal) = (points[b] - points[a], axes[a].cross(&axes[b]));
    let square = normal.norm_squared();
    if between.dot(&normal).abs() > EXACT * size * square.sqrt() {
        return None;
    }
    Some(points[a] + axes[a] * (between.cross(&axes[b]).dot(&normal) / square))
}
