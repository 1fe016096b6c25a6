//! A comparison or a list of findings as flat entries: what the line-oriented formats need.

use crate::comparison::{Comparison, JointValue, Verdict};
use crate::report::Report;
use crate::robots::{Member, State};
use crate::words;

/// How serious an entry is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Level {
    /// It makes the exit code 1.
    Error,
    /// Worth a look.
    Warning,
    /// For information.
    Note,
}

impl Level {
    /// `error`, `warning`, `note`.
    pub fn word(self) -> &'static str {
        match self {
            Self::Error => "error",
            Self::Warning => "warning",
            Self::Note => "note",
        }
    }
}

/// One line of a report.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Entry {
    /// A rule's number, or `diff`.
    pub code: String,
    /// How serious it is.
    pub level: Level,
    /// The file that it is about.
    pub file: String,
    /// Line, counted from 1.
    pub line: Option<usize>,
    /// `joint "elbow"`.
    pub subject: String,
    /// A sentence.
    pub message: String,
}

impl Report<'_> {
    /// Every difference or finding, the serious ones of a comparison first.
    pub fn entries(&self) -> Vec<Entry> {
        match self {
            Self::Comparison(comparison) => of_comparison(comparison),
            Self::Robots(robots) => robots.members.iter().flat_map(of_member).collect(),
            Self::Findings { findings, .. } => findings
                .iter()
                .map(|finding| Entry {
                    code: finding.rule.to_owned(),
                    level: finding.level,
                    file: finding.place.file.clone(),
                    line: Some(finding.place.line),
                    subject: finding.place.element.clone(),
                    message: finding.message.clone(),
                })
                .collect(),
        }
    }
}

fn of_member(member: &Member) -> Vec<Entry> {
    let entry = |level, subject: &str, message| Entry {
        code: "diff".into(),
        level,
        file: member.file.clone(),
        line: None,
        subject: subject.into(),
        message,
    };
    match &member.state {
        State::Compared { comparison, .. } => {
            let mut entries = of_comparison(comparison);
            // Lines of an expanded file are those of no file that anybody can open.
            for entry in entries.iter_mut().filter(|entry| entry.file != member.file) {
                entry.file.clone_from(&member.file);
                entry.line = None;
            }
            entries
        }
        State::Unreadable { why, counts: true } => vec![entry(Level::Error, "robot", format!("cannot be read: {why}"))],
        State::Unreadable { why, counts: false } => {
            vec![entry(Level::Note, "robot", format!("cannot be read, as before: {why}"))]
        }
        State::New => vec![entry(Level::Note, "note", "new".into())],
        State::Removed => vec![entry(Level::Note, "note", "removed".into())],
        State::Untouched => Vec::new(),
    }
}

/// Where a tip is displaced most, in words.
fn posture(at: &[JointValue]) -> String {
    if at.is_empty() {
        return "at any joint values".into();
    }
    if at.len() > 1 && at.iter().all(|joint| joint.value == 0.0) {
        return "with every joint at 0".into();
    }
    let values: Vec<String> =
        at.iter().map(|joint| format!("{} = {}", joint.joint, words::joint_value(joint.value))).collect();
    format!("at {}", values.join(", "))
}

fn of_comparison(comparison: &Comparison) -> Vec<Entry> {
    let entry = |counts: bool, line, subject: String, message| Entry {
        code: "diff".into(),
        level: if counts { Level::Error } else { Level::Note },
        file: comparison.b.file.clone(),
        line,
        subject,
        message,
    };
    let mut entries = Vec::new();
    for joint in &comparison.joints {
        for change in &joint.changes {
            let subject = format!("joint \"{}\"", joint.joint);
            entries.push(entry(change.counts, joint.line, subject, change.what.to_string()));
        }
    }
    for part in &comparison.parts {
        entries.push(entry(part.counts, part.line, part.part.clone(), part.what.clone()));
    }
    let relevant = |m: f64| m > comparison.tolerance_m;
    for tip in comparison.tips.iter().filter(|tip| relevant(tip.sampled_m)) {
        let message = format!(
            "displaced by up to {} {}; never more than {}",
            words::length(tip.sampled_m),
            posture(&tip.at),
            words::length(tip.bound_m)
        );
        let counts = comparison.verdict == Verdict::Different;
        entries.push(entry(counts, None, format!("tip \"{}\"", tip.tip), message));
    }
    for note in &comparison.notes {
        entries.push(entry(false, None, "note".into(), note.clone()));
    }
    entries.sort_by_key(|entry| entry.level);
    entries
}
