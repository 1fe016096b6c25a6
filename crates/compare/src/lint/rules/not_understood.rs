//! Attributes, elements and text that the reader does not understand.

use crate::lint::finding::Found;
use crate::lint::{Rule, Sheet};
use crate::report::Level;
use denavit_model::Note;

pub(in crate::lint) const RULE: Rule = Rule {
    code: "D009",
    name: "not-understood",
    level: Level::Warning,
    summary: "An attribute, element or text is not understood and has no effect",
    why: "A program ignores what it does not understand, so each program may read a different robot. Often a name is \
          misspelt (`rpi`, `<orgin>`), or is in the wrong element. Known elements of simulators, controllers and CAD \
          programs are kept and not reported.",
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
