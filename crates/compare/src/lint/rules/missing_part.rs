//! A link or joint lacks what it cannot do without.

use crate::lint::finding::Found;
use crate::lint::{Rule, Sheet};
use crate::report::Level;
use denavit_model::ProblemKind;

pub(super) const RULE: Rule = Rule {
    code: "D002",
    name: "missing-part",
    level: Level::Error,
    summary: "A link or joint has no name, type, parent, child or thread pitch",
    why: "Without it the robot has no tree. Readers stop, some with a message that names no line.",
    bad: "<link name=\"base\"/>\n<link name=\"arm\"/>\n<joint name=\"j\" type=\"fixed\">\n  <parent link=\"base\"/>\n</joint>",
    good: "<link name=\"base\"/>\n<link name=\"arm\"/>\n<joint name=\"j\" type=\"fixed\">\n  <parent link=\"base\"/>\n  <child link=\"arm\"/>\n</joint>",
    fixable: false,
    check,
};

fn check(sheet: &Sheet) -> Vec<Found> {
    let missing = |kind: &ProblemKind| {
        matches!(
            kind,
            ProblemKind::MissingName
                | ProblemKind::MissingEnd(_)
                | ProblemKind::MissingType
                | ProblemKind::MissingThreadPitch
        )
    };
    super::problems(sheet, missing)
}
