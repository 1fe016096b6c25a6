//! Rows of two robots, or of two places of the instrument, in one file: the rows that fit together are found by chance.
//!
//! # Source
//! Random sample consensus: Fischler, Bolles 1981.

use super::{misfit, size_of};
use crate::identify::initial_guess::nominal_fit;
use crate::identify::residual_statistics::residuals;
use crate::identify::solve::FitOptions;
use crate::identify::{IdentifyOptions, identify};
use crate::observation::measurements::Measurements;
use crate::observation::parameters::NoEffects;
use denavit_model::Chain;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Rows that place the instrument and a target, with some to spare.
const ROWS_TO_PLACE: usize = 5;
/// Draws: one of them is of one kind alone, when that makes up half of the rows, but for one file in a thousand.
const DRAWS: usize = 220;
/// A row belongs to the others when the robot as drawn, placed by them, is as near as this share of its size (and rad).
const NEAR: f64 = 0.02;
/// The rows that belong together are at least this share.
const LEAST_SHARE: f64 = 0.3;
/// The seed of the draws: the same file gives the same answer.
const SEED: u64 = 1;

/// Rows that do not fit where the others do, by index, and the misfit of the others; `None` where there is no such part.
pub(super) fn strangers(
    chain: &Chain,
    data: &Measurements,
    options: &IdentifyOptions,
    left: f64,
) -> Option<(Vec<usize>, [f64; 2])> {
    let rows: Vec<usize> = (0..data.len()).filter(|row| !data.locate[*row]).collect();
    if rows.len() < 4 * ROWS_TO_PLACE {
        return None;
    }
    let mut random = ChaCha8Rng::seed_from_u64(SEED);
    let mut best: Vec<usize> = Vec::new();
    for _ in 0..DRAWS {
        let drawn: Vec<usize> = (0..ROWS_TO_PLACE).map(|_| rows[random.random_range(0..rows.len())]).collect();
        let together = near(chain, data, &rows, &drawn);
        if together.len() > best.len() {
            best = together;
        }
    }
    // Placed by all that belong together, more may.
    for _ in 0..3 {
        let more = near(chain, data, &rows, &best);
        if more.len() <= best.len() {
            break;
        }
        best = more;
    }
    let share = best.len() as f64 / rows.len() as f64;
    if share < LEAST_SHARE || best.len() == rows.len() {
        return None;
    }
    let together = data.subset(&best);
    let after = misfit(&identify(chain, &together, options).geometric, &together);
    let others = rows.into_iter().filter(|row| !best.contains(row)).collect();
    (size_of(after, chain) * super::ORDER < left).then_some((others, after))
}

/// The rows that are near when these place the robot as drawn.
fn near(chain: &Chain, data: &Measurements, rows: &[usize], placing: &[usize]) -> Vec<usize> {
    let some = data.subset(placing);
    let options = FitOptions { robust: false, most_iterations: 20 };
    let fit = nominal_fit(chain, &some, &vec![1.0; some.observations()], &options);
    let off = |residual: &crate::identify::residual_statistics::Residual| {
        residual.place.norm() / chain.size() + residual.turn.norm()
    };
    let mut far = vec![false; data.len()];
    for residual in residuals(&fit.arm, &NoEffects, data) {
        let off = off(&residual);
        far[residual.row] |= off.is_nan() || off >= NEAR;
    }
    rows.iter().copied().filter(|row| !far[*row]).collect()
}
