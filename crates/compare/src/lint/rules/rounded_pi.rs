//! Angles of joint origins that are a rounded multiple of π.

use crate::lint::finding::Found;
use crate::lint::sheet::words;
use crate::lint::{Edit, Rule, Sheet};
use crate::report::Level;
use denavit_model::intended;

pub(super) const RULE: Rule = Rule {
    code: "D010",
    name: "rounded-pi",
    level: Level::Warning,
    summary: "An angle of a joint origin is a multiple of π written to few digits, so axes are only nearly parallel",
    why: "Axes that are meant to be parallel or at right angles then miss that by 1e-6 to 1e-3 rad. Denavit-Hartenberg \
          tables of such a robot have numbers of kilometres, and inverse kinematics that tests for a spherical wrist \
          fails. Write the angle to all digits.",
    bad: "<link name=\"base\"/>\n<link name=\"arm\"/>\n<joint name=\"j\" type=\"continuous\">\n  <origin rpy=\"1.5708 0 -3.14\"/>\n  <axis xyz=\"0 0 1\"/>\n  <parent link=\"base\"/>\n  <child link=\"arm\"/>\n</joint>",
    good: "<link name=\"base\"/>\n<link name=\"arm\"/>\n<joint name=\"j\" type=\"continuous\">\n  <origin rpy=\"1.5707963267948966 0 -3.141592653589793\"/>\n  <axis xyz=\"0 0 1\"/>\n  <parent link=\"base\"/>\n  <child link=\"arm\"/>\n</joint>",
    fixable: true,
    check,
};

fn check(sheet: &Sheet) -> Vec<Found> {
    let mut found = Vec::new();
    for joint in sheet.joints() {
        let at = sheet.below(joint.at, &["origin"]);
        let Some((written, start)) = sheet.written(at, "rpy") else { continue };
        let mut edits = Vec::new();
        let mut readings = Vec::new();
        let mut off: f64 = 0.0;
        for (offset, word) in words(written) {
            let Some(angle) = intended::read_as(word) else { continue };
            // What is off by less than that is π to single precision: as good as it gets in many tools.
            if angle.change.abs() < NOTHING {
                continue;
            }
            readings.push(format!("{word} is {}", angle.read_as));
            off = off.max(angle.change.abs());
            let text = format!("{}", angle.angle);
            edits.push(Edit { start: start + offset, end: start + offset + word.len(), text });
        }
        if !edits.is_empty() {
            let what = format!("rpy: {}, off by {off:.1e} rad; write all digits", readings.join(", "));
            found.push(Found::at(at, format!("joint \"{}\"", joint.name), what).mended_by(edits));
        }
    }
    found
}

/// Twelve digits written, rad: below, nothing in the world shows it.
const NOTHING: f64 = 1e-9;
