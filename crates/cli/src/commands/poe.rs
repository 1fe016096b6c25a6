//! `denavit poe`: screw axes and home pose.

use crate::args::{PoeArguments, PoeFormat};
use crate::delivery::Delivery;
use crate::failure::Failure;
use crate::output::{self, Status};
use crate::source;
use denavit_export::poe;

/// Runs the command.
pub fn run(arguments: &PoeArguments) -> Result<Status, Failure> {
    let units = super::units(&arguments.units)?;
    let delivery = Delivery::of(arguments.output.as_deref(), &arguments.json, arguments.robot.files())?;
    let loaded = source::load(&arguments.robot.robot, &arguments.robot.source)?;
    let noted = loaded.chain(&arguments.robot.selection())?;
    let json = || Ok(poe::json(&noted.value, &noted.notes));
    let own = || match arguments.format {
        PoeFormat::Text => Ok(poe::text(&noted.value, &noted.notes, units)),
        PoeFormat::Json => json(),
        PoeFormat::Csv => {
            output::remark(&noted.notes);
            Ok(poe::csv(&noted.value))
        }
    };
    delivery.deliver(own, json)?;
    Ok(Status::Same)
}
