//! `denavit calibrate`: from measured data to a calibrated model.

use crate::args::CalibrateArguments;
use crate::failure::Failure;
use crate::measured::{self, MeasuredRobot, Robot};
use crate::output::{self, Outputs, Slot, Status};
use crate::progress::Spinner;
use crate::source::{self, Loaded};
use denavit_calibrate::calibration::contract::{CalibrationReport, Identified};
use denavit_calibrate::calibration::placed_anew::PlacedAnew;
use denavit_calibrate::calibration::{Calibration, HoldOut, Progress, calibrate_and_tell};
use denavit_calibrate::report::deltas::{self, Nominal};
use denavit_calibrate::report::{html, text};
use denavit_dh::convert::{HAYATI_BELOW, table};
use denavit_dh::nearest::{Parallels, nearest};
use denavit_dh::{Convention, NearParallel, Options, Parallelism};
use denavit_export::deltas as written;
use denavit_export::makers::{self, Calibrated, Maker};
use denavit_export::offsets::{self, Offset, Offsets};
use denavit_export::{FORMATS, Format, RenderError, Sheet, formats, urdf};
use denavit_identify::proportion::can_be_identified;
use denavit_load::measured::{DataFile, Rows, RowsAsked, SearchAsked, other_chains, prior_read, rows, search};
use denavit_measurements::Units;
use denavit_measurements::import::{self, ImportOptions};
use denavit_model::{Chain, Tips};
use std::ops::ControlFlow;
use std::path::Path;
use std::sync::Arc;

/// Runs the command.
pub fn run(arguments: &CalibrateArguments) -> Result<Status, Failure> {
    let mut inputs: Vec<Option<&str>> = arguments.data.iter().map(|file| Some(file.as_str())).collect();
    inputs.extend([
        Some(arguments.robot.robot.as_str()),
        arguments.test.as_deref(),
        arguments.prior.as_deref(),
        arguments.camera.camera.as_deref(),
    ]);
    measured::one_standard_input(&inputs)?;
    if arguments.columns_draft {
        return draft(arguments);
    }
    output::gather_notes();
    let places = Places::of(arguments)?;
    let MeasuredRobot { robot, tips } = measured::robot_with_tips(&arguments.robot)?;
    can_be_identified(&robot.chain)?;
    let asked = search_asked(arguments)?;
    let mut options = search(&asked, &robot.chain)?;
    let formats = output_formats(arguments, &robot, &tips)?;
    let asked_rows = rows_asked(arguments, &robot.chain, &tips)?;
    let Rows { data, test, columns, notes, origin } = rows(&asked_rows, &robot.chain)?;
    measured::mention(&notes);
    if !tips.several() {
        options.other_chains = other_chains(&robot.loaded, &robot.chain, &data);
    }
    let spinner = Spinner::start("reading");
    let mut result = calibrate_and_tell(&robot.chain, &robot.statics, data, test, &options, &mut |progress| {
        spinner.say(match progress {
            Progress::Geometry => "fitting the geometry",
            Progress::Effects => "searching for effects",
            Progress::Curves => "fitting error curves of the joints",
            Progress::Judgement => "evaluating on held-out rows",
        });
        ControlFlow::Continue(())
    })?;
    drop(spinner);
    let said = result.report.read_as.as_ref().map(|read_as| read_as.said.clone());
    let said = said.into_iter().chain(result.report.placed_anew.as_ref().map(PlacedAnew::said));
    measured::mention(&said.collect::<Vec<_>>());
    result.report.columns = columns;
    result.report.origin = origin;
    result.report.origin.files.extend(prior_read(&asked)?);
    let texts = texts(arguments, &places, &formats, &robot, &result)?;
    places.outputs.write(&texts)?;
    if !places.outputs.take_standard_output() {
        output::print_sentences(&text::report(&result))?;
    }
    output::tell_notes(arguments.verbose);
    Ok(Status::Same)
}

/// Prints a map of the data's columns to start from.
fn draft(arguments: &CalibrateArguments) -> Result<Status, Failure> {
    let chain = measured::robot_with_tips(&arguments.robot)?.robot.chain;
    let [file] = &arguments.data[..] else {
        return Err(Failure::Argument("--columns-draft: name one file of data".into()));
    };
    let (name, bytes) = source::read_bytes(file)?;
    let map = import::draft(&name, &bytes, &chain).map_err(|error| Failure::Argument(format!("{name}: {error}")))?;
    output::print(&map)?;
    Ok(Status::Same)
}

/// Where the outputs go.
struct Places {
    outputs: Outputs,
    json: Option<Slot>,
    html: Option<Slot>,
    urdf: Option<Slot>,
    /// A table for each tip, in their order.
    dh: Vec<Slot>,
    /// Nominal, actual and delta of each tip, in their order.
    deltas: Vec<Slot>,
    /// The effects of each tip, in their order.
    effects: Vec<Slot>,
    residuals: Option<Slot>,
    makers: Vec<(Slot, &'static Maker)>,
    offsets: Vec<(Slot, &'static offsets::Form)>,
}

impl Places {
    fn of(arguments: &CalibrateArguments) -> Result<Self, Failure> {
        let sockets = arguments.socket.iter().filter_map(|word| Some(word.split_once('=')?.1));
        let inputs = arguments.data.iter().map(String::as_str).chain(arguments.test.as_deref()).chain(sockets);
        let inputs = inputs.chain(arguments.import.files()).chain(arguments.camera.camera.as_deref());
        let inputs = inputs.chain(arguments.prior.as_deref()).chain(arguments.nominal.as_deref());
        let mut outputs = Outputs::beside(inputs.chain(arguments.robot.files()));
        let pairs = arguments.out_for.chunks_exact(2);
        let makers = pairs.map(|pair| {
            let maker = makers::named(&pair[0])?;
            Ok((outputs.add("--out-for", Path::new(&pair[1]))?, maker))
        });
        let makers = makers.collect::<Result<Vec<_>, Failure>>()?;
        let pairs = arguments.offsets_out.chunks_exact(2);
        let forms = pairs.map(|pair| {
            let form = offsets::named(&pair[0])?;
            Ok((outputs.add("--offsets-out", Path::new(&pair[1]))?, form))
        });
        let offsets = forms.collect::<Result<Vec<_>, Failure>>()?;
        Ok(Self {
            makers,
            offsets,
            json: outputs.add_if("--json", arguments.json.place())?,
            html: outputs.add_if("--html", arguments.html.as_deref())?,
            urdf: outputs.add_if("--urdf", arguments.urdf.as_deref())?,
            dh: of_tips(arguments, arguments.dh.as_deref(), |path| outputs.add("--dh", path))?,
            deltas: of_tips(arguments, arguments.deltas.as_deref(), |path| outputs.add("--deltas", path))?,
            effects: of_tips(arguments, arguments.effects_out.as_deref(), |path| outputs.add("--effects-out", path))?,
            residuals: outputs.add_if("--residuals", arguments.residuals.as_deref())?,
            outputs,
        })
    }
}

/// A slot for the file of each tip: the one that was named, or beside it `<name>_<tip>` where there are several.
fn of_tips(
    arguments: &CalibrateArguments,
    path: Option<&Path>,
    mut add: impl FnMut(&Path) -> Result<Slot, Failure>,
) -> Result<Vec<Slot>, Failure> {
    let Some(path) = path else { return Ok(Vec::new()) };
    let tips = &arguments.robot.tip.tips;
    if tips.len() < 2 {
        return Ok(vec![add(path)?]);
    }
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    let extension = path.extension().unwrap_or_default().to_string_lossy();
    let of = |tip: &String| path.with_file_name(format!("{stem}_{}.{extension}", tip.replace('/', "_")));
    tips.iter().map(|tip| add(&of(tip))).collect()
}

/// The requested formats of the calibrated robot.
struct OutputFormats<'a> {
    /// The tree that a calibrated URDF is made of.
    urdf: Option<&'a denavit_model::Robot>,
    /// The format of the table.
    dh: Option<&'static Format>,
    /// What deltas are counted from.
    nominal: Option<Nominal>,
}

/// Formats that can hold everything that a calibration may find: β, pitches and scales.
const ROOMY: [&str; 5] = ["csv", "json", "md", "tex", "text"];

/// Refuses what cannot be made before any work is done: each format is tried on the robot as drawn.
fn output_formats<'a>(
    arguments: &CalibrateArguments,
    robot: &'a Robot,
    tips: &Tips,
) -> Result<OutputFormats<'a>, Failure> {
    if tips.several() && !arguments.out_for.is_empty() {
        let message = "--out-for: a maker's file holds one arm; write the calibrated robot with --urdf";
        return Err(Failure::Argument(message.into()));
    }
    let chains = chains(&robot.chain, tips)?;
    let freedom = &arguments.freedom;
    let more_than_axes = !freedom.scales.is_empty() || !freedom.pitches.is_empty();
    let urdf = match (&arguments.urdf, &robot.loaded) {
        (None, _) => None,
        (Some(_), _) if more_than_axes => {
            let message = "--urdf: a URDF cannot hold what --scales and --pitches fit; write --dh FILE.csv or FILE.json, \
                           which can, or leave them out";
            return Err(Failure::Argument(message.into()));
        }
        (Some(_), Loaded::Robot(tree)) => {
            urdf::with_chains(tree, &chains, arguments.robot.reading())?;
            Some(tree.as_ref())
        }
        _ => return Err(Failure::Argument("--urdf needs a URDF as its source; write a table with --dh".into())),
    };
    let nominal = nominal(arguments)?;
    let Some(path) = &arguments.dh else { return Ok(OutputFormats { urdf, dh: None, nominal }) };
    if tips.several() && path == Path::new("-") {
        let message = "--dh -: there is a table for each tip; name a file, and each is written beside it";
        return Err(Failure::Argument(message.into()));
    }
    let format = format_of(path)?;
    let refused = |why: &str| {
        let known = FORMATS.iter().filter(|format| ROOMY.contains(&format.name)).map(|format| format.extension);
        let known = known.collect::<Vec<_>>().join(", ");
        Failure::Argument(format!("--dh {}: {why}; name a file that ends in one of {known}", path.display()))
    };
    if more_than_axes && !ROOMY.contains(&format.name) {
        return Err(refused(&format!("{} cannot hold what --scales and --pitches fit", format.name)));
    }
    let tables = chains.iter().map(|chain| dh_table(format, chain, chain, &arguments.robot.robot));
    match tables.collect::<Result<Vec<_>, _>>() {
        Err(Failure::Render(RenderError::CannotHold { format, what, .. })) => {
            Err(refused(&format!("{format} has no {what}, which the calibrated table of this robot needs")))
        }
        Err(Failure::Render(other)) => Err(refused(&other.to_string())),
        tried => tried.map(|_| OutputFormats { urdf, dh: Some(format), nominal }),
    }
}

/// The chain to each tip.
fn chains(all: &Chain, tips: &Tips) -> Result<Vec<Chain>, Failure> {
    let chain = |tip: &denavit_model::Tip| tip.chain(all).map_err(|error| Failure::Argument(error.to_string()));
    tips.all().iter().map(chain).collect()
}

/// Every requested output: all are made before any is written.
fn texts(
    arguments: &CalibrateArguments,
    places: &Places,
    formats: &OutputFormats,
    robot: &Robot,
    result: &Calibration,
) -> Result<Vec<(Slot, String)>, Failure> {
    let arm = result.arm();
    let calibrated: Vec<Chain> = (0..arm.tips.all().len()).map(|tip| arm.chain_to(tip)).collect();
    let mut texts = Vec::new();
    if let Some(slot) = places.json {
        texts.push((slot, result.report.to_json() + "\n"));
    }
    if let Some(slot) = places.html {
        texts.push((slot, html::page(result)?));
    }
    if let (Some(slot), Some(tree)) = (places.urdf, formats.urdf) {
        let written = urdf::with_chains(tree, &calibrated, arguments.robot.reading())?;
        output::remark(&written.notes);
        texts.push((slot, written.value));
    }
    if let Some(format) = formats.dh {
        for (tip, (slot, chain)) in places.dh.iter().zip(&calibrated).enumerate() {
            texts.push((*slot, dh_table(format, chain, &arm.nominal_to(tip), &arguments.robot.robot)?));
        }
    }
    if let Some(nominal) = &formats.nominal {
        for (tip, slot) in places.deltas.iter().enumerate() {
            let found = deltas::of(result, tip, nominal).map_err(|error| refused_deltas(arguments, &error))?;
            let is_csv =
                arguments.deltas.as_deref().is_some_and(|path| path.extension().is_some_and(|end| end == "csv"));
            texts.push((*slot, if is_csv { written::csv(&found) } else { written::markdown(&found) }));
        }
    }
    let found: Vec<String> = result.report.effects.iter().map(|effect| effect.kind.clone()).collect();
    for (slot, maker) in &places.makers {
        let drawn = if let Loaded::Robot(tree) = &robot.loaded {
            Some((tree.as_ref(), arguments.robot.reading()))
        } else {
            None
        };
        let written = (maker.render)(&Calibrated { chain: &calibrated[0], drawn, effects: &found })?;
        written.left_out.iter().for_each(|what| output::mention(format!("--out-for {}: {what}", maker.name)));
        texts.push((*slot, written.text));
    }
    let zeros = offsets_of(&result.report);
    for (slot, form) in &places.offsets {
        let drawn = if let Loaded::Robot(tree) = &robot.loaded { Some(tree.as_ref()) } else { None };
        let written = (form.render)(&Offsets { joints: &zeros, drawn })?;
        written.left_out.iter().for_each(|what| output::mention(format!("--offsets-out {}: {what}", form.name)));
        texts.push((*slot, written.text));
    }
    if let Some(slot) = places.residuals {
        texts.push((slot, denavit_calibrate::calibration::rows::to_csv(&result.report.rows)));
    }
    let effects = result.effects(&robot.statics);
    for (tip, slot) in places.effects.iter().enumerate() {
        texts.push((*slot, effects.to_tip(tip).to_json()));
    }
    Ok(texts)
}

/// The zeros that were fitted, in the chain's order.
fn offsets_of(report: &CalibrationReport) -> Vec<Offset> {
    let of = |zero: &Identified| Offset {
        joint: zero.joint.clone(),
        zero: zero.change,
        std: zero.std,
        turns: zero.unit == "rad",
        determined: zero.is_determined(),
    };
    report.zeros().map(of).collect()
}

/// Options of what is fitted and searched for.
fn search_asked(arguments: &CalibrateArguments) -> Result<SearchAsked, Failure> {
    Ok(SearchAsked {
        scales: arguments.freedom.scales.clone(),
        pitches: arguments.freedom.pitches.clone(),
        zeros: arguments.zeros.clone(),
        effects: arguments.effects.clone(),
        max_effects: arguments.max_effects,
        mass: arguments.mass,
        gear_ratios: arguments.gear_ratio.clone(),
        prior: arguments.prior.as_deref().map(measured::bare_file).transpose()?,
        hold_out: arguments.hold_out.map(|share| HoldOut { share, seed: arguments.seed }),
    })
}

/// Training and test files.
fn rows_asked(arguments: &CalibrateArguments, chain: &Chain, tips: &Arc<Tips>) -> Result<RowsAsked, Failure> {
    if tips.several() && !arguments.socket.is_empty() {
        let message = "--socket: its files have no column that says which tip a row is of; calibrate one tip at a time";
        return Err(Failure::Argument(message.into()));
    }
    let units = measured::units(&arguments.units)?;
    let (sight, camera) = measured::sight_and_file(&arguments.camera)?.unzip();
    let import = ImportOptions {
        sight,
        tips: tips.several().then(|| tips.clone()),
        ..measured::import_options(&arguments.import)?
    };
    let read = |file: &String| {
        let read = measured::data_file_or_bag(file, units, import.clone(), &arguments.bag, chain)?;
        Ok::<_, Failure>(DataFile { camera: camera.clone(), ..read })
    };
    Ok(RowsAsked {
        data: arguments.data.iter().map(read).collect::<Result<_, _>>()?,
        sockets: arguments.socket.iter().map(|word| socket(word, units)).collect::<Result<_, _>>()?,
        distances: arguments.distance.clone(),
        test: arguments.test.as_ref().map(read).transpose()?,
        hold_out_setups: arguments.hold_out_setups.clone(),
    })
}

/// `LABEL=FILE`.
fn socket(word: &str, units: Units) -> Result<(String, DataFile), Failure> {
    let (label, file) =
        word.split_once('=').filter(|(label, file)| !label.is_empty() && !file.is_empty()).ok_or_else(|| {
            Failure::Argument(format!("--socket \"{word}\": write LABEL=FILE, such as front/0=front_0.csv"))
        })?;
    Ok((label.to_owned(), measured::data_file(file, units, ImportOptions::default())?))
}

fn format_of(path: &Path) -> Result<&'static Format, Failure> {
    if path == Path::new("-") {
        return Ok(&formats::text::FORMAT);
    }
    let extension = path.extension().map_or_else(String::new, |extension| extension.to_string_lossy().into_owned());
    FORMATS.iter().find(|format| format.extension == extension).ok_or_else(|| {
        let known: Vec<&str> = FORMATS.iter().map(|format| format.extension).collect();
        Failure::Argument(format!(
            "--dh {}: the extension chooses the format; end it in one of {}",
            path.display(),
            known.join(", ")
        ))
    })
}

/// The calibrated table on the branch of the drawn one, with Hayati's rows if axes are drawn parallel: the numbers then stay small.
fn dh_table(format: &Format, calibrated: &Chain, drawn: &Chain, source: &str) -> Result<String, Failure> {
    let failed = |error: denavit_model::ChainError| Failure::Chain { file: source.to_owned(), source: error };
    let options = Options {
        parallelism: Parallelism::Exact,
        near_parallel: NearParallel::HayatiBelow(HAYATI_BELOW),
        ..Options::default()
    };
    let given = table(drawn, &options).map_err(failed)?;
    let made = nearest(calibrated, &given.value, Parallels::Hayati).map_err(failed)?.in_one_table();
    let sheet = Sheet {
        table: &made,
        convention: Convention::Hayati,
        units: denavit_export::Units::default(),
        notes: &given.notes,
        source,
        gauge: "that of the drawing",
    };
    Ok((format.render)(&sheet)?)
}

/// The reference of the requested deltas: the maker's table, or the drawing's own.
fn nominal(arguments: &CalibrateArguments) -> Result<Option<Nominal>, Failure> {
    let Some(path) = &arguments.deltas else { return Ok(None) };
    let known = path == Path::new("-") || path.extension().is_some_and(|end| end == "csv" || end == "md");
    if !known {
        return Err(Failure::Argument(format!(
            "--deltas {}: name a file that ends in .csv or .md, or -",
            path.display()
        )));
    }
    let Some(file) = &arguments.nominal else {
        return Ok(Some(Nominal { table: None, parallels: Parallels::Hayati }));
    };
    match source::load_quietly(file, &arguments.robot.source)? {
        Loaded::Table { table, convention, .. } => {
            Ok(Some(Nominal { table: Some((table, convention)), parallels: Parallels::Hayati }))
        }
        _ => Err(Failure::Argument(format!("--nominal {file}: this is not a D-H table"))),
    }
}

fn refused_deltas(arguments: &CalibrateArguments, error: &deltas::DeltasError) -> Failure {
    let nominal = arguments.nominal.as_deref().unwrap_or(&arguments.robot.robot);
    Failure::Argument(format!("--deltas: {nominal}: {error}"))
}
