//! Merges links on fixed joints into the link that carries them.
//!
//! First everything in a removed link is expressed in the frame of the remaining link, in place; then the elements move.
//! A link that is kept as a frame loses its mass and shapes and stays in place.

mod inertial;
mod srdf;

use crate::Change;
use crate::claim::{Claim, Compared, KeptLink};
use crate::error::{self, EditError, refused_at_joint};
use crate::references::{self, Names};
use crate::tally::Tally;
use crate::values::child;
use denavit_export::urdf::text::{Edits, Moves, Nodes, Numbers, joint_origin, parse};
use denavit_model::PlacedRobot;
use denavit_model::robot::{JointKind, Robot, SourceText};
use denavit_model::se3::Pose;
use denavit_model::tree::Reading;
use denavit_model::urdf;
use roxmltree::{Document, Node};
use std::collections::{BTreeMap, BTreeSet};

/// How a link on a fixed joint is treated.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Fate {
    /// It is removed, with its joint.
    Goes,
    /// It stays as a frame.
    Frame,
}

/// Which links go where.
struct Plan {
    fates: BTreeMap<usize, Fate>,
    /// For each link, the link with its content afterwards.
    target: Vec<usize>,
    /// target_from_link.
    step: Vec<Pose>,
}

/// `named`: fixed joints, or links on them; all if empty. `keep`: links that stay as frames.
///
/// # Errors
/// A name that is missing, is not on a fixed joint, or is needed.
pub(crate) fn merge(
    robot: &Robot,
    srdf: Option<&SourceText>,
    named: &[String],
    keep: &[String],
) -> Result<Change, EditError> {
    let document = parse(robot)?;
    let nodes = Nodes::of(robot, &document)?;
    error::all_declared(robot, &nodes)?;
    let mut notes = Vec::new();
    let fates = fates(robot, &document, srdf, (named, keep), &mut notes)?;
    let plan = plan(robot, fates);
    let moved = given_in_the_target(robot, &document, &nodes, &plan)?;
    let moved = urdf::read(&robot.source.file, &moved)?;
    let mut tally = Tally::default();
    let urdf = moved_over(&moved, robot, &plan, &mut tally)?;
    let mut claim = Claim { compared: Compared::UpToFrames, ..Claim::same(robot) };
    let mut names = Names::default();
    for (link, fate) in &plan.fates {
        let (name, target) = (&robot.links[*link].name, &robot.links[plan.target[*link]].name);
        let place = Some((target.clone(), plan.step[*link]));
        match fate {
            Fate::Goes => {
                let kept = KeptLink { name: target.clone(), offset: plan.step[*link], matter: None };
                claim.links.insert(name.clone(), kept);
                names.links.insert(name.clone(), target.clone());
                if let Some(joint) = robot.joint_to(*link) {
                    claim.joints.remove(&robot.joints[joint].name);
                }
                tally.count("link", "links", "merged");
            }
            Fate::Frame => {
                let kept = KeptLink { name: name.clone(), offset: Pose::identity(), matter: place };
                claim.links.insert(name.clone(), kept);
                tally.count("frame", "frames", "kept");
            }
        }
    }
    let srdf = srdf.map(|source| srdf::merged(source, &names, &mut tally)).transpose()?;
    Ok(Change { urdf, srdf, claim, second: None, files: Vec::new(), tally, notes })
}

fn fates(
    robot: &Robot,
    document: &Document,
    srdf: Option<&SourceText>,
    (named, keep): (&[String], &[String]),
    notes: &mut Vec<String>,
) -> Result<BTreeMap<usize, Fate>, EditError> {
    let mut wanted: BTreeSet<usize> = BTreeSet::new();
    for name in named {
        let joint = match (robot.joint_index(name), robot.link_index(name).and_then(|link| robot.joint_to(link))) {
            (Some(joint), _) | (None, Some(joint)) => joint,
            (None, None) => error::joint(robot, name)?,
        };
        if robot.joints[joint].kind != JointKind::Fixed {
            return Err(refused_at_joint(robot, joint, "only a fixed joint can be merged; this one moves"));
        }
        wanted.insert(joint);
    }
    let all = named.is_empty();
    if all {
        wanted.extend((0..robot.joints.len()).filter(|joint| robot.joints[*joint].kind == JointKind::Fixed));
    }
    for name in keep {
        let link = error::link(robot, name)?;
        if robot.joint_to(link).is_none_or(|joint| !wanted.contains(&joint)) {
            return Err(error::refused_at_link(robot, link, "it is not on a merged fixed joint, so it stays anyway"));
        }
    }
    let needed = needed(robot, document, srdf)?;
    let mut fates = BTreeMap::new();
    for joint in wanted {
        let (of, link) = (&robot.joints[joint], robot.joints[joint].child);
        let (name, parent) = (&robot.links[link].name, &robot.links[of.parent].name);
        let because = needed.get(name.as_str()).or_else(|| needed.get(of.name.as_str()));
        if keep.contains(name) {
            fates.insert(link, Fate::Frame);
        } else if all && parent == "world" {
            notes.push(format!(
                "link \"{name}\" stays, because the world carries it; name its joint to merge it anyway"
            ));
        } else if let Some(why) = because {
            notes.push(format!("link \"{name}\" is kept as a frame: {why}"));
            fates.insert(link, Fate::Frame);
        } else {
            fates.insert(link, Fate::Goes);
        }
    }
    Ok(fates)
}

/// Names that an element outside the tree needs, and why.
fn needed(
    robot: &Robot,
    document: &Document,
    srdf: Option<&SourceText>,
) -> Result<BTreeMap<String, String>, EditError> {
    let links: BTreeSet<&str> = robot.links.iter().map(|link| link.name.as_str()).collect();
    let fixed = robot.joints.iter().filter(|joint| joint.kind == JointKind::Fixed);
    let joints: BTreeSet<&str> = fixed.map(|joint| joint.name.as_str()).collect();
    let mut needed = BTreeMap::new();
    for used in references::uses(document, &links, &joints) {
        let is_top = used.node.parent().is_some_and(|above| above == document.root_element());
        let own = is_top && used.node.tag_name().name() == "joint";
        if used.in_text || joints.contains(used.name.as_str()) && !links.contains(used.name.as_str()) && !own {
            let tag = used.node.tag_name().name();
            let line = robot.source.line(used.node.range().start);
            needed.entry(used.name).or_insert_with(|| format!("<{tag}> in line {line} names it"));
        }
    }
    if let Some(source) = srdf {
        let document = crate::operations::parse_srdf(source)?;
        for used in references::uses(&document, &links, &BTreeSet::new()) {
            let tag = used.node.tag_name().name();
            if ["chain", "end_effector", "virtual_joint", "link_sphere_approximation"].contains(&tag) {
                needed.entry(used.name).or_insert_with(|| format!("<{tag}> of {} names it", source.file));
            }
        }
    }
    Ok(needed)
}

fn plan(robot: &Robot, fates: BTreeMap<usize, Fate>) -> Plan {
    let placed = PlacedRobot::new(robot, Reading::AsWritten);
    let mut target: Vec<usize> = (0..robot.links.len()).collect();
    let mut step = vec![Pose::identity(); robot.links.len()];
    for link in placed.order() {
        if let (true, Some(joint)) = (fates.contains_key(link), placed.carrier(*link)) {
            let parent = robot.joints[joint].parent;
            target[*link] = target[parent];
            step[*link] = step[parent] * placed.origin(joint).pose();
        }
    }
    Plan { fates, target, step }
}

/// The text with everything that moves expressed in the frame of its new link.
fn given_in_the_target(robot: &Robot, document: &Document, nodes: &Nodes, plan: &Plan) -> Result<String, EditError> {
    let mut edits = Edits::default();
    let steps =
        (0..robot.links.len()).map(|link| (plan.fates.get(&link) == Some(&Fate::Goes)).then(|| plan.step[link]));
    let moves = Moves::by_steps(robot, Reading::AsWritten, steps.collect());
    moves.contents(robot, document, nodes, &mut edits)?;
    for (link, fate) in &plan.fates {
        if let (Fate::Frame, Some(node)) = (fate, nodes.link(*link)) {
            moves.shapes(&mut edits, node, &plan.step[*link]);
        }
    }
    for (index, joint) in robot.joints.iter().enumerate() {
        if plan.target[joint.parent] != joint.parent && plan.fates.get(&joint.child) != Some(&Fate::Goes) {
            let pose = plan.step[joint.parent] * joint.origin.pose();
            let scale = plan.step[joint.parent].translation.vector.amax() + pose.translation.vector.amax();
            joint_origin(&robot.source, &mut edits, nodes.joint(index), &Numbers::of(&pose, scale));
        }
    }
    Ok(edits.apply(&robot.source)?)
}

/// Moves the elements to their links; `moved` has the links of `robot` in its order.
fn moved_over(moved: &Robot, robot: &Robot, plan: &Plan, tally: &mut Tally) -> Result<String, EditError> {
    let document = parse(moved)?;
    let nodes = Nodes::of(moved, &document)?;
    let mut edits = Edits::default();
    let source = &moved.source;
    let mut goes: Vec<Node> = Vec::new();
    for (link, fate) in &plan.fates {
        if let (Fate::Goes, Some(node)) = (fate, nodes.link(*link)) {
            goes.push(node);
            goes.extend(robot.joint_to(*link).map(|joint| nodes.joint(joint)));
        }
    }
    for node in &goes {
        edits.remove(source, *node);
    }
    let mut into: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    for link in plan.fates.keys() {
        into.entry(plan.target[*link]).or_default().push(*link);
    }
    for (target, links) in &into {
        let Some(target_node) = nodes.link(*target) else { continue };
        let mut lines: Vec<String> = Vec::new();
        for link in links {
            let Some(node) = nodes.link(*link) else { continue };
            let frame = plan.fates[link] == Fate::Frame;
            for part in node.children().filter(Node::is_element) {
                let tag = part.tag_name().name();
                let shape = matches!(tag, "visual" | "collision");
                if shape || !frame && tag != "inertial" {
                    lines.push(source.text[part.range()].to_owned());
                }
                if frame && (shape || tag == "inertial") {
                    edits.remove(source, part);
                }
                if shape {
                    tally.count("shape", "shapes", "moved over");
                }
            }
        }
        let mut all = vec![*target];
        all.extend(links);
        if let Some(sum) = inertial::sum(moved, &all) {
            tally.count("mass", "masses", "summed");
            match child(target_node, "inertial") {
                Some(old) => edits.replace(old.range(), sum),
                None => lines.insert(0, sum),
            }
        }
        if !lines.is_empty() {
            edits.lines_at_end(source, target_node, &lines);
        }
    }
    let merged = plan.fates.iter().filter(|(_, fate)| **fate == Fate::Goes);
    let mut names = Names::default();
    for (link, _) in merged {
        names.links.insert(robot.links[*link].name.clone(), robot.links[plan.target[*link]].name.clone());
    }
    // A joint on a kept frame is attached to the link that has its mass.
    for (index, joint) in robot.joints.iter().enumerate() {
        let node = nodes.joint(index);
        let hangs = plan.fates.get(&joint.parent) == Some(&Fate::Frame) && !goes.contains(&node);
        if let (true, Some(parent)) = (hangs, child(node, "parent")) {
            edits.attribute(source, parent, "link", &robot.links[plan.target[joint.parent]].name);
        }
    }
    references::rename_where(&document, &names, &mut edits, &|node| !goes.iter().any(|gone| is_within(node, *gone)));
    Ok(edits.apply(source)?)
}

fn is_within(node: Node, above: Node) -> bool {
    node.range().start >= above.range().start && node.range().end <= above.range().end
}
