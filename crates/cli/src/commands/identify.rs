//! `denavit identify`: what measurements can tell of a robot.

use crate::args::IdentifyArguments;
use crate::failure::Failure;
use crate::output::{self, Status};
use crate::source;
use denavit_calibrate::{Freedom, identifiability, report};

/// Runs the command.
pub fn run(arguments: &IdentifyArguments) -> Result<Status, Failure> {
    let robot = &arguments.robot;
    let chain = source::load(&robot.robot, &robot.xacro)?.chain(robot)?.value;
    let freedom = Freedom::axes(chain.joints().len());
    let found = identifiability::of_chain(&chain, &freedom, arguments.targets, arguments.rows);
    output::print(&report::text::identifiability(&found))?;
    Ok(Status::Same)
}
