//! A robot line by line: everything that a comparison looks at, as input for `git diff`.
//!
//! Lines are sorted by name, numbers are rounded far below the comparison's tolerances, and what moves is given
//! in the root link's frame with every joint value 0: two descriptions of one robot give the same lines, except for
//! the poses of link frames, which are in a separate part.

use crate::mechanism::{Body, Mechanism, MovingJoint, PartPlace, Role};
use crate::subject::Subject;
use denavit_model::nalgebra::{Point3, Vector3};
use denavit_model::robot::Geometry;
use denavit_model::se3::Pose;
use denavit_model::tree::Reading;
use denavit_model::{AxisLine, Screw};
use std::fmt::Write;

/// The lines, ending in a line break: lengths in m, angles in rad, masses in kg.
///
/// # Examples
/// ```
/// use denavit_compare::{Subject, describe::describe};
/// let text = describe(&Subject::Chain { file: "-", chain: &denavit_model::examples::planar_arm() });
/// assert!(text.contains("joint \"joint_1\""), "{text}");
/// ```
pub fn describe(subject: &Subject) -> String {
    describe_as(subject, Reading::Intended)
}

/// The same, angles and axes as written or as intended.
pub fn describe_as(subject: &Subject, reading: Reading) -> String {
    let mechanism = subject.mechanism(reading);
    let mut out = format!("robot \"{}\"\n", mechanism.name);
    if let Subject::Robot(robot) = subject {
        let _ = writeln!(out, "root \"{}\"", robot.links[robot.root].name);
        let mut chains = robot.leaf_chains();
        chains.sort_by(|one, other| one.tip.cmp(&other.tip));
        for chain in chains {
            let _ = writeln!(out, "chain \"{}\" to \"{}\": {}", chain.base, chain.tip, chain.coordinates.join(" "));
        }
    }
    out.push_str("in the root link's frame with every joint at 0; m, rad, kg\n");
    let mut joints: Vec<usize> = (0..mechanism.joints.len()).collect();
    joints.sort_by(|one, other| mechanism.joints[*one].name.cmp(&mechanism.joints[*other].name));
    body(&mut out, "root", &mechanism.bodies[0]);
    for index in joints {
        joint(&mut out, &mechanism, index);
    }
    let mut frames: Vec<_> = mechanism.bodies.iter().flat_map(|body| &body.frames).collect();
    frames.sort_by(|one, other| one.link.cmp(&other.link));
    for frame in frames {
        let carrier = frame.carrier.as_ref().map_or_else(String::new, |joint| format!(" on joint \"{joint}\""));
        let _ = writeln!(out, "frame \"{}\"{carrier}: {}", frame.link, placed(&frame.pose));
    }
    let mut elements: Vec<_> = mechanism.elements.iter().collect();
    elements.sort_by(|one, other| one.label.cmp(&other.label));
    for element in elements {
        let _ = writeln!(out, "{}", element.label);
        for (path, value) in &element.entries {
            let _ = writeln!(out, "  {path}: {value}");
        }
        for part in &element.parts {
            let place = match &part.place {
                PartPlace::Pose(pose) => placed(pose),
                PartPlace::Inside(pose) => format!("in its part {}", placed(pose)),
                PartPlace::Point(point) => format!("at {}", vector(&point.coords)),
                PartPlace::Direction(direction) => format!("along {}", vector(direction)),
            };
            let _ = writeln!(out, "  {}: {place}", part.path);
        }
    }
    out
}

fn joint(out: &mut String, mechanism: &Mechanism, index: usize) {
    let MovingJoint { name, kind, screw, parent, limits, mimic, dynamics, soft_limits, .. } = &mechanism.joints[index];
    let carrier = parent.map_or_else(|| "the root".to_owned(), |joint| format!("\"{}\"", mechanism.joints[joint].name));
    let _ = writeln!(out, "joint \"{name}\"\n  {kind} on {carrier}");
    if let Some(screw) = screw {
        let _ = writeln!(out, "  axis {}", axis(screw));
    }
    if screw.is_none_or(|screw| screw.line().is_none()) {
        // An axis without a place does not say where the joint is.
        let _ = writeln!(out, "  at {}", vector(&mechanism.joints[index].origin.coords));
    }
    let MovingJoint { idle_range, calibration, .. } = &mechanism.joints[index];
    let bound = |value: Option<f64>| value.map_or_else(|| "none".to_owned(), number);
    if let Some((lower, upper)) = limits.range {
        let _ = writeln!(out, "  lower {} upper {}", number(lower), number(upper));
    }
    if let Some((lower, upper)) = idle_range {
        let _ = writeln!(out, "  stated although continuous: lower {} upper {}", number(*lower), number(*upper));
    }
    if let Some(sensor) = calibration {
        let (rising, falling) = (bound(sensor.rising), bound(sensor.falling));
        let reference =
            sensor.reference_position.map_or_else(String::new, |at| format!(" reference_position {}", number(at)));
        let _ = writeln!(out, "  calibration rising {rising} falling {falling}{reference}");
    }
    if limits.velocity.is_some() || limits.effort.is_some() {
        let _ = writeln!(out, "  velocity {} effort {}", bound(limits.velocity), bound(limits.effort));
    }
    if let Some((driver, multiplier, offset)) = mimic {
        let _ = writeln!(out, "  mimics \"{driver}\" times {} plus {}", number(*multiplier), number(*offset));
    }
    if dynamics.damping != 0.0 || dynamics.friction != 0.0 {
        let _ = writeln!(out, "  damping {} friction {}", number(dynamics.damping), number(dynamics.friction));
    }
    if let Some(soft) = soft_limits {
        let (lower, upper) = (soft.range.map(|range| range.0), soft.range.map(|range| range.1));
        let _ = writeln!(
            out,
            "  soft lower {} upper {} k_position {} k_velocity {}",
            bound(lower),
            bound(upper),
            number(soft.k_position),
            number(soft.k_velocity)
        );
    }
    body(out, "carries", &mechanism.bodies[index + 1]);
}

/// Links that form one body, with their masses and shapes.
fn body(out: &mut String, word: &str, body: &Body) {
    let mut links: Vec<String> = body.frames.iter().map(|frame| format!("\"{}\"", frame.link)).collect();
    links.sort();
    if !links.is_empty() {
        let _ = writeln!(out, "  {word} {}", links.join(" "));
    }
    let mut lines: Vec<String> = Vec::new();
    for share in body.mass.iter().flat_map(|mass| &mass.shares) {
        let t = &share.tensor;
        let tensor = [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)].map(|place| significant(t[place], t.norm()));
        let centre = vector(&share.centre.coords);
        lines.push(format!("  \"{}\" mass {} at {centre}", share.link, number(share.mass)));
        lines.push(format!("  \"{}\" inertia {}", share.link, tensor.join(" ")));
    }
    for shape in &body.shapes {
        let role = match shape.role {
            Role::Visual => "visual",
            Role::Collision => "collision",
        };
        lines.push(format!("  \"{}\" {role} {} {}", shape.link, geometry(&shape.geometry), placed(&shape.pose)));
    }
    lines.sort();
    for line in lines {
        let _ = writeln!(out, "{line}");
    }
}

fn geometry(geometry: &Geometry) -> String {
    let list = |numbers: &[f64]| numbers.iter().map(|x| number(*x)).collect::<Vec<_>>().join(" ");
    match geometry {
        Geometry::Box(edges) => format!("box {}", list(edges)),
        Geometry::Cylinder { radius, length } => format!("cylinder {}", list(&[*radius, *length])),
        Geometry::Capsule { radius, length } => format!("capsule {}", list(&[*radius, *length])),
        Geometry::Sphere(radius) => format!("sphere {}", number(*radius)),
        Geometry::Mesh { filename, scale } => format!("mesh {filename} scale {}", list(scale)),
        Geometry::Other(element) => element.clone(),
        _ => "shape".to_owned(),
    }
}

/// Direction, and the point of the line nearest to the root's origin: the same for every way to place the joint.
fn axis(screw: &Screw) -> String {
    let direction = vector(&screw.direction());
    let at = |line: &AxisLine| vector(&line.nearest_to(&Point3::origin()).coords);
    match screw {
        Screw::Revolute(line) => format!("turns about {direction} through {}", at(line)),
        Screw::Prismatic(_) => format!("slides along {direction}"),
        Screw::Helical { axis, pitch } => {
            format!("turns about {direction} through {} pitch {}", at(axis), number(pitch.metres_per_radian()))
        }
    }
}

/// Position and the directions of the x and z axes: unlike angles, these cannot jump by a turn.
fn placed(pose: &Pose) -> String {
    let axis = |unit: &Vector3<f64>| vector(&(pose.rotation * unit));
    format!("at {} x {} z {}", vector(&pose.translation.vector), axis(&Vector3::x()), axis(&Vector3::z()))
}

fn vector(vector: &Vector3<f64>) -> String {
    vector.iter().map(|x| place(*x)).collect::<Vec<_>>().join(" ")
}

/// A length or a component of a direction to eight places: a tenth of the comparison's tolerance.
fn place(x: f64) -> String {
    if x.abs() >= 1e6 {
        return number(x);
    }
    let text = format!("{x:.8}");
    let short = text.trim_end_matches('0').trim_end_matches('.');
    if short == "-0" { "0".to_owned() } else { short.to_owned() }
}

/// A stated number, without the last digits, which come from arithmetic.
fn number(x: f64) -> String {
    let rounded: f64 = format!("{x:.11e}").parse().unwrap_or(x);
    (rounded + 0.0).to_string()
}

/// A component of a tensor, to as many places as the largest has nine digits.
fn significant(x: f64, norm: f64) -> String {
    if norm == 0.0 || x.abs() < norm * 1e-9 {
        return "0".to_owned();
    }
    let digits = 8.0 + (x.abs() / norm).log10().floor();
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "between 0 and 8")]
    let digits = digits.clamp(0.0, 8.0) as usize;
    let rounded: f64 = format!("{x:.digits$e}").parse().unwrap_or(x);
    (rounded + 0.0).to_string()
}
