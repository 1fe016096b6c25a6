//! Edits that leave the robot what it is.

use super::chance::Chance;
use super::write::{Numbers, PLAIN, again};
use denavit_model::nalgebra::Vector3;
use denavit_model::posed;
use denavit_model::robot::{Inertial, Joint, Link, Mimic, Origin};
use denavit_model::se3::{self, Pose};
use denavit_model::{JointKind, Robot};
use std::f64::consts::TAU;

/// The robot after one of them, and what was done; `None` where the robot has nothing to do it to.
pub fn edit(robot: &Robot, kind: usize, chance: &mut Chance) -> Option<(String, Robot)> {
    let mut edited = robot.clone();
    let mut style = PLAIN;
    let what = match kind % KINDS {
        0 => reframed(&mut edited, chance)?,
        1 => axis_scaled(&mut edited, chance)?,
        2 => wrapped(&mut edited, chance)?,
        3 => {
            style.shuffled = Some(chance.bits());
            "elements in another order".into()
        }
        4 => renamed(&mut edited, chance)?,
        5 => {
            style.numbers = if chance.below(2) == 0 { Numbers::Exponent } else { Numbers::Padded };
            "numbers written otherwise".into()
        }
        6 => split(&mut edited, chance)?,
        7 => merged(&mut edited, chance)?,
        8 => all_reframed(&mut edited, chance)?,
        _ => slid(&mut edited, chance)?,
    };
    Some((what, again(&edited, &style)))
}

pub const KINDS: usize = 10;

pub fn origin_of(pose: &Pose) -> Origin {
    Origin {
        xyz: pose.translation.vector.into(),
        rpy: se3::rpy_from_rotation(&pose.rotation),
        rpy_written: None,
        quat_written: None,
    }
}

/// A leaf link that is nothing but its frame is what it says; the root stands for the floor.
fn may_be_reframed(robot: &Robot, link: usize) -> bool {
    let it = &robot.links[link];
    let weighs = it.inertial.as_ref().is_some_and(|inertial| inertial.mass != 0.0);
    let matter = weighs || !it.visuals.is_empty() || !it.collisions.is_empty();
    let placed = places_something(robot, link);
    link != robot.root && !placed && (matter || robot.joints_from(link).next().is_some())
}

/// Whether an element places something in the link's frame, which an edit would leave behind: a sensor, an offset.
fn places_something(robot: &Robot, link: usize) -> bool {
    let names = [Some(&robot.links[link].name), robot.joint_to(link).map(|joint| &robot.joints[joint].name)];
    let own = |posed: &posed::Posed| matches!(&posed.frame, posed::Frame::Named(name) if names.contains(&Some(name)));
    let mut of_robot = robot.elements.iter().flat_map(|element| posed::in_element(element, None));
    let it = &robot.links[link];
    let mut of_link = it.elements.iter().flat_map(|element| posed::in_element(element, Some(&it.name)));
    of_robot.any(|posed| own(&posed)) || of_link.next().is_some()
}

/// Moves a link's frame by `old_from_new` and all that is given in it back.
fn reframe(robot: &mut Robot, link: usize, old_from_new: &Pose) {
    let new_from_old = old_from_new.inverse();
    let back = |origin: &mut Origin| *origin = origin_of(&(new_from_old * origin.pose()));
    let it = &mut robot.links[link];
    it.visuals.iter_mut().chain(&mut it.collisions).for_each(|shape| back(&mut shape.origin));
    it.inertial.iter_mut().for_each(|inertial| back(&mut inertial.origin));
    robot.joints.iter_mut().filter(|joint| joint.parent == link).for_each(|joint| back(&mut joint.origin));
    for joint in robot.joints.iter_mut().filter(|joint| joint.child == link) {
        // A revolute axis runs through the new origin only if that lies on it.
        joint.origin = origin_of(&(joint.origin.pose() * old_from_new));
        let axis = old_from_new.rotation.inverse() * joint.axis.into_inner();
        joint.axis_written = Some(axis.into());
    }
}

fn reframed(robot: &mut Robot, chance: &mut Chance) -> Option<String> {
    let links: Vec<usize> = (0..robot.links.len()).filter(|link| may_be_reframed(robot, *link)).collect();
    let link = *links.get(chance.below(links.len().max(1)))?;
    let motion = frame_motion(robot, link, chance);
    reframe(robot, link, &motion);
    Some(format!("link {} reframed", robot.links[link].name))
}

fn all_reframed(robot: &mut Robot, chance: &mut Chance) -> Option<String> {
    for link in (0..robot.links.len()).filter(|link| may_be_reframed(robot, *link)).collect::<Vec<_>>() {
        let motion = frame_motion(robot, link, chance);
        reframe(robot, link, &motion);
    }
    Some("all links reframed".into())
}

/// Any rotation; a translation along the axis where a joint must keep its line, any for other joints.
fn frame_motion(robot: &Robot, link: usize, chance: &mut Chance) -> Pose {
    let turn = se3::rotation_about(&chance.direction(), chance.between(-3.0, 3.0));
    let carrier = robot.joint_to(link).map(|joint| &robot.joints[joint]);
    let step = match carrier.map(|joint| (&joint.kind, joint.axis)) {
        Some((JointKind::Revolute | JointKind::Continuous | JointKind::Screw(_), axis)) => {
            axis.into_inner() * chance.between(-0.5, 0.5)
        }
        // The zero of a floating or planar joint is a place, not only an axis.
        Some((JointKind::Fixed | JointKind::Prismatic, _)) => {
            chance.direction().into_inner() * chance.between(0.0, 0.5)
        }
        _ => return Pose::identity(),
    };
    se3::pose(turn, step)
}

fn axis_scaled(robot: &mut Robot, chance: &mut Chance) -> Option<String> {
    let joint = moving(robot, chance)?;
    let factor = chance.magnitude(-2.0, 2.0);
    let axis = Vector3::from(joint.axis_written.unwrap_or([1.0, 0.0, 0.0])) * factor;
    joint.axis_written = Some(axis.into());
    Some(format!("axis of {} scaled by {factor}", joint.name))
}

fn moving<'a>(robot: &'a mut Robot, chance: &mut Chance) -> Option<&'a mut Joint> {
    let mut joints: Vec<&mut Joint> = robot.joints.iter_mut().filter(|joint| joint.kind.moves()).collect();
    let index = chance.below(joints.len().max(1));
    (!joints.is_empty()).then(|| joints.remove(index))
}

fn wrapped(robot: &mut Robot, chance: &mut Chance) -> Option<String> {
    let count = robot.joints.len();
    let joint = robot.joints.get_mut(chance.below(count.max(1)))?;
    let (angle, turn) = (chance.below(3), if chance.below(2) == 0 { TAU } else { -TAU });
    joint.origin.rpy[angle] += turn;
    Some(format!("angle {angle} of {} wrapped", joint.name))
}

fn renamed(robot: &mut Robot, chance: &mut Chance) -> Option<String> {
    if chance.below(2) == 0 {
        let link = chance.below(robot.links.len());
        let name = robot.links[link].name.clone();
        robot.links[link].name.push_str("_renamed");
        named_in_elements(robot, &name, &robot.links[link].name.clone());
        return Some(format!("link {}", robot.links[link].name));
    }
    let name = moving(robot, chance)?.name.clone();
    let new = format!("{name}_renamed");
    for joint in &mut robot.joints {
        if joint.name == name {
            joint.name.clone_from(&new);
        }
        if let Some(Mimic { joint, .. }) = &mut joint.mimic
            && *joint == name
        {
            joint.clone_from(&new);
        }
    }
    named_in_elements(robot, &name, &new);
    Some(format!("joint {new}"))
}

/// Whatever names a joint or link has to follow its name.
fn named_in_elements(robot: &mut Robot, name: &str, new: &str) {
    for node in robot.elements.iter_mut().flat_map(|element| &mut element.nodes) {
        let values = node.attributes.iter_mut().map(|(_, value)| value).chain([&mut node.text]);
        values.filter(|value| *value == name).for_each(|value| new.clone_into(value));
    }
}

/// Whether something beside the links names a link, or the link itself says more than shapes and mass.
fn is_spoken_of(robot: &Robot, link: usize) -> bool {
    is_named(robot, &robot.links[link].name) || !robot.links[link].elements.is_empty()
}

fn is_named(robot: &Robot, name: &str) -> bool {
    let mut nodes = robot.elements.iter().flat_map(|element| &element.nodes);
    nodes.any(|node| node.text == name || node.attributes.iter().any(|(_, value)| value == name))
}

/// An empty link and a fixed joint between a joint and what it carries.
fn split(robot: &mut Robot, chance: &mut Chance) -> Option<String> {
    let count = robot.joints.len();
    let index = chance.below(count.max(1));
    let joint = robot.joints.get(index)?.clone();
    let part = se3::pose(se3::rotation_about(&chance.direction(), 1.0), chance.direction().into_inner() * 0.2);
    let between = robot.links.len();
    let name = format!("{}_part", joint.name);
    robot.links.push(Link::named(name.clone(), 0));
    let before = Joint {
        name,
        kind: JointKind::Fixed,
        origin: origin_of(&part),
        child: between,
        axis_written: None,
        limits: denavit_model::Limits::default(),
        mimic: None,
        elements: Vec::new(),
        ..joint.clone()
    };
    robot.joints[index].parent = between;
    robot.joints[index].origin = origin_of(&(part.inverse() * joint.origin.pose()));
    robot.joints.push(before);
    Some(format!("joint {} split", joint.name))
}

/// The link behind a fixed joint becomes part of the link before it.
fn merged(robot: &mut Robot, chance: &mut Chance) -> Option<String> {
    let fixed: Vec<usize> = (0..robot.joints.len())
        .filter(|joint| {
            let Joint { name, kind, child, elements, .. } = &robot.joints[*joint];
            let silent = elements.is_empty() && !is_spoken_of(robot, *child) && !is_named(robot, name);
            *kind == JointKind::Fixed && may_be_reframed(robot, *child) && silent
        })
        .collect();
    let index = *fixed.get(chance.below(fixed.len().max(1)))?;
    let Joint { parent, child, origin, name, .. } = robot.joints[index].clone();
    let placed = |inner: &Origin| origin_of(&(origin.pose() * inner.pose()));
    let Link { inertial, visuals, collisions, .. } = robot.links[child].clone();
    let moved = |mut shape: denavit_model::robot::Shape| {
        shape.origin = placed(&shape.origin);
        shape
    };
    robot.links[parent].visuals.extend(visuals.into_iter().map(moved));
    robot.links[parent].collisions.extend(collisions.into_iter().map(moved));
    if let Some(share) = inertial {
        let share = Inertial { origin: placed(&share.origin), ..share };
        robot.links[parent].inertial = Some(match &robot.links[parent].inertial {
            Some(own) => sum(own, &share),
            None => share,
        });
    }
    for joint in robot.joints.iter_mut().filter(|joint| joint.parent == child) {
        joint.origin = placed(&joint.origin);
        joint.parent = parent;
    }
    robot.joints.remove(index);
    robot.links.remove(child);
    let shifted = |link: &mut usize| *link -= usize::from(*link > child);
    for joint in &mut robot.joints {
        shifted(&mut joint.parent);
        shifted(&mut joint.child);
    }
    shifted(&mut robot.root);
    Some(format!("fixed joint {name} merged"))
}

/// Two inertials of one link as one (parallel axis theorem).
fn sum(one: &Inertial, other: &Inertial) -> Inertial {
    let mass = one.mass + other.mass;
    let centre = |part: &Inertial| Vector3::from(part.origin.xyz);
    let middle = if mass == 0.0 { centre(one) } else { (centre(one) * one.mass + centre(other) * other.mass) / mass };
    let about = |part: &Inertial| {
        let (r, d) = (part.origin.pose().rotation, centre(part) - middle);
        let d = se3::skew(&d);
        r.matrix() * part.tensor * r.matrix().transpose() - d * d * part.mass
    };
    let origin = Origin { xyz: middle.into(), ..Origin::default() };
    Inertial { origin, mass, tensor: about(one) + about(other) }
}

/// A joint re-placed along its own axis, everything behind it put back.
fn slid(robot: &mut Robot, chance: &mut Chance) -> Option<String> {
    let turning = |joint: &Joint| matches!(joint.kind, JointKind::Revolute | JointKind::Continuous);
    let joints: Vec<usize> = (0..robot.joints.len())
        .filter(|joint| turning(&robot.joints[*joint]) && may_be_reframed(robot, robot.joints[*joint].child))
        .collect();
    let joint = *joints.get(chance.below(joints.len().max(1)))?;
    let (axis, child) = (robot.joints[joint].axis.into_inner(), robot.joints[joint].child);
    reframe(robot, child, &se3::translation(axis * chance.between(-1.0, 1.0)));
    Some(format!("joint {} slid along its axis", robot.joints[joint].name))
}
