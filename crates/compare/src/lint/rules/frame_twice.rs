//! Two frames without a body in one place.

use crate::lint::finding::Found;
use crate::lint::{Rule, Sheet};
use crate::report::Level;
use denavit_model::robot::Link;
use std::collections::HashSet;
use std::collections::hash_map::{Entry, HashMap};

pub(super) const RULE: Rule = Rule {
    code: "D061",
    name: "frame-twice",
    level: Level::Note,
    summary: "Two empty frames have the same pose on the same link",
    why: "If someone moves one of them, the other is easily forgotten. If both names are needed, attach the second to \
          the first: then there is one place to edit.",
    bad: "<link name=\"arm\"/>\n<link name=\"tool0\"/>\n<link name=\"tcp\"/>\n<joint name=\"a\" type=\"fixed\">\n  <origin xyz=\"0 0 0.1\"/>\n  <parent link=\"arm\"/>\n  <child link=\"tool0\"/>\n</joint>\n<joint name=\"b\" type=\"fixed\">\n  <origin xyz=\"0 0 0.1\"/>\n  <parent link=\"arm\"/>\n  <child link=\"tcp\"/>\n</joint>",
    good: "<link name=\"arm\"/>\n<link name=\"tool0\"/>\n<link name=\"tcp\"/>\n<joint name=\"a\" type=\"fixed\">\n  <origin xyz=\"0 0 0.1\"/>\n  <parent link=\"arm\"/>\n  <child link=\"tool0\"/>\n</joint>\n<joint name=\"b\" type=\"fixed\">\n  <parent link=\"tool0\"/>\n  <child link=\"tcp\"/>\n</joint>",
    fixable: false,
    check,
};

fn is_empty(link: &Link) -> bool {
    link.inertial.is_none() && link.visuals.is_empty() && link.collisions.is_empty() && link.elements.is_empty()
}

fn check(sheet: &Sheet) -> Vec<Found> {
    let Some(robot) = sheet.robot() else { return Vec::new() };
    let mut first: HashMap<(usize, [u64; 6]), usize> = HashMap::new();
    let leaves: HashSet<usize> = robot.leaves().into_iter().collect();
    let mut found = Vec::new();
    for joint in robot.joints.iter().filter(|joint| !joint.kind.moves() && leaves.contains(&joint.child)) {
        let [x, y, z] = joint.origin.xyz;
        let [roll, pitch, yaw] = joint.origin.rpy;
        // A frame fixed to another without an origin is intentionally the same.
        let origin = [x, y, z, roll, pitch, yaw];
        if origin == [0.0; 6] || !is_empty(&robot.links[joint.child]) {
            continue;
        }
        match first.entry((joint.parent, origin.map(|number| (number + 0.0).to_bits()))) {
            Entry::Vacant(free) => {
                free.insert(joint.child);
            }
            Entry::Occupied(first) => {
                let (own, other) = (&robot.links[joint.child], &robot.links[*first.get()].name);
                let what = format!(
                    "this frame has the same pose as frame \"{other}\"; attach it to \"{other}\" without an origin, \
                     or remove one of the two"
                );
                found.push(Found::at(joint.at, format!("link \"{}\"", own.name), what));
            }
        }
    }
    found
}
