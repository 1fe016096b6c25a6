//! A robot as URDF text, in any order of elements and any format of numbers.

use super::chance::Chance;
use denavit_model::robot::{Geometry, Inertial, Joint, Link, Origin, Shape};
use denavit_model::{Element, JointKind, Limits, Robot, urdf};
use std::fmt::Write;

/// How numbers are written; each reads back as the same number.
#[derive(Clone, Copy, PartialEq)]
pub enum Numbers {
    Plain,
    Exponent,
    Padded,
}

pub struct Style {
    pub numbers: Numbers,
    /// Order of elements by chance, else as they are.
    pub shuffled: Option<u64>,
}

pub const PLAIN: Style = Style { numbers: Numbers::Plain, shuffled: None };

pub fn again(robot: &Robot, style: &Style) -> Robot {
    let text = text(robot, style);
    match urdf::read(&robot.source.file, &text) {
        Ok(robot) => robot,
        Err(error) => panic!("{error}"),
    }
}

fn escaped(name: &str) -> String {
    name.replace('&', "&amp;").replace('<', "&lt;").replace('"', "&quot;")
}

impl Style {
    fn number(&self, value: f64) -> String {
        match self.numbers {
            Numbers::Plain => format!("{value}"),
            Numbers::Exponent => format!("{value:e}"),
            Numbers::Padded => format!(
                "{}{value}{}",
                if value.is_sign_negative() { "" } else { "+" },
                if value.fract() == 0.0 { ".000" } else { "000" }
            ),
        }
    }

    fn numbers(&self, values: &[f64]) -> String {
        values.iter().map(|value| self.number(*value)).collect::<Vec<_>>().join(" ")
    }

    fn origin(&self, origin: &Origin) -> String {
        format!("<origin xyz=\"{}\" rpy=\"{}\"/>", self.numbers(&origin.xyz), self.numbers(&origin.rpy))
    }
}

pub fn text(robot: &Robot, style: &Style) -> String {
    let links = robot.links.iter().map(|link| link_text(link, style));
    let joints = robot.joints.iter().map(|joint| joint_text(robot, joint, style));
    let further = robot.elements.iter().map(element_text);
    let mut elements: Vec<String> = links.chain(joints).chain(further).collect();
    if let Some(seed) = style.shuffled {
        Chance::new(seed).shuffle(&mut elements);
    }
    let drake = "xmlns:drake=\"http://drake.mit.edu\"";
    format!("<robot name=\"{}\" {drake}>\n{}\n</robot>\n", escaped(&robot.name), elements.join("\n"))
}

fn link_text(link: &Link, style: &Style) -> String {
    let mut children: Vec<String> = Vec::new();
    children.extend(link.inertial.as_ref().map(|inertial| inertial_text(inertial, style)));
    children.extend(link.visuals.iter().map(|shape| shape_text(shape, "visual", style)));
    children.extend(link.collisions.iter().map(|shape| shape_text(shape, "collision", style)));
    children.extend(link.elements.iter().map(element_text));
    format!("<link name=\"{}\">{}</link>", escaped(&link.name), children.concat())
}

fn element_text(element: &Element) -> String {
    denavit_model::write::element(element)
}

fn inertial_text(inertial: &Inertial, style: &Style) -> String {
    let t = &inertial.tensor;
    let mut tensor = String::new();
    for (name, row, column) in
        [("ixx", 0, 0), ("ixy", 0, 1), ("ixz", 0, 2), ("iyy", 1, 1), ("iyz", 1, 2), ("izz", 2, 2)]
    {
        write!(tensor, " {name}=\"{}\"", style.number(t[(row, column)])).unwrap();
    }
    let (origin, mass) = (style.origin(&inertial.origin), style.number(inertial.mass));
    format!("<inertial>{origin}<mass value=\"{mass}\"/><inertia{tensor}/></inertial>")
}

fn shape_text(shape: &Shape, tag: &str, style: &Style) -> String {
    let geometry = match &shape.geometry {
        Geometry::Box(size) => format!("<box size=\"{}\"/>", style.numbers(size)),
        Geometry::Cylinder { radius, length } => {
            format!("<cylinder radius=\"{}\" length=\"{}\"/>", style.number(*radius), style.number(*length))
        }
        Geometry::Capsule { radius, length } => {
            format!("<capsule radius=\"{}\" length=\"{}\"/>", style.number(*radius), style.number(*length))
        }
        Geometry::Sphere(radius) => format!("<sphere radius=\"{}\"/>", style.number(*radius)),
        Geometry::Mesh { filename, scale } => {
            format!("<mesh filename=\"{}\" scale=\"{}\"/>", escaped(filename), style.numbers(scale))
        }
        Geometry::Other(element) if element.is_empty() => String::new(),
        Geometry::Other(element) => format!("<{element}/>"),
        _ => String::new(),
    };
    let further: String = shape.elements.iter().map(element_text).collect();
    format!("<{tag}>{}<geometry>{geometry}</geometry>{further}</{tag}>", style.origin(&shape.origin))
}

fn joint_text(robot: &Robot, joint: &Joint, style: &Style) -> String {
    let mut children = vec![
        style.origin(&joint.origin),
        format!("<parent link=\"{}\"/>", escaped(&robot.links[joint.parent].name)),
        format!("<child link=\"{}\"/>", escaped(&robot.links[joint.child].name)),
    ];
    children.extend(joint.axis_written.map(|axis| format!("<axis xyz=\"{}\"/>", style.numbers(&axis))));
    let Limits { range, velocity, effort } = joint.limits;
    let stated = [
        ("lower", range.map(|range| range.0)),
        ("upper", range.map(|range| range.1)),
        ("velocity", velocity),
        ("effort", effort),
    ];
    let stated = stated.iter().filter_map(|(name, value)| Some(format!(" {name}=\"{}\"", style.number((*value)?))));
    let further = joint.elements.iter().filter(|element| element.tag() == "limit").flat_map(|limit| &limit.nodes);
    let further = further.flat_map(|node| &node.attributes).map(|(name, value)| format!(" {name}=\"{value}\""));
    let stated: String = stated.chain(further).collect();
    if !stated.is_empty() {
        children.push(format!("<limit{stated}/>"));
    }
    children.extend(joint.mimic.as_ref().map(|mimic| {
        let (factor, offset) = (style.number(mimic.multiplier), style.number(mimic.offset));
        format!("<mimic joint=\"{}\" multiplier=\"{factor}\" offset=\"{offset}\"/>", escaped(&mimic.joint))
    }));
    children.extend(joint.elements.iter().filter(|element| element.tag() != "limit").map(element_text));
    let tag = if let JointKind::Screw(pitch) = &joint.kind {
        let lead = style.number(pitch.metres_per_radian() * std::f64::consts::TAU);
        children.push(format!("<drake:screw_thread_pitch value=\"{lead}\"/>"));
        "drake:joint"
    } else {
        "joint"
    };
    if let Some(seed) = style.shuffled {
        Chance::new(seed).shuffle(&mut children);
    }
    let (name, kind) = (escaped(&joint.name), joint.kind.word());
    format!("<{tag} name=\"{name}\" type=\"{kind}\">{}</{tag}>", children.concat())
}
