//! The frames of a compiled chain: z on each axis, x across neighbouring axes, so that most numbers between them vanish.

use crate::chain::{Chain, ChainJoint};
use crate::screw::{AxisLine, Screw};
use crate::se3::{self, Pose};
use nalgebra::{Matrix3, Point3, Rotation3, Unit, Vector3};
use std::f64::consts::FRAC_PI_2;

/// Directions closer than this to parallel or perpendicular (rad) are so up to rounding.
///
/// Each frame is measured from the actual frame before it, so dropped errors do not accumulate.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

/// Above this sine of the angle between neighbours the next frame's origin is moved along its axis until the offset
/// along y vanishes. Below, the place where it does would be far away and cost digits.
const OBLIQUE: f64 = 0.1;

/// Relation of the next axis to this one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Twist {
    /// Parallel: alpha = 0.
    Parallel,
    /// Perpendicular: alpha = π/2.
    Square,
    /// Any angle between.
    Oblique {
        /// cos alpha.
        cosine: f64,
        /// sin alpha.
        sine: f64,
    },
}

/// The step from one frame to the next, without the joint: Rz(theta) T(offset) Rx(alpha).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Step {
    /// Whole quarter turns of theta, 0 to 3.
    pub quarters: u64,
    /// Cosine and sine of the remainder of theta, in \[-π/4, π/4\].
    pub rest: (f64, f64),
    /// Offset in the frame turned by theta, m: along x (the length a), y (mostly 0), z (the offset d).
    pub offset: [f64; 3],
    /// alpha.
    pub twist: Twist,
}

/// The start, one step after each joint, and the turn about z from the last frame to the tip's.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Frames {
    pub start: Pose,
    /// With each step, whether the frame's z points along the joint's positive direction (1) or against it (-1).
    pub steps: Vec<(f64, Step)>,
    /// Cosine and sine of the last turn, where there is one.
    pub last_turn: Option<(f64, f64)>,
}

/// What the next frame is put on.
enum Target<'a> {
    /// A line of either sense.
    Line(&'a AxisLine),
    /// A direction of either sense.
    Direction(&'a Unit<Vector3<f64>>),
    /// The tip: axis and place are given.
    Tip(&'a Pose),
}

impl<'a> From<&'a ChainJoint> for Target<'a> {
    fn from(joint: &'a ChainJoint) -> Self {
        match &joint.screw {
            Screw::Prismatic(direction) => Self::Direction(direction),
            Screw::Revolute(line) | Screw::Helical { axis: line, .. } => Self::Line(line),
        }
    }
}

impl Target<'_> {
    /// Its direction, turned to within a quarter turn of `z` where either sense will do, and the sense.
    fn direction(&self, z: &Vector3<f64>) -> (Vector3<f64>, f64) {
        let free = match self {
            Self::Line(line) => line.direction,
            Self::Direction(direction) => **direction,
            Self::Tip(pose) => return (pose.rotation * Vector3::z(), 1.0),
        };
        let sense = if z.dot(&free) < -ROUNDING { -1.0 } else { 1.0 };
        (free.into_inner() * sense, sense)
    }

    fn point(&self, reference: &Vector3<f64>) -> Vector3<f64> {
        match self {
            Self::Line(line) => line.nearest_to(&Point3::from(*reference)).coords,
            Self::Direction(_) => *reference,
            Self::Tip(pose) => pose.translation.vector,
        }
    }
}

impl Frames {
    /// The frames of a chain at home.
    pub fn of(chain: &Chain) -> Self {
        let tip = Target::Tip(chain.home());
        let mut targets = chain.joints().iter().map(Target::from).chain([tip]);
        let mut sense = 1.0;
        let mut frame = Pose::identity();
        if let Some(first) = targets.next() {
            let direction;
            (direction, sense) = first.direction(&Vector3::z());
            frame = start(&direction, first.point(&Vector3::zeros()));
        }
        let start = frame;
        let mut steps = Vec::with_capacity(chain.joints().len());
        for target in targets {
            let (direction, next_sense) = target.direction(&(frame.rotation * Vector3::z()));
            let step = Step::to(&frame, &direction, &target);
            frame *= step.pose();
            frame.rotation = se3::orthonormalised(&frame.rotation);
            steps.push((sense, step));
            sense = next_sense;
        }
        let left = frame.rotation.inverse() * chain.home().rotation;
        let (cosine, sine) = (left[(0, 0)], left[(1, 0)]);
        let last_turn = (cosine < 0.0 || sine.abs() > ROUNDING).then_some((cosine, sine));
        if chain.joints().is_empty() {
            return Self { start: *chain.home(), steps, last_turn: None };
        }
        Self { start, steps, last_turn }
    }
}

/// The first frame: that of the base where the axis is along z, else x square to both.
fn start(direction: &Vector3<f64>, point: Vector3<f64>) -> Pose {
    let across = Vector3::z().cross(direction);
    let Some(x) = Unit::try_new(across, ROUNDING) else { return se3::translation(point) };
    let y = direction.cross(&x);
    se3::pose(Rotation3::from_matrix_unchecked(Matrix3::from_columns(&[*x, y, *direction])), point)
}

impl Step {
    fn to(frame: &Pose, direction: &Vector3<f64>, target: &Target) -> Self {
        let to_local = frame.rotation.inverse();
        let u = to_local * direction;
        let offset = to_local * (target.point(&frame.translation.vector) - frame.translation.vector);
        let sine = u.x.hypot(u.y);
        if sine <= ROUNDING && u.z > 0.0 {
            return Self::parallel(&to_local, offset, target);
        }
        // x along z × u; where the two are opposite any x will do.
        let (x, y) = if sine <= ROUNDING { (1.0, 0.0) } else { (-u.y / sine, u.x / sine) };
        let (quarters, rest) = quarters_and_rest(x, y);
        let offset = [x * offset.x + y * offset.y, x * offset.y - y * offset.x, offset.z];
        let twist = if u.z.abs() <= ROUNDING {
            Twist::Square
        } else {
            Twist::Oblique { cosine: u.z, sine: sine.copysign(1.0) }
        };
        let offset = match (target, twist) {
            (Target::Line(_), Twist::Square) => [offset[0], 0.0, offset[2]],
            (Target::Line(_), Twist::Oblique { cosine, sine }) if sine > OBLIQUE => {
                [offset[0], 0.0, offset[2] + offset[1] / sine * cosine]
            }
            _ => offset,
        };
        Self { quarters, rest, offset: offset.map(|length| length + 0.0), twist }
    }

    /// x is free: across the two lines where that is a matter of quarter turns, else where it was; the tip's for the tip.
    fn parallel(to_local: &Rotation3<f64>, offset: Vector3<f64>, target: &Target) -> Self {
        let (x, y) = match target {
            Target::Tip(pose) => {
                let x = to_local * (pose.rotation * Vector3::x());
                let length = x.x.hypot(x.y);
                (x.x / length, x.y / length)
            }
            Target::Line(_) if offset.x.abs() <= ROUNDING * offset.y.abs() => (0.0, 1.0),
            _ => (1.0, 0.0),
        };
        let (quarters, rest) = quarters_and_rest(x, y);
        let along = if matches!(target, Target::Tip(_)) { offset.z } else { 0.0 };
        let offset = [x * offset.x + y * offset.y, x * offset.y - y * offset.x, along];
        Self { quarters, rest, offset: offset.map(|length| length + 0.0), twist: Twist::Parallel }
    }

    /// Rz(theta) T(offset) Rx(alpha).
    pub fn pose(&self) -> Pose {
        let (cosine, sine) = self.turn();
        let turn = Matrix3::new(cosine, -sine, 0.0, sine, cosine, 0.0, 0.0, 0.0, 1.0);
        let (cosine, sine) = match self.twist {
            Twist::Parallel => (1.0, 0.0),
            Twist::Square => (0.0, 1.0),
            Twist::Oblique { cosine, sine } => (cosine, sine),
        };
        let twist = Matrix3::new(1.0, 0.0, 0.0, 0.0, cosine, -sine, 0.0, sine, cosine);
        se3::pose(Rotation3::from_matrix_unchecked(turn * twist), turn * Vector3::from(self.offset))
    }

    /// Cosine and sine of theta.
    fn turn(&self) -> (f64, f64) {
        let (cosine, sine) = self.rest;
        match self.quarters {
            0 => (cosine, sine),
            1 => (-sine, cosine),
            2 => (-cosine, -sine),
            _ => (sine, -cosine),
        }
    }
}

/// The angle of the unit vector (x, y) as whole quarter turns and the cosine and sine of what is left.
fn quarters_and_rest(x: f64, y: f64) -> (u64, (f64, f64)) {
    let quarters = (y.atan2(x) / FRAC_PI_2).round().rem_euclid(4.0);
    let (quarters, (cosine, sine)) = match quarters {
        q if q < 0.5 => (0, (x, y)),
        q if q < 1.5 => (1, (y, -x)),
        q if q < 2.5 => (2, (-x, -y)),
        _ => (3, (-y, x)),
    };
    if sine.abs() <= ROUNDING { (quarters, (1.0, 0.0)) } else { (quarters, (cosine, sine)) }
}
