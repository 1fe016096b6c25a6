//! The first lines of a report: how good the robot is now, what causes its error, what to do next.

use crate::calibration::Calibration;
use crate::calibration::adoption::Adopted;
use crate::report::findings;
use crate::report::tables::attainable;
use std::fmt::Write;

/// An error up to this many times what the noise allows is at the noise floor: rms of some dozen rows scatter as much.
const AT_THE_FLOOR: f64 = 1.15;

/// Effects that are listed by name; of more, the number is given.
const LISTED: usize = 3;

/// Error, cause and next step, a line each; of a length where there is one.
pub(super) fn summary(result: &Calibration) -> String {
    let stages = &result.report.stages;
    let scene = &result.train.scene;
    let mut parts = scene.channels.iter().enumerate();
    let found = parts.clone().find(|(_, part)| part.unit == "m").or_else(|| parts.next());
    let (Some((channel, part)), Some(adopted)) = (found, stages.iter().find(|stage| stage.adopted)) else {
        return String::new();
    };
    let rms = |stage: &crate::calibration::contract::Stage| {
        stage.test.as_ref().unwrap_or(&stage.train).of(part.word).map(|error| error.rms * 1e3)
    };
    let Some(error) = rms(adopted) else { return String::new() };
    let unit = if part.unit == "m" { "mm" } else { "mrad" };
    let rows = if adopted.test.is_some() { "held-out" } else { "training" };
    let mut text = format!("result: {rows} error {error:.4} {unit} rms");
    if let Some(drawn) = stages.first().filter(|first| first.name != adopted.name).and_then(rms) {
        let _ = write!(text, "; as drawn {drawn:.4} {unit}");
    }
    if let Some(floor) = attainable(result, channel).map(|floor| floor * 1e3) {
        let at = if error <= AT_THE_FLOOR * floor { "; at the noise floor, " } else { "; noise floor " };
        let _ = write!(text, "{at}{floor:.4} {unit}");
    }
    text.push('\n');
    text.push_str(&cause(result));
    text
}

/// What causes the error, and what to do about what is not explained.
fn cause(result: &Calibration) -> String {
    let Some(trace) = result.trace.as_ref() else { return String::new() };
    if !matches!(result.report.adopted, Adopted::Effects | Adopted::Averaged) && !trace.findings.is_empty() {
        return "cause: uncertain; no effect improves the prediction\n".into();
    }
    let mut named: Vec<String> = trace
        .findings
        .iter()
        .filter(|finding| finding.named)
        .map(|finding| format!("{} at {}", finding.term.kind.name(), finding.place))
        .collect();
    let unnamed = trace.findings.len() - named.len();
    // One that follows two columns is named once.
    named.dedup();
    let mut text = match (named.len(), unnamed) {
        (0, 0) => "cause: geometry; no effect beyond it".to_owned(),
        (0, _) => format!("cause: uncertain; {unnamed} possible effects are included in the model"),
        (all, _) => {
            let listed = named[..all.min(LISTED)].join(", ");
            let more = if all > LISTED { format!(" and {} more", all - LISTED) } else { String::new() };
            format!("cause: {listed}{more}")
        }
    };
    text.push('\n');
    if let Some(structure) = findings::structure(trace) {
        let _ = writeln!(
            text,
            "next: unexplained structure remains, {structure}; record more columns or measure more rows"
        );
    } else if unnamed > 0 {
        text.push_str("next: measure poses that distinguish the possible causes (denavit plan)\n");
    }
    text
}
