//! Marker links that show the D-H frames of one chain and move nothing.

use super::bodies::Bodies;
use super::edit::{Edits, escaped};
use super::keep::free;
use super::verify::poses;
use super::written::Numbers;
use super::{ExportError, Frames, Options};
use denavit_dh::table::{Table, ToolPart};
use denavit_dh::{NearParallel, convert};
use denavit_model::notes::{Note, Noted};
use denavit_model::robot::{Joint, JointKind, Robot};
use denavit_model::se3::{self, Pose};
use roxmltree::Document;

/// Markers closer to their pose than this (rad, and relative to the robot's size) already exist.
const THERE: f64 = 1e-12;

struct Marker {
    name: String,
    parent: String,
    numbers: Numbers,
}

/// Adds dh_0 … dh_n, each fixed to the link that it moves with, unless they already exist.
pub(crate) fn add(
    robot: &Robot,
    document: &Document,
    options: &Options,
    edits: &mut Edits,
) -> Result<Vec<Note>, ExportError> {
    let Noted { value: markers, notes } = markers(&without_markers(robot), options)?;
    if already_there(robot, &markers) {
        return Ok(notes);
    }
    let Some(last) = document.root_element().last_element_child() else { return Ok(notes) };
    for Marker { name, parent, numbers } in markers {
        let holder = format!("{name}_fixed");
        free(robot, robot.link_index(&name).map(|link| ("link", robot.links[link].at, name.as_str())))?;
        free(robot, robot.joint_index(&holder).map(|at| ("joint", robot.joints[at].at, holder.as_str())))?;
        let joint = format!(
            "<joint name=\"{holder}\" type=\"fixed\"><parent link=\"{}\"/><child link=\"{name}\"/>{}</joint>",
            escaped(&parent),
            numbers.element()
        );
        edits.lines_behind(&robot.source, last, &[format!("<link name=\"{name}\"/>"), joint]);
    }
    Ok(notes)
}

fn markers(robot: &Robot, options: &Options) -> Result<Noted<Vec<Marker>>, ExportError> {
    let Noted { value: chain, mut notes } = robot.chain(None, options.tip.as_deref(), options.reading)?;
    let dh =
        convert::Options { parallelism: options.parallelism, gauge: options.gauge, near_parallel: NearParallel::Dh };
    let table =
        convert::table(&chain, &dh).map_err(|source| ExportError::Chain { file: robot.source.file.clone(), source })?;
    notes.extend(table.notes);
    let bodies = Bodies::of(robot, options.reading);
    let at_zero = poses(robot, &bodies, &|joint| value_at_zero(robot, joint));
    let base = robot.link_index(chain.base()).unwrap_or(robot.root);
    let mut carriers = vec![base];
    carriers.extend(carriers_behind(robot, &bodies, &table.value, base)?);
    let markers = frames(&table.value, options.frames).into_iter().zip(carriers).enumerate();
    let value = markers.map(|(index, (base_from_marker, link))| Marker {
        name: format!("dh_{index}"),
        parent: robot.links[link].name.clone(),
        numbers: Numbers::of(&(at_zero[link].inverse() * at_zero[base] * base_from_marker), bodies.size),
    });
    Ok(Noted { value: value.collect(), notes })
}

/// base_from_frame of dh_0 … dh_n, at zero.
fn frames(table: &Table, convention: Frames) -> Vec<Pose> {
    let distal = table.frames();
    if convention == Frames::Distal || table.rows.iter().any(|row| row.d().is_none()) {
        return distal;
    }
    let before = std::iter::once(Pose::identity()).chain(distal);
    let pair = |index: usize| ToolPart { theta: table.rows[index].theta(), d: table.rows[index].d().unwrap_or(0.0) };
    before.take(table.rows.len()).enumerate().map(|(index, frame)| frame * pair(index).pose()).collect()
}

/// The link that each joint of the table moves.
fn carriers_behind(robot: &Robot, bodies: &Bodies, table: &Table, base: usize) -> Result<Vec<usize>, ExportError> {
    let mut way = Vec::new();
    let mut at = robot.link_index(&table.tip).unwrap_or(base);
    while let Some(joint) = bodies.to_parent[at].filter(|_| at != base) {
        way.push(joint);
        at = robot.joints[joint].parent;
    }
    way.reverse();
    let in_table = |joint: usize| table.joints.iter().any(|row| row.name == robot.joints[joint].name);
    let mut carriers = Vec::new();
    for row in &table.joints {
        let found = way.iter().position(|joint| robot.joints[*joint].name == row.name);
        let position = found.ok_or_else(|| ExportError::NotInUrdf {
            joint: row.name.clone(),
            what: "it is part of a planar joint, which cannot carry a marker; choose a tip before it".into(),
        })?;
        // A slide driven by the turn before it has no separate row.
        let slide = way[position + 1..]
            .iter()
            .take_while(|joint| robot.joints[**joint].kind == JointKind::Fixed || !in_table(**joint));
        let last = slide.filter(|joint| robot.joints[**joint].kind.moves()).last().unwrap_or(&way[position]);
        carriers.push(robot.joints[*last].child);
    }
    Ok(carriers)
}

/// A joint's value where every free joint's is 0: mimic offsets.
fn value_at_zero(robot: &Robot, joint: &Joint) -> f64 {
    let (mut value, mut scale, mut at) = (0.0, 1.0, joint);
    for _ in 0..=robot.joints.len() {
        let Some(mimic) = &at.mimic else { break };
        value += scale * mimic.offset;
        scale *= mimic.multiplier;
        match robot.joint_index(&mimic.joint) {
            Some(driver) => at = &robot.joints[driver],
            None => break,
        }
    }
    value
}

fn is_marker(name: &str) -> bool {
    name.strip_prefix("dh_").is_some_and(|index| !index.is_empty() && index.bytes().all(|byte| byte.is_ascii_digit()))
}

/// The robot without marker links from an earlier export.
fn without_markers(robot: &Robot) -> Robot {
    let (leaves, carriers) = (robot.leaves(), robot.carriers());
    let marker = |link: usize| {
        let fixed = carriers[link].is_some_and(|joint| robot.joints[joint].kind == JointKind::Fixed);
        is_marker(&robot.links[link].name) && leaves.binary_search(&link).is_ok() && fixed
    };
    let kept: Vec<usize> = (0..robot.links.len()).filter(|link| !marker(*link)).collect();
    let new_index = |old: usize| kept.binary_search(&old).ok();
    let joints = robot.joints.iter().filter_map(|joint| {
        let (parent, child) = (new_index(joint.parent)?, new_index(joint.child)?);
        Some(Joint { parent, child, ..joint.clone() })
    });
    Robot {
        links: kept.iter().map(|link| robot.links[*link].clone()).collect(),
        joints: joints.collect(),
        root: new_index(robot.root).unwrap_or(0),
        ..robot.clone()
    }
}

fn already_there(robot: &Robot, markers: &[Marker]) -> bool {
    markers.iter().all(|marker| {
        let joint = robot.link_index(&marker.name).and_then(|link| robot.joint_to(link));
        joint.map(|joint| &robot.joints[joint]).is_some_and(|joint| {
            let (turned, moved) = se3::difference(&joint.origin.pose(), &marker.numbers.pose());
            let size = marker.numbers.pose().translation.vector.norm().max(1.0);
            robot.links[joint.parent].name == marker.parent && turned < THERE && moved < THERE * size
        })
    })
}
