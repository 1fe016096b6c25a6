//! What changed about one joint, in words and numbers.

use crate::comparison::{Change, JointChange};
use crate::diff::alignment::{Alignment, least_motion};
use crate::diff::features::axes_apart;
use crate::diff::{Options, Scope};
use crate::mechanism::{Mechanism, MovingJoint};
use crate::words;
use denavit_model::Screw;
use denavit_model::nalgebra::Point3;
use denavit_model::se3::{self, Pose};
use std::collections::{HashMap, HashSet};

/// The relation of a joint of b to its counterpart in a: q_b = sense · q_a + shift.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Reparametrised {
    pub sense: f64,
    pub shift: f64,
}

/// The identity.
pub(crate) const AS_IS: Reparametrised = Reparametrised { sense: 1.0, shift: 0.0 };

impl Reparametrised {
    /// One of b's joint values in those of a.
    fn value_in_a(self, value: f64) -> f64 {
        (value - self.shift) * self.sense
    }

    /// A range of b's joint values in those of a.
    fn range_in_a(self, (lower, upper): (f64, f64)) -> (f64, f64) {
        let (x, y) = ((lower - self.shift) * self.sense, (upper - self.shift) * self.sense);
        if self.sense < 0.0 { (y, x) } else { (x, y) }
    }
}

/// Everything that changed between joint `index` of a and its counterpart in b.
pub(crate) fn changes(
    a: &Mechanism,
    b: &Mechanism,
    at: &Alignment,
    names: &Names,
    runs: &[Reparametrised],
    index: usize,
    options: &Options,
) -> Vec<Change> {
    let Some(other) = at.joint_b[index] else {
        return vec![Change::counted(gone(a, names, index))];
    };
    let (one, two) = (&a.joints[index], &b.joints[other]);
    let mut found = Vec::new();
    let carrier = at.moved[one.parent.map_or(0, |parent| parent + 1)];
    let geometry = geometry(one, two, &carrier, &at.moved[index + 1], options);
    let free = |what: &JointChange| matches!(what, JointChange::SenseReversed | JointChange::ZeroShifted { .. });
    found.extend(
        geometry.changes.into_iter().map(|what| Change { counts: !(options.up_to_zeros && free(&what)), what }),
    );
    found.extend(kind(a, b, one, two).map(Change::counted));
    found.extend(scale(a, b, one, two));
    found.extend(carried(a, b, at, index, other).map(Change::counted));
    let run = if options.up_to_zeros { geometry.run } else { AS_IS };
    found.extend(limits(a, b, one, two, run, options));
    let runs = if options.up_to_zeros { runs } else { &[] };
    found.extend(mimic((a, b, at), names, runs, (index, other), options).map(Change::counted));
    if options.scope == Scope::Everything && !a.bare && !b.bare {
        found.extend(controller(one, two, run, options).into_iter().map(Change::counted));
    }
    found
}

/// Names of both robots, looked up for every joint.
pub(crate) struct Names<'a> {
    in_a: HashMap<&'a str, usize>,
    in_b: HashMap<&'a str, usize>,
    fixed_in_a: HashSet<&'a str>,
    fixed_in_b: HashSet<&'a str>,
}

impl<'a> Names<'a> {
    pub fn of(a: &'a Mechanism, b: &'a Mechanism) -> Self {
        let fixed = |mechanism: &'a Mechanism| {
            let names = mechanism.fixed.iter().flat_map(|(name, child)| [name.as_str(), child.as_str()]);
            names.collect()
        };
        Self { in_a: a.joint_indices(), in_b: b.joint_indices(), fixed_in_a: fixed(a), fixed_in_b: fixed(b) }
    }
}

/// Damping, friction and soft limits.
fn controller(one: &MovingJoint, two: &MovingJoint, run: Reparametrised, options: &Options) -> Vec<JointChange> {
    let mut found = Vec::new();
    let mut compare = |property: &'static str, from: Option<f64>, to: Option<f64>, tolerance: f64| {
        let same = match (from, to) {
            (Some(x), Some(y)) => (x - y).abs() <= tolerance,
            (None, None) => true,
            _ => false,
        };
        if !same {
            found.push(JointChange::PropertyChanged { property, from: words::stated(from), to: words::stated(to) });
        }
    };
    let relative = |x: f64| options.tolerance_mass * x.abs();
    let (x, y) = (one.dynamics, two.dynamics);
    compare("damping", Some(x.damping), Some(y.damping), relative(x.damping));
    compare("friction", Some(x.friction), Some(y.friction), relative(x.friction));
    let position =
        if matches!(one.screw, Some(Screw::Prismatic(_))) { options.tolerance_m } else { options.tolerance_rad };
    let (x, y) = (one.soft_limits, two.soft_limits);
    let from = x.and_then(|soft| soft.range);
    let to = y.and_then(|soft| soft.range).map(|range| run.range_in_a(range));
    let (sensor, now) = (one.calibration.unwrap_or_default(), two.calibration.unwrap_or_default());
    // Where the joint counts the other way, its sensor switches on where it switched off.
    let (rising, falling) = if run.sense < 0.0 { (now.falling, now.rising) } else { (now.rising, now.falling) };
    let in_a = |value: Option<f64>| value.map(|value| run.value_in_a(value));
    compare("calibration rising", sensor.rising, in_a(rising), position);
    compare("calibration falling", sensor.falling, in_a(falling), position);
    compare("calibration reference_position", sensor.reference_position, in_a(now.reference_position), position);
    compare("soft lower limit", from.map(|range| range.0), to.map(|range| range.0), position);
    compare("soft upper limit", from.map(|range| range.1), to.map(|range| range.1), position);
    let (x, y) = (x.map(|soft| soft.k_position), y.map(|soft| soft.k_position));
    compare("soft limit k_position", x, y, relative(x.unwrap_or(0.0)));
    let (x, y) = (one.soft_limits.map(|soft| soft.k_velocity), two.soft_limits.map(|soft| soft.k_velocity));
    compare("soft limit k_velocity", x, y, relative(x.unwrap_or(0.0)));
    found
}

/// The relation of joint `index` of b to its counterpart in a.
pub(crate) fn run(a: &Mechanism, b: &Mechanism, at: &Alignment, index: usize, options: &Options) -> Reparametrised {
    let (joint, carrier) = (&a.joints[index], at.moved[a.joints[index].parent.map_or(0, |parent| parent + 1)]);
    at.joint_b[index]
        .map_or(AS_IS, |other| geometry(joint, &b.joints[other], &carrier, &at.moved[index + 1], options).run)
}

fn gone(a: &Mechanism, names: &Names, index: usize) -> JointChange {
    let joint = &a.joints[index];
    let fixed = [&joint.name, &joint.child].iter().any(|name| names.fixed_in_b.contains(name.as_str()));
    if fixed { JointChange::KindChanged { from: joint.kind.clone(), to: "fixed".into() } } else { JointChange::Removed }
}

/// A joint that only b has.
pub(crate) fn new_in_b(b: &Mechanism, names: &Names, index: usize) -> JointChange {
    let joint = &b.joints[index];
    let fixed = [&joint.name, &joint.child].iter().any(|name| names.fixed_in_a.contains(name.as_str()));
    if fixed { JointChange::KindChanged { from: "fixed".into(), to: joint.kind.clone() } } else { JointChange::Added }
}

pub(crate) struct GeometryFound {
    pub changes: Vec<JointChange>,
    pub run: Reparametrised,
}

/// The axis relative to its carrier, then the child relative to the axis.
pub(crate) fn geometry(
    one: &MovingJoint,
    two: &MovingJoint,
    carrier: &Pose,
    moved: &Pose,
    options: &Options,
) -> GeometryFound {
    let mut result = GeometryFound { changes: Vec::new(), run: AS_IS };
    let back = carrier.inverse();
    let carried = back * moved;
    let (Some(screw), Some(screw_b)) = (&one.screw, &two.screw) else {
        let (rad, m) = se3::difference(&Pose::identity(), &carried);
        if rad > options.tolerance_rad || m > options.tolerance_m {
            result.changes.push(JointChange::LinkMoved { rad, m });
        }
        return result;
    };
    let (screw_b, origin_b) = (screw_b.moved(&back), back * two.origin);
    let (turned, distance, opposed) = axes_apart(screw, &one.origin, &screw_b, &origin_b);
    let screw_b = if opposed { screw_b.reversed() } else { screw_b };
    if turned > options.tolerance_rad {
        result.changes.push(JointChange::AxisTurned { rad: turned });
    }
    if distance > options.tolerance_m {
        result.changes.push(JointChange::AxisMoved { m: distance });
    }
    if opposed {
        result.changes.push(JointChange::SenseReversed);
        result.run.sense = -1.0;
    }
    let (rad, m) = displacement_near(&carried, &one.origin);
    if rad > options.tolerance_rad || m > options.tolerance_m {
        behind(&mut result, screw, &one.origin, &screw_b, &carried, options);
    }
    if let (Some(from), Some(to)) = (screw.pitch(), screw_b.pitch())
        && (from - to).abs() > options.tolerance_m
    {
        result.changes.push(JointChange::PitchChanged { from, to });
    }
    result
}

/// Angle of a motion, and how far it moves a point.
fn displacement_near(motion: &Pose, point: &Point3<f64>) -> (f64, f64) {
    (se3::rotation_angle(&motion.rotation), (motion * point - point).norm())
}

/// The part of a child link's motion that exceeds the motion of the axis.
fn behind(
    result: &mut GeometryFound,
    screw: &Screw,
    at: &Point3<f64>,
    screw_b: &Screw,
    carried: &Pose,
    options: &Options,
) {
    let least = least_motion(screw, at, screw_b);
    let rest = carried * least.inverse();
    let u = screw_b.direction().into_inner();
    let foot = least * screw.line().map_or(*at, |line| line.nearest_to(at));
    let turn = se3::rotation_vector(&rest.rotation);
    let (about, across) = (turn.dot(&u), (turn - u * turn.dot(&u)).norm());
    let step = rest * foot - foot;
    let (along, aside) = (step.dot(&u), (step - u * step.dot(&u)).norm());
    if screw.line().is_none() {
        shift(result, along, "m", options.tolerance_m);
        if aside > options.tolerance_m {
            result.changes.push(JointChange::AxisMoved { m: aside });
        }
        if turn.norm() > options.tolerance_rad {
            result.changes.push(JointChange::LinkMoved { rad: turn.norm(), m: 0.0 });
        }
        return;
    }
    // If only the axis was turned, its link stays: the minimal motion is then undone after it.
    if across > options.tolerance_rad || aside > options.tolerance_m {
        let turn = se3::rotation_vector(&carried.rotation);
        let (rad, m) = displacement_near(carried, at);
        shift(result, turn.dot(&u), "rad", options.tolerance_rad);
        result.changes.push(JointChange::LinkMoved { rad, m });
        return;
    }
    shift(result, about, "rad", options.tolerance_rad);
    let along = along - screw_b.pitch().unwrap_or(0.0) * about;
    if along.abs() > options.tolerance_m {
        result.changes.push(JointChange::SlidAlongAxis { m: along });
    }
}

fn shift(result: &mut GeometryFound, by: f64, unit: &'static str, tolerance: f64) {
    if by.abs() > tolerance {
        result.changes.push(JointChange::ZeroShifted { by, unit });
        // b has a's pose at zero when its value is reduced by the shift.
        result.run.shift = -result.run.sense * by;
    }
}

/// A table does not distinguish a continuous joint from one without limits.
fn kind(a: &Mechanism, b: &Mechanism, one: &MovingJoint, two: &MovingJoint) -> Option<JointChange> {
    let endless =
        |joint: &MovingJoint| joint.kind == "continuous" || (joint.kind == "revolute" && joint.limits.range.is_none());
    let unsaid = (a.bare || b.bare) && endless(one) && endless(two);
    (one.kind != two.kind && !unsaid).then(|| JointChange::KindChanged { from: one.kind.clone(), to: two.kind.clone() })
}

fn scale(a: &Mechanism, b: &Mechanism, one: &MovingJoint, two: &MovingJoint) -> Option<Change> {
    if !(a.bare || b.bare) || one.mimic.is_some() || two.mimic.is_some() {
        return None;
    }
    let (from, to) = (one.drive?.scale, two.drive?.scale);
    ((from - to).abs() > 1e-9 * from.abs()).then(|| Change::counted(JointChange::ScaleChanged { from, to }))
}

fn carried(a: &Mechanism, b: &Mechanism, at: &Alignment, index: usize, other: usize) -> Option<JointChange> {
    let paired = |joints: &[MovingJoint], paired: &[Option<usize>], mut joint: usize| loop {
        joint = joints[joint].parent?;
        if paired[joint].is_some() {
            return Some(joint);
        }
    };
    let in_a = paired(&a.joints, &at.joint_b, index);
    let in_b = paired(&b.joints, &at.joint_a, other);
    let name = |joints: &[MovingJoint], joint: Option<usize>| {
        joint.map_or_else(String::new, |joint| joints[joint].name.clone())
    };
    (in_a.and_then(|joint| at.joint_b[joint]) != in_b)
        .then(|| JointChange::CarriedByOther { from: name(&a.joints, in_a), to: name(&b.joints, in_b) })
}

fn limits(
    a: &Mechanism,
    b: &Mechanism,
    one: &MovingJoint,
    two: &MovingJoint,
    run: Reparametrised,
    options: &Options,
) -> Vec<Change> {
    // A table may be silent about limits altogether.
    let silent = |mechanism: &Mechanism, joint: &MovingJoint| mechanism.bare && joint.limits.range.is_none();
    if silent(a, one) || silent(b, two) {
        return Vec::new();
    }
    let slides = matches!(one.screw, Some(Screw::Prismatic(_)));
    let tolerance = if slides { options.tolerance_m } else { options.tolerance_rad };
    let from = one.limits.range;
    let to = two.limits.range.map(|range| run.range_in_a(range));
    let mut found = Vec::new();
    let mut compare = |limit, from: Option<f64>, to: Option<f64>, tolerance: f64, counts| {
        let same = match (from, to) {
            (Some(x), Some(y)) => (x - y).abs() <= tolerance,
            (None, None) => true,
            _ => false,
        };
        if !same {
            found.push(Change { what: JointChange::LimitChanged { limit, from, to }, counts });
        }
    };
    compare("lower", from.map(|range| range.0), to.map(|range| range.0), tolerance, true);
    compare("upper", from.map(|range| range.1), to.map(|range| range.1), tolerance, true);
    if options.scope == Scope::Everything {
        // Stated, though a joint that turns without end does not keep to them.
        let (x, y) = (one.idle_range, two.idle_range.map(|range| run.range_in_a(range)));
        compare("lower", x.map(|range| range.0), y.map(|range| range.0), tolerance, true);
        compare("upper", x.map(|range| range.1), y.map(|range| range.1), tolerance, true);
        let (x, y) = (one.limits, two.limits);
        for (limit, x, y) in [("velocity", x.velocity, y.velocity), ("effort", x.effort, y.effort)] {
            compare(limit, x, y, options.tolerance_mass * x.unwrap_or(0.0).abs(), true);
        }
    }
    found
}

/// Whether the joint mimics the same joint in the same way, in a's joint values; `runs` relates b's joints to those
/// of a (empty: identity).
///
/// With q_b = s q_a + z for driver (d) and follower (f), what b states as q_f = m q_d + o is, in a's values,
/// q_f = s_f m s_d q_d + s_f (m z_d + o - z_f).
fn mimic(
    (a, b, at): (&Mechanism, &Mechanism, &Alignment),
    names: &Names,
    runs: &[Reparametrised],
    (index, other): (usize, usize),
    options: &Options,
) -> Option<JointChange> {
    let (one, two) = (&a.joints[index], &b.joints[other]);
    let run = |joint: usize| runs.get(joint).copied().unwrap_or(AS_IS);
    let followed = || {
        let (driver, factor, offset) = a.driver(index, &names.in_a)?;
        let (driver_b, factor_b, offset_b) = b.driver(other, &names.in_b)?;
        let (s, z) = (run(driver), run(index));
        let factor_in_a = z.sense * factor_b * s.sense;
        let offset_in_a = z.sense * (factor_b * s.shift + offset_b - z.shift);
        let interval = a.coordinates.get(one.drive?.coordinate)?;
        let slides = matches!(one.screw, Some(Screw::Prismatic(_)));
        let tolerance = if slides { options.tolerance_m } else { options.tolerance_rad };
        let apart = |q: f64| {
            let (x, y) = (factor * q + offset, factor_in_a * q + offset_in_a);
            (x - y).abs() > tolerance.max(1e-9 * x.abs().max(1.0))
        };
        let same = at.joint_b[driver] == Some(driver_b);
        // A driver that cannot move does not determine the factor.
        let upper = if interval.upper - interval.lower > 1e-6 { interval.upper } else { interval.lower + 1.0 };
        Some(same && !apart(interval.lower) && !apart(upper))
    };
    let same = match (&one.mimic, &two.mimic) {
        (None, None) => true,
        (Some((driver, factor, offset)), Some((driver_b, factor_b, offset_b))) => followed().unwrap_or_else(|| {
            // Nothing moves it: what is stated is compared.
            let close = |x: f64, y: f64| (x - y).abs() <= 1e-9 * x.abs().max(1.0);
            let paired = names.in_a.get(driver.as_str()).and_then(|joint| at.joint_b[*joint]);
            let paired = paired.map(|joint| &b.joints[joint].name);
            (driver == driver_b || paired == Some(driver_b)) && close(*factor, *factor_b) && close(*offset, *offset_b)
        }),
        _ => false,
    };
    let words = |mimic: &Option<(String, f64, f64)>| match mimic {
        None => "free".to_owned(),
        Some((driver, factor, offset)) => format!("{factor} × \"{driver}\" + {offset}"),
    };
    (!same).then(|| JointChange::MimicChanged { from: words(&one.mimic), to: words(&two.mimic) })
}
