//! What an effect does to the tip.

use crate::answers::words;
use crate::question::RobotText;
use denavit_identify::effects::candidates::candidates;
use denavit_identify::effects::catalogue::KINDS;
use denavit_identify::effects::driver::{Conditions, Statics};
use denavit_identify::effects::survey::{Survey, with_run_order};
use denavit_identify::parameters::NoEffects;
use denavit_identify::proportion::within_proportion;
use denavit_identify::simulate::effect_specification::{EffectSpecification, specified_effects};
use denavit_identify::simulate::{Simulation, SimulationOptions, simulate};
use denavit_measurements::RecordedRow;
use denavit_model::Chain;
use serde_json::{Value, json};

/// Postures at which an effect's strength is computed.
const ROWS: usize = 60;
const SEED: u64 = 1;

fn robot(source: &RobotText) -> Result<(Chain, Statics), String> {
    let loaded = source.load()?;
    let chain = loaded.chain(&source.selection()).map_err(words)?.value;
    if chain.joints().is_empty() {
        return Err(format!("{}: nothing moves between \"{}\" and \"{}\"", source.file, chain.base(), chain.tip()));
    }
    within_proportion(&chain).map_err(words)?;
    let statics = loaded.statics(&chain, source.reading());
    Ok((chain, statics))
}

fn run(chain: &Chain) -> Simulation {
    simulate(chain, &SimulationOptions { rows: ROWS, seed: SEED, ..SimulationOptions::default() }, &NoEffects)
}

/// The kinds that depend only on the posture, and where each can act.
pub fn possible(source: &RobotText) -> Result<Value, String> {
    let (chain, statics) = robot(source)?;
    let data = with_run_order(run(&chain).data);
    let survey = Survey::of(&statics, &data, Vec::new());
    let mut kinds = Vec::new();
    for entry in KINDS {
        let mut places: Vec<String> = Vec::new();
        for candidate in candidates(entry.kind, &survey) {
            let place = candidate.term.carrier.place(&chain);
            let of_posture = candidate.term.driver.columns().is_empty();
            if of_posture && candidate.term.moves_the_tip() && !places.contains(&place) {
                places.push(place);
            }
        }
        if !places.is_empty() {
            kinds.push(json!({
                "kind": entry.name, "formula": entry.formula, "units": entry.units, "source": entry.source, "places": places,
            }));
        }
    }
    Ok(json!({ "kinds": kinds }))
}

/// The tip of the robot as drawn and with the effect, for each row of joint values: base_from_tip, 16 numbers column by
/// column, and the distance between the two, m.
pub fn act(source: &RobotText, effect: &str, q: &[Vec<f64>]) -> Result<Value, String> {
    let (chain, statics) = robot(source)?;
    let specification: EffectSpecification = effect.parse().map_err(words)?;
    let model = specified_effects(&[specification], &statics, &run(&chain), SEED).map_err(words)?;
    if let Some(column) = model.effects.iter().find_map(|effect| effect.term.driver.columns().first().copied()) {
        return Err(format!("the effect follows \"{}\", which a posture alone does not give", column.name()));
    }
    let mut rows = Vec::new();
    for reading in q {
        if reading.len() != chain.coordinates().len() || !reading.iter().all(|value| value.is_finite()) {
            return Err(format!("{} finite joint values are wanted", chain.coordinates().len()));
        }
        let drawn = chain.fk(reading);
        let acted = model.fk(&chain, &Conditions { reading, recorded: RecordedRow::nothing(), tip: 0 });
        let apart = (acted.translation.vector - drawn.translation.vector).norm();
        let numbers = |pose: &denavit_model::Pose| pose.to_homogeneous().as_slice().to_vec();
        rows.push(json!({ "drawn": numbers(&drawn), "acted": numbers(&acted), "apart_m": apart }));
    }
    Ok(json!({ "rows": rows, "effects": model.to_json() }))
}
