//! Changes the root: the joints on the path to it are inverted, every link's frame stays in place on its link.
//!
//! A joint turns about its child link's origin. After inversion, its child is its former carrier, whose origin need not
//! be on the axis. A joint moves by T·exp(a q); the inverse is exp(-a q)·T⁻¹ = T⁻¹·exp(-(Ta) q):
//! - fixed, floating: the origin is T⁻¹;
//! - sliding, and turning where the carrying link's origin lies on the axis: the origin is T⁻¹, the axis -(R a);
//! - otherwise the joint carries a link `LINK_at_JOINT` without mass or shape, with the axis -a, and that carries the link by a fixed
//!   joint with T⁻¹.
//!
//! Joint values stay, and with them limits, mimic joints and transmissions. Rerooting back removes such links again.

use crate::Change;
use crate::claim::Claim;
use crate::claim::Compared;
use crate::error::{self, EditError, refused_at_joint};
use crate::literal::negated_where;
use crate::references;
use crate::tally::Tally;
use crate::values::child;
use denavit_export::urdf::text::{Edits, Nodes, Numbers, clean, escaped, joint_origin, parse, three};
use denavit_model::PlacedRobot;
use denavit_model::nalgebra::Vector3;
use denavit_model::posed::{self, Frame, Placed};
use denavit_model::robot::{JointKind, Robot, SourceText};
use denavit_model::se3::Pose;
use denavit_model::tree::Reading;
use roxmltree::Node;
use std::collections::BTreeSet;

/// An origin closer to an axis than this, relative to its length, is on it: rounding of the product that gave it.
const ON_AXIS: f64 = 4.0 * f64::EPSILON;

/// How a joint on the path is inverted.
enum Turned {
    /// The carrying link follows directly.
    Plain { origin: Pose, axis: Option<Vector3<f64>> },
    /// With a link between the joint and the carrying link.
    Between { origin: Pose },
}

/// # Errors
/// No such link, or a joint on the path that cannot be inverted.
pub(crate) fn reroot(robot: &Robot, srdf: Option<&SourceText>, name: &str) -> Result<Change, EditError> {
    let new_root = error::link(robot, name)?;
    let placed = PlacedRobot::new(robot, Reading::AsWritten);
    let document = parse(robot)?;
    let nodes = Nodes::of(robot, &document)?;
    error::all_declared(robot, &nodes)?;
    let (mut edits, mut tally, mut notes) = (Edits::default(), Tally::default(), Vec::new());
    let mut claim = Claim { compared: Compared::No, seen_from: name.to_owned(), ..Claim::same(robot) };
    let mut way = Vec::new();
    let mut at = new_root;
    while let Some(joint) = placed.carrier(at) {
        way.push(joint);
        at = robot.joints[joint].parent;
    }
    if way.is_empty() {
        notes.push(format!("link \"{name}\" is already the root"));
    }
    refuse_places_in_the_root_frame(robot)?;
    let mut between = 0;
    let mut step = 0;
    while let Some(index) = way.get(step).copied() {
        step += 1;
        // A fixed joint and a link that an earlier reroot put behind the joint that comes next.
        if let Some(next) = way.get(step).copied().filter(|next| is_helper(robot, &nodes, &document, index, *next)) {
            step += 1;
            let joint = &robot.joints[next];
            without_helper(robot, &nodes, &mut edits, &mut claim, (index, next))?;
            if let Some(kept) = claim.joints.get_mut(&joint.name) {
                kept.reversed = true;
            }
            tally.count("joint", "joints", "inverted");
            tally.count("link without mass", "links without mass", "no longer needed");
            continue;
        }
        let joint = &robot.joints[index];
        let node = nodes.joint(index);
        let forward = joint.origin.pose();
        let turned = turned(robot, index, &forward)?;
        let (old_parent, old_child) = (&robot.links[joint.parent].name, &robot.links[joint.child].name);
        end(robot, &mut edits, node, "parent", old_child)?;
        let scale = forward.translation.vector.amax();
        match turned {
            Turned::Plain { origin, axis } => {
                end(robot, &mut edits, node, "child", old_parent)?;
                joint_origin(&robot.source, &mut edits, node, &Numbers::of(&origin, scale));
                if let Some(axis) = axis {
                    write_axis(robot, &mut edits, node, axis);
                }
            }
            Turned::Between { origin } => {
                let link = free_name(robot, &format!("{old_parent}_at_{}", joint.name));
                let fixed = free_name(robot, &format!("{link}_fixed"));
                end(robot, &mut edits, node, "child", &link)?;
                joint_origin(&robot.source, &mut edits, node, &Numbers::default());
                write_axis(robot, &mut edits, node, -joint.axis.into_inner());
                let lines = [
                    format!("<link name=\"{}\"/>", escaped(&link)),
                    format!(
                        "<joint name=\"{}\" type=\"fixed\">{}<parent link=\"{}\"/><child link=\"{}\"/></joint>",
                        escaped(&fixed),
                        Numbers::of(&origin, scale).element(),
                        escaped(&link),
                        escaped(old_parent)
                    ),
                ];
                edits.lines_behind(&robot.source, node, &lines);
                between += 1;
            }
        }
        if let Some(kept) = claim.joints.get_mut(&joint.name) {
            kept.reversed = true;
        }
        tally.count("joint", "joints", "inverted");
        if !joint.kind.has_one_value() && joint.kind.moves() {
            notes.push(format!(
                "joint \"{}\" is {}: its pose is now that of \"{old_parent}\" in \"{old_child}\", the inverse",
                joint.name,
                joint.kind.word()
            ));
        }
    }
    if between > 0 {
        tally.say(format!(
            "{between} link{} without mass added, so that every frame stays",
            if between == 1 { "" } else { "s" }
        ));
    }
    if !way.is_empty() {
        notes.extend(what_names_the_old_tree(robot, srdf));
    }
    let urdf = edits.apply(&robot.source)?;
    Ok(Change::of(urdf, srdf, claim, tally, notes))
}

/// Inverts the joint `next` onto the link that the fixed joint `index` leads to, without the link between them.
fn without_helper(
    robot: &Robot,
    nodes: &Nodes,
    edits: &mut Edits,
    claim: &mut Claim,
    (index, next): (usize, usize),
) -> Result<(), EditError> {
    let (fixed, joint) = (&robot.joints[index], &robot.joints[next]);
    let node = nodes.joint(next);
    end(robot, edits, node, "parent", &robot.links[fixed.child].name)?;
    end(robot, edits, node, "child", &robot.links[joint.parent].name)?;
    let origin = fixed.origin.pose().inverse();
    joint_origin(&robot.source, edits, node, &Numbers::of(&origin, origin.translation.vector.amax()));
    write_axis(robot, edits, node, -joint.axis.into_inner());
    edits.remove(&robot.source, nodes.joint(index));
    if let Some(link) = nodes.link(fixed.parent) {
        edits.remove(&robot.source, link);
    }
    claim.links.remove(&robot.links[fixed.parent].name);
    claim.joints.remove(&fixed.name);
    Ok(())
}

/// Notes on what may depend on the root link.
fn what_names_the_old_tree(robot: &Robot, srdf: Option<&SourceText>) -> Vec<String> {
    let mut notes: Vec<String> = Vec::new();
    if robot.links[robot.root].name == "world" {
        notes.push("link \"world\" is no longer the root; simulators that fix such a root no longer do".into());
    }
    if let Some(srdf) = srdf.filter(|srdf| srdf.text.contains("<virtual_joint") || srdf.text.contains("<chain")) {
        notes.push(format!(
            "{}: <virtual_joint> and <chain> name links of the old tree; check them: a chain must run from base to tip",
            srdf.file
        ));
    }
    notes
}

/// The joint from its child to its former carrier, if it moved by `forward`·exp(a q).
fn turned(robot: &Robot, index: usize, forward: &Pose) -> Result<Turned, EditError> {
    let joint = &robot.joints[index];
    let back = forward.inverse();
    let seen = forward.rotation * joint.axis.into_inner();
    let offset = forward.translation.vector;
    let on_axis = offset.cross(&seen).norm() <= ON_AXIS * offset.norm();
    match joint.kind {
        JointKind::Fixed | JointKind::Floating => Ok(Turned::Plain { origin: back, axis: None }),
        JointKind::Planar => Ok(Turned::Plain { origin: back, axis: Some(seen) }),
        JointKind::Prismatic => Ok(Turned::Plain { origin: back, axis: Some(-seen) }),
        JointKind::Revolute | JointKind::Continuous | JointKind::Screw(_) if on_axis => {
            Ok(Turned::Plain { origin: back, axis: Some(-seen) })
        }
        JointKind::Revolute | JointKind::Continuous | JointKind::Screw(_) => Ok(Turned::Between { origin: back }),
        _ => Err(refused_at_joint(
            robot,
            index,
            format!("a joint of the unknown kind \"{}\" cannot be inverted", joint.kind.word()),
        )),
    }
}

/// Writes the direction of an axis; only the signs if nothing else changes.
fn write_axis(robot: &Robot, edits: &mut Edits, node: Node, axis: Vector3<f64>) {
    let axis: [f64; 3] = axis.map(|x| clean(x, 1.0)).into();
    let found = child(node, "axis");
    let written = found.and_then(|axis| axis.attribute("xyz"));
    let same = |text: &str| {
        let numbers: Vec<f64> = text.split_whitespace().filter_map(|word| word.parse().ok()).collect();
        let length = numbers.iter().map(|x| x * x).sum::<f64>().sqrt();
        numbers.len() == 3 && numbers.iter().zip(axis).all(|(a, b)| (a / length - b).abs() <= 4.0 * f64::EPSILON)
    };
    let negative = written.map(|written| negated_where(written, &[true; 3]));
    match (found, written, negative) {
        (_, Some(written), _) if same(written) => {}
        (Some(found), _, Some(negative)) if same(&negative) => {
            edits.attribute(&robot.source, found, "xyz", &negative);
        }
        (Some(found), ..) => edits.attribute(&robot.source, found, "xyz", &three(axis)),
        (None, ..) if axis == [1.0, 0.0, 0.0] => {}
        (None, ..) => edits.behind_origin(&robot.source, node, &format!("<axis xyz=\"{}\"/>", three(axis))),
    }
}

/// Gives an end of a joint another link.
fn end(robot: &Robot, edits: &mut Edits, joint: Node, tag: &str, link: &str) -> Result<(), EditError> {
    let Some(node) = child(joint, tag) else {
        let place = robot.source.place(joint.range().start, "joint");
        return Err(EditError::Refused { place, what: format!("its <{tag}> is not in the text itself") });
    };
    edits.attribute(&robot.source, node, "link", link);
    Ok(())
}

fn free_name(robot: &Robot, wanted: &str) -> String {
    let taken = |name: &str| robot.link_index(name).is_some() || robot.joint_index(name).is_some();
    let mut name = wanted.to_owned();
    let mut number = 2;
    while taken(&name) {
        name = format!("{wanted}_{number}");
        number += 1;
    }
    name
}

/// Whether an earlier reroot added the link between `joint` and `fixed`; `fixed` then leads to the link in its name.
fn is_helper(robot: &Robot, nodes: &Nodes, document: &roxmltree::Document, fixed: usize, joint: usize) -> bool {
    let (fixed, joint) = (&robot.joints[fixed], &robot.joints[joint]);
    let name = &robot.links[fixed.parent].name;
    let wanted = format!("{}_at_{}", robot.links[fixed.child].name, joint.name);
    let is_named = name.strip_prefix(&wanted).is_some_and(|rest| {
        rest.is_empty() || rest.strip_prefix('_').is_some_and(|number| number.parse::<u32>().is_ok())
    });
    let is_empty = nodes.link(fixed.parent).is_some_and(|node| node.first_element_child().is_none());
    let sits_there = joint.origin.pose() == Pose::identity() && joint.child == fixed.parent;
    // Its own element, and the two joints.
    let named = BTreeSet::from([name.as_str()]);
    let uses = || references::uses(document, &named, &BTreeSet::new()).len();
    fixed.kind == JointKind::Fixed && joint.kind.has_one_value() && is_named && is_empty && sits_there && uses() == 3
}

/// Refuses poses in the root link's frame that do not name it, because they would move.
fn refuse_places_in_the_root_frame(robot: &Robot) -> Result<(), EditError> {
    for element in &robot.elements {
        let found = posed::in_element(element, None);
        let moved =
            found.iter().any(|posed| posed.frame == Frame::Root && !matches!(posed.placed, Placed::Direction(_)));
        if moved {
            let place = robot.source.place(element.at, element.label());
            let what = "its pose is in the frame of the root link, which changes; name a link with relative_to, or \
                        remove it";
            return Err(EditError::Refused { place, what: what.into() });
        }
    }
    Ok(())
}
