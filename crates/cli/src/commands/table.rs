//! `denavit table`: the Denavit-Hartenberg table of a chain.

use crate::args::{ConventionName, GaugeName, TableArguments};
use crate::failure::Failure;
use crate::output::{self, Status};
use crate::source::{self, Loaded};
use denavit_dh::Gauge;
use denavit_dh::matching::{self, Match, Verdict};
use denavit_export::sources::{Stated, VendorReading};
use denavit_export::{Sheet, formats, matched, sources};
use denavit_load::TableOptions;
use denavit_model::Chain;
use denavit_model::notes::Noted;

/// Runs the command.
pub fn run(arguments: &TableArguments) -> Result<Status, Failure> {
    let units = super::units(&arguments.units)?;
    let format = formats::named(&arguments.format).expect("the argument parser knows the formats");
    let loaded = source::load(&arguments.robot.robot, &arguments.robot.source)?;
    if let Some(vendor) = &arguments.r#match {
        return matched(arguments, &loaded, vendor);
    }
    let made = loaded.table(&arguments.robot.selection(), &options(arguments))?;
    let Noted { value: table, notes } = made.table;
    let source = &arguments.robot.robot;
    let sheet = Sheet { table: &table, convention: made.convention, units, notes: &notes, source, gauge: made.gauge };
    let text = (format.render)(&sheet)?;
    if format.name == "csv" {
        output::remark(&notes);
    }
    super::deliver(arguments.output.as_deref(), &text)?;
    Ok(Status::Same)
}

fn matched(arguments: &TableArguments, loaded: &Loaded, vendor: &str) -> Result<Status, Failure> {
    let units = super::units(&arguments.units)?;
    let (file, text) = source::read_text(vendor)?;
    let convention = arguments.convention.map(ConventionName::convention);
    let given = Stated { convention, ..Stated::default() }.or(source::stated(&arguments.robot.source)?);
    let readings = sources::read_vendor_table(&file, &text, given).map_err(denavit_load::LoadError::from)?;
    let Noted { value: chain, notes } = loaded.chain(&arguments.robot.selection())?;
    let found = best(&chain, &readings).map_err(|error| Failure::Argument(format!("{file}: {error}")))?;
    let text = match arguments.format.as_str() {
        "text" => matched::text(&chain, &file, &found, units),
        "json" => matched::json(&chain, &file, &found),
        other => return Err(Failure::Argument(format!("--match prints text or json, not {other}"))),
    };
    output::remark(&notes);
    super::deliver(arguments.output.as_deref(), &text)?;
    Ok(if found.found.verdict <= Verdict::Rounded { Status::Same } else { Status::Different })
}

/// The reading that matches best of those that nothing stated contradicts; where it is a mismatch, what would match.
fn best<'a>(chain: &Chain, readings: &'a [VendorReading]) -> Result<matched::Found<'a>, matching::MatchError> {
    let mut best: Option<(Match, &VendorReading)> = None;
    let mut otherwise: Option<(Match, &VendorReading)> = None;
    for reading in readings {
        let settled = best.as_ref().is_some_and(|(found, _)| found.verdict <= Verdict::Rounded);
        let hopeless = best.as_ref().is_none_or(|(found, _)| found.verdict == Verdict::Mismatch);
        if settled || (reading.against_what_is_stated && !hopeless) {
            break;
        }
        let found = matching::match_table(chain, &reading.table)?;
        let slot = if reading.against_what_is_stated { &mut otherwise } else { &mut best };
        if slot.as_ref().is_none_or(|(known, _)| {
            (found.verdict, found.placement.position_error) < (known.verdict, known.placement.position_error)
                && (found.verdict < known.verdict || found.verdict == Verdict::Mismatch)
        }) {
            *slot = Some((found, reading));
        }
    }
    let (found, reading) = best.expect("the first reading contradicts nothing");
    let otherwise = otherwise.filter(|(other, _)| other.verdict < Verdict::Mismatch);
    Ok(matched::Found { found, reading, otherwise: otherwise.map(|(other, reading)| (other.verdict, reading.read_as)) })
}

fn options(arguments: &TableArguments) -> TableOptions {
    TableOptions {
        convention: arguments.convention.map(ConventionName::convention),
        gauge: arguments.gauge.map(|name| match name {
            GaugeName::Simple => Gauge::Simple,
            GaugeName::Paper => Gauge::Paper,
        }),
        tolerance: arguments.robot.tolerance,
    }
}
