//! Ortho-parallel arms with a spherical wrist, given by seven lengths.

use denavit_model::chain::{Chain, ChainError, ChainJoint, Coordinate, Quantity};
use denavit_model::nalgebra::{Matrix3, Point3, Rotation3, Unit, Vector3};
use denavit_model::screw::{AxisLine, Screw};
use denavit_model::se3::{self, Pose};
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use thiserror::Error;

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

/// The parameters of an arm, and the remaining errors.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OpwFit {
    /// The parameters.
    pub parameters: OrthoParallelWrist,
    /// Largest distance of the tips over [`CONFIGURATIONS`] joint values, m.
    pub position_error: f64,
    /// Largest rotation between the tips over the same joint values, rad.
    pub rotation_error: f64,
}

/// How many joint values, spread over ±π, a fit is evaluated at.
pub const CONFIGURATIONS: usize = 500;

/// Why an arm has no such parameters.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum OpwError {
    /// Other joints.
    #[error(
        "the OPW form needs six revolute joints, each with its own coordinate and scale 1 or -1, but the chain from \"{base}\" to \"{tip}\" has {found}"
    )]
    Joints {
        /// Base link.
        base: String,
        /// Tip link.
        tip: String,
        /// What it has.
        found: String,
    },
    /// The axes are arranged differently.
    #[error("{0}")]
    Axes(String),
    /// The parameters do not form a chain.
    #[error(transparent)]
    Chain(#[from] ChainError),
}

/// Axes may deviate from perpendicular and parallel by this, rad; beyond it the arm is of another kind.
const ANGLE: f64 = 0.02;

/// Lines may miss each other by this, times the robot's size; beyond it the arm is of another kind.
const MISS: f64 = 0.02;

/// Numbers closer than this to a multiple of a quarter turn, or to 0, are it (rad, and times the robot's size).
const ROUNDING: f64 = 1e-12;

fn tidy_angle(angle: f64) -> f64 {
    let wrapped = angle - TAU * (angle / TAU).round();
    let wrapped = if wrapped <= -PI + ROUNDING { wrapped + TAU } else { wrapped };
    let quarter = (wrapped / FRAC_PI_2).round() * FRAC_PI_2;
    if (wrapped - quarter).abs() < ROUNDING { quarter + 0.0 } else { wrapped }
}

impl OpwFit {
    /// The parameters of an arm that moves as a chain does from its base to its tip frame.
    ///
    /// The base frame has its z on axis 1 and the tip frame its z on axis 6, as the form requires. An
    /// arm whose axes are nearly of this kind gets the parameters of the nearest one; the errors state how near.
    ///
    /// # Errors
    /// The joints differ, or the axes are far from this kind.
    ///
    /// # Validation
    /// tests/opw.rs: every published set of parameters comes back, with its arm to 1e-12 of its size.
    pub fn of(chain: &Chain) -> Result<Self, OpwError> {
        let parameters = parameters(chain)?;
        let own = parameters.chain(chain.name())?;
        let (mut position_error, mut rotation_error) = (0.0f64, 0.0f64);
        for index in 0..CONFIGURATIONS {
            let value = |joint: usize| (0.5 + (index as f64 + 1.0) * (joint as f64 + 2.3).sqrt()).fract() * TAU - PI;
            let q: Vec<f64> = (0..6).map(value).collect();
            let (turned, moved) = se3::difference(&chain.fk(&q), &own.fk(&q));
            (position_error, rotation_error) = (position_error.max(moved), rotation_error.max(turned));
        }
        Ok(Self { parameters, position_error, rotation_error })
    }
}

/// Axes in the sense in which the coordinates count, and the tip, all at coordinates 0.
struct Arm {
    directions: [Vector3<f64>; 6],
    points: [Vector3<f64>; 6],
    tip: Pose,
    size: f64,
    names: (String, String),
}

impl Arm {
    fn of(chain: &Chain) -> Result<Self, OpwError> {
        let own = |(index, joint): (usize, &ChainJoint)| joint.coordinate == index && joint.scale.abs() == 1.0;
        let revolute = chain.joints().iter().filter(|joint| matches!(joint.screw, Screw::Revolute(_))).count();
        let count = chain.joints().len();
        let names = (chain.base().to_owned(), chain.tip().to_owned());
        if count != 6 || revolute != 6 || !chain.joints().iter().enumerate().all(own) {
            let found = format!("{count} joints, {revolute} of them revolute");
            return Err(OpwError::Joints { base: names.0, tip: names.1, found });
        }
        let (mut directions, mut points) = ([Vector3::zeros(); 6], [Vector3::zeros(); 6]);
        let mut moved = Pose::identity();
        for (index, joint) in chain.joints().iter().enumerate() {
            if let Some(line) = joint.screw.moved(&moved).line() {
                directions[index] = line.direction.into_inner() * joint.scale;
                points[index] = line.point.coords;
            }
            moved *= joint.screw.motion(joint.offset);
        }
        Ok(Self { directions, points, tip: moved * chain.home(), size: chain.size(), names })
    }

    /// Refuses an angle or distance that is not nearly 0.
    fn check(&self, angle: f64, miss: f64, what: impl Fn() -> String) -> Result<(), OpwError> {
        if angle.abs() <= ANGLE && miss.abs() <= MISS * self.size { Ok(()) } else { Err(OpwError::Axes(what())) }
    }

    /// The point nearest to axes 4, 5 and 6, and how far the farthest is.
    fn wrist(&self) -> Option<(Vector3<f64>, f64)> {
        let (mut normal, mut right) = (Matrix3::zeros(), Vector3::zeros());
        for k in 3..6 {
            let across = Matrix3::identity() - self.directions[k] * self.directions[k].transpose();
            normal += across;
            right += across * self.points[k];
        }
        let centre = normal.try_inverse()? * right;
        let miss = |k: usize| {
            let to = centre - self.points[k];
            (to - self.directions[k] * to.dot(&self.directions[k])).norm()
        };
        Some((centre, (3..6).map(miss).fold(0.0, f64::max)))
    }
}

fn parameters(chain: &Chain) -> Result<OrthoParallelWrist, OpwError> {
    let arm = Arm::of(chain)?;
    let [u1, u2, u3, u4, u5, u6] = arm.directions;
    let [p1, p2, p3, ..] = arm.points;
    let z = Vector3::z();
    let (base, tip) = (&arm.names.0, &arm.names.1);
    let sign = |value: f64| if value < 0.0 { -1.0 } else { 1.0 };
    arm.check(u1.cross(&z).norm(), (p1 - z * p1.dot(&z)).norm(), || {
        format!("axis 1 is not the z axis of \"{base}\", as the form requires; choose another ‹base›")
    })?;
    arm.check(u2.z, 0.0, || "axis 2 is not perpendicular to axis 1".to_owned())?;
    arm.check(u3.cross(&u2).norm(), 0.0, || "axis 3 is not parallel to axis 2".to_owned())?;
    let (wrist, miss) = arm.wrist().ok_or_else(|| OpwError::Axes("axes 4, 5 and 6 are parallel".to_owned()))?;
    arm.check(0.0, miss, || format!("axes 4, 5 and 6 do not meet in a point: the distance is {:.1} mm", miss * 1e3))?;
    arm.check(u4.dot(&u3), 0.0, || "axis 4 is not perpendicular to axis 3".to_owned())?;
    arm.check(u5.dot(&u4), 0.0, || "axis 5 is not perpendicular to axis 4".to_owned())?;
    arm.check(u6.dot(&u5), 0.0, || "axis 6 is not perpendicular to axis 5".to_owned())?;
    let tip_z = arm.tip.rotation.matrix().column(2).into_owned();
    let to_tip = arm.tip.translation.vector - wrist;
    arm.check(tip_z.cross(&u6).norm(), (to_tip - u6 * to_tip.dot(&u6)).norm(), || {
        format!("axis 6 is not the z axis of \"{tip}\", as the form requires; choose another ‹tip›")
    })?;
    // Axis 1 turns about z by t1 at coordinate 0, and so on: offsets are the negative.
    let way = |sense: f64| {
        let y = Vector3::new(sense * u2.x, sense * u2.y, 0.0).normalize();
        (sense, (-y.x).atan2(y.y), Vector3::new(y.y, -y.x, 0.0), y)
    };
    let forward = |(_, _, x, _): &(f64, f64, Vector3<f64>, Vector3<f64>)| p2.dot(x);
    let ways = [way(1.0), way(-1.0)];
    let prefer_first = if forward(&ways[0]).abs() > ROUNDING * arm.size {
        forward(&ways[0]) > 0.0
    } else {
        ways[0].1.abs() <= ways[1].1.abs() + ROUNDING
    };
    let (s2, t1, x, y) = if prefer_first { ways[0] } else { ways[1] };
    let elbow = p3 - p2;
    let (elbow_x, elbow_z) = (elbow.dot(&x), elbow.z);
    let t2 = elbow_x.atan2(elbow_z);
    let to_wrist = wrist - p3;
    let (wrist_x, wrist_z) = (to_wrist.dot(&x), to_wrist.z);
    // Along the forearm the wrist lies ahead.
    let along = u4.dot(&x) * wrist_x + u4.z * wrist_z;
    let s4 = sign(along);
    let (f_x, f_z) = (s4 * u4.dot(&x), s4 * u4.z);
    let t23 = f_x.atan2(f_z);
    let (sine, cosine) = (t23.sin(), t23.cos());
    let (x_f, z_f) = (x * cosine - z * sine, x * sine + z * cosine);
    let forearm = Matrix3::from_columns(&[x_f, y, z_f]);
    let v5 = forearm.transpose() * u5;
    let turned = |sense: f64| (-sense * v5.x).atan2(sense * v5.y);
    let s5 = if turned(1.0).abs() <= turned(-1.0).abs() + ROUNDING { 1.0 } else { -1.0 };
    let t4 = turned(s5);
    let hand = forearm * se3::rotation_about(&z, t4).matrix();
    let s6 = sign(tip_z.dot(&u6));
    let v6 = hand.transpose() * u6 * s6;
    let t5 = v6.x.atan2(v6.z);
    let last = hand * se3::rotation_about(&Vector3::y(), t5).matrix();
    let turn = last.transpose() * arm.tip.rotation.matrix();
    let t6 = turn[(1, 0)].atan2(turn[(0, 0)]);
    let tidy = |length: f64| if length.abs() < ROUNDING * arm.size { 0.0 } else { length };
    Ok(OrthoParallelWrist {
        a1: tidy(p2.dot(&x)),
        a2: tidy(wrist_x * cosine - wrist_z * sine),
        b: tidy(wrist.dot(&y)),
        c1: tidy(p2.z),
        c2: tidy(elbow_x.hypot(elbow_z)),
        c3: tidy(wrist_x * sine + wrist_z * cosine),
        c4: tidy(to_tip.dot(&tip_z)),
        offsets: [t1, t2, t23 - t2, t4, t5, t6].map(|angle| tidy_angle(-angle)),
        signs: [sign(u1.z), s2, s2 * sign(u3.dot(&u2)), s4, s5, s6],
    })
}
