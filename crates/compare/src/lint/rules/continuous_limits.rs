//! Position limits of a joint that turns without end.

use crate::lint::finding::Found;
use crate::lint::{Rule, Sheet};
use crate::report::Level;
use denavit_model::JointKind;

pub(super) const RULE: Rule = Rule {
    code: "D025",
    name: "continuous-limits",
    level: Level::Warning,
    summary: "A continuous joint has position limits",
    why: "In URDF a continuous joint has none: most readers ignore them, some apply them. If the joint has stops, \
          make it `revolute`; if not, remove `lower` and `upper`.",
    bad: "<link name=\"base\"/>\n<link name=\"arm\"/>\n<joint name=\"j\" type=\"continuous\">\n  <axis xyz=\"0 0 1\"/>\n  <limit lower=\"-6.28\" upper=\"6.28\" effort=\"10\" velocity=\"1\"/>\n  <parent link=\"base\"/>\n  <child link=\"arm\"/>\n</joint>",
    good: "<link name=\"base\"/>\n<link name=\"arm\"/>\n<joint name=\"j\" type=\"continuous\">\n  <axis xyz=\"0 0 1\"/>\n  <limit effort=\"10\" velocity=\"1\"/>\n  <parent link=\"base\"/>\n  <child link=\"arm\"/>\n</joint>",
    fixable: false,
    check,
};

/// A range of at least this, rad, means "no limits".
const NO_STOP: f64 = 1e3;

fn check(sheet: &Sheet) -> Vec<Found> {
    let mut found = Vec::new();
    for joint in sheet.joints().iter().filter(|joint| joint.kind == JointKind::Continuous) {
        // A range of nothing is what exporters write for no range.
        let stated = joint.limits.range.filter(|(lower, upper)| lower != upper && upper - lower < 2.0 * NO_STOP);
        let Some((lower, upper)) = stated else { continue };
        let at = sheet.below(joint.at, &["limit"]);
        let what = format!(
            "it is continuous, so its limits {lower} and {upper} have no effect; make it revolute, or remove lower \
             and upper"
        );
        found.push(Found::at(at, format!("joint \"{}\"", joint.name), what));
    }
    found
}
