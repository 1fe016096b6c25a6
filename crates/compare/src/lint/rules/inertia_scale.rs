//! A tensor that belongs to a body of quite another size.

use crate::lint::finding::Found;
use crate::lint::{Rule, Sheet};
use crate::report::Level;
use crate::words;

pub(super) const RULE: Rule = Rule {
    code: "D032",
    name: "inertia-scale",
    level: Level::Warning,
    summary: "An inertia tensor belongs to a body larger than the whole robot",
    why: "The radius of gyration √(I/m) of a link is smaller than the link. Usual causes: `ixx=\"1\"` left by a template, \
          and tensors in kg·mm² or g·mm².",
    bad: "<link name=\"base\">\n  <inertial>\n    <mass value=\"0.1\"/>\n    <inertia ixx=\"10\" ixy=\"0\" ixz=\"0\" iyy=\"10\" iyz=\"0\" izz=\"10\"/>\n  </inertial>\n</link>",
    good: "<link name=\"base\">\n  <inertial>\n    <mass value=\"0.1\"/>\n    <inertia ixx=\"1e-4\" ixy=\"0\" ixz=\"0\" iyy=\"1e-4\" iyz=\"0\" izz=\"1e-4\"/>\n  </inertial>\n</link>",
    fixable: false,
    check,
};

fn check(sheet: &Sheet) -> Vec<Found> {
    let Some(robot) = sheet.robot() else { return Vec::new() };
    let size = super::size(robot);
    let mut found = Vec::new();
    for link in sheet.links() {
        let Some(inertial) = link.inertial.as_ref().filter(|inertial| inertial.mass > 0.0) else { continue };
        let radius = (inertial.tensor.diagonal().max() / inertial.mass).sqrt();
        if radius > size {
            let at = sheet.below(link.at, &["inertial", "inertia"]);
            let what = format!(
                "its radius of gyration is {}, but the robot's size is {}; are the units kg·m²?",
                words::length(radius),
                words::length(size)
            );
            found.push(Found::at(at, format!("link \"{}\"", link.name), what));
        }
    }
    found
}
