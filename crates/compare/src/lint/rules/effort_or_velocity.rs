//! A limit without effort or velocity.

use crate::lint::finding::Found;
use crate::lint::{Rule, Sheet};
use crate::report::Level;
use denavit_model::JointKind;
use denavit_model::formats::Format;

pub(super) const RULE: Rule = Rule {
    code: "D024",
    name: "speed-or-effort",
    level: Level::Note,
    summary: "A joint's `<limit>` has no effort or velocity, or one of them is 0",
    why: "URDF requires both. Readers use 0, and then a planner cannot move the joint.",
    bad: "<link name=\"base\"/>\n<link name=\"arm\"/>\n<joint name=\"j\" type=\"revolute\">\n  <axis xyz=\"0 0 1\"/>\n  <limit lower=\"-1\" upper=\"1\" velocity=\"0\"/>\n  <parent link=\"base\"/>\n  <child link=\"arm\"/>\n</joint>",
    good: "<link name=\"base\"/>\n<link name=\"arm\"/>\n<joint name=\"j\" type=\"revolute\">\n  <axis xyz=\"0 0 1\"/>\n  <limit lower=\"-1\" upper=\"1\" effort=\"10\" velocity=\"1\"/>\n  <parent link=\"base\"/>\n  <child link=\"arm\"/>\n</joint>",
    fixable: false,
    check,
};

fn check(sheet: &Sheet) -> Vec<Found> {
    let mut found = Vec::new();
    // MJCF limits no speed, and states forces with what drives the joint.
    if sheet.format() == Format::Mjcf {
        return found;
    }
    for joint in sheet.joints().iter().filter(|joint| matches!(joint.kind, JointKind::Revolute | JointKind::Prismatic))
    {
        let at = sheet.below(joint.at, &["limit"]);
        if at == joint.at {
            continue;
        }
        let stated = |name: &str| sheet.written(at, name).map(|(text, _)| text.trim().parse::<f64>().unwrap_or(0.0));
        let lacking: Vec<String> = ["effort", "velocity"]
            .into_iter()
            .filter_map(|name| match stated(name) {
                None => Some(format!("no {name}")),
                Some(0.0) => Some(format!("{name} is 0")),
                Some(_) => None,
            })
            .collect();
        if !lacking.is_empty() {
            let what = format!("<limit>: {}; state the joint's maximum speed and effort", lacking.join(", "));
            found.push(Found::at(at, format!("joint \"{}\"", joint.name), what));
        }
    }
    found
}
