//! What only a tolerant reader accepts.

use crate::lint::finding::Found;
use crate::lint::{Rule, Sheet};
use crate::report::Level;
use denavit_model::{Note, Place};

pub(super) const RULE: Rule = Rule {
    code: "D007",
    name: "taken-as-meant",
    level: Level::Warning,
    summary: "The file breaks the rules of URDF, but its meaning is clear, and it was read that way",
    why: "This program reads unbound namespace prefixes, duplicate elements, an undeclared `world` link, and text \
          before the XML declaration; others stop.",
    bad: "<link name=\"base\"/>\n<link name=\"arm\"/>\n<joint name=\"j\" type=\"continuous\">\n  <axis xyz=\"0 0 1\"/>\n  <axis xyz=\"0 1 0\"/>\n  <parent link=\"base\"/>\n  <child link=\"arm\"/>\n</joint>",
    good: "<link name=\"base\"/>\n<link name=\"arm\"/>\n<joint name=\"j\" type=\"continuous\">\n  <axis xyz=\"0 0 1\"/>\n  <parent link=\"base\"/>\n  <child link=\"arm\"/>\n</joint>",
    fixable: false,
    check,
};

fn check(sheet: &Sheet) -> Vec<Found> {
    let notes = sheet.robot().map_or(&[][..], |robot| &robot.notes);
    // Other formats have rules of their own.
    let elsewhere = |place: &Place, what: &str| {
        let translation = sheet.robot().and_then(|robot| robot.source.translation.as_ref());
        translation.is_some_and(|t| t.findings.iter().any(|(_, at, said)| at == place && said == what))
    };
    let found = notes.iter().filter_map(|note| match note {
        // Commas between numbers have a rule of their own, which fixes them.
        Note::Corrected { place, what } if !what.contains("has commas") && !elsewhere(place, what) => {
            Some(Found::placed(place.clone(), what.clone()))
        }
        _ => None,
    });
    found.collect()
}
