//! Error curves of joints as the report has them: entries of the JSON, lines of the text.

use crate::calibration::contract::{CurveEntry, CurvePoint, FieldEntry};
use denavit_identify::effects::curve::Curve;
use denavit_identify::effects::model::{Effect, EffectModel};
use denavit_identify::solve::Fit;
use denavit_measurements::Measurements;
use denavit_model::Screw;
use denavit_trace::infer::deflection::turned;
use denavit_trace::infer::lines::{course, lines};
use std::fmt::Write;

/// Readings in the table of a curve.
const TABLE: usize = 73;

impl CurveEntry {
    /// An entry for each curve of a fit.
    pub fn of_fit(fit: &Fit<EffectModel>, gains: &[f64]) -> Vec<Self> {
        let joints = fit.arm.nominal.joints();
        let entry = |(curve, gain): (&Curve, &f64)| {
            let (low, high) = curve.range;
            let at = |k: usize| low + (high - low) * k as f64 / (TABLE - 1) as f64;
            let point = |at: f64| CurvePoint { at, value: curve.value(at), std: curve.deviation(at) };
            let joint = &joints[curve.joint];
            Self {
                joint: joint.name.clone(),
                unit: if matches!(joint.screw, Screw::Prismatic(_)) { "m" } else { "rad" },
                rms: course(curve).1,
                length: curve.length,
                std_without_data: curve.size,
                log_evidence: *gain,
                lines: lines(curve),
                table: (0..TABLE).map(|k| point(at(k))).collect(),
            }
        };
        fit.effects.curves.iter().zip(gains).map(entry).collect()
    }
}

impl FieldEntry {
    /// An entry for each field: the last effects of a fit.
    pub fn of_fit(data: &Measurements, fit: &Fit<EffectModel>, gains: &[f64]) -> Vec<Self> {
        let effects = &fit.effects.effects;
        let chain = &fit.effects.statics.chain;
        let slides =
            |joint: Option<usize>| joint.is_some_and(|j| matches!(chain.joints()[j].screw, Screw::Prismatic(_)));
        let entry = |(effect, gain): (&Effect, &f64)| Self {
            kind: "gravity",
            joint: effect.term.carrier.place(chain),
            rms: turned(data, fit, effect),
            unit: if slides(effect.term.carrier.joint()) { "m" } else { "rad" },
            log_evidence: *gain,
        };
        effects[effects.len() - gains.len()..].iter().zip(gains).map(entry).collect()
    }
}

/// Deflections of joints under gravity, one line each.
pub fn fields(fields: &[FieldEntry]) -> String {
    let line = |field: &FieldEntry| {
        let (joint, rms, unit) = (&field.joint, field.rms * 1e3, if field.unit == "m" { "mm" } else { "mrad" });
        format!(
            "deflection of joint {joint} under gravity, rms {rms:.3} {unit}: fitted with the curves, no cause claimed\n"
        )
    };
    fields.iter().map(line).collect()
}

/// The error curves, one line each.
pub fn curves(curves: &[CurveEntry]) -> String {
    let mut text = String::new();
    for curve in curves {
        let unit = if curve.unit == "m" { "mm" } else { "mrad" };
        let most = curve.table.iter().map(|point| point.std).fold(0.0, f64::max);
        let _ = write!(
            text,
            "error curve of joint {}, rms {:.3} {unit}, no cause claimed; standard deviation {:.3} {unit} at most",
            curve.joint,
            curve.rms * 1e3,
            most * 1e3
        );
        for line in &curve.lines {
            let share = 100.0 * line.share;
            let _ = write!(text, "; order {:.2}: {:.3} {unit} ({share:.0} %)", line.order, line.amplitude * 1e3);
        }
        text.push('\n');
    }
    text
}
