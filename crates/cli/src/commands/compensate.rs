//! `denavit compensate`: joint commands that reach poses with the robot as it is.

use crate::args::{CompensateArguments, RobotArguments};
use crate::delivery::Delivery;
use crate::failure::Failure;
use crate::measured;
use crate::output::Status;
use denavit_calibrate::apply::compensate::{Command, Wanted, compensate};
use denavit_calibrate::effects::approach::{LEAST_MOVE, side_after};
use denavit_calibrate::effects::driver::{APPROACH, Conditions};
use denavit_calibrate::effects::{EffectModel, recorded};
use denavit_calibrate::observation::measurements::poses::Poses;
use denavit_calibrate::report::commands::{Allowed, summary, to_csv, to_json};
use denavit_model::Chain;

/// Runs the command.
pub fn run(arguments: &CompensateArguments) -> Result<Status, Failure> {
    measured::one_standard_input(&[
        Some(&arguments.robot.robot),
        Some(&arguments.poses),
        arguments.from.as_deref(),
        arguments.effects.as_deref(),
    ])?;
    let read = [Some(arguments.poses.as_str()), arguments.from.as_deref(), arguments.effects.as_deref()];
    let inputs = arguments.robot.files().chain(read.into_iter().flatten());
    let delivery = Delivery::of(arguments.output.as_deref(), &arguments.json, inputs)?;
    let units = measured::units(&arguments.units)?;
    let robot = measured::robot(&arguments.robot)?;
    let calibrated = &robot.chain;
    let model = measured::effects(arguments.effects.as_deref(), &robot.statics)?;
    let nominal = match &arguments.from {
        Some(from) => drawn(from, &arguments.robot, calibrated)?,
        None => model.statics.chain.clone(),
    };
    let [position, orientation] =
        measured::millimetres_and_milliradians("--allowed-miss", &arguments.allowed_miss, 0.001)?;
    let allowed = Allowed { position, orientation };
    let given = measured::given(&arguments.given)?;
    let poses = measured::pose_list(&arguments.poses, calibrated, &arguments.units)?;
    if let Some(file) = &arguments.effects {
        let known = |name: &str| {
            recorded::plain(name).ends_with(APPROACH)
                || recorded::given(&given, name).is_some()
                || poses.covariates.iter().any(|column| column.name == name)
        };
        measured::all_known(file, &model, &known)?;
        measured::without_part_in_the_tip(file, &model);
    }
    let commands = commands(&nominal, calibrated, &model, &poses, &given, allowed);
    let said = summary(&commands, &poses.lines, allowed);
    let csv = || Ok(to_csv(&nominal, &commands, allowed, units, &said));
    delivery.deliver(csv, || Ok(to_json(&nominal, &commands, &poses.lines, allowed)))?;
    delivery.summary(&said)?;
    let all = commands.iter().all(|command| allowed.met_by(command));
    Ok(if all { Status::Same } else { Status::Different })
}

/// The robot as drawn, which must have the joints of the calibrated one.
fn drawn(from: &str, arguments: &RobotArguments, calibrated: &Chain) -> Result<Chain, Failure> {
    let loaded = crate::source::load(from, &arguments.source)?;
    let own = RobotArguments { robot: from.to_owned(), ..arguments.clone() };
    let chain = loaded.chain(&own.selection())?.value;
    let names = |chain: &Chain| chain.coordinates().iter().map(|joint| joint.name.clone()).collect::<Vec<_>>();
    if names(&chain) != names(calibrated) {
        return Err(Failure::Argument(format!(
            "--from {from}: its joints are {}, but those of {} are {}; choose --base and --tip to match",
            names(&chain).join(", "),
            arguments.robot,
            names(calibrated).join(", ")
        )));
    }
    Ok(chain)
}

/// One command per pose. A search starts at the row's joint values, else where the last one ended; sides of approach
/// that nobody gives are those that the nominal commands have in this order.
fn commands(
    nominal: &Chain,
    calibrated: &Chain,
    model: &EffectModel,
    poses: &Poses,
    given: &[(String, f64)],
    allowed: Allowed,
) -> Vec<Command> {
    let middle = |coordinate: &denavit_model::Coordinate| {
        let (lower, upper) = coordinate.range();
        0.0f64.clamp(lower, upper)
    };
    let mut near: Vec<f64> = nominal.coordinates().iter().map(middle).collect();
    let mut before: Option<Vec<f64>> = None;
    let mut sides = vec![0.0; near.len()];
    let mut commands = Vec::with_capacity(poses.lines.len());
    for row in 0..poses.lines.len() {
        let start = poses.joints.get(row).unwrap_or(&near);
        let wanted = match poses.poses.get(row) {
            Some(pose) => Wanted::Pose(*pose),
            None => Wanted::Joints(start.clone()),
        };
        let column = |name: &str| {
            let column = poses.covariates.iter().find(|column| column.name == name);
            column.map(|column| column.values[row])
        };
        let actual = |q: &[f64]| {
            let recorded = |name: &str| {
                let name = recorded::plain(name);
                let side = || side(&name, nominal, before.as_deref(), &sides, q);
                column(&name).or_else(|| recorded::given(given, &name)).or_else(side)
            };
            model.fk(calibrated, &Conditions { reading: q, covariate: &recorded })
        };
        let mut command = compensate(nominal, calibrated, &actual, &wanted, start);
        // The first pose has nothing to keep.
        command.keeps_configuration |= before.is_none() && poses.joints.is_empty();
        if allowed.reached_by(&command) {
            near.clone_from(&command.nominal);
        }
        if let Some(before) = &before {
            for (index, side) in sides.iter_mut().enumerate() {
                *side = side_after(command.nominal[index] - before[index], LEAST_MOVE, *side);
            }
        }
        before = Some(command.nominal.clone());
        commands.push(command);
    }
    commands
}

/// The side from which a joint comes to `q` from the command before, for the name of a column of sides; 0 where nothing was
/// before.
fn side(name: &str, chain: &Chain, before: Option<&[f64]>, sides: &[f64], q: &[f64]) -> Option<f64> {
    let joint = name.strip_suffix(APPROACH)?;
    let index = chain.coordinates().iter().position(|coordinate| coordinate.name == joint)?;
    Some(before.map_or(0.0, |before| side_after(q[index] - before[index], LEAST_MOVE, sides[index])))
}
