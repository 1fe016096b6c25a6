//! Bodies as URDF text, each line with its source line in the model.

use crate::bodies::{At, Body, Joint, Kind, Model, Shape, Site};
use crate::document::Document;
use crate::mass::Mass;
use crate::write::add_numbers;
use denavit_model::chain::Limits;
use denavit_model::element::{Element, ElementNode};
use denavit_model::formats::{Builder, Format};
use denavit_model::intended::axis_read_as;
use denavit_model::nalgebra::{Matrix3, Unit, Vector3};
use denavit_model::robot::{
    Geometry, Inertial, Joint as UrdfJoint, JointKind, Link, Mimic, Origin, Shape as UrdfShape,
};
use denavit_model::se3::{self, Pose};
use denavit_model::urdf::{Loose, LooseJoint};
use denavit_model::write::{self, escape, escaped};
use std::collections::HashSet;
use std::fmt::Write as _;
use std::ops::Range;

/// A smaller turn or place is 0: rounding.
const NOTHING: f64 = 1e-15;

/// The text, with its places, and its tree.
pub fn urdf(document: &Document, model: Model) -> Builder {
    let mut builder = Builder::new(Format::Mjcf, document.files[0].clone());
    builder.translation.files.clone_from(&document.files);
    let Model { name, bodies, kept, notes, findings, understood } = model;
    builder.translation.kept = kept;
    builder.translation.notes = notes;
    builder.translation.findings = findings;
    builder.translation.understood = understood;
    let links = bodies
        .iter()
        .flat_map(|body| std::iter::once(body.name.clone()).chain(body.sites.iter().map(|site| site.name.clone())));
    let joints = bodies.iter().flat_map(|body| body.joints.iter().map(|joint| joint.name.clone()));
    let (links, joints) = (links.collect(), joints.collect());
    let mut text = Text { builder, tree: Loose::default(), read_back: true, links, joints };
    text.line(document.root.at, &format!("<robot name=\"{}\">", escaped(&name)));
    let skipped = world_is_no_link(&bodies);
    for (index, body) in bodies.iter().enumerate() {
        if index == 0 && skipped {
            continue;
        }
        text.body(&bodies, body, skipped);
    }
    text.line(document.root.at, "</robot>");
    text.check_text(&name);
    let Text { mut builder, mut tree, read_back, .. } = text;
    tree.name = name;
    builder.tree = read_back.then_some(tree);
    builder
}

/// Whether the world gets no link: it holds only one body, and that body is fixed to it.
fn world_is_no_link(bodies: &[Body]) -> bool {
    let world = &bodies[0];
    let mut held = bodies.iter().filter(|body| body.parent == Some(0));
    let (Some(only), None) = (held.next(), held.next()) else { return false };
    world.shapes.is_empty() && world.sites.is_empty() && only.joints.is_empty() && is_nothing(&only.pose)
}

fn is_nothing(pose: &Pose) -> bool {
    pose.translation.vector.amax() <= NOTHING && se3::rotation_angle(&pose.rotation) <= NOTHING
}

/// Writes the numbers of an attribute and returns their position.
fn written(out: &mut String, values: &[f64]) -> Range<usize> {
    let first = out.len();
    add_numbers(out, values);
    first..out.len()
}

/// Numbers as they are written: -0 as 0.
fn plain<const N: usize>(values: [f64; N]) -> [f64; N] {
    values.map(|value| value + 0.0)
}

fn origin(out: &mut String, pose: &Pose) -> Origin {
    if is_nothing(pose) {
        return Origin::default();
    }
    let (xyz, rpy): ([f64; 3], _) = (pose.translation.vector.into(), se3::written_rpy(&pose.rotation));
    out.push_str("<origin xyz=\"");
    add_numbers(out, &xyz);
    out.push_str("\" rpy=\"");
    let words = written(out, &rpy);
    let mut words = out[words].split(' ').map(str::to_owned);
    let rpy_written = [(); 3].map(|()| words.next().unwrap_or_default());
    out.push_str("\"/>");
    Origin { xyz: plain(xyz), rpy: plain(rpy), rpy_written: Some(rpy_written), quat_written: None }
}

fn attribute(out: &mut String, name: &str, value: f64) {
    out.extend([" ", name, "=\""]);
    add_numbers(out, &[value]);
    out.push('"');
}

fn inertial(text: &mut String, mass: &Mass) -> Inertial {
    text.push_str("<inertial>");
    if mass.centre != Vector3::zeros() {
        text.push_str("<origin xyz=\"");
        add_numbers(text, mass.centre.as_slice());
        text.push_str("\"/>");
    }
    text.push_str("<mass");
    attribute(text, "value", mass.mass);
    text.push_str("/><inertia");
    let t = &mass.tensor;
    let moments = [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)].map(|(row, column)| t[(row, column)]);
    for (name, moment) in ["ixx", "ixy", "ixz", "iyy", "iyz", "izz"].into_iter().zip(moments) {
        attribute(text, name, moment);
    }
    text.push_str("/></inertial>");
    let [xx, xy, xz, yy, yz, zz] = plain(moments);
    let tensor = Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz);
    let origin = Origin { xyz: plain(mass.centre.into()), ..Origin::default() };
    Inertial { origin, mass: mass.mass + 0.0, tensor }
}

/// A `<joint>` up to its ends.
fn open(text: &mut String, name: &str, kind: &str, parent: &str, child: &str, place: &Pose) -> Origin {
    text.push_str("<joint name=\"");
    escape(text, name);
    text.extend(["\" type=\"", kind, "\">"]);
    let origin = origin(text, place);
    text.push_str("<parent link=\"");
    escape(text, parent);
    text.push_str("\"/><child link=\"");
    escape(text, child);
    text.push_str("\"/>");
    origin
}

/// A joint of which only its ends and its place are known.
fn bare(name: &str, kind: JointKind, origin: Origin, at: usize) -> UrdfJoint {
    UrdfJoint {
        name: name.to_owned(),
        kind,
        origin,
        parent: 0,
        child: 0,
        axis: Vector3::x_axis(),
        axis_written: None,
        axis_meant: None,
        limits: Limits::default(),
        mimic: None,
        elements: Vec::new(),
        at,
    }
}

/// A visual's colour, as it is written.
fn material(rgba: &str, at: usize) -> Element {
    let node = |depth, tag: &str, name: &str, value: &str| ElementNode {
        depth,
        tag: tag.to_owned(),
        attributes: vec![(name.to_owned(), value.to_owned())],
        text: String::new(),
    };
    Element { nodes: vec![node(0, "material", "name", ""), node(1, "color", "rgba", rgba)], at }
}

struct Text {
    builder: Builder,
    tree: Loose,
    /// Whether reading the text gives the tree: all numbers are finite, and XML changes no character.
    read_back: bool,
    links: HashSet<String>,
    joints: HashSet<String>,
}

impl Text {
    fn line(&mut self, at: At, text: &str) {
        self.builder.line(at, text);
    }

    fn check_text(&mut self, text: &str) {
        self.read_back &= text.bytes().all(|byte| byte >= b' ');
    }

    fn check(&mut self, values: &[f64]) {
        self.read_back &= values.iter().all(|value| value.is_finite());
    }

    /// A link without anything in it, in a line of its own.
    fn empty_link(&mut self, at: At, name: &str) {
        self.check_text(name);
        self.tree.links.push(Link::named(name, self.builder.offset()));
        self.line(at, &format!("<link name=\"{}\"/>", escaped(name)));
    }

    fn push(&mut self, joint: UrdfJoint, parent: &str, child: &str) {
        self.check_text(&joint.name);
        self.check(&joint.origin.xyz);
        self.check(&joint.origin.rpy);
        self.tree.joints.push(LooseJoint { joint, parent: parent.to_owned(), child: child.to_owned() });
    }

    /// A name not used by any link or joint.
    fn new_name(taken: &mut HashSet<String>, wanted: &str) -> String {
        let mut name = wanted.to_owned();
        let mut number = 2;
        while taken.contains(&name) {
            name = format!("{wanted}_{number}");
            number += 1;
        }
        taken.insert(name.clone());
        name
    }

    fn body(&mut self, bodies: &[Body], body: &Body, world_is_skipped: bool) {
        let mut link = Link::named(&*body.name, self.builder.offset());
        self.check_text(&body.name);
        self.line(body.at, &format!("<link name=\"{}\">", escaped(&body.name)));
        if let Some((mass, at)) = &body.mass {
            self.builder.line_by(*at, |text| link.inertial = Some(inertial(text, mass)));
            self.check(mass.centre.as_slice());
            self.check(mass.tensor.as_slice());
            self.check(&[mass.mass]);
        }
        for shape in &body.shapes {
            self.shape(shape, &mut link);
        }
        self.line(body.at, "</link>");
        self.tree.links.push(link);
        if let Some(parent) = body.parent.filter(|parent| !(*parent == 0 && world_is_skipped)) {
            self.joints_of(&bodies[parent].name, body);
        }
        for site in &body.sites {
            self.site(&body.name, site);
        }
    }

    fn shape(&mut self, shape: &Shape, link: &mut Link) {
        let Some(geometry) = &shape.geometry else { return };
        let put = |text: &mut String, tag: &str| {
            text.extend(["<", tag]);
            if let Some(name) = &shape.name {
                text.push_str(" name=\"");
                escape(text, name);
                text.push('"');
            }
            text.push('>');
            let origin = origin(text, &shape.pose);
            text.extend(["<geometry>", &write::geometry(geometry), "</geometry>"]);
            UrdfShape { name: shape.name.clone(), origin, geometry: geometry.clone(), elements: Vec::new() }
        };
        if shape.seen {
            self.builder.line_by(shape.at, |text| {
                let mut visual = put(text, "visual");
                if let Some(rgba) = &shape.rgba {
                    let at = text.len();
                    text.push_str("<material name=\"\"><color rgba=\"");
                    let colour = written(text, rgba);
                    visual.elements.push(material(&text[colour], at));
                    text.push_str("\"/></material>");
                }
                text.push_str("</visual>");
                link.visuals.push(visual);
            });
        }
        if shape.collides {
            self.builder.line_by(shape.at, |text| {
                link.collisions.push(put(text, "collision"));
                text.push_str("</collision>");
            });
        }
        self.check_text(shape.name.as_deref().unwrap_or_default());
        self.check(shape.pose.translation.vector.as_slice());
        self.check(shape.pose.rotation.matrix().as_slice());
        match geometry {
            Geometry::Box(edges) => self.check(edges),
            Geometry::Sphere(radius) => self.check(&[*radius]),
            Geometry::Cylinder { radius, length } | Geometry::Capsule { radius, length } => {
                self.check(&[*radius, *length]);
            }
            Geometry::Mesh { filename, scale } => {
                self.check_text(filename);
                self.check(scale);
            }
            _ => self.read_back = false,
        }
    }

    /// The joints of a body in series, with a massless link between two, and one fixed joint after the last where
    /// its axis does not go through the body's origin.
    fn joints_of(&mut self, parent: &str, body: &Body) {
        if body.joints.is_empty() {
            self.fixed(body.at, parent, &body.name, &body.pose);
            return;
        }
        let mut parent = parent.to_owned();
        let mut here = body.pose;
        let mut offset = Vector3::zeros();
        for (index, joint) in body.joints.iter().enumerate() {
            let turns = matches!(joint.kind, Kind::Hinge | Kind::Ball);
            let point = if turns { joint.pos } else { offset };
            let mut place = here * se3::translation(point - offset);
            if joint.zero != 0.0 {
                let axis = joint.axis.normalize();
                place *= match joint.kind {
                    Kind::Hinge => se3::pose(se3::rotation_about(&axis, -joint.zero), Vector3::zeros()),
                    Kind::Slide => se3::translation(axis * -joint.zero),
                    _ => Pose::identity(),
                };
            }
            offset = point;
            let is_last = index + 1 == body.joints.len();
            let child = if is_last && offset == Vector3::zeros() {
                body.name.clone()
            } else {
                let wanted = format!("{}_{}", body.name, joint.name);
                let name = Self::new_name(&mut self.links, &wanted);
                self.empty_link(joint.at, &name);
                name
            };
            self.joint(joint, &parent, &child, &place);
            parent = child;
            here = Pose::identity();
        }
        if offset != Vector3::zeros() {
            self.fixed(body.at, &parent, &body.name, &se3::translation(-offset));
        }
    }

    fn fixed(&mut self, at: At, parent: &str, child: &str, pose: &Pose) {
        let name = Self::new_name(&mut self.joints, &format!("{child}_fixed"));
        let first = self.builder.offset();
        let mut place = Origin::default();
        self.builder.line_by(at, |text| {
            place = open(text, &name, "fixed", parent, child, pose);
            text.push_str("</joint>");
        });
        self.push(bare(&name, JointKind::Fixed, place, first), parent, child);
    }

    fn joint(&mut self, joint: &Joint, parent: &str, child: &str, place: &Pose) {
        let (word, kind) = match joint.kind {
            Kind::Hinge if joint.range.is_some() => ("revolute", JointKind::Revolute),
            Kind::Hinge => ("continuous", JointKind::Continuous),
            Kind::Slide => ("prismatic", JointKind::Prismatic),
            Kind::Ball => ("ball", JointKind::Unknown("ball".into())),
            Kind::Free => ("floating", JointKind::Floating),
        };
        let first = self.builder.offset();
        let mut text = String::with_capacity(500);
        let place = open(&mut text, &joint.name, word, parent, child, place);
        let mut made = bare(&joint.name, kind, place, first);
        if matches!(joint.kind, Kind::Hinge | Kind::Slide) {
            text.push_str("<axis xyz=\"");
            let axis = written(&mut text, joint.axis.as_slice());
            made.axis_meant = axis_read_as(&text[axis]);
            text.push_str("\"/>");
            let axis = plain(joint.axis.into());
            self.check(&axis);
            made.axis_written = Some(axis);
            match Unit::try_new(Vector3::from(axis), 0.0) {
                Some(axis) => made.axis = axis,
                None => self.read_back = false,
            }
        }
        let bounds = [
            ("lower", joint.range.map(|range| range.0)),
            ("upper", joint.range.map(|range| range.1)),
            ("effort", joint.effort),
            ("velocity", joint.velocity),
        ];
        if bounds.iter().any(|(_, value)| value.is_some()) {
            text.push_str("<limit");
            for (name, value) in bounds {
                if let Some(value) = value {
                    attribute(&mut text, name, value);
                    self.check(&[value]);
                }
            }
            text.push_str("/>");
            let own = |value: Option<f64>| value.map(|value| value + 0.0);
            let range = joint.range.map(|(lower, upper)| (lower + 0.0, upper + 0.0));
            made.limits = Limits { range, velocity: own(joint.velocity), effort: own(joint.effort) };
        }
        if let Some((driver, factor, offset)) = &joint.mimic {
            let offset = offset + 0.0;
            let _ = write!(text, "<mimic joint=\"");
            escape(&mut text, driver);
            let _ = write!(text, "\" multiplier=\"{factor}\" offset=\"{offset}\"/>");
            self.check(&[*factor, offset]);
            self.check_text(driver);
            let mimic = Mimic { joint: driver.clone(), multiplier: *factor, offset };
            made.mimic = (!driver.is_empty()).then_some(mimic);
        }
        if joint.damping != 0.0 || joint.friction != 0.0 {
            let numbers = [("damping", joint.damping), ("friction", joint.friction)];
            let numbers = numbers.map(|(name, value)| (name.to_owned(), value.to_string()));
            let at = first + text.len();
            let _ = write!(text, "<dynamics damping=\"{}\" friction=\"{}\"/>", numbers[0].1, numbers[1].1);
            made.elements.push(Element { at, ..Element::empty("dynamics", numbers) });
        }
        text.push_str("</joint>");
        self.line(joint.at, &text);
        self.push(made, parent, child);
    }

    fn site(&mut self, body: &str, site: &Site) {
        self.empty_link(site.at, &site.name);
        self.fixed(site.at, body, &site.name, &site.pose);
    }
}
