//! One file per command.

pub mod chains;
pub mod fk;
pub mod poe;
pub mod table;

use crate::args::UnitsArguments;
use crate::failure::Failure;
use denavit_export::Units;

fn units(arguments: &UnitsArguments) -> Result<Units, Failure> {
    Units::default()
        .with_words(&arguments.units)
        .map_err(|word| Failure::Argument(format!("--units: \"{word}\" is no unit; write m or mm, and deg or rad")))
}
