//! `denavit completions`: completions of the command line for a shell.

use crate::args::{Arguments, CompletionsArguments};
use crate::delivery::Delivery;
use crate::failure::Failure;
use crate::output::Status;
use clap::CommandFactory as _;

/// Runs the command.
pub fn run(arguments: &CompletionsArguments) -> Result<Status, Failure> {
    let delivery = Delivery::plain(arguments.output.as_deref(), [])?;
    let mut script = Vec::new();
    clap_complete::generate(arguments.shell, &mut Arguments::command(), "denavit", &mut script);
    delivery.text(String::from_utf8_lossy(&script).into_owned())?;
    Ok(Status::Same)
}
