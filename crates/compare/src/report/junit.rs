//! JUnit XML: a test case per joint, part and tip of a comparison, or per file of a check.

use crate::comparison::{Comparison, Verdict};
use crate::report::{Entry, Level, Report};
use std::fmt::Write;

/// A test case and why it failed.
struct Case {
    class: String,
    name: String,
    failures: Vec<Entry>,
}

pub(super) fn render(report: &Report) -> String {
    let cases = match report {
        Report::Comparison(comparison) => of_comparison(comparison, report.entries()),
        Report::Findings { files, .. } => {
            let mut entries = report.entries();
            entries.retain(|entry| entry.level != Level::Note);
            files
                .iter()
                .map(|file| Case {
                    class: "denavit.check".into(),
                    name: file.clone(),
                    failures: entries.iter().filter(|entry| entry.file == *file).cloned().collect(),
                })
                .collect()
        }
    };
    let failed = cases.iter().filter(|case| !case.failures.is_empty()).count();
    let mut out = String::from("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n");
    let _ = writeln!(out, "<testsuites name=\"denavit\" tests=\"{}\" failures=\"{failed}\">", cases.len());
    let _ = writeln!(out, "  <testsuite name=\"denavit\" tests=\"{}\" failures=\"{failed}\">", cases.len());
    for case in &cases {
        let (class, name) = (escaped(&case.class), escaped(&case.name));
        let head = format!("    <testcase classname=\"{class}\" name=\"{name}\"");
        if case.failures.is_empty() {
            let _ = writeln!(out, "{head}/>");
            continue;
        }
        let lines: Vec<String> = case.failures.iter().map(line).collect();
        let message = escaped(&case.failures[0].sentence());
        let _ = writeln!(out, "{head}>\n      <failure message=\"{message}\">{}</failure>", escaped(&lines.join("\n")));
        out.push_str("    </testcase>\n");
    }
    out + "  </testsuite>\n</testsuites>\n"
}

fn line(entry: &Entry) -> String {
    entry.line.map_or_else(|| entry.sentence(), |line| format!("{}:{line}: {}", entry.file, entry.sentence()))
}

/// A case for each thing that differs; one that passes or fails for the whole.
fn of_comparison(comparison: &Comparison, mut entries: Vec<Entry>) -> Vec<Case> {
    entries.retain(|entry| entry.level == Level::Error);
    let class = format!("denavit.diff.{}", comparison.b.file);
    let mut cases: Vec<Case> = Vec::new();
    for entry in entries {
        match cases.iter_mut().find(|case| case.name == entry.subject) {
            Some(case) => case.failures.push(entry),
            None => cases.push(Case { class: class.clone(), name: entry.subject.clone(), failures: vec![entry] }),
        }
    }
    if comparison.verdict == Verdict::Same {
        cases.push(Case { class, name: format!("same robot as {}", comparison.a.file), failures: Vec::new() });
    }
    cases
}

/// Text that XML takes: what it reserves written out, control characters that it forbids left out.
pub(super) fn escaped(text: &str) -> String {
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
