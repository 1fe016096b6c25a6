//! `denavit poe`: screw axes and home pose.

use crate::args::{PoeArguments, PoeFormat};
use crate::failure::Failure;
use crate::output::{self, Status};
use crate::source;
use denavit_export::poe;

/// Runs the command.
pub fn run(arguments: &PoeArguments) -> Result<Status, Failure> {
    let units = super::units(&arguments.units)?;
    let loaded = source::load(&arguments.robot.robot, &arguments.robot.source)?;
    let noted = loaded.chain(&arguments.robot.selection())?;
    let text = match arguments.format {
        PoeFormat::Text => poe::text(&noted.value, &noted.notes, units),
        PoeFormat::Json => poe::json(&noted.value, &noted.notes),
        PoeFormat::Csv => {
            output::remark(&noted.notes);
            poe::csv(&noted.value)
        }
    };
    output::print(&text)?;
    Ok(Status::Same)
}
