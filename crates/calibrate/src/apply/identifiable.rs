//! Which parameters of a chain measurements can identify, before any are made.

use denavit_identify::identifiability::{Identifiability, identifiability};
use denavit_identify::parameters::{Freedom, NoEffects};
use denavit_identify::simulate::{SimulationOptions, simulate};
use denavit_measurements::kinds::KINDS;
use denavit_model::Chain;

/// What poses, positions of this many targets and distances can identify of a chain, measured at `rows` readings spread over the
/// joint range.
pub fn of_chain(chain: &Chain, freedom: &Freedom, targets: usize, rows: usize) -> Vec<Identifiability> {
    measured(chain, freedom, &SimulationOptions { rows, targets, ..as_drawn() })
}

/// The same, measured at these joint readings (rad, m; one value per coordinate).
pub fn at_readings(chain: &Chain, freedom: &Freedom, targets: usize, readings: &[Vec<f64>]) -> Vec<Identifiability> {
    let options = SimulationOptions { rows: readings.len(), targets, readings: Some(readings.to_vec()), ..as_drawn() };
    measured(chain, freedom, &options)
}

/// Axes as drawn and no noise; a target beside the last axis and an anchor in general position.
fn as_drawn() -> SimulationOptions {
    SimulationOptions { turn: 0.0, shift: 0.0, noise_position: 0.0, noise_orientation: 0.0, ..Default::default() }
}

fn measured(chain: &Chain, freedom: &Freedom, options: &SimulationOptions) -> Vec<Identifiability> {
    let read =
        KINDS.into_iter().filter(|kind| !kind.holds_the_target() && !kind.of_a_board() && !kind.is_turned_alone());
    let found = read.map(|kind| {
        let run = simulate(chain, &SimulationOptions { kind, ..options.clone() }, &NoEffects);
        identifiability(&run.data, &run.arm, &NoEffects, freedom)
    });
    found.collect()
}
