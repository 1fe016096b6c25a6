//! `denavit table`: the Denavit-Hartenberg table of a chain.

use crate::args::{ConventionName, GaugeName, TableArguments};
use crate::failure::Failure;
use crate::output::{self, Status};
use crate::source::{self, Loaded};
use denavit_dh::convert::{HAYATI_BELOW, table};
use denavit_dh::matching::{self, Verdict};
use denavit_dh::{Convention, Gauge, NearParallel, Options, Parallelism, Table};
use denavit_export::urdf::read_off;
use denavit_export::{Sheet, formats, matched, sources};
use denavit_model::Reading;
use denavit_model::notes::{Note, Noted};

/// Runs the command.
pub fn run(arguments: &TableArguments) -> Result<Status, Failure> {
    let units = super::units(&arguments.units)?;
    let format = formats::named(&arguments.format).expect("the argument parser knows the formats");
    let loaded = source::load(&arguments.robot.robot, &arguments.robot.source)?;
    if let Some(vendor) = &arguments.r#match {
        return matched(arguments, &loaded, vendor);
    }
    let convention = convention(arguments, &loaded);
    let Noted { value: table, notes } = made(arguments, &loaded, convention)?;
    let gauge = if arguments.gauge == Some(GaugeName::Paper) { "paper" } else { "simple" };
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
    let vendor = sources::read_vendor_table(&file, &text)?;
    let Noted { value: chain, notes } = loaded.chain(&arguments.robot)?;
    let found =
        matching::match_table(&chain, &vendor).map_err(|error| Failure::Argument(format!("{file}: {error}")))?;
    let text = match arguments.format.as_str() {
        "text" => matched::text(&chain, &file, &vendor, &found, units),
        "json" => matched::json(&chain, &file, &found),
        other => return Err(Failure::Argument(format!("--match prints text or json, not {other}"))),
    };
    output::remark(&notes);
    super::deliver(arguments.output.as_deref(), &text)?;
    Ok(if found.verdict <= Verdict::Rounded { Status::Same } else { Status::Different })
}

fn convention(arguments: &TableArguments, loaded: &Loaded) -> Convention {
    match (arguments.convention, loaded) {
        (Some(ConventionName::Proximal), _) => Convention::Proximal,
        (Some(ConventionName::Paper), _) => Convention::Paper,
        (Some(ConventionName::Hayati), _) => Convention::Hayati,
        (None, Loaded::Table { convention, .. }) => *convention,
        (Some(ConventionName::Distal) | None, _) => Convention::Distal,
    }
}

/// The table: a file's own numbers regrouped, or new ones from the chain.
fn made(arguments: &TableArguments, loaded: &Loaded, convention: Convention) -> Result<Noted<Table>, Failure> {
    if let (Loaded::Table { table, .. }, None) = (loaded, arguments.gauge) {
        let hayati = table.rows.iter().any(|row| row.beta().is_some());
        if hayati == (convention == Convention::Hayati) {
            return Ok(Noted { value: table.clone(), notes: Vec::new() });
        }
    }
    let Noted { value: chain, mut notes } = loaded.chain(&arguments.robot)?;
    if let (Loaded::Robot(tree), None, false) = (loaded, arguments.gauge, convention == Convention::Hayati) {
        // A file whose joint origins are D-H rows has chosen its gauge.
        let robot = &arguments.robot;
        let reading = if robot.exact { Reading::AsWritten } else { Reading::Intended };
        if let Some(table) = read_off(tree, robot.base.as_deref(), robot.tip.as_deref(), reading) {
            return Ok(Noted { value: table, notes });
        }
    }
    let options = options(arguments, convention);
    let made =
        table(&chain, &options).map_err(|source| Failure::Chain { file: arguments.robot.robot.clone(), source })?;
    notes.extend(
        made.notes
            .into_iter()
            .filter(|note| !(convention == Convention::Hayati && matches!(note, Note::FarNumber { .. }))),
    );
    Ok(Noted { value: made.value, notes })
}

fn options(arguments: &TableArguments, convention: Convention) -> Options {
    let hayati = convention == Convention::Hayati;
    // Hayati's numbers need no axes made parallel.
    let exact = arguments.robot.exact || hayati || arguments.robot.tolerance <= 0.0;
    Options {
        parallelism: if exact { Parallelism::Exact } else { Parallelism::Within { angle: arguments.robot.tolerance } },
        gauge: if arguments.gauge == Some(GaugeName::Paper) { Gauge::Paper } else { Gauge::Simple },
        near_parallel: if hayati { NearParallel::HayatiBelow(HAYATI_BELOW) } else { NearParallel::Dh },
    }
}
