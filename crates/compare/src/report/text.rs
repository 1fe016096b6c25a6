//! Text for people: a line each, the verdict first.

use crate::comparison::{Comparison, Verdict};
use crate::report::{Colour, Entry, FileInventory, Level, Report};
use crate::robots::{Robots, State};
use crate::words;
use denavit_model::{Inventory, Outcome};
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
    if let Report::Robots(robots) = report {
        of_robots(&mut out, robots, &paint);
        return out;
    }
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
    if let Report::Findings { files, findings, inventories, known } = report {
        for FileInventory { file, inventory } in *inventories {
            let _ = writeln!(out, "{}", paint(FAINT, &format!("{file}: {}", account(inventory))));
        }
        let errors = findings.iter().filter(|finding| finding.level == Level::Error).count();
        let new = if known.is_some() { "new " } else { "" };
        let mut counts =
            format!("{} file(s), {} {new}finding(s), {errors} of them errors", files.len(), findings.len());
        if let Some(known) = known {
            let _ = write!(counts, "; {known} more are in the baseline");
        }
        let _ = writeln!(out, "{}", paint(if findings.is_empty() { GREEN } else { FAINT }, &counts));
    }
    out
}

/// Each changed robot in full; then the counts.
fn of_robots(out: &mut String, robots: &Robots, paint: &dyn Fn(&str, &str) -> String) {
    for member in &robots.members {
        let who = member.title();
        match &member.state {
            State::Untouched => {}
            State::Compared { comparison, .. } => {
                let one = render(&Report::Comparison(comparison), Colour::None);
                let verdict = match comparison.verdict {
                    Verdict::Same => paint(GREEN, "the same robot"),
                    Verdict::Different => paint(RED, "different"),
                };
                let _ = writeln!(out, "{who}: {verdict}");
                for line in one.lines().skip(1) {
                    let _ = writeln!(out, "{line}");
                }
            }
            State::New => {
                let _ = writeln!(out, "{who}: new");
            }
            State::Removed => {
                let _ = writeln!(out, "{who}: removed");
            }
            State::Unreadable { why, counts } => {
                let words = if *counts { "cannot be read" } else { "cannot be read, as before" };
                let _ = writeln!(out, "{who}: {}: {why}", paint(if *counts { RED } else { FAINT }, words));
            }
        }
    }
    for left_out in &robots.left_out {
        let _ = writeln!(out, "{}", paint(FAINT, &format!("{left_out}: left out, as it is not a robot by itself")));
    }
    let _ = writeln!(out, "{} → {}: {}", robots.before, robots.after, robots.counts());
}

/// `214 understood, 3 kept unchanged (2 <gazebo>, 1 <transmission>), 1 not understood`.
fn account(inventory: &Inventory) -> String {
    let mut kinds: Vec<(&str, usize)> = Vec::new();
    for item in inventory.items.iter().filter(|item| item.outcome == Outcome::Carried) {
        match kinds.iter_mut().find(|(kind, _)| *kind == item.what) {
            Some((_, count)) => *count += 1,
            None => kinds.push((&item.what, 1)),
        }
    }
    let mut out = format!("{} understood", inventory.understood);
    if !kinds.is_empty() {
        let listed: Vec<String> = kinds.iter().map(|(kind, count)| format!("{count} {kind}")).collect();
        let _ = write!(out, ", {} kept unchanged ({})", inventory.count(Outcome::Carried), listed.join(", "));
    }
    let _ = write!(out, ", {} not understood", inventory.count(Outcome::Reported));
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
