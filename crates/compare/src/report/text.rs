//! Text for people: a line each, the verdict first.

use crate::comparison::{Comparison, Verdict};
use crate::report::{Colour, Entry, Level, Report};
use crate::words;
use std::fmt::Write;

const RED: &str = "31";
const YELLOW: &str = "33";
const GREEN: &str = "32";
const FAINT: &str = "2";

pub(super) fn render(report: &Report, colour: Colour) -> String {
    let paint = |code: &str, text: &str| match colour {
        Colour::Ansi => format!("\u{1b}[{code}m{text}\u{1b}[0m"),
        Colour::None => text.to_owned(),
    };
    let mut out = String::new();
    if let Report::Comparison(comparison) = report {
        let _ = writeln!(out, "{}", headline(comparison, &paint));
    }
    for entry in report.entries() {
        let code = match entry.level {
            Level::Error => RED,
            Level::Warning => YELLOW,
            Level::Note => FAINT,
        };
        let _ = writeln!(out, "{}", line(report, &entry, &|text| paint(code, text)));
    }
    if let Report::Findings { files, findings } = report {
        let errors = findings.iter().filter(|finding| finding.level == Level::Error).count();
        let counts = format!("{} file(s), {} finding(s), {errors} of them errors", files.len(), findings.len());
        let _ = writeln!(out, "{}", paint(if findings.is_empty() { GREEN } else { FAINT }, &counts));
    }
    out
}

fn headline(comparison: &Comparison, paint: &dyn Fn(&str, &str) -> String) -> String {
    let files = format!("{} → {}", comparison.a.file, comparison.b.file);
    let within = format!("{} and {}", words::length(comparison.tolerance_m), words::angle(comparison.tolerance_rad));
    match comparison.verdict {
        Verdict::Same => format!("{files}: {} within {within}", paint(GREEN, "the same robot")),
        Verdict::Different => format!("{files}: {}", paint(RED, "different")),
    }
}

fn line(report: &Report, entry: &Entry, paint: &dyn Fn(&str) -> String) -> String {
    if matches!(report, Report::Comparison(_)) {
        let text = if entry.subject == "note" {
            entry.message.clone()
        } else {
            format!("{}: {}", entry.subject, entry.message)
        };
        return format!("  {}", if entry.level == Level::Error { text } else { paint(&text) });
    }
    let place = format!("{}:{}", entry.file, entry.line.unwrap_or(1));
    let level = entry.level.word();
    format!("{place}: {} {}: {}", paint(&format!("{level} {}", entry.code)), entry.subject, entry.message)
}
