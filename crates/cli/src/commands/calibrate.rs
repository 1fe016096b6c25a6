//! `denavit calibrate`: from measured data to a calibrated model.

use crate::args::CalibrateArguments;
use crate::failure::Failure;
use crate::measured::{self, Robot};
use crate::output::{self, Status};
use crate::progress::Spinner;
use crate::source::Loaded;
use denavit_calibrate::IdentifyOptions;
use denavit_calibrate::calibration::{CalibrateOptions, Calibration, HoldOut, Progress, calibrate_and_tell};
use denavit_calibrate::effects::catalogue::{KINDS, Kind};
use denavit_calibrate::report::{html, text};
use denavit_calibrate::trace::TraceOptions;
use denavit_dh::convert::{HAYATI_BELOW, table};
use denavit_dh::{Convention, NearParallel, Options, Parallelism};
use denavit_export::makers::{self, Calibrated, Maker};
use denavit_export::{FORMATS, Format, Sheet, urdf};
use denavit_model::{Chain, Reading};
use std::path::Path;

/// Runs the command.
pub fn run(arguments: &CalibrateArguments) -> Result<Status, Failure> {
    measured::one_standard_input(&[Some(&arguments.robot.robot), Some(&arguments.data), arguments.test.as_deref()])?;
    let robot = measured::robot(&arguments.robot)?;
    let mut options = options(arguments, &robot.chain)?;
    let outputs = outputs(arguments, &robot.loaded)?;
    let read = |file: &str| measured::measurements(file, &robot.chain, &arguments.units);
    let (data, columns) = read(&arguments.data)?;
    let test = arguments.test.as_deref().map(read).transpose()?.map(|(test, _)| test);
    options.other_chains = measured::other_chains(&robot.loaded, &robot.chain, &data);
    let spinner = Spinner::start("reading");
    let mut result = calibrate_and_tell(&robot.chain, &robot.statics, data, test, &options, &mut |progress| {
        spinner.say(match progress {
            Progress::Geometry => "fitting the geometry",
            Progress::Effects => "searching for effects",
            Progress::Judgement => "judging on rows held out",
        });
    })?;
    drop(spinner);
    result.report.columns = columns;
    let files = files(arguments, &outputs, &robot, &result)?;
    output::write_files(&files)?;
    output::print(&text::report(&result))?;
    Ok(Status::Same)
}

/// What some outputs need.
struct Outputs<'a> {
    /// The tree that a calibrated URDF is made of.
    urdf: Option<(&'a Path, &'a denavit_model::Robot)>,
    /// The format of the table.
    dh: Option<(&'a Path, &'static Format)>,
    /// Makers' forms.
    makers: Vec<(&'a Path, &'static Maker)>,
}

/// Refuses what cannot be made before any work is done.
fn outputs<'a>(arguments: &'a CalibrateArguments, loaded: &'a Loaded) -> Result<Outputs<'a>, Failure> {
    let urdf = match (&arguments.urdf, loaded) {
        (None, _) => None,
        (Some(path), Loaded::Robot(tree)) => Some((path.as_path(), tree.as_ref())),
        _ => return Err(Failure::Argument("--urdf needs a URDF as its source; take --dh for a table".into())),
    };
    let dh = arguments.dh.as_deref().map(|path| format_of(path).map(|format| (path, format))).transpose()?;
    let pairs = arguments.out_for.chunks_exact(2);
    let makers = pairs.map(|pair| Ok((Path::new(&pair[1]), makers::named(&pair[0])?)));
    let makers = makers.collect::<Result<Vec<_>, Failure>>()?;
    Ok(Outputs { urdf, dh, makers })
}

/// Every file that was asked for: all are made before any is written.
fn files<'a>(
    arguments: &'a CalibrateArguments,
    outputs: &Outputs<'a>,
    robot: &Robot,
    result: &Calibration,
) -> Result<Vec<(&'a Path, String)>, Failure> {
    let calibrated = result.arm().chain();
    let mut files: Vec<(&Path, String)> = Vec::new();
    if let Some(path) = &arguments.json {
        files.push((path, result.report.to_json() + "\n"));
    }
    if let Some(path) = &arguments.html {
        files.push((path, html::page(result)?));
    }
    if let Some((path, tree)) = outputs.urdf {
        let reading = if arguments.robot.exact { Reading::AsWritten } else { Reading::Intended };
        let written = urdf::with_chain(tree, &calibrated, reading)?;
        output::remark(&written.notes);
        files.push((path, written.value));
    }
    if let Some((path, format)) = outputs.dh {
        files.push((path, dh_table(format, &calibrated, &arguments.robot.robot)?));
    }
    let found: Vec<String> = result.report.effects.iter().map(|effect| effect.kind.clone()).collect();
    for (path, maker) in &outputs.makers {
        let reading = if arguments.robot.exact { Reading::AsWritten } else { Reading::Intended };
        let drawn = if let Loaded::Robot(tree) = &robot.loaded { Some((tree.as_ref(), reading)) } else { None };
        let written = (maker.render)(&Calibrated { chain: &calibrated, drawn, effects: &found })?;
        written.left_out.iter().for_each(|what| output::mention(format!("--out-for {}: {what}", maker.name)));
        files.push((path, written.text));
    }
    if let Some(path) = &arguments.effects_out {
        files.push((path, result.effects(&robot.statics).to_json()));
    }
    Ok(files)
}

fn options(arguments: &CalibrateArguments, chain: &Chain) -> Result<CalibrateOptions, Failure> {
    let freedom = measured::freedom(chain, &arguments.freedom.scales, &arguments.freedom.pitches)?;
    let identify = IdentifyOptions { freedom, ..IdentifyOptions::axes(chain) };
    let trace = match arguments.effects.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        ["none"] => None,
        ["auto"] => Some(Vec::new()),
        ref words => Some(words.iter().map(|word| kind(word)).collect::<Result<Vec<Kind>, Failure>>()?),
    };
    let gear_ratios = gear_ratios(&arguments.gear_ratio, chain)?;
    let trace = trace.map(|kinds| TraceOptions {
        kinds,
        max_effects: arguments.max_effects,
        gear_ratios,
        ..TraceOptions::new(identify.clone())
    });
    let hold_out = arguments.hold_out.map(|share| HoldOut { share, seed: arguments.seed });
    Ok(CalibrateOptions { identify, hold_out, trace, other_chains: Vec::new() })
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

fn format_of(path: &Path) -> Result<&'static Format, Failure> {
    let extension = path.extension().map_or_else(String::new, |extension| extension.to_string_lossy().into_owned());
    FORMATS.iter().find(|format| format.extension == extension).ok_or_else(|| {
        let known: Vec<&str> = FORMATS.iter().map(|format| format.extension).collect();
        Failure::Argument(format!(
            "--dh {}: the extension chooses the format; take one of {}",
            path.display(),
            known.join(", ")
        ))
    })
}

/// The calibrated table: Hayati's rows where axes are nearly parallel, as the numbers then stay small.
fn dh_table(format: &Format, calibrated: &Chain, source: &str) -> Result<String, Failure> {
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
