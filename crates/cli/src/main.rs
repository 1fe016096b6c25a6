//! The command `denavit`: reads arguments and files, calls the crates, prints. No mathematics here.

// A smaller build parses what it cannot do, to say how to get it.
#![cfg_attr(not(all(feature = "bags", feature = "fleet", feature = "lsp")), allow(dead_code, unused_imports))]

mod args;
#[cfg(feature = "calibrate")]
mod bags;
mod commands;
mod delivery;
mod failure;
#[cfg(feature = "calibrate")]
mod measured;
mod output;
#[cfg(feature = "calibrate")]
mod progress;
mod source;

use args::{Arguments, Command, with_json_files_joined, with_steps_joined};
use clap::Parser as _;
use failure::Failure;
use output::Status;
use std::process::ExitCode;

fn main() -> ExitCode {
    let arguments = Arguments::parse_from(with_steps_joined(with_json_files_joined(std::env::args_os())));
    match run(arguments.command) {
        Ok(status) => ExitCode::from(status as u8),
        Err(Failure::ClosedPipe) => ExitCode::SUCCESS,
        Err(failure) => {
            output::complain(&failure);
            ExitCode::from(Status::Error as u8)
        }
    }
}

fn run(command: Command) -> Result<Status, Failure> {
    match command {
        Command::Table(arguments) => commands::table::run(&arguments),
        Command::Chains(arguments) => commands::chains::run(&arguments),
        Command::Fk(arguments) => commands::fk::run(&arguments),
        #[cfg(feature = "calibrate")]
        Command::Ik(arguments) => commands::ik::run(&arguments),
        Command::Code(arguments) => commands::code::run(&arguments),
        #[cfg(feature = "calibrate")]
        Command::HandEye(arguments) => commands::hand_eye::run(&arguments),
        Command::Poe(arguments) => commands::poe::run(&arguments),
        Command::Describe(arguments) => commands::describe::run(&arguments),
        Command::Diff(arguments) => commands::diff::run(&arguments),
        Command::Expand(arguments) => commands::expand::run(&arguments),
        Command::Export(arguments) => commands::export::run(&arguments),
        Command::Edit(arguments) => commands::edit::run(&arguments),
        Command::Doc(arguments) => commands::doc::run(&arguments),
        Command::Explore(arguments) => commands::explore::run(&arguments),
        Command::Fingerprint(arguments) => commands::fingerprint::run(&arguments),
        Command::Check(arguments) => commands::check::run(&arguments),
        #[cfg(feature = "calibrate")]
        Command::Calibrate(arguments) => commands::calibrate::run(&arguments),
        #[cfg(feature = "calibrate")]
        Command::Identify(arguments) => commands::identify::run(&arguments),
        #[cfg(feature = "calibrate")]
        Command::Measure(arguments) => commands::measure::run(&arguments),
        #[cfg(feature = "calibrate")]
        Command::Plan(arguments) => commands::plan::run(&arguments),
        #[cfg(feature = "calibrate")]
        Command::Plate(arguments) => commands::plate::run(&arguments),
        #[cfg(feature = "calibrate")]
        Command::Simulate(arguments) => commands::simulate::run(&arguments),
        #[cfg(feature = "calibrate")]
        Command::Compensate(arguments) => commands::compensate::run(&arguments),
        #[cfg(feature = "fleet")]
        Command::Fleet(arguments) => commands::fleet::run(&arguments),
        #[cfg(not(feature = "calibrate"))]
        Command::Ik(_)
        | Command::HandEye(_)
        | Command::Calibrate(_)
        | Command::Identify(_)
        | Command::Measure(_)
        | Command::Plan(_)
        | Command::Plate(_)
        | Command::Simulate(_)
        | Command::Compensate(_) => Err(Failure::not_built("calibrate")),
        #[cfg(not(feature = "fleet"))]
        Command::Fleet(_) => Err(Failure::not_built("fleet")),
        #[cfg(feature = "lsp")]
        Command::Lsp(arguments) => commands::lsp::run(&arguments),
        #[cfg(not(feature = "lsp"))]
        Command::Lsp(_) => Err(Failure::not_built("lsp")),
        Command::Completions(arguments) => commands::completions::run(&arguments),
        Command::Man(arguments) => commands::man::run(&arguments),
    }
}
