//! How far a calibration is to be trusted, as text: redundancy, suspicious rows, what is not the drawing's, what was not
//! adopted.

use crate::calibration::Calibration;
use crate::calibration::contract::{CalibrationReport, FileUse};
use denavit_identify::carried::{CarriedPart, PartState};
use denavit_identify::lack_of_fit::LackOfFit;
use denavit_measurements::Scene;
use std::fmt::Write;

/// Below this many degrees of freedom a standard deviation is off by more than a fifth (1/√(2·10)) as a rule.
const FEW: f64 = 10.0;
/// No more lines are listed.
const LISTED: usize = 30;

/// Numbers measured beside numbers found, and what few of them mean.
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
            "  few: the prior keeps what so few numbers cannot determine; intervals of 95 % are {factor:.2} standard deviations \
             to either side"
        );
    }
    if size_is_unseen(&result.train.scene) {
        let _ = writeln!(
            text,
            "  size: nothing that was measured has a length, so the size of the robot is that of its drawing, held by the \
             tolerances alone; measure how far two of the points are apart and add it: ‹distance› LABEL,LABEL=50mm"
        );
    }
    if !counted.enough_for_effects && counted.degrees_of_freedom >= 2 * counted.parameters {
        text.push_str(
            "  effects are not looked for: both tips of a touch have one error, and the search would count it twice\n",
        );
    } else if !counted.enough_for_effects {
        let _ = writeln!(
            text,
            "  too few to look for effects: with {} parameters chance makes some up below {} degrees of freedom",
            counted.parameters,
            2 * counted.parameters
        );
    }
    text
}

/// Whether a robot twice as large would explain the rows as well: they say only that points stay where they are.
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
        0.0 => "does not count, for these rows contradict it".into(),
        weight => format!("counts for {:.1} %, for these rows contradict the rest", 100.0 * weight),
    };
    let mut text =
        format!("prior: what {name} says of the axes {counted}; stage \"earlier\" is that robot on these rows\n");
    let named = |part: &CarriedPart| match part.kind {
        "error_curve" => format!("the error curve of {}", part.place),
        "gravity" => format!("what {} gives under gravity", part.place),
        kind => format!("{kind} at {}", part.place),
    };
    let in_state = |state: PartState| earlier.effects.iter().filter(move |part| part.state == state);
    let kept = in_state(PartState::Kept).count();
    if !earlier.effects.is_empty() {
        let all = earlier.effects.len();
        let _ = writeln!(text, "  of its {all} effects and error curves {kept} are carried over");
    }
    let reasons = [
        (PartState::Contradicted, "these rows speak against it: something there is no longer as it was"),
        (PartState::OfThatRun, "it was a drift of the earlier run"),
        (PartState::OfThatSetup, "it was of the instrument or the target, which are placed anew"),
        (PartState::NoColumn, "it follows a column that these rows do not have"),
    ];
    for (state, why) in reasons {
        for part in in_state(state) {
            let column = part.column.as_ref().map_or_else(String::new, |column| format!(", \"{column}\""));
            let _ = writeln!(text, "  left out: {}, for {why}{column}", named(part));
        }
    }
    text
}

/// What was supposed of the data, before anything else is said: it is to be confirmed or corrected by whoever measured.
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
            "ATTENTION: of the measured {}, which varies by {:.3} {unit} rms, {:.3} {unit} are left ({:.0} % of its variance is \
             explained); is this the robot that was measured, do values and readings belong together, are all units right?",
            part.of,
            part.spread * 1e3,
            part.left * 1e3,
            100.0 * part.share().max(0.0)
        );
    }
    text
}

/// Lines of rows that were left out, or that look as if they should be.
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
            "held-out rows that are far off, and counted all the same, lines: {}",
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
        "DIFFERS FROM THE DRAWING by far more than links are made to; is it another variant of this robot?\n",
    );
    for difference in &report.differs_from_drawing {
        let (factor, unit) = match difference.unit {
            "rad" => (1e3, "mrad"),
            "m" => (1e3, "mm"),
            other => (1.0, other),
        };
        let _ = writeln!(
            text,
            "  {} {:.2} {unit}, {:.0} tolerances, seen from the axes before it",
            difference.parameter,
            difference.value * factor,
            difference.tolerances
        );
    }
    text
}

/// What held-out rows say against the stage that was adopted, and stages that did not converge.
pub(super) fn doubtful_stages(report: &CalibrationReport) -> String {
    let mut text = String::new();
    for (before, stage) in report.stages.iter().zip(report.stages.iter().skip(1)) {
        if stage.worse_on_held_out && stage.adopted {
            let _ = writeln!(
                text,
                "\"{}\" makes the held-out rows worse than \"{}\", by more than chance; it stays the result, because held-out rows judge and \
                 choose no stage: fit some rows like them, too",
                stage.name, before.name
            );
        } else if !stage.converged {
            let _ = writeln!(text, "\"{}\" did not converge: do not use its errors", stage.name);
        }
    }
    text
}

/// A model without lack of fit gives such a result once in this many files.
const LACK_OF_FIT: f64 = 0.001;

/// What postures that were measured again say.
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
            format!("the model misses {:.4} {unit} beside it", repeat.missed * factor)
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
