//! How far each axis is from its drawing, as text: standard deviations, poorly identified parameters, strong correlations.

use crate::report::tables::{correlations, table};
use denavit_identify::parameters::ParameterKind;
use denavit_identify::solve::Fit;
use std::f64::consts::TAU;
use std::fmt::Write;

/// A parameter whose spread is more than this share of the prior's is poorly identified.
const WEAK: f64 = 0.5;
/// Correlations above this are strong.
const STRONG: f64 = 0.9;
/// Number of pairs listed.
const LISTED: usize = 5;

/// One line per joint: how far its axis is turned and moved, with standard deviations; then the poorly identified and the
/// correlated parameters.
pub fn axes<E>(fit: &Fit<E>) -> String {
    let difference = fit.layout.difference(&fit.arm, &fit.arm);
    let joints = &fit.arm.nominal.joints();
    let mut rows: Vec<Vec<String>> = Vec::new();
    for (joint, of) in joints.iter().enumerate() {
        let mut row = vec![format!("  {}", of.name)];
        for index in fit.layout.joints.clone() {
            let parameter = &fit.layout.parameters[index];
            if parameter.kind.joint() != Some(joint) {
                continue;
            }
            let deviation = fit.covariance[(index, index)].max(0.0).sqrt();
            let word = parameter.name.rsplit_once('.').map_or(parameter.name.as_str(), |(_, word)| word);
            let (factor, unit) = match parameter.kind {
                ParameterKind::Pitch { .. } => (TAU * 1e3, " mm/turn"),
                ParameterKind::Scale { .. } => (1e6, " ppm"),
                _ => (1e3, ""),
            };
            let shown = format!("{word} {:.3} ± {:.3}{unit}", difference[index] * factor, deviation * factor);
            row.push(shown);
        }
        if row.len() == 1 {
            row.push("as drawn".into());
        }
        rows.push(row);
    }
    let mut text = String::from("axes, change from the drawing ± standard deviation: turns in mrad, moves in mm\n");
    text.push_str(&table(&rows));
    let weak: Vec<String> = fit
        .layout
        .joints
        .clone()
        .map(|index| (fit.held_by_prior(index), &fit.layout.parameters[index].name))
        .filter(|(held, _)| *held > WEAK)
        .map(|(held, name)| format!("{name} ({:.0} %)", 100.0 * held))
        .collect();
    if !weak.is_empty() {
        let by = if fit.layout.prior.is_of_drawing() { "the drawing" } else { "their earlier values" };
        let _ = writeln!(text, "poorly identified, kept near {by} by the prior: {}", weak.join(", "));
    }
    // As printed, ties by name: where two parameters are one in the common frame, only rounding orders their pairs.
    let printed = |pair: &(String, String, f64)| (pair.2.abs() * -100.0).round();
    let mut strong = correlations(fit, STRONG, usize::MAX);
    strong.sort_by(|a, b| printed(a).total_cmp(&printed(b)).then_with(|| (&a.0, &a.1).cmp(&(&b.0, &b.1))));
    strong.truncate(LISTED);
    if !strong.is_empty() {
        text.push_str("parameters that these data hardly distinguish, strongest correlations\n");
        let pair = |(a, b, value): &(String, String, f64)| vec![format!("  {a}"), b.clone(), format!("{value:.2}")];
        text.push_str(&table(&strong.iter().map(pair).collect::<Vec<_>>()));
    }
    text
}
