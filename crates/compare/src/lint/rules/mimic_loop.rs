//! Mimic joints that follow each other, or something that does not move.

use crate::lint::finding::Found;
use crate::lint::{Rule, Sheet};
use crate::report::Level;

pub(super) const RULE: Rule = Rule {
    code: "D041",
    name: "mimic-loop",
    level: Level::Error,
    summary: "A joint mimics itself, a joint that follows it in turn, or a joint that does not move",
    why: "Nothing then says where it is.",
    bad: "<link name=\"a\"/>\n<link name=\"b\"/>\n<joint name=\"finger\" type=\"continuous\">\n  <axis xyz=\"0 0 1\"/>\n  <parent link=\"a\"/>\n  <child link=\"b\"/>\n  <mimic joint=\"finger\"/>\n</joint>",
    good: "<link name=\"a\"/>\n<link name=\"b\"/>\n<joint name=\"finger\" type=\"continuous\">\n  <axis xyz=\"0 0 1\"/>\n  <parent link=\"a\"/>\n  <child link=\"b\"/>\n</joint>",
    fixable: false,
    check,
};

fn check(sheet: &Sheet) -> Vec<Found> {
    let Some(robot) = sheet.robot() else { return Vec::new() };
    let mut found = Vec::new();
    for (index, joint) in robot.joints.iter().enumerate().filter(|(_, joint)| joint.kind.moves()) {
        let driver = |joint: usize| robot.joint_index(&robot.joints[joint].mimic.as_ref()?.joint);
        let mut at = driver(index);
        let mut steps = 0;
        while let Some(next) = at.and_then(driver) {
            at = Some(next);
            steps += 1;
            if steps > robot.joints.len() {
                break;
            }
        }
        let Some(mimic) = &joint.mimic else { continue };
        let still = at.is_some_and(|at| !robot.joints[at].kind.moves());
        if steps > robot.joints.len() || still {
            let why = if still { "which never moves" } else { "which leads back to it" };
            let what = format!("it mimics joint \"{}\", {why}; free one of them", mimic.joint);
            found.push(Found::at(sheet.below(joint.at, &["mimic"]), format!("joint \"{}\"", joint.name), what));
        }
    }
    found
}
