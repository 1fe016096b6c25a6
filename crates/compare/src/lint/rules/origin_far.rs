//! Origins in millimetres.

use crate::lint::finding::Found;
use crate::lint::{Rule, Sheet};
use crate::report::Level;
use crate::words;
use denavit_model::nalgebra::Vector3;

pub(super) const RULE: Rule = Rule {
    code: "D016",
    name: "origin-far",
    level: Level::Warning,
    summary: "A joint's origin is farther away than any robot's size",
    why: "URDF uses metres. Lengths of hundreds are usually millimetres; larger numbers are garbage, and make every \
          pose garbage.",
    bad: "<link name=\"base\"/>\n<link name=\"arm\"/>\n<joint name=\"j\" type=\"fixed\">\n  <origin xyz=\"0 0 425\"/>\n  <parent link=\"base\"/>\n  <child link=\"arm\"/>\n</joint>",
    good: "<link name=\"base\"/>\n<link name=\"arm\"/>\n<joint name=\"j\" type=\"fixed\">\n  <origin xyz=\"0 0 0.425\"/>\n  <parent link=\"base\"/>\n  <child link=\"arm\"/>\n</joint>",
    fixable: false,
    check,
};

/// The boom of the space station's arm is 7 m long, that of a large crane 60 m; m.
const FAR: f64 = 70.0;

fn check(sheet: &Sheet) -> Vec<Found> {
    let mut found = Vec::new();
    for joint in sheet.joints() {
        // Summed up by the largest component: the squares of absurd numbers are infinite.
        let length = Vector3::from(joint.origin.xyz).amax();
        if length > FAR {
            let what = format!("its origin is {} away; is it in mm?", words::length(length));
            let at = sheet.below(joint.at, &["origin"]);
            found.push(Found::at(at, format!("joint \"{}\"", joint.name), what));
        }
    }
    found
}
