//! Everything that a text gives in the frame of a link, given in the link's new frame.

use super::bodies::{Bodies, has_axis};
use super::edit::Edits;
use super::frames::Plan;
use super::origin::{axis_as_meant, is, joint_axis, joint_origin, numbers_as, numbers_of, write, write_xyz};
use super::written::{Numbers, three};
use super::{ExportError, nodes::Nodes};
use denavit_model::notes::Note;
use denavit_model::robot::{Robot, SourceText};
use denavit_model::se3::{self, Pose};
use denavit_model::tree::Reading;
use roxmltree::{Document, Node};
use std::collections::BTreeMap;

/// A frame that moves by no more (rad, and m relative to the robot's size) stays: the rounding of the products that
/// lead to it.
const STAYS: f64 = 3e-14;

/// Frames by link.
pub(crate) struct Moves<'a> {
    source: &'a SourceText,
    /// How angles of shapes and centres of mass are read.
    reading: Reading,
    /// new_from_old of each link; `None` where the frame stays.
    pub new_from_old: Vec<Option<Pose>>,
    by_name: BTreeMap<&'a str, Pose>,
}

impl<'a> Moves<'a> {
    pub fn of(robot: &'a Robot, bodies: &Bodies, plan: &Plan) -> Self {
        let new_from_old: Vec<Option<Pose>> = plan
            .poses
            .iter()
            .zip(&bodies.poses)
            .map(|(new, old)| {
                let step = new.inverse() * old;
                let (turned, moved) = se3::difference(&Pose::identity(), &step);
                (turned > STAYS || moved > STAYS * bodies.size).then_some(step)
            })
            .collect();
        let named = robot.links.iter().zip(&new_from_old);
        let by_name = named.filter_map(|(link, step)| Some((link.name.as_str(), (*step)?))).collect();
        Self { source: &robot.source, reading: bodies.reading, new_from_old, by_name }
    }

    /// The `<origin>` children of an element, moved; one is put in where there is none.
    fn origins_in(&self, edits: &mut Edits, element: Node, step: &Pose, reading: Reading) {
        let mut found = false;
        for origin in element.children().filter(|child| is(child, "origin")) {
            found = true;
            if let Some(old) = numbers_as(origin, reading) {
                write(self.source, edits, origin, (&old, &moved(step, &old)), scale(step, &old));
            }
        }
        if !found && element.first_element_child().is_some() {
            let numbers = moved(step, &Numbers::default());
            edits.first_child(self.source, element, &numbers.element());
        }
    }

    fn link(&self, edits: &mut Edits, link: Node, step: &Pose) {
        for part in link.children().filter(|part| part.is_element() && !is(part, "origin")) {
            let has = |tag| part.children().any(|child| is(&child, tag));
            let shape = matches!(part.tag_name().name(), "inertial" | "visual" | "collision");
            if shape || has("origin") || has("geometry") {
                // As a comparison reads both.
                let reading = if shape { self.reading } else { Reading::AsWritten };
                self.origins_in(edits, part, step, reading);
            }
        }
    }

    /// Sensors, lights and shapes inside `<gazebo reference="link">`.
    fn gazebo(&self, edits: &mut Edits, gazebo: Node, step: &Pose) {
        for part in gazebo.children().filter(Node::is_element) {
            let tag = part.tag_name().name();
            let sits_in_the_link = matches!(tag, "sensor" | "light" | "projector" | "particle_emitter");
            let pose = part.children().find(|child| is(child, "pose"));
            match pose {
                Some(pose) if sits_in_the_link || matches!(tag, "visual" | "collision") => {
                    self.pose_element(edits, pose, step);
                }
                None if sits_in_the_link && part.first_element_child().is_some() => {
                    let text = six(&moved(step, &Numbers::default()));
                    edits.first_child(self.source, part, &format!("<pose>{text}</pose>"));
                }
                _ => {}
            }
        }
    }

    /// `<pose>x y z roll pitch yaw</pose>`, unless it is relative to another frame.
    fn pose_element(&self, edits: &mut Edits, pose: Node, step: &Pose) {
        let elsewhere =
            pose.attribute("relative_to").or(pose.attribute("frame")).is_some_and(|frame| !frame.is_empty());
        let otherwise = pose.attribute("rotation_format").is_some() || pose.attribute("degrees").is_some();
        if elsewhere || otherwise {
            return;
        }
        let written = pose.text().unwrap_or_default();
        let words: Option<Vec<f64>> = written.split_whitespace().map(|word| word.parse().ok()).collect();
        let old = match words.as_deref() {
            Some([x, y, z, roll, pitch, yaw]) => Numbers { xyz: [*x, *y, *z], rpy: [*roll, *pitch, *yaw] },
            Some([]) => Numbers::default(),
            _ => return,
        };
        let text = six(&moved(step, &old));
        match pose.children().find(Node::is_text) {
            Some(inside) => edits.replace(inside.range(), text),
            None => edits.first_child(self.source, pose, &text),
        }
    }

    /// Drake's frames, loop joints and cables: elements with `link`, `xyz` and `rpy` attributes.
    fn attached(&self, edits: &mut Edits, element: Node) {
        for node in element.descendants().filter(Node::is_element) {
            let Some(step) = node.attribute("link").and_then(|link| self.by_name.get(link)) else { continue };
            let tag = node.tag_name().name();
            let placed = node.attribute("xyz").is_some() || node.attribute("rpy").is_some();
            let Some(old) = numbers_of(node) else { continue };
            if tag == "parent" {
                if let Some(owner) = node.parent_element() {
                    self.origins_in(edits, owner, step, Reading::AsWritten);
                }
            } else if matches!(tag, "frame" | "link1" | "link2") {
                write(self.source, edits, node, (&old, &moved(step, &old)), scale(step, &old));
            } else if placed {
                write_xyz(self.source, edits, node, moved(step, &old).xyz, scale(step, &old));
                if node.attribute("rpy").is_some() {
                    write(self.source, edits, node, (&old, &moved(step, &old)), scale(step, &old));
                }
            }
        }
    }
}

/// Moves joint origins and axes, and everything that is given in a link whose frame moves.
pub(crate) fn edit(
    robot: &Robot,
    document: &Document,
    bodies: &Bodies,
    plan: &Plan,
    edits: &mut Edits,
) -> Result<Vec<Note>, ExportError> {
    let moves = Moves::of(robot, bodies, plan);
    let nodes = Nodes::of(robot, document)?;
    for (index, joint) in robot.joints.iter().enumerate() {
        let node = nodes.joint(index);
        if let Some(numbers) = plan.origins[index].filter(|_| has_axis(&joint.kind)) {
            joint_origin(&robot.source, edits, node, &numbers);
            joint_axis(&robot.source, edits, node);
            continue;
        }
        if has_axis(&joint.kind) {
            axis_as_meant(&robot.source, edits, node, bodies.axes[index].into_inner().into());
        }
        let old = bodies.origins[index];
        let on_the_way = !joint.kind.moves() && bodies.on_the_way[joint.child];
        let numbers = match moves.new_from_old[joint.parent] {
            _ if on_the_way => Numbers::default(),
            Some(step) => moved(&step, &old),
            None if bodies.reread[index] => old,
            None => continue,
        };
        joint_origin(&robot.source, edits, node, &numbers);
    }
    for (index, step) in moves.new_from_old.iter().enumerate() {
        if let (Some(step), Some(node)) = (step, nodes.link(index)) {
            moves.link(edits, node, step);
        }
    }
    for node in document.root_element().children().filter(Node::is_element) {
        match node.tag_name().name() {
            "link" | "joint" | "transmission" | "ros2_control" | "material" => {}
            "gazebo" => {
                if let Some(step) = node.attribute("reference").and_then(|link| moves.by_name.get(link)) {
                    moves.gazebo(edits, node, step);
                }
            }
            _ => moves.attached(edits, node),
        }
    }
    Ok(plugins_that_name(robot, document, &moves))
}

/// What programs beside the robot are told by link name: they get the new frames.
fn plugins_that_name(robot: &Robot, document: &Document, moves: &Moves) -> Vec<Note> {
    let named = document.descendants().filter(|node| {
        let names = node.is_element() && node.first_element_child().is_none();
        names
            && node.text().is_some_and(|text| moves.by_name.contains_key(text.trim()))
            && node.ancestors().any(|above| is(&above, "gazebo"))
    });
    let named: Vec<Node> = named.collect();
    let Some(first) = named.first() else { return Vec::new() };
    let tag = first.tag_name().name();
    let place = robot.source.place(first.range().start, format!("<{tag}>"));
    let what = format!(
        "simulator settings name links whose frames move ({} in all, this one \"{}\"); they now act at the new frames, \
         ‹keep-link-frames› leaves the old ones where they are",
        named.len(),
        first.text().unwrap_or_default().trim()
    );
    vec![Note::Mended { place, what }]
}

/// The length whose rounding a re-expressed translation carries, m.
fn scale(step: &Pose, old: &Numbers) -> f64 {
    let length = |xyz: [f64; 3]| xyz.iter().fold(0.0, |a: f64, b| a.max(b.abs()));
    length(step.translation.vector.into()) + length(old.xyz)
}

fn moved(step: &Pose, old: &Numbers) -> Numbers {
    Numbers::of(&(step * old.pose()), scale(step, old))
}

fn six(numbers: &Numbers) -> String {
    format!("{} {}", three(numbers.xyz), three(numbers.rpy))
}
