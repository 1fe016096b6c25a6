//! Reads a manifest (CSV, TOML, or a pattern of folders) into one entry per robot, night and task.

mod pattern;

use crate::day::Day;
use crate::error::FleetError;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::Path;

/// What is done with a robot.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Task {
    /// Fit the measurements.
    Calibrate,
    /// Make the D-H table.
    Table,
    /// Check with the rules.
    Check,
    /// Hash what the robot is.
    Fingerprint,
    /// Compare with another.
    Diff,
}

impl Task {
    const ALL: [(&'static str, Self); 5] = [
        ("calibrate", Self::Calibrate),
        ("table", Self::Table),
        ("check", Self::Check),
        ("fingerprint", Self::Fingerprint),
        ("diff", Self::Diff),
    ];

    /// As manifests write it.
    pub fn name(self) -> &'static str {
        Self::ALL.iter().find(|(_, task)| *task == self).expect("every task has a name").0
    }

    fn named(word: &str) -> Option<Self> {
        Self::ALL.iter().find(|(name, _)| *name == word).map(|(_, task)| *task)
    }
}

/// The prior of a fit.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum PriorSource {
    /// A file that `denavit calibrate --json` or `denavit fleet siblings --prior-out` wrote.
    File(String),
    /// The robot's siblings in the store.
    Siblings {
        /// The prior as JSON, once it was learned.
        learned: Option<String>,
    },
}

impl PriorSource {
    /// As manifests write it.
    pub fn name(&self) -> &str {
        match self {
            Self::File(file) => file,
            Self::Siblings { .. } => SIBLINGS,
        }
    }
}

/// The word for the siblings prior.
pub(crate) const SIBLINGS: &str = "siblings";

/// One robot, one night, one task.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Entry {
    /// The robot's name in the fleet.
    pub serial: String,
    /// The night, as `YYYY-MM-DD`.
    pub date: Option<Day>,
    /// What happened before this night.
    pub event: String,
    /// What is done.
    pub task: Task,
    /// The robot's file.
    pub robot: String,
    /// Measurements to fit.
    pub data: Vec<String>,
    /// Test data.
    pub test: Option<String>,
    /// The prior of the fit.
    pub prior: Option<PriorSource>,
    /// For [`Task::Diff`]: what the robot is compared with.
    pub against: Option<String>,
    /// How.
    pub options: TaskOptions,
}

impl Entry {
    /// Whether it has a siblings prior, which needs earlier calibrations of siblings without this prior.
    pub(crate) fn learns(&self) -> bool {
        matches!(self.prior, Some(PriorSource::Siblings { .. }))
    }
}

/// Options of a task, named like those of the command line.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TaskOptions {
    /// Link that the chain starts at.
    pub base: Option<String>,
    /// Link that the chain ends at.
    pub tip: Option<String>,
    /// Units of the measurements.
    pub units: String,
    /// `auto`, `none`, `curves`, or kinds of effects.
    pub effects: Vec<String>,
    /// No more effects than this.
    pub max_effects: Option<usize>,
    /// Mass of all moving links, kg, for a description without masses.
    pub mass: Option<f64>,
    /// Fraction of the rows to hold out.
    pub hold_out: Option<f64>,
    /// Of the choice of rows held out.
    pub seed: u64,
    /// Of `fingerprint`, m and rad.
    pub tolerance: f64,
    /// Of `diff`, m.
    pub tolerance_m: f64,
    /// Of `diff`, rad.
    pub tolerance_rad: f64,
    /// `ROBOT NAME:=VALUE` arguments of a xacro file.
    pub arguments: Vec<(String, String)>,
}

/// Every key of an entry.
pub const WORDS: &[&str] = &[
    "serial",
    "robot",
    "data",
    "date",
    "event",
    "task",
    "test",
    "prior",
    "against",
    "base",
    "tip",
    "units",
    "effects",
    "max_effects",
    "mass",
    "hold_out",
    "seed",
    "tolerance",
    "tolerance_m",
    "tolerance_rad",
    "arguments",
];

/// Reads a manifest: a TOML file by its name, otherwise CSV; a name with `{serial}` in it is a pattern of folders.
///
/// Paths are relative to the manifest's folder. `defaults` apply to every entry that does not override them, such as the
/// robot of a pattern.
///
/// # Errors
/// The file cannot be read, or an entry has an unknown key or lacks a required one.
pub fn read(name: &str, defaults: &[(String, String)]) -> Result<Vec<Entry>, FleetError> {
    let defaults: BTreeMap<String, String> = defaults.iter().cloned().collect();
    known_words("‹set›", defaults.keys())?;
    if name.contains("{serial}") {
        return pattern::entries(name, &defaults);
    }
    let (file, text) = denavit_load::read_text(name)?;
    let folder = Path::new(&file).parent().unwrap_or(Path::new("")).to_owned();
    let toml = Path::new(&file).extension().is_some_and(|extension| extension.eq_ignore_ascii_case("toml"));
    let entries =
        if toml { of_toml(&file, &text, &folder, &defaults) } else { of_csv(&file, &text, &folder, &defaults) }?;
    if entries.is_empty() {
        return Err(FleetError::manifest(file, "it names no robot; write one row serial,robot,data,date for each"));
    }
    Ok(entries)
}

type Words = BTreeMap<String, String>;

fn known_words<'a>(place: &str, words: impl Iterator<Item = &'a String>) -> Result<(), FleetError> {
    for word in words {
        if !WORDS.contains(&word.as_str()) {
            let message = format!("\"{word}\" is not a manifest key; keys are {}", WORDS.join(", "));
            return Err(FleetError::manifest(place, message));
        }
    }
    Ok(())
}

fn of_csv(file: &str, text: &str, folder: &Path, defaults: &Words) -> Result<Vec<Entry>, FleetError> {
    let text = text.trim_start_matches('\u{feff}');
    let mut reader = csv::ReaderBuilder::new().comment(Some(b'#')).trim(csv::Trim::All).from_reader(text.as_bytes());
    let wrong = |error: &csv::Error| {
        let line = error.position().map_or(1, csv::Position::line);
        FleetError::manifest(format!("{file}:{line}"), format!("{error}; every row needs as many cells as the header"))
    };
    let heading: Vec<String> = reader.headers().map_err(|error| wrong(&error))?.iter().map(str::to_owned).collect();
    known_words(&format!("{file}:1"), heading.iter())?;
    let mut entries = Vec::new();
    for record in reader.records() {
        let record = record.map_err(|error| wrong(&error))?;
        let line = record.position().map_or(0, csv::Position::line);
        let mut words = defaults.clone();
        let filled = heading.iter().zip(&record).filter(|(_, cell)| !cell.is_empty());
        words.extend(filled.map(|(word, cell)| (word.clone(), cell.to_owned())));
        entries.push(entry(&words, folder, &format!("{file}:{line}"))?);
    }
    Ok(entries)
}

fn of_toml(file: &str, text: &str, folder: &Path, defaults: &Words) -> Result<Vec<Entry>, FleetError> {
    #[derive(serde::Deserialize)]
    #[serde(deny_unknown_fields)]
    struct File {
        #[serde(default)]
        defaults: toml::Table,
        #[serde(default)]
        robots: Vec<toml::Table>,
    }
    let read: File = toml::from_str(text).map_err(|error| {
        FleetError::manifest(file, format!("{error}; write [defaults] and a [[robots]] for each robot"))
    })?;
    let words = |place: &str, table: &toml::Table| -> Result<Words, FleetError> {
        known_words(place, table.keys())?;
        Ok(table.iter().map(|(word, value)| (word.clone(), text_of(value))).collect())
    };
    let mut common = defaults.clone();
    common.extend(words(&format!("{file}: [defaults]"), &read.defaults)?);
    let of = |(index, table): (usize, &toml::Table)| {
        let place = format!("{file}: [[robots]] {}", index + 1);
        let mut all = common.clone();
        all.extend(words(&place, table)?);
        entry(&all, folder, &place)
    };
    read.robots.iter().enumerate().map(of).collect()
}

/// A value as CSV would write it; lists are joined by ;.
fn text_of(value: &toml::Value) -> String {
    match value {
        toml::Value::String(text) => text.clone(),
        toml::Value::Integer(number) => number.to_string(),
        toml::Value::Float(number) => number.to_string(),
        toml::Value::Boolean(flag) => flag.to_string(),
        toml::Value::Datetime(time) => time.to_string(),
        toml::Value::Array(list) => list.iter().map(text_of).collect::<Vec<_>>().join(";"),
        toml::Value::Table(_) => String::new(),
    }
}

/// An entry of its words; `place` is what messages call it.
fn entry(words: &Words, folder: &Path, place: &str) -> Result<Entry, FleetError> {
    let wrong = |message: String| FleetError::manifest(place, message);
    let word = |name: &str| words.get(name).map(|text| text.trim()).filter(|text| !text.is_empty());
    let needed = |name: &str, fix: &str| word(name).ok_or_else(|| wrong(format!("{name} is missing; {fix}")));
    let path = |name: &str| {
        let kept = name.starts_with("git:") || Path::new(name).is_absolute() || folder.as_os_str().is_empty();
        if kept { name.to_owned() } else { folder.join(name).to_string_lossy().into_owned() }
    };
    let list = |name: &str| -> Vec<String> {
        let parts = word(name).into_iter().flat_map(|text| text.split(';')).map(str::trim);
        parts.filter(|part| !part.is_empty()).map(str::to_owned).collect()
    };
    let number = |name: &str, otherwise: f64| match word(name) {
        None => Ok(otherwise),
        Some(text) => text
            .parse::<f64>()
            .ok()
            .filter(|number| number.is_finite() && *number >= 0.0)
            .ok_or_else(|| wrong(format!("{name} \"{text}\" is not a number of 0 or more"))),
    };
    let count = |name: &str, otherwise: u64| match word(name) {
        None => Ok(otherwise),
        Some(text) => text.parse::<u64>().map_err(|_| wrong(format!("{name} \"{text}\" is not a whole number"))),
    };
    let data: Vec<String> = list("data").iter().map(|name| path(name)).collect();
    let task = match word("task") {
        None if data.is_empty() => Task::Table,
        None => Task::Calibrate,
        Some(text) => Task::named(text).ok_or_else(|| {
            let names: Vec<&str> = Task::ALL.iter().map(|(name, _)| *name).collect();
            wrong(format!("task \"{text}\" is unknown; write {}", names.join(", ")))
        })?,
    };
    if task == Task::Calibrate && data.is_empty() {
        return Err(wrong(
            "there are no data for the calibration; name the measurement file in the column data".into(),
        ));
    }
    let against = word("against").map(path);
    if task == Task::Diff && against.is_none() {
        return Err(wrong("there is no robot to compare with; name one in the column against".into()));
    }
    let prior = word("prior").map(|name| match name {
        SIBLINGS => PriorSource::Siblings { learned: None },
        file => PriorSource::File(path(file)),
    });
    if prior.is_some() && task != Task::Calibrate {
        return Err(wrong(format!("only the task calibrate has a prior, but this is {}; leave it out", task.name())));
    }
    let pair = |text: String| {
        let split = text.split_once(":=").map(|(name, value)| (name.to_owned(), value.to_owned()));
        split.ok_or_else(|| wrong(format!("\"{text}\" is not an argument of a xacro file; write NAME:=VALUE")))
    };
    let mass = word("mass").map(|_| number("mass", 0.0)).transpose()?;
    if mass == Some(0.0) {
        return Err(wrong("mass is the mass of all moving links in kg; write a number above 0".into()));
    }
    let max_effects = word("max_effects").map(|_| count("max_effects", 0)).transpose()?;
    let max_effects = max_effects.map(|most| usize::try_from(most).unwrap_or(usize::MAX));
    let hold_out = word("hold_out").map(|_| number("hold_out", 0.0)).transpose()?.filter(|share| *share > 0.0);
    if hold_out.is_some_and(|share| share >= 1.0) {
        return Err(wrong("hold_out is a fraction of the rows; write a number between 0 and 1".into()));
    }
    Ok(Entry {
        serial: needed("serial", "name the robot in the column serial")?.to_owned(),
        date: word("date").map(str::parse).transpose().map_err(wrong)?,
        event: word("event").unwrap_or_default().to_owned(),
        task,
        robot: path(needed("robot", "name its URDF in the column robot, or for all with ‹set› robot=FILE")?),
        data,
        test: word("test").map(path),
        prior,
        against,
        options: TaskOptions {
            base: word("base").map(str::to_owned),
            tip: word("tip").map(str::to_owned),
            units: word("units").unwrap_or("m,rad").to_owned(),
            effects: Some(list("effects")).filter(|list| !list.is_empty()).unwrap_or_else(|| vec!["auto".into()]),
            max_effects,
            mass,
            hold_out,
            seed: count("seed", 0)?,
            tolerance: number("tolerance", denavit_compare::fingerprint::DEFAULT_TOLERANCE)?,
            tolerance_m: number("tolerance_m", denavit_compare::Options::default().tolerance_m)?,
            tolerance_rad: number("tolerance_rad", denavit_compare::Options::default().tolerance_rad)?,
            arguments: list("arguments").into_iter().map(pair).collect::<Result<_, _>>()?,
        },
    })
}
