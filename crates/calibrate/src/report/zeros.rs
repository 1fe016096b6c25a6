//! Zeros of joints as text: what is added to each reading, and which zeros the data do not determine.

use crate::calibration::Calibration;
use crate::calibration::contract::{CalibrationReport, Identified, JointZeros};
use crate::report::tables::table;
use std::fmt::Write;

/// A line for each zero that was fitted.
pub fn zeros(result: &Calibration) -> String {
    let report = &result.report;
    let mut rows = Vec::new();
    let mut undetermined = String::new();
    for zero in report.zeros() {
        if zero.is_determined() {
            let [value, deviation] = in_words(zero);
            rows.push(vec![format!("  {}", zero.joint), value, format!("± {deviation}")]);
        } else {
            rows.push(vec![format!("  {}", zero.joint), "not determined".into(), "as drawn".into()]);
            let _ = writeln!(undetermined, "zero of {}: {}", zero.joint, why_not(report, zero));
        }
    }
    format!("joint zeros, added to the reading ± standard deviation\n{}{undetermined}", table(&rows))
}

/// What hides a zero, and what would show it.
fn why_not(report: &CalibrationReport, zero: &Identified) -> &'static str {
    let known = report.unidentifiable.iter().find(|known| known.parameter == zero.parameter);
    match known.map(|known| known.why.as_str()) {
        Some(why) if why.contains("instrument") => {
            "it has the effect of another pose of the instrument; set it by eye, or turn the base to a mark"
        }
        Some(why) if why.contains("target") => {
            "it has the effect of another pose of the target on the tip; set it by eye, or measure orientations of a target whose pose is known"
        }
        Some(_) => "these rows determine only its sum with other zeros; move the joints between them further",
        None => "these rows hardly determine it; measure more poses in which the joints after it move",
    }
}

/// A zero and its standard deviation, degrees or mm, to the digits that the deviation allows.
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "held between 2 and 6")]
pub(crate) fn in_words(zero: &Identified) -> [String; 2] {
    let (factor, unit) = if zero.unit == "rad" { (1f64.to_degrees(), "°") } else { (1e3, " mm") };
    let (value, deviation) = (zero.change * factor, zero.std * factor);
    let digits = (1.0 - deviation.log10().floor()).clamp(2.0, 6.0) as usize;
    [format!("{value:+.digits$}{unit}"), format!("{deviation:.digits$}{unit}")]
}

/// A line that says that zeros are nearly all that was found, if so.
pub(super) fn nearly_all(found: Option<&JointZeros>) -> String {
    let Some(found) = found else { return String::new() };
    let listed = found.zeros.iter().filter(|zero| zero.is_determined()).map(|zero| {
        let [value, deviation] = in_words(zero);
        format!("{} {value} ± {deviation}", zero.joint)
    });
    format!(
        "joint zeros alone explain {:.1} % of what fitted axes explain ({}); ‹zeros› fits them and leaves the axes as drawn\n",
        100.0 * found.share,
        listed.collect::<Vec<_>>().join(", ")
    )
}
