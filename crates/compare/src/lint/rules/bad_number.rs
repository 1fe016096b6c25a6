//! Not a number.

use crate::lint::finding::Found;
use crate::lint::{Rule, Sheet};
use crate::report::Level;
use denavit_model::ProblemKind;

pub(super) const RULE: Rule = Rule {
    code: "D003",
    name: "bad-number",
    level: Level::Error,
    summary: "A value is not a finite number, or a vector has too many or too few numbers",
    why: "Readers differ: some stop, some use 0, some read the first three of four numbers. Expressions such as \
          `${pi/2}` are unexpanded xacro.",
    bad: "<link name=\"base\"/>\n<link name=\"arm\"/>\n<joint name=\"j\" type=\"fixed\">\n  <origin xyz=\"0 0 0\" rpy=\"0 0 ${pi/2}\"/>\n  <parent link=\"base\"/>\n  <child link=\"arm\"/>\n</joint>",
    good: "<link name=\"base\"/>\n<link name=\"arm\"/>\n<joint name=\"j\" type=\"fixed\">\n  <origin xyz=\"0 0 0\" rpy=\"0 0 1.5707963267948966\"/>\n  <parent link=\"base\"/>\n  <child link=\"arm\"/>\n</joint>",
    fixable: false,
    check,
};

fn check(sheet: &Sheet) -> Vec<Found> {
    super::problems(sheet, |kind| matches!(kind, ProblemKind::BadNumber { .. } | ProblemKind::WrongCount { .. }))
}
