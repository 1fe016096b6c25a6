//! Two links, or two joints, of one name.

use crate::lint::finding::Found;
use crate::lint::{Rule, Sheet};
use crate::report::Level;
use denavit_model::ProblemKind;

pub(super) const RULE: Rule = Rule {
    code: "D004",
    name: "duplicate-name",
    level: Level::Error,
    summary: "Two links or two joints have the same name",
    why: "Joints refer to links by name, and controllers to joints. Most readers stop, some keep the last one.",
    bad: "<link name=\"base\"/>\n<link name=\"base\"/>",
    good: "<link name=\"base\"/>",
    fixable: false,
    check,
};

fn check(sheet: &Sheet) -> Vec<Found> {
    super::problems(sheet, |kind| matches!(kind, ProblemKind::DuplicateName { .. }))
}
