//! How far a calibration can be trusted, as text: redundancy, suspicious rows, differences from the drawing, doubtful stages.

use super::tables::short_name;
use crate::calibration::Calibration;
use crate::calibration::contract::{CalibrationReport, FileUse};
use denavit_identify::carried::{CarriedPart, PartState};
use denavit_identify::lack_of_fit::LackOfFit;
use denavit_measurements::Scene;
use std::fmt::Write;

/// Below this many degrees of freedom a standard deviation is off by more than a fifth (1/√(2·10)) as a rule.
const FEW: f64 = 10.0;
/// Number of lines listed.
const LISTED: usize = 30;

/// Measured numbers and degrees of freedom, and what it means if there are few.
pub(super) fn redundancy(result: &Calibration) -> String {
    let counted = &result.report.redundancy;
    let mut text = format!(
        "redundancy: {} numbers in {} postures, {} degrees of freedom\n",
        counted.values, counted.postures, counted.degrees_of_freedom
    );
    let fit = &result.identification.geometric;
    if (counted.degrees_of_freedom as f64) < FEW {
        let joint = fit.layout.joints.start;
        let factor =
            if fit.deviation(joint) > 0.0 { fit.half_interval(joint, 0.95) / fit.deviation(joint) } else { 2.0 };
        let _ = writeln!(
            text,
            "  few degrees of freedom: the prior determines the rest, and a 95 % interval is ± {factor:.2} standard deviations"
        );
    }
    if size_is_unseen(&result.train.scene) {
        let _ = writeln!(
            text,
            "  size: the measurements contain no length, so only the drawing and its tolerances determine the robot's size; \
             measure the distance between two of the points and add it: ‹distance› LABEL,LABEL=50mm"
        );
    }
    if !counted.enough_for_effects && counted.degrees_of_freedom >= 2 * counted.parameters {
        text.push_str(
            "  no search for effects: the two tips of a touch share one error, which the search would count twice\n",
        );
    } else if !counted.enough_for_effects {
        let _ = writeln!(
            text,
            "  too few to search for effects: with {} parameters and below {} degrees of freedom, chance looks like effects",
            counted.parameters,
            2 * counted.parameters
        );
    }
    text
}

/// Whether a robot twice as large would explain the rows as well: they say only that points do not move.
fn size_is_unseen(scene: &Scene) -> bool {
    scene.lengths.is_empty() && scene.series.iter().all(|series| series.kind.numbers() == 0)
}

/// How much an earlier calibration counts.
pub(super) fn continued(report: &CalibrationReport) -> String {
    let Some(earlier) = &report.earlier else { return String::new() };
    let file = report.origin.files.iter().find(|file| file.used == FileUse::Prior);
    let name = file.map_or("the earlier calibration", |file| &file.file);
    let counted = match earlier.weight {
        1.0 => "counts in full".into(),
        0.0 => "does not count, as these rows contradict it".into(),
        weight => format!("counts for {:.1} %, as these rows contradict the rest", 100.0 * weight),
    };
    let mut text =
        format!("prior: the axis estimate of {name} {counted}; stage \"earlier\" is that robot on these rows\n");
    let named = |part: &CarriedPart| match part.kind {
        "error_curve" => format!("the error curve of {}", part.place),
        "gravity" => format!("the deflection of {} under gravity", part.place),
        kind => format!("{kind} at {}", part.place),
    };
    let in_state = |state: PartState| earlier.effects.iter().filter(move |part| part.state == state);
    let kept = in_state(PartState::Kept).count();
    if !earlier.effects.is_empty() {
        let all = earlier.effects.len();
        let _ = writeln!(text, "  {kept} of its {all} effects and error curves are carried over");
    }
    let reasons = [
        (PartState::Contradicted, "these rows contradict it: something has changed there"),
        (PartState::OfThatRun, "it was a drift of the earlier run"),
        (PartState::OfThatSetup, "it belonged to the instrument or the target, which have new places"),
        (PartState::NoColumn, "it follows a column that these rows do not have"),
    ];
    for (state, why) in reasons {
        for part in in_state(state) {
            let column = part.column.as_ref().map_or_else(String::new, |column| format!(", \"{column}\""));
            let _ = writeln!(text, "  left out: {}, as {why}{column}", named(part));
        }
    }
    text
}

/// Assumptions about the data, at the head of the report: the user has to confirm or correct them.
pub(super) fn supposed(report: &CalibrationReport) -> String {
    let mut text = String::new();
    if let Some(read_as) = &report.read_as {
        let _ = writeln!(text, "ATTENTION: these data do not fit this robot as they are written; {}", read_as.said);
    }
    if let Some(loads) = &report.undeclared_loads {
        let _ = writeln!(text, "ATTENTION: {}", loads.said());
    }
    if let Some(anew) = &report.placed_anew {
        let _ = writeln!(text, "ATTENTION: {}", anew.said());
    }
    for part in &report.poorly_explained {
        let unit = if part.unit == "m" { "mm" } else { "mrad" };
        let _ = writeln!(
            text,
            "ATTENTION: the measured {} varies by {:.3} {unit} rms, and {:.3} {unit} remain as residual ({:.0} % of its variance is \
             explained); is this the robot that was measured, do values and readings belong together, are all units right?",
            part.of,
            part.spread * 1e3,
            part.left * 1e3,
            100.0 * part.share().max(0.0)
        );
    }
    text
}

/// Lines of rows that were left out, or that are suspicious.
pub(super) fn suspicious_rows(report: &CalibrationReport) -> String {
    let mut text = String::new();
    let samples = &report.samples;
    let listed = |lines: &[usize]| {
        let shown: Vec<String> = lines.iter().take(LISTED).map(usize::to_string).collect();
        let more = if lines.len() > LISTED { format!(" and {} more", lines.len() - LISTED) } else { String::new() };
        format!("{}{more}", shown.join(", "))
    };
    if !samples.stale.is_empty() {
        let _ = writeln!(
            text,
            "left out: the same measured values as in the row before, although joints moved, lines: {}",
            listed(&samples.stale)
        );
    }
    if !samples.copies.is_empty() {
        let _ = writeln!(
            text,
            "{} rows are exact copies of earlier ones and counted once, lines: {}",
            samples.copies.len(),
            listed(&samples.copies)
        );
    }
    if !samples.test_copies.is_empty() {
        let _ = writeln!(
            text,
            "{} test rows are exact copies of others or of fitted rows and left out of the test, lines: {}",
            samples.test_copies.len(),
            listed(&samples.test_copies)
        );
    }
    if !samples.rejected.is_empty() {
        let _ = writeln!(text, "rejected as gross outliers, lines: {}", listed(&samples.rejected));
    }
    if !samples.test_outliers.is_empty() {
        let _ = writeln!(
            text,
            "held-out rows with gross errors, counted nevertheless, lines: {}",
            listed(&samples.test_outliers)
        );
    }
    text
}

/// Axes that are many tolerances from their place.
pub(super) fn differs(report: &CalibrationReport) -> String {
    let mut text = String::new();
    if report.differs_from_drawing.is_empty() {
        return text;
    }
    text.push_str(
        "DIFFERS FROM THE DRAWING by far more than manufacturing tolerances; is it another variant of this robot?\n",
    );
    for difference in &report.differs_from_drawing {
        let (factor, unit) = match difference.unit {
            "rad" => (1e3, "mrad"),
            "m" => (1e3, "mm"),
            other => (1.0, other),
        };
        let _ = writeln!(
            text,
            "  {} {:.2} {unit}, {:.0} tolerances, relative to the axes before it",
            difference.parameter,
            difference.value * factor,
            difference.tolerances
        );
    }
    text
}

/// Held-out rows that contradict the adopted stage, and stages that did not converge.
pub(super) fn doubtful_stages(report: &CalibrationReport) -> String {
    let mut text = String::new();
    for (before, stage) in report.stages.iter().zip(report.stages.iter().skip(1)) {
        if stage.worse_on_held_out && stage.adopted {
            let _ = writeln!(
                text,
                "\"{}\" predicts the held-out rows worse than \"{}\", by more than chance; it remains the result, because held-out rows test \
                 stages but do not choose one: fit some rows like them, too",
                short_name(&stage.name),
                short_name(&before.name)
            );
        } else if !stage.converged {
            let _ = writeln!(text, "\"{}\" did not converge: do not use its errors", short_name(&stage.name));
        }
    }
    text
}

/// Significance level of the lack-of-fit test.
const LACK_OF_FIT: f64 = 0.001;

/// Pure error and lack of fit from repeated postures.
pub(super) fn repeats(repeats: &[LackOfFit]) -> String {
    let mut text = String::new();
    for repeat in repeats {
        let (factor, unit) = if repeat.unit == "rad" { (1e3, "mrad") } else { (1e3, "mm") };
        let _ = writeln!(
            text,
            "{} postures measured again ({} {}s): repeats differ by {:.4} {unit} per component, the pure error",
            repeat.postures,
            repeat.observations,
            repeat.of,
            repeat.pure_error * factor
        );
        let ratio = repeat.f.map_or_else(|| "repeats are equal".into(), |f| format!("F = {f:.1}"));
        let verdict = if repeat.p_value < LACK_OF_FIT {
            format!("lack of fit: {:.4} {unit} beyond the pure error", repeat.missed * factor)
        } else {
            "no lack of fit".into()
        };
        let _ = writeln!(
            text,
            "  {verdict} ({ratio} with {} and {} degrees of freedom, p {:.1e})",
            repeat.missed_degrees, repeat.pure_degrees, repeat.p_value
        );
    }
    text
}
