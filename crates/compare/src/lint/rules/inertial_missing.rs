//! A link that moves and is seen, but weighs nothing.

use crate::lint::finding::Found;
use crate::lint::{Rule, Sheet};
use crate::report::Level;

pub(super) const RULE: Rule = Rule {
    code: "D034",
    name: "inertial-missing",
    level: Level::Note,
    summary: "A moving link has shapes but no `<inertial>`",
    why: "Simulators skip the link or give it a mass of 1 kg; gravity compensation ignores it. It does not matter for \
          kinematics alone.",
    bad: "<link name=\"base\"/>\n<link name=\"arm\">\n  <visual>\n    <geometry>\n      <sphere radius=\"0.1\"/>\n    </geometry>\n  </visual>\n</link>\n<joint name=\"j\" type=\"continuous\">\n  <axis xyz=\"0 0 1\"/>\n  <parent link=\"base\"/>\n  <child link=\"arm\"/>\n</joint>",
    good: "<link name=\"base\"/>\n<link name=\"arm\">\n  <inertial>\n    <mass value=\"1\"/>\n    <inertia ixx=\"4e-3\" ixy=\"0\" ixz=\"0\" iyy=\"4e-3\" iyz=\"0\" izz=\"4e-3\"/>\n  </inertial>\n  <visual>\n    <geometry>\n      <sphere radius=\"0.1\"/>\n    </geometry>\n  </visual>\n</link>\n<joint name=\"j\" type=\"continuous\">\n  <axis xyz=\"0 0 1\"/>\n  <parent link=\"base\"/>\n  <child link=\"arm\"/>\n</joint>",
    fixable: false,
    check,
};

fn check(sheet: &Sheet) -> Vec<Found> {
    let mut found = Vec::new();
    for joint in sheet.joints().iter().filter(|joint| joint.kind.moves()) {
        let link = &sheet.links()[joint.child];
        if link.inertial.is_none() && !(link.visuals.is_empty() && link.collisions.is_empty()) {
            let what = "it moves and has shapes but no <inertial>; give its mass, or allow this rule";
            found.push(Found::at(link.at, format!("link \"{}\"", link.name), what));
        }
    }
    found
}
