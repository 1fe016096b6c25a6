//! Screw axes: where a joint turns or slides, with which pitch.

use crate::se3::{self, Pose};
use nalgebra::{Point3, Rotation3, Unit, Vector3, Vector6};
use thiserror::Error;

/// A line in space: the axis of a revolute or helical joint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AxisLine {
    /// Direction of positive rotation.
    pub direction: Unit<Vector3<f64>>,
    /// A point on the line, m; any will do, one near the arm keeps digits.
    pub point: Point3<f64>,
}

impl AxisLine {
    /// The point of the line that is nearest to `reference`, m.
    pub fn nearest_to(&self, reference: &Point3<f64>) -> Point3<f64> {
        let u = self.direction.as_ref();
        let offset = reference - self.point;
        self.point + u * offset.dot(u)
    }

    /// The same line given by its point nearest to `reference`.
    #[must_use]
    pub fn about(&self, reference: &Point3<f64>) -> Self {
        Self { direction: self.direction, point: self.nearest_to(reference) }
    }

    /// The line after the motion `pose`.
    #[must_use]
    pub fn moved(&self, pose: &Pose) -> Self {
        Self { direction: Unit::new_normalize(pose.rotation * self.direction.as_ref()), point: pose * self.point }
    }
}

/// Pitch of a helical joint in m per **rad**: finite and not zero.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pitch(f64);

impl Pitch {
    /// From metres per radian; `None` when zero or not finite.
    pub fn from_metres_per_radian(pitch: f64) -> Option<Self> {
        (pitch.is_finite() && pitch != 0.0).then_some(Self(pitch))
    }

    /// From a screw's lead in metres per turn: pitch = lead / 2π.
    pub fn from_lead(metres_per_turn: f64) -> Option<Self> {
        Self::from_metres_per_radian(metres_per_turn / std::f64::consts::TAU)
    }

    /// m per rad.
    pub fn metres_per_radian(self) -> f64 {
        self.0
    }
}

/// A joint's screw axis, normalised.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Screw {
    /// Turns about a line; its value is an angle, rad.
    Revolute(AxisLine),
    /// Slides along a direction; its value is a length, m.
    Prismatic(Unit<Vector3<f64>>),
    /// Turns about a line and slides along it; its value is the angle, rad.
    Helical {
        /// The line that it turns about and slides along.
        axis: AxisLine,
        /// Slide per angle.
        pitch: Pitch,
    },
}

/// Why six numbers are not a screw axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum TwistError {
    /// All six numbers are zero: nothing moves.
    #[error("the twist is zero, so nothing moves; give the joint an axis")]
    Zero,
    /// A number is infinite or not a number.
    #[error("a number of the twist is not finite")]
    NotFinite,
}

impl Screw {
    /// The screw axis of a twist `[omega; v]` of any length, and its normalisation factor.
    ///
    /// The factor is |omega|, or |v| where omega = 0: exp(twist · q) = exp(unit twist · factor · q).
    /// The pitch is omega·v / |omega|²; one within the rounding of that product counts as zero.
    ///
    /// # Errors
    /// The twist is zero or not finite.
    ///
    /// # Source
    /// Wu, Crawford, Roberts 2019, eq. (1) and section II.
    pub fn from_twist(twist: &Vector6<f64>) -> Result<(Self, f64), TwistError> {
        if !twist.iter().all(|x| x.is_finite()) {
            return Err(TwistError::NotFinite);
        }
        let omega = twist.fixed_rows::<3>(0).into_owned();
        let v = twist.fixed_rows::<3>(3).into_owned();
        let Some((direction, factor)) = Unit::try_new_and_get(omega, 0.0) else {
            let (direction, factor) = Unit::try_new_and_get(v, 0.0).ok_or(TwistError::Zero)?;
            return Ok((Self::Prismatic(direction), factor));
        };
        let axis = AxisLine { direction, point: Point3::from(omega.cross(&v) / (factor * factor)) };
        let along = omega.dot(&v);
        let rounding = 4.0 * f64::EPSILON * omega.component_mul(&v).abs().sum();
        let pitch =
            if along.abs() <= rounding { None } else { Pitch::from_metres_per_radian(along / (factor * factor)) };
        Ok(match pitch {
            None => (Self::Revolute(axis), factor),
            Some(pitch) => (Self::Helical { axis, pitch }, factor),
        })
    }

    /// The unit twist `[omega; v]` in the frame that the screw is given in.
    ///
    /// Revolute and helical: omega = u, v = p × u + h u; prismatic: omega = 0, v = u.
    pub fn twist(&self) -> Vector6<f64> {
        let (omega, v) = match self {
            Self::Revolute(axis) => (*axis.direction, axis.point.coords.cross(&axis.direction)),
            Self::Prismatic(direction) => (Vector3::zeros(), **direction),
            Self::Helical { axis, pitch } => {
                (*axis.direction, axis.point.coords.cross(&axis.direction) + *axis.direction * pitch.0)
            }
        };
        Vector6::new(omega.x, omega.y, omega.z, v.x, v.y, v.z)
    }

    /// Direction of positive motion.
    pub fn direction(&self) -> Unit<Vector3<f64>> {
        match self {
            Self::Revolute(axis) | Self::Helical { axis, .. } => axis.direction,
            Self::Prismatic(direction) => *direction,
        }
    }

    /// The line, where the joint has one: a prismatic joint's axis has a direction but no place.
    pub fn line(&self) -> Option<&AxisLine> {
        match self {
            Self::Revolute(axis) | Self::Helical { axis, .. } => Some(axis),
            Self::Prismatic(_) => None,
        }
    }

    /// Pitch in m/rad, 0 for revolute joints; `None` for prismatic ones.
    pub fn pitch(&self) -> Option<f64> {
        match self {
            Self::Revolute(_) => Some(0.0),
            Self::Helical { pitch, .. } => Some(pitch.0),
            Self::Prismatic(_) => None,
        }
    }

    /// exp(unit twist · value): the motion at joint value `value` (rad, or m for prismatic).
    #[inline]
    pub fn motion(&self, value: f64) -> Pose {
        self.moved_by(value, |direction| se3::rotation_about(direction, value))
    }

    /// The motion at joint value `value` whose sine and cosine are known, as by
    /// [`sines_and_cosines`](crate::compiled::sines_and_cosines); accurate to the rounding of the numbers' size.
    #[inline]
    pub fn motion_by(&self, value: f64, sine_and_cosine: (f64, f64)) -> Pose {
        self.moved_by(value, |direction| se3::rotation_by(direction, sine_and_cosine))
    }

    #[inline]
    fn moved_by(&self, value: f64, rotation: impl Fn(&Vector3<f64>) -> Rotation3<f64>) -> Pose {
        // Rotation about a line and slide along it: R, p = (I - R) point + slide · u.
        let turn = |axis: &AxisLine, slide: f64| {
            let rotation = rotation(&axis.direction);
            let moved = axis.point.coords - rotation * axis.point.coords + axis.direction.as_ref() * slide;
            se3::pose(rotation, moved)
        };
        match self {
            Self::Revolute(axis) => turn(axis, 0.0),
            Self::Prismatic(direction) => se3::translation(direction.as_ref() * value),
            Self::Helical { axis, pitch } => turn(axis, pitch.0 * value),
        }
    }

    /// The screw after the motion `pose`.
    #[must_use]
    pub fn moved(&self, pose: &Pose) -> Self {
        match self {
            Self::Revolute(axis) => Self::Revolute(axis.moved(pose)),
            Self::Prismatic(direction) => Self::Prismatic(Unit::new_normalize(pose.rotation * direction.as_ref())),
            Self::Helical { axis, pitch } => Self::Helical { axis: axis.moved(pose), pitch: *pitch },
        }
    }

    /// The same axis with the opposite positive direction.
    #[must_use]
    pub fn reversed(&self) -> Self {
        let turned = |line: &AxisLine| AxisLine { direction: -line.direction, point: line.point };
        match self {
            Self::Revolute(line) => Self::Revolute(turned(line)),
            Self::Prismatic(direction) => Self::Prismatic(-*direction),
            Self::Helical { axis, pitch } => Self::Helical { axis: turned(axis), pitch: *pitch },
        }
    }

    /// The same screw whose line is given by its point nearest to `reference`.
    #[must_use]
    pub fn about(&self, reference: &Point3<f64>) -> Self {
        match self {
            Self::Revolute(axis) => Self::Revolute(axis.about(reference)),
            Self::Prismatic(_) => *self,
            Self::Helical { axis, pitch } => Self::Helical { axis: axis.about(reference), pitch: *pitch },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn motion_is_exp_of_the_twist(twist in prop::array::uniform6(-2.0..2.0f64), q in -4.0..4.0f64, straight in any::<bool>()) {
            let mut twist = Vector6::from(twist);
            if straight {
                twist.fixed_rows_mut::<3>(0).fill(0.0);
            }
            let (screw, factor) = Screw::from_twist(&twist).unwrap();
            let (turned, moved) = se3::difference(&screw.motion(factor * q), &se3::exp(&(twist * q)));
            prop_assert!(turned < 1e-13 && moved < 1e-11, "{turned} {moved}");
            prop_assert!((screw.twist() * factor - twist).norm() < 1e-11);
        }
    }

    #[test]
    fn kinds_are_distinguished() {
        let revolute = Screw::from_twist(&Vector6::new(0.04, -0.02, 0.999, 0.02, 0.04, 0.0)).unwrap();
        assert!(matches!(revolute.0, Screw::Revolute(_)));
        let helical = Screw::from_twist(&Vector6::new(0.0, 0.0, 2.0, 0.0, 0.0, 0.01)).unwrap();
        assert!(helical.1 == 2.0 && helical.0.pitch() == Some(0.005));
        assert!(
            matches!(Screw::from_twist(&Vector6::new(0.0, 0.0, 0.0, 0.0, 3.0, 0.0)).unwrap(), (Screw::Prismatic(_), f) if f == 3.0)
        );
        assert_eq!(Screw::from_twist(&Vector6::zeros()), Err(TwistError::Zero));
        assert_eq!(Screw::from_twist(&Vector6::repeat(f64::NAN)), Err(TwistError::NotFinite));
    }

    #[test]
    fn lead_is_per_turn_and_pitch_per_radian() {
        assert_eq!(Pitch::from_lead(std::f64::consts::TAU), Pitch::from_metres_per_radian(1.0));
        assert_eq!(Pitch::from_lead(0.0), None);
    }
}
