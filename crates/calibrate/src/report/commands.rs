//! Compensated joint commands as text, CSV and JSON.

use crate::apply::compensate::{Allowed, Command};
use denavit_measurements::Units;
use denavit_model::Chain;
use serde_json::{Map, Value, json};
use std::fmt::Write;

/// Version of the JSON.
pub const SCHEMA: &str = "denavit.commands/1";

/// The expected error of the commands that reach their poses, and the rows of `lines` that do not or that leave the limits.
pub fn summary(commands: &[Command], lines: &[usize], allowed: Allowed) -> String {
    let reached: Vec<&Command> = commands.iter().filter(|command| allowed.reached_by(command)).collect();
    let mut text = format!("{} of {} poses reached", reached.len(), commands.len());
    if !reached.is_empty() {
        let rms = |of: fn(&Command) -> f64| {
            (reached.iter().map(|command| of(command).powi(2)).sum::<f64>() / reached.len() as f64).sqrt() * 1e3
        };
        let most = |of: fn(&Command) -> f64| reached.iter().map(|command| of(command)).fold(0.0, f64::max) * 1e3;
        let (before, after) = (|command: &Command| command.uncompensated.0, |command: &Command| command.position_error);
        let _ = write!(
            text,
            "; expected error, mm: {:.4} rms, {:.4} at most (nominal commands: {:.4} rms, {:.4} at most)",
            rms(after),
            most(after),
            rms(before),
            most(before)
        );
    }
    text.push('\n');
    for (command, line) in commands.iter().zip(lines) {
        if allowed.reached_by(command) && !command.keeps_configuration {
            let _ = writeln!(
                text,
                "line {line}: the arm changes its configuration; no solution in the previous one was found for this pose"
            );
        }
        if !allowed.reached_by(command) {
            let _ = writeln!(
                text,
                "line {line}: out of reach; the nearest is {:.4} mm and {:.4} mrad away",
                command.position_error * 1e3,
                command.orientation_error * 1e3
            );
        }
        if !command.outside.is_empty() {
            let _ = writeln!(text, "line {line}: outside of the limits of {}", command.outside.join(", "));
        }
    }
    text
}

/// Commands as CSV: `comments`, then joint values and the expected errors with and without compensation, in
/// `units`, which the columns name.
pub fn to_csv(chain: &Chain, commands: &[Command], allowed: Allowed, units: Units, comments: &str) -> String {
    let mut text = String::new();
    for line in comments.lines() {
        let _ = writeln!(text, "# {line}");
    }
    let _ = writeln!(text, "# units: {units}");
    let [length, angle] = units.words();
    let mut header: Vec<String> = chain.coordinates().iter().map(|coordinate| coordinate.name.clone()).collect();
    header.extend([
        format!("position_error_{length}"),
        format!("orientation_error_{angle}"),
        format!("uncompensated_{length}"),
        format!("uncompensated_{angle}"),
        "state".to_owned(),
    ]);
    let _ = writeln!(text, "{}", header.join(","));
    for command in commands {
        let joints = chain.coordinates().iter().zip(&command.joints);
        let mut cells: Vec<String> = joints.map(|(joint, value)| format!("{:.9}", value / units.of(joint))).collect();
        let (moved, turned) = command.uncompensated;
        let errors = [
            command.position_error / units.length,
            command.orientation_error / units.angle,
            moved / units.length,
            turned / units.angle,
        ];
        cells.extend(errors.iter().map(|error| format!("{error:.9}")));
        cells.push(state(command, allowed).into());
        let _ = writeln!(text, "{}", cells.join(","));
    }
    text
}

fn state(command: &Command, allowed: Allowed) -> &'static str {
    match (allowed.reached_by(command), command.outside.is_empty()) {
        (true, true) => "reached",
        (true, false) => "outside of limits",
        (false, _) => "out of reach",
    }
}

/// Commands as JSON; `lines`: those of the wanted poses in their file.
pub fn to_json(chain: &Chain, commands: &[Command], lines: &[usize], allowed: Allowed) -> String {
    let named = |values: &[f64]| -> Map<String, Value> {
        chain.coordinates().iter().zip(values).map(|(joint, value)| (joint.name.clone(), json!(value))).collect()
    };
    let entry = |(command, line): (&Command, &usize)| {
        json!({
            "line": line,
            "state": state(command, allowed),
            "joints": named(&command.joints),
            "nominal": named(&command.nominal),
            "position_error_m": command.position_error,
            "orientation_error_rad": command.orientation_error,
            "uncompensated_m": command.uncompensated.0,
            "uncompensated_rad": command.uncompensated.1,
            "outside": command.outside,
            "keeps_configuration": command.keeps_configuration,
        })
    };
    let value = json!({
        "schema": SCHEMA,
        "robot": chain.name(),
        "base": chain.base(),
        "tip": chain.tip(),
        "allowed": {"position_m": allowed.position, "orientation_rad": allowed.orientation},
        "commands": commands.iter().zip(lines).map(entry).collect::<Vec<_>>(),
    });
    serde_json::to_string_pretty(&value).expect("names are texts and numbers are numbers") + "\n"
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::apply::compensate::{Wanted, compensate};
    use denavit_ik::Solver;
    use denavit_model::examples;

    #[test]
    fn commands_have_a_header_and_a_line_each() {
        let chain = examples::puma_like();
        let wanted = Wanted::Joints(vec![0.1, 0.2, 0.3, 0.4, 0.5, 0.6]);
        let command = compensate(&Solver::new(&chain), &chain, &|q| chain.fk(q), &wanted, &[0.0; 6]);
        let text =
            to_csv(&chain, &[command], Allowed { position: 1e-6, orientation: 1e-6 }, Units::default(), "made here");
        assert_eq!(text.lines().count(), 4);
        let last = text.lines().last().unwrap_or_default();
        assert!(
            last.starts_with("0.100000000,0.200000000,0.300000000,0.400000000,") && last.ends_with(",reached"),
            "{text}"
        );
    }
}
