//! What the commands about measurements share: files of measurements, poses and effects, and pairs of numbers.

use crate::args::{GivenArguments, MeasureName, RobotArguments};
use crate::failure::Failure;
use crate::output;
use crate::source::{self, Loaded};
use denavit_calibrate::ObservationKind;
use denavit_calibrate::effects::EffectModel;
use denavit_calibrate::effects::driver::Statics;
use denavit_calibrate::observation::kinds::{DISTANCE, POSE, POSITION};
use denavit_calibrate::observation::measurements::{Units, poses, poses::Poses};
use denavit_load::measured::{DataFile, moving};
use denavit_model::Chain;

/// A robot, its chain and what gravity acts on; notes are said.
pub struct Robot {
    pub loaded: Loaded,
    pub chain: Chain,
    pub statics: Statics,
}

/// Reads the robot that the arguments choose.
pub fn robot(arguments: &RobotArguments) -> Result<Robot, Failure> {
    let loaded = source::load(&arguments.robot, &arguments.source)?;
    let noted = loaded.chain(&arguments.selection())?;
    output::remark(&noted.notes);
    let chain = noted.value;
    moving(&arguments.robot, &chain)?;
    let statics = loaded.statics(&chain, arguments.selection().reading);
    Ok(Robot { loaded, chain, statics })
}

/// Standard input can be read once.
pub fn one_standard_input(files: &[Option<&str>]) -> Result<(), Failure> {
    if files.iter().flatten().filter(|file| **file == "-").count() > 1 {
        return Err(Failure::Argument("standard input (-) can be one file only; give the others by name".into()));
    }
    Ok(())
}

/// Units of a file of data.
pub fn units(written: &str) -> Result<Units, Failure> {
    written.parse().map_err(|error| Failure::Argument(format!("--units: {error}")))
}

/// A file of measurements.
pub fn data_file(file: &str, units: Units) -> Result<DataFile, Failure> {
    let (name, text) = source::read_text(file)?;
    Ok(DataFile { name, text, units })
}

/// Says what must be known.
pub fn mention(notes: &[String]) {
    notes.iter().for_each(output::mention);
}

/// Reads a list of poses.
pub fn pose_list(file: &str, chain: &Chain, written: &str) -> Result<Poses, Failure> {
    let units = units(written)?;
    let (name, text) = source::read_text(file)?;
    Ok(poses::read(&name, text.as_bytes(), chain, units)?)
}

/// Reads joint values.
pub fn joint_values(file: &str, chain: &Chain, written: &str) -> Result<Vec<Vec<f64>>, Failure> {
    let units = units(written)?;
    let (name, text) = source::read_text(file)?;
    Ok(poses::read_joints(&name, text.as_bytes(), chain, units)?)
}

/// Reads effects; without a file there are none.
pub fn effects(file: Option<&str>, statics: &Statics) -> Result<EffectModel, Failure> {
    let Some(file) = file else { return Ok(EffectModel::new(statics.clone(), Vec::new())) };
    let (name, text) = source::read_text(file)?;
    Ok(EffectModel::from_json(&name, &text, statics)?)
}

/// What was given by `--given`.
pub fn given(arguments: &GivenArguments) -> Result<Vec<(String, f64)>, Failure> {
    let pair = |word: &String| {
        let parsed = word.rsplit_once('=').and_then(|(name, value)| {
            let value = value.trim().parse::<f64>().ok().filter(|value| value.is_finite())?;
            Some((name.trim().to_owned(), value))
        });
        parsed.ok_or_else(|| Failure::Argument(format!("--given: \"{word}\" is no NAME=VALUE, such as payload=2.5")))
    };
    arguments.given.iter().map(pair).collect()
}

/// Millimetres and milliradians as m and rad; one number alone leaves the other at its default.
pub fn millimetres_and_milliradians(option: &str, written: &[f64], otherwise: f64) -> Result<[f64; 2], Failure> {
    let good = |value: &f64| value.is_finite() && *value >= 0.0;
    if written.is_empty() || written.len() > 2 || !written.iter().all(good) {
        let words: Vec<String> = written.iter().map(f64::to_string).collect();
        return Err(Failure::Argument(format!(
            "{option}: \"{}\" is not MM,MRAD; write one or two numbers of 0 or more",
            words.join(",")
        )));
    }
    Ok([written[0] * 1e-3, written.get(1).copied().unwrap_or(otherwise) * 1e-3])
}

/// The kind that a word on the command line means.
pub fn kind(measure: MeasureName) -> ObservationKind {
    match measure {
        MeasureName::Poses => POSE,
        MeasureName::Positions => POSITION,
        MeasureName::Distances => DISTANCE,
    }
}
