//! An axis of length zero on a joint that moves.

use crate::lint::finding::Found;
use crate::lint::{Rule, Sheet};
use crate::report::Level;
use denavit_model::ProblemKind;

pub(super) const RULE: Rule = Rule {
    code: "D013",
    name: "zero-axis",
    level: Level::Error,
    summary: "A movable joint has an axis of length zero",
    why: "It has no direction of motion; readers divide by zero or silently use another axis.",
    bad: "<link name=\"base\"/>\n<link name=\"arm\"/>\n<joint name=\"j\" type=\"continuous\">\n  <axis xyz=\"0 0 0\"/>\n  <parent link=\"base\"/>\n  <child link=\"arm\"/>\n</joint>",
    good: "<link name=\"base\"/>\n<link name=\"arm\"/>\n<joint name=\"j\" type=\"continuous\">\n  <axis xyz=\"0 0 1\"/>\n  <parent link=\"base\"/>\n  <child link=\"arm\"/>\n</joint>",
    fixable: false,
    check,
};

fn check(sheet: &Sheet) -> Vec<Found> {
    super::problems(sheet, |kind| matches!(kind, ProblemKind::ZeroAxis(_)))
}
