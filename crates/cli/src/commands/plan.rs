//! `denavit plan`: which poses to measure.

use crate::args::PlanArguments;
use crate::delivery::Delivery;
use crate::failure::Failure;
use crate::measured;
use crate::output::Status;
use crate::progress::Spinner;
use denavit_calibrate::apply::plan::{PlanOptions, plan};
use denavit_model::nalgebra::{Point3, Vector3};

/// Runs the command.
pub fn run(arguments: &PlanArguments) -> Result<Status, Failure> {
    measured::one_standard_input(&[Some(&arguments.robot.robot), arguments.candidates.as_deref()])?;
    let inputs = arguments.robot.files().chain(arguments.candidates.as_deref());
    let delivery = Delivery::of(arguments.output.as_deref(), &arguments.json, inputs)?;
    let units = measured::units(&arguments.units)?;
    let chain = measured::robot(&arguments.robot)?.chain;
    let usual = PlanOptions::new(&chain, arguments.count.into(), measured::kind(arguments.measure));
    let read = |file: &String| measured::joint_values(file, &chain, &arguments.units);
    let options = PlanOptions {
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

/// Lowest and highest corner.
fn corners(written: &[f64]) -> Result<Option<[Point3<f64>; 2]>, Failure> {
    let [x0, x1, y0, y1, z0, z1] = match *written {
        [] => return Ok(None),
        [x0, x1, y0, y1, z0, z1] => [x0, x1, y0, y1, z0, z1],
        _ => {
            let message = format!("--box: {} numbers where X0,X1,Y0,Y1,Z0,Z1 are six", written.len());
            return Err(Failure::Argument(message));
        }
    };
    for (axis, low, high) in [("X", x0, x1), ("Y", y0, y1), ("Z", z0, z1)] {
        let ordered = low < high;
        if !ordered {
            let message = format!("--box: {axis}0 = {low} is not below {axis}1 = {high}; nothing fits between");
            return Err(Failure::Argument(message));
        }
        if !low.is_finite() || !high.is_finite() {
            return Err(Failure::Argument(format!(
                "--box: {axis}0 = {low}, {axis}1 = {high}; write finite numbers in m"
            )));
        }
    }
    Ok(Some([Point3::new(x0, y0, z0), Point3::new(x1, y1, z1)]))
}

fn place(option: &str, written: &[f64]) -> Result<Vector3<f64>, Failure> {
    match *written {
        [x, y, z] if written.iter().all(|value| value.is_finite()) => Ok(Vector3::new(x, y, z)),
        _ => Err(Failure::Argument(format!("{option}: write three finite numbers X,Y,Z in m"))),
    }
}
