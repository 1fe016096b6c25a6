//! A mass that is not positive.

use crate::lint::finding::Found;
use crate::lint::{Rule, Sheet};
use crate::report::Level;

pub(super) const RULE: Rule = Rule {
    code: "D030",
    name: "mass-not-positive",
    level: Level::Error,
    summary: "A link's mass is zero or negative",
    why: "Simulators divide by it. A link without mass has no `<inertial>`, and is then merged into its parent or \
          omitted from the dynamics.",
    bad: "<link name=\"base\">\n  <inertial>\n    <mass value=\"0\"/>\n    <inertia ixx=\"1e-3\" ixy=\"0\" ixz=\"0\" iyy=\"1e-3\" iyz=\"0\" izz=\"1e-3\"/>\n  </inertial>\n</link>",
    good: "<link name=\"base\"/>",
    fixable: false,
    check,
};

fn check(sheet: &Sheet) -> Vec<Found> {
    let mut found = Vec::new();
    for link in sheet.links() {
        let Some(inertial) = link.inertial.as_ref().filter(|inertial| inertial.mass <= 0.0) else { continue };
        let at = sheet.below(link.at, &["inertial", "mass"]);
        let what = if inertial.mass < 0.0 {
            format!("mass {} kg is negative; give the mass of the link", inertial.mass)
        } else {
            "mass 0 kg; give the mass of the link, or remove <inertial>".to_owned()
        };
        found.push(Found::at(at, format!("link \"{}\"", link.name), what));
    }
    found
}
