//! What a view draws: links and their shapes, joints, their poses and drivers.

use denavit_model::element::Element;
use denavit_model::robot::{Geometry, Shape};
use denavit_model::{PlacedRobot, Pose, Reading, Robot};
use serde_json::{Value, json};

/// The tree as JSON: lengths in m, angles in rad, poses as 16 numbers column by column.
pub fn scene(robot: &Robot, reading: Reading) -> Value {
    let placed = PlacedRobot::new(robot, reading);
    let links: Vec<Value> = robot
        .links
        .iter()
        .map(|link| {
            let shapes = |shapes: &[Shape]| shapes.iter().map(|it| shape(robot, it, reading)).collect::<Vec<_>>();
            json!({ "name": link.name, "visuals": shapes(&link.visuals), "collisions": shapes(&link.collisions) })
        })
        .collect();
    let joints: Vec<Value> = robot
        .joints
        .iter()
        .enumerate()
        .map(|(index, joint)| {
            let drive = placed.drive(index).ok();
            let range = joint.limits_in_force().range;
            json!({
                "name": joint.name,
                "kind": joint.kind.word(),
                "parent": joint.parent,
                "child": joint.child,
                "origin": columns(&placed.origin(index).pose()),
                "axis": joint.axis.into_inner().as_slice(),
                "pitch": match &joint.kind {
                    denavit_model::robot::JointKind::Screw(pitch) => Some(pitch.metres_per_radian()),
                    _ => None,
                },
                "lower": range.map(|range| range.0),
                "upper": range.map(|range| range.1),
                "driver": drive.and_then(|drive| drive.driver),
                "scale": drive.map_or(1.0, |drive| drive.scale),
                "offset": drive.map_or(0.0, |drive| drive.offset),
                "line": robot.source.line(joint.at),
            })
        })
        .collect();
    json!({ "root": robot.root, "links": links, "joints": joints })
}

fn shape(robot: &Robot, shape: &Shape, reading: Reading) -> Value {
    let geometry = match &shape.geometry {
        Geometry::Box(size) => json!({ "box": size }),
        Geometry::Cylinder { radius, length } => json!({ "cylinder": [radius, length] }),
        Geometry::Capsule { radius, length } => json!({ "capsule": [radius, length] }),
        Geometry::Sphere(radius) => json!({ "sphere": radius }),
        Geometry::Mesh { filename, scale } => json!({ "mesh": filename, "scale": scale }),
        _ => Value::Null,
    };
    json!({
        "origin": columns(&shape.origin.read(reading).pose()),
        "geometry": geometry,
        "colour": shape.elements.iter().find(|element| element.tag() == "material").and_then(|it| colour(robot, it)),
    })
}

/// Red, green, blue, opacity of a material, or of the global material with its name.
fn colour(robot: &Robot, material: &Element) -> Option<[f64; 4]> {
    let own = |element: &Element| {
        let stated = element.entries().into_iter().find(|(name, _)| name.ends_with("rgba"))?.1;
        let numbers: Vec<f64> = stated.split_whitespace().filter_map(|word| word.parse().ok()).collect();
        numbers.try_into().ok()
    };
    own(material).or_else(|| {
        let name = material.attribute("name")?;
        let named = |element: &&Element| element.tag() == "material" && element.attribute("name") == Some(name);
        robot.elements.iter().find(named).and_then(own)
    })
}

fn columns(pose: &Pose) -> Vec<f64> {
    pose.to_homogeneous().as_slice().to_vec()
}
