//! A lower limit above the upper.

use crate::lint::finding::Found;
use crate::lint::{Rule, Sheet};
use crate::report::Level;
use denavit_model::JointKind;

pub(super) const RULE: Rule = Rule {
    code: "D021",
    name: "limits-reversed",
    level: Level::Error,
    summary: "A lower limit is above the upper limit",
    why: "No position satisfies both. One physics engine reads `lower=\"0\" upper=\"-1\"` as \"no limits\"; others clamp \
          to either end, or refuse. A joint without limits is `continuous`; otherwise swap them.",
    bad: "<link name=\"base\"/>\n<link name=\"arm\"/>\n<joint name=\"j\" type=\"revolute\">\n  <axis xyz=\"0 0 1\"/>\n  <limit lower=\"1\" upper=\"-1\" effort=\"10\" velocity=\"1\"/>\n  <parent link=\"base\"/>\n  <child link=\"arm\"/>\n</joint>",
    good: "<link name=\"base\"/>\n<link name=\"arm\"/>\n<joint name=\"j\" type=\"revolute\">\n  <axis xyz=\"0 0 1\"/>\n  <limit lower=\"-1\" upper=\"1\" effort=\"10\" velocity=\"1\"/>\n  <parent link=\"base\"/>\n  <child link=\"arm\"/>\n</joint>",
    fixable: false,
    check,
};

fn check(sheet: &Sheet) -> Vec<Found> {
    let mut found = Vec::new();
    for joint in sheet.joints().iter().filter(|joint| !matches!(joint.kind, JointKind::Fixed | JointKind::Continuous)) {
        let Some((lower, upper)) = joint.limits.range.filter(|(lower, upper)| lower > upper) else { continue };
        let at = sheet.below(joint.at, &["limit"]);
        let what = format!("lower {lower} is above upper {upper}; swap them");
        found.push(Found::at(at, format!("joint \"{}\"", joint.name), what));
    }
    found
}
