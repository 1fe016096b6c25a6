//! What the bodies carry: masses, shapes, frames, and the tips whose displacement is computed.

use crate::comparison::{PartDifference, PartKind};
use crate::diff::alignment::Alignment;
use crate::diff::features::{alike, same_size, shape_apart};
use crate::diff::{Options, Scope};
use crate::mechanism::{Frame, Mass, Mechanism, PlacedShape, Role, Share, apart};
use crate::words;
use denavit_model::nalgebra::Point3;
use denavit_model::robot::Geometry;
use denavit_model::se3::Pose;
use std::collections::{HashMap, HashSet};

/// What was found.
#[derive(Default)]
pub(crate) struct Matter {
    pub parts: Vec<PartDifference>,
    /// Links of a under the name that they have in b.
    pub renamed: Vec<(String, String)>,
    /// Links that only a has.
    pub gone: Vec<String>,
    /// Links that only b has.
    pub new: Vec<String>,
    pub notes: Vec<String>,
    pub tips: Vec<TipPair>,
}

impl Matter {
    /// Changed names, a sentence for each kind of change.
    pub fn name_notes(&self, joints: &[(String, String)]) -> Vec<String> {
        let pairs = |pairs: &[(String, String)]| {
            let pairs: Vec<String> = pairs.iter().map(|(one, other)| format!("\"{one}\" is \"{other}\"")).collect();
            pairs.join(", ")
        };
        let list = |names: &[String]| {
            let names: Vec<String> = names.iter().map(|name| format!("\"{name}\"")).collect();
            names.join(", ")
        };
        let notes = [
            ("joints renamed", pairs(joints)),
            ("links renamed", pairs(&self.renamed)),
            ("links removed", list(&self.gone)),
            ("links added", list(&self.new)),
        ];
        notes.into_iter().filter(|(_, list)| !list.is_empty()).map(|(what, list)| format!("{what}: {list}")).collect()
    }
}

/// A leaf link that both have: the body of a that it is on, and where its origin is at zero in a and in b.
pub(crate) struct TipPair {
    pub link: String,
    pub body: usize,
    pub points: (Point3<f64>, Point3<f64>),
}

/// Corresponding bodies of a and b: more than one if a joint was added or removed.
struct Group {
    in_a: Vec<usize>,
    in_b: Vec<usize>,
}

pub(crate) fn compare(a: &Mechanism, b: &Mechanism, at: &Alignment, options: &Options) -> Matter {
    let mut found = Matter::default();
    let mut replaced = Vec::new();
    let links = (links_of(a), links_of(b));
    for group in groups(a, b, at) {
        if !(options.scope == Scope::Kinematics || a.bare || b.bare) {
            masses(&mut found, a, b, at, &group, options);
        }
        let off = shapes(&mut found, a, b, at, &group, options);
        frames(&mut found, &mut replaced, (a, b, at), &links, &group, &off, options);
    }
    if !replaced.is_empty() {
        found.notes.push(format!("same motion: link frames moved: {}", replaced.join(", ")));
    }
    found
}

fn links_of(mechanism: &Mechanism) -> HashSet<&str> {
    mechanism.bodies.iter().flat_map(|body| &body.frames).map(|frame| frame.link.as_str()).collect()
}

fn groups(a: &Mechanism, b: &Mechanism, at: &Alignment) -> Vec<Group> {
    let mut in_b: Vec<Vec<usize>> = vec![Vec::new(); b.bodies.len()];
    // A body's owner: the nearest body before it, including itself, that corresponds to one of a; parents come first.
    let mut owners = vec![0; b.bodies.len()];
    for body in 0..b.bodies.len() {
        let new = body > 0 && at.joint_a[body - 1].is_none();
        owners[body] = if new { owners[b.joints[body - 1].parent.map_or(0, |parent| parent + 1)] } else { body };
        in_b[owners[body]].push(body);
    }
    let mut result: Vec<Group> = Vec::new();
    let mut group_of: HashMap<usize, usize> = HashMap::new();
    for body in 0..a.bodies.len() {
        let owner = at.body_b[body];
        if let Some(group) = group_of.get(&owner) {
            result[*group].in_a.push(body);
        } else {
            group_of.insert(owner, result.len());
            result.push(Group { in_a: vec![body], in_b: std::mem::take(&mut in_b[owner]) });
        }
    }
    result
}

fn masses(found: &mut Matter, a: &Mechanism, b: &Mechanism, at: &Alignment, group: &Group, options: &Options) {
    let one = group.in_a.iter().filter_map(|body| Some(a.bodies[*body].mass.as_ref()?.moved(&at.moved[*body])));
    let other = group.in_b.iter().filter_map(|body| b.bodies[*body].mass.clone());
    let (one, other) = (one.reduce(Mass::joined), other.reduce(Mass::joined));
    let nothing = |mass: &Option<Mass>| mass.as_ref().is_none_or(|mass| mass.mass == 0.0 && mass.tensor.norm() == 0.0);
    let (one, other) = match (one, other) {
        (one, other) if nothing(&one) && nothing(&other) => return,
        (Some(one), Some(other)) => (one, other),
        (Some(one), None) => {
            let what = format!("mass {} kg is gone", words::digits(one.mass));
            return found.parts.push(part(&one.shares[0].link, PartKind::Inertial, what));
        }
        (None, Some(other)) => {
            let what = format!("mass {} kg is new", words::digits(other.mass));
            return found.parts.push(part(&other.shares[0].link, PartKind::Inertial, what));
        }
        (None, None) => return,
    };
    let links = |mass: &Mass| mass.shares.iter().map(|share| share.link.clone()).collect::<Vec<_>>();
    if links(&one) == links(&other) {
        for (share, now) in one.shares.iter().zip(&other.shares) {
            share_changes(found, share, now, a.size, options);
        }
    } else {
        share_changes(found, &one.sum(), &other.sum(), a.size, options);
    }
}

/// Compares a link's share, or the sum of a body's where links were split, joined or renamed; `size` is the robot's, m.
fn share_changes(found: &mut Matter, one: &Share, other: &Share, size: f64, options: &Options) {
    let link = &one.link;
    if (one.mass - other.mass).abs() > options.tolerance_mass * one.mass.abs() {
        let what = format!("mass {} kg to {} kg", shortest(one.mass), shortest(other.mass));
        found.parts.push(part(link, PartKind::Inertial, what));
    }
    let moved = (one.centre - other.centre).norm();
    if moved > options.tolerance_m && (one.mass != 0.0 || other.mass != 0.0) {
        found.parts.push(part(link, PartKind::Inertial, format!("centre of mass moved by {}", words::length(moved))));
    }
    let changed = (one.tensor - other.tensor).norm();
    let relative = changed / one.tensor.norm().max(other.tensor.norm());
    // What a design program writes for no inertia, such as -5e-20, is 0.
    let is_dust = changed <= f64::EPSILON * one.mass.min(other.mass) * size.powi(2);
    if relative > options.tolerance_mass && !is_dust {
        let what = format!("inertia tensor changed by {} % of its norm", words::digits(100.0 * relative));
        found.parts.push(part(link, PartKind::Inertial, what));
    }
}

/// A number without the rounding error of a sum.
fn shortest(value: f64) -> f64 {
    format!("{value:.11e}").parse().unwrap_or(value)
}

fn part(link: &str, kind: PartKind, what: String) -> PartDifference {
    PartDifference {
        part: format!("link \"{link}\""),
        what,
        kind,
        line: None,
        counts: true,
        link: Some(link.to_owned()),
    }
}

/// Compares shapes; returns the links with displaced shapes.
fn shapes(
    found: &mut Matter,
    a: &Mechanism,
    b: &Mechanism,
    at: &Alignment,
    group: &Group,
    options: &Options,
) -> HashSet<String> {
    if a.bare || b.bare {
        return HashSet::new();
    }
    let in_a = group.in_a.iter().flat_map(|body| {
        let moved = at.moved[*body];
        a.bodies[*body].shapes.iter().map(move |shape| PlacedShape { pose: moved * shape.pose, ..shape.clone() })
    });
    let of_b: Vec<&PlacedShape> = group.in_b.iter().flat_map(|body| &b.bodies[*body].shapes).collect();
    let mut on_link: HashMap<&str, Vec<usize>> = HashMap::new();
    for (index, shape) in of_b.iter().enumerate() {
        on_link.entry(&shape.link).or_default().push(index);
    }
    let mut taken = vec![false; of_b.len()];
    let mut left_a = Vec::new();
    for shape in in_a {
        let same = |index: &usize| {
            let other = of_b[*index];
            let (turned, distance) = shape_apart(&shape.geometry, &shape.pose, &other.pose);
            alike(&shape, other, options) && turned <= options.tolerance_rad && distance <= options.tolerance_m
        };
        // On its own link first: where nothing changed, that ends the search.
        let own = on_link.get(shape.link.as_str()).map_or(&[][..], Vec::as_slice);
        let own = own.iter().copied().find(|index| !taken[*index] && same(index));
        match own.or_else(|| (0..of_b.len()).find(|index| !taken[*index] && same(index))) {
            Some(index) => taken[index] = true,
            None => left_a.push(shape),
        }
    }
    let mut taken = taken.into_iter();
    let mut left_b = of_b;
    left_b.retain(|_| !taken.next().unwrap_or(false));
    let mut off = HashSet::new();
    let counts = options.scope == Scope::Everything;
    for shape in left_a {
        off.insert(shape.link.clone());
        let other = left_b
            .iter()
            .position(|other| alike(&shape, other, options) && other.link == shape.link)
            .or_else(|| left_b.iter().position(|other| other.role == shape.role && other.link == shape.link))
            .or_else(|| left_b.iter().position(|other| alike(&shape, other, options)));
        let what = match other.map(|index| left_b.remove(index)) {
            None => format!("{} is gone: {}", word(shape.role), describe(&shape.geometry)),
            Some(other) if same_size(&shape.geometry, &other.geometry, options.tolerance_m) => {
                let by = shape_apart(&shape.geometry, &shape.pose, &other.pose);
                format!("{} {}", word(shape.role), words::displacement(by, options.tolerance_rad, options.tolerance_m))
            }
            Some(other) => {
                format!("{}: {} to {}", word(shape.role), describe(&shape.geometry), describe(&other.geometry))
            }
        };
        found.parts.push(PartDifference { counts, ..part(&shape.link, role_kind(shape.role), what) });
    }
    for shape in left_b {
        let what = format!("{} is new: {}", word(shape.role), describe(&shape.geometry));
        found.parts.push(PartDifference { counts, ..part(&shape.link, role_kind(shape.role), what) });
    }
    if !counts {
        found.parts.retain(|part| part.counts);
    }
    off
}

fn word(role: Role) -> &'static str {
    match role {
        Role::Visual => "visual",
        Role::Collision => "collision",
    }
}

fn role_kind(role: Role) -> PartKind {
    match role {
        Role::Visual => PartKind::Visual,
        Role::Collision => PartKind::Collision,
    }
}

fn describe(geometry: &Geometry) -> String {
    match geometry {
        Geometry::Box([x, y, z]) => format!("box {x} × {y} × {z} m"),
        Geometry::Cylinder { radius, length } => format!("cylinder of radius {radius} m, length {length} m"),
        Geometry::Capsule { radius, length } => format!("capsule of radius {radius} m, length {length} m"),
        Geometry::Sphere(radius) => format!("sphere of radius {radius} m"),
        Geometry::Mesh { filename, scale: [x, y, z] } if [*x, *y, *z] == [1.0; 3] => format!("mesh {filename}"),
        Geometry::Mesh { filename, scale: [x, y, z] } => format!("mesh {filename}, scale {x} {y} {z}"),
        Geometry::Other(element) => format!("<{element}>"),
        _ => "another shape".into(),
    }
}

fn frames(
    found: &mut Matter,
    replaced: &mut Vec<String>,
    (a, b, at): (&Mechanism, &Mechanism, &Alignment),
    (links_a, links_b): &(HashSet<&str>, HashSet<&str>),
    group: &Group,
    off: &HashSet<String>,
    options: &Options,
) {
    let mut left_b: Vec<&Frame> = group.in_b.iter().flat_map(|body| &b.bodies[*body].frames).collect();
    let by_name: HashMap<&str, usize> =
        left_b.iter().enumerate().map(|(index, frame)| (frame.link.as_str(), index)).collect();
    let mut paired = vec![false; left_b.len()];
    let mut left_a = Vec::new();
    for (body, frame) in group.in_a.iter().flat_map(|body| a.bodies[*body].frames.iter().map(|frame| (*body, frame))) {
        match by_name.get(frame.link.as_str()) {
            Some(index) => {
                paired[*index] = true;
                pair(found, replaced, (body, frame, left_b[*index]), &at.moved[body], off, options);
            }
            None => left_a.push((body, frame)),
        }
    }
    let mut paired = paired.into_iter();
    left_b.retain(|_| !paired.next().unwrap_or(false));
    let close = |moved: &Pose, frame: &Frame, other: &Frame| {
        let (turned, distance) = apart(&(moved * frame.pose), &other.pose);
        turned <= options.tolerance_rad && distance <= options.tolerance_m
    };
    let only_leaf = |frames: &mut dyn Iterator<Item = &Frame>| frames.filter(|frame| frame.leaf).count() == 1;
    let alone = a.bare || b.bare || group.in_b.first() != Some(&0);
    let one_leaf =
        alone && only_leaf(&mut left_a.iter().map(|(_, frame)| *frame)) && only_leaf(&mut left_b.iter().copied());
    for (body, frame) in left_a {
        let moved = &at.moved[body];
        let place = left_b
            .iter()
            .position(|other| other.leaf == frame.leaf && close(moved, frame, other))
            .or_else(|| left_b.iter().position(|other| one_leaf && frame.leaf && other.leaf));
        if let Some(index) = place {
            let other = left_b.remove(index);
            if !(a.bare || b.bare) {
                found.renamed.push((frame.link.clone(), other.link.clone()));
            }
            pair(found, replaced, (body, frame, other), moved, off, options);
        } else if links_b.contains(frame.link.as_str()) {
            found.parts.push(part(&frame.link, PartKind::Frame, "it is attached to another moving body".into()));
        } else if !(a.bare || b.bare) {
            found.gone.push(frame.link.clone());
            // An unused leaf frame exists for users of the robot.
            if frame.leaf && !frame.matter {
                found.parts.push(part(&frame.link, PartKind::Frame, format!("frame is gone{}", carried_by(frame))));
            }
        }
    }
    let counts = options.scope == Scope::Everything;
    for frame in left_b {
        if !(links_a.contains(frame.link.as_str()) || a.bare || b.bare) {
            found.new.push(frame.link.clone());
            if frame.leaf && !frame.matter && counts {
                found.parts.push(part(&frame.link, PartKind::Frame, format!("frame is new{}", carried_by(frame))));
            }
        }
    }
}

fn carried_by(frame: &Frame) -> String {
    frame.carrier.as_ref().map_or_else(String::new, |joint| format!(" (joint \"{joint}\")"))
}

/// Compares two corresponding frames.
///
/// An empty leaf is only a frame, so its pose counts. The frame of a link with shapes, mass or joints may be anywhere
/// as long as these stay in place.
fn pair(
    found: &mut Matter,
    replaced: &mut Vec<String>,
    (body, frame, other): (usize, &Frame, &Frame),
    moved: &Pose,
    off: &HashSet<String>,
    options: &Options,
) {
    let carried = moved * frame.pose;
    let (turned, distance) = apart(&carried, &other.pose);
    let same = turned <= options.tolerance_rad && distance <= options.tolerance_m;
    let free = !frame.leaf || (frame.matter && !off.contains(&frame.link));
    if !same && free {
        replaced.push(format!("\"{}\"", frame.link));
    } else if !same {
        let on = carried_by(frame);
        let by = words::displacement((turned, distance), options.tolerance_rad, options.tolerance_m);
        let what = format!("frame {by}{on}");
        found.parts.push(part(&frame.link, PartKind::Frame, what));
    }
    if frame.leaf {
        let in_b = if free { carried } else { other.pose };
        let points = (Point3::from(frame.pose.translation.vector), Point3::from(in_b.translation.vector));
        found.tips.push(TipPair { link: frame.link.clone(), body, points });
    }
}
