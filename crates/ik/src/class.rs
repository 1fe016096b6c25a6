//! The closed form of an arm, found from its screw axes.

use crate::arm::SixR;
use denavit_model::nalgebra::{Matrix3, Vector3};

/// Axes that deviate from parallel by less than this, rad, are solved as parallel; the solutions are then refined for the real axes.
///
/// Calibrated arms deviate by up to about 10 mrad; from 50 mrad on, branches near singularities get lost.
const PARALLEL_WITHIN: f64 = 0.03;

/// Axes that miss a common point by less than this share of the arm's size are solved as if they met.
const MEET_WITHIN: f64 = 0.01;

/// Neighbouring axes of a wrist closer to parallel than this, rad, give it no second degree of freedom.
const DEGENERATE: f64 = 0.05;

/// The closed form of an arm with six revolute joints.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Class {
    /// The last three axes meet in a point.
    SphericalWrist,
    /// The first three axes meet in a point: a spherical wrist seen from the tip.
    SphericalShoulder,
    /// Joints 2, 3 and 4 are parallel (Universal Robots).
    ParallelShoulder,
    /// Joints 3, 4 and 5 are parallel: the same seen from the tip.
    ParallelWrist,
    /// None of these: all real solutions by elimination.
    General,
}

impl std::fmt::Display for Class {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::SphericalWrist => "axes 4, 5 and 6 meet in a point",
            Self::SphericalShoulder => "axes 1, 2 and 3 meet in a point",
            Self::ParallelShoulder => "axes 2, 3 and 4 are parallel",
            Self::ParallelWrist => "axes 3, 4 and 5 are parallel",
            Self::General => "no three neighbouring axes are parallel or meet in a point",
        })
    }
}

/// An arm made exactly of its class, from the end at which the class stands as in [`Class::SphericalWrist`] or
/// [`Class::ParallelShoulder`].
#[derive(Debug, Clone)]
pub(crate) struct Drawn {
    pub arm: SixR,
    pub class: Class,
    /// Deviation of the real axes from parallel, rad.
    pub angle: f64,
    /// Distance of the real axes from the common point, m.
    pub distance: f64,
}

impl Drawn {
    pub fn of(arm: &SixR, size: f64) -> Self {
        let reversed = arm.reversed();
        let found = [
            wrist(arm, size, Class::SphericalWrist),
            parallel(arm, Class::ParallelShoulder),
            wrist(&reversed, size, Class::SphericalShoulder),
            parallel(&reversed, Class::ParallelWrist),
        ];
        let misses = |drawn: &Self| (drawn.angle / PARALLEL_WITHIN).max(drawn.distance / (MEET_WITHIN * size));
        // Rounding alone must not choose among classes that hold exactly: the first of the list then.
        let rank = |drawn: &Self| if misses(drawn) < 1e-9 { 0.0 } else { misses(drawn) };
        found
            .into_iter()
            .flatten()
            .filter(|drawn| misses(drawn) < 1.0)
            .min_by(|a, b| rank(a).total_cmp(&rank(b)))
            .unwrap_or(Self { arm: arm.clone(), class: Class::General, angle: 0.0, distance: 0.0 })
    }

    /// Whether joint values are those of the arm seen from its tip.
    pub fn is_reversed(&self) -> bool {
        matches!(self.class, Class::SphericalShoulder | Class::ParallelWrist)
    }
}

/// The arm with its last three axes through their common point, if they nearly have one.
fn wrist(arm: &SixR, size: f64, class: Class) -> Option<Drawn> {
    let [.., a, b, c] = &arm.axes;
    let bends = |one: &Vector3<f64>, other: &Vector3<f64>| one.cross(other).norm() > DEGENERATE;
    if !bends(&a.direction, &b.direction) || !bends(&b.direction, &c.direction) {
        return None;
    }
    // The point with the least sum of squared distances: Σ (I - u uᵀ) (x - p) = 0.
    let (mut matrix, mut right) = (Matrix3::zeros(), Vector3::zeros());
    for axis in [a, b, c] {
        let across = Matrix3::identity() - axis.direction * axis.direction.transpose();
        matrix += across;
        right += across * axis.point;
    }
    let centre = matrix.try_inverse()? * right;
    let distance = [a, b, c].iter().map(|axis| axis.distance_to(&centre)).fold(0.0, f64::max);
    // A point far beyond the arm is no wrist.
    if (centre - arm.home.translation.vector).norm() > 2.0 * size {
        return None;
    }
    let mut drawn = arm.clone();
    for axis in &mut drawn.axes[3..] {
        axis.point = centre;
    }
    Some(Drawn { arm: drawn, class, angle: 0.0, distance })
}

/// The arm with axes 2, 3 and 4 parallel to their mean, if they nearly are; the sense of each is kept.
fn parallel(arm: &SixR, class: Class) -> Option<Drawn> {
    let reference = arm.axes[1].direction;
    let sense = |k: usize| if arm.axes[k].direction.dot(&reference) < 0.0 { -1.0 } else { 1.0 };
    let mean = (1..4).map(|k| arm.axes[k].direction * sense(k)).sum::<Vector3<f64>>().try_normalize(0.0)?;
    let angle = (1..4).map(|k| arm.axes[k].direction.cross(&mean).norm()).fold(0.0, f64::max);
    let bends = |one: &Vector3<f64>| one.cross(&mean).norm() > DEGENERATE;
    if !bends(&arm.axes[0].direction) || !bends(&arm.axes[4].direction) {
        return None;
    }
    let mut drawn = arm.clone();
    for k in 1..4 {
        drawn.axes[k].direction = mean * sense(k);
    }
    Some(Drawn { arm: drawn, class, angle, distance: 0.0 })
}
