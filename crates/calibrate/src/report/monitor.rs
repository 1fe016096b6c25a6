//! What is known after each measured row: as a line, as lines for a terminal, as JSON.

use crate::calibration::monitor::{Known, Off, RowStatus, SCHEMA, Uncertain};
use denavit_measurements::Units;
use denavit_model::Chain;
use serde::Serialize;
use std::fmt::Write as _;

/// A length or an angle for people: mm, mrad.
fn size(value: f64, unit: &str) -> String {
    let (value, unit) = match unit {
        "m" => (value * 1e3, "mm"),
        "rad" => (value * 1e3, "mrad"),
        other => (value, other),
    };
    // Three significant digits.
    let decimals = if value < 0.1 {
        4
    } else if value < 10.0 {
        3
    } else {
        1
    };
    format!("{value:.decimals$} {unit}")
}

fn offs(offs: &[Off], of: impl Fn(&Off) -> String) -> String {
    offs.iter().map(of).collect::<Vec<_>>().join(", ")
}

fn uncertain(parameter: &Uncertain) -> String {
    let after = parameter
        .std_after_next
        .map_or_else(String::new, |std| format!(", {} after the next pose", size(std, parameter.unit)));
    format!("{} ± {}{after}", parameter.parameter, size(parameter.std, parameter.unit))
}

/// How far a row is off, and why it does not fit, if so.
pub fn row(status: &RowStatus) -> String {
    let mut text = String::new();
    if let Some(read_as) = &status.read_as {
        let _ = writeln!(text, "ATTENTION: these data do not fit this robot as they are written; {}", read_as.said);
    }
    let _ = write!(text, "line {}: ", status.line);
    if let Some(why) = &status.out_of_line {
        text.push_str("DOES NOT FIT, ");
        if !why.targets.is_empty() {
            let _ = write!(text, "target {}, ", why.targets.join(", "));
        }
    }
    if status.copy {
        text.push_str("an exact copy of an earlier row, not counted again");
    } else if status.off.is_empty() {
        text.push_str(match status.missing_numbers {
            0 => "nothing to compare it with yet",
            _ => "too few rows to place the instrument and the target",
        });
    } else {
        let off = |off: &Off| {
            format!("{} off ({}), {} expected", size(off.error, off.unit), off.what, size(off.expected, off.unit))
        };
        text.push_str(&offs(&status.off, off));
        if !status.judged {
            text.push_str(", too early to judge");
        }
    }
    if let Some(why) = &status.out_of_line {
        if why.rows > 1 {
            let _ = write!(text, "; {} rows in succession", why.rows);
        }
        match &why.explanations[..] {
            [] if why.undecided => {
                text.push_str(
                    "; too few such rows yet to distinguish another reflector from a moved instrument or base",
                );
            }
            [] => text.push_str("; neither a joint, nor a target, nor the instrument alone explains it"),
            found => {
                let _ = write!(text, "; possible cause: {}", found.join("; or "));
            }
        }
    }
    text
}

fn worst(known: &Known) -> String {
    known
        .worst
        .first()
        .map_or_else(String::new, |worst| format!(", worst {} ± {}", worst.parameter, size(worst.std, worst.unit)))
}

/// Joint values in the units of the file.
fn joints(next: &[(String, f64)], chain: &Chain, units: Units) -> String {
    let values = chain.coordinates().iter().zip(next);
    values.map(|(coordinate, (_, value))| format!("{:.3}", value / units.of(coordinate))).collect::<Vec<_>>().join(",")
}

/// Everything of a row in one line.
pub fn line(status: &RowStatus, chain: &Chain, units: Units) -> String {
    let mut text = row(status);
    if !status.noise.is_empty() {
        let _ = write!(text, "; noise {}", offs(&status.noise, |noise| size(noise.error, noise.unit)));
    }
    if let Some(known) = &status.known {
        let _ = write!(text, "; {} of {} parameters known{}", known.known, known.identifiable, worst(known));
    }
    if let Some(next) = &status.next {
        let _ = write!(text, "; next {}", joints(next, chain, units));
    }
    text + "\n"
}

/// What is known by now, several lines for a terminal.
pub fn knowledge(status: &RowStatus, chain: &Chain, units: Units) -> String {
    let mut text = format!("{} rows", status.row);
    match &status.lines_out_of_line[..] {
        [] => {}
        lines => {
            let lines: Vec<String> = lines.iter().map(usize::to_string).collect();
            let _ = write!(text, ", {} do not fit (lines {})", lines.len(), lines.join(", "));
        }
    }
    if status.missing_numbers > 0 {
        let _ = write!(
            text,
            "; {} more measured numbers needed to place the instrument and the target",
            status.missing_numbers
        );
    }
    text.push('\n');
    let Some(known) = &status.known else { return text };
    let _ = write!(text, "noise {} per component", offs(&status.noise, |noise| size(noise.error, noise.unit)));
    if let Some(prediction) = known.prediction_std_m {
        let _ = write!(text, "; predicted error over the joint range {}", size(prediction, "m"));
    }
    let bar = (20 * known.known).checked_div(known.identifiable).unwrap_or(0);
    let _ = writeln!(
        text,
        "\n[{}{}] {} of {} parameters are known better than their tolerance",
        "#".repeat(bar),
        "-".repeat(20 - bar),
        known.known,
        known.identifiable
    );
    for parameter in &known.worst {
        let _ = writeln!(text, "  {}", uncertain(parameter));
    }
    if !known.unmoved.is_empty() {
        let _ = writeln!(text, "  not moved yet: {}", known.unmoved.join(", "));
    }
    if let Some(next) = &status.next {
        let [_, angle] = units.words();
        let names: Vec<&str> = next.iter().map(|(name, _)| name.as_str()).collect();
        let _ = writeln!(text, "measure next ({}, {angle}):\n  {}", names.join(","), joints(next, chain, units));
    }
    text
}

/// A row as one line of JSON; `restarts` counts how often the file began anew.
pub fn json(status: &RowStatus, restarts: usize) -> String {
    #[derive(Serialize)]
    struct Stamped<'a> {
        schema: &'static str,
        restarts: usize,
        #[serde(flatten)]
        status: &'a RowStatus,
    }
    serde_json::to_string(&Stamped { schema: SCHEMA, restarts, status }).expect("plain values with text keys") + "\n"
}
