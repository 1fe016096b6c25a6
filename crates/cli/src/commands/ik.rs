//! `denavit ik`: joint values that reach given poses, every branch.

use crate::args::IkArguments;
use crate::delivery::Delivery;
use crate::failure::Failure;
use crate::measured;
use crate::output::{self, Status};
use crate::source;
use denavit_ik::{Found, Solutions, Solver};
use denavit_model::{Chain, Pose, se3};
use serde_json::{Map, Value, json};
use std::fmt::Write as _;

const SCHEMA: &str = "denavit.ik/1";

/// A pose to reach and what was found for it.
struct Answer {
    /// Line of the file, 1 for a pose of the command line.
    line: usize,
    reached: bool,
    lost: usize,
    solutions: Vec<(Vec<f64>, Found)>,
}

/// Runs the command.
pub fn run(arguments: &IkArguments) -> Result<Status, Failure> {
    measured::one_standard_input(&[Some(&arguments.robot.robot), arguments.poses.as_deref()])?;
    let inputs = arguments.robot.files().chain(arguments.poses.as_deref());
    let delivery = Delivery::of(arguments.output.as_deref(), &arguments.json, inputs)?;
    let units = measured::units(&arguments.units)?;
    let loaded = source::load(&arguments.robot.robot, &arguments.robot.source)?;
    let noted = loaded.chain(&arguments.robot.selection())?;
    let chain = &noted.value;
    let mut near = super::fk::joint_values(chain, "--near", &arguments.near, false)?;
    for (value, coordinate) in near.iter_mut().zip(chain.coordinates()) {
        *value *= units.of(coordinate);
    }
    if chain.coordinates().is_empty() {
        let (base, tip) = (chain.base(), chain.tip());
        return Err(Failure::Argument(format!(
            "nothing moves between \"{base}\" and \"{tip}\"; choose --base and --tip"
        )));
    }
    let solver = Solver::new(chain);
    let wanted = wanted(arguments, chain)?;
    output::remark(&noted.notes);
    let mut solutions = Solutions::default();
    let mut from = near;
    let mut answers = Vec::with_capacity(wanted.len());
    for (line, pose) in wanted {
        solver.solve_into(&pose, &from, &mut solutions);
        let found: Vec<_> = solutions.iter().map(|(joints, found)| (joints.to_vec(), *found)).collect();
        // The next pose is sought next to where this one is reached, so that a path keeps its branch.
        if let Some((joints, _)) = found.first().filter(|_| solutions.reached()) {
            from.clone_from(joints);
        }
        let (reached, lost) = (solutions.reached(), solutions.lost());
        answers.push(Answer { line, reached, lost, solutions: found });
    }
    let csv = || Ok(csv(&solver, &answers, arguments.all, units));
    delivery.deliver(csv, || Ok(json(&solver, &answers)))?;
    let all =
        answers.iter().all(|answer| answer.reached && answer.solutions.iter().any(|(_, found)| found.within_limits));
    Ok(if all { Status::Same } else { Status::Different })
}

/// The poses to reach, base_from_tip, each with its line.
fn wanted(arguments: &IkArguments, chain: &Chain) -> Result<Vec<(usize, Pose)>, Failure> {
    let Some(file) = &arguments.poses else {
        let units = measured::units(&arguments.units)?;
        let [x, y, z, roll, pitch, yaw] = arguments.pose[..] else {
            let count = arguments.pose.len();
            return Err(Failure::Argument(format!("--pose: {count} numbers; write x,y,z,roll,pitch,yaw")));
        };
        if !arguments.pose.iter().all(|number| number.is_finite()) {
            return Err(Failure::Argument("--pose: a number is not finite".into()));
        }
        let rotation = se3::rotation_from_rpy([roll, pitch, yaw].map(|angle| angle * units.angle));
        let place = [x, y, z].map(|length| length * units.length);
        return Ok(vec![(1, se3::pose(rotation, place.into()))]);
    };
    let list = measured::pose_list(file, chain, &arguments.units, None)?;
    let poses =
        if list.poses.is_empty() { list.joints.iter().map(|joints| chain.fk(joints)).collect() } else { list.poses };
    Ok(list.lines.into_iter().zip(poses).collect())
}

/// The joints of a solution that are outside of their limits.
fn state(answer: &Answer, found: &Found) -> &'static str {
    match (answer.reached, found.within_limits) {
        (true, true) => "reached",
        (true, false) => "outside of limits",
        (false, _) => "out of reach",
    }
}

fn csv(solver: &Solver, answers: &[Answer], all: bool, units: denavit_measurements::Units) -> String {
    let chain = solver.chain();
    let mut text = format!("# {} → {}: {}\n", chain.base(), chain.tip(), solver.method());
    for answer in answers {
        if answer.lost > 0 {
            let _ = writeln!(
                text,
                "# line {}: {} branches of the arm with exactly parallel or intersecting axes were not found for this arm",
                answer.line, answer.lost
            );
        }
        if let (false, Some((_, nearest))) = (answer.reached, answer.solutions.first()) {
            let (moved, turned) = (nearest.position_error * 1e3, nearest.orientation_error * 1e3);
            let _ = writeln!(
                text,
                "# line {}: out of reach; the nearest found is {moved:.4} mm and {turned:.4} mrad away",
                answer.line
            );
        }
    }
    let _ = writeln!(text, "# units: {units}");
    let joints = chain.coordinates().iter().map(|coordinate| coordinate.name.as_str()).collect::<Vec<_>>().join(",");
    let _ = writeln!(text, "line,solution,{joints},state,branch");
    for answer in answers {
        let shown = if all { answer.solutions.len() } else { 1 };
        for (index, (joints, found)) in answer.solutions.iter().take(shown).enumerate() {
            let values = chain.coordinates().iter().zip(joints);
            let values = values.map(|(coordinate, value)| format!("{:.9}", value / units.of(coordinate)));
            let branch = found.branch.map_or_else(String::new, |branch| format!("\"{branch}\""));
            let values = values.collect::<Vec<_>>().join(",");
            let _ = writeln!(text, "{},{},{values},{},{branch}", answer.line, index + 1, state(answer, found));
        }
    }
    text
}

fn json(solver: &Solver, answers: &[Answer]) -> String {
    let chain = solver.chain();
    let named = |values: &[f64]| -> Map<String, Value> {
        chain.coordinates().iter().zip(values).map(|(joint, value)| (joint.name.clone(), json!(value))).collect()
    };
    let poses = answers.iter().map(|answer| {
        let solutions = answer.solutions.iter().map(|(joints, found)| {
            json!({
                "state": state(answer, found),
                "joints": named(joints),
                "branch": found.branch.map(|branch| branch.to_string()),
                "position_error_m": found.position_error,
                "orientation_error_rad": found.orientation_error,
            })
        });
        json!({
            "line": answer.line,
            "reached": answer.reached,
            "branches_lost": answer.lost,
            "solutions": solutions.collect::<Vec<_>>(),
        })
    });
    let value = json!({
        "schema": SCHEMA,
        "robot": chain.name(),
        "base": chain.base(),
        "tip": chain.tip(),
        "method": solver.method().to_string(),
        "poses": poses.collect::<Vec<_>>(),
    });
    serde_json::to_string_pretty(&value).expect("plain values with text keys") + "\n"
}
