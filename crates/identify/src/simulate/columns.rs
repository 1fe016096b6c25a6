//! Recorded columns of a simulated run: time, temperatures, payloads, inclinations, sides of approach, velocities.

use crate::effects::driver::{APPROACH, VELOCITY};
use denavit_measurements::Covariate;
use denavit_measurements::covariates::PAYLOAD;
use denavit_model::{Chain, Quantity};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::StandardNormal;
use thiserror::Error;

/// A word that is not a column.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error(
    "\"{0}\" cannot be simulated as a column; write some of time, temperature, payload, tilt_x, tilt_y, approach, velocity, \
     JOINT.approach, JOINT.velocity, JOINT.temperature"
)]
pub struct NoColumn(pub String);

/// From one row to the next, s.
const SECONDS_PER_ROW: f64 = 15.0;
/// A cold room, °C.
const COLD: f64 = 20.0;
/// Rise of the temperature, °C.
const WARMER: f64 = 8.0;
/// Time constant of that, s.
const WARMING: f64 = 1800.0;
/// Attached payloads, kg.
const PAYLOADS: [f64; 4] = [0.0, 1.0, 2.0, 3.0];
/// Standard deviation of an inclination, rad: a base on soft ground.
const TILT: f64 = 5e-4;
/// Highest speed of a joint, rad/s.
const FASTEST: f64 = 0.5;
/// Highest speed of a slide, m/s.
const FASTEST_SLIDE: f64 = 0.1;

/// The columns of these names for `rows` rows of a run of which `first_row` were measured before.
///
/// `approach` and `velocity` stand for a column of every joint.
///
/// # Errors
/// A name is not one of those.
pub fn columns(
    names: &[String],
    chain: &Chain,
    rows: usize,
    first_row: usize,
    seed: u64,
) -> Result<Vec<Covariate>, NoColumn> {
    let mut all: Vec<String> = Vec::new();
    for name in names {
        let joints = chain.coordinates().iter().map(|coordinate| &coordinate.name);
        match name.as_str() {
            "approach" => all.extend(joints.map(|joint| format!("{joint}{APPROACH}"))),
            "velocity" => all.extend(joints.map(|joint| format!("{joint}{VELOCITY}"))),
            name => all.push(name.to_owned()),
        }
    }
    let mut unique: Vec<String> = Vec::new();
    for name in all {
        if !unique.contains(&name) {
            unique.push(name);
        }
    }
    let made = unique.into_iter().enumerate().map(|(index, name)| {
        // A separate stream, so that an additional column changes no other.
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        random.set_stream(index as u64 + 1);
        let values = values(&name, chain, rows, first_row, &mut random).ok_or_else(|| NoColumn(name.clone()))?;
        Ok(Covariate { name, values })
    });
    made.collect()
}

fn values(name: &str, chain: &Chain, rows: usize, first_row: usize, random: &mut ChaCha8Rng) -> Option<Vec<f64>> {
    let time = |row: usize| (first_row + row) as f64 * SECONDS_PER_ROW;
    let mut warm = |row: usize| {
        let noise: f64 = random.sample(StandardNormal);
        hundredths(COLD - WARMER * (-time(row) / WARMING).exp_m1() + 0.05 * noise)
    };
    match name {
        "time" => return Some((0..rows).map(time).collect()),
        "temperature" => return Some((0..rows).map(warm).collect()),
        "tilt_x" | "tilt_y" => {
            let tilt = |_| TILT * random.sample::<f64, _>(StandardNormal);
            return Some((0..rows).map(tilt).collect());
        }
        PAYLOAD => return Some((0..rows).map(|_| PAYLOADS[random.random_range(0..PAYLOADS.len())]).collect()),
        _ => {}
    }
    let (joint, word) = name.rsplit_once('.')?;
    let coordinate = chain.coordinates().iter().find(|coordinate| coordinate.name == joint)?;
    match word {
        "approach" => Some((0..rows).map(|_| if random.random::<bool>() { 1.0 } else { -1.0 }).collect()),
        "velocity" => {
            let fastest = if coordinate.quantity == Quantity::Length { FASTEST_SLIDE } else { FASTEST };
            Some(
                (0..rows).map(|_| hundredths(100.0 * fastest * (2.0 * random.random::<f64>() - 1.0)) / 100.0).collect(),
            )
        }
        "temperature" => Some((0..rows).map(&mut warm).collect()),
        _ => None,
    }
}

/// As a display with two decimals shows it.
fn hundredths(value: f64) -> f64 {
    (value * 100.0).round() / 100.0
}
