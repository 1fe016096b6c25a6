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
    summary: "Two frames that carry nothing are at the same place of the same link",
    why: "Two names for one frame invite one of them to be moved and the other forgotten. If both names are needed, \
          fix the second to the first: then there is one place to edit.",
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
        // A frame that is fixed to another by nothing says that it is the same.
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
                    "this frame is where frame \"{other}\" is; fix it to \"{other}\" without an origin, or remove one of the two"
                );
                found.push(Found::at(joint.at, format!("link \"{}\"", own.name), what));
            }
        }
    }
    found
}
