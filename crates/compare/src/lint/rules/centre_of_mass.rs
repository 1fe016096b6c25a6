//! A centre of mass far outside the link.

use crate::lint::finding::Found;
use crate::lint::{Rule, Sheet};
use crate::report::Level;
use crate::words;
use denavit_model::Robot;
use denavit_model::nalgebra::{Point3, Vector3};
use denavit_model::robot::{Geometry, Link};

pub(super) const RULE: Rule = Rule {
    code: "D033",
    name: "centre-of-mass-outside",
    level: Level::Warning,
    summary: "A link's centre of mass is far outside the link",
    why: "The usual causes: millimetres, the assembly's frame instead of the link's, or a wrong sign.",
    bad: "<link name=\"base\"/>\n<link name=\"arm\">\n  <inertial>\n    <origin xyz=\"25 0 0\"/>\n    <mass value=\"1\"/>\n    <inertia ixx=\"1e-3\" ixy=\"0\" ixz=\"0\" iyy=\"1e-3\" iyz=\"0\" izz=\"1e-3\"/>\n  </inertial>\n  <collision>\n    <geometry>\n      <box size=\"0.1 0.1 0.1\"/>\n    </geometry>\n  </collision>\n</link>\n<joint name=\"j\" type=\"fixed\">\n  <origin xyz=\"0 0 0.5\"/>\n  <parent link=\"base\"/>\n  <child link=\"arm\"/>\n</joint>",
    good: "<link name=\"base\"/>\n<link name=\"arm\">\n  <inertial>\n    <origin xyz=\"0.025 0 0\"/>\n    <mass value=\"1\"/>\n    <inertia ixx=\"1e-3\" ixy=\"0\" ixz=\"0\" iyy=\"1e-3\" iyz=\"0\" izz=\"1e-3\"/>\n  </inertial>\n  <collision>\n    <geometry>\n      <box size=\"0.1 0.1 0.1\"/>\n    </geometry>\n  </collision>\n</link>\n<joint name=\"j\" type=\"fixed\">\n  <origin xyz=\"0 0 0.5\"/>\n  <parent link=\"base\"/>\n  <child link=\"arm\"/>\n</joint>",
    fixable: false,
    check,
};

/// This many times the link's own extent away from it.
const FAR: f64 = 2.0;

fn check(sheet: &Sheet) -> Vec<Found> {
    let Some(robot) = sheet.robot() else { return Vec::new() };
    let size = super::size(robot);
    let carried = robot.carried();
    let mut found = Vec::new();
    for (index, link) in sheet.links().iter().enumerate() {
        let Some(inertial) = link.inertial.as_ref().filter(|inertial| inertial.mass != 0.0) else { continue };
        // A link without shapes may be nothing but the place of a mass.
        if link.visuals.is_empty() && link.collisions.is_empty() {
            continue;
        }
        let centre = Point3::from(inertial.origin.xyz);
        let (low, high) = extent(robot, &carried[index], link, size);
        let outside = Vector3::from_fn(|k, _| (low[k] - centre[k]).max(centre[k] - high[k]).max(0.0)).norm();
        let allowed = FAR * (high - low).norm();
        if outside > allowed.max(LEAST) {
            let at = sheet.below(link.at, &["inertial", "origin"]);
            let what = format!(
                "the centre of mass lies {} outside the link; is it in m, and in this link's frame?",
                words::length(outside)
            );
            found.push(Found::at(at, format!("link \"{}\"", link.name), what));
        }
    }
    found
}

/// Smaller distances do not matter, m.
const LEAST: f64 = 0.02;

/// A box around the link's frame, the joints on it and its shapes, m; a mesh may reach half as far as the robot.
fn extent(robot: &Robot, carried: &[usize], link: &Link, size: f64) -> (Point3<f64>, Point3<f64>) {
    let (mut low, mut high) = (Point3::origin(), Point3::origin());
    let mut include = |point: Vector3<f64>, reach: f64| {
        for k in 0..3 {
            low[k] = f64::min(low[k], point[k] - reach);
            high[k] = f64::max(high[k], point[k] + reach);
        }
    };
    for joint in carried {
        include(Vector3::from(robot.joints[*joint].origin.xyz), 0.0);
    }
    for shape in link.visuals.iter().chain(&link.collisions) {
        let reach = match &shape.geometry {
            Geometry::Box(edges) => 0.5 * Vector3::from(*edges).norm(),
            Geometry::Cylinder { radius, length } => radius.hypot(0.5 * length),
            Geometry::Capsule { radius, length } => radius + 0.5 * length,
            Geometry::Sphere(radius) => *radius,
            _ => 0.5 * size,
        };
        include(Vector3::from(shape.origin.xyz), reach);
    }
    (low, high)
}
