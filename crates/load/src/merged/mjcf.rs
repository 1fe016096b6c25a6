//! Edits in an MJCF: ranges, damping and friction of joints, their axes, where bodies are, what they weigh.

use super::{Edits, Merged, along_link, carrier, child, joint, link, named, parsed, words};
use denavit_model::robot::{Joint, JointKind};
use denavit_model::{Robot, se3};
use roxmltree::{Document, Node};

/// Every form of an orientation; an element has one of them.
const TURNS: [&str; 5] = ["quat", "axisangle", "euler", "xyaxes", "zaxis"];

pub(super) fn merged(text: &str, before: &Robot, after: &Robot) -> Option<Merged> {
    let document = parsed(text)?;
    let compilers = document.descendants().filter(|node| node.tag_name().name() == "compiler");
    let in_rad = compilers.rev().find_map(|node| node.attribute("angle")) == Some("radian");
    let unit = if in_rad { 1.0 } else { 1.0_f64.to_radians() };
    let mut edits = Edits::of(text);
    for is in &after.joints {
        let Some(was) = joint(before, &is.name) else { continue };
        if let Some(node) = named(&document, "joint", &is.name) {
            of_joint(&mut edits, node, was, is, unit);
        }
    }
    for is in &after.links {
        let Some(was) = link(before, &is.name) else { continue };
        if let Some(node) = named(&document, "body", &is.name) {
            of_body(&mut edits, &document, node, [carrier(before, &is.name), carrier(after, &is.name)]);
            if let (true, Some(inertial), Some(stated)) =
                (was.inertial != is.inertial, &is.inertial, child(node, "inertial"))
            {
                let (mass, centre, tensor) = along_link(inertial);
                let new = format!(
                    "<inertial pos=\"{}\" mass=\"{mass}\" fullinertia=\"{}\"/>",
                    words(&centre),
                    words(&tensor)
                );
                edits.replace(stated.range(), new);
            }
        }
    }
    let (text, changes) = edits.finished()?;
    Some(Merged { text, changes, lost: Vec::new() })
}

fn of_joint<'a>(edits: &mut Edits<'a>, node: Node<'a, 'a>, was: &Joint, is: &Joint, unit: f64) {
    let unit = if is.kind == JointKind::Prismatic { 1.0 } else { unit };
    if was.limits.range != is.limits.range || was.kind != is.kind {
        match is.limits_in_force().range {
            Some((lower, upper)) => {
                edits.set_attribute(node, "range", &words(&[lower / unit, upper / unit]));
                if was.limits_in_force().range.is_none() {
                    edits.set_attribute(node, "limited", "true");
                }
            }
            None => edits.set_attribute(node, "limited", "false"),
        }
    }
    let (one, two) = (was.dynamics(), is.dynamics());
    for (name, was, is) in [("damping", one.damping, two.damping), ("frictionloss", one.friction, two.friction)] {
        if was != is {
            edits.set_attribute(node, name, &is.to_string());
        }
    }
    if let (true, Some(axis)) = (was.axis_written != is.axis_written, is.axis_written) {
        edits.set_attribute(node, "axis", &words(&axis));
    }
}

/// Where a body is, if nothing but its own place says so: no frame around it, no joint beside its origin or with a reference.
fn of_body<'a>(edits: &mut Edits<'a>, document: &'a Document<'a>, node: Node<'a, 'a>, [was, is]: [Option<&Joint>; 2]) {
    let (Some(was), Some(is)) = (was, is) else { return };
    if was.origin == is.origin {
        return;
    }
    let joints: Vec<Node> = node.children().filter(|child| child.tag_name().name() == "joint").collect();
    let classes = document.descendants().any(|node| {
        let in_class = node.ancestors().any(|above| above.tag_name().name() == "default");
        in_class && node.tag_name().name() == "joint" && (node.has_attribute("ref") || node.has_attribute("pos"))
    });
    let plain = joints.iter().all(|joint| !joint.has_attribute("ref") && !joint.has_attribute("pos"));
    let framed = node.ancestors().any(|above| above.tag_name().name() == "frame");
    if joints.len() > 1 || classes || !plain || framed {
        return;
    }
    if was.origin.xyz != is.origin.xyz {
        edits.set_attribute(node, "pos", &words(&is.origin.xyz));
    }
    if was.origin.rpy != is.origin.rpy {
        let [x, y, z, w] = se3::quaternion_xyzw(&se3::rotation_from_rpy(is.origin.rpy));
        TURNS.iter().filter(|turn| **turn != "quat").for_each(|turn| edits.remove_attribute(node, turn));
        edits.set_attribute(node, "quat", &words(&[w, x, y, z]));
    }
}
