//! Six revolute axes and a home pose: the arm in which branches are found in closed form.

use denavit_model::nalgebra::{Point3, Rotation3, Vector3};
use denavit_model::{Chain, Pose, Screw, se3};
use std::f64::consts::PI;

/// An angle (rad) with its sine and cosine, which closed forms know before the angle.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Angle {
    pub value: f64,
    pub sine: f64,
    pub cosine: f64,
}

impl Angle {
    pub const ZERO: Self = Self { value: 0.0, sine: 0.0, cosine: 1.0 };

    pub fn at(value: f64) -> Self {
        let (sine, cosine) = value.sin_cos();
        Self { value, sine, cosine }
    }

    /// The direction of a vector; 0 of none.
    #[inline]
    pub fn of(y: f64, x: f64) -> Self {
        let length = (x * x + y * y).sqrt();
        if length == 0.0 { Self::ZERO } else { Self { value: y.atan2(x), sine: y / length, cosine: x / length } }
    }

    /// The sum of two; sine and cosine lose a rounding.
    #[inline]
    pub fn plus(self, other: Self) -> Self {
        Self {
            value: self.value + other.value,
            sine: self.sine * other.cosine + self.cosine * other.sine,
            cosine: self.cosine * other.cosine - self.sine * other.sine,
        }
    }

    /// Half a turn from here, within half a turn of 0 if this is.
    #[inline]
    pub fn opposite(self) -> Self {
        let by = if self.value > 0.0 { -PI } else { PI };
        Self { value: self.value + by, sine: -self.sine, cosine: -self.cosine }
    }
}

impl std::ops::Neg for Angle {
    type Output = Self;

    fn neg(self) -> Self {
        Self { value: -self.value, sine: -self.sine, ..self }
    }
}

/// A revolute axis at home: its direction, of length 1, and a point on it, m.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Axis {
    pub direction: Vector3<f64>,
    pub point: Vector3<f64>,
}

impl Axis {
    /// The turn's rotation.
    #[inline]
    pub fn rotation(&self, angle: Angle) -> Rotation3<f64> {
        se3::rotation_by(&self.direction, (angle.sine, angle.cosine))
    }

    /// The turn as a pose.
    #[inline]
    pub fn motion(&self, angle: f64) -> Pose {
        let rotation = self.rotation(Angle::at(angle));
        se3::pose(rotation, self.point - rotation * self.point)
    }

    /// Distance of the axis from a point, m.
    pub fn distance_to(&self, point: &Vector3<f64>) -> f64 {
        self.direction.cross(&(point - self.point)).norm()
    }
}

/// A vector turned about a unit direction by an angle.
#[inline]
pub(crate) fn rotated(direction: &Vector3<f64>, angle: Angle, vector: &Vector3<f64>) -> Vector3<f64> {
    let along = direction * direction.dot(vector);
    along + (vector - along) * angle.cosine + direction.cross(vector) * angle.sine
}

/// The angle by which `from` is turned about the unit `direction` to point as `to` does, seen along it; 0 where
/// one of the two lies along it.
#[inline]
pub(crate) fn turn_between(direction: &Vector3<f64>, from: &Vector3<f64>, to: &Vector3<f64>) -> Angle {
    let cross = from.cross(to).dot(direction);
    let dot = from.dot(to) - direction.dot(from) * direction.dot(to);
    Angle::of(cross, dot)
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

    /// Every axis turned by some `angle` (rad) and moved by as large a share of the size, each another way, and another for each seed.
    pub fn perturbed(&self, angle: f64, size: f64, seed: usize) -> Self {
        let mut arm = self.clone();
        for (k, axis) in arm.axes.iter_mut().enumerate() {
            let some = |n: usize| 2.0 * (0.5 + (101 * seed + 7 * k + n) as f64 * 0.414_213_562_373_095).fract() - 1.0;
            let vector = |n: usize| Vector3::new(some(n), some(n + 1), some(n + 2)) * angle;
            axis.direction = (axis.direction + vector(1)).normalize();
            axis.point += vector(4) * size;
        }
        arm
    }

    /// The same axes, each stated by its point nearest to that of another arm's.
    pub fn with_points_near(mut self, points: &[Vector3<f64>; 6]) -> Self {
        for (axis, near) in self.axes.iter_mut().zip(points) {
            axis.point += axis.direction * axis.direction.dot(&(near - axis.point));
        }
        self
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
