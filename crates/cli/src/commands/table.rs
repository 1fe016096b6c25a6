//! `denavit table`: the Denavit-Hartenberg table of a chain.

use crate::args::{ConventionName, GaugeName, TableArguments};
use crate::delivery::Delivery;
use crate::failure::Failure;
use crate::output::{self, Status};
use crate::source::{self, Loaded};
use denavit_dh::Gauge;
use denavit_dh::matching::Verdict;
use denavit_export::formats::json;
use denavit_export::sources::Stated;
use denavit_export::{Sheet, formats, matched, sources};
use denavit_load::TableOptions;
use denavit_model::notes::Noted;

/// Runs the command.
pub fn run(arguments: &TableArguments) -> Result<Status, Failure> {
    let units = super::units(&arguments.units)?;
    let format = formats::named(&arguments.format).expect("the argument parser knows the formats");
    let inputs = arguments.robot.files().chain(arguments.r#match.as_deref());
    let delivery = Delivery::of(arguments.output.as_deref(), &arguments.json, inputs)?;
    let loaded = source::load(&arguments.robot.robot, &arguments.robot.source)?;
    if let Some(vendor) = &arguments.r#match {
        return matched(arguments, &delivery, &loaded, vendor);
    }
    let made = loaded.table(&arguments.robot.selection(), &options(arguments))?;
    let Noted { value: table, notes } = made.table;
    let source = &arguments.robot.robot;
    let sheet = Sheet { table: &table, convention: made.convention, units, notes: &notes, source, gauge: made.gauge };
    if format.name == "csv" && delivery.wants_own() {
        output::remark(&notes);
    }
    delivery.deliver(|| Ok((format.render)(&sheet)?), || Ok((json::FORMAT.render)(&sheet)?))?;
    Ok(Status::Same)
}

fn matched(arguments: &TableArguments, delivery: &Delivery, loaded: &Loaded, vendor: &str) -> Result<Status, Failure> {
    let units = super::units(&arguments.units)?;
    let (file, text) = source::read_text(vendor)?;
    let convention = arguments.convention.map(ConventionName::convention);
    let given = Stated { convention, ..Stated::default() }.or(source::stated(&arguments.robot.source)?);
    let readings = sources::read_vendor_table(&file, &text, given).map_err(denavit_load::LoadError::from)?;
    let said = sources::vendor_notes(&file, &text, given).map_err(denavit_load::LoadError::from)?;
    said.iter().for_each(output::mention);
    let Noted { value: chain, notes } = loaded.chain(&arguments.robot.selection())?;
    let found = matched::best(&chain, &readings).map_err(|error| Failure::Argument(format!("{file}: {error}")))?;
    let json = || Ok(matched::json(&chain, &file, &found));
    let own = || match arguments.format.as_str() {
        "text" => Ok(matched::text(&chain, &file, &found, units)),
        "json" => json(),
        other => Err(Failure::Argument(format!("--match prints text or json, not {other}"))),
    };
    output::remark(&notes);
    delivery.deliver(own, json)?;
    Ok(if found.found.verdict <= Verdict::Rounded { Status::Same } else { Status::Different })
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
