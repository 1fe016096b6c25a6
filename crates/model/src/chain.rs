//! A serial chain: screw axes in the base frame and the home pose of the tip (product of exponentials).

mod tips;

use crate::screw::Screw;
use crate::se3::{self, Pose};
use nalgebra::{Matrix3, Point3, Vector3};
use std::collections::HashSet;
use std::f64::consts::PI;
use thiserror::Error;
pub use tips::{Tip, Tips, TipsError};

/// The quantity of a coordinate.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quantity {
    /// An angle, rad.
    Angle,
    /// A length, m.
    Length,
}

/// Limits of a joint, each where stated: position in rad or m, velocity per second, effort in N·m or N.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Limits {
    /// Lower and upper position, in the order of the source.
    pub range: Option<(f64, f64)>,
    /// Highest speed, where stated.
    pub velocity: Option<f64>,
    /// Highest torque or force, where stated.
    pub effort: Option<f64>,
}

impl Limits {
    /// Position limits only.
    pub fn between(lower: f64, upper: f64) -> Self {
        Self { range: Some((lower, upper)), ..Self::default() }
    }

    /// The lowest and the highest position, whichever the source names first.
    pub fn interval(&self) -> Option<(f64, f64)> {
        self.range.map(|(lower, upper)| (lower.min(upper), lower.max(upper)))
    }
}

/// One number that moves the chain: the value of a joint that is not a mimic.
#[derive(Debug, Clone, PartialEq)]
pub struct Coordinate {
    /// The joint's name.
    pub name: String,
    /// Angle or length.
    pub quantity: Quantity,
    /// Limits that are stated; a continuous joint has no range.
    pub limits: Limits,
    /// Turns without end (URDF's `continuous`).
    pub continuous: bool,
}

impl Coordinate {
    /// An unlimited coordinate.
    pub fn unlimited(name: impl Into<String>, quantity: Quantity) -> Self {
        Self { name: name.into(), quantity, limits: Limits::default(), continuous: false }
    }

    /// The interval to sample: the limits in order, or \[-π, π\] rad, or \[-1, 1\] m.
    pub fn range(&self) -> (f64, f64) {
        self.limits.interval().unwrap_or(match self.quantity {
            Quantity::Angle => (-PI, PI),
            Quantity::Length => (-1.0, 1.0),
        })
    }
}

/// A moving joint of a chain: its value is `scale · q[coordinate] + offset`.
#[derive(Debug, Clone, PartialEq)]
pub struct ChainJoint {
    /// The joint's name.
    pub name: String,
    /// Screw axis in the base frame with every joint value 0.
    pub screw: Screw,
    /// Index of the coordinate that moves it.
    pub coordinate: usize,
    /// The paper's normalisation factor, a mimic joint's multiplier, or -1 where a path runs up the tree.
    pub scale: f64,
    /// Joint value at coordinate 0, rad or m.
    pub offset: f64,
}

impl ChainJoint {
    /// The joint's value (rad or m) at the coordinates `q`.
    #[inline]
    pub fn value(&self, q: &[f64]) -> f64 {
        self.scale * q[self.coordinate] + self.offset
    }
}

/// A chain of revolute, prismatic and helical joints in any mix, fixed joints folded in.
///
/// base_from_tip(q) = exp(\[S1\] v1) ··· exp(\[Sn\] vn) M, vi = scale_i q\[coordinate_i\] + offset_i.
///
/// # Source
/// Wu, Crawford, Roberts 2019, eq. (5).
#[derive(Debug, Clone, PartialEq)]
pub struct Chain {
    name: String,
    base: String,
    tip: String,
    coordinates: Vec<Coordinate>,
    joints: Vec<ChainJoint>,
    home: Pose,
}

/// Why a chain cannot be built from parts.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum ChainError {
    /// A joint names a coordinate that is not there.
    #[error("joint \"{joint}\" is moved by coordinate {coordinate}, but there are only {coordinates} coordinates")]
    NoSuchCoordinate {
        /// The joint.
        joint: String,
        /// Its index.
        coordinate: usize,
        /// How many there are.
        coordinates: usize,
    },
    /// Two coordinates of one name.
    #[error("two joints are named \"{0}\"; give each its own name")]
    DuplicateName(String),
    /// A number is not finite, or a scale is zero.
    #[error("joint \"{0}\": scale, offset and axis must be finite and the scale not zero")]
    BadNumber(String),
    /// The D-H table does not have one row more than joints.
    #[error("the table has {rows} rows for {joints} joints; it needs one row more than there are joints")]
    Rows {
        /// How many there are.
        rows: usize,
        /// How many joints there are.
        joints: usize,
    },
    /// A number of the home pose is not finite.
    #[error("a number of the home pose is not finite")]
    BadHome,
    /// The upper left of the home pose is not a rotation.
    #[error(
        "the rotation of the home pose is invalid: its columns are not of length 1 and orthogonal, or are left-handed; correct its first three columns"
    )]
    HomeNotARotation,
    /// Something lies farther away than any robot reaches.
    #[error(
        "{what} lies {metres} m from the base; give every length in m (this file may be in mm, or a number may be wrong)"
    )]
    TooFar {
        /// Which joint, or the tip.
        what: String,
        /// How far.
        metres: String,
    },
}

/// A rotation written to three decimals deviates from orthonormal by at most this.
const NO_ROTATION: f64 = 5e-3;

/// No part of a robot is farther from the base than this, m: beyond it a double has fewer digits left below the millimetre
/// than arithmetic along an arm needs.
const FARTHEST: f64 = 1e5;

impl Chain {
    /// Refuses a chain that was read from a file and is impossibly large: results from it would be meaningless.
    ///
    /// # Errors
    /// A joint or the tip lies farther from the base than 100 km.
    pub fn within_reach(self) -> Result<Self, ChainError> {
        let too_far = |what: String, at: &Vector3<f64>| {
            let metres = at.amax();
            (metres > FARTHEST).then(|| ChainError::TooFar { what, metres: format!("{metres:.3e}") })
        };
        let of_joint = |joint: &ChainJoint| {
            too_far(format!("the axis of joint \"{}\"", joint.name), &joint.screw.line()?.point.coords)
        };
        let found = self.joints.iter().find_map(of_joint);
        match found.or_else(|| too_far("the tip".into(), &self.home.translation.vector)) {
            Some(error) => Err(error),
            None => Ok(self),
        }
    }

    /// Builds a chain from its parts; moves axis points close to the arm and makes the home rotation orthonormal.
    ///
    /// # Errors
    /// A coordinate is missing or named twice, a number is not finite, or the home pose is not a rotation.
    pub fn new(
        (name, base, tip): (impl Into<String>, impl Into<String>, impl Into<String>),
        coordinates: Vec<Coordinate>,
        mut joints: Vec<ChainJoint>,
        home: Pose,
    ) -> Result<Self, ChainError> {
        let mut names = HashSet::with_capacity(coordinates.len());
        if let Some(again) = coordinates.iter().find(|coordinate| !names.insert(coordinate.name.as_str())) {
            return Err(ChainError::DuplicateName(again.name.clone()));
        }
        let mut reference = Point3::origin();
        for joint in &mut joints {
            if joint.coordinate >= coordinates.len() {
                return Err(ChainError::NoSuchCoordinate {
                    joint: joint.name.clone(),
                    coordinate: joint.coordinate,
                    coordinates: coordinates.len(),
                });
            }
            let finite = joint.scale.is_finite()
                && joint.offset.is_finite()
                && joint.screw.twist().iter().all(|x| x.is_finite());
            if !finite || joint.scale == 0.0 {
                return Err(ChainError::BadNumber(joint.name.clone()));
            }
            joint.screw = joint.screw.about(&reference);
            if let Some(line) = joint.screw.line() {
                reference = line.point;
            }
        }
        if !home.to_homogeneous().iter().all(|x| x.is_finite()) {
            return Err(ChainError::BadHome);
        }
        let r = home.rotation.matrix();
        let skewed = (r.transpose() * r - Matrix3::identity()).amax();
        if skewed > NO_ROTATION || r.determinant() < 0.0 {
            return Err(ChainError::HomeNotARotation);
        }
        let home = se3::pose(se3::orthonormalised(&home.rotation), home.translation.vector);
        Ok(Self { name: name.into(), base: base.into(), tip: tip.into(), coordinates, joints, home })
    }

    /// The robot's name.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Name of the base link.
    pub fn base(&self) -> &str {
        &self.base
    }

    /// Name of the tip link.
    pub fn tip(&self) -> &str {
        &self.tip
    }

    /// The numbers that move it, in order of first use from base to tip.
    pub fn coordinates(&self) -> &[Coordinate] {
        &self.coordinates
    }

    /// Moving joints from base to tip.
    pub fn joints(&self) -> &[ChainJoint] {
        &self.joints
    }

    /// base_from_tip with every joint *value* 0.
    pub fn home(&self) -> &Pose {
        &self.home
    }

    /// The same chain with another robot name.
    #[must_use]
    pub fn renamed(mut self, name: impl Into<String>) -> Self {
        self.name = name.into();
        self
    }

    /// The same joints with other screw axes and home pose: the result of a calibration or a change of gauge.
    ///
    /// # Errors
    /// As [`Chain::new`].
    pub fn with_geometry(&self, screws: &[Screw], home: Pose) -> Result<Self, ChainError> {
        let joints = self.joints.iter().zip(screws).map(|(joint, screw)| ChainJoint { screw: *screw, ..joint.clone() });
        Self::new(
            (self.name.clone(), self.base.clone(), self.tip.clone()),
            self.coordinates.clone(),
            joints.collect(),
            home,
        )
    }

    /// Points along the arm at home: base origin, for each joint with a line the point of it nearest to the one
    /// before, the tip's origin; m.
    pub fn skeleton(&self) -> Vec<Point3<f64>> {
        let mut points = vec![Point3::origin()];
        points.extend(self.joints.iter().filter_map(|joint| joint.screw.line()).map(|line| line.point));
        points.push(Point3::from(self.home.translation.vector));
        points
    }

    /// The robot's size, m: length of [`Chain::skeleton`] and the travel of its slides, where limited; never 0.
    ///
    /// Tolerances on lengths are relative to it.
    pub fn size(&self) -> f64 {
        let arm: f64 = self.skeleton().windows(2).map(|pair| (pair[1] - pair[0]).norm()).sum();
        let limited = |joint: &&ChainJoint| {
            let coordinate = &self.coordinates[joint.coordinate];
            coordinate.limits.range.is_some() || coordinate.quantity == Quantity::Angle
        };
        let travel: f64 = self.joints.iter().filter(limited).map(|joint| self.greatest_slide(joint)).sum();
        let size = arm + travel;
        if size > 0.0 { size } else { 1.0 }
    }

    /// How far the joint can slide from its zero over its coordinate's [`Coordinate::range`], m: 0 for revolute joints.
    pub fn greatest_slide(&self, joint: &ChainJoint) -> f64 {
        let per_value = joint.screw.pitch().unwrap_or(1.0).abs();
        let (lower, upper) = self.coordinates[joint.coordinate].range();
        let value = |q: f64| (joint.scale * q + joint.offset).abs();
        per_value * value(lower).max(value(upper))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::examples;
    use nalgebra::Rotation3;

    fn with_home(change: impl Fn(&mut Matrix3<f64>, &mut Vector3<f64>)) -> Result<Chain, ChainError> {
        let chain = examples::puma_like();
        let (mut r, mut t) = (*chain.home().rotation.matrix(), chain.home().translation.vector);
        change(&mut r, &mut t);
        let home = se3::pose(Rotation3::from_matrix_unchecked(r), t);
        let parts = (chain.coordinates().to_vec(), chain.joints().to_vec());
        Chain::new(("r", "base", "tip"), parts.0, parts.1, home)
    }

    #[test]
    fn a_home_pose_that_is_no_rotation_is_refused_and_a_rounded_one_is_not() {
        assert_eq!(with_home(|r, _| *r *= 1.1).unwrap_err(), ChainError::HomeNotARotation);
        assert_eq!(with_home(|r, _| r.swap_columns(0, 1)).unwrap_err(), ChainError::HomeNotARotation);
        assert_eq!(with_home(|r, _| r.fill(0.0)).unwrap_err(), ChainError::HomeNotARotation);
        assert!(with_home(|r, _| r.iter_mut().for_each(|x| *x = (*x * 1e3).round() / 1e3)).is_ok());
    }

    #[test]
    fn what_lies_absurdly_far_is_named() {
        let error = with_home(|_, t| t.x = 1e155).unwrap().within_reach().unwrap_err().to_string();
        assert!(error.starts_with("the tip lies 1.000e155 m from the base"), "{error}");
        assert!(with_home(|_, t| t.x = 1e3).unwrap().within_reach().is_ok());
    }
}
