//! `check`: a robot's file against the rules.

use super::{Found, Summary, TaskError, note, source_options};
use crate::manifest::Entry;
use denavit_compare::report::Level;
use denavit_export::urdf;
use denavit_load::{CheckOptions, Rules};

pub(super) fn run(entry: &Entry) -> Result<Found, TaskError> {
    let mut found = Found::default();
    let (file, text) = denavit_load::read_text(&entry.robot)?;
    let rules = Rules::of(&file, &CheckOptions::default())?;
    let text = denavit_load::urdf_text(&file, text, &source_options(entry), &urdf::Options::default())?.text;
    let findings = rules.check(&file, &text);
    for finding in &findings {
        let level = finding.level.word();
        let place = format!("{}:{}: {}", finding.place.file, finding.place.line, finding.place.element);
        found.notes.push(note("rule", finding.rule, level, &place, finding.message.clone()));
    }
    let worst = |level: Level| findings.iter().any(|finding| finding.level == level);
    let verdict = if worst(Level::Error) {
        "failed"
    } else if worst(Level::Warning) {
        "warned"
    } else {
        "clean"
    };
    found.summary = Summary { verdict: verdict.into(), ..Summary::default() };
    Ok(found)
}
