//! Everything as JSON, two spaces deep.

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

#[derive(Serialize)]
struct FindingsOut<'a> {
    files: &'a [String],
    findings: Vec<FindingOut<'a>>,
}

pub(super) fn render(report: &Report) -> String {
    let text = match report {
        Report::Comparison(comparison) => serde_json::to_string_pretty(comparison),
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
            serde_json::to_string_pretty(&FindingsOut { files, findings: findings.collect() })
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
