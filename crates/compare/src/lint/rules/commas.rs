//! Commas between the numbers of a vector.

use crate::lint::finding::Found;
use crate::lint::{Edit, Rule, Sheet};
use crate::report::Level;

pub(super) const RULE: Rule = Rule {
    code: "D008",
    name: "commas",
    level: Level::Warning,
    summary: "Numbers are separated by commas",
    why: "URDF separates numbers by white space. Some readers stop at the comma and set the rest to 0.",
    bad: "<link name=\"base\"/>\n<link name=\"arm\"/>\n<joint name=\"j\" type=\"fixed\">\n  <origin xyz=\"0.1, 0, 0.2\"/>\n  <parent link=\"base\"/>\n  <child link=\"arm\"/>\n</joint>",
    good: "<link name=\"base\"/>\n<link name=\"arm\"/>\n<joint name=\"j\" type=\"fixed\">\n  <origin xyz=\"0.1 0 0.2\"/>\n  <parent link=\"base\"/>\n  <child link=\"arm\"/>\n</joint>",
    fixable: true,
    check,
};

/// Attributes that hold vectors.
const VECTORS: [&str; 4] = ["xyz", "rpy", "size", "scale"];

fn check(sheet: &Sheet) -> Vec<Found> {
    let mut found = Vec::new();
    for node in sheet.elements() {
        let vectors = node.attributes().filter(|attribute| VECTORS.contains(&attribute.name()));
        for attribute in vectors.filter(|attribute| attribute.value().contains(',')) {
            let range = attribute.range_value();
            let spaced: Vec<&str> =
                attribute.value().split([',', ' ', '\t', '\n', '\r']).filter(|word| !word.is_empty()).collect();
            let text = spaced.join(" ");
            let what = format!("{}=\"{}\" has commas; write \"{text}\"", attribute.name(), attribute.value());
            let edit = Edit { start: range.start, end: range.end, text };
            found.push(Found::at(node.range().start, super::owner(node), what).fixed_by(vec![edit]));
        }
    }
    found
}
