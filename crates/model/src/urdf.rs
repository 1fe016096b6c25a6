//! Reading URDF: text to [`Robot`]; reports all problems at once and repairs clear mistakes with a note.
//!
//! Everything in the text is understood, kept as an [`Element`], or reported: see [`Robot::inventory`].

mod account;
mod known;

use crate::chain::Limits;
use crate::element::Element;
use crate::formats::Translation;
use crate::intended;
use crate::inventory::Inventory;
use crate::notes::{Note, Place};
use crate::problems::{Problem, ProblemKind, UrdfError, nearest_name};
use crate::robot::{Geometry, Inertial, Joint, JointKind, Link, Mimic, Origin, Robot, Shape, SourceText};
use crate::screw::Pitch;
use crate::se3;
use crate::well_formed;
use account::Account;
use nalgebra::{Matrix3, Quaternion, Unit, UnitQuaternion, Vector3};
use roxmltree::{Document, Node, ParsingOptions};
use std::collections::HashMap;

/// Drake's namespace for joints that URDF lacks.
const DRAKE: &str = "http://drake.mit.edu";

/// What may stand in the element at a path of tags below `<robot>`, such as `["joint", "limit"]`: attributes and elements that
/// are understood or kept; `None` for a path that is neither.
///
/// # Examples
/// ```
/// let (attributes, _) = denavit_model::urdf::vocabulary(&["joint", "mimic"]).unwrap();
/// assert_eq!(attributes, ["joint", "multiplier", "offset"]);
/// ```
pub fn vocabulary(path: &[&str]) -> Option<(Vec<&'static str>, Vec<&'static str>)> {
    known::vocabulary(path)
}

/// Reads a robot from the text of a URDF.
///
/// `file` is used only in messages. Read with a note, since the meaning is clear: a byte order mark, white space
/// before the XML declaration, unbound namespace prefixes, commas between numbers, doubled child elements (the first
/// counts), a parent link "world" that is not declared. Missing `xyz`, `rpy`, `axis`, mimic `multiplier` and `offset`
/// take URDF's defaults. Links and joints may stand in a default namespace. `<origin>` states its rotation as `rpy` or, since
/// URDF 1.1, as `quat_xyzw`, which need not be of length 1.
///
/// An attribute, element or text that is not understood is reported by a note, one for each kind of thing, and in
/// [`Robot::inventory`], each by its own line. So are closed loops and calibration positions, which are kept
/// but have no effect here.
///
/// # Errors
/// Everything that is wrong with the file, each with line and element; see [`ProblemKind`].
///
/// # Source
/// <https://wiki.ros.org/urdf/XML>; `quat_xyzw`: <https://github.com/ros/urdfdom/blob/master/xsd/urdf.xsd>.
///
/// # Examples
/// ```
/// let robot = denavit_model::urdf::read("arm.urdf", r#"<robot name="arm">
///   <link name="base"/> <link name="tip"/>
///   <joint name="slide" type="prismatic"> <parent link="base"/> <child link="tip"/> </joint>
/// </robot>"#)?;
/// assert_eq!(robot.joints[0].axis.as_slice(), [1.0, 0.0, 0.0]);
/// # Ok::<(), denavit_model::UrdfError>(())
/// ```
pub fn read(file: &str, text: &str) -> Result<Robot, UrdfError> {
    read_with(file, text, None)
}

/// As [`read`], for a text that was translated from another format.
pub(crate) fn read_translated(mut source: SourceText) -> Result<Robot, UrdfError> {
    let translation = source.translation.take().map(|translation| *translation);
    read_with(&source.file, &source.text, translation)
}

fn read_with(file: &str, text: &str, translation: Option<Translation>) -> Result<Robot, UrdfError> {
    let (source, fixes) = well_formed::prepare(file, text, translation);
    let options = ParsingOptions { allow_dtd: true, ..ParsingOptions::default() };
    let document =
        Document::parse_with_options(&source.text, options).map_err(|error| xml_error(&source, text, &error))?;
    let mut reader = Reader { source: &source, problems: Vec::new(), notes: fixes };
    let parts = reader.robot(document.root_element());
    let Reader { problems, mut notes, .. } = reader;
    let Some(parts) = parts.filter(|_| problems.is_empty()) else { return Err(UrdfError { problems }) };
    let account = Account::of(document.root_element());
    notes.extend(account.notes(&source));
    let read = account.inventory(&source);
    Ok(parts.robot(source, notes, read))
}

/// The robot of a text that was translated from another format, from its links and joints, whose offsets count from
/// `before` on; the text where they make no tree.
pub(crate) fn of_values(source: SourceText, before: usize, mut loose: Loose) -> Result<Robot, SourceText> {
    for link in &mut loose.links {
        link.at += before;
        let on_shapes = link.visuals.iter_mut().chain(&mut link.collisions).flat_map(|shape| &mut shape.elements);
        for element in on_shapes.chain(&mut link.elements) {
            element.at += before;
        }
    }
    for LooseJoint { joint, .. } in &mut loose.joints {
        joint.at += before;
        for element in &mut joint.elements {
            element.at += before;
        }
    }
    let mut reader = Reader { source: &source, problems: Vec::new(), notes: Vec::new() };
    let parts = reader.tree(loose, Vec::new());
    let Reader { problems, notes, .. } = reader;
    match parts.filter(|_| problems.is_empty()) {
        Some(parts) => Ok(parts.robot(source, notes, Inventory::default())),
        None => Err(source),
    }
}

fn xml_error(source: &SourceText, original: &str, error: &roxmltree::Error) -> UrdfError {
    let dropped = source.dropped_before.bytes().filter(|byte| *byte == b'\n').count();
    let line = error.pos().row as usize + dropped;
    let conflict = original
        .lines()
        .nth(line.saturating_sub(1))
        .is_some_and(|line| ["<<<<<<<", "=======", ">>>>>>>"].iter().any(|marker| line.starts_with(marker)));
    let kind =
        if original.trim().is_empty() { ProblemKind::Empty } else { ProblemKind::Xml(error.to_string(), conflict) };
    let place = Place { file: source.file.clone(), line, element: "file".into() };
    UrdfError { problems: vec![Problem { place, kind }] }
}

/// What a `<limit>` states beyond URDF's four: accelerations, jerks.
fn further_limits(limit: Node) -> Option<Element> {
    let further = limit.attributes().filter(|attribute| !known::RANGE.contains(&attribute.name()));
    let further: Vec<_> = further.map(|limit| (limit.name().to_owned(), limit.value().to_owned())).collect();
    (!further.is_empty()).then(|| Element { at: limit.range().start, ..Element::empty("limit", further) })
}

struct Parts {
    name: String,
    links: Vec<Link>,
    joints: Vec<Joint>,
    root: usize,
    elements: Vec<Element>,
}

impl Parts {
    /// The robot, with all notes of its reading.
    fn robot(self, source: SourceText, mut notes: Vec<Note>, mut read: Inventory) -> Robot {
        let Self { name, links, joints, root, elements } = self;
        if let Some(translation) = &source.translation {
            read.understood = translation.understood;
            notes.extend(translation.reader_notes());
        }
        let mut robot = Robot { name, links, joints, root, elements, notes, read, source };
        let unused = robot.unused();
        robot.notes.extend(unused);
        robot
    }
}

/// Links and joints whose ends are still names.
#[derive(Debug, Clone, Default)]
pub struct Loose {
    /// The robot's name.
    pub name: String,
    /// In the order of the text.
    pub links: Vec<Link>,
    /// In the order of the text.
    pub joints: Vec<LooseJoint>,
}

/// A joint whose ends are still names.
#[derive(Debug, Clone)]
pub struct LooseJoint {
    /// The joint; its indices of links say nothing yet.
    pub joint: Joint,
    /// Name of the parent link.
    pub parent: String,
    /// Name of the child link.
    pub child: String,
}

struct Reader<'a> {
    source: &'a SourceText,
    problems: Vec<Problem>,
    notes: Vec<Note>,
}

fn element_of(node: Node) -> String {
    match node.attribute("name") {
        Some(name) => format!("{} \"{name}\"", node.tag_name().name()),
        None => format!("<{}>", node.tag_name().name()),
    }
}

fn words(value: &str) -> impl Iterator<Item = &str> {
    value.split(|c: char| c.is_whitespace() || c == ',').filter(|word| !word.is_empty())
}

/// The numbers of an attribute as the file writes them.
fn as_written<const N: usize>(value: &str) -> Option<[String; N]> {
    let mut found = [""; N];
    let mut words = words(value);
    for word in &mut found {
        *word = words.next()?;
    }
    words.next().is_none().then(|| found.map(str::to_owned))
}

/// A quaternion whose length is off by more gets a note: less is rounding.
const UNIT_QUATERNION: f64 = 1e-3;

impl Reader<'_> {
    fn problem(&mut self, node: Node, element: impl Into<String>, kind: ProblemKind) {
        let place = self.source.place(node.range().start, element);
        self.problems.push(Problem { place, kind });
    }

    fn corrected(&mut self, node: Node, element: impl Into<String>, what: impl Into<String>) {
        let place = self.source.place(node.range().start, element);
        self.notes.push(Note::Corrected { place, what: what.into() });
    }

    fn robot(&mut self, root: Node) -> Option<Parts> {
        if root.tag_name().name() != "robot" {
            self.problem(root, element_of(root), ProblemKind::NoRobot(root.tag_name().name().to_owned()));
            return None;
        }
        let namespace = root.tag_name().namespace();
        let ours = |node: &Node| {
            let found = node.tag_name().namespace();
            found.is_none() || found == namespace || found == Some(DRAKE)
        };
        let (mut links, mut loose, mut elements) = (Vec::new(), Vec::new(), Vec::new());
        for node in root.children().filter(Node::is_element) {
            match node.tag_name().name() {
                "link" if ours(&node) => links.extend(self.link(node)),
                "joint" if ours(&node) => loose.extend(self.joint(node)),
                _ => elements.push(Element::of(node, &self.source.text)),
            }
        }
        if links.is_empty() && self.problems.is_empty() {
            self.problem(root, element_of(root), ProblemKind::NoLinks);
            return None;
        }
        let name = root.attribute("name").unwrap_or_default().to_owned();
        self.tree(Loose { name, links, joints: loose }, elements)
    }

    /// The tree that links and joints make.
    fn tree(&mut self, loose: Loose, elements: Vec<Element>) -> Option<Parts> {
        let Loose { name, mut links, joints: loose } = loose;
        self.unique(links.iter().map(|link| ("link", link.name.as_str(), link.at)));
        self.unique(loose.iter().map(|loose| ("joint", loose.joint.name.as_str(), loose.joint.at)));
        self.declare_world(&mut links, &loose);
        let joints = self.connect(&links, loose);
        let root = self.root_of(&links, &joints)?;
        Some(Parts { name, links, joints, root, elements })
    }

    fn unique<'n>(&mut self, named: impl Iterator<Item = (&'static str, &'n str, usize)>) {
        let mut seen: HashMap<&str, usize> = HashMap::new();
        for (tag, name, at) in named {
            if let Some(first) = seen.insert(name, at) {
                let kind = ProblemKind::DuplicateName { first: self.source.line(first) };
                self.problems.push(Problem { place: self.source.place(at, format!("{tag} \"{name}\"")), kind });
            }
        }
    }

    /// Drake takes an undeclared parent link "world" as the world: so do we, with a note.
    fn declare_world(&mut self, links: &mut Vec<Link>, loose: &[LooseJoint]) {
        let Some(user) = loose.iter().find(|loose| loose.parent == "world") else { return };
        if links.iter().any(|link| link.name == "world") {
            return;
        }
        let place = self.source.place(user.joint.at, format!("joint \"{}\"", user.joint.name));
        self.notes.push(Note::Corrected {
            place,
            what: "parent link \"world\" is not declared; read as an empty link".into(),
        });
        links.push(Link::named("world", user.joint.at));
    }

    fn connect(&mut self, links: &[Link], loose: Vec<LooseJoint>) -> Vec<Joint> {
        let index: HashMap<&str, usize> =
            links.iter().enumerate().map(|(index, link)| (link.name.as_str(), index)).collect();
        let mut carried: HashMap<usize, String> = HashMap::new();
        let mut joints = Vec::with_capacity(loose.len());
        for LooseJoint { mut joint, parent, child } in loose {
            let mut find = |role: &'static str, link: &String| {
                let found = index.get(link.as_str()).copied();
                if found.is_none() {
                    let near = nearest_name(link, links.iter().map(|link| link.name.as_str())).map(str::to_owned);
                    let place = self.source.place(joint.at, format!("joint \"{}\"", joint.name));
                    let kind = ProblemKind::UnknownLink { role, link: link.clone(), near };
                    self.problems.push(Problem { place, kind });
                }
                found
            };
            let (Some(parent), Some(child)) = (find("parent", &parent), find("child", &child)) else { continue };
            joint.parent = parent;
            joint.child = child;
            if let Some(other) = carried.insert(child, joint.name.clone()) {
                let place = self.source.place(joint.at, format!("joint \"{}\"", joint.name));
                let kind = ProblemKind::TwoParents { link: links[child].name.clone(), other };
                self.problems.push(Problem { place, kind });
            }
            joints.push(joint);
        }
        joints
    }

    /// The one link that no joint carries, if the joints make a tree.
    fn root_of(&mut self, links: &[Link], joints: &[Joint]) -> Option<usize> {
        if !self.problems.is_empty() {
            return None;
        }
        let mut parent = vec![None; links.len()];
        for joint in joints {
            parent[joint.child] = Some(joint.parent);
        }
        // 0 unknown, 1 on the way, 2 leads to a root.
        let mut state = vec![0u8; links.len()];
        for start in 0..links.len() {
            let mut way = Vec::new();
            let mut at = start;
            while state[at] == 0 {
                state[at] = 1;
                way.push(at);
                match parent[at] {
                    Some(up) => at = up,
                    None => state[at] = 2,
                }
            }
            if state[at] == 1 {
                let first = way.iter().position(|link| *link == at).unwrap_or(0);
                let names: Vec<String> = way[first..].iter().map(|link| format!("\"{}\"", links[*link].name)).collect();
                let place = self.source.place(links[at].at, format!("link \"{}\"", links[at].name));
                self.problems.push(Problem { place, kind: ProblemKind::Cycle { links: names.join(", ") } });
                return None;
            }
            for link in way {
                state[link] = 2;
            }
        }
        let roots: Vec<usize> = (0..links.len()).filter(|link| parent[*link].is_none()).collect();
        if roots.len() > 1 {
            let names: Vec<String> = roots.iter().map(|link| format!("\"{}\"", links[*link].name)).collect();
            let second = &links[roots[1]];
            let place = self.source.place(second.at, format!("link \"{}\"", second.name));
            let kind = ProblemKind::SeveralRoots { count: roots.len(), links: names.join(", ") };
            self.problems.push(Problem { place, kind });
            return None;
        }
        roots.first().copied()
    }

    fn link(&mut self, node: Node) -> Option<Link> {
        let Some(name) = node.attribute("name") else {
            self.problem(node, element_of(node), ProblemKind::MissingName);
            return None;
        };
        let owner = element_of(node);
        let mut link = Link::named(name, node.range().start);
        for child in node.children().filter(Node::is_element) {
            match child.tag_name().name() {
                "inertial" if link.inertial.is_none() => link.inertial = Some(self.inertial(child, &owner)),
                "inertial" => self.corrected(child, &*owner, "a second <inertial> is ignored"),
                "visual" => link.visuals.push(self.shape(child, &owner)),
                "collision" => link.collisions.push(self.shape(child, &owner)),
                _ => link.elements.push(Element::of(child, &self.source.text)),
            }
        }
        Some(link)
    }

    fn inertial(&mut self, node: Node, owner: &str) -> Inertial {
        let origin = self.origin(node, owner);
        let mass =
            self.only_child(node, "mass", owner).map_or(0.0, |mass| self.number(mass, "value", owner).unwrap_or(0.0));
        let tensor = self.only_child(node, "inertia", owner).map_or_else(Matrix3::zeros, |inertia| {
            let mut entry = |attribute| self.number(inertia, attribute, owner).unwrap_or(0.0);
            let (xx, xy, xz) = (entry("ixx"), entry("ixy"), entry("ixz"));
            let (yy, yz, zz) = (entry("iyy"), entry("iyz"), entry("izz"));
            Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz)
        });
        Inertial { origin, mass, tensor }
    }

    fn shape(&mut self, node: Node, owner: &str) -> Shape {
        let origin = self.origin(node, owner);
        let shape =
            self.only_child(node, "geometry", owner).and_then(|geometry| geometry.children().find(Node::is_element));
        let geometry = shape.map_or_else(|| Geometry::Other(String::new()), |shape| self.geometry(shape, owner));
        let known = ["origin", "geometry"];
        let further = node.children().filter(|child| child.is_element() && !known.contains(&child.tag_name().name()));
        let elements = further.map(|child| Element::of(child, &self.source.text)).collect();
        Shape { name: node.attribute("name").map(str::to_owned), origin, geometry, elements }
    }

    fn geometry(&mut self, shape: Node, owner: &str) -> Geometry {
        let radius_and_length = |reader: &mut Self| {
            let mut entry = |attribute| reader.number(shape, attribute, owner).unwrap_or(0.0);
            (entry("radius"), entry("length"))
        };
        match shape.tag_name().name() {
            "box" => Geometry::Box(self.several(shape, "size", owner).unwrap_or_default()),
            "sphere" => Geometry::Sphere(self.number(shape, "radius", owner).unwrap_or(0.0)),
            "cylinder" => {
                let (radius, length) = radius_and_length(self);
                Geometry::Cylinder { radius, length }
            }
            "capsule" => {
                let (radius, length) = radius_and_length(self);
                Geometry::Capsule { radius, length }
            }
            "mesh" => Geometry::Mesh {
                filename: shape.attribute("filename").unwrap_or_default().to_owned(),
                scale: self.several(shape, "scale", owner).unwrap_or([1.0; 3]),
            },
            other => Geometry::Other(other.to_owned()),
        }
    }

    fn joint(&mut self, node: Node) -> Option<LooseJoint> {
        let Some(name) = node.attribute("name") else {
            self.problem(node, element_of(node), ProblemKind::MissingName);
            return None;
        };
        let owner = element_of(node);
        let before = self.problems.len();
        let mut end = |role: &'static str| {
            let link = self.only_child(node, role, &owner).and_then(|end| end.attribute("link"));
            if link.is_none() {
                self.problem(node, &*owner, ProblemKind::MissingEnd(role));
            }
            link.unwrap_or_default().to_owned()
        };
        let (parent, child) = (end("parent"), end("child"));
        let kind = self.joint_kind(node, &owner);
        let origin = self.origin(node, &owner);
        let axis_written = self
            .only_child(node, "axis", &owner)
            .and_then(|axis| self.several(axis, "xyz", &owner).map(|xyz| (axis, xyz)));
        let axis = match axis_written {
            None => Vector3::x_axis(),
            Some((axis, xyz)) => Unit::try_new(Vector3::from(xyz), 0.0).unwrap_or_else(|| {
                if kind.moves() && kind != JointKind::Floating {
                    let written = axis.attribute("xyz").unwrap_or_default().to_owned();
                    self.problem(node, &*owner, ProblemKind::ZeroAxis(written));
                }
                Vector3::x_axis()
            }),
        };
        let limit = self.only_child(node, "limit", &owner);
        let limits = limit.map_or_else(Limits::default, |limit| self.limits(limit, &owner));
        let mimic = self.only_child(node, "mimic", &owner).and_then(|mimic| {
            let joint = mimic.attribute("joint").unwrap_or_default().to_owned();
            let multiplier = self.number(mimic, "multiplier", &owner).unwrap_or(1.0);
            let offset = self.number(mimic, "offset", &owner).unwrap_or(0.0);
            (!joint.is_empty()).then_some(Mimic { joint, multiplier, offset })
        });
        if self.problems.len() > before {
            return None;
        }
        let known = ["origin", "parent", "child", "axis", "limit", "mimic", "screw_thread_pitch"];
        let further = node.children().filter(|child| child.is_element() && !known.contains(&child.tag_name().name()));
        let mut elements: Vec<Element> = further.map(|child| Element::of(child, &self.source.text)).collect();
        elements.extend(limit.and_then(further_limits));
        let joint = Joint {
            elements,
            name: name.to_owned(),
            kind,
            origin,
            parent: 0,
            child: 0,
            axis,
            axis_written: axis_written.map(|(_, xyz)| xyz),
            axis_meant: axis_written.and_then(|(axis, _)| intended::axis_read_as(axis.attribute("xyz")?)),
            limits,
            mimic,
            at: node.range().start,
        };
        Some(LooseJoint { joint, parent, child })
    }

    fn joint_kind(&mut self, node: Node, owner: &str) -> JointKind {
        match node.attribute("type") {
            Some("fixed") => JointKind::Fixed,
            Some("revolute") => JointKind::Revolute,
            Some("continuous") => JointKind::Continuous,
            Some("prismatic") => JointKind::Prismatic,
            Some("planar") => JointKind::Planar,
            Some("floating") => JointKind::Floating,
            Some("screw") => {
                let per_turn = self
                    .only_child(node, "screw_thread_pitch", owner)
                    .and_then(|pitch| self.number(pitch, "value", owner))
                    .and_then(Pitch::from_lead);
                per_turn.map_or_else(
                    || {
                        self.problem(node, owner, ProblemKind::MissingThreadPitch);
                        JointKind::Fixed
                    },
                    JointKind::Screw,
                )
            }
            Some(word) => JointKind::Unknown(word.to_owned()),
            None => {
                self.problem(node, owner, ProblemKind::MissingType);
                JointKind::Fixed
            }
        }
    }

    /// What is stated and finite; a `<limit>` with neither bound states no range.
    fn limits(&mut self, limit: Node, owner: &str) -> Limits {
        let lower = self.number_or_infinite(limit, "lower", owner);
        let upper = self.number_or_infinite(limit, "upper", owner);
        let velocity = self.number_or_infinite(limit, "velocity", owner).filter(|value| value.is_finite());
        let effort = self.number_or_infinite(limit, "effort", owner).filter(|value| value.is_finite());
        let stated = lower.is_some() || upper.is_some();
        let range = (lower.unwrap_or(0.0), upper.unwrap_or(0.0));
        let finite = range.0.is_finite() && range.1.is_finite();
        Limits { range: (stated && finite).then_some(range), velocity, effort }
    }

    fn origin(&mut self, node: Node, owner: &str) -> Origin {
        let Some(origin) = self.only_child(node, "origin", owner) else { return Origin::default() };
        let xyz = self.several(origin, "xyz", owner).unwrap_or_default();
        if origin.has_attribute("quat_xyzw") {
            let (rpy, quat_written) = self.quaternion(origin, owner).unwrap_or_default();
            return Origin { xyz, rpy, rpy_written: None, quat_written };
        }
        let rpy = self.several(origin, "rpy", owner);
        let rpy_written = rpy.and(origin.attribute("rpy")).and_then(as_written);
        Origin { xyz, rpy: rpy.unwrap_or_default(), rpy_written, quat_written: None }
    }

    /// The rotation of `quat_xyzw`, as fixed-axis angles, and its four numbers as written.
    fn quaternion(&mut self, origin: Node, owner: &str) -> Option<([f64; 3], Option<[String; 4]>)> {
        let written = origin.attribute("quat_xyzw").unwrap_or_default();
        if let Some(rpy) = origin.attribute("rpy") {
            let kind = ProblemKind::TwoRotations { rpy: rpy.to_owned(), quat_xyzw: written.to_owned() };
            self.problem(origin, owner, kind);
            return None;
        }
        let [x, y, z, w] = self.several::<4>(origin, "quat_xyzw", owner)?;
        let Some(rotation) = UnitQuaternion::try_new(Quaternion::new(w, x, y, z), f64::MIN_POSITIVE) else {
            self.problem(origin, owner, ProblemKind::ZeroQuaternion(written.to_owned()));
            return None;
        };
        let length = x.hypot(y).hypot(z.hypot(w));
        if (length - 1.0).abs() > UNIT_QUATERNION {
            self.corrected(
                origin,
                owner,
                format!("quat_xyzw=\"{written}\" has length {length:.4}; normalised to length 1"),
            );
        }
        Some((se3::written_rpy(&rotation.to_rotation_matrix()), as_written(written)))
    }

    /// The first child of this name; more of them get a note.
    fn only_child<'b, 'c>(&mut self, node: Node<'b, 'c>, name: &str, owner: &str) -> Option<Node<'b, 'c>> {
        let mut found = node.children().filter(|child| child.is_element() && child.tag_name().name() == name);
        let first = found.next();
        if let Some(second) = found.next() {
            self.corrected(second, owner, format!("a second <{name}> is ignored"));
        }
        first
    }

    fn number(&mut self, node: Node, attribute: &'static str, owner: &str) -> Option<f64> {
        let value = node.attribute(attribute)?;
        let number = value.trim().parse::<f64>().ok().filter(|number| number.is_finite());
        if number.is_none() {
            self.bad_number(node, attribute, value, value.trim(), owner);
        }
        number
    }

    fn number_or_infinite(&mut self, node: Node, attribute: &'static str, owner: &str) -> Option<f64> {
        let value = node.attribute(attribute)?;
        match value.trim().parse::<f64>() {
            Ok(number) if number.is_infinite() => Some(number),
            _ => self.number(node, attribute, owner),
        }
    }

    fn bad_number(&mut self, node: Node, attribute: &'static str, value: &str, word: &str, owner: &str) {
        let kind = ProblemKind::BadNumber {
            element: node.tag_name().name().to_owned(),
            attribute,
            value: value.to_owned(),
            word: word.to_owned(),
        };
        self.problem(node, owner, kind);
    }

    fn several<const N: usize>(&mut self, node: Node, attribute: &'static str, owner: &str) -> Option<[f64; N]> {
        let value = node.attribute(attribute)?;
        if value.contains(',') {
            let count = if N == 3 { "three" } else { "four" };
            self.corrected(node, owner, format!("{attribute}=\"{value}\" has commas; read as {count} numbers"));
        }
        let mut numbers = [0.0; N];
        let mut found = 0;
        for word in words(value) {
            let Some(number) = word.parse::<f64>().ok().filter(|number| number.is_finite()) else {
                self.bad_number(node, attribute, value, word, owner);
                return None;
            };
            if let Some(slot) = numbers.get_mut(found) {
                *slot = number;
            }
            found += 1;
        }
        if found != N {
            let element = node.tag_name().name().to_owned();
            let kind = ProblemKind::WrongCount { element, attribute, value: value.to_owned(), found, expected: N };
            self.problem(node, owner, kind);
            return None;
        }
        Some(numbers)
    }
}
