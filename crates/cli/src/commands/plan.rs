//! `denavit plan`: which poses to measure.

use crate::args::PlanArguments;
use crate::delivery::Delivery;
use crate::failure::Failure;
use crate::measured;
use crate::output::Status;
use crate::progress::Spinner;
use denavit_calibrate::apply::plan::{PlanOptions, plan};
use denavit_load::measured::corners;
use denavit_model::nalgebra::Vector3;

/// Runs the command.
pub fn run(arguments: &PlanArguments) -> Result<Status, Failure> {
    let (candidates, prior) = (arguments.candidates.as_deref(), arguments.prior.as_deref());
    measured::one_standard_input(&[Some(&arguments.robot.robot), candidates, prior])?;
    let inputs = arguments.robot.files().chain(candidates).chain(prior);
    let delivery = Delivery::of(arguments.output.as_deref(), &arguments.json, inputs)?;
    let units = measured::units(&arguments.units)?;
    let chain = measured::robot(&arguments.robot)?.chain;
    let usual = PlanOptions::new(&chain, arguments.count.into(), measured::kind(arguments.measure));
    let read = |file: &String| measured::joint_values(file, &chain, &arguments.units);
    let options = PlanOptions {
        earlier: measured::known_before(prior, &chain)?,
        candidates: arguments.candidates.as_ref().map(read).transpose()?,
        spread: arguments.spread.into(),
        allowed: corners(&arguments.r#box)?,
        target: place("--target", &arguments.target)?,
        anchor: if arguments.anchor.is_empty() { usual.anchor } else { place("--anchor", &arguments.anchor)? },
        seed: arguments.seed,
        ..usual
    };
    let spinner = Spinner::start("choosing poses");
    let planned = plan(&chain, &options)?;
    drop(spinner);
    delivery.deliver(|| Ok(planned.to_csv(&chain, units)), || Ok(planned.to_json(&chain, options.kind)))?;
    delivery.summary(&planned.to_text())?;
    Ok(Status::Same)
}

fn place(option: &str, written: &[f64]) -> Result<Vector3<f64>, Failure> {
    match *written {
        [x, y, z] if written.iter().all(|value| value.is_finite()) => Ok(Vector3::new(x, y, z)),
        _ => Err(Failure::Argument(format!("{option}: write three finite numbers X,Y,Z in m"))),
    }
}
