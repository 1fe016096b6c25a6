//! Ortho-parallel arms with a spherical wrist, given by seven lengths.

use denavit_model::chain::{Chain, ChainError, ChainJoint, Coordinate, Quantity};
use denavit_model::nalgebra::{Point3, Rotation3, Unit, Vector3};
use denavit_model::screw::{AxisLine, Screw};
use denavit_model::se3;

/// The parameters of an ortho-parallel arm with a spherical wrist; joint i of the model is at signs\[i\] q\[i\] - offsets\[i\].
///
/// ```text
/// T = Rz(t1) T(a1, b, c1) Ry(t2) Tz(c2) Ry(t3) T(a2, 0, c3) Rz(t4) Ry(t5) Rz(t6) Tz(c4)
/// ```
///
/// # Source
/// M. Brandstötter, A. Angerer, M. Hofbaur 2014; signs and offsets as ROS-Industrial's opw_kinematics takes them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OrthoParallelWrist {
    /// Axis 1 to axis 2, forwards, m.
    pub a1: f64,
    /// Axis 3 to axis 4, m.
    pub a2: f64,
    /// Sideways offset of the arm, m.
    pub b: f64,
    /// Base to axis 2, upwards, m.
    pub c1: f64,
    /// Axis 2 to axis 3, m.
    pub c2: f64,
    /// Axis 3 to the wrist, m.
    pub c3: f64,
    /// Wrist to flange, m.
    pub c4: f64,
    /// rad.
    pub offsets: [f64; 6],
    /// 1 or -1.
    pub signs: [f64; 6],
}

impl OrthoParallelWrist {
    /// The arm as a chain from `base_link` to `tool0`, joints `joint_1` … `joint_6` without limits.
    ///
    /// # Errors
    /// A number is not finite, or a sign is zero.
    pub fn chain(&self, name: &str) -> Result<Chain, ChainError> {
        let (z, y) = (Vector3::z_axis(), Vector3::y_axis());
        let shoulder = Point3::new(self.a1, self.b, self.c1);
        let elbow = shoulder + Vector3::z() * self.c2;
        let wrist = elbow + Vector3::new(self.a2, 0.0, self.c3);
        let axes = [(z, Point3::origin()), (y, shoulder), (y, elbow), (z, wrist), (y, wrist), (z, wrist)];
        let revolute = |(direction, point): (Unit<Vector3<f64>>, _)| Screw::Revolute(AxisLine { direction, point });
        let joints = axes.into_iter().enumerate().map(|(k, axis)| ChainJoint {
            name: format!("joint_{}", k + 1),
            screw: revolute(axis),
            coordinate: k,
            scale: self.signs[k],
            offset: -self.offsets[k],
        });
        let coordinates = (1..=6).map(|k| Coordinate::unlimited(format!("joint_{k}"), Quantity::Angle)).collect();
        let home = se3::pose(Rotation3::identity(), wrist.coords + Vector3::z() * self.c4);
        Chain::new((name, "base_link", "tool0"), coordinates, joints.collect(), home)
    }
}
