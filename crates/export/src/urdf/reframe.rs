//! Re-expresses everything given in the frame of a link in the link's new frame.

use super::bodies::{Bodies, has_axis};
use super::edit::{Edits, written_tag};
use super::frames::{Plan, STAYS};
use super::origin::{axis_as_meant, is, joint_axis, joint_origin, numbers_as, write};
use super::placing::{Placing, placing};
use super::written::{Numbers, clean, three_over, word};
use super::{ExportError, nodes::Nodes};
use denavit_model::element::{Element, ElementNode};
use denavit_model::nalgebra::{Point3, Vector3};
use denavit_model::notes::Note;
use denavit_model::posed::{self, Change, How, Placed, Posed};
use denavit_model::robot::{Robot, SourceText};
use denavit_model::se3::{self, Pose};
use denavit_model::tree::Reading;
use roxmltree::{Document, Node};
use std::collections::{BTreeMap, HashSet};

/// Links with new frames, and the text that refers to the old ones.
pub struct Moves<'a> {
    source: &'a SourceText,
    /// How angles of shapes and centres of mass are read.
    reading: Reading,
    /// new_from_old of each link; `None` where the frame stays.
    pub new_from_old: Vec<Option<Pose>>,
    by_name: BTreeMap<&'a str, Pose>,
}

impl<'a> Moves<'a> {
    /// `poses`: root_from_frame of each link's new frame.
    pub(crate) fn of(robot: &'a Robot, bodies: &Bodies, poses: &[Pose]) -> Self {
        let new_from_old: Vec<Option<Pose>> = poses
            .iter()
            .zip(&bodies.poses)
            .map(|(new, old)| {
                let step = new.inverse() * old;
                let (turned, moved) = se3::difference(&Pose::identity(), &step);
                (turned > STAYS || moved > STAYS * bodies.size).then_some(step)
            })
            .collect();
        Self::by_steps(robot, bodies.reading, new_from_old)
    }

    /// `new_from_old` of each link, `None` where the frame stays; `reading`: how angles of shapes and centres of mass are read.
    pub fn by_steps(robot: &'a Robot, reading: Reading, new_from_old: Vec<Option<Pose>>) -> Self {
        let named = robot.links.iter().zip(&new_from_old);
        let mut by_name: BTreeMap<&str, Pose> =
            named.filter_map(|(link, step)| Some((link.name.as_str(), (*step)?))).collect();
        // A joint's frame is that of its child link.
        let links: HashSet<&str> = robot.links.iter().map(|link| link.name.as_str()).collect();
        for joint in robot.joints.iter().filter(|joint| !links.contains(joint.name.as_str())) {
            by_name.extend(new_from_old[joint.child].map(|step| (joint.name.as_str(), step)));
        }
        Self { source: &robot.source, reading, new_from_old, by_name }
    }

    /// Moves the `<origin>` children of an element; adds one if there is none.
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

    /// Re-expresses the shapes and the mass of a link in the frame that `step` leads to.
    pub fn shapes(&self, edits: &mut Edits, link: Node, step: &Pose) {
        let shape =
            |part: &Node| part.is_element() && matches!(part.tag_name().name(), "inertial" | "visual" | "collision");
        for part in link.children().filter(shape) {
            // As a comparison reads them.
            self.origins_in(edits, part, step, self.reading);
        }
    }

    /// Moves the poses of another element in a link's frame, each in its own notation.
    fn element(&self, edits: &mut Edits, placing: &Placing) -> Result<(), ExportError> {
        let Placing { element, owner, inside, .. } = placing;
        let found = posed::in_element(element, *owner);
        self.refuse_what_is_no_pose(element, &found)?;
        for part in found {
            let posed::Frame::Named(name) = &part.frame else { continue };
            let Some(step) = self.by_name.get(name.as_str()) else { continue };
            let placed = match &part.placed {
                Placed::Pose(old) => {
                    let numbers = moved(step, &Numbers::of(old, 0.0));
                    Placed::Pose(se3::pose((step * old).rotation, Vector3::from(numbers.xyz)))
                }
                Placed::Point(old) => Placed::Point(cleaned(&(step * Point3::from(*old)).coords, step)),
                Placed::Direction(old) => Placed::Direction(cleaned(&(step.rotation * old), &Pose::identity())),
            };
            for Change { node, how, numbers } in part.rewritten(&placed) {
                let node = *inside.get(node).ok_or_else(|| self.unfaithful(node))?;
                self.change(edits, node, how, &numbers)?;
            }
        }
        Ok(())
    }

    fn change(&self, edits: &mut Edits, node: Node, how: How, numbers: &[f64]) -> Result<(), ExportError> {
        let text = numbers.iter().map(|number| word(clean(*number, 0.0))).collect::<Vec<_>>().join(" ");
        match how {
            How::Text => {
                let mut texts = node.children().filter(Node::is_text);
                match (texts.next(), texts.next()) {
                    (_, Some(_)) => return Err(self.unfaithful(node.range().start)),
                    (Some(inside), None) => edits.replace(inside.range(), text),
                    (None, None) => edits.first_child(self.source, node, &text),
                }
            }
            How::Attribute(name) => {
                let text = match (node.attribute(name), numbers) {
                    (Some(written), [x, y, z]) => three_over(written, [*x, *y, *z], 1.0),
                    (None, numbers) if numbers.iter().all(|number| *number == 0.0) => return Ok(()),
                    _ => text,
                };
                if node.attribute(name) != Some(text.as_str()) {
                    edits.attribute(self.source, node, name, &text);
                }
            }
            How::NewPose => edits.first_child(self.source, node, &format!("<pose>{text}</pose>")),
            How::NewOrigin => {
                let [x, y, z, roll, pitch, yaw] = *numbers else { return Err(self.unfaithful(node.range().start)) };
                let origin = Numbers { xyz: [x, y, z], rpy: [roll, pitch, yaw] };
                edits.first_child(self.source, node, &origin.element());
            }
            How::OtherOffset => {
                let tag = written_tag(self.source, node);
                let other = if tag.contains("xyz") { tag.replace("xyz", "rpy") } else { tag.replace("rpy", "xyz") };
                edits.lines_behind(self.source, node, &[format!("<{other}>{text}</{other}>")]);
            }
        }
        Ok(())
    }

    /// Refuses a sensor's `<pose>` that is not a pose, because it cannot follow the frame.
    fn refuse_what_is_no_pose(&self, element: &Element, found: &[Posed]) -> Result<(), ExportError> {
        let Some(top) = element.nodes.first() else { return Ok(()) };
        let moves =
            top.tag == "gazebo" && top.attribute("reference").is_some_and(|link| self.by_name.contains_key(link));
        let lost = |(index, node): (usize, &ElementNode)| {
            node.tag == "pose" && node.depth == 2 && !found.iter().any(|posed| posed.node == index)
        };
        if moves && element.nodes.iter().enumerate().any(lost) {
            let place = self.source.place(element.at, element.label());
            let what = "its <pose> is not a valid pose, so it cannot move with its link; write x y z roll pitch yaw, \
                        or with rotation_format=\"quat_xyzw\" x y z and a quaternion";
            return Err(ExportError::NotCarried { place, what: what.into() });
        }
        Ok(())
    }

    /// Rewrites everything in a link whose frame moves: shapes, centres of mass, and poses in other elements.
    /// Joints are not touched.
    ///
    /// # Errors
    /// A pose that cannot be rewritten.
    pub fn contents(
        &self,
        robot: &Robot,
        document: &Document,
        nodes: &Nodes,
        edits: &mut Edits,
    ) -> Result<(), ExportError> {
        for (index, step) in self.new_from_old.iter().enumerate() {
            if let (Some(step), Some(node)) = (step, nodes.link(index)) {
                self.shapes(edits, node, step);
            }
        }
        for placing in placing(robot, document, nodes) {
            self.element(edits, &placing)?;
        }
        Ok(())
    }

    /// Notes on settings that name links: they now apply to the new frames.
    pub fn plugins_that_name(&self, robot: &Robot, document: &Document) -> Vec<Note> {
        let named = document.descendants().filter(|node| {
            let names = node.is_element() && node.first_element_child().is_none();
            names
                && node.text().is_some_and(|text| self.by_name.contains_key(text.trim()))
                && node.ancestors().any(|above| is(&above, "gazebo"))
        });
        let named: Vec<Node> = named.collect();
        let Some(first) = named.first() else { return Vec::new() };
        let tag = first.tag_name().name();
        let place = robot.source.place(first.range().start, format!("<{tag}>"));
        let what = format!(
            "simulator settings name links whose frames move ({} in total, this one \"{}\"); they now act at the new \
             frames, ‹keep-link-frames› keeps the old frames",
            named.len(),
            first.text().unwrap_or_default().trim()
        );
        vec![Note::Corrected { place, what }]
    }

    fn unfaithful(&self, at: usize) -> ExportError {
        ExportError::Unfaithful {
            file: self.source.file.clone(),
            what: format!("a pose at line {} is not in the text itself", self.source.line(at)),
        }
    }
}

fn cleaned(vector: &Vector3<f64>, step: &Pose) -> Vector3<f64> {
    let scale = step.translation.vector.amax() + vector.amax();
    vector.map(|x| clean(x, scale))
}

/// Moves joint origins and axes, and everything given in a link whose frame moves.
pub(crate) fn edit(
    robot: &Robot,
    document: &Document,
    bodies: &Bodies,
    plan: &Plan,
    edits: &mut Edits,
) -> Result<Vec<Note>, ExportError> {
    let moves = Moves::of(robot, bodies, &plan.poses(bodies));
    let nodes = Nodes::of(robot, document)?;
    let seen = |joint: usize| match moves.new_from_old[robot.joints[joint].parent] {
        Some(step) => moved(&step, &bodies.origins[joint]),
        None => bodies.origins[joint],
    };
    // body_from_link along fixed joints, as it will be written.
    let mut within = vec![Pose::identity(); robot.links.len()];
    for link in &bodies.order {
        if let Some(joint) = bodies.to_parent[*link].filter(|_| *link != bodies.body[*link]) {
            within[*link] = within[robot.joints[joint].parent] * seen(joint).pose();
        }
    }
    for (index, joint) in robot.joints.iter().enumerate() {
        let node = nodes.joint(index);
        if let Some(row) = plan.rows[index].filter(|_| !plan.kept[joint.child]) {
            let from = plan.from[index];
            let numbers = if joint.parent == from {
                row
            } else {
                let step = within[joint.parent].inverse() * within[from];
                Numbers::of(&(step * row.pose()), bodies.size)
            };
            joint_origin(&robot.source, edits, node, &numbers);
            joint_axis(&robot.source, edits, node);
            continue;
        }
        if moves.new_from_old[joint.parent].is_some() || bodies.reread[index] {
            joint_origin(&robot.source, edits, node, &seen(index));
        }
        if has_axis(&joint.kind) {
            axis_as_meant(&robot.source, edits, node, bodies.axes[index].into_inner().into());
        }
    }
    moves.contents(robot, document, &nodes, edits)?;
    Ok(moves.plugins_that_name(robot, document))
}

/// The length whose rounding a re-expressed translation carries, m.
fn scale(step: &Pose, old: &Numbers) -> f64 {
    let length = |xyz: [f64; 3]| xyz.iter().fold(0.0, |a: f64, b| a.max(b.abs()));
    length(step.translation.vector.into()) + length(old.xyz)
}

fn moved(step: &Pose, old: &Numbers) -> Numbers {
    Numbers::of(&(step * old.pose()), scale(step, old))
}
