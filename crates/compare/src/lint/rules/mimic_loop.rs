//! Mimic joints that follow each other, or something that does not move.

use crate::lint::finding::Found;
use crate::lint::{Rule, Sheet};
use crate::report::Level;
use denavit_model::placed::Follows;
use denavit_model::{PlacedRobot, Reading};

pub(super) const RULE: Rule = Rule {
    code: "D041",
    name: "mimic-loop",
    level: Level::Error,
    summary: "A joint mimics itself, a joint that mimics it, or a joint that does not move",
    why: "Its position is then undefined.",
    bad: "<link name=\"a\"/>\n<link name=\"b\"/>\n<joint name=\"finger\" type=\"continuous\">\n  <axis xyz=\"0 0 1\"/>\n  <parent link=\"a\"/>\n  <child link=\"b\"/>\n  <mimic joint=\"finger\"/>\n</joint>",
    good: "<link name=\"a\"/>\n<link name=\"b\"/>\n<joint name=\"finger\" type=\"continuous\">\n  <axis xyz=\"0 0 1\"/>\n  <parent link=\"a\"/>\n  <child link=\"b\"/>\n</joint>",
    fixable: false,
    check,
};

fn check(sheet: &Sheet) -> Vec<Found> {
    let Some(robot) = sheet.robot().filter(|robot| robot.joints.iter().any(|joint| joint.mimic.is_some())) else {
        return Vec::new();
    };
    let placed = PlacedRobot::new(robot, Reading::AsWritten);
    let mut found = Vec::new();
    for (index, joint) in robot.joints.iter().enumerate().filter(|(_, joint)| joint.kind.moves()) {
        let Some(mimic) = &joint.mimic else { continue };
        let why = match placed.follows(index) {
            Follows::Nothing if mimic.multiplier != 0.0 => "which never moves",
            Follows::Itself => "which leads back to it",
            _ => continue,
        };
        let what = format!("it mimics joint \"{}\", {why}; remove one <mimic>", mimic.joint);
        found.push(Found::at(sheet.below(joint.at, &["mimic"]), format!("joint \"{}\"", joint.name), what));
    }
    found
}
