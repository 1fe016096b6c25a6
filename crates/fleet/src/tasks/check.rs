//! `check`: a robot's file against the rules.

use super::{Found, Summary, TaskError, note, source_options};
use crate::manifest::Entry;
use denavit_compare::report::Level;
use denavit_load::{CheckOptions, Rules};

pub(super) fn run(entry: &Entry) -> Result<Found, TaskError> {
    let mut found = Found::default();
    let (file, mut text) = denavit_load::read_text(&entry.robot)?;
    let rules = Rules::of(&file, &CheckOptions::default())?;
    let named = |end: &str| file.to_ascii_lowercase().ends_with(end);
    if named(".xacro") {
        text = denavit_load::expanded(&file, &text, &source_options(entry))?.urdf;
    } else if !named(".urdf") && !text.trim_start_matches('\u{feff}').trim_start().starts_with('<') {
        let robot = denavit_load::from_text(&file, &text, &source_options(entry))?.robot;
        text = denavit_load::canonical(&robot, &file, &denavit_export::urdf::Options::default())?.value;
    }
    let findings = rules.check(&file, &text);
    for finding in &findings {
        let level = match finding.level {
            Level::Error => "error",
            Level::Warning => "warning",
            Level::Note => "note",
        };
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
