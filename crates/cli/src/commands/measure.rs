//! `denavit measure`: each row of measurements as it comes, against what the rows before it predict.

mod growing;
mod touch;

use self::growing::{Growing, News};
use self::touch::Touch;
use crate::args::MeasureArguments;
use crate::failure::Failure;
use crate::measured;
use crate::output::{self, Outputs, Status};
use denavit_calibrate::IdentifyOptions;
use denavit_calibrate::apply::plan::PlanOptions;
use denavit_calibrate::calibration::CalibrateError;
use denavit_calibrate::calibration::monitor::{Monitor, MonitorOptions, RowStatus};
use denavit_calibrate::report::monitor as report;
use denavit_identify::proportion::can_be_identified;
use denavit_load::measured::{corners, freedom};
use denavit_measurements::import::{ImportOptions, ImportProblem};
use denavit_measurements::kinds::ObservationKind;
use denavit_measurements::{DataError, DataNote, MeasurementError, Measurements, Units, read_export};
use denavit_model::Chain;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::IsTerminal as _;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// Whether the user has had enough.
static INTERRUPTED: AtomicBool = AtomicBool::new(false);
/// How often the file is looked at.
const TICK: Duration = Duration::from_millis(100);

/// Runs the command.
pub fn run(arguments: &MeasureArguments) -> Result<Status, Failure> {
    let file = arguments.file.as_str();
    let (candidates, prior) = (arguments.candidates.as_deref(), arguments.prior.as_deref());
    measured::one_standard_input(&[Some(&arguments.robot.robot), Some(file), candidates, prior])?;
    refused(arguments)?;
    let inputs = arguments.robot.files().chain([file]).chain(candidates).chain(prior);
    let inputs = inputs.chain(arguments.import.files()).chain(arguments.camera.camera.as_deref());
    let mut outputs = Outputs::beside(inputs);
    let json = outputs.add_if("--json", arguments.json.place())?;
    let units = measured::units(&arguments.units)?;
    let chain = measured::robot(&arguments.robot)?.chain;
    can_be_identified(&chain)?;
    let import =
        ImportOptions { sight: measured::sight(&arguments.camera)?, ..measured::import_options(&arguments.import)? };
    let monitor = Monitor::new(&chain, options(arguments, &chain)?)?;
    // A handler that was there before leaves the exit code to it.
    let _ = ctrlc::set_handler(|| INTERRUPTED.store(true, Ordering::Relaxed));
    let touch = match (&arguments.touch, &import.plate) {
        (Some(readings), Some(plate)) => {
            Some(Touch::begin(&chain, units, &arguments.units, readings, Path::new(file), plate)?)
        }
        _ => None,
    };
    let reader = Reader { name: file.into(), chain: &chain, units, import, said: Vec::new() };
    let screen = Screen::new(&chain, units, json.is_some() && outputs.take_standard_output());
    let mut session = Session { reader, screen, fresh: monitor.clone(), monitor, restarts: 0, any_out: false, rows: 0 };
    match touch {
        Some(mut touch) => {
            while !INTERRUPTED.load(Ordering::Relaxed) && touch.next()? {
                session.follow(&mut Growing::open(file, false))?;
            }
            return Ok(if session.any_out { Status::Different } else { Status::Same });
        }
        None => session.follow(&mut Growing::open(file, arguments.watch))?,
    }
    if session.rows == 0 && !arguments.watch {
        return Err(Failure::Data(session.reader.read(b"", true).err().unwrap_or_else(nothing)));
    }
    if let Some(slot) = json.filter(|_| !session.screen.is_json) {
        outputs.write(&[(slot, std::mem::take(&mut session.screen.json))])?;
    }
    Ok(if session.any_out { Status::Different } else { Status::Same })
}

fn nothing() -> DataError {
    DataError { problems: Vec::new(), more: 0 }
}

fn refused(arguments: &MeasureArguments) -> Result<(), Failure> {
    let file = &arguments.file;
    let workbook = file.to_lowercase().ends_with(".xlsx");
    if crate::bags::is_bag(file) || workbook {
        let what = if workbook { "a workbook" } else { "a bag" };
        return Err(Failure::Argument(format!(
            "{file}: {what} does not grow row by row; write the rows as CSV while you measure, or calibrate with {what} when it \
             is complete"
        )));
    }
    if let Some(readings) = &arguments.touch
        && (file == "-" || readings == "-")
    {
        let message = "--touch waits for Enter on standard input; name files for --data and --touch";
        return Err(Failure::Argument(message.into()));
    }
    if arguments.watch && arguments.import.joints.is_some() {
        let message = "--joints: a robot program has a row for each row of a whole file; leave out --watch";
        return Err(Failure::Argument(message.into()));
    }
    Ok(())
}

fn options(arguments: &MeasureArguments, chain: &Chain) -> Result<MonitorOptions, Failure> {
    let free = freedom(chain, &arguments.freedom.scales, &arguments.freedom.pitches)?;
    let earlier = measured::known_before(arguments.prior.as_deref(), chain)?;
    let identify = IdentifyOptions { freedom: free, earlier: earlier.clone(), ..IdentifyOptions::axes(chain) };
    let read = |file: &String| measured::joint_values(file, chain, &arguments.units);
    let plan = PlanOptions {
        candidates: arguments.candidates.as_ref().map(read).transpose()?,
        spread: arguments.spread.into(),
        allowed: corners(&arguments.r#box)?,
        earlier,
        ..PlanOptions::new(chain, 1, ObservationKind::Position)
    };
    Ok(MonitorOptions { identify, plan })
}

/// Reads what there is of a file.
struct Reader<'a> {
    name: String,
    chain: &'a Chain,
    units: Units,
    import: ImportOptions,
    /// Notes that were said.
    said: Vec<String>,
}

impl Reader<'_> {
    fn read(&mut self, bytes: &[u8], is_all: bool) -> Result<Measurements, DataError> {
        let loaded = read_export(&self.name, bytes, self.chain, self.units, &self.import)?;
        // What other notes say of all rows is not so yet.
        for note in loaded.notes.iter().filter(|note| matches!(note, DataNote::ReadAs(_))) {
            let note = format!("{}: {note}", self.name);
            if !self.said.contains(&note) {
                output::mention(&note);
                self.said.push(note);
            }
        }
        // More corners of the last image may come.
        let kept = loaded.data.len() - usize::from(self.import.sight.is_some() && !is_all);
        Ok(loaded.data.subset(&(0..kept).collect::<Vec<usize>>()))
    }
}

/// Whether there is only no row yet.
fn no_rows_yet(error: &DataError) -> bool {
    let none = |problem: &MeasurementError| {
        matches!(
            problem,
            MeasurementError::NoRows | MeasurementError::NoHeader | MeasurementError::Import(ImportProblem::NoRows)
        )
    };
    error.problems.iter().all(|problem| none(&problem.problem))
}

/// A run of measurements.
struct Session<'a> {
    reader: Reader<'a>,
    screen: Screen<'a>,
    fresh: Monitor,
    monitor: Monitor,
    restarts: usize,
    any_out: bool,
    rows: usize,
}

impl Session<'_> {
    fn follow(&mut self, growing: &mut Growing) -> Result<(), Failure> {
        let mut is_all = false;
        while !is_all && !INTERRUPTED.load(Ordering::Relaxed) {
            let bytes = match growing.wait(TICK)? {
                News::Nothing => continue,
                News::Said(what) => {
                    self.screen.mention(&what);
                    continue;
                }
                News::Anew(why) => {
                    self.screen.mention(&format!("{}: {why}; all its rows are read again", self.reader.name));
                    self.monitor = self.fresh.clone();
                    self.restarts += 1;
                    continue;
                }
                News::Rows(bytes) => bytes,
                News::End(bytes) => {
                    is_all = true;
                    bytes
                }
            };
            let rows = match self.reader.read(&bytes, is_all) {
                Err(error) if no_rows_yet(&error) && !is_all => continue,
                read => read?,
            };
            self.take(&rows)?;
        }
        Ok(())
    }

    fn take(&mut self, rows: &Measurements) -> Result<(), Failure> {
        let (restarts, screen) = (self.restarts, &mut self.screen);
        let mut shown = Ok(());
        let count = &mut self.rows;
        self.monitor
            .take(rows, &mut |status| {
                *count += 1;
                if shown.is_ok() {
                    shown = screen.show(&status, restarts);
                }
                shown.is_ok() && !INTERRUPTED.load(Ordering::Relaxed)
            })
            .map_err(CalibrateError::Diagnosis)?;
        self.any_out = !self.monitor.lines_out_of_line(rows).is_empty();
        shown
    }
}

/// Where rows are shown: lines, JSON lines, or a terminal with what is known at its foot.
struct Screen<'a> {
    chain: &'a Chain,
    units: Units,
    is_json: bool,
    /// What was shown, as JSON.
    json: String,
    foot: Option<ProgressBar>,
}

impl<'a> Screen<'a> {
    fn new(chain: &'a Chain, units: Units, is_json: bool) -> Self {
        let foot = (!is_json && std::io::stdout().is_terminal()).then(|| {
            let foot = ProgressBar::with_draw_target(None, ProgressDrawTarget::stdout());
            if let Ok(style) = ProgressStyle::with_template("{msg}") {
                foot.set_style(style);
            }
            foot
        });
        Self { chain, units, is_json, json: String::new(), foot }
    }

    fn show(&mut self, status: &RowStatus, restarts: usize) -> Result<(), Failure> {
        let json = report::json(status, restarts);
        if self.is_json {
            return output::print(&json);
        }
        self.json.push_str(&json);
        let Some(foot) = &self.foot else { return output::print(&report::line(status, self.chain, self.units)) };
        foot.println(report::row(status));
        if status.known.is_some() || status.noise.is_empty() {
            foot.set_message(report::knowledge(status, self.chain, self.units));
        }
        Ok(())
    }

    fn mention(&self, what: &str) {
        match &self.foot {
            Some(foot) => foot.suspend(|| output::mention(what)),
            None => output::mention(what),
        }
    }
}

impl Drop for Screen<'_> {
    fn drop(&mut self) {
        if let Some(foot) = &self.foot {
            foot.abandon();
        }
    }
}
