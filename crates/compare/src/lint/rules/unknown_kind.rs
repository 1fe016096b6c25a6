//! A joint type that URDF does not know.

use crate::lint::finding::Found;
use crate::lint::{Rule, Sheet};
use crate::report::Level;
use denavit_model::JointKind;
use denavit_model::formats::Format;

pub(super) const RULE: Rule = Rule {
    code: "D015",
    name: "unknown-kind",
    level: Level::Error,
    summary: "A joint has a type that URDF does not define",
    why: "URDF has revolute, continuous, prismatic, fixed, floating and planar. `spherical` is read by one physics engine \
          and by nothing else.",
    bad: "<link name=\"base\"/>\n<link name=\"arm\"/>\n<joint name=\"j\" type=\"spherical\">\n  <axis xyz=\"0 0 1\"/>\n  <parent link=\"base\"/>\n  <child link=\"arm\"/>\n</joint>",
    good: "<link name=\"base\"/>\n<link name=\"arm\"/>\n<joint name=\"j\" type=\"continuous\">\n  <axis xyz=\"0 0 1\"/>\n  <parent link=\"base\"/>\n  <child link=\"arm\"/>\n</joint>",
    fixable: false,
    check,
};

fn check(sheet: &Sheet) -> Vec<Found> {
    let unknown = sheet.joints().iter().filter_map(|joint| match &joint.kind {
        // Other formats have kinds of their own.
        JointKind::Unknown(word) if sheet.format() == Format::Urdf => {
            let what = format!("type \"{word}\" is not a URDF type; write revolute, continuous, prismatic, fixed, …");
            Some(Found::at(joint.at, format!("joint \"{}\"", joint.name), what))
        }
        _ => None,
    });
    unknown.collect()
}
