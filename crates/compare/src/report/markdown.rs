//! Markdown for a pull-request comment: the verdict, then a table.

use crate::comparison::{Comparison, Verdict};
use crate::report::{Level, Report};
use crate::words;
use std::fmt::Write;

pub(super) fn render(report: &Report) -> String {
    match report {
        Report::Comparison(comparison) => of_comparison(comparison, report),
        Report::Findings { files, .. } => of_findings(files.len(), report),
    }
}

fn cell(text: &str) -> String {
    text.replace('|', "\\|").replace('\n', " ")
}

fn of_comparison(comparison: &Comparison, report: &Report) -> String {
    let mut out = match comparison.verdict {
        Verdict::Same => format!("### `{}`: the same robot as `{}`\n", comparison.b.file, comparison.a.file),
        Verdict::Different => format!("### `{}` differs from `{}`\n", comparison.b.file, comparison.a.file),
    };
    let entries = report.entries();
    let rows: Vec<_> = entries.iter().filter(|entry| !entry.subject.starts_with("tip ")).collect();
    let (counted, notes): (Vec<_>, Vec<_>) = rows.into_iter().partition(|entry| entry.level == Level::Error);
    if !counted.is_empty() {
        out.push_str("\n| where | what changed | line |\n|---|---|---:|\n");
        for entry in counted {
            let line = entry.line.map_or_else(String::new, |line| line.to_string());
            let _ = writeln!(out, "| {} | {} | {line} |", cell(&entry.subject), cell(&entry.message));
        }
    }
    let moved: Vec<_> = comparison.tips.iter().filter(|tip| tip.sampled_m > comparison.tolerance_m).collect();
    if !moved.is_empty() {
        out.push_str("\n| tip | displaced by up to | nowhere by more than |\n|---|---:|---:|\n");
        for tip in moved {
            let (sampled, bound) = (words::length(tip.sampled_m), words::length(tip.bound_m));
            let _ = writeln!(out, "| {} | {sampled} | {bound} |", cell(&tip.tip));
        }
    }
    if !notes.is_empty() {
        out.push('\n');
        for note in notes {
            let _ = writeln!(out, "- {}", note.sentence());
        }
    }
    let within = format!("{} and {}", words::length(comparison.tolerance_m), words::angle(comparison.tolerance_rad));
    let _ = writeln!(out, "\nTolerances: {within}.");
    out
}

fn of_findings(files: usize, report: &Report) -> String {
    let entries = report.entries();
    let mut out = format!("### {} finding(s) in {files} file(s)\n", entries.len());
    if entries.is_empty() {
        return out;
    }
    out.push_str("\n| place | rule | finding |\n|---|---|---|\n");
    for entry in entries {
        let place = format!("`{}:{}`", entry.file, entry.line.unwrap_or(1));
        let _ = writeln!(out, "| {place} | {} | {} |", entry.code, cell(&entry.sentence()));
    }
    out
}
