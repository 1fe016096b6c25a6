//! Data of the 3-D view: screw axes at zero, frames and links, each with its carrying joint.

use super::{ChainPart, Document};
use crate::drawing::far_from_scale;
use denavit_dh::Motion;
use denavit_model::chain::{Chain, Coordinate, Quantity};
use denavit_model::nalgebra::Point3;
use denavit_model::screw::Screw;
use denavit_model::se3::Pose;
use serde::Serialize;
use std::collections::BTreeMap;

#[derive(Serialize)]
struct Scene {
    robot: String,
    /// m; what the initial view must contain.
    size: f64,
    coordinates: Vec<Slider>,
    chains: Vec<Moving>,
}

#[derive(Serialize)]
struct Slider {
    name: String,
    /// Whether it is an angle.
    turns: bool,
    lower: f64,
    upper: f64,
}

#[derive(Serialize)]
struct Moving {
    /// Indices of its coordinates, in its own order.
    coordinates: Vec<usize>,
    joints: Vec<Axis>,
    /// base_from_tip at zero: rows of the rotation, then the translation.
    home: [f64; 12],
    frames: Vec<Triad>,
    links: Vec<Link>,
}

/// A joint: value = scale · q\[coordinate\] about or along the line through `point`.
#[derive(Serialize)]
struct Axis {
    kind: &'static str,
    coordinate: usize,
    scale: f64,
    direction: [f64; 3],
    point: [f64; 3],
    pitch: f64,
    /// Where its body is drawn.
    body: [f64; 3],
}

/// A frame at zero, carried by the first `carried` joints.
#[derive(Serialize)]
struct Triad {
    name: String,
    pose: [f64; 12],
    carried: usize,
}

/// A line from a point that one link carries to a point that another or the same carries.
#[derive(Serialize)]
struct Link {
    from: ([f64; 3], usize),
    to: ([f64; 3], usize),
}

/// The data of the 3-D view, safe inside a script element.
pub(super) fn json(document: &Document) -> String {
    let parts = document.parts_from_one_base();
    let mut places: BTreeMap<&str, usize> = BTreeMap::new();
    let mut coordinates: Vec<&Coordinate> = Vec::new();
    for coordinate in parts.iter().flat_map(|part| part.chain.coordinates()) {
        places.entry(&coordinate.name).or_insert_with(|| {
            coordinates.push(coordinate);
            coordinates.len() - 1
        });
    }
    let size = parts.iter().map(|part| part.chain.size()).fold(0.0, f64::max);
    let scene = Scene {
        robot: document.main.chain.name().to_owned(),
        size,
        coordinates: coordinates.into_iter().map(slider).collect(),
        chains: parts.iter().map(|part| moving(part, &places)).collect(),
    };
    // A name may hold "</script>".
    serde_json::to_string(&scene).expect("every number of a chain is finite").replace('<', "\\u003c")
}

fn slider(coordinate: &Coordinate) -> Slider {
    let (lower, upper) = coordinate.range();
    // Zero is the pose in the figures; a joint with equal limits does not move.
    Slider { name: coordinate.name.clone(), turns: coordinate.quantity == Quantity::Angle, lower, upper }
}

fn twelve(pose: &Pose) -> [f64; 12] {
    let (r, t) = (pose.rotation.matrix(), pose.translation.vector);
    [r[(0, 0)], r[(0, 1)], r[(0, 2)], r[(1, 0)], r[(1, 1)], r[(1, 2)], r[(2, 0)], r[(2, 1)], r[(2, 2)], t.x, t.y, t.z]
}

fn moving(part: &ChainPart, places: &BTreeMap<&str, usize>) -> Moving {
    let chain = &part.chain;
    let indices: Vec<usize> = chain.coordinates().iter().map(|own| places[own.name.as_str()]).collect();
    let frames = part.table.frames();
    let mut zero = Pose::identity();
    let mut joints = Vec::new();
    for (joint, frame) in chain.joints().iter().zip(&frames) {
        let screw = joint.screw.moved(&zero);
        let origin = Point3::from(frame.translation.vector);
        joints.push(Axis {
            kind: Motion::of(&screw).word(),
            coordinate: indices[joint.coordinate],
            scale: joint.scale,
            direction: screw.direction().into_inner().into(),
            point: screw.line().map_or([0.0; 3], |line| line.point.coords.into()),
            pitch: screw.pitch().unwrap_or(0.0),
            body: screw.line().map_or(origin, |line| line.nearest_to(&origin)).coords.into(),
        });
        zero *= joint.screw.motion(joint.offset);
    }
    let home = zero * chain.home();
    let far = far_from_scale(&part.table);
    let mut triads = vec![Triad { name: "base".into(), pose: twelve(&Pose::identity()), carried: 0 }];
    if !far {
        let named = frames.iter().enumerate();
        triads.extend(named.map(|(k, frame)| Triad { name: k.to_string(), pose: twelve(frame), carried: k }));
    }
    triads.push(Triad { name: "tip".into(), pose: twelve(&home), carried: frames.len() - 1 });
    let links = if far { arm_links(chain, &home) } else { row_links(part, &frames, &home) };
    Moving { coordinates: indices, joints, home: twelve(&home), frames: triads, links }
}

/// Along d and a of every row, and along the travel of a prismatic joint.
fn row_links(part: &ChainPart, frames: &[Pose], home: &Pose) -> Vec<Link> {
    let mut links = Vec::new();
    let mut before = Pose::identity();
    let after = frames.iter().copied().chain([*home]);
    let lengths = part.table.rows.iter().map(|row| row.d().unwrap_or(0.0)).chain([part.table.tool.d]);
    for (carried, (after, d)) in after.zip(lengths).enumerate() {
        // The tool's pair is carried by the last joint, as the row before it.
        let carried = carried.min(part.table.joints.len());
        let start: [f64; 3] = before.translation.vector.into();
        let corner: [f64; 3] = (before * Point3::new(0.0, 0.0, d)).coords.into();
        let end: [f64; 3] = after.translation.vector.into();
        if let Some(joint) = carried.checked_sub(1) {
            links.push(Link { from: (start, joint), to: (start, carried) });
        }
        links.push(Link { from: (start, carried), to: (corner, carried) });
        links.push(Link { from: (corner, carried), to: (end, carried) });
        before = after;
    }
    links
}

/// From axis to axis by their nearest points: for tables with distant common normals.
fn arm_links(chain: &Chain, home: &Pose) -> Vec<Link> {
    let mut links = Vec::new();
    let mut zero = Pose::identity();
    let mut last = Point3::origin();
    for (index, joint) in chain.joints().iter().enumerate() {
        let screw: Screw = joint.screw.moved(&zero);
        let next = screw.line().map_or(last, |line| line.nearest_to(&last));
        links.push(Link { from: (last.coords.into(), index), to: (next.coords.into(), index) });
        links.push(Link { from: (next.coords.into(), index), to: (next.coords.into(), index + 1) });
        last = next;
        zero *= joint.screw.motion(joint.offset);
    }
    let carried = chain.joints().len();
    links.push(Link { from: (last.coords.into(), carried), to: (home.translation.vector.into(), carried) });
    links
}
