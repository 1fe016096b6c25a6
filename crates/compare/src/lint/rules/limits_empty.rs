//! Limits between which there is nothing.

use crate::lint::finding::Found;
use crate::lint::{Rule, Sheet};
use crate::report::Level;
use denavit_model::JointKind;

pub(super) const RULE: Rule = Rule {
    code: "D022",
    name: "limits-equal",
    level: Level::Warning,
    summary: "A joint's lower and upper limit are the same",
    why: "It cannot move. Usually an exporter left the limits at 0 and 0; a joint that must not move is `fixed`.",
    bad: "<link name=\"base\"/>\n<link name=\"arm\"/>\n<joint name=\"j\" type=\"revolute\">\n  <axis xyz=\"0 0 1\"/>\n  <limit lower=\"0\" upper=\"0\" effort=\"10\" velocity=\"1\"/>\n  <parent link=\"base\"/>\n  <child link=\"arm\"/>\n</joint>",
    good: "<link name=\"base\"/>\n<link name=\"arm\"/>\n<joint name=\"j\" type=\"revolute\">\n  <axis xyz=\"0 0 1\"/>\n  <limit lower=\"-1\" upper=\"1\" effort=\"10\" velocity=\"1\"/>\n  <parent link=\"base\"/>\n  <child link=\"arm\"/>\n</joint>",
    fixable: false,
    check,
};

fn check(sheet: &Sheet) -> Vec<Found> {
    let mut found = Vec::new();
    for joint in sheet.joints().iter().filter(|joint| matches!(joint.kind, JointKind::Revolute | JointKind::Prismatic))
    {
        let Some((lower, _)) = joint.limits.range.filter(|(lower, upper)| lower == upper) else { continue };
        let at = sheet.below(joint.at, &["limit"]);
        let what = format!("both limits are {lower}, so it cannot move; give its range, or type=\"fixed\"");
        found.push(Found::at(at, format!("joint \"{}\"", joint.name), what));
    }
    found
}
