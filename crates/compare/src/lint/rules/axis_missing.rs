//! A joint that moves without saying about what.

use crate::lint::finding::Found;
use crate::lint::{Rule, Sheet};
use crate::report::Level;
use denavit_model::JointKind;

pub(super) const RULE: Rule = Rule {
    code: "D014",
    name: "axis-missing",
    level: Level::Warning,
    summary: "A movable joint has no `<axis>`",
    why: "The axis is then 1 0 0, which is rarely intended: most joints turn about z. Write the axis, even if it is 1 \
          0 0.",
    bad: "<link name=\"base\"/>\n<link name=\"arm\"/>\n<joint name=\"j\" type=\"continuous\">\n  <parent link=\"base\"/>\n  <child link=\"arm\"/>\n</joint>",
    good: "<link name=\"base\"/>\n<link name=\"arm\"/>\n<joint name=\"j\" type=\"continuous\">\n  <axis xyz=\"1 0 0\"/>\n  <parent link=\"base\"/>\n  <child link=\"arm\"/>\n</joint>",
    fixable: false,
    check,
};

fn check(sheet: &Sheet) -> Vec<Found> {
    let moves_along = |kind: &JointKind| kind.moves() && !matches!(kind, JointKind::Floating | JointKind::Unknown(_));
    let lacking = sheet.joints().iter().filter(|joint| moves_along(&joint.kind) && joint.axis_written.is_none());
    let what = "no <axis>, so the axis is 1 0 0; write it";
    lacking.map(|joint| Found::at(joint.at, format!("joint \"{}\"", joint.name), what)).collect()
}
