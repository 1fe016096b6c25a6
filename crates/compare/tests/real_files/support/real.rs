//! Edits that make it another robot, and what a comparison must say of each.

use super::chance::Chance;
use super::harmless::origin_of;
use denavit_compare::{Comparison, JointChange};
use denavit_model::nalgebra::{Unit, Vector3};
use denavit_model::robot::{Geometry, Joint};
use denavit_model::se3;
use denavit_model::{JointKind, Robot};

/// What was done to which joint (or link), and by how much.
pub struct Edit {
    pub what: What,
    /// The joint, or for a mass the link.
    pub name: String,
    pub by: f64,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub enum What {
    AxisTurned,
    OriginMoved,
    OriginTurned,
    ZeroShifted,
    SenseFlipped,
    Limit,
    Kind,
    Mass,
}

pub const KINDS: [What; 8] = [
    What::AxisTurned,
    What::OriginMoved,
    What::OriginTurned,
    What::ZeroShifted,
    What::SenseFlipped,
    What::Limit,
    What::Kind,
    What::Mass,
];

/// Edits a robot in place; `None` where it has nothing to do it to.
pub fn edit(robot: &mut Robot, what: What, chance: &mut Chance) -> Option<Edit> {
    if what == What::Mass {
        let mut links: Vec<_> =
            robot.links.iter_mut().filter(|link| link.inertial.as_ref().is_some_and(|i| i.mass > 0.0)).collect();
        let index = chance.below(links.len().max(1));
        let link = links.get_mut(index)?;
        let by = chance.magnitude(-4.0, 0.0);
        link.inertial.as_mut()?.mass *= 1.0 + by;
        return Some(Edit { what, name: link.name.clone(), by });
    }
    let one_value = |joint: &Joint| {
        matches!(joint.kind, JointKind::Revolute | JointKind::Continuous | JointKind::Prismatic | JointKind::Screw(_))
    };
    let before = robot.clone();
    let fits = |joint: &&mut Joint| match what {
        What::ZeroShifted | What::OriginTurned => one_value(joint) && !round_about_axis(&before, joint),
        What::Limit => one_value(joint) && joint.kind != JointKind::Continuous && joint.limits.range.is_some(),
        What::Kind => matches!(joint.kind, JointKind::Revolute | JointKind::Prismatic),
        _ => one_value(joint),
    };
    let mut joints: Vec<&mut Joint> = robot.joints.iter_mut().filter(fits).collect();
    let index = chance.below(joints.len().max(1));
    let joint = joints.get_mut(index)?;
    let name = joint.name.clone();
    let by = change(joint, what, chance);
    Some(Edit { what, name, by })
}

/// Whether all that a joint carries looks the same however it is turned about the joint's axis (a plain wheel): its
/// zero is then nowhere to be seen.
fn round_about_axis(robot: &Robot, joint: &Joint) -> bool {
    let link = &robot.links[joint.child];
    let on_axis = |xyz: [f64; 3]| Vector3::from(xyz).cross(&joint.axis).norm() < 1e-6;
    let shapes = link.visuals.iter().chain(&link.collisions).all(|shape| {
        // Angles such as 1.57075 leave a wheel round for all that anybody sees.
        let along = (shape.origin.pose().rotation * Vector3::z()).cross(&joint.axis).norm() < 1e-3;
        let round = match shape.geometry {
            Geometry::Sphere(_) => true,
            Geometry::Cylinder { .. } => along,
            _ => false,
        };
        round && on_axis(shape.origin.xyz)
    });
    let turned = se3::rotation_about(&joint.axis, 1.0);
    let mass = link.inertial.as_ref().is_none_or(|inertial| {
        let r = inertial.origin.pose().rotation;
        let tensor = r.matrix() * inertial.tensor * r.matrix().transpose();
        let change = turned.matrix() * tensor * turned.matrix().transpose() - tensor;
        on_axis(inertial.origin.xyz) && change.norm() <= 1e-4 * tensor.norm()
    });
    let weighs = link.inertial.as_ref().is_some_and(|inertial| inertial.mass != 0.0);
    let matter = weighs || !link.visuals.is_empty() || !link.collisions.is_empty();
    robot.joints_from(joint.child).next().is_none() && joint.kind != JointKind::Prismatic && matter && shapes && mass
}

fn change(joint: &mut Joint, what: What, chance: &mut Chance) -> f64 {
    let axis = joint.axis.into_inner();
    match what {
        What::AxisTurned => {
            let by = chance.magnitude(-5.0, -1.0);
            let across = Unit::new_normalize(axis.cross(&chance.direction()));
            joint.axis_written = Some((se3::rotation_about(&across, by) * axis).into());
            by
        }
        What::OriginMoved => {
            let by = chance.magnitude(-6.0, -1.0);
            let step = chance.direction().into_inner() * by;
            joint.origin.xyz = (Vector3::from(joint.origin.xyz) + step).into();
            by
        }
        What::OriginTurned => {
            let by = chance.magnitude(-5.0, -1.0);
            let turn = se3::pose(se3::rotation_about(&chance.direction(), by), Vector3::zeros());
            joint.origin = origin_of(&(joint.origin.pose() * turn));
            by
        }
        What::ZeroShifted => {
            let by = chance.magnitude(-5.0, -1.0);
            let shift = if joint.kind == JointKind::Prismatic {
                se3::translation(axis * by)
            } else {
                se3::pose(se3::rotation_about(&axis, by), Vector3::zeros())
            };
            joint.origin = origin_of(&(joint.origin.pose() * shift));
            by
        }
        What::SenseFlipped => {
            joint.axis_written = Some((-axis).into());
            0.0
        }
        What::Limit => {
            let by = chance.magnitude(-5.0, -1.0);
            let (lower, upper) = joint.limits.range.as_mut().unwrap();
            if chance.below(2) == 0 {
                *lower -= by;
            } else {
                *upper += by;
            }
            by
        }
        What::Kind => {
            joint.kind = match (&joint.kind, chance.below(3)) {
                (_, 0) => JointKind::Fixed,
                (JointKind::Prismatic, _) => JointKind::Revolute,
                (_, 1) => JointKind::Prismatic,
                _ => JointKind::Continuous,
            };
            0.0
        }
        What::Mass => 0.0,
    }
}

/// What is wrong with the answer; `None` where it names the joint and the magnitude to 1 %.
pub fn fault(edit: &Edit, found: &Comparison) -> Option<String> {
    let close = |value: f64| (value.abs() - edit.by.abs()).abs() <= 0.01 * edit.by.abs();
    if edit.what == What::Mass {
        let part = found.parts.iter().find(|part| part.part == format!("link \"{}\"", edit.name));
        return part.is_none().then(|| format!("mass of {} not found: {:?}", edit.name, found.parts));
    }
    let Some(joint) = found.joints.iter().find(|joint| joint.joint == edit.name) else {
        return Some(format!("{} is not named", edit.name));
    };
    let others: Vec<&String> =
        found.joints.iter().map(|other| &other.joint).filter(|name| **name != edit.name).collect();
    if !others.is_empty() && edit.what != What::Kind {
        return Some(format!("{others:?} are named, too"));
    }
    let changes = joint.changes.iter().map(|change| &change.what);
    let (mut turned, mut moved, mut zero, mut slid, mut limit, mut link) =
        (0.0f64, 0.0f64, 0.0f64, 0.0f64, 0.0f64, 0.0f64);
    let (mut reversed, mut kind) = (false, false);
    for change in changes {
        match change {
            JointChange::AxisTurned { rad } => turned = *rad,
            JointChange::AxisMoved { m } => moved = *m,
            JointChange::ZeroShifted { by, .. } => zero = *by,
            JointChange::LinkMoved { rad, .. } => link = *rad,
            JointChange::SlidAlongAxis { m } => slid = *m,
            JointChange::LimitChanged { from: Some(from), to: Some(to), .. } => limit = to - from,
            JointChange::SenseReversed => reversed = true,
            JointChange::KindChanged { .. } => kind = true,
            _ => {}
        }
    }
    let right = match edit.what {
        What::AxisTurned => close(turned) && moved == 0.0 && zero == 0.0,
        What::OriginMoved => close((moved * moved + slid * slid + zero * zero).sqrt()) && turned == 0.0,
        // The turn of the axis and the turn about it, put together again.
        What::OriginTurned => {
            let cosine = (0.5 * turned).cos() * (0.5 * (zero + link)).cos();
            close(2.0 * (1.0 - cosine * cosine).sqrt().atan2(cosine))
        }
        What::ZeroShifted => close(zero) && turned == 0.0,
        What::SenseFlipped => reversed,
        What::Limit => close(limit),
        What::Kind => kind,
        What::Mass => true,
    };
    (!right).then(|| format!("{:?} by {} reads {:?}", edit.what, edit.by, joint.changes))
}
