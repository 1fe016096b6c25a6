//! `denavit man`: manual pages.

use crate::args::{Arguments, ManArguments};
use crate::delivery::Delivery;
use crate::failure::Failure;
use crate::output::{self, OutputFolder, Status};
use clap::{Command, CommandFactory as _};
use std::fmt::Write as _;
use std::path::Path;

/// Runs the command.
pub fn run(arguments: &ManArguments) -> Result<Status, Failure> {
    let mut command = Arguments::command();
    command.build();
    let pages = pages(&command)?;
    match arguments.output.as_deref().filter(|folder| *folder != Path::new("-")) {
        None => Delivery::plain(None, [])?.text(pages[0].1.clone())?,
        Some(folder) => {
            let mut listing = String::new();
            for path in OutputFolder::of(folder)?.write(&pages, [])? {
                let _ = writeln!(listing, "{}", path.display());
            }
            output::print(&listing)?;
        }
    }
    Ok(Status::Same)
}

/// A page for the program and one for each of its commands: name and text.
fn pages(program: &Command) -> Result<Vec<(String, String)>, Failure> {
    let page = |command: &Command, name: String| {
        let mut text = Vec::new();
        let made = clap_mangen::Man::new(command.clone().name(name.clone())).render(&mut text);
        made.map_err(|error| Failure::Write { file: format!("{name}.1"), reason: error.to_string() })?;
        Ok((format!("{name}.1"), String::from_utf8_lossy(&text).into_owned()))
    };
    let own = program.get_name().to_owned();
    let commands = program.get_subcommands().filter(|command| command.get_name() != "help");
    let commands = commands.map(|command| page(command, format!("{own}-{}", command.get_name())));
    std::iter::once(page(program, own.clone())).chain(commands).collect()
}
