//! `denavit calibrate`: from measured data to a calibrated model.

use crate::args::CalibrateArguments;
use crate::failure::Failure;
use crate::output::{self, Status};
use crate::source::{self, Loaded};
use denavit_calibrate::IdentifyOptions;
use denavit_calibrate::calibration::{CalibrateOptions, HoldOut, calibrate};
use denavit_calibrate::effects::catalogue::{KINDS, Kind};
use denavit_calibrate::effects::driver::Statics;
use denavit_calibrate::measurements::{self, Measurements, Units};
use denavit_calibrate::report::text;
use denavit_calibrate::trace::TraceOptions;
use denavit_dh::convert::{HAYATI_BELOW, table};
use denavit_dh::{Convention, NearParallel, Options, Parallelism};
use denavit_export::{FORMATS, Sheet, urdf};
use denavit_model::{Chain, Reading};
use std::path::Path;

/// Runs the command.
pub fn run(arguments: &CalibrateArguments) -> Result<Status, Failure> {
    let robot = &arguments.robot;
    let loaded = source::load(&robot.robot, &robot.xacro)?;
    let noted = loaded.chain(robot)?;
    output::remark(&noted.notes);
    let chain = noted.value;
    let statics = match &loaded {
        Loaded::Robot(tree) => Statics::of(tree, &chain),
        _ => Statics::of_chain(&chain),
    };
    let data = read(&arguments.data, &chain, &arguments.units)?;
    let test = arguments.test.as_ref().map(|file| read(file, &chain, &arguments.units)).transpose()?;
    let options = options(arguments, &chain)?;
    let result = calibrate(&chain, &statics, data, test, &options)?;
    let calibrated = result.arm().chain();
    // Every file is made before any is written.
    let mut files: Vec<(&Path, String)> = Vec::new();
    if let Some(path) = &arguments.json {
        files.push((path, result.report.to_json()));
    }
    if let Some(path) = &arguments.urdf {
        let Loaded::Robot(tree) = &loaded else {
            return Err(Failure::Argument("--urdf needs a URDF as its source; take --dh for a table".into()));
        };
        let reading = if robot.exact { Reading::AsWritten } else { Reading::Intended };
        let written = urdf::with_chain(tree, &calibrated, reading)?;
        output::remark(&written.notes);
        files.push((path, written.value));
    }
    if let Some(path) = &arguments.dh {
        files.push((path, dh_table(path, &calibrated, &robot.robot)?));
    }
    for (path, text) in files {
        output::write_file(path, text.as_bytes())?;
    }
    output::print(&text::calibration(&result))?;
    Ok(Status::Same)
}

fn read(file: &str, chain: &Chain, units: &str) -> Result<Measurements, Failure> {
    let units: Units = units.parse().map_err(|error| Failure::Argument(format!("--units: {error}")))?;
    let (name, text) = source::read_text(file)?;
    let loaded = measurements::read(&name, text.as_bytes(), chain, units)?;
    for note in &loaded.notes {
        output::mention(format!("{name}: {note}"));
    }
    Ok(loaded.data)
}

fn options(arguments: &CalibrateArguments, chain: &Chain) -> Result<CalibrateOptions, Failure> {
    let identify = IdentifyOptions::axes(chain);
    let trace = match arguments.effects.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        ["none"] => None,
        ["auto"] => Some(Vec::new()),
        ref words => Some(words.iter().map(|word| kind(word)).collect::<Result<Vec<Kind>, Failure>>()?),
    };
    let trace = match trace {
        None => None,
        Some(kinds) => Some(TraceOptions {
            kinds,
            max_effects: arguments.max_effects,
            gear_ratios: gear_ratios(&arguments.gear_ratio, chain)?,
            ..TraceOptions::new(identify.clone())
        }),
    };
    let hold_out = arguments.hold_out.map(|share| HoldOut { share, seed: arguments.seed });
    Ok(CalibrateOptions { identify, hold_out, trace })
}

fn kind(word: &str) -> Result<Kind, Failure> {
    Kind::named(word).ok_or_else(|| {
        let names: Vec<&str> = KINDS.iter().map(|entry| entry.name).collect();
        Failure::Argument(format!(
            "--effects: \"{word}\" is no kind of effect; write none, auto, or of {}",
            names.join(", ")
        ))
    })
}

fn gear_ratios(written: &[String], chain: &Chain) -> Result<Vec<Option<f64>>, Failure> {
    let mut ratios = Vec::new();
    for word in written {
        let wrong = |why: &str| Failure::Argument(format!("--gear-ratio: \"{word}\" {why}"));
        let (name, ratio) = word.split_once('=').ok_or_else(|| wrong("has no joint; write NAME=RATIO"))?;
        let joint = chain.joints().iter().position(|joint| joint.name == name);
        let joint = joint.ok_or_else(|| wrong("names no joint of the chain"))?;
        let ratio = ratio.parse::<f64>().ok().filter(|ratio| ratio.is_finite() && *ratio != 0.0);
        ratios.resize(chain.joints().len(), None);
        ratios[joint] = Some(ratio.ok_or_else(|| wrong("has no number"))?);
    }
    Ok(ratios)
}

/// The calibrated table: Hayati's rows where axes are nearly parallel, as the numbers then stay small.
fn dh_table(path: &Path, calibrated: &Chain, source: &str) -> Result<String, Failure> {
    let extension = path.extension().map_or_else(String::new, |extension| extension.to_string_lossy().into_owned());
    let format = FORMATS.iter().find(|format| format.extension == extension).ok_or_else(|| {
        let known: Vec<&str> = FORMATS.iter().map(|format| format.extension).collect();
        Failure::Argument(format!(
            "--dh {}: the extension chooses the format; take one of {}",
            path.display(),
            known.join(", ")
        ))
    })?;
    let options = Options {
        parallelism: Parallelism::Exact,
        near_parallel: NearParallel::HayatiBelow(HAYATI_BELOW),
        ..Options::default()
    };
    let made =
        table(calibrated, &options).map_err(|error| Failure::Chain { file: source.to_owned(), source: error })?;
    let sheet = Sheet {
        table: &made.value,
        convention: Convention::Hayati,
        units: denavit_export::Units::default(),
        notes: &made.notes,
        source,
        gauge: "simple",
    };
    Ok((format.render)(&sheet)?)
}
