//! Markdown for a pull-request comment: the verdict, then a table.

use crate::comparison::{Comparison, Verdict};
use crate::report::{Entry, Level, Report};
use crate::robots::{Member, Robots, State};
use crate::words;
use std::fmt::Write;

pub(super) fn render(report: &Report) -> String {
    match report {
        Report::Comparison(comparison) => of_comparison(comparison, report),
        Report::Robots(robots) => of_robots(robots),
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
        out.push_str("\n| tip | displaced by up to | never more than |\n|---|---:|---:|\n");
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

/// A comment on GitHub holds 65536 characters; bytes are counted here, and the table comes first.
const MOST_BYTES: usize = 60_000;
/// Rows of the table.
const MOST_ROWS: usize = 200;

fn of_robots(robots: &Robots) -> String {
    let mut out = format!("### Robots: {}\n", robots.counts());
    let is_as_before = |member: &&Member| match &member.state {
        State::Untouched => true,
        State::Compared { comparison, .. } => comparison.verdict == Verdict::Same && member.file_before.is_none(),
        _ => false,
    };
    let (same, mut listed): (Vec<_>, Vec<_>) = robots.members.iter().partition(is_as_before);
    listed.sort_by_key(|member| rank(&member.state));
    if !listed.is_empty() {
        out.push_str(
            "\n| robot | | tip displaced by up to | never more than | what changed |\n|---|---|---:|---:|---|\n",
        );
    }
    for member in listed.iter().take(MOST_ROWS) {
        let (verdict, tip, what) = row(member);
        let [up_to, most] = tip.unwrap_or_default();
        let _ = writeln!(out, "| {} | {verdict} | {up_to} | {most} | {} |", cell(&named(member)), cell(&what));
    }
    if listed.len() > MOST_ROWS {
        let _ = writeln!(out, "\n{} more robots changed.", listed.len() - MOST_ROWS);
    }
    let mut left_out = 0;
    for member in &listed {
        let State::Compared { comparison, picture } = &member.state else { continue };
        if comparison.verdict == Verdict::Same {
            continue;
        }
        let mut part = format!("\n<details><summary><code>{}</code></summary>\n\n", html(&member.name));
        part.push_str(&of_comparison(comparison, &Report::Comparison(comparison)));
        if let Some(picture) = picture {
            let _ = writeln!(part, "\n![{} before and after]({picture})", member.name.replace(['[', ']'], ""));
        }
        part.push_str("\n</details>\n");
        if out.len() + part.len() > MOST_BYTES {
            left_out += 1;
        } else {
            out.push_str(&part);
        }
    }
    if left_out > 0 {
        let _ = writeln!(out, "\nDetails of {left_out} more robots are omitted here.");
    }
    let same = same.iter().filter(|member| !matches!(member.state, State::Untouched)).map(|member| &member.name);
    folded(&mut out, "changed files, same robots", same);
    let parts = "xacro files are not robots by themselves, or need arguments (state them in denavit.toml)";
    folded(&mut out, parts, robots.left_out.iter());
    let _ = writeln!(out, "\nCompared: `{}` → {}.", robots.before, robots.after);
    out
}

/// What asks for attention first.
fn rank(state: &State) -> u8 {
    match state {
        State::Unreadable { counts: true, .. } => 0,
        State::Compared { comparison, .. } if comparison.verdict == Verdict::Different => 1,
        State::Removed => 2,
        State::New => 3,
        State::Compared { .. } | State::Unreadable { .. } | State::Untouched => 4,
    }
}

/// A collapsed list.
fn folded<'a>(out: &mut String, words: &str, names: impl Iterator<Item = &'a String>) {
    let names: Vec<String> = names.map(|name| format!("`{name}`")).collect();
    if !names.is_empty() {
        let (count, names) = (names.len(), names.join(", "));
        let _ = writeln!(out, "\n<details><summary>{count} {words}</summary>\n\n{names}\n\n</details>");
    }
}

fn named(member: &Member) -> String {
    let mut out = format!("`{}`", member.name);
    if member.name != member.file {
        let _ = write!(out, "<br>{}", html(&member.file));
    }
    if let Some(before) = &member.file_before {
        let _ = write!(out, "<br>was {}", html(before));
    }
    out
}

/// The verdict, how far the tip moves at most, and what changed.
fn row(member: &Member) -> (&'static str, Option<[String; 2]>, String) {
    let what = match &member.state {
        State::Compared { comparison, .. } => {
            let entries = Report::Comparison(comparison).entries();
            let counted =
                entries.iter().filter(|entry| entry.level == Level::Error && !entry.subject.starts_with("tip "));
            let counted: Vec<String> = counted.map(Entry::sentence).collect();
            let mut what = counted.first().cloned().unwrap_or_default();
            if counted.len() > 1 {
                let _ = write!(what, " (and {} more)", counted.len() - 1);
            }
            let tip = comparison.largest().filter(|tip| tip.sampled_m > comparison.tolerance_m);
            let tip = tip.map(|tip| [words::length(tip.sampled_m), words::length(tip.bound_m)]);
            return match comparison.verdict {
                Verdict::Same => ("the same robot", tip, what),
                Verdict::Different => ("**different**", tip, what),
            };
        }
        State::Unreadable { why, .. } => why.lines().next().unwrap_or_default().to_owned(),
        State::New | State::Removed | State::Untouched => String::new(),
    };
    let verdict = match &member.state {
        State::New => "new",
        State::Removed => "removed",
        State::Unreadable { counts: true, .. } => "**cannot be read**",
        State::Unreadable { .. } => "cannot be read, as before",
        State::Compared { .. } | State::Untouched => "",
    };
    (verdict, None, what)
}

fn html(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
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
