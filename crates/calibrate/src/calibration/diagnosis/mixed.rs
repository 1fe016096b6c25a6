//! Rows of two robots, or of two places of the instrument, in one file: rows that fit together are found by random sampling.
//!
//! # Source
//! Random sample consensus: Fischler, Bolles 1981.

use super::{misfit, size_of};
use denavit_identify::initial_guess::nominal_fit;
use denavit_identify::parameters::NoEffects;
use denavit_identify::residual_statistics::residuals;
use denavit_identify::solve::{Fit, FitOptions};
use denavit_identify::{IdentifyOptions, identify};
use denavit_measurements::Measurements;
use denavit_model::Chain;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Rows that place the instrument and a target, with some to spare.
const ROWS_TO_PLACE: usize = 5;
/// Number of samples: at least one is of one kind only, if that is half of the rows, except in one file of a thousand.
const DRAWS: usize = 220;
/// A row belongs to the others if the error of the robot as drawn, placed by them, is below this share of its size (and rad).
const NEAR: f64 = 0.02;
/// Smallest share of rows that belong together.
const LEAST_SHARE: f64 = 0.3;
/// Rows on which one of two robots is fitted.
const ROWS_OF_ONE: usize = 150;
/// A third of the rows must measure this many numbers for each parameter.
const SPARE: usize = 2;
/// The seed of the samples: the same file gives the same answer.
const SEED: u64 = 1;

/// Rows that do not fit although the others do, by index, and the misfit of the others; `None` if there are none.
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
    // Placed by all rows that belong together, more rows may belong.
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

/// Rows from some row on that are of another robot of the same model: the geometry of the first third does not fit
/// the last, and vice versa; by index, and the misfit of the rows before. `None` if one geometry fits all.
///
/// An instrument, a base or a target that was moved in between does not count: separate frames for each part explain it.
pub(super) fn individuals(
    chain: &Chain,
    data: &Measurements,
    options: &IdentifyOptions,
    left: f64,
) -> Option<(Vec<usize>, [f64; 2])> {
    let rows: Vec<usize> = (0..data.len()).filter(|row| !data.locate[*row]).collect();
    let third = rows.len() / 3;
    let thinned = |rows: &[usize]| {
        let every = rows.len().div_ceil(ROWS_OF_ONE);
        data.subset(&rows.iter().copied().step_by(every.max(1)).collect::<Vec<usize>>())
    };
    let fitted = |rows: &[usize]| {
        let part = thinned(rows);
        let fit = identify(chain, &part, options).geometric;
        let after = misfit(&fit, &part);
        (fit, after)
    };
    let numbers = data.values() / data.len().max(1);
    if third * numbers < SPARE * (4 * chain.joints().len() + 9) {
        return None;
    }
    let (one, at_first) = fitted(&rows[..third]);
    if size_of(at_first, chain) * super::ORDER >= left {
        return None;
    }
    let (other, at_last) = fitted(&rows[rows.len() - third..]);
    if size_of(at_last, chain) * super::ORDER >= left {
        return None;
    }
    // The row from which the second fits better: the split with the least sum of both.
    let squares = |fit: &Fit<NoEffects>| {
        let mut sums = vec![0.0; data.len()];
        for residual in residuals(&fit.arm, &NoEffects, data) {
            sums[residual.row] += (residual.place.norm() / chain.size() + residual.turn.norm()).powi(2);
        }
        rows.iter().map(|row| sums[*row]).collect::<Vec<f64>>()
    };
    let (before, behind) = (squares(&one), squares(&other));
    let mut sum: f64 = behind.iter().sum();
    let mut best = (sum, 0);
    for (place, (of_one, of_other)) in before.iter().zip(&behind).enumerate() {
        sum += of_one - of_other;
        if sum < best.0 {
            best = (sum, place + 1);
        }
    }
    let split = best.1;
    let parts = [&rows[..split], &rows[split..]];
    if parts.iter().any(|part| part.len() < third) {
        return None;
    }
    let apart = parts.map(|part| fitted(part).1);
    let worst = apart.iter().map(|after| size_of(*after, chain)).fold(0.0, f64::max);
    let [first, second] = parts.map(thinned);
    let moved = Measurements::joined(vec![first.of_setup("before"), second.of_setup("behind")])?;
    let with_own_frames = size_of(misfit(&identify(chain, &moved, options).geometric, &moved), chain);
    (worst * super::ORDER < with_own_frames.min(left)).then(|| (parts[1].to_vec(), apart[0]))
}

/// The rows that are near when these place the robot as drawn.
fn near(chain: &Chain, data: &Measurements, rows: &[usize], placing: &[usize]) -> Vec<usize> {
    let some = data.subset(placing);
    let options = FitOptions { robust: false, most_iterations: 20, ..FitOptions::default() };
    let fit = nominal_fit(chain, &some, &vec![1.0; some.observations()], &options);
    let off = |residual: &denavit_identify::residual_statistics::Residual| {
        residual.place.norm() / chain.size() + residual.turn.norm()
    };
    let mut far = vec![false; data.len()];
    for residual in residuals(&fit.arm, &NoEffects, data) {
        let off = off(&residual);
        far[residual.row] |= off.is_nan() || off >= NEAR;
    }
    rows.iter().copied().filter(|row| !far[*row]).collect()
}
