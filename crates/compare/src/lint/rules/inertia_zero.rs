//! A mass without an inertia tensor.

use crate::lint::finding::Found;
use crate::lint::{Rule, Sheet};
use crate::report::Level;

pub(super) const RULE: Rule = Rule {
    code: "D035",
    name: "inertia-zero",
    level: Level::Warning,
    summary: "A link has a mass, but its inertia tensor is zero",
    why: "Vendors often publish only masses and centres of mass. That suffices for statics, such as gravity loads, \
          but not for simulators, which stop or become unstable. Give the tensor, or allow this rule if nothing \
          simulates the robot.",
    bad: "<link name=\"base\">\n  <inertial>\n    <mass value=\"1\"/>\n    <inertia ixx=\"0\" ixy=\"0\" ixz=\"0\" iyy=\"0\" iyz=\"0\" izz=\"0\"/>\n  </inertial>\n</link>",
    good: "<link name=\"base\">\n  <inertial>\n    <mass value=\"1\"/>\n    <inertia ixx=\"1\" ixy=\"0\" ixz=\"0\" iyy=\"1\" iyz=\"0\" izz=\"1.5\"/>\n  </inertial>\n</link>",
    fixable: false,
    check,
};

fn check(sheet: &Sheet) -> Vec<Found> {
    let massive = sheet.links().iter().filter(|link| {
        link.inertial.as_ref().is_some_and(|inertial| inertial.mass > 0.0 && inertial.tensor.iter().all(|x| *x == 0.0))
    });
    let found = massive.map(|link| {
        let at = sheet.below(link.at, &["inertial", "inertia"]);
        let what = "the inertia tensor is zero; give it, or remove <inertial>";
        Found::at(at, format!("link \"{}\"", link.name), what)
    });
    found.collect()
}
