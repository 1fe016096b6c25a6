//! Everything as JSON, two spaces deep.

use crate::comparison::Comparison;
use crate::report::{Entry, Report};
use serde::Serialize;

#[derive(Serialize)]
struct FindingOut<'a> {
    rule: &'a str,
    level: crate::report::Level,
    file: &'a str,
    line: usize,
    element: &'a str,
    message: &'a str,
    fixable: bool,
}

/// What a comparison is called, and its version.
const COMPARISON: &str = "denavit.diff/1";
/// What findings are called, and their version.
const FINDINGS: &str = "denavit.check/1";

#[derive(Serialize)]
struct ComparisonOut<'a> {
    schema: &'static str,
    #[serde(flatten)]
    comparison: &'a Comparison,
}

#[derive(Serialize)]
struct FindingsOut<'a> {
    schema: &'static str,
    files: &'a [String],
    findings: Vec<FindingOut<'a>>,
}

pub(super) fn render(report: &Report) -> String {
    let text = match report {
        Report::Comparison(comparison) => {
            serde_json::to_string_pretty(&ComparisonOut { schema: COMPARISON, comparison })
        }
        Report::Findings { files, findings } => {
            let findings = findings.iter().map(|finding| FindingOut {
                rule: finding.rule,
                level: finding.level,
                file: &finding.place.file,
                line: finding.place.line,
                element: &finding.place.element,
                message: &finding.message,
                fixable: !finding.fix.is_empty(),
            });
            serde_json::to_string_pretty(&FindingsOut { schema: FINDINGS, files, findings: findings.collect() })
        }
    };
    text.expect("plain values with text keys") + "\n"
}

impl Entry {
    /// `subject: message`, or the message alone where the entry is about the whole.
    pub(super) fn sentence(&self) -> String {
        if self.subject == "note" { self.message.clone() } else { format!("{}: {}", self.subject, self.message) }
    }
}
