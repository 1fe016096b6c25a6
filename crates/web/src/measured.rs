//! `denavit calibrate` for a page.

use crate::answers::words;
use crate::memory;
use crate::question::{Calibrate, DataText, RobotText};
use denavit_calibrate::IdentifyOptions;
use denavit_calibrate::calibration::{CalibrateOptions, Calibration, HoldOut, Progress, calibrate_and_tell};
use denavit_calibrate::report::{findings, text};
use denavit_export::urdf;
use denavit_identify::proportion::within_proportion;
use denavit_load::Loaded;
use denavit_measurements::import::{self, ImportOptions, Map};
use denavit_measurements::{self, Loaded as Data, Units};
use denavit_model::Chain;
use denavit_trace::TraceOptions;
use denavit_trace::infer::CurveOptions;
use serde_json::{Value, json};
use std::ops::ControlFlow;

/// The seed of the rows that are held out, the command line's.
const SEED: u64 = 0;

/// Every column of a file with its first values and what it is likely to be; and the result of reading the file as the map
/// states, or by its column names without a map.
pub fn columns(source: &RobotText, data: &DataText, units: &str, map: Option<&str>) -> Result<Value, String> {
    let chain = source.load()?.chain(&source.selection()).map_err(words)?.value;
    let outlined = import::outline(&data.bytes()?, &chain);
    let columns = outlined.map_err(|problem| format!("{}: {problem}", data.file))?;
    let tried = import_options(map).and_then(|options| read(data, &chain, units, &options));
    let joints: Vec<&str> = chain.coordinates().iter().map(|joint| joint.name.as_str()).collect();
    let (problem, rows, taken) = match tried {
        Ok(read) => (None, Some(read.data.len()), read.columns),
        Err(problem) => (Some(problem), None, Vec::new()),
    };
    Ok(json!({ "columns": columns, "joints": joints, "problem": problem, "rows": rows, "taken": taken }))
}

fn import_options(map: Option<&str>) -> Result<ImportOptions, String> {
    let map = map.map(|text| Map::read("the columns", text).map_err(words)).transpose()?;
    Ok(ImportOptions { map, ..ImportOptions::default() })
}

fn read(data: &DataText, chain: &Chain, units: &str, options: &ImportOptions) -> Result<Data, String> {
    let units: Units = units.parse().map_err(words)?;
    denavit_measurements::read_export(&data.file, &*data.bytes()?, chain, units, options).map_err(words)
}

/// The calibration as JSON, as text and as the report's page, with the calibrated URDF and effects.
pub fn calibrated(asked: &Calibrate) -> Result<Value, String> {
    let source = &asked.source;
    let loaded = source.load()?;
    let chain = loaded.chain(&source.selection()).map_err(words)?.value;
    if chain.joints().is_empty() {
        return Err(format!("{}: nothing moves between \"{}\" and \"{}\"", source.file, chain.base(), chain.tip()));
    }
    within_proportion(&chain).map_err(words)?;
    let statics = loaded.statics(&chain, source.reading());
    let options = import_options(asked.map.as_deref())?;
    let data = read(&asked.data, &chain, &asked.units, &options)?;
    let test = asked.test.as_ref().map(|test| read(test, &chain, &asked.units, &options)).transpose()?;
    let said = data.notes.iter().chain(test.iter().flat_map(|test| &test.notes));
    let notes: Vec<String> = said.map(ToString::to_string).collect();
    let identify = IdentifyOptions::axes(&chain);
    let options = CalibrateOptions {
        hold_out: asked.hold_out.map(|share| HoldOut { share, seed: SEED }),
        trace: (asked.effects == "auto").then(|| TraceOptions::new(identify.clone())),
        curves: (asked.effects == "curves").then(CurveOptions::default),
        average: asked.effects == "auto",
        identify,
        noise: true,
        other_chains: Vec::new(),
    };
    let columns = data.columns.clone();
    let mut tell = |progress: Progress| {
        memory::progress(match progress {
            Progress::Geometry => "fitting the geometry",
            Progress::Effects => "searching for effects",
            Progress::Curves => "fitting error curves of the joints",
            Progress::Judgement => "judging on rows held out",
        });
        ControlFlow::Continue(())
    };
    let test = test.map(|test| test.data.placed_again());
    let mut result = calibrate_and_tell(&chain, &statics, data.data, test, &options, &mut tell).map_err(words)?;
    result.report.columns = columns;
    let arm = result.arm().chain();
    let urdf = match &loaded {
        Loaded::Robot(tree) => Some(urdf::with_chain(tree, &arm, source.reading()).map_err(words)?.value),
        _ => None,
    };
    Ok(json!({
        "text": result.report.to_json() + "\n",
        "words": text::report(&result),
        "urdf": urdf,
        "effects": result.effects(&statics).to_json(),
        "notes": notes,
        "said": found(&result),
        "residuals": residuals(&chain, &result),
        "tried": tried(&result),
    }))
}

/// What was found, as sentences of the report: heading and end of the list, and each effect; `None` where nothing
/// was searched for.
fn found(result: &Calibration) -> Value {
    let Some(trace) = &result.trace else { return Value::Null };
    let effects: Vec<Value> = findings::named_first(trace)
        .into_iter()
        .map(|finding| json!({ "said": findings::said(finding, trace), "probability": finding.probability }))
        .collect();
    json!({
        "heading": findings::heading(trace),
        "effects": effects,
        "structured": trace.unexplained.structured,
        "ending": findings::ending(trace),
    })
}

/// The search's first pass: the best candidate of each kind at each place, and by how much it lowers the criterion.
fn tried(result: &Calibration) -> Value {
    let cells = result.trace.iter().flat_map(|trace| &trace.scan);
    cells.map(|cell| json!({ "kind": cell.kind.name(), "place": cell.place, "delta_bic": cell.delta_bic })).collect()
}

/// For every stage and row fitted: where the drawn tip is at its reading, and the residual of the measured position, both m in
/// the base frame; rows without a place in space are left out.
fn residuals(chain: &Chain, result: &Calibration) -> Value {
    let (readings, width) = (&result.train.readings, chain.coordinates().len());
    let stages = result.residuals().into_iter().map(|stage| {
        let rows: Vec<Value> = stage
            .train
            .iter()
            .filter_map(|residual| {
                let reading = readings.get(residual.row * width..(residual.row + 1) * width)?;
                let at = chain.fk(reading).translation.vector;
                Some(json!({ "row": residual.row, "at": at.as_slice(), "left": residual.place.as_slice(), "q": reading }))
            })
            .collect();
        json!({ "stage": stage.name, "rows": rows })
    });
    stages.collect()
}
