//! `denavit describe`: a robot line by line, for `git diff` to compare.

use crate::args::DescribeArguments;
use crate::failure::Failure;
use crate::output::Status;
use crate::source;
use denavit_compare::describe::describe;

/// Runs the command.
pub fn run(arguments: &DescribeArguments) -> Result<Status, Failure> {
    let loaded = source::load(&arguments.robot, &arguments.source)?;
    super::deliver(arguments.output.as_deref(), &describe(&loaded.subject(&arguments.robot)))?;
    Ok(Status::Same)
}
