//! `denavit simulate`: measurement files of a robot that differs from its drawing.

use crate::args::SimulateArguments;
use crate::failure::Failure;
use crate::measured;
use crate::output::{Outputs, Slot, Status};
use denavit_calibrate::apply::simulate::columns::columns;
use denavit_calibrate::apply::simulate::effect_specification::{EffectSpecification, granted};
use denavit_calibrate::apply::simulate::{
    SimulationOptions, as_displayed, commanded_readings, simulate, simulate_arm, truth,
};
use denavit_calibrate::effects::recorded;
use denavit_calibrate::effects::survey::with_run_order;
use denavit_calibrate::observation::measurements::{Covariate, write};
use denavit_calibrate::{NoEffects, ObservationKind};
use denavit_model::Chain;
use std::path::Path;

/// The test is drawn from a seed of its own.
const TEST_SEED: u64 = 0x7465_7374;

/// Runs the command.
pub fn run(arguments: &SimulateArguments) -> Result<Status, Failure> {
    let read = arguments.poses.as_deref().into_iter().chain(arguments.effects.as_deref());
    let mut outputs = Outputs::beside(arguments.robot.files().chain(read));
    let main = outputs.add("--output", arguments.output.as_deref().unwrap_or(Path::new("-")))?;
    let test = outputs.add_if("--test", arguments.test.as_deref())?;
    let truth = outputs.add_if("--truth", arguments.truth.as_deref())?;
    let robot = measured::robot(&arguments.robot)?;
    let chain = &robot.chain;
    let options = options(arguments, chain)?;
    let wishes = arguments.effect.iter().map(|text| text.parse::<EffectSpecification>()).collect::<Result<Vec<_>, _>>();
    let wishes = wishes.map_err(|error| Failure::Argument(format!("--effect {error}")))?;
    let loaded = measured::effects(arguments.effects.as_deref(), &robot.statics)?;
    if let Some(file) = &arguments.effects {
        for effect in &loaded.effects {
            for name in recorded::needed(&effect.term, chain) {
                if !recorded::told_by_run(&name, &options.covariates) {
                    let kind = effect.term.kind.name();
                    let message = format!("{file}: {kind} follows \"{name}\"; record it with --columns \"{name}\"");
                    return Err(Failure::Argument(message));
                }
            }
        }
    }
    // What is drawn does not depend on the effects: the strengths asked for are those on the very rows that are written.
    let bare = simulate(chain, &options, &NoEffects);
    let granted = granted(&wishes, &robot.statics, &bare, options.seed)
        .map_err(|error| Failure::Argument(format!("--effect {error}")))?;
    let mut model = loaded;
    model.effects.extend(granted.effects);
    let run = simulate(chain, &options, &model);
    let comments = |rows: usize, kind: ObservationKind| {
        vec![format!("{}: {rows} simulated {}, m and rad; made by denavit simulate", chain.name(), kind.plural())]
    };
    let data = write(&as_displayed(&run.data, &options), &comments(options.rows, options.kind));
    let mut texts: Vec<(Slot, String)> = vec![(main, data)];
    if let Some(slot) = test {
        let rows = arguments.test_rows as usize;
        let seed = options.seed ^ TEST_SEED;
        let later = SimulationOptions {
            rows,
            seed,
            readings: Some(commanded_readings(chain, rows, seed)),
            before: Some(with_run_order(run.data.clone())),
            covariates: recorded_columns(arguments, chain, rows, options.rows, seed)?,
            ..options.clone()
        };
        let test = simulate_arm(&run.arm, &later, &model);
        texts.push((slot, write(&as_displayed(&test.data, &later), &comments(rows, options.kind))));
    }
    if let Some(slot) = truth {
        texts.push((slot, truth::to_json(&run, &options, &model)));
    }
    outputs.write(&texts)?;
    Ok(Status::Same)
}

fn recorded_columns(
    arguments: &SimulateArguments,
    chain: &Chain,
    rows: usize,
    first_row: usize,
    seed: u64,
) -> Result<Vec<Covariate>, Failure> {
    columns(&arguments.columns, chain, rows, first_row, seed)
        .map_err(|error| Failure::Argument(format!("--columns: {error}")))
}

fn options(arguments: &SimulateArguments, chain: &Chain) -> Result<SimulationOptions, Failure> {
    let [shift, turn] = measured::millimetres_and_milliradians("--geometry-error", &arguments.geometry_error, 1.0)?;
    let [noise_position, noise_orientation] =
        measured::millimetres_and_milliradians("--noise", &arguments.noise, 0.05)?;
    let share = arguments.outliers;
    if !(0.0..=1.0).contains(&share) {
        return Err(Failure::Argument(format!("--outliers: {share} is no share of the rows; write 0 to 1")));
    }
    let kind = measured::kind(arguments.measure);
    if arguments.targets > 1 && !kind.of_several() {
        let message = format!("--targets {}: only positions are of several targets at once", arguments.targets);
        return Err(Failure::Argument(message));
    }
    let readings = match &arguments.poses {
        Some(file) => measured::joint_values(file, chain, &arguments.units)?,
        None => commanded_readings(chain, arguments.rows as usize, arguments.seed),
    };
    let rows = readings.len();
    Ok(SimulationOptions {
        kind,
        rows,
        targets: arguments.targets.into(),
        seed: arguments.seed,
        turn,
        shift,
        noise_position,
        noise_orientation,
        outliers: share,
        covariates: recorded_columns(arguments, chain, rows, 0, arguments.seed)?,
        readings: Some(readings),
        before: None,
    })
}
