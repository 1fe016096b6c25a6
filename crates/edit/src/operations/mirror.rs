//! The mirror image: with M the reflection, every pose T becomes M T M, so that equal joint values give mirrored poses.
//!
//! One coordinate of a translation changes sign; of fixed-axis angles and quaternions, the components about axes in the
//! plane do. A revolute joint's axis is a pseudo-vector (-M a), a prismatic joint's a vector (M a); the pitch of a screw
//! changes sign. In a tensor the two products with the reflected coordinate change sign. Boxes, cylinders and
//! spheres are their own mirror images; meshes get a negative scale along the reflected coordinate. Every number keeps
//! its digits, so mirroring twice gives the original file.

use crate::Change;
use crate::claim::{Claim, Compared, Space};
use crate::error::{EditError, refused_at_joint};
use crate::literal::{negated, negated_where};
use crate::operations::rename;
use crate::references::Names;
use crate::tally::Tally;
use crate::value::Plane;
use crate::values::child;
use denavit_export::urdf::text::{Edits, Nodes, Placing, parse, placing};
use denavit_model::posed::{self, Notation, Placed};
use denavit_model::robot::{JointKind, Robot, SourceText};
use denavit_model::urdf;
use roxmltree::Node;

/// Which signs change.
struct Signs {
    index: usize,
    /// Of vectors.
    vector: [bool; 3],
    /// Of angles, and of rotation vectors.
    turn: [bool; 3],
}

/// `names`: pairs of parts of names that are swapped.
///
/// # Errors
/// A joint that has no mirror image, or names that clash.
pub(crate) fn mirror(
    robot: &Robot,
    srdf: Option<&SourceText>,
    plane: Plane,
    names: &[(String, String)],
) -> Result<Change, EditError> {
    let index = plane.index();
    let vector = [0, 1, 2].map(|coordinate| coordinate == index);
    let signs = Signs { index, vector, turn: vector.map(|changes| !changes) };
    let document = parse(robot)?;
    let nodes = Nodes::of(robot, &document)?;
    let mut edits = Edits::default();
    let (mut tally, mut notes) = (Tally::default(), Vec::new());
    for (index, joint) in robot.joints.iter().enumerate() {
        let node = nodes.joint(index);
        origins(robot, &mut edits, node, &signs);
        axis(robot, &mut edits, index, node, &signs)?;
        if matches!(joint.kind, JointKind::Screw(_)) {
            let pitch = node.children().find(|child| child.tag_name().name() == "screw_thread_pitch");
            if let Some(value) = pitch.and_then(|pitch| pitch.attribute_node("value")) {
                edits.replace(value.range_value(), negated(value.value()));
            }
        }
    }
    for index in 0..robot.links.len() {
        let Some(node) = nodes.link(index) else { continue };
        for part in node.children().filter(Node::is_element) {
            match part.tag_name().name() {
                "inertial" => {
                    origins(robot, &mut edits, part, &signs);
                    tensor(&mut edits, part, &signs);
                }
                "visual" | "collision" => {
                    origins(robot, &mut edits, part, &signs);
                    mesh(robot, &mut edits, part, &signs, &mut tally);
                }
                _ => {}
            }
        }
    }
    others(robot, &document, &nodes, &mut edits, &signs, &mut notes)?;
    tally.say(format!("mirrored in the {} plane", plane.name()));
    let mirrored = edits.apply(&robot.source)?;
    let mut claim =
        Claim { space: Space { mirrored: Some(index), scale: 1.0 }, compared: Compared::No, ..Claim::same(robot) };
    let swapped = exchanged(robot, names);
    if swapped.links.is_empty() && swapped.joints.is_empty() {
        return Ok(Change::of(mirrored, srdf, claim, tally, notes));
    }
    let made = urdf::read(&robot.source.file, &mirrored)?;
    let renamed = rename::renamed(&made, srdf, &swapped)?;
    let named = rename::claim(robot, &swapped);
    (claim.links, claim.joints) = (named.links, named.joints);
    tally.say(format!("{} names exchanged", swapped.links.len() + swapped.joints.len()));
    notes.extend(renamed.notes);
    Ok(Change { urdf: renamed.urdf, srdf: renamed.srdf, claim, second: None, files: Vec::new(), tally, notes })
}

/// `xyz`, and `rpy` or `quat_xyzw`, of the `<origin>` children.
fn origins(robot: &Robot, edits: &mut Edits, element: Node, signs: &Signs) {
    let origins = element.children().filter(|node| node.is_element() && node.tag_name().name() == "origin");
    origins.for_each(|origin| attributes(robot, edits, origin, signs));
}

fn attributes(robot: &Robot, edits: &mut Edits, node: Node, signs: &Signs) {
    signs_of(robot, edits, node, "xyz", &signs.vector);
    signs_of(robot, edits, node, "rpy", &signs.turn);
    signs_of(robot, edits, node, "quat_xyzw", &signs.turn);
}

fn signs_of(robot: &Robot, edits: &mut Edits, node: Node, name: &str, negate: &[bool]) {
    let Some(written) = node.attribute(name) else { return };
    let changed = negated_where(written, negate);
    if changed != written {
        edits.attribute(&robot.source, node, name, &changed);
    }
}

fn axis(robot: &Robot, edits: &mut Edits, index: usize, node: Node, signs: &Signs) -> Result<(), EditError> {
    let kind = &robot.joints[index].kind;
    let negate = match kind {
        JointKind::Revolute | JointKind::Continuous | JointKind::Screw(_) | JointKind::Planar => &signs.turn,
        JointKind::Prismatic => &signs.vector,
        JointKind::Fixed | JointKind::Floating => return Ok(()),
        _ => {
            let what = format!("a joint of the unknown kind \"{}\" has no mirror image here", kind.word());
            return Err(refused_at_joint(robot, index, what));
        }
    };
    match child(node, "axis") {
        Some(axis) if axis.has_attribute("xyz") => signs_of(robot, edits, axis, "xyz", negate),
        Some(axis) if negate[0] => edits.attribute(&robot.source, axis, "xyz", "-1 0 0"),
        None if negate[0] => edits.behind_origin(&robot.source, node, "<axis xyz=\"-1 0 0\"/>"),
        _ => {}
    }
    Ok(())
}

fn tensor(edits: &mut Edits, inertial: Node, signs: &Signs) {
    let Some(inertia) = child(inertial, "inertia") else { return };
    for (name, pair) in [("ixy", [0, 1]), ("ixz", [0, 2]), ("iyz", [1, 2])] {
        if let Some(entry) = inertia.attribute_node(name).filter(|_| pair.contains(&signs.index)) {
            edits.replace(entry.range_value(), negated(entry.value()));
        }
    }
}

fn mesh(robot: &Robot, edits: &mut Edits, shape: Node, signs: &Signs, tally: &mut Tally) {
    let Some(mesh) = child(shape, "geometry").and_then(|geometry| child(geometry, "mesh")) else { return };
    tally.count("mesh", "meshes", "reflected by its scale");
    let reflected = [0, 1, 2].map(|index| if signs.vector[index] { "-1" } else { "1" }).join(" ");
    match mesh.attribute("scale") {
        // As it was before it was mirrored.
        Some(written) if written == reflected => {
            let attribute = mesh.attribute_node("scale").map(|attribute| attribute.range());
            let Some(range) = attribute else { return };
            let before = &robot.source.text[..range.start];
            edits.replace(before.trim_end().len()..range.end, "");
        }
        Some(_) => signs_of(robot, edits, mesh, "scale", &signs.vector),
        None => edits.attribute(&robot.source, mesh, "scale", &reflected),
    }
}

/// Poses in other elements: sensors, plugin offsets, loop joints.
fn others(
    robot: &Robot,
    document: &roxmltree::Document,
    nodes: &Nodes,
    edits: &mut Edits,
    signs: &Signs,
    notes: &mut Vec<String>,
) -> Result<(), EditError> {
    for Placing { element, owner, top, inside } in placing(robot, document, nodes) {
        let found = posed::in_element(element, owner);
        if found.iter().any(|posed| matches!(posed.placed, Placed::Pose(_))) && top.tag_name().name() == "gazebo" {
            let place = robot.source.place(element.at, element.label());
            notes.push(format!("{place}: its pose is mirrored, but the sensor itself is not"));
        }
        for posed in found {
            let Some(node) = inside.get(posed.node) else { continue };
            match &posed.notation {
                Notation::Pose { .. } => {
                    // Six numbers or seven: of a quaternion the last stays.
                    let turn = [signs.vector, signs.turn].concat();
                    text(edits, *node, &turn);
                }
                Notation::Attributes { .. } => attributes(robot, edits, *node, signs),
                Notation::Offsets { xyz, rpy } => {
                    for (part, negate) in [(xyz, &signs.vector), (rpy, &signs.turn)] {
                        if let Some(node) = part.and_then(|part| inside.get(part)) {
                            text(edits, *node, negate);
                        }
                    }
                }
                Notation::Text => text(edits, *node, &signs.vector),
                Notation::Attribute(name) => signs_of(robot, edits, *node, name, &signs.vector),
                Notation::Missing(_) => {}
            }
        }
    }
    Ok(())
}

fn text(edits: &mut Edits, node: Node, negate: &[bool]) {
    let Some(inside) = node.children().find(Node::is_text) else { return };
    let written = inside.text().unwrap_or_default();
    let changed = negated_where(written, negate);
    if changed != written {
        edits.replace(inside.range(), changed);
    }
}

/// Names with their parts exchanged: `left_arm` and `right_arm`.
fn exchanged(robot: &Robot, pairs: &[(String, String)]) -> Names {
    let new = |name: &String| {
        let other = pairs.iter().fold(name.clone(), |name, (one, other)| {
            let marked = name.replace(one.as_str(), "\u{0}");
            marked.replace(other.as_str(), one).replace('\u{0}', other)
        });
        (other != *name).then(|| (name.clone(), other))
    };
    Names {
        links: robot.links.iter().filter_map(|link| new(&link.name)).collect(),
        joints: robot.joints.iter().filter_map(|joint| new(&joint.name)).collect(),
    }
}
