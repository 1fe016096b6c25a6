//! What the tracer found, as text for a terminal: each effect, why it is claimed, its alternatives, and unexplained structure.

use denavit_identify::effects::catalogue::Kind;
use denavit_trace::infer::named::Alternative;
use denavit_trace::{Finding, Trace, Value};
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

/// Kind, place and driver.
fn title(finding: &Finding, trace: &Trace) -> String {
    let mut title = format!("{} at {}", finding.term.kind.name(), finding.place);
    if let Some(driver) = finding.driven_by() {
        let _ = write!(title, ", driven by {}", trace.fit.arm.nominal.joints()[driver].name);
    }
    if let Some(name) = finding.term.driver.covariate() {
        let _ = write!(title, ", with {name}");
    }
    title
}

/// Titles with their probabilities.
fn listed(all: &[(f64, String)]) -> String {
    all.iter().map(|(probability, title)| format!("{title} ({})", percent(*probability))).collect::<Vec<_>>().join(", ")
}

/// The likeliest kind of all that an effect may be.
fn likeliest(finding: &Finding) -> Kind {
    let above = finding.rivals.iter().filter(|rival| rival.probability > finding.probability);
    let best = above.max_by(|a, b| a.probability.total_cmp(&b.probability));
    best.filter(|_| !finding.named).map_or(finding.term.kind, |rival| rival.kind)
}

/// A probability in percent; not rounded to 0 or 100.
fn percent(probability: f64) -> String {
    match probability {
        p if p > 0.995 => "over 99 %".into(),
        p if p < 0.005 => "below 1 %".into(),
        p => format!("{:.0} %", 100.0 * p),
    }
}

/// The texts of an effect on a page.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize)]
pub struct Said {
    /// The effect if it is named; else all alternatives, each with its probability.
    pub title: String,
    /// Whether it is certain enough to be named.
    pub named: bool,
    /// Its numbers with their standard deviations.
    pub numbers: Vec<String>,
    /// The evidence for it.
    pub why: String,
    /// Alternatives to a named one.
    pub rivals: Option<String>,
}

/// A finding in the words of the report.
pub fn said(finding: &Finding, trace: &Trace) -> Said {
    let own = title(finding, trace);
    let rival = |rival: &Alternative| (rival.probability, format!("{} at {}", rival.kind.name(), rival.place));
    let mut all: Vec<(f64, String)> = finding.rivals.iter().map(rival).collect();
    let again = match finding.found_again {
        share if share <= 0.0 => "selected in no half-sample refit".to_owned(),
        share if share >= 1.0 => "selected in all half-sample refits".to_owned(),
        share => format!("selected in {} of half-sample refits", percent(share)),
    };
    let (title, why, rivals) = if finding.named {
        let rivals = (!all.is_empty()).then(|| format!("alternatives: {}", listed(&all)));
        (own, format!("probability {}, {again}", percent(finding.probability)), rivals)
    } else {
        let alone = if all.is_empty() { "perhaps" } else { "one of" };
        // The likeliest first, whichever of them the model has.
        all.insert(0, (finding.probability, own.clone()));
        all.sort_by(|a, b| b.0.total_cmp(&a.0));
        let model = if all[0].1 == own { "the model".to_owned() } else { format!("the model as {own}") };
        let beside = if finding.is_outweighed() { ", but there is more unexplained structure" } else { "" };
        (format!("{alone}: {}", listed(&all)), format!("included in {model}, cause uncertain: {again}{beside}"), None)
    };
    Said { title, named: finding.named, numbers: finding.values.iter().map(number).collect(), why, rivals }
}

/// The effects, the named ones first.
pub fn named_first(trace: &Trace) -> Vec<&Finding> {
    let (mut named, open): (Vec<&Finding>, Vec<&Finding>) = trace.findings.iter().partition(|finding| finding.named);
    named.extend(open);
    named
}

/// What unexplained structure follows; `None` without such structure.
pub fn structure(trace: &Trace) -> Option<String> {
    let left = &trace.unexplained;
    left.structured.then(|| format!("{} ({})", places(trace), probability(left.p_value)))
}

/// Joints and covariates that unexplained structure follows, each with its share.
fn places(trace: &Trace) -> String {
    let place = |place: &denavit_trace::Structure| {
        let name = place.joint.as_deref().or(place.covariate.as_deref()).unwrap_or("run order");
        format!("{name} {}", percent(place.share))
    };
    trace.unexplained.places.iter().map(place).collect::<Vec<_>>().join(", ")
}

/// The heading of the list of effects: whether a cause is named, and the number of candidates.
pub fn heading(trace: &Trace) -> String {
    let what = if trace.findings.is_empty() {
        let beside = if trace.fit.effects.curves.is_empty() { "" } else { " and error curves" };
        format!("no effect beyond geometry{beside}")
    } else if trace.findings.iter().any(|finding| finding.named) {
        "effects selected".to_owned()
    } else {
        "no cause is certain enough to be named".to_owned()
    };
    format!("{what}, of {} candidates", trace.candidates)
}

/// The last line of the list: unexplained structure.
pub fn ending(trace: &Trace) -> String {
    let left = &trace.unexplained;
    let chance = probability(left.p_value);
    if left.structured {
        format!("unexplained structure ({chance}): {}", places(trace))
    } else {
        format!("no unexplained structure ({chance})")
    }
}

/// The effects with their numbers and alternatives, then unexplained structure.
pub fn findings(trace: &Trace) -> String {
    let mut text = heading(trace) + "\n";
    for finding in named_first(trace) {
        let Said { title, named, numbers, why, rivals } = said(finding, trace);
        let _ = writeln!(text, "  {title}");
        for number in numbers {
            let _ = writeln!(text, "      {number}");
        }
        let _ = writeln!(text, "      {}{why}", if named { "why: " } else { "" });
        if let Some(rivals) = rivals {
            let _ = writeln!(text, "      {rivals}");
        }
        let _ = writeln!(text, "      {}", likeliest(finding).advice());
    }
    text + &ending(trace) + "\n"
}
