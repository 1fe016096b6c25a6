//! Neighbouring axes that are nearly, but not quite, parallel.

use crate::lint::finding::Found;
use crate::lint::{Rule, Sheet};
use crate::mechanism::Mechanism;
use crate::report::Level;
use denavit_model::se3::angle_between;
use denavit_model::tree::Reading;
use std::collections::HashMap;

pub(super) const RULE: Rule = Rule {
    code: "D011",
    name: "nearly-parallel",
    level: Level::Warning,
    summary: "Two neighbouring axes are between 1e-9 and 1e-3 rad from parallel, and no rounded π explains this",
    why: "Either they should be parallel, and an axis or angle has too few digits; or the robot is calibrated, and \
          its Denavit-Hartenberg table needs the Hayati form for this pair.",
    bad: "<link name=\"a\"/>\n<link name=\"b\"/>\n<link name=\"c\"/>\n<joint name=\"j\" type=\"continuous\">\n  <axis xyz=\"0 0 1\"/>\n  <parent link=\"a\"/>\n  <child link=\"b\"/>\n</joint>\n<joint name=\"k\" type=\"continuous\">\n  <origin xyz=\"1 0 0\" rpy=\"0.00001 0 0\"/>\n  <axis xyz=\"0 0 1\"/>\n  <parent link=\"b\"/>\n  <child link=\"c\"/>\n</joint>",
    good: "<link name=\"a\"/>\n<link name=\"b\"/>\n<link name=\"c\"/>\n<joint name=\"j\" type=\"continuous\">\n  <axis xyz=\"0 0 1\"/>\n  <parent link=\"a\"/>\n  <child link=\"b\"/>\n</joint>\n<joint name=\"k\" type=\"continuous\">\n  <origin xyz=\"1 0 0\"/>\n  <axis xyz=\"0 0 1\"/>\n  <parent link=\"b\"/>\n  <child link=\"c\"/>\n</joint>",
    fixable: false,
    check,
};

/// Below, rounding of twelve written digits; above, meant as an angle, rad.
const NEARLY: std::ops::Range<f64> = 1e-9..1e-3;

fn check(sheet: &Sheet) -> Vec<Found> {
    let Some(robot) = sheet.robot() else { return Vec::new() };
    let mechanism = Mechanism::of_robot(robot, Reading::Intended);
    let places: HashMap<&str, usize> = robot.joints.iter().map(|joint| (joint.name.as_str(), joint.at)).collect();
    let mut found = Vec::new();
    for joint in &mechanism.joints {
        let Some(parent) = joint.parent.map(|parent| &mechanism.joints[parent]) else { continue };
        let (Some(screw), Some(before)) = (&joint.screw, &parent.screw) else { continue };
        let (u, w) = (before.direction(), screw.direction());
        let angle = angle_between(&u, &w).min(angle_between(&-u.into_inner(), &w));
        if let (true, Some(at)) = (NEARLY.contains(&angle), places.get(joint.name.as_str())) {
            let what = format!(
                "its axis is {angle:.1e} rad from parallel to that of joint \"{}\"; write more digits, or the exact \
                 direction",
                parent.name
            );
            found.push(Found::at(*at, format!("joint \"{}\"", joint.name), what));
        }
    }
    found
}
