//! `denavit table`: the Denavit-Hartenberg table of a chain.

use crate::args::{ConventionName, GaugeName, RobotArguments, TableArguments};
use crate::failure::Failure;
use crate::output::{self, Status};
use crate::source::{self, Loaded};
use denavit_dh::convert::{HAYATI_BELOW, table};
use denavit_dh::matching::{self, Match, Verdict};
use denavit_dh::{Convention, Gauge, NearParallel, Options, Parallelism, Table};
use denavit_export::sources::{Stated, VendorReading};
use denavit_export::urdf::read_off;
use denavit_export::{Sheet, formats, matched, sources};
use denavit_model::notes::{Note, Noted};
use denavit_model::{Chain, Reading};

/// Runs the command.
pub fn run(arguments: &TableArguments) -> Result<Status, Failure> {
    let units = super::units(&arguments.units)?;
    let format = formats::named(&arguments.format).expect("the argument parser knows the formats");
    let loaded = source::load(&arguments.robot.robot, &arguments.robot.source)?;
    if let Some(vendor) = &arguments.r#match {
        return matched(arguments, &loaded, vendor);
    }
    let asked = Asked { convention: arguments.convention.map(ConventionName::convention), gauge: arguments.gauge };
    let Made { table, notes, convention, gauge } = made(&arguments.robot, &loaded, &asked)?;
    let sheet = Sheet { table: &table, convention, units, notes: &notes, source: &arguments.robot.robot, gauge };
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
    let readings = sources::read_vendor_table(&file, &text, given)?;
    let Noted { value: chain, notes } = loaded.chain(&arguments.robot)?;
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

/// What is asked of a table; what is not named is as the source has it.
#[derive(Debug, Clone, Copy, Default)]
pub struct Asked {
    /// How to group the rows.
    pub convention: Option<Convention>,
    /// How to choose what the geometry leaves free.
    pub gauge: Option<GaugeName>,
}

/// A table and what must be said of it.
pub struct Made {
    /// The numbers.
    pub table: Table,
    /// What was read otherwise than written, and other findings.
    pub notes: Vec<Note>,
    /// How its rows are grouped.
    pub convention: Convention,
    /// How the gauge was chosen: `file`, `simple` or `paper`.
    pub gauge: &'static str,
}

/// The table of a chain, the same for every command: a file's own numbers regrouped, or new ones from the chain.
pub fn made(robot: &RobotArguments, loaded: &Loaded, asked: &Asked) -> Result<Made, Failure> {
    let convention = match (asked.convention, loaded) {
        (Some(asked), _) => asked,
        (None, Loaded::Table { convention, .. }) => *convention,
        (None, _) => Convention::Distal,
    };
    let hayati = convention == Convention::Hayati;
    // Hayati's rows are given to those who ask for them, or ask for nothing.
    let as_asked =
        |table: &Table| asked.convention.is_none() || table.rows.iter().any(|row| row.beta().is_some()) == hayati;
    if let (Loaded::Table { table, .. }, None) = (loaded, asked.gauge)
        && as_asked(table)
    {
        return Ok(Made { table: table.clone(), notes: Vec::new(), convention, gauge: "file" });
    }
    let Noted { value: chain, mut notes } = loaded.chain(robot)?;
    if let (Loaded::Robot(tree), None, false) = (loaded, asked.gauge, hayati) {
        // A file whose joint origins are D-H rows has chosen its gauge.
        let reading = if robot.exact { Reading::AsWritten } else { Reading::Intended };
        let own = read_off(tree, robot.base.as_deref(), robot.tip.as_deref(), reading);
        if let Some(table) = own.filter(as_asked) {
            return Ok(Made { table, notes, convention, gauge: "file" });
        }
    }
    let made = table(&chain, &options(robot, asked.gauge, convention))
        .map_err(|source| Failure::Chain { file: robot.robot.clone(), source })?;
    notes.extend(made.notes.into_iter().filter(|note| !(hayati && matches!(note, Note::FarNumber { .. }))));
    let gauge = if asked.gauge == Some(GaugeName::Paper) { "paper" } else { "simple" };
    Ok(Made { table: made.value, notes, convention, gauge })
}

fn options(robot: &RobotArguments, gauge: Option<GaugeName>, convention: Convention) -> Options {
    let hayati = convention == Convention::Hayati;
    // Hayati's numbers need no axes made parallel.
    let exact = robot.exact || hayati || robot.tolerance <= 0.0;
    Options {
        parallelism: if exact { Parallelism::Exact } else { Parallelism::Within { angle: robot.tolerance } },
        gauge: if gauge == Some(GaugeName::Paper) { Gauge::Paper } else { Gauge::Simple },
        near_parallel: if hayati { NearParallel::HayatiBelow(HAYATI_BELOW) } else { NearParallel::Dh },
    }
}
