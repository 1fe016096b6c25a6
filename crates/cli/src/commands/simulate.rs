//! `denavit simulate`: measurement files of a robot that differs from its drawing.

use crate::args::{SimulateArguments, numbers};
use crate::failure::Failure;
use crate::measured::{self, MeasuredRobot};
use crate::output::{Outputs, Slot, Status};
use denavit_identify::simulate::effect_specification::EffectSpecification;
use denavit_identify::simulate::files::{FilesAsked, FilesError, files};
use denavit_identify::simulate::{SimulationOptions, commanded_readings};
use denavit_measurements::kinds::ObservationKind;
use denavit_model::Chain;
use std::path::Path;

/// Runs the command.
pub fn run(arguments: &SimulateArguments) -> Result<Status, Failure> {
    let read = arguments.poses.as_deref().into_iter().chain(arguments.effects.as_deref());
    let read = read.chain(arguments.camera.camera.as_deref());
    let mut outputs = Outputs::beside(arguments.robot.files().chain(read));
    let main = outputs.add("--output", arguments.output.as_deref().unwrap_or(Path::new("-")))?;
    let test = outputs.add_if("--test", arguments.test.as_deref())?;
    let truth = outputs.add_if("--truth", arguments.truth.as_deref())?;
    let MeasuredRobot { robot, tips } = measured::robot_with_tips(&arguments.robot)?;
    let specifications =
        arguments.effect.iter().map(|text| text.parse::<EffectSpecification>()).collect::<Result<Vec<_>, _>>();
    let asked = FilesAsked {
        options: SimulationOptions { tips: tips.several().then_some(tips), ..options(arguments, &robot.chain)? },
        specifications: specifications.map_err(|error| Failure::Argument(format!("--effect {error}")))?,
        columns: arguments.columns.clone(),
        test_rows: arguments.test.as_ref().map(|_| arguments.test_rows as usize),
        truth: truth.is_some(),
    };
    let effects = measured::effects(arguments.effects.as_deref(), &robot.statics)?;
    let made = files(&robot.chain, &robot.statics, effects, &asked).map_err(|error| {
        Failure::Argument(match error {
            FilesError::Effect(error) => format!("--effect {error}"),
            FilesError::Column(error) => format!("--columns: {error}"),
            FilesError::EffectsInContact(_) => format!("--effect: {error}"),
            FilesError::NotTwoTips(_) => format!("--measure: {error}"),
            FilesError::ColumnsOfTwoTips(_) => format!("--columns: {error}"),
            FilesError::OutOfReach { .. } | FilesError::TipsOutOfReach { .. } => format!("--rows: {error}"),
            FilesError::OutOfSight { .. } => format!("--camera: {error}"),
            FilesError::KindOfSeveralTips(_) => format!("--tip: {error}"),
            FilesError::Targets(count) => format!("--targets {count}: {error}"),
            other => format!("{}: {other}", arguments.effects.as_deref().unwrap_or("--effects")),
        })
    })?;
    let mut texts: Vec<(Slot, String)> = vec![(main, made.data)];
    texts.extend(test.zip(made.test));
    texts.extend(truth.zip(made.truth));
    outputs.write(&texts)?;
    Ok(Status::Same)
}

fn options(arguments: &SimulateArguments, chain: &Chain) -> Result<SimulationOptions, Failure> {
    let [shift, turn] = measured::millimetres_and_milliradians("--geometry-error", &arguments.geometry_error, 1.0)?;
    let [noise_position, noise_orientation] =
        measured::millimetres_and_milliradians("--noise", &arguments.noise, 0.05)?;
    let share = arguments.outliers;
    if !(0.0..=1.0).contains(&share) {
        return Err(Failure::Argument(format!("--outliers: {share} is not a share of the rows; write 0 to 1")));
    }
    let sight = measured::sight(&arguments.camera)?;
    if sight.as_ref().is_some_and(|sight| sight.board.is_none()) {
        return Err(Failure::Argument(
            "--camera needs a board; give its squares with --board, such as 7x5:30mm".into(),
        ));
    }
    let kind = if sight.is_some() { ObservationKind::Pixel } else { measured::kind(arguments.measure) };
    let tries = SimulationOptions { kind, ..SimulationOptions::default() }.tries();
    let readings = match &arguments.poses {
        Some(file) => measured::joint_values(file, chain, &arguments.units)?,
        None => commanded_readings(chain, arguments.rows as usize * tries, arguments.seed),
    };
    let rows = if arguments.poses.is_some() { readings.len() } else { arguments.rows as usize };
    Ok(SimulationOptions {
        kind,
        rows,
        targets: arguments.targets.into(),
        seed: arguments.seed,
        turn,
        shift,
        noise_position,
        noise_orientation,
        noise_range: arguments.range_noise * 1e-3,
        noise_angle: arguments.angle_noise * 1e-3,
        repeatability: repeatability(&arguments.repeatability, chain)?,
        sight,
        noise_pixel: arguments.pixel_noise,
        outliers: share,
        covariates: Vec::new(),
        readings: Some(readings),
        tips: None,
        before: None,
    })
}

/// One standard deviation for each coordinate, rad or m, from `[JOINT=]SIZE` in mrad and mm; later ones replace earlier ones.
fn repeatability(written: &[String], chain: &Chain) -> Result<Vec<f64>, Failure> {
    let names: Vec<&str> = chain.coordinates().iter().map(|coordinate| coordinate.name.as_str()).collect();
    let mut sizes = vec![0.0; if written.is_empty() { 0 } else { names.len() }];
    for text in written {
        let refused = |why: String| Failure::Argument(format!("--repeatability {text}: {why}"));
        let (joint, size) = text.rsplit_once('=').map_or((None, text.as_str()), |(joint, size)| (Some(joint), size));
        let size = numbers::tolerance(size).map_err(refused)? * 1e-3;
        match joint {
            None => sizes.fill(size),
            Some(joint) => match names.iter().position(|name| *name == joint) {
                Some(index) => sizes[index] = size,
                None => return Err(refused(format!("no joint is called \"{joint}\"; there are {}", names.join(", ")))),
            },
        }
    }
    Ok(sizes)
}
