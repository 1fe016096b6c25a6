//! `denavit fleet`: many robots, many nights.

mod corpus;
mod report;
mod run;
mod siblings;
mod watch;

use crate::args::{FleetArguments, FleetCommand};
use crate::failure::Failure;
use crate::output::Status;

/// Runs the command.
pub fn run(arguments: &FleetArguments) -> Result<Status, Failure> {
    match &arguments.command {
        FleetCommand::Run(arguments) => run::run(arguments),
        FleetCommand::Watch(arguments) => watch::watch(arguments),
        FleetCommand::History(arguments) => watch::history(arguments),
        FleetCommand::Siblings(arguments) => siblings::run(arguments),
        FleetCommand::Report(arguments) => report::run(arguments),
        FleetCommand::Corpus(arguments) => corpus::run(arguments),
    }
}
