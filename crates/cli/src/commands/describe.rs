//! `denavit describe`: a robot line by line, for `git diff` to compare.

use crate::args::DescribeArguments;
use crate::delivery::Delivery;
use crate::failure::Failure;
use crate::output::Status;
use crate::source;
use denavit_compare::describe::describe_as;

/// Runs the command.
pub fn run(arguments: &DescribeArguments) -> Result<Status, Failure> {
    let inputs = std::iter::once(arguments.robot.as_str()).chain(arguments.source.files());
    let delivery = Delivery::plain(arguments.output.as_deref(), inputs)?;
    let loaded = source::load(&arguments.robot, &arguments.source)?;
    loaded.sound(&arguments.robot)?;
    delivery.text(describe_as(&loaded.subject(&arguments.robot), super::reading(arguments.exact)))?;
    Ok(Status::Same)
}
