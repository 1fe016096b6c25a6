//! A robot as URDF text: everything that [`Robot`] holds, with numbers that read back exactly.
//!
//! To change only a few places of a robot's text and keep the rest, edit the text instead.

use crate::element::{Element, ElementNode};
use crate::robot::{Geometry, Inertial, Joint, JointKind, Link, Origin, Robot, Shape};
use crate::se3;
use nalgebra::{Matrix3, Quaternion, UnitQuaternion};
use std::collections::BTreeSet;
use std::fmt::Write;

/// The robot as URDF text. Angles keep the digits that they were written with.
///
/// # Examples
/// ```
/// let text = r#"<robot name="r"><link name="a"/><link name="b"/>
///   <joint name="j" type="continuous"><parent link="a"/><child link="b"/></joint></robot>"#;
/// let robot = denavit_model::urdf::read("r.urdf", text)?;
/// let again = denavit_model::urdf::read("r.urdf", &denavit_model::write::urdf(&robot))?;
/// assert_eq!(again.joints[0].name, "j");
/// # Ok::<(), denavit_model::UrdfError>(())
/// ```
pub fn urdf(robot: &Robot) -> String {
    let mut out = String::from("<?xml version=\"1.0\"?>\n<robot");
    if !robot.name.is_empty() {
        let _ = write!(out, " name=\"{}\"", escaped(&robot.name));
    }
    for prefix in prefixes(robot) {
        let uri = if prefix == "drake" { "http://drake.mit.edu".into() } else { format!("urn:unbound:{prefix}") };
        let _ = write!(out, " xmlns:{prefix}=\"{uri}\"");
    }
    out.push_str(">\n");
    for link in &robot.links {
        out.push_str(&self::link(link));
    }
    for joint in &robot.joints {
        out.push_str(&self::joint(robot, joint));
    }
    for further in &robot.elements {
        let _ = writeln!(out, "  {}", element(further));
    }
    out.push_str("</robot>\n");
    out
}

/// An element with everything in it.
pub fn element(element: &Element) -> String {
    let mut out = String::new();
    let mut open: Vec<&ElementNode> = Vec::new();
    for (index, node) in element.nodes.iter().enumerate() {
        while open.len() > node.depth {
            let Some(done) = open.pop() else { break };
            let _ = write!(out, "</{}>", done.tag);
        }
        let _ = write!(out, "<{}", node.tag);
        for (name, value) in &node.attributes {
            let _ = write!(out, " {name}=\"{}\"", escaped(value));
        }
        let holds = element.nodes.get(index + 1).is_some_and(|next| next.depth > node.depth);
        if !holds && node.text.is_empty() {
            out.push_str("/>");
            continue;
        }
        let _ = write!(out, ">{}", escaped(&node.text));
        open.push(node);
    }
    while let Some(done) = open.pop() {
        let _ = write!(out, "</{}>", done.tag);
    }
    out
}

/// Text as it may stand between quotes or tags.
pub fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    escape(&mut out, text);
    out
}

/// Adds text as it may stand between quotes or tags.
pub fn escape(out: &mut String, text: &str) {
    let mut rest = text;
    while let Some(at) = rest.bytes().position(|byte| b"&<>\"".contains(&byte)) {
        out.push_str(&rest[..at]);
        out.push_str(match rest.as_bytes()[at] {
            b'&' => "&amp;",
            b'<' => "&lt;",
            b'>' => "&gt;",
            _ => "&quot;",
        });
        rest = &rest[at + 1..];
    }
    out.push_str(rest);
}

/// Namespace prefixes in use.
fn prefixes(robot: &Robot) -> BTreeSet<&str> {
    let of_links = robot.links.iter().flat_map(|link| {
        let shapes = link.visuals.iter().chain(&link.collisions).flat_map(|shape| &shape.elements);
        link.elements.iter().chain(shapes)
    });
    let elements = robot.elements.iter().chain(of_links).chain(robot.joints.iter().flat_map(|joint| &joint.elements));
    let names = elements.flat_map(|element| &element.nodes).flat_map(|node| {
        std::iter::once(node.tag.as_str()).chain(node.attributes.iter().map(|(name, _)| name.as_str()))
    });
    let mut found: BTreeSet<&str> = names.filter_map(|name| Some(name.split_once(':')?.0)).collect();
    if robot.joints.iter().any(|joint| matches!(joint.kind, JointKind::Screw(_))) {
        found.insert("drake");
    }
    found.remove("xml");
    found
}

/// Numbers with blanks between them, each so that it reads back as itself.
pub fn numbers(values: &[f64]) -> String {
    let mut out = String::new();
    for (index, value) in values.iter().enumerate() {
        let _ = write!(out, "{}{value}", if index == 0 { "" } else { " " });
    }
    out
}

/// An `<origin>`; empty where it is the identity and nothing else was written.
pub fn origin(origin: &Origin) -> String {
    let unwritten = origin.rpy_written.is_none() && origin.quat_written.is_none();
    if origin.xyz == [0.0; 3] && origin.rpy == [0.0; 3] && unwritten {
        return String::new();
    }
    if let Some(written) = &origin.quat_written {
        let turn = se3::rotation_from_rpy(origin.rpy);
        // As written, where that still is the rotation.
        let number = |index: usize| written[index].parse::<f64>().ok();
        let kept = (|| {
            let quaternion = Quaternion::new(number(3)?, number(0)?, number(1)?, number(2)?);
            let old = UnitQuaternion::try_new(quaternion, f64::MIN_POSITIVE)?.to_rotation_matrix();
            Some(se3::rotation_angle(&(old.inverse() * turn)) <= 1e-14)
        })();
        let quaternion = if kept == Some(true) {
            written.each_ref().map(|word| escaped(word)).join(" ")
        } else {
            numbers(&se3::quaternion_xyzw(&turn))
        };
        return format!("<origin xyz=\"{}\" quat_xyzw=\"{quaternion}\"/>", numbers(&origin.xyz));
    }
    // As written, where that still is the angle.
    let angle = |index: usize| {
        let written = origin.rpy_written.as_ref().map(|written| &written[index]);
        let kept = written.filter(|written| written.parse() == Ok(origin.rpy[index]));
        kept.map_or_else(|| origin.rpy[index].to_string(), |written| escaped(written))
    };
    format!("<origin xyz=\"{}\" rpy=\"{} {} {}\"/>", numbers(&origin.xyz), angle(0), angle(1), angle(2))
}

/// A `<link>` with everything in it, lines with their ends.
pub fn link(link: &Link) -> String {
    let mut parts: Vec<String> = Vec::new();
    parts.extend(link.inertial.as_ref().map(inertial));
    parts.extend(link.visuals.iter().map(|visual| shape("visual", visual)));
    parts.extend(link.collisions.iter().map(|collision| shape("collision", collision)));
    parts.extend(link.elements.iter().map(element));
    with_parts(&format!("link name=\"{}\"", escaped(&link.name)), "link", &parts)
}

fn with_parts(open: &str, tag: &str, parts: &[String]) -> String {
    if parts.is_empty() {
        return format!("  <{open}/>\n");
    }
    let mut out = format!("  <{open}>\n");
    for part in parts.iter().filter(|part| !part.is_empty()) {
        let _ = writeln!(out, "    {part}");
    }
    let _ = writeln!(out, "  </{tag}>");
    out
}

/// An `<inertial>`.
pub fn inertial(inertial: &Inertial) -> String {
    let (at, tensor) = (origin(&inertial.origin), inertia(&inertial.tensor));
    format!("<inertial>{at}<mass value=\"{}\"/>{tensor}</inertial>", inertial.mass)
}

/// An `<inertia>`.
pub fn inertia(t: &Matrix3<f64>) -> String {
    let entries = [("ixx", 0, 0), ("ixy", 0, 1), ("ixz", 0, 2), ("iyy", 1, 1), ("iyz", 1, 2), ("izz", 2, 2)];
    let tensor = entries.map(|(name, row, column)| format!(" {name}=\"{}\"", t[(row, column)])).concat();
    format!("<inertia{tensor}/>")
}

/// The content of a `<geometry>`; empty where the robot's text has nothing there.
pub fn geometry(geometry: &Geometry) -> String {
    match geometry {
        Geometry::Box(edges) => format!("<box size=\"{}\"/>", numbers(edges)),
        Geometry::Cylinder { radius, length } => format!("<cylinder radius=\"{radius}\" length=\"{length}\"/>"),
        Geometry::Capsule { radius, length } => format!("<capsule radius=\"{radius}\" length=\"{length}\"/>"),
        Geometry::Sphere(radius) => format!("<sphere radius=\"{radius}\"/>"),
        Geometry::Mesh { filename, scale } if *scale == [1.0; 3] => {
            format!("<mesh filename=\"{}\"/>", escaped(filename))
        }
        Geometry::Mesh { filename, scale } => {
            format!("<mesh filename=\"{}\" scale=\"{}\"/>", escaped(filename), numbers(scale))
        }
        Geometry::Other(word) if word.is_empty() => String::new(),
        Geometry::Other(word) => format!("<{word}/>"),
    }
}

/// A `<visual>` or `<collision>`, by its tag.
pub fn shape(tag: &str, shape: &Shape) -> String {
    let name = shape.name.as_ref().map_or_else(String::new, |name| format!(" name=\"{}\"", escaped(name)));
    let geometry = geometry(&shape.geometry);
    let further: String = shape.elements.iter().map(element).collect();
    format!("<{tag}{name}>{}<geometry>{geometry}</geometry>{further}</{tag}>", origin(&shape.origin))
}

/// A `<joint>` with everything in it, lines with their ends.
pub fn joint(robot: &Robot, joint: &Joint) -> String {
    let link = |index: usize| escaped(robot.links.get(index).map_or("", |link| link.name.as_str()));
    let mut parts = vec![
        origin(&joint.origin),
        format!("<parent link=\"{}\"/>", link(joint.parent)),
        format!("<child link=\"{}\"/>", link(joint.child)),
    ];
    parts.extend(joint.axis_written.map(|axis| format!("<axis xyz=\"{}\"/>", numbers(&axis))));
    let stated = [
        ("lower", joint.limits.range.map(|range| range.0)),
        ("upper", joint.limits.range.map(|range| range.1)),
        ("effort", joint.limits.effort),
        ("velocity", joint.limits.velocity),
    ];
    let (limits, others): (Vec<&Element>, Vec<&Element>) =
        joint.elements.iter().partition(|element| element.tag() == "limit");
    let further = limits.iter().flat_map(|limit| &limit.nodes).flat_map(|node| &node.attributes);
    let further = further.map(|(name, value)| format!(" {name}=\"{}\"", escaped(value)));
    let stated = stated.iter().filter_map(|(name, value)| Some(format!(" {name}=\"{}\"", (*value)?)));
    let stated: String = stated.chain(further).collect();
    if !stated.is_empty() {
        parts.push(format!("<limit{stated}/>"));
    }
    parts.extend(joint.mimic.as_ref().map(|mimic| {
        let (driver, factor, offset) = (escaped(&mimic.joint), mimic.multiplier, mimic.offset);
        format!("<mimic joint=\"{driver}\" multiplier=\"{factor}\" offset=\"{offset}\"/>")
    }));
    let tag = if let JointKind::Screw(pitch) = joint.kind {
        let lead = pitch.metres_per_radian() * std::f64::consts::TAU;
        parts.push(format!("<drake:screw_thread_pitch value=\"{lead}\"/>"));
        "drake:joint"
    } else {
        "joint"
    };
    parts.extend(others.into_iter().map(element));
    let open = format!("{tag} name=\"{}\" type=\"{}\"", escaped(&joint.name), escaped(joint.kind.word()));
    with_parts(&open, tag, &parts)
}
