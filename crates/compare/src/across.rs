//! Robots in two formats: what only one format can express is not a difference between the robots; notes list it.

use crate::mechanism::Mechanism;
use denavit_model::Robot;
use denavit_model::formats::Format;
use denavit_model::robot::Geometry;

/// Removes from both what one of the two formats, or an intermediate one, cannot express; returns a line for each
/// kind and side.
pub fn level(a: (&Robot, &mut Mechanism), b: (&Robot, &mut Mechanism), through: Option<Format>) -> Vec<String> {
    let mut notes = Vec::new();
    let formats: Vec<Format> = [a.0.source.format(), b.0.source.format()].into_iter().chain(through).collect();
    let has = |format: Format| formats.contains(&format);
    for (robot, mechanism) in [a, b] {
        let own = robot.source.format();
        let Some(other) = formats.iter().find(|format| **format != own) else { continue };
        let mut taken = |count: usize, what: &str| {
            if count > 0 {
                notes.push(format!(
                    "{}: {count} {what} not compared: {} cannot express it",
                    robot.source.file,
                    other.name()
                ));
            }
        };
        taken(robot.source.kept().len(), "element(s) that only its format can express");
        taken(mechanism.elements.len(), "further element(s)");
        mechanism.elements.clear();
        let mut counts = [0; 5];
        for joint in &mut mechanism.joints {
            counts[0] += usize::from(joint.soft_limits.take().is_some());
            counts[1] += usize::from(joint.calibration.take().is_some());
            counts[2] += usize::from(joint.idle_range.take().is_some());
            if has(Format::Sdf) {
                // SDF takes a negative limit as no limit.
                joint.limits.velocity = joint.limits.velocity.filter(|velocity| *velocity >= 0.0);
                joint.limits.effort = joint.limits.effort.filter(|effort| *effort >= 0.0);
            }
            if has(Format::Mjcf) {
                counts[3] += usize::from(joint.limits.velocity.take().is_some());
                // MuJoCo has no force range of 0, and no range without room.
                joint.limits.effort = joint.limits.effort.filter(|effort| *effort > 0.0);
                if joint.kind == "revolute" && joint.limits.range.is_none_or(|(lower, upper)| lower >= upper) {
                    joint.limits.range = None;
                    "continuous".clone_into(&mut joint.kind);
                    counts[4] += 1;
                }
            }
        }
        for (count, what) in counts.into_iter().zip([
            "soft limits",
            "calibration(s)",
            "ineffective range(s)",
            "velocity limits",
            "empty range(s)",
        ]) {
            taken(count, what);
        }
        if has(Format::Mjcf) {
            let mut left_out = 0;
            for body in &mut mechanism.bodies {
                let before = body.shapes.len();
                body.shapes.retain(|shape| in_mjcf(&shape.geometry));
                left_out += before - body.shapes.len();
            }
            taken(left_out, "shape(s)");
        }
        for shape in mechanism.bodies.iter_mut().flat_map(|body| &mut body.shapes) {
            if let Geometry::Mesh { filename, .. } = &mut shape.geometry {
                // Each format finds files in its own way.
                *filename = filename.rsplit(['/', '\\']).next().unwrap_or_default().to_owned();
            }
        }
    }
    notes
}

/// Whether MuJoCo supports the shape: a mesh format that it reads, or a solid of nonzero size.
fn in_mjcf(geometry: &Geometry) -> bool {
    match geometry {
        Geometry::Mesh { filename, .. } => {
            let ending = filename.rsplit('.').next().unwrap_or_default().to_ascii_lowercase();
            ["stl", "obj", "msh"].contains(&ending.as_str())
        }
        Geometry::Box(edges) => edges.iter().all(|edge| *edge > 0.0),
        Geometry::Cylinder { radius, length } | Geometry::Capsule { radius, length } => *radius > 0.0 && *length > 0.0,
        Geometry::Sphere(radius) => *radius > 0.0,
        _ => false,
    }
}
