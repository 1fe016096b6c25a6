//! `denavit diff`: how two robots differ, or all robots of a repository.

mod robots;

use crate::args::{DiffArguments, RobotFormatName};
use crate::delivery::Delivery;
use crate::failure::Failure;
use crate::output::Status;
use crate::source;
use denavit_compare::report::Report;
use denavit_compare::{Options, Range, Scope, Verdict, compare};
use denavit_load::Project;
use std::path::Path;

/// Runs the command.
pub fn run(arguments: &DiffArguments) -> Result<Status, Failure> {
    let options = options(arguments)?;
    let Some(b) = arguments.b.as_deref().filter(|_| !arguments.robots) else { return robots::run(arguments, &options) };
    let inputs = [arguments.a.as_str(), b].into_iter().chain(arguments.source.files());
    let delivery = Delivery::of(arguments.output.as_deref(), &arguments.json, inputs)?;
    let robots = source::load_all(&[&arguments.a, b], &arguments.source)?;
    let comparison = compare(&robots[0].subject(&arguments.a), &robots[1].subject(b), &options)?;
    let found = Report::Comparison(&comparison);
    delivery.report(&arguments.format, &found)?;
    Ok(if comparison.verdict == Verdict::Different { Status::Different } else { Status::Same })
}

fn options(arguments: &DiffArguments) -> Result<Options, Failure> {
    let stated = match (arguments.tolerance_m, arguments.tolerance_rad) {
        (Some(_), Some(_)) => None,
        _ => Project::of(Path::new("."))?,
    };
    let (defaults, stated) = (Options::default(), stated.unwrap_or_default());
    let q_range = arguments.q_range.iter().map(|written| range(written)).collect::<Result<Vec<Range>, Failure>>()?;
    Ok(Options {
        tolerance_m: arguments.tolerance_m.or(stated.tolerance_m).unwrap_or(defaults.tolerance_m),
        tolerance_rad: arguments.tolerance_rad.or(stated.tolerance_rad).unwrap_or(defaults.tolerance_rad),
        scope: if arguments.only.is_some() { Scope::Kinematics } else { Scope::Everything },
        up_to_base: arguments.up_to_base,
        up_to_zeros: arguments.up_to_zeros,
        count_names: arguments.count_names,
        q_range,
        samples: arguments.samples as usize,
        seed: arguments.seed,
        reading: super::reading(arguments.exact),
        through: arguments.through.map(RobotFormatName::format),
        ..defaults
    })
}

/// `LOWER,UPPER` or `NAME=LOWER,UPPER`.
fn range(written: &str) -> Result<Range, Failure> {
    let wrong =
        || Failure::Argument(format!("--q-range: \"{written}\" is not a range; write LOWER,UPPER or NAME=LOWER,UPPER"));
    let (joint, bounds) = match written.rsplit_once('=') {
        Some((name, bounds)) => (Some(name.to_owned()), bounds),
        None => (None, written),
    };
    let (lower, upper) = bounds.split_once(',').ok_or_else(wrong)?;
    let number = |word: &str| word.trim().parse::<f64>().ok().filter(|number| number.is_finite());
    let (lower, upper) = (number(lower).ok_or_else(wrong)?, number(upper).ok_or_else(wrong)?);
    if lower > upper {
        return Err(wrong());
    }
    Ok(Range { joint, lower, upper })
}
