//! One line and a colour, as shields.io reads them from a file.
//!
//! # Source
//! shields.io, "Endpoint badge": schemaVersion 1, label, message, color.

use crate::comparison::Verdict;
use crate::report::{Level, Report};
use crate::robots::Counts;
use serde_json::json;

pub(super) fn render(report: &Report) -> String {
    let (label, message, color) = match report {
        Report::Findings { files, findings, .. } => {
            let errors = findings.iter().filter(|finding| finding.level == Level::Error).count();
            match (errors, findings.len()) {
                (0, 0) => ("denavit check", format!("clean, {} files", files.len()), "brightgreen"),
                (0, found) => ("denavit check", format!("{found} findings, no error"), "yellow"),
                (errors, _) => ("denavit check", format!("{errors} errors"), "red"),
            }
        }
        Report::Comparison(comparison) => match comparison.verdict {
            Verdict::Same => ("denavit diff", "the same robot".into(), "brightgreen"),
            Verdict::Different => ("denavit diff", "different".into(), "orange"),
        },
        Report::Robots(robots) => {
            let Counts { different, unreadable, .. } = robots.count();
            let color = match (unreadable, different) {
                (0, 0) => "brightgreen",
                (0, _) => "orange",
                _ => "red",
            };
            ("denavit diff", robots.counts(), color)
        }
    };
    let badge = json!({ "schemaVersion": 1, "label": label, "message": message, "color": color });
    serde_json::to_string_pretty(&badge).expect("plain values with text keys") + "\n"
}
