//! Closed loops, which a URDF tree cannot express.

use crate::lint::finding::Found;
use crate::lint::{Rule, Sheet};
use crate::report::Level;

pub(super) const RULE: Rule = Rule {
    code: "D090",
    name: "closed-loop",
    level: Level::Note,
    summary: "The file closes a kinematic loop, which is kept but not solved",
    why: "A URDF is a tree. Each program states loops outside the tree in its own way: `<constraint>`, \
          `<loop_joint>`, a `<joint>` inside `<gazebo>`, `<equality>` inside `<mujoco>`. Here every joint of the loop \
          moves freely, so tables, forward kinematics and the reach of tips are right only for joint values that close \
          it.",
    bad: "<link name=\"base\"/>\n<link name=\"crank\"/>\n<link name=\"rocker\"/>\n<joint name=\"j1\" type=\"continuous\">\n  <axis xyz=\"0 1 0\"/>\n  <parent link=\"base\"/>\n  <child link=\"crank\"/>\n</joint>\n<joint name=\"j2\" type=\"continuous\">\n  <axis xyz=\"0 1 0\"/>\n  <parent link=\"base\"/>\n  <child link=\"rocker\"/>\n</joint>\n<loop_joint name=\"l\" type=\"revolute\">\n  <link1 link=\"crank\"/>\n  <link2 link=\"rocker\"/>\n</loop_joint>",
    good: "<link name=\"base\"/>\n<link name=\"crank\"/>\n<link name=\"rocker\"/>\n<joint name=\"j1\" type=\"continuous\">\n  <axis xyz=\"0 1 0\"/>\n  <parent link=\"base\"/>\n  <child link=\"crank\"/>\n</joint>\n<joint name=\"j2\" type=\"continuous\">\n  <axis xyz=\"0 1 0\"/>\n  <parent link=\"base\"/>\n  <child link=\"rocker\"/>\n  <mimic joint=\"j1\"/>\n</joint>",
    fixable: false,
    check,
};

fn check(sheet: &Sheet) -> Vec<Found> {
    let loops = sheet.robot().map_or_else(Vec::new, denavit_model::Robot::loops);
    let found = loops.into_iter().map(|found| {
        let ends = match &found.between[..] {
            [one, other, ..] => format!(" between \"{one}\" and \"{other}\""),
            _ => String::new(),
        };
        let what = format!("closes a loop{ends}, which is kept but not solved; give joint values that close it");
        Found::at(found.at, found.label, what)
    });
    found.collect()
}
