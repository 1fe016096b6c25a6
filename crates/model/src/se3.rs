//! Rigid motions: exponential, logarithm, Adjoint, and the angles that URDF writes.
//!
//! Poses read `base_from_tip`: in `base_from_link * link_from_tip` the inner names meet.
//! Six-vectors are angular first, `[omega; v]`.

use nalgebra::{IsometryMatrix3, Matrix3, Matrix6, Rotation3, Translation3, UnitQuaternion, Vector3, Vector6};
use std::f64::consts::PI;

/// A rigid motion, rotation matrix and translation in m.
pub type Pose = IsometryMatrix3<f64>;

/// Below this angle (rad) the closed forms of exp and log lose digits and their series are exact to rounding.
const SERIES_BELOW: f64 = 1e-3;

/// The matrix `[w]` with `[w] x = w × x`.
///
/// # Examples
/// ```
/// use denavit_model::{nalgebra::Vector3, se3::skew};
/// let (w, x) = (Vector3::new(1.0, 2.0, 3.0), Vector3::new(-2.0, 0.5, 1.0));
/// assert_eq!(skew(&w) * x, w.cross(&x));
/// ```
pub fn skew(w: &Vector3<f64>) -> Matrix3<f64> {
    Matrix3::new(0.0, -w.z, w.y, w.z, 0.0, -w.x, -w.y, w.x, 0.0)
}

/// Pose from a rotation and a translation (m).
pub fn pose(rotation: Rotation3<f64>, translation: Vector3<f64>) -> Pose {
    Pose::from_parts(Translation3::from(translation), rotation)
}

/// A translation (m) without rotation.
pub fn translation(vector: Vector3<f64>) -> Pose {
    pose(Rotation3::identity(), vector)
}

/// Rotation by `angle` (rad) about a unit `direction`; quarter turns come out exact when sine and cosine do.
///
/// R = I + sin(angle) \[u\] + (1 - cos(angle)) \[u\]²  (Rodrigues).
pub fn rotation_about(direction: &Vector3<f64>, angle: f64) -> Rotation3<f64> {
    let half = (0.5 * angle).sin();
    rotation_of(direction, angle.sin_cos(), 2.0 * half * half)
}

/// Rotation about a unit `direction` by an angle of this sine and cosine; 1 - cos comes with their absolute rounding.
pub fn rotation_by(direction: &Vector3<f64>, (sine, cosine): (f64, f64)) -> Rotation3<f64> {
    rotation_of(direction, (sine, cosine), 1.0 - cosine)
}

#[inline]
fn rotation_of(u: &Vector3<f64>, (sine, cosine): (f64, f64), versine: f64) -> Rotation3<f64> {
    Rotation3::from_matrix_unchecked(Matrix3::new(
        cosine + versine * u.x * u.x,
        versine * u.x * u.y - sine * u.z,
        versine * u.x * u.z + sine * u.y,
        versine * u.x * u.y + sine * u.z,
        cosine + versine * u.y * u.y,
        versine * u.y * u.z - sine * u.x,
        versine * u.x * u.z - sine * u.y,
        versine * u.y * u.z + sine * u.x,
        cosine + versine * u.z * u.z,
    ))
}

/// Sine and cosine of `angle` (rad), exact at whole quarter turns as written in f64 (`FRAC_PI_2` gives `(1, 0)`).
///
/// The nearest f64 to a multiple of π/2 is meant as that multiple: up to eight turns, closer than the spacing of f64
/// there.
pub fn sin_cos_of_written(angle: f64) -> (f64, f64) {
    let quarters = (angle / std::f64::consts::FRAC_PI_2).round();
    if quarters.abs() <= 32.0 && (angle - quarters * std::f64::consts::FRAC_PI_2).abs() <= 1e-15 * angle.abs() {
        return match quarters.rem_euclid(4.0) {
            q if q < 0.5 => (0.0, 1.0),
            q if q < 1.5 => (1.0, 0.0),
            q if q < 2.5 => (0.0, -1.0),
            _ => (-1.0, 0.0),
        };
    }
    angle.sin_cos()
}

/// URDF's fixed-axis angles: R = Rz(yaw) Ry(pitch) Rx(roll), rad.
///
/// # Examples
/// ```
/// use denavit_model::se3::{rotation_from_rpy, rpy_from_rotation};
/// let [roll, pitch, yaw] = rpy_from_rotation(&rotation_from_rpy([0.1, -0.2, 3.0]));
/// assert!((roll - 0.1).abs() < 1e-15 && (pitch + 0.2).abs() < 1e-15 && (yaw - 3.0).abs() < 1e-15);
/// ```
pub fn rotation_from_rpy([roll, pitch, yaw]: [f64; 3]) -> Rotation3<f64> {
    let (sr, cr) = sin_cos_of_written(roll);
    let (sp, cp) = sin_cos_of_written(pitch);
    let (sy, cy) = sin_cos_of_written(yaw);
    Rotation3::from_matrix_unchecked(Matrix3::new(
        cy * cp,
        cy * sp * sr - sy * cr,
        cy * sp * cr + sy * sr,
        sy * cp,
        sy * sp * sr + cy * cr,
        sy * sp * cr - cy * sr,
        -sp,
        cp * sr,
        cp * cr,
    ))
}

/// The fixed-axis angles of a rotation, rad: the inverse of [`rotation_from_rpy`], roll 0 where pitch is ±π/2.
pub fn rpy_from_rotation(rotation: &Rotation3<f64>) -> [f64; 3] {
    let r = rotation.matrix();
    let cosine_of_pitch = r[(0, 0)].hypot(r[(1, 0)]);
    let pitch = (-r[(2, 0)]).atan2(cosine_of_pitch);
    // The square of the spacing of f64 near 1, with room for the rounding of a product or two.
    if cosine_of_pitch < 1e-12 {
        return [0.0, pitch, (-r[(0, 1)]).atan2(r[(1, 1)])];
    }
    [r[(2, 1)].atan2(r[(2, 2)]), pitch, r[(1, 0)].atan2(r[(0, 0)])]
}

/// URDF's fixed-axis angles, rad, without what rounding added: the rotation that they give is `rotation` to rounding, near
/// a pitch of a quarter turn too, where roll and yaw are one number and each by itself is lost.
pub fn written_rpy(rotation: &Rotation3<f64>) -> [f64; 3] {
    let r = rotation.matrix();
    let cosine_of_pitch = r[(0, 0)].hypot(r[(1, 0)]);
    let yaw = if cosine_of_pitch < 4.0 * f64::EPSILON { 0.0 } else { clean_angle(r[(1, 0)].atan2(r[(0, 0)])) };
    // Roll from the rotation with the yaw as it will be written taken off: what the yaw lacks goes into the roll.
    let (sine, cosine) = sin_cos_of_written(yaw);
    let roll = (sine * r[(0, 2)] - cosine * r[(1, 2)]).atan2(cosine * r[(1, 1)] - sine * r[(0, 1)]);
    let pitch = (-r[(2, 0)]).atan2(cosine * r[(0, 0)] + sine * r[(1, 0)]);
    [clean_angle(roll), clean_angle(pitch), yaw]
}

/// The quaternion x, y, z, w of a rotation, of length 1, w not negative.
pub fn quaternion_xyzw(rotation: &Rotation3<f64>) -> [f64; 4] {
    let quaternion = UnitQuaternion::from_rotation_matrix(rotation);
    let sense = if quaternion.w < 0.0 { -1.0 } else { 1.0 };
    [quaternion.i, quaternion.j, quaternion.k, quaternion.w].map(|part| sense * part + 0.0)
}

/// An angle without what rounding added (rad): a multiple of π/12, or a short decimal.
pub fn clean_angle(angle: f64) -> f64 {
    // Rounding of a turn that went through some products, rad.
    const ROUNDING: f64 = 8.0 * f64::EPSILON;
    let parts = (angle / (PI / 12.0)).round();
    let multiple = if parts % 12.0 == 0.0 { parts / 12.0 * PI } else { parts * PI / 12.0 };
    if (multiple - angle).abs() <= ROUNDING {
        return multiple + 0.0;
    }
    // A short decimal next to a multiple of π would be read as that multiple.
    let rounded = (angle * 1e12).round() / 1e12;
    let short = (rounded - angle).abs() <= 4.0 * f64::EPSILON * angle.abs().max(1.0);
    if (multiple - angle).abs() >= 1e-6 && short { rounded + 0.0 } else { angle }
}

/// Angle of a rotation in \[0, π\], rad, with every digit near 0 and near π.
pub fn rotation_angle(rotation: &Rotation3<f64>) -> f64 {
    rotation_vector(rotation).norm()
}

/// Rotation vector (axis × angle), rad; at an angle of π one of the two is returned.
pub fn rotation_vector(rotation: &Rotation3<f64>) -> Vector3<f64> {
    let quaternion = UnitQuaternion::from_rotation_matrix(rotation);
    let (imaginary, real) =
        if quaternion.w < 0.0 { (-quaternion.imag(), -quaternion.w) } else { (quaternion.imag(), quaternion.w) };
    let sine_of_half = imaginary.norm();
    if sine_of_half == 0.0 {
        return Vector3::zeros();
    }
    imaginary * (2.0 * sine_of_half.atan2(real) / sine_of_half)
}

/// Angle between two directions in \[0, π\], rad; they need not be of length 1.
pub fn angle_between(a: &Vector3<f64>, b: &Vector3<f64>) -> f64 {
    a.cross(b).norm().atan2(a.dot(b))
}

/// The rotation vector (rad) that takes one direction to another on the shortest way; 0 where they are opposite.
pub fn least_rotation_vector(from: &Vector3<f64>, to: &Vector3<f64>) -> Vector3<f64> {
    let cross = from.cross(to);
    let sine = cross.norm();
    if sine == 0.0 { Vector3::zeros() } else { cross * (sine.atan2(from.dot(to)) / sine) }
}

/// The rotation that takes one direction to another on the shortest way; none where they are opposite.
pub fn least_rotation(from: &Vector3<f64>, to: &Vector3<f64>) -> Rotation3<f64> {
    let vector = least_rotation_vector(from, to);
    exp(&Vector6::new(vector.x, vector.y, vector.z, 0.0, 0.0, 0.0)).rotation
}

/// exp of the twist `[omega; v]` (rad, m): the motion after unit time.
///
/// R = exp\[omega\], p = (I + B \[omega\] + C \[omega\]²) v, B = (1 - cos t)/t², C = (t - sin t)/t³, t = |omega|.
///
/// # Source
/// Murray, Li, Sastry 1994, Prop. 2.9; Wu, Crawford, Roberts 2019, eq. (3).
///
/// # Examples
/// ```
/// use denavit_model::{nalgebra::Vector6, se3::{exp, log}};
/// let twist = Vector6::new(0.3, -0.2, 0.9, 0.1, 2.0, -1.0);
/// assert!((log(&exp(&twist)) - twist).norm() < 1e-14);
/// ```
pub fn exp(twist: &Vector6<f64>) -> Pose {
    let omega = twist.fixed_rows::<3>(0).into_owned();
    let v = twist.fixed_rows::<3>(3).into_owned();
    let t = omega.norm();
    let t2 = t * t;
    let half = (0.5 * t).sin();
    let (a, b, c) = if t < SERIES_BELOW {
        (1.0 - t2 / 6.0 + t2 * t2 / 120.0, 0.5 - t2 / 24.0 + t2 * t2 / 720.0, 1.0 / 6.0 - t2 / 120.0 + t2 * t2 / 5040.0)
    } else {
        (t.sin() / t, 2.0 * half * half / t2, (t - t.sin()) / (t2 * t))
    };
    let w = skew(&omega);
    let w2 = w * w;
    let rotation = Rotation3::from_matrix_unchecked(Matrix3::identity() + w * a + w2 * b);
    pose(rotation, v + w * v * b + w2 * v * c)
}

/// log of a pose: the twist `[omega; v]` (rad, m) with |omega| ≤ π and `exp(log(T)) = T`.
///
/// Well behaved at rotations by exactly π, where the sign of the axis is free.
pub fn log(pose: &Pose) -> Vector6<f64> {
    let omega = rotation_vector(&pose.rotation);
    let t = omega.norm();
    let t2 = t * t;
    let half = (0.5 * t).sin();
    let factor = if t < SERIES_BELOW {
        1.0 / 12.0 + t2 / 720.0 + t2 * t2 / 30240.0
    } else {
        (1.0 - t * t.sin() / (4.0 * half * half)) / t2
    };
    let w = skew(&omega);
    let p = pose.translation.vector;
    let v = p - w * p * 0.5 + w * (w * p) * factor;
    Vector6::new(omega.x, omega.y, omega.z, v.x, v.y, v.z)
}

/// Adjoint of `a_from_b`: maps a twist given in b to the same twist given in a.
///
/// ```text
/// Ad = |   R    0 |
///      | [p] R  R |
/// ```
///
/// # Examples
/// ```
/// use denavit_model::{nalgebra::Vector6, se3::{adjoint, exp}};
/// let (a_from_b, in_b) = (exp(&Vector6::new(0.3, 1.0, 0.2, 1.0, 2.0, 3.0)), Vector6::new(1.0, 0.0, 0.5, 0.0, 0.2, 0.1));
/// let moved = a_from_b * exp(&in_b) * a_from_b.inverse();
/// assert!((exp(&(adjoint(&a_from_b) * in_b)).to_homogeneous() - moved.to_homogeneous()).norm() < 1e-13);
/// ```
pub fn adjoint(a_from_b: &Pose) -> Matrix6<f64> {
    let r = a_from_b.rotation.matrix();
    let mut result = Matrix6::zeros();
    result.fixed_view_mut::<3, 3>(0, 0).copy_from(r);
    result.fixed_view_mut::<3, 3>(3, 3).copy_from(r);
    result.fixed_view_mut::<3, 3>(3, 0).copy_from(&(skew(&a_from_b.translation.vector) * r));
    result
}

/// `Ad(a_from_b) * twist` without building the matrix.
pub fn adjoint_times(a_from_b: &Pose, twist: &Vector6<f64>) -> Vector6<f64> {
    let omega = a_from_b.rotation * twist.fixed_rows::<3>(0).into_owned();
    let v = a_from_b.rotation * twist.fixed_rows::<3>(3).into_owned() + a_from_b.translation.vector.cross(&omega);
    Vector6::new(omega.x, omega.y, omega.z, v.x, v.y, v.z)
}

/// The rotation next to `rotation` whose columns are orthonormal to rounding: undoes the drift of long products.
pub fn orthonormalised(rotation: &Rotation3<f64>) -> Rotation3<f64> {
    let m = rotation.matrix();
    // One Newton step towards the polar factor: quadratic, so rounding drift is gone.
    Rotation3::from_matrix_unchecked(m * (Matrix3::identity() * 1.5 - m.transpose() * m * 0.5))
}

/// How far two poses are apart: angle of the rotation between them (rad) and distance of their origins (m).
pub fn difference(a: &Pose, b: &Pose) -> (f64, f64) {
    let rotation = a.rotation.inverse() * b.rotation;
    (rotation_angle(&rotation), (a.translation.vector - b.translation.vector).norm())
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::f64::consts::{FRAC_PI_2, PI};

    fn direction() -> impl Strategy<Value = Vector3<f64>> {
        (-1.0..1.0f64, -PI..PI).prop_map(|(z, azimuth)| {
            let r = (1.0 - z * z).sqrt();
            Vector3::new(r * azimuth.cos(), r * azimuth.sin(), z)
        })
    }

    fn angle() -> impl Strategy<Value = f64> {
        prop_oneof![
            0.0..PI,
            (-16.0..-0.0f64).prop_map(|e| 10f64.powf(e)),
            (-16.0..-1.0f64).prop_map(|e| PI - 10f64.powf(e)),
            Just(PI),
            Just(0.0)
        ]
    }

    proptest! {
        #[test]
        fn log_undoes_exp(u in direction(), t in angle(), v in prop::array::uniform3(-2.0..2.0f64)) {
            let twist = Vector6::new(u.x * t, u.y * t, u.z * t, v[0], v[1], v[2]);
            let motion = exp(&twist);
            let (turned, moved) = difference(&exp(&log(&motion)), &motion);
            prop_assert!(turned < 4e-15 && moved < 2e-14, "{turned} {moved}");
            if t < PI - 1e-6 {
                prop_assert!((log(&motion) - twist).norm() < 1e-9 * (1.0 + v.iter().map(|x| x.abs()).sum::<f64>()));
            }
        }

        #[test]
        fn angle_keeps_its_digits(u in direction(), t in angle()) {
            prop_assert!((rotation_angle(&rotation_about(&u, t)) - t).abs() <= 1e-15 + 4e-16 * t);
        }

        #[test]
        fn adjoint_times_is_the_matrix_product(a in prop::array::uniform6(-3.0..3.0f64), b in prop::array::uniform6(-3.0..3.0f64)) {
            let (pose, twist) = (exp(&Vector6::from(a)), Vector6::from(b));
            prop_assert!((adjoint(&pose) * twist - adjoint_times(&pose, &twist)).norm() < 1e-13);
        }

        #[test]
        fn rpy_and_rotation_are_inverse(roll in -PI..PI, pitch in prop_oneof![-FRAC_PI_2..FRAC_PI_2, Just(FRAC_PI_2), Just(-FRAC_PI_2)], yaw in -PI..PI) {
            let rotation = rotation_from_rpy([roll, pitch, yaw]);
            let again = rotation_from_rpy(rpy_from_rotation(&rotation));
            // Near a pitch of a quarter turn roll and yaw are one number: their own rounding is all that is lost.
            prop_assert!(rotation_angle(&(rotation.inverse() * again)) < 1e-11);
        }
    }

    #[test]
    fn written_quarter_turns_are_exact() {
        assert_eq!(sin_cos_of_written(FRAC_PI_2), (1.0, 0.0));
        assert_eq!(sin_cos_of_written(-PI), (0.0, -1.0));
        assert_eq!(sin_cos_of_written(-3.0 * FRAC_PI_2), (1.0, 0.0));
        assert_eq!(sin_cos_of_written(1.5709), 1.5709f64.sin_cos());
    }

    #[test]
    fn orthonormalising_removes_drift() {
        let drifted = Rotation3::from_matrix_unchecked(rotation_from_rpy([0.3, 0.2, 0.1]).matrix() * (1.0 + 1e-9));
        let corrected = orthonormalised(&drifted);
        assert!((corrected.matrix().transpose() * corrected.matrix() - Matrix3::identity()).norm() < 1e-15);
    }
}
