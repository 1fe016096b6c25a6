//! D-H frames in new links; every old frame keeps its name and is fixed to them.

use super::ExportError;
use super::bodies::{Bodies, has_axis};
use super::edit::{Edits, escaped};
use super::frames::Plan;
use super::nodes::Nodes;
use super::origin::{axis_as_meant, joint_axis, joint_origin};
use super::reframe::Moves;
use super::written::Numbers;
use denavit_model::robot::Robot;
use roxmltree::{Document, Node};
use std::collections::HashMap;

/// Suffix of the link with a link's D-H frame.
const SUFFIX: &str = "_dh";

/// Joints lead to the D-H frames, which carry the old links: nothing given in a link's frame changes.
pub(crate) fn edit(
    robot: &Robot,
    document: &Document,
    bodies: &Bodies,
    plan: &Plan,
    edits: &mut Edits,
) -> Result<(), ExportError> {
    let moves = Moves::of(robot, bodies, &plan.frames);
    let nodes = Nodes::of(robot, document)?;
    let dh_name = |link: usize| {
        let name = &robot.links[link].name;
        if moves.new_from_old[link].is_some() { format!("{name}{SUFFIX}") } else { name.clone() }
    };
    let links: HashMap<&str, usize> = robot.links.iter().map(|link| (link.name.as_str(), link.at)).collect();
    let joints: HashMap<&str, usize> = robot.joints.iter().map(|joint| (joint.name.as_str(), joint.at)).collect();
    for (index, joint) in robot.joints.iter().enumerate() {
        let node = nodes.joint(index);
        let Some(numbers) = plan.rows[index] else {
            if bodies.reread[index] {
                joint_origin(&robot.source, edits, node, &bodies.origins[index]);
            }
            if has_axis(&joint.kind) {
                axis_as_meant(&robot.source, edits, node, bodies.axes[index].into_inner().into());
            }
            continue;
        };
        joint_origin(&robot.source, edits, node, &numbers);
        joint_axis(&robot.source, edits, node);
        let from = plan.from[index];
        // A named base starts at its own frame.
        let own = plan.kept[from] || from != bodies.body[joint.parent];
        let parent = if own { robot.links[from].name.clone() } else { dh_name(from) };
        set_end(robot, edits, node, "parent", &robot.links[joint.parent].name, &parent);
        let Some(step) = moves.new_from_old[joint.child] else { continue };
        let old = &robot.links[joint.child].name;
        let new = dh_name(joint.child);
        let holder = format!("{new}_to_{old}");
        free(robot, links.get(new.as_str()).map(|at| ("link", *at, new.as_str())))?;
        free(robot, joints.get(holder.as_str()).map(|at| ("joint", *at, holder.as_str())))?;
        set_end(robot, edits, node, "child", old, &new);
        let scale = step.translation.vector.norm();
        edits.lines_behind(
            &robot.source,
            node,
            &[
                format!("<link name=\"{}\"/>", escaped(&new)),
                format!(
                    "<joint name=\"{}\" type=\"fixed\"><parent link=\"{}\"/><child link=\"{}\"/>{}</joint>",
                    escaped(&holder),
                    escaped(&new),
                    escaped(old),
                    Numbers::of(&step, scale).element()
                ),
            ],
        );
    }
    Ok(())
}

fn set_end(robot: &Robot, edits: &mut Edits, joint: Node, role: &str, old: &str, new: &str) {
    let end = joint.children().find(|child| child.is_element() && child.tag_name().name() == role);
    if let (Some(end), true) = (end, old != new) {
        edits.attribute(&robot.source, end, "link", new);
    }
}

/// # Errors
/// There is an element of that name.
pub(crate) fn free(robot: &Robot, taken: Option<(&str, usize, &str)>) -> Result<(), ExportError> {
    match taken {
        None => Ok(()),
        Some((tag, at, name)) => {
            Err(ExportError::NameTaken { place: robot.source.place(at, format!("{tag} \"{name}\"")) })
        }
    }
}
