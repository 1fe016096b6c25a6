//! Tables of text: aligned columns, the errors of all stages, correlations and the noise floor.

use crate::calibration::Calibration;
use crate::calibration::contract::Stage;
use denavit_identify::parameters::ParameterKind;
use denavit_identify::residual_statistics::Errors;
use denavit_identify::solve::{Fit, Noise};
use denavit_measurements::Scene;
use denavit_measurements::kinds::Part;

/// Rows in columns as wide as they must be; the first aligned left, the others right.
pub(super) fn table(rows: &[Vec<String>]) -> String {
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

/// Root mean square, mean and largest of a length; only the root mean square of an angle in the same table.
fn cells(errors: Option<&Errors>, of: [Option<&Part>; 2]) -> Vec<String> {
    let error = |part: &Part| errors.and_then(|errors| errors.of(part.word));
    let mut cells = Vec::new();
    if let Some(length) = of[0] {
        let error = error(length);
        cells.extend([error.map(|e| e.rms), error.map(|e| e.mean), error.map(|e| e.max)].map(millimetres));
    }
    if let Some(angle) = of[1] {
        cells.push(millimetres(error(angle).map(|e| e.rms)));
    }
    cells
}

/// The before/after table: one line per stage, errors in mm and mrad; a table for each quantity with lengths, and for each angle without
/// one.
pub fn stages(stages: &[Stage], scene: &Scene) -> String {
    let lengths: Vec<&Part> = scene.channels.iter().filter(|part| part.unit == "m").collect();
    let angles: Vec<&Part> = scene.channels.iter().filter(|part| part.unit != "m").collect();
    let angle = angles.iter().copied().find(|part| part.word == "orientation");
    let tables = lengths.iter().enumerate().map(|(index, length)| {
        let title = if lengths.len() > 1 { format!("{} in mm", length.word) } else { "errors in mm".into() };
        one_table(stages, title, [Some(length), angle.filter(|_| index == 0)])
    });
    let beside = angles.iter().copied().filter(|part| angle != Some(*part));
    let tables =
        tables.chain(beside.map(|part| one_table(stages, format!("{} in mrad", part.word), [Some(part), None])));
    tables.collect::<Vec<String>>().join("\n")
}

fn one_table(stages: &[Stage], title: String, of: [Option<&Part>; 2]) -> String {
    let tested = stages.iter().any(|stage| stage.test.is_some());
    let mut header: Vec<String> = vec![title];
    for (part, wanted) in [("train", true), ("test", tested)] {
        if wanted {
            header.extend([format!("{part} rms"), "mean".into(), "max".into()]);
            header.extend(of[1].map(|_| "rms, mrad".into()));
        }
    }
    let mut rows = vec![header];
    for stage in stages {
        let mut row = vec![short_name(&stage.name)];
        row.extend(cells(Some(&stage.train), of));
        if tested {
            row.extend(cells(stage.test.as_ref(), of));
        }
        rows.push(row);
    }
    table(&rows)
}

/// A stage's name if it is short; else with the number of its effects, which are listed below the table.
pub(super) fn short_name(name: &str) -> String {
    const WIDEST: usize = 30;
    let parts: Vec<&str> = name.split(" + ").collect();
    let effects = parts.iter().filter(|part| part.contains('(')).count();
    if name.chars().count() <= WIDEST || effects == 0 {
        return name.to_owned();
    }
    let others = parts[1..].iter().filter(|part| !part.contains('(')).map(|part| format!(" + {part}"));
    let plural = if effects == 1 { "" } else { "s" };
    format!("{} + {effects} effect{plural}{}", parts[0], others.collect::<String>())
}

/// Pairs of parameters of the robot that are correlated more than `above`, the strongest first, `most` at most.
pub fn correlations<E>(fit: &Fit<E>, above: f64, most: usize) -> Vec<(String, String, f64)> {
    let robot = |kind: ParameterKind| denavit_identify::identifiability::of_robot(kind);
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

/// The noise of the adopted stage, and its degrees of freedom.
pub(super) struct Floor<'a> {
    pub noise: &'a Noise,
    pub parameters: &'a [f64],
    pub values: &'a [f64],
    /// Degrees of freedom that were assumed.
    pub assumed: f64,
}

pub(super) fn floor(result: &Calibration) -> Floor<'_> {
    fn of<E>(fit: &Fit<E>) -> Floor<'_> {
        Floor {
            noise: &fit.noise,
            parameters: &fit.parameters_used,
            values: &fit.values,
            assumed: fit.assumed_degrees(),
        }
    }
    result.named().map_or_else(|| of(&result.identification.geometric), of)
}

/// Root mean square error of new rows that noise and the number of fitted rows allow, in the channel's unit; `None` without
/// values of the channel.
pub(super) fn attainable(result: &Calibration, channel: usize) -> Option<f64> {
    let Floor { noise, parameters, values, .. } = floor(result);
    let height = result.train.scene.channels[channel].height as f64;
    (values[channel] > 0.0)
        .then(|| noise.levels[channel] * height.sqrt() * (1.0 + parameters[channel] / values[channel]).sqrt())
}
