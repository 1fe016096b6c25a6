//! `denavit fingerprint`: a short hash of what the robot is.

use crate::args::FingerprintArguments;
use crate::failure::Failure;
use crate::output::{self, Status};
use crate::source;
use denavit_compare::fingerprint;

/// Runs the command.
pub fn run(arguments: &FingerprintArguments) -> Result<Status, Failure> {
    let loaded = source::load(&arguments.robot, &arguments.source)?;
    if !(arguments.tolerance > 0.0 && arguments.tolerance < 1.0) {
        return Err(Failure::Argument(format!("--tolerance {}: write a number between 0 and 1", arguments.tolerance)));
    }
    let found = fingerprint(&loaded.subject(&arguments.robot), arguments.tolerance);
    if let Some(written) = &arguments.expect {
        found.comparable(written).map_err(|error| Failure::Argument(format!("--expect: {error}")))?;
    }
    let text = if arguments.json {
        serde_json::to_string_pretty(&found).expect("hashes are text") + "\n"
    } else {
        format!("{found}\n")
    };
    output::print(&text)?;
    let same = arguments
        .expect
        .as_ref()
        .is_none_or(|written| if arguments.only_motion { found.moves_as(written) } else { found.matches(written) });
    Ok(if same { Status::Same } else { Status::Different })
}
