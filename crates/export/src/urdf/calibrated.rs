//! A URDF with changed joint origins, so that one of its chains moves like a calibrated chain.

use super::bodies::Bodies;
use super::edit::{Edits, escaped};
use super::keep::free;
use super::nodes::Nodes;
use super::origin::{is, joint_origin};
use super::written::{Numbers, word};
use super::{ExportError, parse};
use denavit_model::chain::{Chain, ChainJoint};
use denavit_model::nalgebra::{Point3, Unit, Vector3};
use denavit_model::notes::{Note, Noted};
use denavit_model::robot::{JointKind, Robot};
use denavit_model::screw::Screw;
use denavit_model::se3::{self, Pose};
use denavit_model::tree::Reading;
use denavit_model::urdf;
use roxmltree::Node;
use std::collections::BTreeMap;

/// Allowed deviation of the written robot from the chain, relative to its size and in rad.
const SAME: f64 = 1e-11;

/// The URDF of `robot` in which the chain from `calibrated`'s base to its tip moves as `calibrated` does.
///
/// Only joint origins on the path change. Each link keeps its pose relative to its joint's axis as closely as possible: it
/// turns by the angle between the two axes, moves to the nearest point of the new axis, and turns about it by the joint's
/// zero; if only zeros differ, each origin turns about its own axis and nothing else changes. The tip's displacement goes into
/// the last fixed joint; if the last joint carries the tip itself and the new tip is not on its axis, a link
/// `<tip>_calibrated` is fixed to it, with a note. A changed pitch goes into the multiplier of the prismatic joint. `reading`
/// is how the nominal chain was read.
///
/// # Errors
/// The chain is not in the robot, runs up the tree, or differs in more than screw axes, pitch, joint zeros and home pose.
pub fn with_chain(robot: &Robot, calibrated: &Chain, reading: Reading) -> Result<Noted<String>, ExportError> {
    let nominal = robot.chain(Some(calibrated.base()), Some(calibrated.tip()), reading)?.value;
    let ZerosTakenIn { joints, home, shifts } = zeros_taken_in(&nominal, calibrated)?;
    let bodies = Bodies::of(robot, reading);
    let document = parse(robot)?;
    let nodes = Nodes::of(robot, &document)?;
    let mut edits = Edits::default();
    let (base, tip) = ends(robot, calibrated)?;
    let way = way(robot, &bodies, base, tip, calibrated)?;
    let base_from = |link: usize| bodies.poses[base].inverse() * bodies.poses[link];
    let last_moving = way.iter().rposition(|joint| robot.joints[*joint].kind.moves());
    let mut notes = Vec::new();
    let mut here = Pose::identity();
    for (place, index) in way.iter().enumerate() {
        let joint = &robot.joints[*index];
        let old = bodies.origins[*index];
        let found = nominal.joints().iter().position(|of| of.name == joint.name);
        let mut next = here * old.pose();
        if let Some(index) = found {
            let frame = base_from(joint.child);
            // Where a slide and its turn became one helical joint, fixed parts between them move with the turn.
            let (turned, drawn) = (shifts[index] * frame, nominal.joints()[index].screw.moved(&shifts[index]));
            next = moved(&drawn, &joints[index].screw, &turned) * turned;
        }
        let carries_the_tip = Some(place) == last_moving && place + 1 == way.len();
        if carries_the_tip && on_axis(&next, &home, &bodies.axes[*index], calibrated.size()) {
            next = home;
        }
        if place + 1 == way.len() && Some(place) != last_moving {
            next = home;
        }
        let step = here.inverse() * next;
        let numbers = Numbers::of(&step, calibrated.size());
        let (turned, slid) = se3::difference(&step, &old.pose());
        if bodies.reread[*index] || turned > f64::EPSILON * 8.0 || slid > f64::EPSILON * 8.0 * calibrated.size() {
            joint_origin(&robot.source, &mut edits, nodes.joint(*index), &numbers);
            here *= numbers.pose();
        } else {
            here *= old.pose();
        }
        if let Some(pitch) = pitch_change(&nominal, &joints, found) {
            new_pitch(robot, &mut edits, &nodes, &way[place..], pitch)?;
        }
    }
    let (turned, slid) = se3::difference(&here, &home);
    let mut tip_name = calibrated.tip().to_owned();
    if turned > SAME || slid > SAME * calibrated.size() {
        tip_name.push_str("_calibrated");
        let carrier = way.last().map(|joint| nodes.joint(*joint)).or(nodes.link(tip));
        let step = Numbers::of(&(here.inverse() * home), calibrated.size());
        notes.push(add_tip(robot, &mut edits, carrier, &tip_name, calibrated.tip(), &step)?);
    }
    let value = edits.apply(&robot.source)?;
    check(robot, calibrated, &tip_name, reading, &value)?;
    Ok(Noted { value, notes })
}

/// The URDF of `robot` in which each of these chains, which may share joints, moves as calibrated.
///
/// # Errors
/// As [`with_chain`].
pub fn with_chains(robot: &Robot, calibrated: &[Chain], reading: Reading) -> Result<Noted<String>, ExportError> {
    let mut made = Noted { value: robot.source.text.clone(), notes: Vec::new() };
    for (index, chain) in calibrated.iter().enumerate() {
        // Joints of earlier chains are already placed, and stay.
        let again = if index == 0 { None } else { Some(urdf::read(&robot.source.file, &made.value)?) };
        let Noted { value, notes } = with_chain(again.as_ref().unwrap_or(robot), chain, reading)?;
        made.value = value;
        let new: Vec<Note> = notes.into_iter().filter(|note| !made.notes.contains(note)).collect();
        made.notes.extend(new);
    }
    let written = urdf::read(&robot.source.file, &made.value)?;
    for chain in calibrated {
        let moved = format!("{}_calibrated", chain.tip());
        let is_new = written.link_index(&moved).is_some() && robot.link_index(&moved).is_none();
        check(robot, chain, if is_new { &moved } else { chain.tip() }, reading, &made.value)?;
    }
    Ok(made)
}

fn ends(robot: &Robot, chain: &Chain) -> Result<(usize, usize), ExportError> {
    let find = |name: &str| {
        let missing = || ExportError::NoSuchLink { file: robot.source.file.clone(), name: name.to_owned() };
        robot.link_index(name).ok_or_else(missing)
    };
    Ok((find(chain.base())?, find(chain.tip())?))
}

fn way(robot: &Robot, bodies: &Bodies, base: usize, tip: usize, chain: &Chain) -> Result<Vec<usize>, ExportError> {
    let mut way = Vec::new();
    let mut at = tip;
    while at != base {
        let up = || ExportError::NotInUrdf {
            joint: chain.joints().first().map_or_else(String::new, |joint| joint.name.clone()),
            what: "the chain runs up the tree; calibrate from a base above the tip".into(),
        };
        let joint = bodies.to_parent[at].ok_or_else(up)?;
        way.push(joint);
        at = robot.joints[joint].parent;
    }
    way.reverse();
    Ok(way)
}

/// A calibrated chain with its zero offsets folded into the following joints.
pub(crate) struct ZerosTakenIn {
    /// Joints at zero.
    pub joints: Vec<ChainJoint>,
    /// base_from_tip at zero.
    pub home: Pose,
    /// For each joint, the motion of its child by all zero offsets up to its own.
    shifts: Vec<Pose>,
}

/// The calibrated joints and home pose with the zero offsets folded into the following joints.
pub(crate) fn zeros_taken_in(nominal: &Chain, calibrated: &Chain) -> Result<ZerosTakenIn, ExportError> {
    let refuse = |joint: &str, what: String| Err(ExportError::NotInUrdf { joint: joint.to_owned(), what });
    if nominal.joints().len() != calibrated.joints().len() {
        let what = format!("the robot has {} joints there", nominal.joints().len());
        return refuse(calibrated.joints().first().map_or("", |joint| &joint.name), what);
    }
    let mut shift = Pose::identity();
    let (mut joints, mut shifts) = (Vec::new(), Vec::new());
    for (one, other) in nominal.joints().iter().zip(calibrated.joints()) {
        if one.name != other.name {
            return refuse(&other.name, format!("the robot has joint \"{}\" there", one.name));
        }
        if std::mem::discriminant(&one.screw) != std::mem::discriminant(&other.screw) {
            return refuse(&other.name, "its kind differs from that in the robot".into());
        }
        if one.scale != other.scale {
            let what = format!("joint scale {} cannot be written in URDF; apply it in the controller", other.scale);
            return refuse(&other.name, what);
        }
        joints.push(ChainJoint { screw: other.screw.moved(&shift), ..other.clone() });
        shift *= other.screw.motion(other.offset - one.offset);
        shifts.push(shift);
    }
    Ok(ZerosTakenIn { joints, home: shift * calibrated.home(), shifts })
}

/// The smallest motion that takes one axis to another: by the angle between them, about the point of the first that is
/// nearest to the frame's origin, and from there to the nearest point of the other.
fn moved(old: &Screw, new: &Screw, frame: &Pose) -> Pose {
    let (from, to) = (old.direction().into_inner(), new.direction().into_inner());
    let angle = se3::angle_between(&from, &to);
    let turn = Unit::try_new(from.cross(&to), 0.0)
        .map_or_else(Pose::identity, |axis| se3::pose(se3::rotation_about(&axis, angle), Vector3::zeros()));
    let origin = Point3::from(frame.translation.vector);
    let start = old.line().map_or(origin, |line| line.nearest_to(&origin));
    let end = new.line().map_or(start, |line| line.nearest_to(&start));
    se3::translation(end.coords) * turn * se3::translation(-start.coords)
}

/// Whether a link's frame may be `home` where its joint's axis goes through `frame`.
fn on_axis(frame: &Pose, home: &Pose, axis: &Unit<Vector3<f64>>, size: f64) -> bool {
    let (direction, wanted) = (frame.rotation * axis.as_ref(), home.rotation * axis.as_ref());
    let offset = home.translation.vector - frame.translation.vector;
    se3::angle_between(&direction, &wanted) <= SAME * 0.1 && offset.cross(&direction).norm() <= SAME * 0.1 * size
}

/// New pitch over nominal pitch, where they differ.
fn pitch_change(nominal: &Chain, joints: &[ChainJoint], found: Option<usize>) -> Option<f64> {
    let index = found?;
    let (old, new) = (nominal.joints()[index].screw.pitch()?, joints[index].screw.pitch()?);
    (old != new && old != 0.0).then_some(new / old)
}

fn new_pitch(robot: &Robot, edits: &mut Edits, nodes: &Nodes, way: &[usize], factor: f64) -> Result<(), ExportError> {
    let turn = &robot.joints[way[0]];
    let slide = way[1..].iter().find(|joint| robot.joints[**joint].kind == JointKind::Prismatic);
    let driven = slide.and_then(|joint| Some((joint, robot.joints[*joint].mimic.as_ref()?)));
    let Some((slide, mimic)) = driven.filter(|(_, mimic)| mimic.joint == turn.name) else {
        let what = "its pitch cannot be changed in place; write a revolute joint and a prismatic joint that mimics \
                    it"
        .into();
        return Err(ExportError::NotInUrdf { joint: turn.name.clone(), what });
    };
    let node = nodes.joint(*slide).children().find(|child| is(child, "mimic"));
    if let Some(node) = node {
        edits.attribute(&robot.source, node, "multiplier", &word(mimic.multiplier * factor));
    }
    Ok(())
}

fn add_tip(
    robot: &Robot,
    edits: &mut Edits,
    carrier: Option<Node>,
    name: &str,
    tip: &str,
    step: &Numbers,
) -> Result<Note, ExportError> {
    let holder = format!("{name}_joint");
    free(robot, robot.link_index(name).map(|link| ("link", robot.links[link].at, name)))?;
    free(robot, robot.joint_index(&holder).map(|joint| ("joint", robot.joints[joint].at, holder.as_str())))?;
    let Some(carrier) = carrier else {
        let what = format!("link \"{tip}\" is not declared in the file");
        return Err(ExportError::Unfaithful { file: robot.source.file.clone(), what });
    };
    let lines = [
        format!("<link name=\"{}\"/>", escaped(name)),
        format!(
            "<joint name=\"{}\" type=\"fixed\"><parent link=\"{}\"/><child link=\"{}\"/>{}</joint>",
            escaped(&holder),
            escaped(tip),
            escaped(name),
            step.element()
        ),
    ];
    edits.lines_behind(&robot.source, carrier, &lines);
    let place = robot.source.place(carrier.range().start, format!("link \"{tip}\""));
    let what = format!("the calibrated tip is not on the last joint's axis; it is the new link \"{name}\"");
    Ok(Note::Corrected { place, what })
}

/// # Errors
/// The text's chain does not move like the calibrated one.
fn check(robot: &Robot, calibrated: &Chain, tip: &str, reading: Reading, text: &str) -> Result<(), ExportError> {
    let made = urdf::read(&robot.source.file, text)?;
    let chain = made.chain(Some(calibrated.base()), Some(tip), reading)?.value;
    let by_name: BTreeMap<&str, f64> = calibrated
        .coordinates()
        .iter()
        .enumerate()
        .map(|(index, coordinate)| (coordinate.name.as_str(), (1.3 * index as f64 + 0.7).sin()))
        .collect();
    let q = |chain: &Chain| -> Vec<f64> {
        let value = |name: &str| by_name.get(name).copied().unwrap_or(0.0);
        chain.coordinates().iter().map(|coordinate| value(&coordinate.name)).collect()
    };
    let (turned, slid) = se3::difference(&chain.fk(&q(&chain)), &calibrated.fk(&q(calibrated)));
    if turned > SAME || slid > SAME * calibrated.size() {
        let what = format!("the result would deviate from the calibrated chain by {slid:.1e} m and {turned:.1e} rad");
        return Err(ExportError::Unfaithful { file: robot.source.file.clone(), what });
    }
    Ok(())
}
