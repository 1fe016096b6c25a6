//! A root link with mass.

use crate::lint::finding::Found;
use crate::lint::{Rule, Sheet};
use crate::report::Level;

pub(super) const RULE: Rule = Rule {
    code: "D071",
    name: "root-inertia",
    level: Level::Note,
    summary: "The root link has an `<inertial>`",
    why: "KDL does not support a root link with mass and warns at every start. Add an empty root link, with a fixed \
          joint to this link.",
    bad: "<link name=\"base\">\n  <inertial>\n    <mass value=\"1\"/>\n    <inertia ixx=\"1e-3\" ixy=\"0\" ixz=\"0\" iyy=\"1e-3\" iyz=\"0\" izz=\"1e-3\"/>\n  </inertial>\n</link>",
    good: "<link name=\"world\"/>\n<link name=\"base\">\n  <inertial>\n    <mass value=\"1\"/>\n    <inertia ixx=\"1e-3\" ixy=\"0\" ixz=\"0\" iyy=\"1e-3\" iyz=\"0\" izz=\"1e-3\"/>\n  </inertial>\n</link>\n<joint name=\"mount\" type=\"fixed\">\n  <parent link=\"world\"/>\n  <child link=\"base\"/>\n</joint>",
    fixable: false,
    check,
};

fn check(sheet: &Sheet) -> Vec<Found> {
    let Some(robot) = sheet.robot() else { return Vec::new() };
    let root = &robot.links[robot.root];
    if root.inertial.is_none() {
        return Vec::new();
    }
    let at = sheet.below(root.at, &["inertial"]);
    let what = "the root link has mass, which KDL does not support; add an empty root link above it";
    vec![Found::at(at, format!("link \"{}\"", root.name), what)]
}
