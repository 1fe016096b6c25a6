//! A revolute or prismatic joint without limits.

use crate::lint::finding::Found;
use crate::lint::{Rule, Sheet};
use crate::report::Level;
use denavit_model::JointKind;
use denavit_model::formats::Format;

pub(super) const RULE: Rule = Rule {
    code: "D020",
    name: "limits-missing",
    level: Level::Error,
    summary: "A revolute or prismatic joint states no position limits",
    why: "URDF requires `<limit>` there. Readers refuse the file, or set both limits to 0, so that the joint cannot \
          move. A joint without limits is `continuous`.",
    bad: "<link name=\"base\"/>\n<link name=\"arm\"/>\n<joint name=\"j\" type=\"revolute\">\n  <axis xyz=\"0 0 1\"/>\n  <parent link=\"base\"/>\n  <child link=\"arm\"/>\n</joint>",
    good: "<link name=\"base\"/>\n<link name=\"arm\"/>\n<joint name=\"j\" type=\"revolute\">\n  <axis xyz=\"0 0 1\"/>\n  <limit lower=\"-1\" upper=\"1\" effort=\"10\" velocity=\"1\"/>\n  <parent link=\"base\"/>\n  <child link=\"arm\"/>\n</joint>",
    fixable: false,
    check,
};

fn check(sheet: &Sheet) -> Vec<Found> {
    let mut found = Vec::new();
    for joint in sheet.joints() {
        let limited = matches!(joint.kind, JointKind::Revolute | JointKind::Prismatic);
        if !limited || joint.limits.range.is_some() {
            continue;
        }
        let at = sheet.below(joint.at, &["limit"]);
        // Limits that are written as infinite say what they mean.
        if at != joint.at && (sheet.written(at, "lower").is_some() || sheet.written(at, "upper").is_some()) {
            continue;
        }
        let hint = if joint.kind == JointKind::Revolute { ", or type=\"continuous\"" } else { "" };
        let fix = match sheet.format() {
            Format::Mjcf => "range=\"LOWER UPPER\"",
            Format::Sdf => "<limit> with <lower> and <upper>",
            _ => "<limit lower=… upper=…>",
        };
        let what = format!("a {} joint without position limits; write {fix}{hint}", joint.kind.word());
        found.push(Found::at(at, format!("joint \"{}\"", joint.name), what));
    }
    found
}
