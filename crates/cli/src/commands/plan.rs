//! `denavit plan`: which poses to measure.

use crate::args::PlanArguments;
use crate::delivery::Delivery;
use crate::failure::Failure;
use crate::measured::{self, Robot};
use crate::output::Status;
use crate::progress::Spinner;
use denavit_calibrate::apply::plan::{PlanOptions, plan};
use denavit_calibrate::calibration::{Calibration, calibrate};
use denavit_load::measured::{Rows, RowsAsked, SearchAsked, corners, other_chains, rows, search};
use denavit_measurements::Units;
use denavit_model::Chain;
use denavit_model::nalgebra::Vector3;

/// Runs the command.
pub fn run(arguments: &PlanArguments) -> Result<Status, Failure> {
    let (candidates, prior) = (arguments.candidates.as_deref(), arguments.prior.as_deref());
    let mut inputs = vec![Some(arguments.robot.robot.as_str()), candidates, prior];
    inputs.extend(arguments.tell_apart.iter().map(|file| Some(file.as_str())));
    measured::one_standard_input(&inputs)?;
    let inputs = arguments.robot.files().chain(candidates).chain(prior).chain(arguments.import.files());
    let inputs = inputs.chain(arguments.tell_apart.iter().map(String::as_str));
    let delivery = Delivery::of(arguments.output.as_deref(), &arguments.json, inputs)?;
    let units = measured::units(&arguments.units)?;
    let robot = measured::robot(&arguments.robot)?;
    let chain = &robot.chain;
    let options = options(arguments, chain)?;
    if !arguments.tell_apart.is_empty() {
        let found = calibrated(arguments, &robot, units)?;
        let spinner = Spinner::start("choosing poses");
        let planned = found.tell_apart(&robot.statics, &options)?;
        drop(spinner);
        delivery.deliver(|| Ok(planned.to_csv(chain, units)), || Ok(planned.to_json(chain)))?;
        delivery.summary(&planned.to_text())?;
        return Ok(Status::Same);
    }
    let spinner = Spinner::start("choosing poses");
    let planned = plan(chain, &options)?;
    drop(spinner);
    delivery.deliver(|| Ok(planned.to_csv(chain, units)), || Ok(planned.to_json(chain, options.kind)))?;
    delivery.summary(&planned.to_text())?;
    Ok(Status::Same)
}

/// Default number of poses, the same as in the report of a calibration.
const USUAL_COUNT: u16 = 20;

fn options(arguments: &PlanArguments, chain: &Chain) -> Result<PlanOptions, Failure> {
    let count = arguments.count.unwrap_or(USUAL_COUNT);
    let usual = PlanOptions::new(chain, count.into(), measured::kind(arguments.measure));
    let read = |file: &String| measured::joint_values(file, chain, &arguments.units);
    Ok(PlanOptions {
        earlier: measured::known_before(arguments.prior.as_deref(), chain)?,
        candidates: arguments.candidates.as_ref().map(read).transpose()?,
        spread: arguments.spread.into(),
        allowed: corners(&arguments.r#box)?,
        target: place("--target", &arguments.target)?,
        anchor: if arguments.anchor.is_empty() { usual.anchor } else { place("--anchor", &arguments.anchor)? },
        seed: arguments.seed,
        ..usual
    })
}

/// The run calibrated with the defaults of `denavit calibrate`.
fn calibrated(arguments: &PlanArguments, robot: &Robot, units: Units) -> Result<Calibration, Failure> {
    let import = measured::import_options(&arguments.import)?;
    let read = |file: &String| measured::data_file(file, units, import.clone());
    let data = arguments.tell_apart.iter().map(read).collect::<Result<_, _>>()?;
    let asked = RowsAsked { data, ..RowsAsked::default() };
    let Rows { data, notes, .. } = rows(&asked, &robot.chain)?;
    measured::mention(&notes);
    let prior = arguments.prior.as_deref().map(measured::bare_file).transpose()?;
    let mut options = search(&SearchAsked { prior, ..SearchAsked::default() }, &robot.chain)?;
    options.noise = false;
    options.other_chains = other_chains(&robot.loaded, &robot.chain, &data);
    let spinner = Spinner::start("calibrating the run");
    let found = calibrate(&robot.chain, &robot.statics, data, None, &options)?;
    drop(spinner);
    Ok(found)
}

fn place(option: &str, written: &[f64]) -> Result<Vector3<f64>, Failure> {
    match *written {
        [x, y, z] if written.iter().all(|value| value.is_finite()) => Ok(Vector3::new(x, y, z)),
        _ => Err(Failure::Argument(format!("{option}: write three finite numbers X,Y,Z in m"))),
    }
}
