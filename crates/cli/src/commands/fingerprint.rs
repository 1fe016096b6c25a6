//! `denavit fingerprint`: a short hash of what the robot is.

use crate::args::FingerprintArguments;
use crate::delivery::Delivery;
use crate::failure::Failure;
use crate::output::Status;
use crate::source;
use denavit_compare::fingerprint_as;
use serde::Serialize;

#[derive(Serialize)]
struct Answer<'a> {
    fingerprint: String,
    #[serde(flatten)]
    parts: &'a denavit_compare::Fingerprint,
}

/// Runs the command.
pub fn run(arguments: &FingerprintArguments) -> Result<Status, Failure> {
    let inputs = std::iter::once(arguments.robot.as_str()).chain(arguments.source.files());
    let delivery = Delivery::of(None, &arguments.json, inputs)?;
    let loaded = source::load(&arguments.robot, &arguments.source)?;
    let found = fingerprint_as(&loaded.subject(&arguments.robot), arguments.tolerance, super::reading(arguments.exact));
    if let Some(written) = &arguments.expect {
        found.comparable(written).map_err(|error| Failure::Argument(format!("--expect: {error}")))?;
    }
    let answer = || super::stamped("denavit.fingerprint/1", &Answer { fingerprint: found.to_string(), parts: &found });
    delivery.deliver(|| Ok(format!("{found}\n")), || Ok(answer()))?;
    let same = arguments
        .expect
        .as_ref()
        .is_none_or(|written| if arguments.only_motion { found.moves_as(written) } else { found.matches(written) });
    Ok(if same { Status::Same } else { Status::Different })
}
