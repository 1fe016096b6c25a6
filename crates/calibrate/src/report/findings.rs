//! What the tracer found, as text for a terminal: each effect, why it is claimed, its rivals, and what remains.

use crate::trace::{Trace, Value};
use std::fmt::Write;

fn number(value: &Value) -> String {
    let unit = if value.unit == "1" { String::new() } else { format!(" {}", value.unit) };
    match value.std {
        Some(std) => format!("{} {:.3e} ± {:.1e}{unit}", value.name, value.value, std),
        None => format!("{} {:.4}{unit}", value.name, value.value),
    }
}

fn probability(p: f64) -> String {
    match p {
        p if p < 1e-99 => "p below 1e-99".into(),
        p if p < 0.01 => format!("p {p:.1e}"),
        p => format!("p {p:.2}"),
    }
}

/// The effects with their numbers and rivals, then what no effect explains.
pub fn findings(trace: &Trace) -> String {
    let mut text = String::new();
    let count = trace.candidates;
    if trace.findings.is_empty() {
        let _ = writeln!(text, "no effect beyond geometry, of {count} candidates");
    } else {
        let _ = writeln!(text, "effects that the data ask for, of {count} candidates (p counts all of them)");
    }
    for finding in &trace.findings {
        let driver = finding.term.driver.covariate().map_or_else(String::new, |name| format!(", with {name}"));
        let _ = writeln!(text, "  {} at {}{driver}", finding.term.kind.name(), finding.place);
        for value in &finding.values {
            let _ = writeln!(text, "      {}", number(value));
        }
        let _ = writeln!(text, "      why: ΔBIC {:.0}, {}", finding.delta_bic, probability(finding.p_value));
        let rivals: Vec<String> =
            finding.ambiguous_with.iter().map(|(kind, place)| format!("{} at {place}", kind.name())).collect();
        if rivals.is_empty() {
            let _ = writeln!(text, "      rivals: none");
        } else {
            let _ = writeln!(text, "      indistinguishable in these data from {}", rivals.join(", "));
        }
    }
    let left = &trace.leftover;
    if left.structured {
        let places: Vec<String> = left
            .places
            .iter()
            .map(|place| {
                let name = place.joint.as_deref().or(place.covariate.as_deref()).unwrap_or("run order");
                format!("{name} {:.0} %", 100.0 * place.share)
            })
            .collect();
        let _ = writeln!(
            text,
            "structure remains that no effect explains ({}): {}",
            probability(left.p_value),
            places.join(", ")
        );
    } else {
        let _ = writeln!(text, "what remains has no structure ({})", probability(left.p_value));
    }
    text
}
