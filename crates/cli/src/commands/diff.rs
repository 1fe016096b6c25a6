//! `denavit diff`: how two robots differ.

use crate::args::{DiffArguments, RobotFormatName};
use crate::delivery::Delivery;
use crate::failure::Failure;
use crate::output::Status;
use crate::source;
use denavit_compare::report::{self, Report};
use denavit_compare::{Options, Range, Scope, Verdict, compare};

/// Runs the command.
pub fn run(arguments: &DiffArguments) -> Result<Status, Failure> {
    let options = options(arguments)?;
    let inputs = [arguments.a.as_str(), arguments.b.as_str()].into_iter().chain(arguments.source.files());
    let delivery = Delivery::of(arguments.output.as_deref(), &arguments.json, inputs)?;
    let robots = source::load_all(&[&arguments.a, &arguments.b], &arguments.source)?;
    let (a, b) = (&robots[0], &robots[1]);
    let comparison = compare(&a.subject(&arguments.a), &b.subject(&arguments.b), &options)?;
    let found = Report::Comparison(&comparison);
    let rendered =
        |name: &str| Ok((report::format(name).expect("the argument parser knows the formats").render)(&found));
    let own = || match arguments.format.as_str() {
        "text" => Ok(report::text(&found, delivery.colour())),
        name => rendered(name),
    };
    delivery.deliver(own, || rendered("json"))?;
    Ok(if comparison.verdict == Verdict::Different { Status::Different } else { Status::Same })
}

fn options(arguments: &DiffArguments) -> Result<Options, Failure> {
    for (option, value) in [("--tolerance-m", arguments.tolerance_m), ("--tolerance-rad", arguments.tolerance_rad)] {
        if !(value.is_finite() && value >= 0.0) {
            return Err(Failure::Argument(format!("{option} {value}: write a finite number, 0 or more")));
        }
    }
    let q_range = arguments.q_range.iter().map(|written| range(written)).collect::<Result<Vec<Range>, Failure>>()?;
    Ok(Options {
        tolerance_m: arguments.tolerance_m,
        tolerance_rad: arguments.tolerance_rad,
        scope: if arguments.only.is_some() { Scope::Kinematics } else { Scope::Everything },
        up_to_base: arguments.up_to_base,
        up_to_zeros: arguments.up_to_zeros,
        count_names: arguments.count_names,
        q_range,
        samples: arguments.samples as usize,
        seed: arguments.seed,
        reading: super::reading(arguments.exact),
        through: arguments.through.map(RobotFormatName::format),
        ..Options::default()
    })
}

/// `LOWER,UPPER` or `NAME=LOWER,UPPER`.
fn range(written: &str) -> Result<Range, Failure> {
    let wrong =
        || Failure::Argument(format!("--q-range: \"{written}\" is no range; write LOWER,UPPER or NAME=LOWER,UPPER"));
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
