//! Whether a smooth error of two joints is found where there is one, and nowhere else.
//!
//! `cargo run --release -p denavit-calibrate --example study_fields -- [RUNS] [ROWS]`
//!
//! UR5e, off by 1 mrad and 1 mm on each axis, 0.05 mm noise of each component of position, readings spread over ±2.5 rad; a third as many rows
//! more are held out. Worlds: an error of joint 2 or 3 that is a product of sines of two readings; nothing; gears that err; joints that give
//! under gravity.
#![allow(clippy::unwrap_used, clippy::print_stdout)] // A study prints, and stops at the first error.

#[path = "study_coverage.rs"]
#[allow(dead_code, clippy::duplicate_mod, reason = "each study stands alone, and the tests take parts of several")]
pub mod study_coverage;

use denavit_calibrate::Measurements;
use denavit_calibrate::apply::simulate::{SimulationOptions, simulate};
use denavit_calibrate::calibration::{CalibrateOptions, Calibration, calibrate};
use denavit_calibrate::effects::field::{Products, ShapedReading, Shapes};
use denavit_calibrate::effects::{Carrier, Coupling, Driver, Effect, EffectModel, Kind, Term};
use denavit_calibrate::trace::TraceOptions;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::time::Instant;
use study_coverage::{SMOOTH, gears, readings, ur5e};

/// Over which the products of waves that act run, rad: more than the readings, so that they are none of those that are fitted.
const SPAN: f64 = 3.4;

/// What acts beside the axes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum World {
    /// A joint errs by a smooth function of two readings, this many µrad at its largest wave.
    Field(u32),
    /// Nothing.
    Clean,
    /// Gears err.
    Gears,
    /// Joints give under gravity.
    Gravity,
}

/// The effects of a world.
pub fn effects(world: World, rows: usize, seed: u64) -> Vec<Effect> {
    let mut random = ChaCha8Rng::seed_from_u64(seed ^ 0xf1e1d);
    let at = |kind: Kind, joint: usize, driver: Driver, coefficients: Vec<f64>| Effect {
        term: Term { kind, carrier: Carrier::Joint(joint), driver, coupling: Coupling::Each },
        coefficients,
    };
    match world {
        World::Clean => Vec::new(),
        World::Gears => gears(SMOOTH, &readings(rows, seed), seed),
        World::Gravity => {
            [1, 2].map(|joint| at(Kind::JointCompliance, joint, Driver::Torque(joint), vec![6e-6])).to_vec()
        }
        World::Field(size) => {
            let joint = random.random_range(1..3);
            let shapes = Shapes::Range { low: -SPAN, high: SPAN };
            let of = [1, 2].map(|joint| ShapedReading { joint, shapes });
            let mut coefficients = vec![0.0; Products::COUNT];
            let size = f64::from(size) * 1e-6;
            // The first two waves of each reading.
            for place in [0, 1, 4, 5] {
                coefficients[place] = size * random.random_range(0.5..1.0) * [-1.0, 1.0][random.random_range(0..2)];
            }
            vec![at(Kind::JointField, joint, Driver::Products(Products { of, size }), coefficients)]
        }
    }
}

/// Rows of this world to fit, and a third as many more.
pub fn run(world: World, rows: usize, seed: u64) -> (Measurements, Measurements) {
    let (chain, statics) = ur5e();
    let all = rows + rows / 3;
    let options = SimulationOptions { rows: all, seed, readings: Some(readings(all, seed)), ..Default::default() };
    let data = simulate(&chain, &options, &EffectModel::new(statics, effects(world, all, seed))).data;
    let part = |own: std::ops::Range<usize>| data.subset(&own.collect::<Vec<usize>>());
    (part(0..rows), part(rows..all))
}

/// A calibration of a file of this world, a third as many rows more held out.
pub fn calibrated(world: World, rows: usize, seed: u64) -> Calibration {
    let (chain, statics) = ur5e();
    let (train, test) = run(world, rows, seed);
    let mut options = CalibrateOptions::geometry(&chain);
    options.trace = Some(TraceOptions::new(options.identify.clone()));
    calibrate(&chain, &statics, train, Some(test), &options).unwrap()
}

/// How many fields of two joints the adopted model has, held-out rms with them and without, m, and how many causes are named.
pub fn judged(result: &Calibration) -> (usize, f64, f64, usize) {
    let fields = result.report.fields.iter().filter(|field| field.kind == "two_joints").count();
    let rms = |stage: &denavit_calibrate::calibration::contract::Stage| {
        stage.test.as_ref().unwrap().of("position").unwrap().rms
    };
    let adopted = result.report.stages.iter().find(|stage| stage.adopted).unwrap();
    let without = result.report.stages.iter().filter(|stage| !stage.name.ends_with("fields"));
    let without = without.map(rms).fold(f64::INFINITY, f64::min);
    (fields, rms(adopted), without, result.report.effects.len())
}

#[allow(dead_code, reason = "the tests take the parts")]
fn main() {
    let number = |k: usize, or: u64| std::env::args().nth(k).map_or(or, |word| word.parse().unwrap());
    let (runs, rows) = (number(1, 20), usize::try_from(number(2, 300)).unwrap());
    println!("| {runs} files of {rows} rows | with a field | held out, rms, mm | without | causes named | s |");
    println!("|---|---:|---:|---:|---:|---:|");
    let worlds = [World::Field(1000), World::Field(500), World::Field(250), World::Clean, World::Gears, World::Gravity];
    for world in worlds {
        let started = Instant::now();
        let found: Vec<_> = (0..runs).map(|seed| judged(&calibrated(world, rows, 300 + seed))).collect();
        let seconds = started.elapsed().as_secs_f64() / runs as f64;
        let with = found.iter().filter(|run| run.0 > 0).count();
        let rms = |of: fn(&(usize, f64, f64, usize)) -> f64| {
            (found.iter().map(|run| of(run).powi(2)).sum::<f64>() / runs as f64).sqrt() * 1e3
        };
        let named: usize = found.iter().map(|run| run.3).sum();
        println!("| {world:?} | {with} | {:.4} | {:.4} | {named} | {seconds:.2} |", rms(|run| run.1), rms(|run| run.2));
    }
}
