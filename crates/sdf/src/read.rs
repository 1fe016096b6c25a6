//! From links, joints and frames to URDF text.

use crate::error::SdfProblemKind as Kind;
use crate::frames::{FrameId, WORLD};
use crate::gearbox;
use crate::includes::Fetch;
use crate::inertia;
use crate::joints::{self, Axis, Motion};
use crate::known::{COLLISION, JOINT, Known, LINK, VISUAL, tag_of};
use crate::model::{Joint, Link, Model, Part, Reader};
use crate::names::fresh;
use crate::pose::{self, Step, numbers, text_of};
use crate::shapes;
use crate::sources::Sources;
use crate::tree::{Edge, Role, Tree, tree};
use denavit_model::formats::{Builder, Format, FormatError};
use denavit_model::well_formed::unbound_prefixes;
use denavit_model::write::escaped;
use std::collections::{HashMap, HashSet};

/// Reads an SDF: gives URDF text of the same robot, which holds the places of the SDF.
///
/// `file` is the name in messages; `fetch` gives what it includes. SDF 1.2 to 1.12 are read, each by its own rules: up
/// to 1.4 axes are given in the model frame, up to 1.6 where `use_parent_model_frame` says so, later where `expressed_in` says.
///
/// Links keep their frames. What is a graph in SDF becomes a tree: the root is the world where a joint starts there, else the
/// canonical link; a joint that points towards the root is reversed; further joints to a link that is already carried are
/// kept as closed loops; links that no joint carries float. A joint whose frame is not its child's gets a massless link between;
/// so do joints of two or three axes. Frames become massless links. What URDF cannot state is kept in `<gazebo>`.
///
/// # Errors
/// Everything that is wrong with the SDF, each with file, line and element.
///
/// # Source
/// <http://sdformat.org/spec>; pitch of a screw joint in m per rad: `screw_thread_pitch`/2π = -1/`thread_pitch`.
///
/// # Examples
/// ```
/// let sdf = r#"<sdf version="1.9"><model name="lift"><link name="base"/><link name="nut"><pose>0 0 1 0 0 0</pose></link>
///   <joint name="spindle" type="screw"><parent>base</parent><child>nut</child>
///     <screw_thread_pitch>0.01</screw_thread_pitch><axis><xyz>0 0 1</xyz></axis></joint></model></sdf>"#;
/// let urdf = denavit_sdf::read("lift.sdf", sdf, &mut denavit_sdf::includes::nothing).unwrap();
/// let robot = denavit_model::urdf::read("lift.sdf", &urdf)?;
/// assert_eq!(robot.joints[0].origin.xyz, [0.0, 0.0, 1.0]);
/// assert_eq!(robot.joint_place(0).to_string(), "lift.sdf:2: joint \"spindle\"");
/// # Ok::<(), denavit_model::UrdfError>(())
/// ```
pub fn read(file: &str, text: &str, fetch: &mut Fetch) -> Result<String, FormatError> {
    Ok(translated(file, text, fetch)?.text())
}

/// As [`read`], for [`Builder::robot`].
///
/// # Errors
/// Those of [`read`].
pub fn translated(file: &str, text: &str, fetch: &mut Fetch) -> Result<Builder, FormatError> {
    let sources = Sources::gathered(file, text, fetch);
    let (documents, problems) = sources.documents();
    let mut reader = Reader::new(&sources, &documents);
    reader.problems.extend(problems);
    let model = if reader.problems.is_empty() { reader.model() } else { None };
    let body = match model.filter(|_| reader.problems.is_empty()) {
        Some(model) => Translator::new(reader, &model).translated(),
        None => Err(reader),
    };
    body.map_err(|reader| {
        let mut problems = reader.problems;
        problems.sort_by_key(|a| (a.place.file != file, a.place.line));
        FormatError {
            problems: problems.into_iter().map(|problem| (problem.place, problem.kind.to_string())).collect(),
        }
    })
}

/// A file of the source and a line in it.
pub(crate) type Line = (usize, usize);

struct Translator<'a, 'm> {
    reader: Reader<'a>,
    model: &'m Model<'a>,
    lines: Vec<(Line, String)>,
    /// The name of each body in the URDF.
    names: HashMap<FrameId, String>,
    links: HashSet<String>,
    joints: HashSet<String>,
    /// What is kept is written after links and joints.
    further: Vec<(Line, String)>,
}

impl<'a, 'm> Translator<'a, 'm> {
    fn new(reader: Reader<'a>, model: &'m Model<'a>) -> Self {
        Self {
            reader,
            model,
            lines: Vec::new(),
            names: HashMap::new(),
            links: HashSet::new(),
            joints: HashSet::new(),
            further: Vec::new(),
        }
    }

    fn translated(mut self) -> Result<Builder, Reader<'a>> {
        let model = self.model;
        let frames = &model.frames;
        let bodies: Vec<FrameId> = model.links.iter().map(|link| link.frame).collect();
        for link in &model.links {
            let name = frames.all[link.frame].name.clone();
            self.names.insert(link.frame, name.clone());
            self.links.insert(name);
        }
        self.joints = model.joints.iter().map(|joint| joint.name.clone()).collect();
        let motions: Vec<Option<Motion>> = model.joints.iter().map(|joint| self.motion(joint)).collect();
        if !self.reader.problems.is_empty() {
            return Err(self.reader);
        }
        let body = |frame: FrameId| frames.all[frame].body;
        let in_tree: Vec<usize> =
            (0..model.joints.len()).filter(|joint| !matches!(motions[*joint], None | Some(Motion::Gearbox))).collect();
        let edges: Vec<Edge> = in_tree
            .iter()
            .map(|joint| Edge { parent: body(model.joints[*joint].parent), child: body(model.joints[*joint].child) })
            .collect();
        let tree = tree(&bodies, &edges, model.canonical);
        if tree.root == WORLD {
            self.names.insert(WORLD, "world".to_owned());
            self.links.insert("world".to_owned());
            self.line(model.part, "  <link name=\"world\"/>");
        }
        for link in &model.links {
            self.link(link);
        }
        self.frames();
        let (mimics, expressed) = gearbox::couplings(model, &motions, &mut self.reader);
        for (joint, role) in in_tree.iter().zip(&tree.roles) {
            if let Some(motion) = &motions[*joint] {
                self.joint(&model.joints[*joint], motion, *role, mimics.get(joint).map(String::as_str));
            }
        }
        for (index, joint) in model.joints.iter().enumerate() {
            if matches!(motions[index], Some(Motion::Gearbox)) && !expressed.contains(&index) {
                self.carry_joint(joint);
            }
        }
        self.free(&tree);
        inertia::say_defaults(&mut self.reader);
        self.of_model(&tree);
        if self.reader.problems.is_empty() { Ok(self.builder()) } else { Err(self.reader) }
    }

    /// The whole text.
    fn builder(mut self) -> Builder {
        let mut builder = Builder::new(Format::Sdf, self.reader.sources.files[0].name.clone());
        builder.translation.files = self.reader.sources.files.iter().map(|file| file.name.clone()).collect();
        builder.translation.notes = std::mem::take(&mut self.reader.notes);
        builder.translation.findings = std::mem::take(&mut self.reader.findings);
        builder.translation.kept = std::mem::take(&mut self.reader.kept);
        builder.translation.understood = self.reader.understood;
        let first = self.line_of(self.model.part);
        let text = self.further.iter().fold(String::new(), |text, (_, line)| text + line + "\n");
        let declared = crate::sources::declarations(&unbound_prefixes(&text));
        let screws = self.lines.iter().any(|(_, line)| line.contains("<drake:"));
        let drake = if screws && !declared.contains(":drake=") { " xmlns:drake=\"http://drake.mit.edu\"" } else { "" };
        builder.line(first, &format!("<robot name=\"{}\"{declared}{drake}>", escaped(&self.model.name)));
        for (line, text) in self.lines.iter().chain(&self.further) {
            builder.line(*line, text);
        }
        builder.line(first, "</robot>");
        builder
    }

    fn line_of(&self, part: Part) -> Line {
        (part.file, self.reader.sources.files[part.file].line(part.node.range().start))
    }

    fn line(&mut self, part: Part, text: impl Into<String>) {
        let line = self.line_of(part);
        self.lines.push((line, text.into()));
    }

    fn link(&mut self, link: &Link<'a>) {
        let name = escaped(&self.names[&link.frame]);
        self.line(link.part, format!("  <link name=\"{name}\">"));
        let inertial = inertia::of_link(&mut self.reader, self.model, link);
        if let Some((part, text)) = inertial {
            self.line(part, format!("    {text}"));
        }
        // What the URDF's own elements cannot state: of the link, then of each shape.
        let mut kept: Vec<(Line, String)> = Vec::new();
        for part in link.part.children("visual").chain(link.part.children("collision")) {
            let tag = part.node.tag_name().name();
            let Some(text) = shapes::shape(&mut self.reader, self.model, link, part) else {
                self.copy(&mut kept, part);
                continue;
            };
            self.line(part, format!("    {text}"));
            if tag == "visual" {
                self.rest(&mut kept, part, &VISUAL, &["material"], true);
            } else {
                self.rest(&mut kept, part, &COLLISION, &["surface"], true);
            }
        }
        self.line(link.part, "  </link>");
        let mut own = Vec::new();
        self.rest(&mut own, link.part, &LINK, &["visual", "collision"], false);
        own.extend(kept);
        self.gazebo(link.part, Some(&name), own);
    }

    /// Puts lines into a `<gazebo>`.
    fn gazebo(&mut self, part: Part, reference: Option<&str>, lines: Vec<(Line, String)>) {
        if lines.is_empty() {
            return;
        }
        let line = self.line_of(part);
        let reference = reference.map_or_else(String::new, |name| format!(" reference=\"{name}\""));
        self.further.push((line, format!("  <gazebo{reference}>")));
        self.further.extend(lines);
        self.further.push((line, "  </gazebo>".to_owned()));
    }

    /// An element as it is in the file.
    fn copy(&self, out: &mut Vec<(Line, String)>, part: Part) {
        let (file, first) = self.line_of(part);
        let text = &self.reader.sources.files[file].text[part.node.range()];
        out.extend(
            text.split('\n')
                .enumerate()
                .map(|(index, line)| ((file, first + index), line.trim_end_matches('\r').to_owned())),
        );
    }

    /// What of an element is not understood, as it is in the file, inside the tags that lead there.
    fn rest(&self, out: &mut Vec<(Line, String)>, part: Part, known: &Known, placed: &[&str], tagged: bool) {
        let text = &self.reader.sources.files[part.file].text;
        if !known.leaves_something(part.node, text, placed) {
            return;
        }
        let line = self.line_of(part);
        if tagged {
            let name =
                part.node.attribute("name").map_or_else(String::new, |name| format!(" name=\"{}\"", escaped(name)));
            out.push((line, format!("<{}{name}>", known.tag)));
        }
        for node in part.node.children().filter(roxmltree::Node::is_element) {
            let tag = tag_of(node, text);
            let child = Part { node, file: part.file };
            match known.child(tag) {
                _ if placed.contains(&tag) => {}
                Some(inner) => self.rest(out, child, inner, &[], true),
                None => self.copy(out, child),
            }
        }
        if tagged {
            out.push((line, format!("</{}>", known.tag)));
        }
    }

    /// How a joint moves; `None` where that is wrong.
    fn motion(&mut self, joint: &Joint<'a>) -> Option<Motion> {
        let frames = &self.model.frames.all;
        let (parent, child) = (frames[joint.parent].body, frames[joint.child].body);
        if parent == child {
            let name = frames[child].name.clone();
            self.reader.problem(joint.part, Kind::SameLink(name));
            return None;
        }
        joints::motion(&mut self.reader, self.model, joint)
    }

    /// Every `<frame>` becomes a massless link; one with nothing but a single frame at its place becomes the joint to that.
    fn frames(&mut self) {
        let model = self.model;
        let mut attached: HashMap<FrameId, Vec<usize>> = HashMap::new();
        for (index, explicit) in model.explicit.iter().enumerate() {
            attached.entry(explicit.attached_to).or_default().push(index);
        }
        // Frame of the joint, to the frame of the link.
        let mut joints: HashMap<FrameId, FrameId> = HashMap::new();
        let mut links: HashSet<FrameId> = HashSet::new();
        for explicit in &model.explicit {
            let above = model.explicit.iter().find(|other| other.frame == explicit.attached_to);
            let alone = attached.get(&explicit.attached_to).is_some_and(|several| several.len() == 1);
            if let Some(above) = above.filter(|above| alone && !explicit.has_pose && above.has_pose) {
                joints.insert(above.frame, explicit.frame);
                links.insert(explicit.frame);
            }
        }
        for explicit in &model.explicit {
            if !joints.contains_key(&explicit.frame) {
                let wanted = model.frames.all[explicit.frame].name.clone();
                let name = fresh(&mut self.links, &wanted);
                self.names.insert(explicit.frame, name);
            }
        }
        for explicit in &model.explicit {
            if joints.contains_key(&explicit.frame) {
                continue;
            }
            let carrier = links.contains(&explicit.frame);
            let (holder, joint) = if carrier {
                let above = model.explicit.iter().find(|other| other.frame == explicit.attached_to);
                let above = above.unwrap_or(explicit);
                (above.attached_to, model.frames.all[above.frame].name.clone())
            } else {
                (explicit.attached_to, format!("{}_frame", model.frames.all[explicit.frame].name))
            };
            // A frame of a joint or of a model means the link that it is fixed to.
            let holder = if self.names.contains_key(&holder) { holder } else { model.frames.all[holder].body };
            let step = model.frames.between(holder, explicit.frame);
            let child = self.names[&explicit.frame].clone();
            let Some(parent) = self.names.get(&holder).cloned() else { continue };
            self.line(explicit.part, format!("  <link name=\"{}\"/>", escaped(&child)));
            let joint = fresh(&mut self.joints, &joint);
            self.fixed(explicit.part, &joint, &parent, &child, &step);
        }
    }

    fn fixed(&mut self, part: Part, name: &str, parent: &str, child: &str, step: &Step) {
        self.one_joint(part, name, "fixed", parent, child, step, "");
    }

    #[allow(clippy::too_many_arguments)] // A joint has as many parts.
    fn one_joint(&mut self, part: Part, name: &str, kind: &str, parent: &str, child: &str, step: &Step, inside: &str) {
        let tag = if kind == "screw" { "drake:joint" } else { "joint" };
        let origin = if step.is_identity() { String::new() } else { format!("<origin {}/>", step.origin) };
        let (name, parent, child) = (escaped(name), escaped(parent), escaped(child));
        self.line(
            part,
            format!(
                "  <{tag} name=\"{name}\" type=\"{kind}\">{origin}<parent link=\"{parent}\"/><child link=\"{child}\"/>{inside}</{tag}>"
            ),
        );
    }

    /// A joint of the tree, or one that closes a loop.
    fn joint(&mut self, joint: &Joint<'a>, motion: &Motion, role: Role, coupled: Option<&str>) {
        if role == Role::Loop {
            self.carry_joint(joint);
            return;
        }
        let frames = &self.model.frames;
        let reversed = role == Role::Reversed;
        // A frame that is a link of the URDF is the parent itself.
        let holder = |frame: FrameId| if self.names.contains_key(&frame) { frame } else { frames.all[frame].body };
        let (near, far) = if reversed {
            (holder(joint.child), frames.all[joint.parent].body)
        } else {
            (holder(joint.parent), frames.all[joint.child].body)
        };
        let (near_name, far_name) = (self.names[&near].clone(), self.names[&far].clone());
        let axes = match motion {
            Motion::Fixed => {
                let step = frames.between(near, far);
                self.fixed(joint.part, &joint.name, &near_name, &far_name, &step);
                self.rest_of_joint(joint);
                return;
            }
            Motion::Gearbox => return,
            Motion::Axes(axes) => axes,
        };
        if axes.len() > 1 {
            let names: Vec<String> = axes.iter().map(|axis| format!("\"{}\"", axis.name)).collect();
            let kind = joint.part.node.attribute("type").unwrap_or_default();
            let what = format!("a {kind} joint becomes several joints in series: {}", names.join(", "));
            self.reader.note(joint.part, what);
        }
        if reversed {
            let what =
                "its parent and child are swapped here; its axis is reversed so that its values keep their meaning";
            self.reader.note(joint.part, what);
        }
        let last = frames.between(joint.frame, far);
        let mut parent = near_name;
        let mut step = frames.between(near, joint.frame);
        let count = axes.len();
        let in_order: Vec<&Axis> = if reversed { axes.iter().rev().collect() } else { axes.iter().collect() };
        for (index, axis) in in_order.into_iter().enumerate() {
            let name = if count == 1 { joint.name.clone() } else { fresh(&mut self.joints, &axis.name) };
            let child = if index + 1 == count && last.is_identity() {
                far_name.clone()
            } else {
                let wanted = if index + 1 == count { format!("{}_frame", joint.name) } else { format!("{name}_link") };
                let link = fresh(&mut self.links, &wanted);
                self.line(joint.part, format!("  <link name=\"{}\"/>", escaped(&link)));
                link
            };
            let inside = axis.urdf(reversed, coupled);
            self.one_joint(joint.part, &name, axis.kind, &parent, &child, &step, &inside);
            (parent, step) = (child, Step::identity());
        }
        if !last.is_identity() {
            let name = fresh(&mut self.joints, &format!("{}_to_{far_name}", joint.name));
            self.fixed(joint.part, &name, &parent, &far_name, &last);
        }
        self.rest_of_joint(joint);
    }

    fn rest_of_joint(&mut self, joint: &Joint<'a>) {
        let mut own = Vec::new();
        self.rest(&mut own, joint.part, &JOINT, &[], false);
        self.gazebo(joint.part, Some(&escaped(&joint.name)), own);
    }

    /// A joint that does not fit into the tree, as SDF, with its pose in its child's link.
    fn carry_joint(&mut self, joint: &Joint<'a>) {
        let frames = &self.model.frames;
        let body = |frame: FrameId| frames.all[frame].body;
        let name = |frame: FrameId| self.names.get(&body(frame)).map_or("world", String::as_str);
        let (parent, child) = (escaped(name(joint.parent)), escaped(name(joint.child)));
        let within = pose::Step {
            pose: frames.pose(body(joint.child)).inverse() * frames.pose(joint.frame),
            origin: String::new(),
        };
        let line = self.line_of(joint.part);
        let kind = joint.part.node.attribute("type").unwrap_or_default();
        let xyz: Vec<f64> = within.pose.translation.vector.iter().copied().collect();
        let rpy = denavit_model::se3::written_rpy(&within.pose.rotation);
        let mut lines = vec![
            (line, format!("<joint name=\"{}\" type=\"{}\">", escaped(&joint.name), escaped(kind))),
            (line, format!("<pose>{} {}</pose>", numbers(&xyz), numbers(&rpy))),
            (line, format!("<parent>{parent}</parent><child>{child}</child>")),
        ];
        for node in joint.part.node.children().filter(roxmltree::Node::is_element) {
            let part = Part { node, file: joint.part.file };
            let tag = node.tag_name().name();
            match tag {
                "pose" | "parent" | "child" => {}
                "axis" | "axis2" => {
                    let direction = joints::direction(&mut self.reader, self.model, joint, part);
                    let line = self.line_of(part);
                    let direction = direction.map_or_else(String::new, |xyz| format!("<xyz>{xyz}</xyz>"));
                    lines.push((line, format!("<{tag}>{direction}")));
                    for inner in node.children().filter(roxmltree::Node::is_element) {
                        if !["xyz", "use_parent_model_frame"].contains(&inner.tag_name().name()) {
                            self.copy(&mut lines, Part { node: inner, file: part.file });
                        }
                    }
                    lines.push((line, format!("</{tag}>")));
                }
                "gearbox_reference_body" => {
                    let named = self.model.scopes[joint.scope].prefix.clone() + text_of(node);
                    lines.push((self.line_of(part), format!("<{tag}>{}</{tag}>", escaped(&named))));
                }
                _ => self.copy(&mut lines, part),
            }
        }
        lines.push((line, "</joint>".to_owned()));
        self.gazebo(joint.part, None, lines);
    }

    /// Links that no joint carries: free to move, or fixed where the model is static.
    fn free(&mut self, tree: &Tree) {
        let Some(root) = self.names.get(&tree.root).cloned() else { return };
        let kind = if self.model.is_static { "fixed" } else { "floating" };
        for body in &tree.free {
            let Some(link) = self.model.links.iter().find(|link| link.frame == *body) else { continue };
            let part = link.part;
            let name = self.names[body].clone();
            let joint = fresh(&mut self.joints, &format!("{name}_{kind}"));
            let step = self.model.frames.between(tree.root, *body);
            self.one_joint(part, &joint, kind, &root, &name, &step, "");
            let moves = if self.model.is_static { "the model is static, so it is fixed to" } else { "it floats from" };
            self.reader.note(part, format!("no joint carries the link; {moves} \"{root}\" here"));
        }
    }

    /// Where the model is in the world, and what it holds besides links and joints.
    fn of_model(&mut self, tree: &Tree) {
        let model = self.model;
        let mut lines = Vec::new();
        if tree.root != WORLD {
            let step = Step::computed(model.frames.pose(tree.root));
            if !step.is_identity() {
                let pose = step.pose;
                let xyz: Vec<f64> = pose.translation.vector.iter().copied().collect();
                let rpy = denavit_model::se3::written_rpy(&pose.rotation);
                let place = model.part.child("pose").unwrap_or(model.part);
                lines.push((self.line_of(place), format!("<pose>{} {}</pose>", numbers(&xyz), numbers(&rpy))));
            }
        }
        if model.is_static {
            lines.push((self.line_of(model.part), "<static>true</static>".to_owned()));
        }
        for (part, known) in &model.parts {
            self.rest(&mut lines, *part, known, &["link", "joint", "include", "model"], false);
        }
        self.gazebo(model.part, None, lines);
    }
}
