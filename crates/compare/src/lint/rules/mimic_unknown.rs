//! A mimic joint that follows nothing.

use crate::lint::finding::Found;
use crate::lint::{Rule, Sheet};
use crate::report::Level;
use denavit_model::problems::nearest_name;
use std::collections::HashSet;

pub(super) const RULE: Rule = Rule {
    code: "D040",
    name: "mimic-unknown",
    level: Level::Error,
    summary: "A joint mimics a joint that does not exist",
    why: "Readers stop, or keep the joint at rest. Often a prefix was added to the joint's name but not in its \
          `<mimic>`.",
    bad: "<link name=\"a\"/>\n<link name=\"b\"/>\n<joint name=\"left_finger\" type=\"continuous\">\n  <axis xyz=\"0 0 1\"/>\n  <parent link=\"a\"/>\n  <child link=\"b\"/>\n  <mimic joint=\"finger\"/>\n</joint>",
    good: "<link name=\"a\"/>\n<link name=\"b\"/>\n<joint name=\"left_finger\" type=\"continuous\">\n  <axis xyz=\"0 0 1\"/>\n  <parent link=\"a\"/>\n  <child link=\"b\"/>\n</joint>",
    fixable: false,
    check,
};

fn check(sheet: &Sheet) -> Vec<Found> {
    let Some(robot) = sheet.robot() else { return Vec::new() };
    let known: HashSet<&str> = robot.joints.iter().map(|joint| joint.name.as_str()).collect();
    let mut found = Vec::new();
    for joint in &robot.joints {
        let Some(mimic) = joint.mimic.as_ref().filter(|mimic| !known.contains(mimic.joint.as_str())) else {
            continue;
        };
        let others = robot.joints.iter().map(|other| other.name.as_str()).filter(|other| *other != joint.name);
        let ending = others.clone().find(|other| other.ends_with(&mimic.joint));
        let near = ending.or_else(|| nearest_name(&mimic.joint, others));
        let hint = near.map_or_else(String::new, |near| format!("; did you mean \"{near}\"?"));
        let at = sheet.below(joint.at, &["mimic"]);
        let what = format!("it mimics joint \"{}\", which does not exist{hint}", mimic.joint);
        found.push(Found::at(at, format!("joint \"{}\"", joint.name), what));
    }
    found
}
