//! How a joint moves: its axes, limits and couplings.

use crate::error::SdfProblemKind as Kind;
use crate::frames::FrameId;
use crate::model::{Joint, Model, Part, Reader};
use crate::pose::{self, ROUNDING, Step, number, number_or_infinite, numbers, several, text_of};
use denavit_model::nalgebra::Vector3;
use denavit_model::problems::nearest_name;
use denavit_model::write::escaped;
use std::f64::consts::TAU;
use std::fmt::Write as _;

/// How a joint moves.
pub(crate) enum Motion {
    Fixed,
    /// About or along these axes, one after the other.
    Axes(Vec<Axis>),
    /// It does not move itself: it couples two other joints.
    Gearbox,
}

/// One degree of freedom.
pub(crate) struct Axis {
    /// Name of its joint where a joint has several.
    pub name: String,
    /// URDF's joint type.
    pub kind: &'static str,
    /// Direction in the joint's frame, as written where that is its frame in the file.
    pub direction: Vector3<f64>,
    xyz: String,
    /// Attributes of `<limit>`, each with a blank before it.
    limit: String,
    dynamics: String,
    mimic: Option<String>,
    /// m per turn, of a screw.
    lead: Option<String>,
}

/// Bounds of this size or more mean no bound.
///
/// # Source
/// SDF's `axis/limit`: the default of `lower` and `upper` is ∓1e16.
const UNLIMITED: f64 = 1e16;

impl Axis {
    fn along(name: String, kind: &'static str, xyz: &str, direction: Vector3<f64>) -> Self {
        let (limit, dynamics, mimic, lead) = (String::new(), String::new(), None, None);
        Self { name, kind, direction, xyz: xyz.to_owned(), limit, dynamics, mimic, lead }
    }

    /// Its content in the URDF's joint. Reversed: child and parent are swapped.
    pub fn urdf(&self, reversed: bool, coupled: Option<&str>) -> String {
        let xyz = if reversed { numbers(self.direction.map(|part| 0.0 - part).as_slice()) } else { self.xyz.clone() };
        let element =
            |tag: &str, inside: &str| if inside.is_empty() { String::new() } else { format!("<{tag}{inside}/>") };
        let mut out = format!("<axis xyz=\"{xyz}\"/>");
        out.push_str(&element("limit", &self.limit));
        out.push_str(&element("dynamics", &self.dynamics));
        out.push_str(self.mimic.as_deref().or(coupled).unwrap_or_default());
        if let Some(lead) = &self.lead {
            let _ = write!(out, "<drake:screw_thread_pitch value=\"{lead}\"/>");
        }
        out
    }
}

/// How a joint moves; `None` where that is wrong.
pub(crate) fn motion<'a>(reader: &mut Reader<'a>, model: &Model<'a>, joint: &Joint<'a>) -> Option<Motion> {
    let Some(written) = joint.part.node.attribute("type").map(str::trim).filter(|kind| !kind.is_empty()) else {
        reader.problem(joint.part, Kind::MissingType);
        return None;
    };
    let kind = written.to_ascii_lowercase();
    let axes = match kind.as_str() {
        "fixed" => return Some(Motion::Fixed),
        "gearbox" => return Some(Motion::Gearbox),
        "revolute" | "continuous" | "prismatic" | "screw" => {
            let Some(part) = joint.part.child("axis") else {
                reader.problem(joint.part, Kind::MissingElement("axis"));
                return None;
            };
            let mut axis = axis(reader, model, joint, part, joint.name.clone(), &kind)?;
            if kind == "screw" {
                axis.lead = Some(lead(reader, joint)?);
            }
            if axis.mimic.is_none() {
                axis.mimic = drake_mimic(model, joint);
            }
            vec![axis]
        }
        "universal" | "revolute2" => {
            let mut axes = Vec::new();
            for (tag, xyz, default) in [("axis", "1 0 0", Vector3::x()), ("axis2", "0 1 0", Vector3::y())] {
                let name = format!("{}_{tag}", joint.name);
                axes.push(match joint.part.child(tag) {
                    Some(part) => axis(reader, model, joint, part, name, "revolute")?,
                    None => Axis::along(name, "continuous", xyz, default),
                });
            }
            axes
        }
        // The order in which Drake's roll, pitch and yaw turn a ball.
        "ball" => [("z", "0 0 1", Vector3::z()), ("y", "0 1 0", Vector3::y()), ("x", "1 0 0", Vector3::x())]
            .map(|(letter, xyz, way)| Axis::along(format!("{}_{letter}", joint.name), "continuous", xyz, way))
            .into(),
        _ => {
            reader.problem(joint.part, Kind::UnknownType(written.to_owned()));
            return None;
        }
    };
    Some(Motion::Axes(axes))
}

/// m per turn.
///
/// # Source
/// SDF 1.10, `joint/screw_thread_pitch`: m per turn; `joint/thread_pitch`: rad per m with the opposite sign. Without either: 1 m
/// per turn. Test `test_pitch_of_screw_joints` compares with Drake.
fn lead<'a>(reader: &mut Reader<'a>, joint: &Joint<'a>) -> Option<String> {
    for element in ["screw_thread_pitch", "thread_pitch"] {
        let Some(part) = joint.part.child(element) else { continue };
        let written = number(part.node);
        let written = reader.take(part, written)?;
        if element == "screw_thread_pitch" && written != 0.0 {
            return Some(text_of(part.node).to_owned());
        }
        let lead = -TAU / written;
        if element == "thread_pitch" && lead.is_finite() && lead != 0.0 {
            return Some(lead.to_string());
        }
        reader.problem(part, Kind::BadPitch { element, value: text_of(part.node).to_owned() });
        return None;
    }
    reader.note(joint.part, "the screw joint states no pitch; SDF's default of 1 m per turn is used".to_owned());
    Some("1".to_owned())
}

fn axis<'a>(
    reader: &mut Reader<'a>,
    model: &Model<'a>,
    joint: &Joint<'a>,
    part: Part<'a>,
    name: String,
    kind: &str,
) -> Option<Axis> {
    let xyz = direction(reader, model, joint, part)?;
    let direction: Vec<f64> = xyz.split(' ').filter_map(|word| word.parse().ok()).collect();
    let [x, y, z] = direction[..] else { return None };
    let (lower, upper, limit) = limit(reader, part)?;
    let kind = match kind {
        "prismatic" => "prismatic",
        "screw" => "screw",
        "continuous" => "continuous",
        _ if lower.is_none() && upper.is_none() => "continuous",
        _ => "revolute",
    };
    let dynamics = dynamics(reader, part)?;
    let mimic = match part.child("mimic") {
        Some(mimic) => Some(coupling(reader, model, joint, mimic)?),
        None => None,
    };
    Some(Axis { name, kind, direction: Vector3::new(x, y, z), xyz, limit, dynamics, mimic, lead: None })
}

/// Direction of an axis in its joint's frame: three numbers.
pub(crate) fn direction<'a>(
    reader: &mut Reader<'a>,
    model: &Model<'a>,
    joint: &Joint<'a>,
    part: Part<'a>,
) -> Option<String> {
    let scope = &model.scopes[joint.scope];
    let written = part.child("xyz");
    let (values, words) = match written {
        Some(xyz) => reader.take(xyz, several(xyz.node, 3))?,
        None => (vec![0.0, 0.0, 1.0], vec!["0", "0", "1"]),
    };
    let vector = Vector3::new(values[0], values[1], values[2]);
    if vector.norm() == 0.0 {
        reader.problem(part, Kind::ZeroAxis(words.join(" ")));
        return None;
    }
    let in_model = match part.child("use_parent_model_frame") {
        Some(flag) if scope.version < (1, 7) => {
            let flag_value = pose::boolean(flag.node);
            reader.take(flag, flag_value)?
        }
        _ => false,
    };
    let named = written.and_then(|xyz| xyz.node.attribute("expressed_in")).filter(|name| !name.is_empty());
    let frame = match named {
        _ if scope.version < (1, 5) || in_model => scope.model,
        Some(name) => frame_named(reader, model, joint.scope, part, "expressed_in", name)?,
        None => joint.frame,
    };
    let (own, other) = (model.frames.pose(joint.frame).rotation, model.frames.pose(frame).rotation);
    if frame == joint.frame || own == other || model.frames.between(joint.frame, frame).is_identity() {
        return Some(words.join(" "));
    }
    let turned: Vector3<f64> = own.inverse() * (other * vector);
    let size = turned.norm();
    Some(numbers(turned.map(|part| if part.abs() < ROUNDING * size { 0.0 } else { part }).as_slice()))
}

/// The frame of this name, as seen from a model.
pub(crate) fn frame_named<'a>(
    reader: &mut Reader<'a>,
    model: &Model<'a>,
    scope: usize,
    part: Part<'a>,
    what: &'static str,
    name: &str,
) -> Option<FrameId> {
    let scope = &model.scopes[scope];
    if name == "__model__" {
        return Some(scope.model);
    }
    let found = model.frames.find(&format!("{}{name}", scope.prefix));
    if found.is_none() {
        let near = nearest_name(name, model.frames.names_in(&scope.prefix)).map(str::to_owned);
        reader.problem(part, Kind::UnknownFrame { what, name: name.to_owned(), near });
    }
    found
}

/// Where a part of a link is, in the link's frame.
pub(crate) fn within<'a>(
    reader: &mut Reader<'a>,
    model: &Model<'a>,
    link: FrameId,
    scope: usize,
    part: Part<'a>,
) -> Option<Step> {
    let Some(found) = part.child("pose") else { return Some(Step::identity()) };
    let step = pose::step(found.node);
    let step = reader.take(found, step)?;
    let base = found.node.attribute("relative_to").or(found.node.attribute("frame")).filter(|name| !name.is_empty());
    let Some(base) = base else { return Some(step) };
    let base = frame_named(reader, model, scope, found, "relative_to", base)?;
    let to_base = model.frames.between(link, base);
    Some(if to_base.is_identity() { step } else { Step::computed(to_base.pose * step.pose) })
}

type Bounds = (Option<f64>, Option<f64>, String);

/// The bounds that there are, and the attributes of URDF's `<limit>`.
fn limit<'a>(reader: &mut Reader<'a>, axis: Part<'a>) -> Option<Bounds> {
    let Some(limit) = axis.child("limit") else { return Some((None, None, String::new())) };
    let mut value = |tag: &'static str| match limit.child(tag) {
        None => Some(None),
        Some(part) => {
            let number = number_or_infinite(part.node);
            reader.take(part, number).map(|value| Some((value, text_of(part.node))))
        }
    };
    let (lower, upper) = (value("lower")?, value("upper")?);
    let (effort, velocity) = (value("effort")?, value("velocity")?);
    let bounded = |bound: Option<(f64, &'a str)>| bound.filter(|(value, _)| value.abs() < UNLIMITED);
    let (lower, upper) = (bounded(lower), bounded(upper));
    let mut out = String::new();
    if lower.is_some() || upper.is_some() {
        // A bound on one side: the other is where SDF has it.
        let word = |bound: Option<(f64, &'a str)>, none: &'a str| bound.map_or(none, |(_, word)| word).to_owned();
        out = format!(" lower=\"{}\" upper=\"{}\"", word(lower, "-1e16"), word(upper, "1e16"));
    }
    for (name, value) in [("effort", effort), ("velocity", velocity)] {
        // -1 and infinity: no limit.
        if let Some((_, word)) = value.filter(|(value, _)| *value != -1.0 && value.abs() < UNLIMITED) {
            let _ = write!(out, " {name}=\"{word}\"");
        }
    }
    Some((lower.map(|(value, _)| value), upper.map(|(value, _)| value), out))
}

fn dynamics<'a>(reader: &mut Reader<'a>, axis: Part<'a>) -> Option<String> {
    let Some(dynamics) = axis.child("dynamics") else { return Some(String::new()) };
    let mut out = String::new();
    for tag in ["damping", "friction", "spring_reference", "spring_stiffness"] {
        if let Some(part) = dynamics.child(tag) {
            let checked = number(part.node);
            reader.take(part, checked)?;
            let _ = write!(out, " {tag}=\"{}\"", text_of(part.node));
        }
    }
    Some(out)
}

/// URDF's `<mimic>`: SDF's value = multiplier · (leader - reference) + offset.
fn coupling<'a>(reader: &mut Reader<'a>, model: &Model<'a>, joint: &Joint<'a>, mimic: Part<'a>) -> Option<String> {
    let mut value = |tag: &'static str, default: f64| match mimic.child(tag) {
        None => Some(default),
        Some(part) => {
            let number = number(part.node);
            reader.take(part, number)
        }
    };
    let (multiplier, offset, reference) = (value("multiplier", 1.0)?, value("offset", 0.0)?, value("reference", 0.0)?);
    let Some(leader) = mimic.node.attribute("joint").filter(|name| !name.is_empty()) else {
        reader.problem(mimic, Kind::MissingElement("mimic joint=\"…\""));
        return None;
    };
    let name = format!("{}{leader}", model.scopes[joint.scope].prefix);
    let axis = mimic.node.attribute("axis").unwrap_or("axis");
    let several = model.joints.iter().find(|other| other.name == name);
    let several = several.and_then(|other| other.part.node.attribute("type"));
    let name = match several {
        Some("universal" | "revolute2") => format!("{name}_{axis}"),
        _ => name,
    };
    Some(mimic_element(&name, multiplier, offset - multiplier * reference))
}

pub(crate) fn mimic_element(joint: &str, multiplier: f64, offset: f64) -> String {
    format!("<mimic joint=\"{}\" multiplier=\"{multiplier}\" offset=\"{offset}\"/>", escaped(joint))
}

/// Drake's own element, which older files have.
fn drake_mimic(model: &Model, joint: &Joint) -> Option<String> {
    let node = joint.part.node.children().find(|node| node.is_element() && node.tag_name().name() == "mimic")?;
    let value =
        |name: &str, default: f64| node.attribute(name).and_then(|text| text.trim().parse().ok()).unwrap_or(default);
    let leader = format!("{}{}", model.scopes[joint.scope].prefix, node.attribute("joint")?);
    Some(mimic_element(&leader, value("multiplier", 1.0), value("offset", 0.0)))
}
