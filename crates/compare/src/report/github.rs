//! Workflow commands of GitHub Actions: each entry becomes an annotation beside its line.

use crate::report::{Level, Report};
use std::fmt::Write;

pub(super) fn render(report: &Report) -> String {
    let mut out = String::new();
    for entry in report.entries() {
        let command = match entry.level {
            Level::Error => "error",
            Level::Warning => "warning",
            Level::Note => "notice",
        };
        let line = entry.line.map_or_else(String::new, |line| format!(",line={line}"));
        let (file, title) = (property(&entry.file), property(&format!("denavit {}", entry.code)));
        let _ = writeln!(out, "::{command} file={file}{line},title={title}::{}", data(&entry.sentence()));
    }
    out
}

fn data(text: &str) -> String {
    text.replace('%', "%25").replace('\r', "%0D").replace('\n', "%0A")
}

fn property(text: &str) -> String {
    data(text).replace(':', "%3A").replace(',', "%2C")
}
