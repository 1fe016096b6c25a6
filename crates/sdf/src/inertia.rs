//! Mass, centre and tensor of a link.

use crate::error::SdfProblemKind as Kind;
use crate::joints::within;
use crate::model::{Link, Model, Part, Reader};
use crate::pose::{Step, number, several, text_of};
use denavit_model::Pose;
use denavit_model::nalgebra::{Matrix3, Vector3};
use denavit_model::se3;
use std::f64::consts::PI;
use std::fmt::Write as _;

const ENTRIES: [(&str, &str); 6] = [("ixx", "1"), ("ixy", "0"), ("ixz", "0"), ("iyy", "1"), ("iyz", "0"), ("izz", "1")];
/// kg/m³: SDF's default of `density`, that of water.
const WATER: f64 = 1000.0;

/// URDF's `<inertial>`, and its source. A link with mass and tensor 0 has none. Without `<inertial>`, or in it without
/// `<mass>` and `<inertia>`, SDF's defaults apply: 1 kg, 1 kg·m² about each axis.
pub(crate) fn of_link<'a>(reader: &mut Reader<'a>, model: &Model<'a>, link: &Link<'a>) -> Option<(Part<'a>, String)> {
    let Some(inertial) = link.part.child("inertial") else {
        reader.defaults.push(link.part);
        return Some((link.part, element(&Step::identity(), "1", &ENTRIES.map(|(_, default)| default.to_owned()))));
    };
    if inertial.node.attribute("auto").is_some_and(|auto| ["true", "1"].contains(&auto.trim())) {
        return automatic(reader, model, link, inertial);
    }
    let step = within(reader, model, link.frame, link.scope, inertial)?;
    let mass = if let Some(part) = inertial.child("mass") {
        value(reader, part)?
    } else {
        reader.finding("default-inertia", link.part, "its <inertial> has no <mass>; SDF's default of 1 kg is used");
        "1".to_owned()
    };
    let inertia = inertial.child("inertia");
    if inertia.is_none() {
        let what = "its <inertial> has no <inertia>; SDF's default of 1 kg·m² about each axis is used";
        reader.finding("default-inertia", link.part, what);
    }
    let mut entries = Vec::new();
    for (tag, default) in ENTRIES {
        entries.push(match inertia.and_then(|inertia| inertia.child(tag)) {
            Some(part) => value(reader, part)?,
            None => default.to_owned(),
        });
    }
    let zero = |word: &String| word.parse() == Ok(0.0);
    let massless = zero(&mass) && entries.iter().all(zero);
    let entries: [String; 6] = entries.try_into().ok()?;
    (!massless).then(|| (inertial, element(&step, &mass, &entries)))
}

/// One note for all links that have SDF's default.
pub(crate) fn say_defaults(reader: &mut Reader) {
    let defaults = std::mem::take(&mut reader.defaults);
    if let Some(first) = defaults.first() {
        let many = if defaults.len() > 1 { format!(" ({} links)", defaults.len()) } else { String::new() };
        let what = format!("there is no <inertial>{many}; SDF's default of 1 kg and 1 kg·m² about each axis is used");
        reader.finding("default-inertia", *first, what);
    }
}

fn value<'a>(reader: &mut Reader<'a>, part: Part<'a>) -> Option<String> {
    let checked = number(part.node);
    reader.take(part, checked)?;
    Some(text_of(part.node).to_owned())
}

fn element(step: &Step, mass: &str, entries: &[String; 6]) -> String {
    let origin = if step.is_identity() { String::new() } else { format!("<origin {}/>", step.origin) };
    let mut out = format!("<inertial>{origin}<mass value=\"{mass}\"/><inertia");
    for ((tag, _), value) in ENTRIES.iter().zip(entries) {
        let _ = write!(out, " {tag}=\"{value}\"");
    }
    out + "/></inertial>"
}

/// Mass of the collisions: `<inertial auto="true">` of SDF 1.11.
fn automatic<'a>(
    reader: &mut Reader<'a>,
    model: &Model<'a>,
    link: &Link<'a>,
    inertial: Part<'a>,
) -> Option<(Part<'a>, String)> {
    let density = match inertial.child("density") {
        Some(part) => {
            let density = number(part.node);
            reader.take(part, density)?
        }
        None => WATER,
    };
    let mut solids = Vec::new();
    for collision in link.part.children("collision") {
        let own = match collision.child("density") {
            Some(part) => {
                let density = number(part.node);
                reader.take(part, density)?
            }
            None => density,
        };
        let pose = within(reader, model, link.frame, link.scope, collision)?.pose;
        let shape =
            collision.child("geometry").and_then(|geometry| geometry.node.children().find(roxmltree::Node::is_element));
        let Some(shape) = shape.map(|node| Part { node, file: collision.file }) else { continue };
        if let Some((volume, tensor)) = solid(reader, shape)? {
            solids.push((volume * own, tensor * own, pose));
        } else {
            let name = shape.node.tag_name().name().to_owned();
            reader.note(shape, format!("the mass of a <{name}> is not computed here, so the link has no inertial"));
            return None;
        }
    }
    let mass: f64 = solids.iter().map(|(mass, ..)| mass).sum();
    if solids.is_empty() || mass <= 0.0 {
        reader.note(inertial, "there is no collision to compute the mass from, so the link has no inertial");
        return None;
    }
    let centre: Vector3<f64> =
        solids.iter().map(|(part, _, pose)| pose.translation.vector * *part).sum::<Vector3<f64>>() / mass;
    let tensor: Matrix3<f64> = solids
        .iter()
        .map(|(part, own, pose)| {
            let turn = pose.rotation.matrix();
            let away = pose.translation.vector - centre;
            turn * own * turn.transpose()
                + (Matrix3::identity() * away.norm_squared() - away * away.transpose()) * *part
        })
        .sum();
    let entry = |row, column| tensor[(row, column)].to_string();
    let entries = [entry(0, 0), entry(0, 1), entry(0, 2), entry(1, 1), entry(1, 2), entry(2, 2)];
    let step = Step::computed(Pose::from_parts(centre.into(), se3::rotation_from_rpy([0.0; 3])));
    Some((inertial, element(&step, &mass.to_string(), &entries)))
}

/// Volume (m³) and tensor about the centre per density (m⁵) of a solid; nothing inside where that is not computed.
#[allow(clippy::option_option)] // Wrong numbers are one thing, shapes without a formula another.
fn solid<'a>(reader: &mut Reader<'a>, shape: Part<'a>) -> Option<Option<(f64, Matrix3<f64>)>> {
    let mut value = |tag: &'static str| {
        let Some(part) = shape.child(tag) else {
            reader.problem(shape, Kind::MissingElement(tag));
            return None;
        };
        let number = number(part.node);
        reader.take(part, number)
    };
    let diagonal = |x: f64, y: f64, z: f64| Matrix3::from_diagonal(&Vector3::new(x, y, z));
    Some(match shape.node.tag_name().name() {
        "sphere" => {
            let r = value("radius")?;
            let volume = 4.0 / 3.0 * PI * r.powi(3);
            let about = 0.4 * volume * r * r;
            Some((volume, diagonal(about, about, about)))
        }
        "cylinder" => {
            let (r, l) = (value("radius")?, value("length")?);
            let volume = PI * r * r * l;
            let across = volume * (3.0 * r * r + l * l) / 12.0;
            Some((volume, diagonal(across, across, volume * r * r / 2.0)))
        }
        "capsule" => {
            let (r, l) = (value("radius")?, value("length")?);
            let (tube, ball) = (PI * r * r * l, 4.0 / 3.0 * PI * r.powi(3));
            let along = tube * r * r / 2.0 + 0.4 * ball * r * r;
            // Two half balls, their centres 3r/8 beyond the ends of the tube.
            let across = tube * (3.0 * r * r + l * l) / 12.0 + ball * (0.4 * r * r + l * l / 4.0 + 3.0 * l * r / 8.0);
            Some((tube + ball, diagonal(across, across, along)))
        }
        "box" | "ellipsoid" => {
            let is_box = shape.node.tag_name().name() == "box";
            let tag = if is_box { "size" } else { "radii" };
            let Some(part) = shape.child(tag) else {
                reader.problem(shape, Kind::MissingElement(tag));
                return None;
            };
            let numbers = several(part.node, 3);
            let (numbers, _) = reader.take(part, numbers)?;
            let [x, y, z] = [numbers[0], numbers[1], numbers[2]];
            let volume = if is_box { x * y * z } else { 4.0 / 3.0 * PI * x * y * z };
            let part = if is_box { volume / 12.0 } else { volume / 5.0 };
            Some((volume, diagonal(part * (y * y + z * z), part * (x * x + z * z), part * (x * x + y * y))))
        }
        _ => None,
    })
}
