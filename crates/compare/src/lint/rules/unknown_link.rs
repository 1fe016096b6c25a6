//! A joint between links that are not there.

use crate::lint::finding::Found;
use crate::lint::{Rule, Sheet};
use crate::report::Level;
use denavit_model::ProblemKind;

pub(super) const RULE: Rule = Rule {
    code: "D005",
    name: "unknown-link",
    level: Level::Error,
    summary: "A joint names a parent or child link that does not exist",
    why: "Usually a typing error or a prefix that was not passed on.",
    bad: "<link name=\"base\"/>\n<link name=\"arm\"/>\n<joint name=\"j\" type=\"fixed\">\n  <parent link=\"bsae\"/>\n  <child link=\"arm\"/>\n</joint>",
    good: "<link name=\"base\"/>\n<link name=\"arm\"/>\n<joint name=\"j\" type=\"fixed\">\n  <parent link=\"base\"/>\n  <child link=\"arm\"/>\n</joint>",
    fixable: false,
    check,
};

fn check(sheet: &Sheet) -> Vec<Found> {
    super::problems(sheet, |kind| matches!(kind, ProblemKind::UnknownLink { .. }))
}
