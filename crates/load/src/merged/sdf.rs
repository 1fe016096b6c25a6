//! Edits in an SDF: limits, damping and friction of joints, what links weigh.

use super::{Edits, Merged, along_link, child, joint, link, named, parsed, words};
use denavit_model::Robot;

pub(super) fn merged(text: &str, before: &Robot, after: &Robot) -> Option<Merged> {
    let document = parsed(text)?;
    let mut edits = Edits::of(text);
    for is in &after.joints {
        let Some(was) = joint(before, &is.name) else { continue };
        let Some(axis) = named(&document, "joint", &is.name).and_then(|node| child(node, "axis")) else { continue };
        let values = |joint: &denavit_model::Joint| {
            let (limits, dynamics) = (joint.limits, joint.dynamics());
            [
                (["limit", "lower"], limits.range.map(|range| range.0)),
                (["limit", "upper"], limits.range.map(|range| range.1)),
                (["limit", "effort"], limits.effort),
                (["limit", "velocity"], limits.velocity),
                (["dynamics", "damping"], Some(dynamics.damping)),
                (["dynamics", "friction"], Some(dynamics.friction)),
            ]
        };
        for ((path, had), (_, has)) in values(was).into_iter().zip(values(is)) {
            if let (true, Some(value)) = (had != has, has) {
                edits.set_text(axis, &path, &value.to_string());
            }
        }
    }
    for is in &after.links {
        let Some(was) = link(before, &is.name) else { continue };
        let node = named(&document, "link", &is.name).and_then(|node| child(node, "inertial"));
        if let (true, Some(inertial), Some(node)) = (was.inertial != is.inertial, &is.inertial, node) {
            let (mass, centre, tensor) = along_link(inertial);
            edits.set(node, "pose", format!("<pose>{} 0 0 0</pose>", words(&centre)));
            edits.set(node, "mass", format!("<mass>{mass}</mass>"));
            let tags = ["ixx", "iyy", "izz", "ixy", "ixz", "iyz"];
            let entries = tags
                .iter()
                .zip(tensor)
                .map(|(tag, value)| format!("<{tag}>{value}</{tag}>"))
                .collect::<Vec<_>>()
                .concat();
            edits.set(node, "inertia", format!("<inertia>{entries}</inertia>"));
        }
    }
    let (text, changes) = edits.finished()?;
    Some(Merged { text, changes, lost: Vec::new() })
}
