//! A calibration as text for a terminal.

use crate::calibration::Calibration;
use crate::compensate::Command;
use crate::dh_form::DhForm;
use crate::errors::Errors;
use crate::identifiability::Identifiability;
use crate::measurements::MeasurementKind;
use crate::parameters::{Parameter, ParameterKind};
use crate::report::contract::Stage;
use crate::solve::Fit;
use denavit_model::Chain;
use std::fmt::Write;

/// Prior and posterior spread are alike when their ratio is above this.
const HELD: f64 = 0.7;

fn table(rows: &[Vec<String>]) -> String {
    let columns = rows.iter().map(Vec::len).max().unwrap_or(0);
    let width = |column: usize| rows.iter().filter_map(|row| row.get(column)).map(|cell| cell.chars().count()).max();
    let widths: Vec<usize> = (0..columns).map(|column| width(column).unwrap_or(0)).collect();
    let mut text = String::new();
    for row in rows {
        let mut line = String::new();
        for (column, cell) in row.iter().enumerate() {
            let gap = " ".repeat(widths[column] - cell.chars().count());
            let padded = if column == 0 { format!("{cell}{gap}") } else { format!("  {gap}{cell}") };
            line.push_str(&padded);
        }
        text.push_str(line.trim_end());
        text.push('\n');
    }
    text
}

fn millimetres(metres: Option<f64>) -> String {
    metres.map_or_else(|| "-".into(), |metres| format!("{:.4}", metres * 1e3))
}

fn cells(errors: Option<&Errors>, kind: MeasurementKind) -> Vec<String> {
    let none = Errors::default();
    let e = errors.unwrap_or(&none);
    let (rms, mean, max) = if kind == MeasurementKind::Distance {
        (e.distance_rms_m, e.distance_mean_m, e.distance_max_m)
    } else {
        (e.position_rms_m, e.position_mean_m, e.position_max_m)
    };
    let mut cells = vec![millimetres(rms), millimetres(mean), millimetres(max)];
    if kind == MeasurementKind::Pose {
        cells.push(millimetres(e.orientation_rms_rad));
    }
    cells
}

/// The before/after table: one line per stage, errors in mm and mrad.
pub fn stages(stages: &[Stage], kind: MeasurementKind) -> String {
    let tested = stages.iter().any(|stage| stage.test.is_some());
    let mut header: Vec<String> = vec!["stage".into()];
    for (part, wanted) in [("train", true), ("test", tested)] {
        if wanted {
            header.extend(["rms", "mean", "max"].map(|word| format!("{part} {word} mm")));
            if kind == MeasurementKind::Pose {
                header.push(format!("{part} rms mrad"));
            }
        }
    }
    let mut rows = vec![header];
    for stage in stages {
        let mut row = vec![stage.name.clone()];
        row.extend(cells(Some(&stage.train), kind));
        if tested {
            row.extend(cells(stage.test.as_ref(), kind));
        }
        rows.push(row);
    }
    table(&rows)
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
    let departure = fit.layout.departure(&fit.arm, &fit.arm);
    let mut rows = vec![["parameter", "change", "std", "unit", ""].map(String::from).to_vec()];
    for index in fit.layout.joints.clone() {
        let parameter = &fit.layout.parameters[index];
        let deviation = fit.covariance[(index, index)].sqrt();
        let held = fit.held_by_prior(index);
        let note = if held > HELD { format!("held by the prior ({:.0} %)", 100.0 * held) } else { String::new() };
        let mut row = vec![parameter.name.clone()];
        row.extend(in_words(parameter, departure[index], deviation));
        row.push(note);
        rows.push(row);
    }
    table(&rows)
}

/// Pairs of parameters of the robot that are correlated more than `above`, the strongest first, `most` at most.
pub fn correlations<E>(fit: &Fit<E>, above: f64, most: usize) -> Vec<(String, String, f64)> {
    let robot = |kind: ParameterKind| crate::identifiability::of_robot(kind);
    let mut pairs = Vec::new();
    for i in 0..fit.layout.len() {
        for k in 0..i {
            let (a, b) = (&fit.layout.parameters[k], &fit.layout.parameters[i]);
            let spread = (fit.covariance[(i, i)] * fit.covariance[(k, k)]).sqrt();
            if robot(a.kind) && robot(b.kind) && spread > 0.0 {
                let correlation = fit.covariance[(i, k)] / spread;
                if correlation.abs() > above {
                    pairs.push((a.name.clone(), b.name.clone(), correlation));
                }
            }
        }
    }
    pairs.sort_by(|a, b| b.2.abs().total_cmp(&a.2.abs()));
    pairs.truncate(most);
    pairs
}

/// The report of `identify`: counts, and what is untold and why.
pub fn identifiability(found: &[Identifiability]) -> String {
    let mut rows = vec![["measured", "count", "", "rank", "weakest"].map(String::from).to_vec()];
    for one in found {
        rows.push(vec![
            crate::errors::kind_word(one.kind).into(),
            one.formula.clone(),
            format!("= {}", one.expected),
            one.rank.to_string(),
            format!("{:.1e}", one.smallest),
        ]);
    }
    let mut text = table(&rows);
    for one in found {
        for untold in &one.untold {
            let kind = crate::errors::kind_word(one.kind);
            let _ = writeln!(text, "{kind}: {} cannot be told: {}", untold.parameter, untold.why);
        }
    }
    text
}

/// The whole calibration for a terminal.
pub fn calibration(result: &Calibration) -> String {
    let report = &result.report;
    let mut text = String::new();
    let samples = &report.samples;
    let _ = writeln!(
        text,
        "{}: {} to {}, {} {} fitted, {} held out",
        report.robot,
        report.base,
        report.tip,
        samples.train,
        crate::errors::kind_word(report.measurement),
        samples.test
    );
    let _ = writeln!(
        text,
        "parameters: {} = {} expected, {} told by the data",
        result.identifiability.formula, report.identifiability.expected, report.identifiability.rank
    );
    for untold in &report.unidentifiable {
        let _ = writeln!(text, "  {} left at nominal: {}", untold.parameter, untold.why);
    }
    if !samples.rejected.is_empty() {
        let lines: Vec<String> = samples.rejected.iter().map(usize::to_string).collect();
        let _ = writeln!(text, "rejected as gross outliers, lines: {}", lines.join(", "));
    }
    text.push('\n');
    text.push_str(&stages(&report.stages, report.measurement));
    text.push('\n');
    let fit = &result.identification.geometric;
    let _ = writeln!(text, "noise left by the geometric stage: {:.4} mm per component", fit.noise.position * 1e3);
    if fit.noise.orientation > 0.0 {
        let _ = writeln!(text, "  and {:.4} mrad per component of orientation", fit.noise.orientation * 1e3);
    }
    if let Some(rounding) = &result.rounding {
        let _ = writeln!(text, "{rounding}");
    }
    text
}

/// The D-H form of a chain: its numbers, how many are too many and where, and what it cannot say.
pub fn dh_form(form: &DhForm, chain: &Chain) -> String {
    let name = |index: usize| chain.joints()[index].name.as_str();
    let mut text = format!(
        "D-H form with full poses: {} numbers, rank {}; {} too many in the base, {} in the tool\n",
        form.numbers, form.rank, form.redundant_in_base, form.redundant_in_tool
    );
    for &first in &form.parallel {
        let _ = writeln!(
            text,
            "  \"{}\" and \"{}\" are parallel neighbours: their d cannot be told apart, and no small change of the row \
             tilts one against the other in the second direction; use the POE form or Hayati's row",
            name(first),
            name(first + 1)
        );
    }
    for &slide in &form.prismatic {
        let _ =
            writeln!(text, "  \"{}\" slides: its axis has no place, so two numbers beside it are free", name(slide));
    }
    text
}

/// Commands as CSV: joint values (rad, m), then what each is expected to miss with and without compensation (m, rad).
pub fn commands(chain: &Chain, commands: &[Command]) -> String {
    let mut header: Vec<&str> = chain.coordinates().iter().map(|coordinate| coordinate.name.as_str()).collect();
    header.extend(["position_error_m", "orientation_error_rad", "uncompensated_m", "uncompensated_rad", "outside"]);
    let mut text = format!("{}\n", header.join(","));
    for command in commands {
        let mut cells: Vec<String> = command.joints.iter().map(f64::to_string).collect();
        let (moved, turned) = command.uncompensated;
        let errors = [command.position_error, command.orientation_error, moved, turned];
        cells.extend(errors.iter().map(|error| format!("{error:.3e}")));
        cells.push(command.outside.join(" "));
        let _ = writeln!(text, "{}", cells.join(","));
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compensate::{Wanted, compensate};
    use crate::dh_form::dh_form as analyse;
    use denavit_model::examples;

    #[test]
    fn parallel_neighbours_are_named() {
        let chain = examples::planar_arm();
        let readings: Vec<Vec<f64>> = (0..20).map(|k| vec![0.3 * f64::from(k), 0.7 * f64::from(k)]).collect();
        let text = dh_form(&analyse(&chain, &readings), &chain);
        assert!(
            text.starts_with("D-H form with full poses: 20 numbers, rank 13; 4 too many in the base, 2 in the tool\n")
        );
        assert!(text.contains("\"joint_1\" and \"joint_2\" are parallel neighbours"), "{text}");
    }

    #[test]
    fn commands_have_a_header_and_a_line_each() {
        let chain = examples::puma_like();
        let wanted = Wanted::Joints(vec![0.1, 0.2, 0.3, 0.4, 0.5, 0.6]);
        let command = compensate(&chain, &chain, &|q| chain.fk(q), &wanted, &[0.0; 6]);
        let text = commands(&chain, &[command]);
        assert_eq!(text.lines().count(), 2);
        assert!(text.lines().last().is_some_and(|line| line.starts_with("0.1,0.2,0.3,0.4,0.5,0.6,")), "{text}");
    }
}
