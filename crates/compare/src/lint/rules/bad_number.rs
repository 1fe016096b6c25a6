//! Not a number.

use crate::lint::finding::Found;
use crate::lint::{Rule, Sheet};
use crate::report::Level;
use denavit_model::ProblemKind;

pub(super) const RULE: Rule = Rule {
    code: "D003",
    name: "bad-number",
    level: Level::Error,
    summary: "A value is no finite number, or there are too many or too few",
    why: "Readers differ: some stop, some take 0, some read the first three of four. Expressions such as `${pi/2}` are \
          xacro that was not expanded.",
    bad: "<link name=\"base\"/>\n<link name=\"arm\"/>\n<joint name=\"j\" type=\"fixed\">\n  <origin xyz=\"0 0 0\" rpy=\"0 0 ${pi/2}\"/>\n  <parent link=\"base\"/>\n  <child link=\"arm\"/>\n</joint>",
    good: "<link name=\"base\"/>\n<link name=\"arm\"/>\n<joint name=\"j\" type=\"fixed\">\n  <origin xyz=\"0 0 0\" rpy=\"0 0 1.5707963267948966\"/>\n  <parent link=\"base\"/>\n  <child link=\"arm\"/>\n</joint>",
    fixable: false,
    check,
};

fn check(sheet: &Sheet) -> Vec<Found> {
    super::problems(sheet, |kind| matches!(kind, ProblemKind::BadNumber { .. } | ProblemKind::WrongCount { .. }))
}
