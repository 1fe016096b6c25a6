//! `denavit identify`: what measurements can tell of a robot.

use crate::args::IdentifyArguments;
use crate::delivery::Delivery;
use crate::failure::Failure;
use crate::measured;
use crate::output::Status;
use denavit_calibrate::apply::identifiable;
use denavit_calibrate::report;
use denavit_identify::dh_form::dh_form;
use denavit_identify::proportion::can_be_identified;
use denavit_identify::simulate;
use denavit_load::measured::freedom;

/// Runs the command.
pub fn run(arguments: &IdentifyArguments) -> Result<Status, Failure> {
    measured::one_standard_input(&[Some(&arguments.robot.robot), arguments.data.as_deref()])?;
    let delivery = Delivery::of(
        None,
        &arguments.json,
        arguments.robot.files().chain(arguments.data.as_deref()).chain(arguments.import.files()),
    )?;
    let chain = measured::robot(&arguments.robot)?.chain;
    can_be_identified(&chain)?;
    let freedom = freedom(&chain, &arguments.freedom.scales, &arguments.freedom.pitches)?;
    let readings = match &arguments.data {
        Some(file) => {
            let options = measured::import_options(&arguments.import)?;
            measured::joint_values_of_export(file, &chain, &arguments.units, &options)?
        }
        None => simulate::readings(&chain, arguments.rows.into(), 0),
    };
    let found = identifiable::at_readings(&chain, &freedom, arguments.targets.into(), &readings);
    let form = dh_form(&chain, &readings);
    let text = || {
        Ok(format!(
            "{}: {} to {}, at {} joint readings\n\n{}{}\n{}",
            chain.name(),
            chain.base(),
            chain.tip(),
            readings.len(),
            report::identifiability::identifiability(&found),
            report::identifiability::never_identifiable(&chain),
            report::identifiability::dh_form(&form, &chain)
        ))
    };
    delivery.deliver(text, || Ok(report::identifiability::to_json(&chain, readings.len(), &found, &form)))?;
    Ok(Status::Same)
}
