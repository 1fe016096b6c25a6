//! `denavit compensate`: joint commands with which a calibrated robot reaches poses.

use crate::args::{CompensateArguments, RobotArguments};
use crate::delivery::Delivery;
use crate::failure::Failure;
use crate::measured;
use crate::output::Status;
use crate::source::Loaded;
use denavit_calibrate::apply::compensate::{Allowed, in_order};
use denavit_calibrate::report::commands::{summary, to_csv, to_json};
use denavit_identify::effects::recorded;
use denavit_load::measured::{all_known, without_part_in_the_tip};
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
    let inputs = arguments.robot.files().chain(read.into_iter().flatten()).chain(arguments.import.files());
    let delivery = Delivery::of(arguments.output.as_deref(), &arguments.json, inputs)?;
    let units = measured::units(&arguments.units)?;
    let (robot, from) = match &arguments.from {
        Some(from) => {
            let (robot, loaded) = measured::robot_and(&arguments.robot, from)?;
            (robot, Some((from, loaded)))
        }
        None => (measured::robot(&arguments.robot)?, None),
    };
    let calibrated = &robot.chain;
    let model = measured::effects(arguments.effects.as_deref(), &robot.statics)?;
    let nominal = match &from {
        Some((from, loaded)) => drawn(from, loaded, &arguments.robot, calibrated)?,
        None => model.statics.chain.clone(),
    };
    let [position, orientation] =
        measured::millimetres_and_milliradians("--allowed-miss", &arguments.allowed_miss, 0.001)?;
    let allowed = Allowed { position, orientation };
    let given = measured::given(&arguments.given)?;
    let poses = measured::pose_list(&arguments.poses, calibrated, &arguments.units, Some(&arguments.import))?;
    if let Some(file) = &arguments.effects {
        let known = |name: &str| {
            recorded::given_by_order(name)
                || recorded::given(&given, name).is_some()
                || poses.covariates.iter().any(|column| column.name == name)
        };
        all_known(file, &model, &known)?;
        measured::mention(&without_part_in_the_tip(file, &model));
    }
    let commands = in_order(&nominal, calibrated, &model, &poses, &given, allowed);
    let commands = commands.map_err(|missing| Failure::Argument(missing.to_string()))?;
    let said = summary(&commands, &poses.lines, allowed);
    let csv = || Ok(to_csv(&nominal, &commands, allowed, units, &said));
    delivery.deliver(csv, || Ok(to_json(&nominal, &commands, &poses.lines, allowed)))?;
    delivery.summary(&said)?;
    let all = commands.iter().all(|command| allowed.met_by(command));
    Ok(if all { Status::Same } else { Status::Different })
}

/// The robot as drawn, which must have the joints of the calibrated one.
fn drawn(from: &str, loaded: &Loaded, arguments: &RobotArguments, calibrated: &Chain) -> Result<Chain, Failure> {
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
