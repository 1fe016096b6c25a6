//! The file is not a URDF.

use crate::lint::finding::Found;
use crate::lint::{Rule, Sheet};
use crate::report::Level;
use denavit_model::ProblemKind;

pub(in crate::lint) const RULE: Rule = Rule {
    code: "D001",
    name: "unreadable",
    level: Level::Error,
    summary: "The file is not well-formed XML, or its root is not a `<robot>` with links",
    why: "Nothing reads it. The usual causes: a committed git merge conflict, xacro saved as URDF, white space or \
          text before the XML declaration, a failed expansion that left an empty robot.",
    bad: "<link name=\"base\">",
    good: "<link name=\"base\"/>",
    fixable: false,
    check,
};

fn check(sheet: &Sheet) -> Vec<Found> {
    let unreadable = |kind: &ProblemKind| {
        matches!(kind, ProblemKind::Xml(..) | ProblemKind::Empty | ProblemKind::NoRobot(_) | ProblemKind::NoLinks)
    };
    super::problems(sheet, unreadable)
}
