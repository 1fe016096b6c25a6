//! A joint whose zero it cannot reach.

use crate::lint::finding::Found;
use crate::lint::{Rule, Sheet};
use crate::report::Level;
use denavit_model::JointKind;

pub(super) const RULE: Rule = Rule {
    code: "D023",
    name: "zero-outside-limits",
    level: Level::Warning,
    summary: "Joint value 0 is outside the joint's limits",
    why: "Simulators and viewers start every joint at 0: this joint starts at an impossible position, jumps, or \
          raises an error. If it is intended (a knee that cannot be straight), set the start position elsewhere and \
          allow this rule.",
    bad: "<link name=\"base\"/>\n<link name=\"arm\"/>\n<joint name=\"j\" type=\"revolute\">\n  <axis xyz=\"0 0 1\"/>\n  <limit lower=\"0.5\" upper=\"2\" effort=\"10\" velocity=\"1\"/>\n  <parent link=\"base\"/>\n  <child link=\"arm\"/>\n</joint>",
    good: "<link name=\"base\"/>\n<link name=\"arm\"/>\n<joint name=\"j\" type=\"revolute\">\n  <axis xyz=\"0 0 1\"/>\n  <limit lower=\"-0.5\" upper=\"2\" effort=\"10\" velocity=\"1\"/>\n  <parent link=\"base\"/>\n  <child link=\"arm\"/>\n</joint>",
    fixable: false,
    check,
};

fn check(sheet: &Sheet) -> Vec<Found> {
    let mut found = Vec::new();
    for joint in sheet.joints().iter().filter(|joint| matches!(joint.kind, JointKind::Revolute | JointKind::Prismatic))
    {
        let Some((lower, upper)) = joint.limits.range else { continue };
        let outside = lower < upper && (lower > 0.0 || upper < 0.0);
        if outside && joint.mimic.is_none() {
            let at = sheet.below(joint.at, &["limit"]);
            let what = format!("0 is outside {lower} … {upper}; set another start position");
            found.push(Found::at(at, format!("joint \"{}\"", joint.name), what));
        }
    }
    found
}
