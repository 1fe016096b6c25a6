//! JUnit XML: a test case per joint, part and tip of a comparison, or per file of a check.

use crate::comparison::{Comparison, Verdict};
use crate::report::{Entry, Level, Report};
use crate::robots::{Member, Robots, State};
use std::fmt::Write;

/// A test case.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Case {
    /// What it belongs to, with dots: `denavit.check`.
    pub class: String,
    /// Its own name.
    pub name: String,
    /// Why it failed; none: it passed, or was skipped.
    pub failure: Option<CaseFailure>,
    /// Why it was not tested; a case that failed was.
    pub skipped: Option<String>,
}

/// Why a test case failed.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct CaseFailure {
    /// In one sentence.
    pub message: String,
    /// In whole, a line for each reason.
    pub text: String,
}

/// The file of a suite of test cases.
pub fn suite(name: &str, cases: &[Case]) -> String {
    let failed = cases.iter().filter(|case| case.failure.is_some()).count();
    let skipped = cases.iter().filter(|case| case.failure.is_none() && case.skipped.is_some()).count();
    let mut head = format!("name=\"{}\" tests=\"{}\" failures=\"{failed}\"", escaped(name), cases.len());
    if skipped > 0 {
        let _ = write!(head, " skipped=\"{skipped}\"");
    }
    let mut out = format!("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites {head}>\n  <testsuite {head}>\n");
    for Case { class, name, failure, skipped } in cases {
        let _ = write!(out, "    <testcase classname=\"{}\" name=\"{}\"", escaped(class), escaped(name));
        let Some(CaseFailure { message, text }) = failure else {
            match skipped {
                None => out.push_str("/>\n"),
                Some(why) => {
                    let _ = writeln!(out, ">\n      <skipped message=\"{}\"/>\n    </testcase>", escaped(why));
                }
            }
            continue;
        };
        let (message, text) = (escaped(message), escaped(text));
        let _ = writeln!(out, ">\n      <failure message=\"{message}\">{text}</failure>\n    </testcase>");
    }
    out + "  </testsuite>\n</testsuites>\n"
}

pub(super) fn render(report: &Report) -> String {
    let cases = match report {
        Report::Comparison(comparison) => of_comparison(comparison, report.entries()),
        Report::Robots(robots) => robots.members.iter().map(|member| of_member(member, &robots.before)).collect(),
        Report::Findings { files, .. } => {
            let mut entries = report.entries();
            entries.retain(|entry| entry.level != Level::Note);
            let case = |file: &String| Case {
                class: "denavit.check".into(),
                name: file.clone(),
                failure: failure(entries.iter().filter(|entry| is_of(entry, file))),
                skipped: None,
            };
            files.iter().map(case).collect()
        }
    };
    suite("denavit", &cases)
}

/// Whether an entry is about a file, or about what it was expanded to: `arm.xacro (expanded)`.
fn is_of(entry: &Entry, file: &str) -> bool {
    entry.file.strip_prefix(file).is_some_and(|rest| rest.is_empty() || rest.starts_with(" ("))
}

/// Of all entries of a case: the first one's sentence is its message.
fn failure<'a>(entries: impl Iterator<Item = &'a Entry>) -> Option<CaseFailure> {
    let entries: Vec<&Entry> = entries.collect();
    let lines: Vec<String> = entries.iter().map(|entry| line(entry)).collect();
    entries.first().map(|first| CaseFailure { message: first.sentence(), text: lines.join("\n") })
}

fn line(entry: &Entry) -> String {
    entry.line.map_or_else(|| entry.sentence(), |line| format!("{}:{line}: {}", entry.file, entry.sentence()))
}

/// A case for each robot.
fn of_member(member: &Member, before: &str) -> Case {
    let report = Report::Robots(&Robots { members: vec![member.clone()], ..Robots::default() });
    let entries = report.entries();
    let skipped = match &member.state {
        State::New => Some("new".into()),
        State::Removed => Some("removed".into()),
        State::Unreadable { why, counts: false } => Some(format!("cannot be read, as before: {why}")),
        _ => None,
    };
    Case {
        class: format!("denavit.diff.{before}"),
        name: member.name.clone(),
        failure: failure(entries.iter().filter(|entry| entry.level == Level::Error)),
        skipped,
    }
}

/// A case for each thing that differs; one that passes or fails for the whole.
fn of_comparison(comparison: &Comparison, mut entries: Vec<Entry>) -> Vec<Case> {
    entries.retain(|entry| entry.level == Level::Error);
    let class = format!("denavit.diff.{}", comparison.b.file);
    let mut names: Vec<&String> = Vec::new();
    for entry in &entries {
        if !names.contains(&&entry.subject) {
            names.push(&entry.subject);
        }
    }
    let mut cases: Vec<Case> = Vec::new();
    for name in names {
        let failure = failure(entries.iter().filter(|entry| entry.subject == *name));
        cases.push(Case { class: class.clone(), name: name.clone(), failure, skipped: None });
    }
    if comparison.verdict == Verdict::Same {
        cases.push(Case { class, name: format!("same robot as {}", comparison.a.file), failure: None, skipped: None });
    }
    cases
}

/// Text that XML takes: what it reserves written out, control characters that it forbids left out.
fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\n' => out.push_str("&#10;"),
            c if c.is_control() => {}
            c => out.push(c),
        }
    }
    out
}
