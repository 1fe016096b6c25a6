//! One file per command.

#[cfg(feature = "calibrate")]
pub mod calibrate;
pub mod chains;
pub mod check;
pub mod code;
#[cfg(feature = "calibrate")]
pub mod compensate;
pub mod completions;
pub mod describe;
pub mod diff;
pub mod doc;
pub mod edit;
pub mod expand;
pub mod explore;
pub mod export;
pub mod fingerprint;
pub mod fk;
#[cfg(feature = "fleet")]
pub mod fleet;
#[cfg(feature = "calibrate")]
pub mod hand_eye;
#[cfg(feature = "calibrate")]
pub mod identify;
#[cfg(feature = "calibrate")]
pub mod ik;
#[cfg(feature = "lsp")]
pub mod lsp;
pub mod man;
#[cfg(feature = "calibrate")]
pub mod measure;
#[cfg(feature = "calibrate")]
pub mod plan;
#[cfg(feature = "calibrate")]
pub mod plate;
pub mod poe;
#[cfg(feature = "calibrate")]
pub mod simulate;
pub mod table;

use crate::args::UnitsArguments;
use crate::failure::Failure;
use denavit_export::{Units, UnknownUnit};
use denavit_model::Reading;
use denavit_model::words::quoted;
use serde::Serialize;

fn reading(exact: bool) -> Reading {
    if exact { Reading::AsWritten } else { Reading::Intended }
}

fn units(arguments: &UnitsArguments) -> Result<Units, Failure> {
    Units::default().with_words(&arguments.units).map_err(|UnknownUnit { word, .. }| {
        Failure::Argument(format!(
            "--units: \"{}\" is not a unit of text; write m or mm, and deg or rad",
            quoted(&word)
        ))
    })
}

/// A value as JSON with the name and version of its schema first.
fn stamped(schema: &'static str, value: &impl Serialize) -> String {
    #[derive(Serialize)]
    struct Stamped<'a, T: Serialize> {
        schema: &'static str,
        #[serde(flatten)]
        value: &'a T,
    }
    serde_json::to_string_pretty(&Stamped { schema, value }).expect("plain values with text keys") + "\n"
}
