//! The tree as MJCF: a body for each link, nothing fused, no mass dropped.

mod inertia;
mod names;

use crate::mass::LEAST;
use crate::srdf::{self, Slot, Srdf};
use denavit_model::formats::{FormatError, Loss, Written};
use denavit_model::notes::Place;
use denavit_model::placed::PlacedRobot;
use denavit_model::robot::{Geometry, Joint, JointKind, Link, Origin, Shape};
use denavit_model::se3;
use denavit_model::tree::Reading;
use denavit_model::write::escaped;
use denavit_model::{Element, Robot};
use inertia::Choice;
use names::Names;
use std::collections::HashMap;
use std::fmt::Write as _;

/// Options of the writer.
pub struct WriteOptions<'a> {
    /// Whether an inertia that no body can have is changed to the nearest that one can.
    pub fix_inertia: bool,
    /// Gives the file name for MuJoCo of a mesh name of the robot; `None`: as the robot writes it, a package's name as
    /// a folder.
    pub mesh: &'a dyn Fn(&str) -> Option<String>,
    /// The robot's SRDF: its pairs with disabled contact and its states are also written.
    pub srdf: Option<&'a Srdf>,
}

impl std::fmt::Debug for WriteOptions<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("WriteOptions").field("fix_inertia", &self.fix_inertia).finish_non_exhaustive()
    }
}

/// A robot as MJCF, and what MJCF cannot state.
///
/// Every link is a body, fixed ones too; the root is a body of the world, or the world itself where it is called so and has no
/// mass. A screw joint becomes a hinge and a slide that an equality couples, a mimic joint an equality, a planar joint two
/// slides and a hinge. Angles are rad; orientations are the URDF's own angles.
///
/// # Errors
/// A link has an inertia that no body can have, unless [`WriteOptions::fix_inertia`].
///
/// # Examples
/// ```
/// let text = r#"<robot name="r"><link name="a"/><link name="b"/>
///   <joint name="j" type="continuous"><axis xyz="0 0 1"/><parent link="a"/><child link="b"/></joint></robot>"#;
/// let robot = denavit_model::urdf::read("r.urdf", text)?;
/// let written = denavit_mjcf::write(&robot, &denavit_mjcf::WriteOptions { fix_inertia: false, mesh: &|_| None, srdf: None })?;
/// assert!(written.text.contains(r#"<joint name="j" type="hinge" axis="0 0 1"/>"#));
/// assert!(written.losses[0].to_string().contains("has no mass"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn write(robot: &Robot, options: &WriteOptions) -> Result<Written, FormatError> {
    let mut writer = Writer {
        robot,
        placed: PlacedRobot::new(robot, Reading::AsWritten),
        options,
        out: String::new(),
        assets: String::new(),
        equalities: String::new(),
        meshes: HashMap::new(),
        bodies: Names::with(["world"]),
        joints: Names::default(),
        geoms: Names::default(),
        assets_named: Names::default(),
        losses: Vec::new(),
        problems: Vec::new(),
        qpos: Vec::new(),
        body_of: HashMap::new(),
    };
    writer.all();
    let (beside, beside_losses) = match options.srdf {
        Some(srdf) => {
            let body = |link: &str| writer.body_of.get(link).cloned();
            srdf::sections(srdf, &writer.placed, &writer.qpos, &body)
        }
        None => Default::default(),
    };
    let Writer { out, assets, equalities, mut losses, problems, .. } = writer;
    losses.extend(beside_losses);
    if !problems.is_empty() {
        return Err(FormatError { problems });
    }
    let mut text = String::from("<?xml version=\"1.0\"?>\n");
    let _ = writeln!(text, "<mujoco model=\"{}\">", escaped(&robot.name));
    text.push_str("  <compiler angle=\"radian\" eulerseq=\"XYZ\" autolimits=\"true\" inertiafromgeom=\"false\" ");
    text.push_str("balanceinertia=\"false\" fusestatic=\"false\" strippath=\"false\"/>\n");
    if !assets.is_empty() {
        let _ = write!(text, "  <asset>\n{assets}  </asset>\n");
    }
    let _ = write!(text, "  <worldbody>\n{out}  </worldbody>\n");
    if !equalities.is_empty() {
        let _ = write!(text, "  <equality>\n{equalities}  </equality>\n");
    }
    text.push_str(&beside);
    text.push_str("</mujoco>\n");
    Ok(Written { text, losses, sidecar: None, proof: Vec::new() })
}

struct Writer<'a> {
    robot: &'a Robot,
    placed: PlacedRobot<'a>,
    options: &'a WriteOptions<'a>,
    out: String,
    assets: String,
    equalities: String,
    /// Assets by file and scale.
    meshes: HashMap<(String, [u64; 3]), String>,
    bodies: Names,
    joints: Names,
    geoms: Names,
    assets_named: Names,
    losses: Vec<Loss>,
    problems: Vec<(Place, String)>,
    /// Every number of `qpos`, in MuJoCo's order.
    qpos: Vec<Slot>,
    /// The name of a link's body.
    body_of: HashMap<String, String>,
}

/// Numbers with blanks between them; -0 is 0.
pub(crate) fn numbers(values: &[f64]) -> String {
    let mut out = String::new();
    add_numbers(&mut out, values);
    out
}

/// Adds numbers with blanks between them, each so that it reads back as itself; -0 as 0.
pub(crate) fn add_numbers(out: &mut String, values: &[f64]) {
    for (index, value) in values.iter().enumerate() {
        if index > 0 {
            out.push(' ');
        }
        if *value == 0.0 {
            out.push('0');
        } else {
            let _ = write!(out, "{value}");
        }
    }
}

/// A pose as attributes, with the URDF's own numbers.
fn place(origin: &Origin) -> String {
    let mut out = String::new();
    if origin.xyz != [0.0; 3] {
        let _ = write!(out, " pos=\"{}\"", numbers(&origin.xyz));
    }
    if origin.quat_written.is_some() {
        let [x, y, z, w] = se3::quaternion_xyzw(&se3::rotation_from_rpy(origin.rpy));
        let _ = write!(out, " quat=\"{}\"", numbers(&[w, x, y, z]));
    } else if origin.rpy != [0.0; 3] {
        let _ = write!(out, " euler=\"{}\"", numbers(&origin.rpy));
    }
    out
}

/// Elements of the world without their own body.
fn is_world(robot: &Robot) -> bool {
    let root = &robot.links[robot.root];
    root.name == "world" && root.inertial.as_ref().is_none_or(|inertial| inertial.mass == 0.0)
}

impl Writer<'_> {
    fn lose(&mut self, at: usize, element: String, what: impl Into<String>, why: impl Into<String>) {
        let place = self.robot.source.place(at, element);
        self.losses.push(Loss { place, what: what.into(), why: why.into() });
    }

    fn all(&mut self) {
        let robot = self.robot;
        let mut open = vec![(robot.root, 2, false)];
        let world = is_world(robot);
        // Where a body ends, its tag is closed: `true` marks the end.
        while let Some((link, depth, ends)) = open.pop() {
            let indent = "  ".repeat(depth);
            if ends {
                let _ = writeln!(self.out, "{indent}</body>");
                continue;
            }
            let is_world = world && link == robot.root;
            if is_world {
                self.body_of.insert(robot.links[link].name.clone(), "world".into());
                self.link_parts(&robot.links[link], &indent, true);
            } else {
                self.body(link, &indent);
                open.push((link, depth, true));
            }
            let inner = if is_world { depth } else { depth + 1 };
            let first = open.len();
            open.extend(self.placed.carried(link).iter().map(|joint| (robot.joints[*joint].child, inner, false)));
            open[first..].reverse();
        }
        for element in &robot.elements {
            self.element(element.label(), element);
        }
        for kept in robot.source.kept() {
            self.losses.push(kept.loss.clone());
        }
    }

    fn element(&mut self, owner: String, element: &Element) {
        let what = format!("<{}>", element.tag());
        let why = match element.tag() {
            "material" => "MJCF colours geoms: the colour is written there, without its name",
            "transmission" | "ros2_control" => "MJCF describes drives in another way",
            "safety_controller" => "MJCF has no soft limits",
            "calibration" => "MJCF has no reference sensors",
            _ => "MJCF has no such element",
        };
        self.lose(element.at, owner, what, why);
    }

    fn body(&mut self, link: usize, indent: &str) {
        let robot = self.robot;
        let own = &robot.links[link];
        let owner = format!("link \"{}\"", own.name);
        let (name, renamed) = self.bodies.give(&own.name);
        if renamed {
            self.lose(own.at, owner, "its name", format!("MJCF has taken that name; the body is called \"{name}\""));
        }
        self.body_of.insert(own.name.clone(), name.clone());
        let carrier = self.placed.carrier(link);
        let at = carrier.map_or_else(String::new, |joint| place(&robot.joints[joint].origin));
        let _ = writeln!(self.out, "{indent}<body name=\"{}\"{at}>", escaped(&name));
        let inner = format!("{indent}  ");
        if let Some(joint) = carrier {
            self.slots(&robot.joints[joint]);
            self.joint(&robot.joints[joint], &inner);
        }
        self.inertial(link, &inner);
        self.link_parts(own, &inner, false);
    }

    fn inertial(&mut self, link: usize, indent: &str) {
        let own = &self.robot.links[link];
        let owner = format!("link \"{}\"", own.name);
        let moves = self.placed.carrier(link).is_some_and(|joint| self.robot.joints[joint].kind.moves());
        let stated = own.inertial.as_ref();
        if let Some(inertial) = stated
            && inertial.mass < 0.0
        {
            let what = format!("its mass of {} kg is negative; write 0 or more", inertial.mass);
            self.problems.push((self.robot.source.place(own.at, owner), what));
            return;
        }
        let is_light = stated.is_none_or(|inertial| inertial.mass < LEAST || inertial.tensor.norm() < LEAST);
        if moves && is_light && !self.has_fixed_mass(link) {
            let (mass, at) =
                stated.map_or((0.0, Origin::default()), |inertial| (inertial.mass, inertial.origin.clone()));
            let _ = writeln!(
                self.out,
                "{indent}<inertial pos=\"{}\" mass=\"{}\" diaginertia=\"{LEAST} {LEAST} {LEAST}\"/>",
                numbers(&at.xyz),
                mass.max(LEAST)
            );
            let why =
                format!("moves and has no mass or inertia, which MuJoCo refuses; it is given {LEAST:e} kg and kg·m²");
            self.lose(own.at, owner, "its inertia", why);
            return;
        }
        let Some(inertial) = stated else { return };
        if inertial.mass == 0.0 && inertial.tensor.norm() == 0.0 && !moves {
            return;
        }
        match inertia::written(inertial, self.options.fix_inertia) {
            Choice::AsItIs(attributes) => {
                let _ = writeln!(self.out, "{indent}<inertial{attributes}/>");
            }
            Choice::Changed(attributes, why) => {
                let _ = writeln!(self.out, "{indent}<inertial{attributes}/>");
                self.lose(own.at, owner, "its inertia", why);
            }
            Choice::Refused(why) => self.problems.push((self.robot.source.place(own.at, owner), why)),
        }
    }

    /// Whether something with mass and inertia is fixed to a link, which MuJoCo counts to it.
    fn has_fixed_mass(&self, link: usize) -> bool {
        let mut open = vec![link];
        while let Some(link) = open.pop() {
            for joint in self.placed.carried(link) {
                let joint = &self.robot.joints[*joint];
                if joint.kind.moves() {
                    continue;
                }
                let inertial = self.robot.links[joint.child].inertial.as_ref();
                if inertial.is_some_and(|inertial| inertial.mass >= LEAST && inertial.tensor.norm() >= LEAST) {
                    return true;
                }
                open.push(joint.child);
            }
        }
        false
    }

    fn link_parts(&mut self, link: &Link, indent: &str, is_world: bool) {
        if is_world && link.inertial.is_some() {
            let owner = format!("link \"{}\"", link.name);
            self.lose(link.at, owner, "<inertial>", "MuJoCo's world has no mass; it is left out");
        }
        for (shapes, collides) in [(&link.visuals, false), (&link.collisions, true)] {
            for shape in shapes {
                self.geom(link, shape, collides, indent);
            }
        }
        for element in &link.elements {
            self.element(format!("link \"{}\"", link.name), element);
        }
    }

    fn geom(&mut self, link: &Link, shape: &Shape, collides: bool, indent: &str) {
        let owner = || format!("link \"{}\"", link.name);
        let positive = |lengths: &[f64]| lengths.iter().all(|length| *length > 0.0);
        let role = if collides { "<collision>" } else { "<visual>" };
        let geometry = match &shape.geometry {
            Geometry::Box(edges) if positive(edges) => {
                format!(" type=\"box\" size=\"{}\"", numbers(&edges.map(|edge| edge / 2.0)))
            }
            Geometry::Sphere(radius) if positive(&[*radius]) => format!(" type=\"sphere\" size=\"{radius}\""),
            Geometry::Cylinder { radius, length } if positive(&[*radius, *length]) => {
                format!(" type=\"cylinder\" size=\"{radius} {}\"", length / 2.0)
            }
            Geometry::Capsule { radius, length } if positive(&[*radius, *length]) => {
                format!(" type=\"capsule\" size=\"{radius} {}\"", length / 2.0)
            }
            Geometry::Mesh { filename, scale } => match self.mesh(filename, *scale) {
                Ok(asset) => format!(" type=\"mesh\" mesh=\"{}\"", escaped(&asset)),
                Err(why) => {
                    self.lose(link.at, owner(), role, why);
                    return;
                }
            },
            _ => {
                self.lose(link.at, owner(), role, "MJCF has no such shape, or not of this size");
                return;
            }
        };
        let name = shape.name.as_deref().unwrap_or_default();
        let mut words = String::new();
        if !name.is_empty() {
            let (given, renamed) = self.geoms.give(name);
            if renamed {
                let why = format!("names of geoms must be unique in MJCF; this one is called \"{given}\"");
                self.lose(link.at, owner(), format!("name \"{name}\" of a {role}"), why);
            }
            let _ = write!(words, " name=\"{}\"", escaped(&given));
        }
        let colour = shape.elements.iter().find(|element| element.tag() == "material");
        let rgba = colour.and_then(|material| self.colour(material));
        let rgba = rgba.map_or_else(String::new, |rgba| format!(" rgba=\"{}\"", numbers(&rgba)));
        let role = if collides { " group=\"3\"" } else { " group=\"2\" contype=\"0\" conaffinity=\"0\"" };
        let _ = writeln!(self.out, "{indent}<geom{words}{geometry}{}{role}{rgba}/>", place(&shape.origin));
        for element in shape.elements.iter().filter(|element| element.tag() != "material") {
            self.element(owner(), element);
        }
    }

    /// Red, green, blue, opacity of a material, or of the one of its name beside the links.
    fn colour(&self, material: &Element) -> Option<[f64; 4]> {
        let own = |material: &Element| -> Option<[f64; 4]> {
            let colour = material.nodes.iter().find(|node| node.tag == "color")?;
            let words: Vec<f64> =
                colour.attribute("rgba")?.split_whitespace().filter_map(|word| word.parse().ok()).collect();
            words.try_into().ok()
        };
        own(material).or_else(|| {
            let name = material.attribute("name")?;
            let named = |element: &&Element| element.tag() == "material" && element.attribute("name") == Some(name);
            own(self.robot.elements.iter().find(named)?)
        })
    }

    /// The asset of a mesh file at a scale.
    fn mesh(&mut self, filename: &str, scale: [f64; 3]) -> Result<String, String> {
        let ending = filename.rsplit('.').next().unwrap_or_default().to_ascii_lowercase();
        if !["stl", "obj", "msh"].contains(&ending.as_str()) {
            return Err(format!(
                "MuJoCo reads no mesh \"{filename}\": it reads .stl, .obj and .msh; convert it and name that file"
            ));
        }
        let key = (filename.to_owned(), scale.map(f64::to_bits));
        if let Some(known) = self.meshes.get(&key) {
            return Ok(known.clone());
        }
        let stem = filename.rsplit(['/', '\\']).next().unwrap_or(filename);
        let stem = stem.rsplit_once('.').map_or(stem, |(stem, _)| stem);
        let (name, _) = self.assets_named.give(stem);
        let path = (self.options.mesh)(filename).unwrap_or_else(|| {
            let plain = filename.split_once("://").map_or(filename, |(_, path)| path);
            plain.to_owned()
        });
        let factor = if scale == [1.0; 3] { String::new() } else { format!(" scale=\"{}\"", numbers(&scale)) };
        let _ = writeln!(self.assets, "    <mesh name=\"{}\" file=\"{}\"{factor}/>", escaped(&name), escaped(&path));
        self.meshes.insert(key, name.clone());
        Ok(name)
    }

    fn joint(&mut self, joint: &Joint, indent: &str) {
        let owner = || format!("joint \"{}\"", joint.name);
        let axis = numbers(&joint.axis_written.unwrap_or([1.0, 0.0, 0.0]));
        let (name, renamed) =
            if joint.kind.moves() { self.joints.give(&joint.name) } else { (joint.name.clone(), false) };
        if renamed {
            self.lose(
                joint.at,
                owner(),
                "its name",
                format!("MJCF has taken that name; the joint is called \"{name}\""),
            );
        }
        let name = escaped(&name);
        let numbers_of = self.joint_numbers(joint);
        let mut lines: Vec<String> = Vec::new();
        match &joint.kind {
            JointKind::Fixed => {
                let generic = format!("{}_fixed", self.robot.links[joint.child].name);
                if joint.name != generic {
                    self.lose(joint.at, owner(), "its name", "MJCF has no fixed joints; its pose is the body's");
                }
            }
            JointKind::Revolute | JointKind::Continuous => {
                lines.push(format!("name=\"{name}\" type=\"hinge\" axis=\"{axis}\"{numbers_of}"));
                if joint.kind == JointKind::Revolute && joint.limits.range.is_none() {
                    self.lose(
                        joint.at,
                        owner(),
                        "revolute",
                        "MJCF has no limited hinge without limits; this one turns without limits",
                    );
                }
            }
            JointKind::Prismatic => lines.push(format!("name=\"{name}\" type=\"slide\" axis=\"{axis}\"{numbers_of}")),
            JointKind::Screw(pitch) => {
                let (slide, _) = self.joints.give(&format!("{}_slide", joint.name));
                let slide = escaped(&slide);
                lines.push(format!("name=\"{name}\" type=\"hinge\" axis=\"{axis}\"{numbers_of}"));
                lines.push(format!("name=\"{slide}\" type=\"slide\" axis=\"{axis}\""));
                let _ = writeln!(
                    self.equalities,
                    "    <joint joint1=\"{slide}\" joint2=\"{name}\" polycoef=\"0 {} 0 0 0\"/>",
                    pitch.metres_per_radian()
                );
            }
            JointKind::Planar => {
                let normal = joint.axis;
                let x = se3::least_rotation(&denavit_model::nalgebra::Vector3::z(), &normal);
                for (letter, column) in [("x", 0), ("y", 1)] {
                    let (slide, _) = self.joints.give(&format!("{}_{letter}", joint.name));
                    let along = x.matrix().column(column).into_owned();
                    lines.push(format!(
                        "name=\"{}\" type=\"slide\" axis=\"{}\"",
                        escaped(&slide),
                        numbers(along.as_slice())
                    ));
                }
                lines.push(format!("name=\"{name}\" type=\"hinge\" axis=\"{axis}\""));
                self.lose(joint.at, owner(), "planar", "MJCF has no planar joint; written as two slides and a hinge");
            }
            JointKind::Floating if joint.parent == self.robot.root && is_world(self.robot) => {
                lines.push(format!("name=\"{name}\" type=\"free\""));
            }
            JointKind::Floating => {
                for (letter, along) in [("x", "1 0 0"), ("y", "0 1 0"), ("z", "0 0 1")] {
                    let (slide, _) = self.joints.give(&format!("{}_{letter}", joint.name));
                    lines.push(format!("name=\"{}\" type=\"slide\" axis=\"{along}\"", escaped(&slide)));
                }
                lines.push(format!("name=\"{name}\" type=\"ball\""));
                self.lose(
                    joint.at,
                    owner(),
                    "floating",
                    "MuJoCo allows a free joint only in its world; written as three slides and a ball",
                );
            }
            JointKind::Unknown(word) if ["ball", "spherical"].contains(&word.as_str()) => {
                lines.push(format!("name=\"{name}\" type=\"ball\"{}", dynamics(joint)));
            }
            other => self.lose(joint.at, owner(), other.word(), "MJCF has no such joint; written as a fixed one"),
        }
        for line in lines {
            let _ = writeln!(self.out, "{indent}<joint {line}/>");
        }
        self.mimic(joint, &name);
        if joint.limits.velocity.is_some() {
            self.lose(joint.at, owner(), "velocity limit", "MJCF limits no joint's speed");
        }
        for element in &joint.elements {
            match element.tag() {
                "dynamics" => {}
                "limit" => self.lose(joint.at, owner(), "further limits", "MJCF limits neither acceleration nor jerk"),
                _ => self.element(owner(), element),
            }
        }
    }

    /// The numbers of `qpos` that a joint takes.
    fn slots(&mut self, joint: &Joint) {
        let index = self.robot.joint_index(&joint.name).unwrap_or(0);
        let still = |numbers: &[f64]| numbers.iter().map(|number| Slot::Still(*number)).collect::<Vec<_>>();
        let ball = [1.0, 0.0, 0.0, 0.0];
        self.qpos.extend(match &joint.kind {
            JointKind::Revolute | JointKind::Continuous | JointKind::Prismatic => vec![Slot::Joint(index, 1.0)],
            JointKind::Screw(pitch) => vec![Slot::Joint(index, 1.0), Slot::Joint(index, pitch.metres_per_radian())],
            JointKind::Planar => still(&[0.0; 3]),
            JointKind::Floating if joint.parent == self.robot.root && is_world(self.robot) => {
                let [x, y, z, w] = se3::quaternion_xyzw(&se3::rotation_from_rpy(joint.origin.rpy));
                still(&[&joint.origin.xyz[..], &[w, x, y, z]].concat())
            }
            JointKind::Floating => still(&[&[0.0; 3][..], &ball].concat()),
            JointKind::Unknown(word) if ["ball", "spherical"].contains(&word.as_str()) => still(&ball),
            _ => Vec::new(),
        });
    }

    fn mimic(&mut self, joint: &Joint, name: &str) {
        let Some(mimic) = &joint.mimic else { return };
        let owner = format!("joint \"{}\"", joint.name);
        let driver = self.robot.joint_index(&mimic.joint).map(|driver| &self.robot.joints[driver]);
        let couples = |joint: &Joint| {
            matches!(
                joint.kind,
                JointKind::Revolute | JointKind::Continuous | JointKind::Prismatic | JointKind::Screw(_)
            )
        };
        if !couples(joint) || !driver.is_some_and(couples) {
            self.lose(joint.at, owner, "<mimic>", "MJCF couples only hinges and slides of the model");
            return;
        }
        let _ = writeln!(
            self.equalities,
            "    <joint joint1=\"{name}\" joint2=\"{}\" polycoef=\"{} {} 0 0 0\"/>",
            escaped(&mimic.joint),
            mimic.offset,
            mimic.multiplier
        );
    }

    /// Limits, damping and friction of a hinge or slide.
    fn joint_numbers(&mut self, joint: &Joint) -> String {
        let owner = || format!("joint \"{}\"", joint.name);
        let mut out = String::new();
        match joint.limits_in_force().range {
            Some((lower, upper)) if lower < upper => {
                let _ = write!(out, " range=\"{}\"", numbers(&[lower, upper]));
            }
            Some((lower, upper)) if joint.kind.moves() => {
                let why = format!("MuJoCo refuses {lower} … {upper}: the upper limit must be above the lower");
                self.lose(joint.at, owner(), "range", why);
            }
            _ => {}
        }
        if joint.kind == JointKind::Continuous && joint.limits.range.is_some() {
            self.lose(joint.at, owner(), "range", "it has no effect on a continuous joint and is not written");
        }
        match joint.limits.effort {
            Some(effort) if effort > 0.0 => {
                let _ = write!(out, " actuatorfrcrange=\"{}\"", numbers(&[-effort, effort]));
            }
            Some(_) if joint.kind.moves() => {
                self.lose(joint.at, owner(), "effort limit", "MuJoCo refuses a force range of 0");
            }
            _ => {}
        }
        out + &dynamics(joint)
    }
}

/// Damping and friction where they are not 0, as attributes.
fn dynamics(joint: &Joint) -> String {
    let dynamics = joint.dynamics();
    let words = [("damping", dynamics.damping), ("frictionloss", dynamics.friction)];
    let stated = words.iter().filter(|(_, value)| *value != 0.0);
    stated.map(|(word, value)| format!(" {word}=\"{value}\"")).collect::<Vec<_>>().concat()
}
