//! A calibration as text for a terminal.

use crate::apply::plan::tell_apart::Prospect;
use crate::calibration::adoption::Adopted;
use crate::calibration::contract::{CalibrationReport, HeldBy, Stage, TipEntry};
use crate::calibration::{AdoptedFit, Calibration};
use crate::report::axes::axes;
use crate::report::curves::{curves, fields};
use crate::report::findings::findings;
use crate::report::noise as noise_model;
use crate::report::summary::summary;
use crate::report::tables::{Floor, attainable, floor, stages, table};
use crate::report::trust;
use crate::report::zeros::{nearly_all, zeros};
use denavit_identify::averaging::NotAveraged;
use denavit_identify::effects::driver::RUN_ORDER;
use denavit_identify::parameters::Parameter;
use denavit_identify::residual_statistics::{Errors, LengthFound};
use denavit_identify::solve::{DEGREES_FOR_NOISE, Fit};
use denavit_measurements::kinds::Part;
use denavit_measurements::{Measurements, Scene, columns};
use denavit_model::nalgebra::Vector3;
use denavit_trace::Trace;
use std::fmt::Write;

/// Prior and posterior spread are alike when their ratio is above this.
const HELD: f64 = 0.7;

/// Known distances and their residuals.
fn lengths(rows: &str, found: &[LengthFound]) -> String {
    if found.is_empty() {
        return String::new();
    }
    let off: Vec<f64> = found.iter().map(|length| (length.found_m - length.known_m).abs() * 1e3).collect();
    let rms = (off.iter().map(|off| off * off).sum::<f64>() / off.len() as f64).sqrt();
    let most = off.iter().fold(0.0f64, |most, off| most.max(*off));
    format!("known distances, {rows}: {} off by {rms:.4} mm rms, {most:.4} mm at most\n", off.len())
}

/// Value, standard deviation and unit as a person reads them.
fn in_words(parameter: &Parameter, value: f64, deviation: f64) -> [String; 3] {
    let (factor, unit) = match parameter.unit {
        "rad" => (1e3, "mrad"),
        "m" => (1e3, "mm"),
        "m/rad" => (std::f64::consts::TAU * 1e3, "mm/turn"),
        other => (1.0, other),
    };
    [format!("{:.4}", value * factor), format!("{:.4}", deviation * factor), unit.into()]
}

/// Each joint's change of axis with its standard deviation, and what is held by the prior.
pub fn parameters<E>(fit: &Fit<E>) -> String {
    let difference = fit.layout.difference(&fit.arm, &fit.arm);
    let mut rows = vec![["parameter", "change", "std", "unit", ""].map(String::from).to_vec()];
    for index in fit.layout.joints.clone() {
        let parameter = &fit.layout.parameters[index];
        let deviation = fit.covariance[(index, index)].sqrt();
        let held = fit.held_by_prior(index);
        let note = if held > HELD { format!("held by the prior ({:.0} %)", 100.0 * held) } else { String::new() };
        let mut row = vec![parameter.name.clone()];
        row.extend(in_words(parameter, difference[index], deviation));
        row.push(note);
        rows.push(row);
    }
    table(&rows)
}

/// The parameters of the last stage: with effects, where there are some.
pub fn final_parameters(result: &Calibration) -> String {
    match result.fit() {
        AdoptedFit::Geometry(_) => parameters(&result.identification.geometric),
        AdoptedFit::Named(fit) => parameters(fit),
        AdoptedFit::Averaged(fit) => parameters(fit),
    }
}

/// What the error on held-out rows means for an effect that follows time: whether the rows lie between the fitted ones.
fn held_out_in_time(result: &Calibration, trace: &Trace) -> &'static str {
    let follows = |name: &str| name == "time" || name == RUN_ORDER;
    let Some(clock) = trace.findings.iter().find_map(|finding| finding.term.driver.covariate().filter(|n| follows(n)))
    else {
        return "";
    };
    let values = |data: &Measurements| data.covariate(clock).map(|column| column.values.clone()).unwrap_or_default();
    let last = values(&result.train).into_iter().fold(f64::NEG_INFINITY, f64::max);
    match result.test.as_deref().map(values) {
        Some(test) if test.iter().all(|value| *value > last) => {
            "the held-out rows come after the fitted rows: drift is assumed to keep its last value\n"
        }
        Some(test) if !test.is_empty() => {
            "held-out rows lie between fitted rows in time: their error shows how well the drift is interpolated, not the \
             error of a later session\n"
        }
        _ => "",
    }
}

/// Why the last stage with named causes is the result, not the average.
fn not_averaged(result: &Calibration) -> String {
    match &result.averaging {
        Err(NotAveraged::NamedExplainsRejected { values }) => format!(
            "not averaged: this model explains {values} values that geometry alone rejects as gross errors, and an average would leave \
             them out\n"
        ),
        Err(NotAveraged::NamedIsBetter { named, averaged }) => format!(
            "not averaged: with each posture left out in turn, this model errs by {:.4} mm per component, the average by {:.4} mm\n",
            named * 1e3,
            averaged * 1e3
        ),
        _ => String::new(),
    }
}

/// The whole calibration for a terminal.
pub fn calibration(result: &Calibration) -> String {
    let report = &result.report;
    let mut text = trust::supposed(report);
    text.push_str(&summary(result));
    let samples = &report.samples;
    let _ = writeln!(
        text,
        "{}: {} to {}, {} {} fitted, {} held out",
        report.robot,
        report.base,
        report.tip,
        samples.train,
        result.train.scene.words(),
        samples.test
    );
    let _ = writeln!(
        text,
        "parameters: {} = {} expected, {} identifiable from these data",
        result.identifiability.formula, report.identifiability.expected, report.identifiability.rank
    );
    let continued = result.identification.earlier.is_some();
    for unidentifiable in &report.unidentifiable {
        let held = match unidentifiable.held {
            HeldBy::Nominal => "left at nominal",
            HeldBy::Prior if continued => "held near its earlier value by the prior",
            HeldBy::Prior => "held near nominal by the prior",
        };
        let _ = writeln!(text, "  {} {held}: {}", unidentifiable.parameter, unidentifiable.why);
    }
    text.push_str(&trust::redundancy(result));
    if let Some(masses) = &report.masses {
        let _ = writeln!(text, "masses: {}", masses.said());
    }
    if !report.columns.is_empty() {
        let _ = writeln!(text, "columns: {}", columns::in_words(&report.columns));
    }
    text.push_str(&trust::continued(report));
    text.push_str(&trust::suspicious_rows(report));
    text.push_str(&trust::differs(report));
    text.push_str(&nearly_all(report.joint_zeros.as_ref()));
    text.push('\n');
    text.push_str(&stages(&report.stages, &result.train.scene));
    if let Some(last) = report.stages.last() {
        for (rows, found) in [("fitted", &last.train_lengths), ("held out", &last.test_lengths)] {
            text.push_str(&lengths(rows, found));
        }
    }
    text.push_str(&tips(report, &result.train.scene));
    text.push_str(&in_pixels(report, &result.train.scene));
    text.push_str(&upright(result));
    text.push_str(&trust::doubtful_stages(report));
    if let Some(expected) = &report.prediction {
        text.push_str(&expected.in_words());
    }
    text.push_str(&not_averaged(result));
    text.push('\n');
    match &result.trace {
        Some(trace) if matches!(report.adopted, Adopted::Effects | Adopted::Averaged) || trace.findings.is_empty() => {
            text.push_str(&findings(trace));
            if let Some(prospect) = report.prospect.as_ref().and_then(Prospect::in_short) {
                let _ = writeln!(text, "{prospect}");
            }
            text.push_str(held_out_in_time(result, trace));
        }
        _ => {}
    }
    text.push_str(&curves(&report.curves));
    text.push_str(&fields(&report.fields));
    if result.trace.is_none() && result.curves.as_ref().is_some_and(|found| found.fit.effects.curves.is_empty()) {
        text.push_str("no error curve was selected\n");
    }
    let Floor { noise, assumed, .. } = floor(result);
    let scene = &result.train.scene;
    for (channel, (part, level)) in scene.channels.iter().zip(&noise.levels).enumerate() {
        noise_floor(&mut text, scene, channel, part, *level);
    }
    if assumed > 0.0 {
        let _ = writeln!(
            text,
            "  mostly assumed, not measured: {assumed:.0} of the {DEGREES_FOR_NOISE} degrees of freedom that determine the noise \
             are missing; measure more poses"
        );
    }
    for (channel, part) in scene.channels.iter().enumerate().filter(|(_, part)| part.unit == "m") {
        if let Some(attainable) = attainable(result, channel).map(|metres| metres * 1e3) {
            let of = if several_lengths(scene) { format!(" of {}", part.word) } else { String::new() };
            let _ = writeln!(text, "attainable on held-out rows: {attainable:.4} mm rms{of}");
        }
    }
    text.push_str(&noise_model::noise(report.noise.as_ref()));
    text.push_str(&trust::repeats(&report.repeats));
    if let Some(rounding) = &result.rounding {
        let _ = writeln!(text, "{rounding}");
    }
    text
}

/// How far each of several tips is off at the adopted stage, as the stages above.
fn tips(report: &CalibrationReport, scene: &Scene) -> String {
    if report.tips.is_empty() {
        return String::new();
    }
    let of_tip = |tip: &TipEntry| Stage {
        name: format!("{}, {} rows, {} held out", tip.tip, tip.fitted, tip.held_out),
        train: tip.train.clone(),
        test: tip.test.clone(),
        train_lengths: Vec::new(),
        test_lengths: Vec::new(),
        converged: true,
        adopted: true,
        worse_on_held_out: false,
    };
    format!("\nby tip, adopted stage\n{}", stages(&report.tips.iter().map(of_tip).collect::<Vec<_>>(), scene))
}

/// The adopted stage's reprojection error, and the size of a pixel in the table above.
fn in_pixels(report: &CalibrationReport, scene: &Scene) -> String {
    let Some(stage) = report.stages.iter().find(|stage| stage.adopted) else { return String::new() };
    let pixels = |errors: &Errors| {
        let (error, size) = errors.0.iter().find_map(|error| Some((error, error.per_pixel?)))?;
        Some((error.rms / size, error.max / size, size))
    };
    let Some((rms, max, size)) = pixels(&stage.train) else { return String::new() };
    let held_out = stage.test.as_ref().and_then(pixels);
    let held_out =
        held_out.map_or_else(String::new, |(rms, max, _)| format!("; held out {rms:.4} px rms, {max:.4} px at most"));
    let range = scene.range().unwrap_or(1.0);
    format!(
        "reprojection: fitted {rms:.4} px rms, {max:.4} px at most{held_out}\na pixel is {:.4} mm at {range:.3} m, the board's usual distance\n",
        size * 1e3
    )
}

/// The tilt of the base, if sensors measured gravity.
fn upright(result: &Calibration) -> String {
    let fit = result.without_effects();
    let found = fit.layout.levels.iter().enumerate().filter_map(|(setup, column)| Some((setup, (*column)?)));
    let line = |(setup, column): (usize, usize)| {
        let up = fit.arm.instruments[setup].rotation.inverse() * Vector3::z();
        let leans = up.xy().norm().atan2(up.z.abs()).to_degrees();
        let variance = fit.covariance[(column, column)] + fit.covariance[(column + 1, column + 1)];
        let of = if result.train.scene.setups.len() > 2 { &result.train.scene.setups[setup] } else { "gravity" };
        format!(
            "{of}: the base's z axis is {leans:.3}° ± {:.3}° from the vertical\n",
            (variance / 2.0).sqrt().to_degrees()
        )
    };
    found.map(line).collect()
}

fn several_lengths(scene: &Scene) -> bool {
    scene.channels.iter().filter(|part| part.unit == "m").count() > 1
}

fn noise_floor(text: &mut String, scene: &Scene, channel: usize, part: &Part, level: f64) {
    let lead = if channel == 0 { "noise floor: " } else { "  and " };
    if part.unit != "m" {
        let _ = writeln!(text, "{lead}{:.4} mrad per component of {}", level * 1e3, part.word);
        return;
    }
    let of = if several_lengths(scene) { format!(" of {}", part.word) } else { String::new() };
    let norm = level * (part.height as f64).sqrt() * 1e3;
    let of_norm = if part.height == 1 { String::new() } else { format!(", {norm:.4} mm rms of the error's length") };
    let pixels = scene.per_pixel(channel).map_or_else(String::new, |size| format!(" ({:.4} px)", level / size));
    let _ = writeln!(text, "{lead}{:.4} mm{pixels} per component{of}{of_norm}", level * 1e3);
}

/// The whole calibration and the uncertainty of each axis, as `denavit calibrate` prints it.
pub fn report(result: &Calibration) -> String {
    if result.report.zeros().next().is_some() {
        return format!("{}\n{}", calibration(result), zeros(result));
    }
    let axes = match (result.fit(), result.report.adopted) {
        (_, Adopted::Nominal | Adopted::Earlier) => return calibration(result),
        (AdoptedFit::Geometry(_), _) => axes(&result.identification.geometric),
        (AdoptedFit::Named(fit), _) => axes(fit),
        (AdoptedFit::Averaged(fit), _) => axes(fit),
    };
    format!("{}\n{axes}", calibration(result))
}
