//! Positions of reference sensors.

use crate::lint::finding::Found;
use crate::lint::{Rule, Sheet};
use crate::report::Level;

pub(super) const RULE: Rule = Rule {
    code: "D091",
    name: "calibration-position",
    level: Level::Note,
    summary: "A joint has a `<calibration>`, which is kept but does not move the joint's zero",
    why: "`rising`, `falling` and `reference_position` state where a reference sensor switches, for the robot's \
          homing. They do not shift the joint's zero. If the number is a zero offset in your files, put it into the \
          joint's `<origin>`.",
    bad: "<link name=\"base\"/>\n<link name=\"arm\"/>\n<joint name=\"j\" type=\"continuous\">\n  <axis xyz=\"0 0 1\"/>\n  <calibration rising=\"-0.5\"/>\n  <parent link=\"base\"/>\n  <child link=\"arm\"/>\n</joint>",
    good: "<link name=\"base\"/>\n<link name=\"arm\"/>\n<joint name=\"j\" type=\"continuous\">\n  <axis xyz=\"0 0 1\"/>\n  <parent link=\"base\"/>\n  <child link=\"arm\"/>\n</joint>",
    fixable: false,
    check,
};

fn check(sheet: &Sheet) -> Vec<Found> {
    let mut found = Vec::new();
    for joint in sheet.joints() {
        let Some(stated) = joint.calibration() else { continue };
        let values =
            [("rising", stated.rising), ("falling", stated.falling), ("reference_position", stated.reference_position)];
        // Of a position of 0 nothing could be lost.
        if !values.iter().any(|(_, value)| value.is_some_and(|value| value != 0.0)) {
            continue;
        }
        let shown: Vec<String> =
            values.iter().filter_map(|(name, value)| value.map(|value| format!("{name} {value}"))).collect();
        let what = format!("<calibration>: {} is kept but does not move the joint's zero", shown.join(", "));
        let at = sheet.below(joint.at, &["calibration"]);
        found.push(Found::at(at, format!("joint \"{}\"", joint.name), what));
    }
    found
}
