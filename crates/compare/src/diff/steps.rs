//! A tip's path from the root in both robots, joint by joint, in a's gauge.
//!
//! ```text
//! a   t_a = A1(q) ··· An(q) t                 Ai = exp([Si] vi)
//! b   t_b = C1(q) ··· Cn(q) t'                Ci = D(i-1)⁻¹ exp([S'i] v'i) Di
//! ```
//! with Di the motion from a's body i to b's (see `alignment`), so that Ci = Ai where nothing changed.

use crate::diff::Options;
use crate::diff::alignment::Alignment;
use crate::diff::joints::{AS_IS, Reparametrised};
use crate::mechanism::{Drive, Interval, Mechanism};
use denavit_model::nalgebra::{Point3, Vector6};
use denavit_model::se3::{self, Pose};
use denavit_model::{Chain, ChainJoint, CompiledChain, Coordinate, Quantity, Screw};
use std::collections::HashMap;

/// A screw axis and what moves it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Motor {
    pub screw: Screw,
    pub drive: Drive,
}

/// One joint of the path; `None` if one of the two lacks the joint or holds it at 0.
#[derive(Debug, Clone)]
pub(crate) struct Step {
    pub a: Option<Motor>,
    /// b's axis as carried by a's link: Ad(D(i-1)⁻¹) S'.
    pub b: Option<Motor>,
    /// D(i-1)⁻¹ Di.
    pub carried: Pose,
    /// b's axis relative to its child link: Ad(Di⁻¹) S'.
    pub behind: Vector6<f64>,
    /// Nothing changed at this joint, to rounding.
    pub still: bool,
}

/// The way to a tip.
#[derive(Debug, Clone)]
pub(crate) struct TipPath {
    pub steps: Vec<Step>,
    /// The tip in a, root frame at zero, m.
    pub tip_a: Point3<f64>,
    /// The tip in b, taken back by Dn, m.
    pub tip_b: Point3<f64>,
}

/// The coordinates of both robots, and their ranges.
pub(crate) struct Space {
    pub intervals: Vec<Interval>,
    /// For each coordinate of b: index, factor and offset: q_b = sense · q\[index\] + shift.
    of_b: Vec<(usize, Reparametrised)>,
}

impl Space {
    /// Paired joints share a coordinate, whose range is the intersection of both.
    pub fn new(a: &Mechanism, b: &Mechanism, at: &Alignment, runs: &[Reparametrised], options: &Options) -> Self {
        let mut intervals = a.coordinates.clone();
        let mut of_b = Vec::new();
        let named = b.joint_indices();
        for interval in &b.coordinates {
            let own = named.get(interval.name.as_str()).and_then(|joint| at.joint_a[*joint]);
            let shared = own.and_then(|joint| {
                let drive = a.joints[joint].drive.filter(|_| a.joints[joint].mimic.is_none())?;
                Some((drive.coordinate, joint))
            });
            let Some((index, joint)) = shared else {
                of_b.push((intervals.len(), AS_IS));
                intervals.push(interval.clone());
                continue;
            };
            let run = if options.up_to_zeros { runs[joint] } else { AS_IS };
            of_b.push((index, run));
            narrow(&mut intervals[index], interval, run);
        }
        for interval in &mut intervals {
            let named = options.q_range.iter().find(|range| range.joint.as_deref() == Some(interval.name.as_str()));
            if let Some(range) = named.or_else(|| options.q_range.iter().find(|range| range.joint.is_none())) {
                (interval.lower, interval.upper) = (range.lower.min(range.upper), range.lower.max(range.upper));
            }
        }
        Self { intervals, of_b }
    }

    fn drive_of_b(&self, drive: Drive) -> Drive {
        let (coordinate, run) = self.of_b[drive.coordinate];
        Drive { coordinate, scale: drive.scale * run.sense, offset: drive.offset + drive.scale * run.shift }
    }
}

/// The intersection of both intervals, if any.
fn narrow(interval: &mut Interval, other: &Interval, run: Reparametrised) {
    let (x, y) = ((other.lower - run.shift) * run.sense, (other.upper - run.shift) * run.sense);
    let (lower, upper) = if other.limited {
        (x.min(y).max(interval.lower), x.max(y).min(interval.upper))
    } else {
        (interval.lower, interval.upper)
    };
    if other.limited && !interval.limited {
        (interval.lower, interval.upper) = (x.min(y), x.max(y));
    } else if lower <= upper {
        (interval.lower, interval.upper) = (lower, upper);
    }
    interval.limited |= other.limited;
}

impl TipPath {
    /// The way to the tip that body `body` of a carries; `None` where the joints do not line up in both.
    pub fn new(
        a: &Mechanism,
        b: &Mechanism,
        at: &Alignment,
        space: &Space,
        body: usize,
        tips: (Point3<f64>, Point3<f64>),
    ) -> Option<Self> {
        let path_a = a.path(body.checked_sub(1));
        let path_b = b.path(at.body_b[body].checked_sub(1));
        let mut steps = Vec::new();
        let mut in_b = path_b.iter().copied().peekable();
        let mut carrier = at.moved[0];
        for joint in path_a {
            let Some(other) = at.joint_b[joint] else {
                steps.push(step(a, b, space, (Some(joint), None), &carrier, &carrier));
                continue;
            };
            while let Some(extra) = in_b.next_if(|next| at.joint_a[*next].is_none()) {
                steps.push(step(a, b, space, (None, Some(extra)), &carrier, &carrier));
            }
            in_b.next_if_eq(&other)?;
            steps.push(step(a, b, space, (Some(joint), Some(other)), &carrier, &at.moved[joint + 1]));
            carrier = at.moved[joint + 1];
        }
        for extra in in_b {
            if at.joint_a[extra].is_some() {
                return None;
            }
            steps.push(step(a, b, space, (None, Some(extra)), &carrier, &carrier));
        }
        Some(Self { steps, tip_a: tips.0, tip_b: carrier.inverse() * tips.1 })
    }

    /// Where both tips are at `q`, in a's root frame, m.
    pub fn tips_at(&self, q: &[f64]) -> (Point3<f64>, Point3<f64>) {
        let (mut one, mut other) = (self.tip_a, self.tip_b);
        for step in self.steps.iter().rev() {
            if let Some(motor) = &step.a {
                one = motor.moves(&one, motor.value(q));
            }
            if !step.still {
                other = step.carried * other;
            }
            if let Some(motor) = &step.b {
                other = motor.moves(&other, motor.value(q));
            }
        }
        (one, other)
    }

    /// How far apart the tips are at `q`, m.
    pub fn displacement(&self, q: &[f64]) -> f64 {
        let (one, other) = self.tips_at(q);
        (one - other).norm()
    }

    /// Both tips' paths for many configurations at once: a's, then b's, over the coordinates `used` in that order.
    ///
    /// `None` if a chain cannot express a drive: a mimic joint with multiplier 0.
    pub fn compiled(&self, used: &[usize]) -> Option<[CompiledChain; 2]> {
        let coordinates: Vec<Coordinate> =
            (0..used.len()).map(|k| Coordinate::unlimited(k.to_string(), Quantity::Angle)).collect();
        let places: HashMap<usize, usize> = used.iter().enumerate().map(|(place, used)| (*used, place)).collect();
        let joint = |motor: &Motor, carrier: &Pose| {
            let Drive { coordinate, scale, offset } = motor.drive;
            let coordinate = *places.get(&coordinate)?;
            Some(ChainJoint { name: String::new(), screw: motor.screw.moved(carrier), coordinate, scale, offset })
        };
        let (mut in_a, mut in_b, mut carrier) = (Vec::new(), Vec::new(), Pose::identity());
        for step in &self.steps {
            if let Some(motor) = &step.a {
                in_a.push(joint(motor, &Pose::identity())?);
            }
            if let Some(motor) = &step.b {
                in_b.push(joint(motor, &carrier)?);
            }
            carrier *= step.carried;
        }
        let chain = |joints: Vec<ChainJoint>, tip: Point3<f64>| {
            let chain = Chain::new(("", "", ""), coordinates.clone(), joints, se3::translation(tip.coords)).ok()?;
            Some(CompiledChain::new(&chain))
        };
        Some([chain(in_a, self.tip_a)?, chain(in_b, carrier * self.tip_b)?])
    }

    /// Indices of the coordinates that move the tip in a or in b, each once.
    pub fn coordinates(&self) -> Vec<usize> {
        let mut used: Vec<usize> =
            self.steps.iter().flat_map(|step| [step.a, step.b]).flatten().map(|motor| motor.drive.coordinate).collect();
        used.sort_unstable();
        used.dedup();
        used
    }
}

impl Motor {
    /// Joint value (rad, m) at `q`.
    pub fn value(&self, q: &[f64]) -> f64 {
        self.drive.scale * q[self.drive.coordinate] + self.drive.offset
    }

    /// exp(\[S\] value) applied to a point.
    #[inline]
    fn moves(&self, point: &Point3<f64>, value: f64) -> Point3<f64> {
        let (line, pitch) = match &self.screw {
            Screw::Prismatic(direction) => return point + direction.as_ref() * value,
            Screw::Revolute(line) => (line, 0.0),
            Screw::Helical { axis, pitch } => (axis, pitch.metres_per_radian()),
        };
        let u = line.direction.as_ref();
        let arm = point - line.point;
        let (sine, cosine) = value.sin_cos();
        let along = u * (u.dot(&arm) * (1.0 - cosine) + pitch * value);
        line.point + arm * cosine + u.cross(&arm) * sine + along
    }
}

fn step(
    a: &Mechanism,
    b: &Mechanism,
    space: &Space,
    joints: (Option<usize>, Option<usize>),
    carrier: &Pose,
    moved: &Pose,
) -> Step {
    let back = carrier.inverse();
    let motor_a = joints.0.and_then(|joint| {
        let joint = &a.joints[joint];
        Some(Motor { screw: joint.screw?, drive: joint.drive? })
    });
    let in_b = joints.1.and_then(|joint| {
        let joint = &b.joints[joint];
        Some(Motor { screw: joint.screw?, drive: space.drive_of_b(joint.drive?) })
    });
    let motor_b = in_b.map(|motor| Motor { screw: motor.screw.moved(&back), drive: motor.drive });
    let carried = back * moved;
    let behind = in_b.map_or_else(Vector6::zeros, |motor| motor.screw.moved(&moved.inverse()).twist());
    let (turned, shifted) = se3::difference(&Pose::identity(), &carried);
    let same = match (&motor_a, &motor_b) {
        (None, None) => true,
        (Some(one), Some(other)) => {
            let twists = (one.screw.twist() - other.screw.twist()).norm().max((one.screw.twist() - behind).norm());
            let drives = (one.drive.scale - other.drive.scale).abs() + (one.drive.offset - other.drive.offset).abs();
            one.drive.coordinate == other.drive.coordinate && drives < 1e-14 && twists < STILL * (1.0 + a.size)
        }
        _ => false,
    };
    let still = same && turned < STILL && shifted < STILL * (1.0 + a.size);
    Step { a: motor_a, b: motor_b, carried: if still { Pose::identity() } else { carried }, behind, still }
}

/// Changes below this (rad, or relative to the robot's size) are rounding and are not followed.
const STILL: f64 = 1e-14;
