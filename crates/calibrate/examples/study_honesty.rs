//! How often a cause is named if none acts, or if twenty tiny ones act, with noise like that of real files.
//!
//! `cargo run --release -p denavit-calibrate --example study_honesty -- FILES [ROWS ...]`
#![allow(clippy::unwrap_used, clippy::print_stdout)] // A study prints, and stops at the first error.

use denavit_calibrate::{IdentifyOptions, Measurements};
use denavit_identify::effects::survey::with_run_order;
use denavit_identify::effects::{Carrier, Coupling, Driver, Effect, EffectModel, Kind, Statics, Term};
use denavit_identify::identify;
use denavit_identify::simulate::{SimulationOptions, simulate};
use denavit_measurements::kinds::ObservationKind;
use denavit_model::nalgebra::Vector3;
use denavit_model::{Chain, examples};
use denavit_trace::{Trace, TraceOptions, trace};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal, StudentT};

/// Standard deviation of a joint's repeatability, rad.
const REPEATABILITY: f64 = 3e-5;
/// Resolution of a reading, rad.
const ROUNDED: f64 = 2e-5;
/// Noise of the instrument along its beam and across it, m.
const ALONG: f64 = 1e-5;
const ACROSS: f64 = 3e-5;
/// Correlation of the instrument's error from row to row, and its size, m.
const CORRELATED: f64 = 0.8;
const SLOW: f64 = 1.5e-5;

/// Effects besides noise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum World {
    /// Nothing.
    Clean,
    /// Twenty tiny harmonics, each a fifth of a joint's repeatability.
    Field,
}

fn normal(random: &mut ChaCha8Rng) -> f64 {
    StandardNormal.sample(random)
}

/// Positions of one target measured on a robot with errors of the size of its tolerances.
pub fn file(chain: &Chain, world: World, rows: usize, seed: u64) -> Measurements {
    let mut random = ChaCha8Rng::seed_from_u64(seed ^ 0x5eed);
    let statics = Statics::of_chain(chain);
    let joints = chain.joints().len();
    let tiny = |k: usize| Effect {
        term: Term {
            kind: Kind::TransmissionError,
            carrier: Carrier::Joint(k % joints),
            driver: Driver::Harmonic { joint: k % joints, order: 1.0 + 0.7 * (k as f64) },
            coupling: Coupling::Each,
        },
        coefficients: vec![0.2 * REPEATABILITY * normal(&mut ChaCha8Rng::seed_from_u64(k as u64 + 99 * seed)), 0.0],
    };
    let effects = if world == World::Field { (0..20).map(tiny).collect() } else { Vec::new() };
    let kind = ObservationKind::Position;
    let options = SimulationOptions { kind, rows, seed, noise_position: 1e-9, ..Default::default() };
    let mut data = simulate(chain, &options, &EffectModel::new(statics, effects)).data;
    for reading in &mut data.readings {
        *reading = ((*reading + REPEATABILITY * normal(&mut random)) / ROUNDED).round() * ROUNDED;
    }
    let tails = StudentT::new(5.0).unwrap();
    let mut slow = Vector3::zeros();
    for observation in 0..data.observations() {
        let values = data.observed.values_mut(observation);
        let mut position = Vector3::from_row_slice(values);
        let mut draw = || Vector3::from_fn(|_, _| normal(&mut random));
        slow = slow * CORRELATED + draw() * (SLOW * (1.0 - CORRELATED * CORRELATED).sqrt());
        let beam = position.normalize();
        let scatter = Vector3::from_fn(|_, _| tails.sample(&mut random));
        let along = beam * beam.dot(&scatter);
        position += along * ALONG + (scatter - along) * ACROSS + slow;
        values.copy_from_slice(position.as_slice());
    }
    with_run_order(data)
}

/// Traces a file.
pub fn traced(chain: &Chain, data: &Measurements) -> Trace {
    let options = TraceOptions::new(IdentifyOptions::axes(chain));
    let geometric = identify(chain, data, &options.identify).geometric;
    trace(&Statics::of_chain(chain), data, &geometric, &options)
}

fn main() {
    let mut arguments = std::env::args().skip(1).map(|word| word.parse::<usize>().unwrap());
    let files = arguments.next().unwrap_or(100);
    let rows: Vec<usize> = arguments.collect();
    let rows = if rows.is_empty() { vec![25, 50, 100, 200, 400] } else { rows };
    let chain = examples::puma_like();
    for world in [World::Clean, World::Field] {
        for &rows in &rows {
            let (mut named, mut open, mut curves) = (0, 0, 0);
            for seed in 0..files as u64 {
                let found = traced(&chain, &file(&chain, world, rows, 1000 * rows as u64 + seed));
                for finding in found.findings.iter().filter(|finding| finding.named) {
                    println!("  {} at {} ({:.3})", finding.term.kind.name(), finding.place, finding.probability);
                }
                named += usize::from(found.findings.iter().any(|finding| finding.named));
                open += usize::from(found.findings.iter().any(|finding| !finding.named));
                curves += usize::from(!found.fit.effects.curves.is_empty());
            }
            println!(
                "{world:?}, {rows} rows: of {files} files {named} name a cause, {open} one of several, {curves} show a curve"
            );
        }
    }
}
