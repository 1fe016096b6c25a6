//! A link and a joint of one name.

use crate::lint::finding::Found;
use crate::lint::{Rule, Sheet};
use crate::report::Level;
use std::collections::HashSet;

pub(super) const RULE: Rule = Rule {
    code: "D060",
    name: "shared-name",
    level: Level::Note,
    summary: "A link has the same name as a joint",
    why: "URDF allows this. Converters to formats with one name space for both (SDF, MJCF) rename one of them or stop.",
    bad: "<link name=\"base\"/>\n<link name=\"wrist\"/>\n<joint name=\"wrist\" type=\"fixed\">\n  <parent link=\"base\"/>\n  <child link=\"wrist\"/>\n</joint>",
    good: "<link name=\"base\"/>\n<link name=\"wrist\"/>\n<joint name=\"wrist_joint\" type=\"fixed\">\n  <parent link=\"base\"/>\n  <child link=\"wrist\"/>\n</joint>",
    fixable: false,
    check,
};

fn check(sheet: &Sheet) -> Vec<Found> {
    let links: HashSet<&str> = sheet.links().iter().map(|link| link.name.as_str()).collect();
    let shared = sheet.joints().iter().filter(|joint| links.contains(joint.name.as_str()));
    let what = "a link has the same name; rename one of the two";
    shared.map(|joint| Found::at(joint.at, format!("joint \"{}\"", joint.name), what)).collect()
}
