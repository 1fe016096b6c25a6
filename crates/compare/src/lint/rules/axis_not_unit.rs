//! An axis that is not of length 1.

use crate::lint::finding::Found;
use crate::lint::{Rule, Sheet};
use crate::report::Level;
use denavit_model::nalgebra::Vector3;

pub(super) const RULE: Rule = Rule {
    code: "D012",
    name: "axis-not-unit",
    level: Level::Warning,
    summary: "A joint axis does not have length 1",
    why: "Readers that do not normalise it move the joint by the wrong amount: `0 0 2` moves twice as far in them.",
    bad: "<link name=\"base\"/>\n<link name=\"arm\"/>\n<joint name=\"j\" type=\"continuous\">\n  <axis xyz=\"0 0 2\"/>\n  <parent link=\"base\"/>\n  <child link=\"arm\"/>\n</joint>",
    good: "<link name=\"base\"/>\n<link name=\"arm\"/>\n<joint name=\"j\" type=\"continuous\">\n  <axis xyz=\"0 0 1\"/>\n  <parent link=\"base\"/>\n  <child link=\"arm\"/>\n</joint>",
    fixable: true,
    check,
};

/// Axes with five or more digits are within this of length 1.
const WRITTEN: f64 = 1e-5;

fn check(sheet: &Sheet) -> Vec<Found> {
    let mut found = Vec::new();
    for joint in sheet.joints().iter().filter(|joint| joint.kind.moves()) {
        let Some(axis) = joint.axis_written.map(Vector3::from) else { continue };
        let length = axis.norm();
        if length == 0.0 || (length - 1.0).abs() <= WRITTEN {
            continue;
        }
        let at = sheet.below(joint.at, &["axis"]);
        let unit: Vec<String> = (axis / length).iter().map(|x| format!("{}", x + 0.0)).collect();
        let (unit, [x, y, z]) = (unit.join(" "), [axis.x, axis.y, axis.z]);
        let what = format!("axis \"{x} {y} {z}\" has length {}; write {unit}", crate::words::digits(length));
        let edit = sheet.set_attribute(at, "xyz", unit);
        found.push(Found::at(at, format!("joint \"{}\"", joint.name), what).fixed_by(edit.into_iter().collect()));
    }
    found
}
