//! Six revolute axes and a home pose: the arm in which branches are found in closed form.

use denavit_model::nalgebra::{Point3, Vector3};
use denavit_model::{Chain, Pose, Screw, se3};

/// A revolute axis at home: its direction, of length 1, and a point on it, m.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Axis {
    pub direction: Vector3<f64>,
    pub point: Vector3<f64>,
}

impl Axis {
    /// Point after a turn by the angle about the axis, m.
    #[inline]
    pub fn turn(&self, angle: f64, point: &Vector3<f64>) -> Vector3<f64> {
        self.point + rotated(&self.direction, angle, &(point - self.point))
    }

    /// The turn as a pose.
    #[inline]
    pub fn motion(&self, angle: f64) -> Pose {
        let rotation = se3::rotation_by(&self.direction, angle.sin_cos());
        se3::pose(rotation, self.point - rotation * self.point)
    }

    /// Distance of the axis from a point, m.
    pub fn distance_to(&self, point: &Vector3<f64>) -> f64 {
        self.direction.cross(&(point - self.point)).norm()
    }
}

/// A vector turned about a unit direction by an angle (rad).
#[inline]
pub(crate) fn rotated(direction: &Vector3<f64>, angle: f64, vector: &Vector3<f64>) -> Vector3<f64> {
    let (sine, cosine) = angle.sin_cos();
    let along = direction * direction.dot(vector);
    along + (vector - along) * cosine + direction.cross(vector) * sine
}

/// The angle (rad) by which `from` is turned about the unit `direction` to point as `to` does, seen along it; 0 where
/// one of the two lies along it.
#[inline]
pub(crate) fn turn_between(direction: &Vector3<f64>, from: &Vector3<f64>, to: &Vector3<f64>) -> f64 {
    let cross = from.cross(to).dot(direction);
    let dot = from.dot(to) - direction.dot(from) * direction.dot(to);
    if cross == 0.0 && dot == 0.0 { 0.0 } else { cross.atan2(dot) }
}

/// Six revolute axes: base_from_tip = e1(v1) ··· e6(v6) home.
#[derive(Debug, Clone)]
pub(crate) struct SixR {
    pub axes: [Axis; 6],
    pub home: Pose,
}

impl SixR {
    /// The arm of a chain, if it has six revolute joints with a coordinate each.
    pub fn of(chain: &Chain) -> Option<Self> {
        let joints = chain.joints();
        let own = joints.len() == 6 && chain.coordinates().len() == 6;
        let in_order = joints.iter().enumerate().all(|(k, joint)| joint.coordinate == k);
        if !own || !in_order {
            return None;
        }
        let mut axes = [Axis { direction: Vector3::z(), point: Vector3::zeros() }; 6];
        for (axis, joint) in axes.iter_mut().zip(joints) {
            let Screw::Revolute(line) = joint.screw else { return None };
            *axis = Axis { direction: *line.direction, point: line.point.coords };
        }
        Some(Self { axes, home: *chain.home() })
    }

    /// The arm seen from its tip: the inverse of base_from_tip at the negative joint values in reverse order.
    ///
    /// (e1(v1) ··· e6(v6) M)⁻¹ = f1(-v6) ··· f6(-v1) M⁻¹, fk the axis 7 - k seen in the tip's frame at home.
    pub fn reversed(&self) -> Self {
        let tip_from_base = self.home.inverse();
        let mut axes = self.axes;
        axes.reverse();
        for axis in &mut axes {
            axis.direction = tip_from_base.rotation * axis.direction;
            axis.point = (tip_from_base * Point3::from(axis.point)).coords;
        }
        Self { axes, home: tip_from_base }
    }

    /// base_from_tip at joint values (rad).
    #[inline]
    pub fn fk(&self, values: &[f64; 6]) -> Pose {
        let mut reached = Pose::identity();
        for (axis, value) in self.axes.iter().zip(values) {
            reached *= axis.motion(*value);
        }
        reached * self.home
    }
}
