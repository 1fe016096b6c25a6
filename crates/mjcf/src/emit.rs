//! Bodies as URDF text, each line with the line of the model that it says.

use crate::bodies::{At, Body, Joint, Kind, Model, Shape, Site};
use crate::document::Document;
use crate::mass::Mass;
use crate::write::add_numbers;
use denavit_model::formats::{Builder, Format};
use denavit_model::nalgebra::Vector3;
use denavit_model::se3::{self, Pose};
use denavit_model::write::{self, escape, escaped};
use std::collections::HashSet;
use std::fmt::Write as _;

/// A smaller turn or place is 0: rounding.
const NOTHING: f64 = 1e-15;

/// The text, with its places.
pub fn urdf(document: &Document, model: Model) -> String {
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
    let mut text = Text { builder, links: links.collect(), joints: joints.collect() };
    text.line(document.root.at, &format!("<robot name=\"{}\">", escaped(&name)));
    let skipped = world_is_no_link(&bodies);
    for (index, body) in bodies.iter().enumerate() {
        if index == 0 && skipped {
            continue;
        }
        text.body(&bodies, body, skipped);
    }
    text.line(document.root.at, "</robot>");
    text.builder.text()
}

/// Whether the world is no link of its own: it holds one body and nothing else, and that body does not move in it.
fn world_is_no_link(bodies: &[Body]) -> bool {
    let world = &bodies[0];
    let mut held = bodies.iter().filter(|body| body.parent == Some(0));
    let (Some(only), None) = (held.next(), held.next()) else { return false };
    world.shapes.is_empty() && world.sites.is_empty() && only.joints.is_empty() && is_nothing(&only.pose)
}

fn is_nothing(pose: &Pose) -> bool {
    pose.translation.vector.amax() <= NOTHING && se3::rotation_angle(&pose.rotation) <= NOTHING
}

fn origin(out: &mut String, pose: &Pose) {
    if !is_nothing(pose) {
        out.push_str("<origin xyz=\"");
        add_numbers(out, pose.translation.vector.as_slice());
        out.push_str("\" rpy=\"");
        add_numbers(out, &se3::written_rpy(&pose.rotation));
        out.push_str("\"/>");
    }
}

fn attribute(out: &mut String, name: &str, value: f64) {
    out.extend([" ", name, "=\""]);
    add_numbers(out, &[value]);
    out.push('"');
}

fn inertial(text: &mut String, mass: &Mass) {
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
    for (name, row, column) in
        [("ixx", 0, 0), ("ixy", 0, 1), ("ixz", 0, 2), ("iyy", 1, 1), ("iyz", 1, 2), ("izz", 2, 2)]
    {
        attribute(text, name, t[(row, column)]);
    }
    text.push_str("/></inertial>");
}

/// A `<joint>` up to its ends.
fn open(text: &mut String, name: &str, kind: &str, parent: &str, child: &str, place: &Pose) {
    text.push_str("<joint name=\"");
    escape(text, name);
    text.extend(["\" type=\"", kind, "\">"]);
    origin(text, place);
    text.push_str("<parent link=\"");
    escape(text, parent);
    text.push_str("\"/><child link=\"");
    escape(text, child);
    text.push_str("\"/>");
}

struct Text {
    builder: Builder,
    links: HashSet<String>,
    joints: HashSet<String>,
}

impl Text {
    fn line(&mut self, at: At, text: &str) {
        self.builder.line(at, text);
    }

    /// A name that no link or joint has.
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
        let name = escaped(&body.name);
        self.line(body.at, &format!("<link name=\"{name}\">"));
        if let Some((mass, at)) = &body.mass {
            self.builder.line_by(*at, |text| inertial(text, mass));
        }
        for shape in &body.shapes {
            self.shape(shape);
        }
        self.line(body.at, "</link>");
        if let Some(parent) = body.parent.filter(|parent| !(*parent == 0 && world_is_skipped)) {
            self.joints_of(&bodies[parent].name, body);
        }
        for site in &body.sites {
            self.site(&body.name, site);
        }
    }

    fn shape(&mut self, shape: &Shape) {
        let Some(geometry) = &shape.geometry else { return };
        let put = |text: &mut String, tag: &str| {
            text.extend(["<", tag]);
            if let Some(name) = &shape.name {
                text.push_str(" name=\"");
                escape(text, name);
                text.push('"');
            }
            text.push('>');
            origin(text, &shape.pose);
            text.extend(["<geometry>", &write::geometry(geometry), "</geometry>"]);
        };
        if shape.seen {
            self.builder.line_by(shape.at, |text| {
                put(text, "visual");
                if let Some(rgba) = &shape.rgba {
                    text.push_str("<material name=\"\"><color rgba=\"");
                    add_numbers(text, rgba);
                    text.push_str("\"/></material>");
                }
                text.push_str("</visual>");
            });
        }
        if shape.collides {
            self.builder.line_by(shape.at, |text| {
                put(text, "collision");
                text.push_str("</collision>");
            });
        }
    }

    /// The joints of a body one behind another, with a link without mass between two, and one fixed joint behind the last where
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
                self.line(joint.at, &format!("<link name=\"{}\"/>", escaped(&name)));
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
        self.builder.line_by(at, |text| {
            open(text, &name, "fixed", parent, child, pose);
            text.push_str("</joint>");
        });
    }

    fn joint(&mut self, joint: &Joint, parent: &str, child: &str, place: &Pose) {
        let kind = match joint.kind {
            Kind::Hinge if joint.range.is_some() => "revolute",
            Kind::Hinge => "continuous",
            Kind::Slide => "prismatic",
            Kind::Ball => "ball",
            Kind::Free => "floating",
        };
        let mut text = String::with_capacity(500);
        open(&mut text, &joint.name, kind, parent, child, place);
        if matches!(joint.kind, Kind::Hinge | Kind::Slide) {
            text.push_str("<axis xyz=\"");
            add_numbers(&mut text, joint.axis.as_slice());
            text.push_str("\"/>");
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
                }
            }
            text.push_str("/>");
        }
        if let Some((driver, factor, offset)) = &joint.mimic {
            let driver = escaped(driver);
            let offset = offset + 0.0;
            let _ = write!(text, "<mimic joint=\"{driver}\" multiplier=\"{factor}\" offset=\"{offset}\"/>");
        }
        if joint.damping != 0.0 || joint.friction != 0.0 {
            let _ = write!(text, "<dynamics damping=\"{}\" friction=\"{}\"/>", joint.damping, joint.friction);
        }
        text.push_str("</joint>");
        self.line(joint.at, &text);
    }

    fn site(&mut self, body: &str, site: &Site) {
        self.line(site.at, &format!("<link name=\"{}\"/>", escaped(&site.name)));
        self.fixed(site.at, body, &site.name, &site.pose);
    }
}
