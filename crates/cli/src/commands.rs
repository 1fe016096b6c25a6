//! One file per command.

pub mod calibrate;
pub mod chains;
pub mod check;
pub mod compensate;
pub mod describe;
pub mod diff;
pub mod doc;
pub mod expand;
pub mod export;
pub mod fingerprint;
pub mod fk;
pub mod identify;
pub mod plan;
pub mod poe;
pub mod simulate;
pub mod table;

use crate::args::UnitsArguments;
use crate::failure::Failure;
use crate::output;
use denavit_export::Units;
use std::path::Path;

fn units(arguments: &UnitsArguments) -> Result<Units, Failure> {
    Units::default()
        .with_words(&arguments.units)
        .map_err(|word| Failure::Argument(format!("--units: \"{word}\" is no unit; write m or mm, and deg or rad")))
}

/// Writes to the file that was asked for, or prints.
fn deliver(file: Option<&Path>, text: &str) -> Result<(), Failure> {
    match file {
        Some(path) => output::write_file(path, text.as_bytes()),
        None => output::print(text),
    }
}
