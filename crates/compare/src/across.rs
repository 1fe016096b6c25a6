//! Robots of two formats: what only one of the formats can say is no difference between the robots, and is said.

use crate::mechanism::Mechanism;
use denavit_model::Robot;
use denavit_model::formats::Format;
use denavit_model::robot::Geometry;

/// Takes out of both what one of the two formats has no word for; what was taken, a line for each kind and side.
pub fn level(a: (&Robot, &mut Mechanism), b: (&Robot, &mut Mechanism)) -> Vec<String> {
    let (formats, mut notes) = ((a.0.source.format(), b.0.source.format()), Vec::new());
    if formats.0 == formats.1 {
        return notes;
    }
    for ((robot, mechanism), other) in [(a, formats.1), (b, formats.0)] {
        let mut taken = |count: usize, what: &str| {
            if count > 0 {
                notes.push(format!("{}: {count} {what}, for which {} has no word", robot.source.file, other.name()));
            }
        };
        taken(robot.source.kept().len(), "thing(s) that only its format says");
        taken(mechanism.elements.len(), "further element(s)");
        mechanism.elements.clear();
        let mut counts = [0; 4];
        for joint in &mut mechanism.joints {
            counts[0] += usize::from(joint.soft_limits.take().is_some());
            counts[1] += usize::from(joint.calibration.take().is_some());
            counts[2] += usize::from(joint.idle_range.take().is_some());
            if formats.0 == Format::Mjcf || formats.1 == Format::Mjcf {
                counts[3] += usize::from(joint.limits.velocity.take().is_some());
                // MuJoCo has no force range of 0.
                joint.limits.effort = joint.limits.effort.filter(|effort| *effort > 0.0);
            }
        }
        for (count, what) in
            counts.into_iter().zip(["soft limits", "calibration(s)", "range(s) without effect", "velocity limits"])
        {
            taken(count, what);
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
