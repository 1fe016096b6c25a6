//! Zeros of joints as text: what is added to each reading, and which the data do not tell.

use crate::calibration::Calibration;
use crate::calibration::contract::{CalibrationReport, Identified, JointZeros};
use crate::report::tables::table;
use std::fmt::Write;

/// A line for each zero that was fitted.
pub fn zeros(result: &Calibration) -> String {
    let report = &result.report;
    let mut rows = Vec::new();
    let mut not_told = String::new();
    for zero in report.zeros() {
        if zero.is_told() {
            let [value, deviation] = in_words(zero);
            rows.push(vec![format!("  {}", zero.joint), value, format!("± {deviation}")]);
        } else {
            rows.push(vec![format!("  {}", zero.joint), "not told".into(), "as drawn".into()]);
            let _ = writeln!(not_told, "zero of {}: {}", zero.joint, why_not(report, zero));
        }
    }
    format!("joint zeros, added to the reading ± standard deviation\n{}{not_told}", table(&rows))
}

/// What hides a zero, and what would show it.
fn why_not(report: &CalibrationReport, zero: &Identified) -> &'static str {
    let known = report.unidentifiable.iter().find(|known| known.parameter == zero.parameter);
    match known.map(|known| known.why.as_str()) {
        Some(why) if why.contains("instrument") => {
            "it looks as if the instrument stood elsewhere; set it by eye, or turn the base to a mark"
        }
        Some(why) if why.contains("target") => {
            "it looks as if the target sat elsewhere on the tip; set it by eye, or measure orientations of a target whose place is known"
        }
        Some(_) => "these rows show only its sum with others that are not told; move the joints between them further",
        None => "these rows hardly show it; measure more poses in which the joints behind it move",
    }
}

/// A zero and its standard deviation, degrees or mm, to the digits that the deviation leaves.
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "held between 2 and 6")]
pub(crate) fn in_words(zero: &Identified) -> [String; 2] {
    let (factor, unit) = if zero.unit == "rad" { (1f64.to_degrees(), "°") } else { (1e3, " mm") };
    let (value, deviation) = (zero.change * factor, zero.std * factor);
    let digits = (1.0 - deviation.log10().floor()).clamp(2.0, 6.0) as usize;
    [format!("{value:+.digits$}{unit}"), format!("{deviation:.digits$}{unit}")]
}

/// That zeros are nearly all that was found, where they are.
pub(super) fn nearly_all(found: Option<&JointZeros>) -> String {
    let Some(found) = found else { return String::new() };
    let listed = found.zeros.iter().filter(|zero| zero.is_told()).map(|zero| {
        let [value, deviation] = in_words(zero);
        format!("{} {value} ± {deviation}", zero.joint)
    });
    format!(
        "joint zeros alone explain {:.1} % of what the axes do ({}); ‹zeros› fits them and leaves the axes as drawn\n",
        100.0 * found.share,
        listed.collect::<Vec<_>>().join(", ")
    )
}
