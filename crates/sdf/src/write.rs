//! From a robot to SDF 1.11.

mod further;
mod names;
mod scopes;

use crate::names::fresh;
use crate::pose::numbers;
use denavit_model::element::Element;
use denavit_model::formats::{FormatError, Loss, Written};
use denavit_model::nalgebra::{Quaternion, UnitQuaternion, Vector3};
use denavit_model::robot::{Geometry, Inertial, Origin, Shape};
use denavit_model::write::escaped;
use denavit_model::{Joint, JointKind, Link, Place, Robot, se3};
use further::Further;
use names::Names;
use scopes::{SEPARATOR, Scopes, is_in};
use std::collections::HashSet;
use std::f64::consts::TAU;
use std::fmt::Write as _;

/// How a link is represented in the SDF.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Part {
    /// The world itself: a massless root of that name.
    World,
    Link,
    /// A link without mass and shapes on a fixed joint: two frames, named as the joint and the link.
    Frame,
    /// A massless link between a joint and a link whose frame is not the joint's: SDF's joints have frames of their own.
    Joint,
}

/// The robot as SDF 1.11, and what SDF cannot state.
///
/// Poses of joints are relative to their parent, those of links to their joint, so every number stays as written. A massless link
/// on a fixed joint becomes a frame; other massless links stay links, of mass 0. A screw joint stays one joint. Elements inside
/// `<gazebo>` go where they belong. Links called `MODEL::LINK` stand in a model of their own where nothing in it names anything
/// outside.
///
/// # Errors
/// A joint that SDF cannot state, with its place.
///
/// # Examples
/// ```
/// let text = r#"<robot name="r"><link name="a"/><link name="b"/><link name="tool0"/>
///   <joint name="j" type="prismatic"><origin xyz="0 0 1"/><parent link="a"/><child link="b"/></joint>
///   <joint name="t" type="fixed"><origin xyz="0 0 1"/><parent link="b"/><child link="tool0"/></joint></robot>"#;
/// let robot = denavit_model::urdf::read("r.urdf", text)?;
/// let sdf = denavit_sdf::write(&robot).unwrap().text;
/// assert!(sdf.contains("<frame name=\"t\" attached_to=\"b\">") && sdf.contains("<frame name=\"tool0\" attached_to=\"t\"/>"));
/// # Ok::<(), denavit_model::UrdfError>(())
/// ```
pub fn write(robot: &Robot) -> Result<Written, FormatError> {
    let carriers = robot.carriers();
    let further = Further::of(robot);
    let parts: Vec<Part> = (0..robot.links.len()).map(|link| part(robot, link, carriers[link], &further)).collect();
    let mut further = further;
    let scopes = Scopes::of(robot);
    let names = Names::of(robot, &parts, &scopes);
    further.rename(&names);
    let mut writer = Writer {
        robot,
        names,
        scopes,
        scope: String::new(),
        parts,
        further,
        out: String::new(),
        losses: Vec::new(),
        problems: Vec::new(),
    };
    writer.model();
    if !writer.problems.is_empty() {
        return Err(FormatError { problems: writer.problems });
    }
    let mut losses = writer.names.losses(robot, &writer.parts);
    losses.append(&mut writer.losses);
    losses.append(&mut writer.further.losses(robot));
    losses.sort_by_key(|loss| loss.place.line);
    Ok(Written { text: writer.out, losses, sidecar: None, proof: Vec::new() })
}

fn part(robot: &Robot, index: usize, carrier: Option<usize>, further: &Further) -> Part {
    let link = &robot.links[index];
    let bare = link.inertial.is_none()
        && link.visuals.is_empty()
        && link.collisions.is_empty()
        && link.elements.is_empty()
        && !further.on_link(&link.name);
    match carrier.map(|joint| &robot.joints[joint]) {
        None if bare && is_world(robot, index) => Part::World,
        Some(joint) if bare && of_joint(robot, index, joint).is_some() => Part::Joint,
        Some(joint)
            if bare
                && joint.kind == JointKind::Fixed
                && !is_world(robot, joint.parent)
                && joint.elements.is_empty() =>
        {
            Part::Frame
        }
        _ => Part::Link,
    }
}

/// The joint that leads on from a massless link that the reader put between a joint and its child.
fn of_joint(robot: &Robot, link: usize, joint: &Joint) -> Option<usize> {
    let single =
        matches!(joint.kind, JointKind::Revolute | JointKind::Continuous | JointKind::Prismatic | JointKind::Screw(_));
    let mut on = robot.joints_from(link);
    let (only, None) = (on.next()?, on.next()) else { return None };
    let next = &robot.joints[only];
    let named = robot.links[link].name == format!("{}_frame", joint.name)
        && next.name == format!("{}_to_{}", joint.name, robot.links[next.child].name);
    (single && named && next.kind == JointKind::Fixed && next.elements.is_empty()).then_some(only)
}

fn is_world(robot: &Robot, link: usize) -> bool {
    link == robot.root && robot.links[link].name == "world" && robot.links.len() > 1
}

struct Writer<'a> {
    robot: &'a Robot,
    names: Names,
    scopes: Scopes,
    /// The model that is being written; empty for the robot itself.
    scope: String,
    parts: Vec<Part>,
    further: Further<'a>,
    out: String,
    losses: Vec<Loss>,
    problems: Vec<(Place, String)>,
}

impl Writer<'_> {
    fn line(&mut self, depth: usize, text: &str) {
        let around = if self.scope.is_empty() { 0 } else { 1 + self.scope.matches(SEPARATOR).count() };
        let _ = writeln!(self.out, "{:1$}{text}", "", 2 * (depth + around));
    }

    /// The name of something in the model that is being written.
    fn seen(&self, name: &str) -> String {
        let own = if self.scope.is_empty() { None } else { name.strip_prefix(self.scope.as_str()) };
        escaped(own.and_then(|own| own.strip_prefix(SEPARATOR)).unwrap_or(name))
    }

    fn lose(&mut self, place: Place, what: impl Into<String>, why: impl Into<String>) {
        self.losses.push(Loss { place, what: what.into(), why: why.into() });
    }

    fn model(&mut self) {
        let robot = self.robot;
        let prefixes = self.further.prefixes();
        let prefixes: Vec<&str> = prefixes.iter().map(String::as_str).collect();
        self.line(0, "<?xml version=\"1.0\"?>");
        self.line(0, &format!("<sdf version=\"1.11\"{}>", crate::sources::declarations(&prefixes)));
        let name = if robot.name.is_empty() { "robot" } else { &robot.name };
        self.line(1, &format!("<model name=\"{}\">", escaped(name)));
        for text in self.further.of_model(&["pose", "static"]) {
            self.line(2, &text);
        }
        self.inside(&robot.carriers());
        for text in self.further.of_model(&[]) {
            self.line(2, &text);
        }
        self.line(1, "</model>");
        self.line(0, "</sdf>");
    }

    /// Links, models and joints of the model that is being written.
    fn inside(&mut self, carriers: &[Option<usize>]) {
        let (robot, scope) = (self.robot, self.scope.clone());
        for (index, link) in robot.links.iter().enumerate() {
            if self.parts[index] == Part::Link && self.scopes.around(&link.name) == scope {
                self.link(index, link, carriers[index]);
            }
        }
        for inner in self.scopes.inside(&scope) {
            let name = self.seen(&inner);
            self.line(2, &format!("<model name=\"{name}\">"));
            // Where its first link is, whose pose in it is 0.
            let enters = |joint: &&Joint| {
                is_in(&robot.links[joint.child].name, &inner) && !is_in(&robot.links[joint.parent].name, &inner)
            };
            if let Some(carrier) = robot.joints.iter().position(|joint| enters(&joint)) {
                let pose = self.pose_on(carrier);
                self.line(3, &pose);
            }
            self.scope = inner;
            self.inside(carriers);
            self.scope.clone_from(&scope);
            self.line(2, "</model>");
        }
        for joint in robot.joints.iter().filter(|joint| self.scopes.around(&joint.name) == scope).collect::<Vec<_>>() {
            if self.parts[joint.child] == Part::Frame {
                self.frame(joint);
            } else if self.parts[joint.parent] != Part::Joint {
                self.joint(joint);
            }
        }
    }

    /// The pose of what a joint carries.
    fn pose_on(&self, carrier: usize) -> String {
        let joint = &self.robot.joints[carrier];
        if self.parts[joint.parent] == Part::Joint {
            let before = carriers_of(self.robot, joint.parent);
            pose(&self.seen(&self.names.joints[before]), &joint.origin)
        } else if joint.kind == JointKind::Floating {
            pose(&self.within(joint.parent), &joint.origin)
        } else {
            let name = format!("{}{}", self.names.joints[carrier], last_part(&joint.kind));
            format!("<pose relative_to=\"{}\">0 0 0 0 0 0</pose>", self.seen(&name))
        }
    }

    /// The reference frame of a pose in a link.
    fn within(&self, link: usize) -> String {
        if self.parts[link] == Part::World { "__model__".to_owned() } else { self.seen(&self.names.links[link]) }
    }

    fn link(&mut self, index: usize, link: &Link, carrier: Option<usize>) {
        self.line(2, &format!("<link name=\"{}\">", self.seen(&self.names.links[index])));
        if let Some(carrier) = carrier
            && is_in(&self.robot.links[self.robot.joints[carrier].parent].name, &self.scope)
        {
            let pose = self.pose_on(carrier);
            self.line(3, &pose);
        }
        let place = self.robot.source.place(link.at, format!("link \"{}\"", link.name));
        let own = self.further.inside(&link.name, "inertial", None);
        let inertial = inertial(link.inertial.as_ref(), &own);
        self.line(3, &inertial);
        if link.inertial.is_none() {
            let why = "it stays a link of mass 0, which Gazebo refuses to simulate";
            self.lose(place.clone(), "no <inertial>", why);
        }
        for (tag, shapes) in [("visual", &link.visuals), ("collision", &link.collisions)] {
            let mut names = HashSet::new();
            for shape in shapes {
                self.shape(tag, link, shape, &mut names);
            }
        }
        for text in self.further.of_link(&link.name, &link.visuals, &link.collisions) {
            self.line(3, &text);
        }
        for element in &link.elements {
            if further::is_of_link(element.tag()) {
                self.line(3, &denavit_model::write::element(element));
            } else {
                let place = self.robot.source.place(element.at, format!("link \"{}\"", link.name));
                self.lose(place, format!("<{}> of a link", element.tag()), "SDF has no such element");
            }
        }
        self.line(2, "</link>");
    }

    fn shape(&mut self, tag: &'static str, link: &Link, shape: &Shape, names: &mut HashSet<String>) {
        let place = self.robot.source.place(link.at, format!("link \"{}\"", link.name));
        let geometry = match &shape.geometry {
            Geometry::Box(size) => format!("<box><size>{}</size></box>", numbers(size)),
            Geometry::Sphere(radius) => format!("<sphere><radius>{radius}</radius></sphere>"),
            Geometry::Cylinder { radius, length } => {
                format!("<cylinder><radius>{radius}</radius><length>{length}</length></cylinder>")
            }
            Geometry::Capsule { radius, length } => {
                format!("<capsule><radius>{radius}</radius><length>{length}</length></capsule>")
            }
            Geometry::Mesh { filename, scale } => {
                let scale =
                    if *scale == [1.0; 3] { String::new() } else { format!("<scale>{}</scale>", numbers(scale)) };
                let further = self.further.in_mesh(&link.name, tag, shape.name.as_deref()).concat();
                format!("<mesh><uri>{}</uri>{scale}{further}</mesh>", escaped(filename))
            }
            other => {
                let word = if let Geometry::Other(word) = other { word.as_str() } else { "" };
                self.lose(
                    place,
                    format!("<{word}> of a {tag}"),
                    "the SDF form of this shape is not known, so it is left out",
                );
                return;
            }
        };
        // SDF needs a unique name in a link.
        let wanted = match &shape.name {
            Some(name) if !name.is_empty() => name.clone(),
            _ => format!("{}_{tag}", link.name.replace(SEPARATOR, "__")),
        };
        let name = fresh(names, &wanted);
        if shape.name.as_ref() != Some(&name) {
            let what = format!("name of a {tag}");
            self.lose(place.clone(), what, format!("SDF needs unique names: it is called \"{name}\" there"));
        }
        let mut inside = if origin_is_zero(&shape.origin) { String::new() } else { plain_pose(&shape.origin) };
        let _ = write!(inside, "<geometry>{geometry}</geometry>");
        for element in &shape.elements {
            match (tag, element.tag()) {
                ("visual", "material") => {
                    inside.push_str(&self.material(element));
                    self.material_losses(element, &place);
                }
                ("collision", "surface") => inside.push_str(&denavit_model::write::element(element)),
                (_, other) => {
                    let place = self.robot.source.place(element.at, format!("link \"{}\"", link.name));
                    let what = format!("<{other}> of a {tag}");
                    self.lose(place, what, "SDF has no such element");
                }
            }
        }
        for text in self.further.inside(&link.name, tag, shape.name.as_deref()) {
            inside.push_str(&text);
        }
        self.line(3, &format!("<{tag} name=\"{}\">{inside}</{tag}>", escaped(&name)));
    }

    /// A material: its colour, its own or of the robot's material of that name; or what SDF said of it.
    fn material(&self, element: &Element) -> String {
        let own = further::children(element);
        let sdf: Vec<String> = own
            .iter()
            .filter(|child| !["color", "texture"].contains(&child.tag()))
            .map(denavit_model::write::element)
            .collect();
        if !sdf.is_empty() {
            return format!("<material>{}</material>", sdf.concat());
        }
        let colour = |material: &Element| {
            further::children(material)
                .iter()
                .find(|child| child.tag() == "color")?
                .attribute("rgba")
                .map(str::to_owned)
        };
        let name = element.attribute("name");
        let named = || {
            let known = self.robot.elements.iter().filter(|known| known.tag() == "material");
            known.filter(|known| name.is_some() && known.attribute("name") == name).find_map(colour)
        };
        let Some(rgba) = colour(element).or_else(named) else { return String::new() };
        let rgba = escaped(&rgba);
        format!("<material><ambient>{rgba}</ambient><diffuse>{rgba}</diffuse></material>")
    }

    /// What SDF cannot state of a material.
    fn material_losses(&mut self, element: &Element, place: &Place) {
        let own = further::children(element);
        let script = own.iter().any(|child| child.tag() == "script");
        if element.attribute("name").is_some_and(|name| !name.is_empty()) && !script {
            self.lose(place.clone(), "name of a material", "SDF's materials have no names");
        }
        if own.iter().any(|child| child.tag() == "texture") {
            self.lose(place.clone(), "<texture> of a material", "SDF's textures are parts of scripts");
        }
    }

    fn frame(&mut self, joint: &Joint) {
        let index = self.robot.joints.iter().position(|other| std::ptr::eq(other, joint)).unwrap_or(0);
        let name = self.seen(&self.names.joints[index]);
        let parent = self.seen(&self.names.links[joint.parent]);
        let origin = plain_pose(&joint.origin);
        self.line(2, &format!("<frame name=\"{name}\" attached_to=\"{parent}\">{origin}</frame>"));
        let child = self.seen(&self.names.links[joint.child]);
        self.line(2, &format!("<frame name=\"{child}\" attached_to=\"{name}\"/>"));
    }

    fn joint(&mut self, joint: &Joint) {
        let index = self.robot.joints.iter().position(|other| std::ptr::eq(other, joint)).unwrap_or(0);
        let place = self.robot.joint_place(index);
        let name = self.names.joints[index].clone();
        let kind = match &joint.kind {
            JointKind::Floating => {
                let root = joint.parent == self.robot.root;
                let from =
                    if root { "" } else { "; it is placed where it is at joint values 0, and floats in the world" };
                let what = format!("name of floating joint \"{}\"", joint.name);
                self.lose(place, what, format!("a floating link has no joint in SDF{from}"));
                return;
            }
            JointKind::Planar => {
                self.planar(joint, &name);
                let why = "SDF has no planar joint: it becomes two prismatic joints and a revolute joint";
                self.lose(place, format!("planar joint \"{}\"", joint.name), why);
                return;
            }
            JointKind::Unknown(word) if ["ball", "spherical"].contains(&word.as_str()) => "ball",
            JointKind::Unknown(word) => {
                self.problems.push((place, format!("type \"{word}\" is not an SDF joint type; write another type")));
                return;
            }
            other => other.word(),
        };
        let parent = if self.parts[joint.parent] == Part::World {
            "world".into()
        } else {
            self.names.links[joint.parent].clone()
        };
        let at = pose(&self.within(joint.parent), &joint.origin);
        let child = match self.parts[joint.child] {
            Part::Joint => {
                of_joint(self.robot, joint.child, joint).map_or(joint.child, |next| self.robot.joints[next].child)
            }
            _ => joint.child,
        };
        let child = self.names.links[child].clone();
        self.line(2, &format!("<joint name=\"{}\" type=\"{kind}\">", self.seen(&name)));
        self.line(3, &at);
        self.line(3, &format!("<parent>{}</parent><child>{}</child>", self.seen(&parent), self.seen(&child)));
        if let JointKind::Screw(pitch) = joint.kind {
            self.line(3, &format!("<screw_thread_pitch>{}</screw_thread_pitch>", pitch.metres_per_radian() * TAU));
        }
        self.say_losses(joint, &place);
        if !["fixed", "ball"].contains(&kind) {
            let axis = self.axis(joint);
            self.line(3, &axis);
        }
        for text in self.further.of_joint(&joint.name) {
            self.line(3, &text);
        }
        self.line(2, "</joint>");
    }

    fn axis(&self, joint: &Joint) -> String {
        let xyz = joint.axis_written.unwrap_or([1.0, 0.0, 0.0]);
        let mut limit = String::new();
        let mut put = |tag: &str, value: Option<f64>| {
            if let Some(value) = value {
                let _ = write!(limit, "<{tag}>{value}</{tag}>");
            }
        };
        let limits = joint.limits_in_force();
        put("lower", limits.range.map(|range| range.0));
        put("upper", limits.range.map(|range| range.1));
        put("effort", limits.effort);
        put("velocity", limits.velocity);
        for text in self.further.inside(&joint.name, "limit", None) {
            limit.push_str(&text);
        }
        let mut dynamics = String::new();
        for element in joint.elements.iter().filter(|element| element.tag() == "dynamics") {
            for tag in further::DYNAMICS {
                if let Some(value) = element.attribute(tag) {
                    let _ = write!(dynamics, "<{tag}>{}</{tag}>", escaped(value.trim()));
                }
            }
        }
        let mut out = format!("<axis><xyz>{}</xyz>", numbers(&xyz));
        for (tag, inside) in [("limit", limit), ("dynamics", dynamics)] {
            if !inside.is_empty() {
                let _ = write!(out, "<{tag}>{inside}</{tag}>");
            }
        }
        if let Some(mimic) = &joint.mimic {
            let leader = self.robot.joint_index(&mimic.joint).map_or(&mimic.joint, |index| &self.names.joints[index]);
            let _ = write!(
                out,
                "<mimic joint=\"{}\"><multiplier>{}</multiplier><offset>{}</offset><reference>0</reference></mimic>",
                self.seen(leader),
                mimic.multiplier,
                mimic.offset
            );
        }
        for text in self.further.inside(&joint.name, "axis", None) {
            out.push_str(&text);
        }
        out + "</axis>"
    }

    /// What a joint states and SDF cannot.
    fn say_losses(&mut self, joint: &Joint, place: &Place) {
        let stated = joint.limits.range.is_some();
        let lost = match joint.kind {
            JointKind::Continuous if stated => {
                Some(("range of a continuous joint", "it has no effect, and SDF cannot state it"))
            }
            JointKind::Revolute if !stated => {
                Some(("revolute joint without a range", "in SDF that joint turns without limits"))
            }
            JointKind::Fixed if stated || joint.axis_written.is_some() || joint.mimic.is_some() => {
                Some(("axis, limits and mimic of a fixed joint", "they have no effect, and SDF cannot state them"))
            }
            _ => None,
        };
        if let Some((what, why)) = lost {
            self.lose(place.clone(), what, why);
        }
        for (word, value) in [("effort", joint.limits.effort), ("velocity", joint.limits.velocity)] {
            if value == Some(-1.0) && joint.kind.moves() {
                self.lose(place.clone(), format!("{word} limit of -1"), "SDF reads that as no limit");
            }
        }
        for element in &joint.elements {
            let tag = element.tag();
            let read = |name: &str| tag == "dynamics" && further::DYNAMICS.contains(&name);
            let beyond: Vec<&str> = element.nodes.first().map_or(Vec::new(), |node| {
                node.attributes.iter().map(|(name, _)| name.as_str()).filter(|name| !read(name)).collect()
            });
            if tag == "dynamics" && beyond.is_empty() && joint.kind.moves() {
                continue;
            }
            let what = if tag == "dynamics" || tag == "limit" {
                format!("<{tag} {}>", beyond.join(" "))
            } else {
                format!("<{tag}>")
            };
            let at = self.robot.source.place(element.at, format!("joint \"{}\"", joint.name));
            let at = if element.at == 0 { place.clone() } else { at };
            self.lose(at, format!("{what} of a joint"), "SDF has no such element");
        }
    }

    /// Two prismatic joints perpendicular to the axis and a revolute joint about it.
    fn planar(&mut self, joint: &Joint, name: &str) {
        let normal = joint.axis.into_inner();
        let (along, across) = across(&normal);
        let mut at = pose(&self.within(joint.parent), &joint.origin);
        let mut parent = if self.parts[joint.parent] == Part::World {
            "world".into()
        } else {
            self.names.links[joint.parent].clone()
        };
        let steps = [("_x", "prismatic", along), ("_y", "prismatic", across), ("_yaw", "continuous", normal)];
        for (index, (end, kind, axis)) in steps.into_iter().enumerate() {
            let own = format!("{name}{end}");
            let child = if index == 2 { self.names.links[joint.child].clone() } else { format!("{own}_link") };
            if index < 2 {
                let massless = inertial(None, &[]);
                let pose = format!("<pose relative_to=\"{}\">0 0 0 0 0 0</pose>", self.seen(&own));
                self.line(2, &format!("<link name=\"{}\">{pose}{massless}</link>", self.seen(&child)));
            }
            self.line(2, &format!("<joint name=\"{}\" type=\"{kind}\">", self.seen(&own)));
            self.line(3, &at);
            self.line(3, &format!("<parent>{}</parent><child>{}</child>", self.seen(&parent), self.seen(&child)));
            self.line(3, &format!("<axis><xyz>{}</xyz></axis>", numbers(axis.as_slice())));
            self.line(2, "</joint>");
            at = format!("<pose relative_to=\"{}\">0 0 0 0 0 0</pose>", self.seen(&child));
            parent = child;
        }
    }
}

/// The joint that carries a link that has one.
fn carriers_of(robot: &Robot, link: usize) -> usize {
    robot.joint_to(link).unwrap_or(0)
}

/// What the name of the joint that carries the child has at its end, of a joint that stands as several.
fn last_part(kind: &JointKind) -> &'static str {
    if *kind == JointKind::Planar { "_yaw" } else { "" }
}

/// Two directions across a third, as the model's chains take them: the plane's own x and y.
fn across(normal: &Vector3<f64>) -> (Vector3<f64>, Vector3<f64>) {
    let away = if normal.x.abs() < 0.9 { Vector3::x() } else { Vector3::y() };
    let x = (away - normal * normal.dot(&away)).normalize();
    (x, normal.cross(&x).normalize())
}

fn origin_is_zero(origin: &Origin) -> bool {
    origin.xyz == [0.0; 3] && origin.rpy == [0.0; 3] && origin.rpy_written.is_none() && origin.quat_written.is_none()
}

fn plain_pose(origin: &Origin) -> String {
    let (format, values) = pose_values(origin);
    format!("<pose{format}>{values}</pose>")
}

fn pose(relative_to: &str, origin: &Origin) -> String {
    let (format, values) = pose_values(origin);
    format!("<pose relative_to=\"{relative_to}\"{format}>{values}</pose>")
}

/// An attribute and the numbers of a `<pose>`, angles in the digits that they were written with.
fn pose_values(origin: &Origin) -> (&'static str, String) {
    let xyz = numbers(&origin.xyz);
    if let Some(written) = &origin.quat_written {
        let turn = se3::rotation_from_rpy(origin.rpy);
        let parsed: Option<Vec<f64>> = written.iter().map(|word| word.parse().ok()).collect();
        let kept = parsed.and_then(|q| {
            let quaternion = Quaternion::new(q[3], q[0], q[1], q[2]);
            let old = UnitQuaternion::try_new(quaternion, f64::MIN_POSITIVE)?.to_rotation_matrix();
            Some(se3::rotation_angle(&(old.inverse() * turn)) <= 1e-14)
        });
        let values = if kept == Some(true) { written.join(" ") } else { numbers(&se3::quaternion_xyzw(&turn)) };
        return (" rotation_format=\"quat_xyzw\"", format!("{xyz} {}", escaped(&values)));
    }
    let angle = |index: usize| {
        let written = origin.rpy_written.as_ref().map(|written| &written[index]);
        let kept = written.filter(|written| written.parse() == Ok(origin.rpy[index]));
        kept.map_or_else(|| origin.rpy[index].to_string(), |written| escaped(written))
    };
    ("", format!("{xyz} {} {} {}", angle(0), angle(1), angle(2)))
}

/// Mass, centre and tensor; all zero where there is none, which SDF would take as 1 kg.
fn inertial(inertial: Option<&Inertial>, further: &[String]) -> String {
    let (mass, tensor) = inertial.map_or_else(Default::default, |inertial| (inertial.mass, inertial.tensor));
    let at = inertial.filter(|inertial| !origin_is_zero(&inertial.origin)).map(|inertial| plain_pose(&inertial.origin));
    let entries = [("ixx", 0, 0), ("ixy", 0, 1), ("ixz", 0, 2), ("iyy", 1, 1), ("iyz", 1, 2), ("izz", 2, 2)];
    let mut out = format!("<inertial>{}<mass>{mass}</mass><inertia>", at.unwrap_or_default());
    for (tag, row, column) in entries {
        let _ = write!(out, "<{tag}>{}</{tag}>", tensor[(row, column)]);
    }
    out + "</inertia>" + &further.concat() + "</inertial>"
}
