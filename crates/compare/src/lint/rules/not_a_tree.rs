//! Links that cannot be reached, or that are reached twice.

use crate::lint::finding::Found;
use crate::lint::{Rule, Sheet};
use crate::report::Level;
use denavit_model::ProblemKind;

pub(super) const RULE: Rule = Rule {
    code: "D006",
    name: "not-a-tree",
    level: Level::Error,
    summary: "Links are unreachable from the root, are carried by two joints, or close a loop",
    why: "A URDF is a tree with one root. A second root is a part that is not attached; cut a loop at one joint and \
          close it outside the URDF.",
    bad: "<link name=\"base\"/>\n<link name=\"arm\"/>\n<link name=\"lost\"/>\n<joint name=\"j\" type=\"fixed\">\n  <parent link=\"base\"/>\n  <child link=\"arm\"/>\n</joint>",
    good: "<link name=\"base\"/>\n<link name=\"arm\"/>\n<joint name=\"j\" type=\"fixed\">\n  <parent link=\"base\"/>\n  <child link=\"arm\"/>\n</joint>",
    fixable: false,
    check,
};

fn check(sheet: &Sheet) -> Vec<Found> {
    let tree = |kind: &ProblemKind| {
        matches!(kind, ProblemKind::TwoParents { .. } | ProblemKind::Cycle { .. } | ProblemKind::SeveralRoots { .. })
    };
    super::problems(sheet, tree)
}
