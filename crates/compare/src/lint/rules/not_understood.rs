//! Attributes, elements and text that the reader does not understand.

use crate::lint::finding::Found;
use crate::lint::{Rule, Sheet};
use crate::report::Level;
use denavit_model::Note;

pub(in crate::lint) const RULE: Rule = Rule {
    code: "D009",
    name: "not-understood",
    level: Level::Warning,
    summary: "An attribute, an element or text is not understood, and changes nothing",
    why: "What a program does not understand it leaves out, and the robot is another one in each program that reads the file. \
          Often a name is misspelt (`rpi`, `<orgin>`), or is in an element that does not have it. What belongs to \
          simulators, controllers and drawings is known and kept, and no finding.",
    bad: "<link name=\"base\"/>\n<link name=\"arm\"/>\n<joint name=\"j\" type=\"fixed\">\n  <origin xyz=\"0 0 1\" rpi=\"0 0 1.5707963267948966\"/>\n  <parent link=\"base\"/>\n  <child link=\"arm\"/>\n</joint>",
    good: "<link name=\"base\"/>\n<link name=\"arm\"/>\n<joint name=\"j\" type=\"fixed\">\n  <origin xyz=\"0 0 1\" rpy=\"0 0 1.5707963267948966\"/>\n  <parent link=\"base\"/>\n  <child link=\"arm\"/>\n</joint>",
    fixable: false,
    check,
};

fn check(sheet: &Sheet) -> Vec<Found> {
    let Some(robot) = sheet.robot() else { return Vec::new() };
    // Closed loops and calibration positions have rules of their own.
    let unused = robot.unused();
    let notes = robot.notes.iter().filter(|note| !unused.contains(note));
    let found = notes.filter_map(|note| match note {
        Note::NotUnderstood { place, what } => Some(Found::placed(place.clone(), what.clone())),
        _ => None,
    });
    found.collect()
}
