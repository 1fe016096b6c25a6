//! Angles of joint origins that are a rounded multiple of π, and limits that were rounded up beyond one.

use crate::lint::finding::Found;
use crate::lint::sheet::words;
use crate::lint::{Edit, Rule, Sheet};
use crate::report::Level;
use denavit_model::robot::Joint;
use denavit_model::{JointKind, intended};
use std::f64::consts::PI;

pub(super) const RULE: Rule = Rule {
    code: "D010",
    name: "rounded-pi",
    level: Level::Warning,
    summary: "An angle of a joint origin is a multiple of π with too few digits, so axes are only nearly parallel; or \
              a limit is rounded up beyond ±π",
    why: "Axes that should be parallel or perpendicular then deviate by 1e-6 to 1e-3 rad. Denavit-Hartenberg tables \
          of such a robot have lengths of kilometres, and inverse kinematics that tests for a spherical wrist fails. \
          A limit of ±3.1416 lets the joint go to 180.0004°: beyond ±180°, where controllers refuse the value and \
          angles change their sign. Limits that were rounded down are not reported. Write all digits of the angle.",
    bad: "<link name=\"base\"/>\n<link name=\"arm\"/>\n<joint name=\"j\" type=\"continuous\">\n  <origin rpy=\"1.5708 0 -3.14\"/>\n  <axis xyz=\"0 0 1\"/>\n  <parent link=\"base\"/>\n  <child link=\"arm\"/>\n</joint>",
    good: "<link name=\"base\"/>\n<link name=\"arm\"/>\n<joint name=\"j\" type=\"continuous\">\n  <origin rpy=\"1.5707963267948966 0 -3.141592653589793\"/>\n  <axis xyz=\"0 0 1\"/>\n  <parent link=\"base\"/>\n  <child link=\"arm\"/>\n</joint>",
    fixable: true,
    check,
};

fn check(sheet: &Sheet) -> Vec<Found> {
    let mut found = Vec::new();
    for joint in sheet.joints() {
        found.extend(limits(sheet, joint));
        let at = sheet.below(joint.at, &["origin"]);
        let Some((written, start)) = sheet.written(at, "rpy") else { continue };
        let mut edits = Vec::new();
        let mut readings = Vec::new();
        let mut off: f64 = 0.0;
        for (offset, word) in words(written) {
            let Some(angle) = intended::read_as(word) else { continue };
            // A smaller deviation is π in single precision, the best that many tools can write.
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
            found.push(Found::at(at, format!("joint \"{}\"", joint.name), what).fixed_by(edits));
        }
    }
    found
}

/// Limits beyond the multiple of π that they were rounded from.
fn limits(sheet: &Sheet, joint: &Joint) -> Option<Found> {
    if joint.kind != JointKind::Revolute {
        return None;
    }
    let at = sheet.below(joint.at, &["limit"]);
    let (mut edits, mut readings) = (Vec::new(), Vec::new());
    let mut beyond: f64 = 0.0;
    for (name, outwards) in [("lower", -1.0), ("upper", 1.0)] {
        let Some((written, start)) = sheet.written(at, name) else { continue };
        let word = written.trim();
        let Some(angle) = intended::read_as(word).filter(|angle| is_half_turns(angle.angle)) else { continue };
        if angle.change * outwards < -NOTHING {
            readings.push(format!("{name} {word} is {}", angle.read_as));
            beyond = beyond.max(angle.change.abs());
            let text = format!("{}", angle.angle);
            edits.push(Edit { start, end: start + written.len(), text });
        }
    }
    let what = format!("{}: {}, {beyond:.1e} rad beyond it; write all digits", sheet.limit_word(), readings.join(", "));
    (!edits.is_empty()).then(|| Found::at(at, format!("joint \"{}\"", joint.name), what).fixed_by(edits))
}

/// π and its multiples, beyond which an angle is another one.
fn is_half_turns(angle: f64) -> bool {
    angle != 0.0 && (angle / PI).fract() == 0.0
}

/// Twelve digits, rad: smaller deviations have no effect.
const NOTHING: f64 = 1e-9;
