//! What the commands about measurements share: files of measurements, poses and effects, and pairs of numbers.

use crate::args::{
    BagArguments, CameraArguments, GivenArguments, ImportArguments, MeasureName, RobotArguments, SeveralTips,
};
use crate::bags;
use crate::failure::Failure;
use crate::output;
use crate::source::{self, Loaded};
use denavit_identify::effects::SavedEffects;
use denavit_identify::effects::driver::Statics;
use denavit_identify::posterior::Earlier;
use denavit_load::measured::{self as load, Content, DataFile, HashedFile, moving};
use denavit_measurements::board::Sight;
use denavit_measurements::import::{self, EulerOrder, ImportOptions, Map};
use denavit_measurements::kinds::ObservationKind;
use denavit_measurements::{Units, poses, poses::Poses};
use denavit_model::{Chain, Tips};
use std::path::Path;
use std::sync::Arc;

/// A robot, its chain and what gravity acts on; notes are said.
pub struct Robot {
    pub loaded: Loaded,
    pub chain: Chain,
    pub statics: Statics,
}

/// A robot and the chain, or the tree of several tips, that is measured.
pub struct MeasuredRobot {
    pub robot: Robot,
    pub tips: Arc<Tips>,
}

/// Reads the robot that the arguments choose, and all tips of it.
pub fn robot_with_tips(arguments: &RobotArguments<SeveralTips>) -> Result<MeasuredRobot, Failure> {
    let loaded = source::load(&arguments.robot, &arguments.source)?;
    let noted = loaded.chain_to(&arguments.selection(), &arguments.tip.tips)?;
    output::remark(&noted.notes);
    let (chain, tips) = noted.value;
    moving(&arguments.robot, &chain)?;
    let tips = Arc::new(tips);
    let statics = loaded.statics_to(&chain, &tips, arguments.reading());
    Ok(MeasuredRobot { robot: Robot { loaded, chain, statics }, tips })
}

/// Reads the robot that the arguments choose.
pub fn robot(arguments: &RobotArguments) -> Result<Robot, Failure> {
    chosen(arguments, source::load(&arguments.robot, &arguments.source)?)
}

/// Reads the robot that the arguments choose and another one, which the arguments of xacro may be meant for.
pub fn robot_and(arguments: &RobotArguments, other: &str) -> Result<(Robot, Loaded), Failure> {
    let mut robots = source::load_all(&[&arguments.robot, other], &arguments.source)?;
    let other = robots.remove(1);
    Ok((chosen(arguments, robots.remove(0))?, other))
}

fn chosen(arguments: &RobotArguments, loaded: Loaded) -> Result<Robot, Failure> {
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
pub fn data_file(file: &str, units: Units, import: ImportOptions) -> Result<DataFile, Failure> {
    let (name, content) = Content::of(file)?;
    Ok(DataFile { name, content, units, import, ..DataFile::default() })
}

/// A file whose columns need no options.
pub fn bare_file(file: &str) -> Result<DataFile, Failure> {
    data_file(file, Units::default(), ImportOptions::default())
}

/// What an earlier calibration knows of the axes, where one is named.
pub fn known_before(prior: Option<&str>, chain: &Chain) -> Result<Option<Earlier>, Failure> {
    prior.map(|file| Ok(load::earlier(&bare_file(file)?, chain)?)).transpose()
}

/// A file of measurements, or a bag as the rows that it makes.
pub fn data_file_or_bag(
    file: &str,
    units: Units,
    import: ImportOptions,
    arguments: &BagArguments,
    chain: &Chain,
) -> Result<DataFile, Failure> {
    if !bags::is_bag(file) {
        return data_file(file, units, import);
    }
    bags::data_file(file, arguments, chain)
}

/// What the arguments say of the columns of a file of measurements.
pub fn import_options(arguments: &ImportArguments) -> Result<ImportOptions, Failure> {
    let wrong = |option: &str, error: &dyn std::fmt::Display| Failure::Argument(format!("{option}: {error}"));
    let map = arguments.columns.as_deref().map(|written| {
        let read = if written.contains('=') && !Path::new(written).exists() {
            Map::of_words(written)
        } else {
            let (file, text) = source::read_text(written)?;
            Map::read(&file, &text)
        };
        read.map_err(|error| Failure::Argument(error.to_string()))
    });
    let order = |written: &str| written.parse::<EulerOrder>().map_err(|error| wrong("--euler", &error));
    let program = |file: &String| {
        let (name, text) = source::read_text(file)?;
        import::joints(&name, &text).map_err(|error| Failure::Argument(error.to_string()))
    };
    Ok(ImportOptions {
        map: map.transpose()?,
        euler: arguments.euler.as_deref().map(order).transpose()?,
        rotation_vector: arguments.rotation_vector,
        quaternion: arguments.quaternion.clone(),
        joints: arguments.joints.as_ref().map(program).transpose()?,
        plate: arguments
            .plate
            .as_deref()
            .map(|text| text.parse().map_err(|error| wrong("--plate", &error)))
            .transpose()?,
        sight: None,
        tips: None,
    })
}

/// The camera that the arguments name.
pub fn sight(arguments: &CameraArguments) -> Result<Option<Sight>, Failure> {
    Ok(sight_and_file(arguments)?.map(|(sight, _)| sight))
}

/// The same, and its file.
pub fn sight_and_file(arguments: &CameraArguments) -> Result<Option<(Sight, HashedFile)>, Failure> {
    let Some(file) = &arguments.camera else { return Ok(None) };
    let (name, text) = source::read_text(file)?;
    let sight = load::sight(&name, &text, arguments.board.as_deref(), arguments.on_hand)?;
    Ok(Some((sight, HashedFile::of(&name, text.as_bytes()))))
}

/// Says what must be known.
pub fn mention(notes: &[String]) {
    notes.iter().for_each(output::mention);
}

/// Reads a list of poses.
pub fn pose_list(file: &str, chain: &Chain, written: &str, import: Option<&ImportArguments>) -> Result<Poses, Failure> {
    let units = units(written)?;
    let (name, bytes) = source::read_bytes(file)?;
    let options = import.map(import_options).transpose()?.unwrap_or_default();
    Ok(poses::read_export(&name, &bytes[..], chain, units, &options)?)
}

/// Reads joint values.
pub fn joint_values(file: &str, chain: &Chain, written: &str) -> Result<Vec<Vec<f64>>, Failure> {
    joint_values_of_export(file, chain, written, &ImportOptions::default())
}

/// The same of an export whose columns were told.
pub fn joint_values_of_export(
    file: &str,
    chain: &Chain,
    written: &str,
    options: &ImportOptions,
) -> Result<Vec<Vec<f64>>, Failure> {
    let units = units(written)?;
    let (name, bytes) = source::read_bytes(file)?;
    Ok(poses::read_joints_of_export(&name, &bytes[..], chain, units, options)?)
}

/// Reads effects; without a file there are none.
pub fn effects(file: Option<&str>, statics: &Statics) -> Result<SavedEffects, Failure> {
    let Some(file) = file else { return Ok(SavedEffects::none(statics.clone())) };
    let (name, text) = source::read_text(file)?;
    Ok(SavedEffects::from_json(&name, &text, statics)?)
}

/// What was given by `--given`.
pub fn given(arguments: &GivenArguments) -> Result<Vec<(String, f64)>, Failure> {
    let pair = |word: &String| {
        let parsed = word.rsplit_once('=').and_then(|(name, value)| {
            let value = value.trim().parse::<f64>().ok().filter(|value| value.is_finite())?;
            Some((name.trim().to_owned(), value))
        });
        parsed.ok_or_else(|| Failure::Argument(format!("--given: \"{word}\" is not NAME=VALUE, such as payload=2.5")))
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
        MeasureName::Poses => ObservationKind::Pose,
        MeasureName::Positions => ObservationKind::Position,
        MeasureName::Distances => ObservationKind::Distance,
        MeasureName::Planes => ObservationKind::Plane,
        MeasureName::Dial => ObservationKind::Dial,
        MeasureName::Gravity => ObservationKind::Gravity,
        MeasureName::Inclination => ObservationKind::Inclination,
        MeasureName::Contacts => ObservationKind::Socket,
        MeasureName::Grips => ObservationKind::Grip,
    }
}
