//! Estimated sources of noise compared with the simulated ones: how often the intervals of each source contain its true size, and how often
//! sources that are present, and sources that are absent, are claimed.
//!
//! `cargo run --release -p denavit-calibrate --example study_noise -- [RUNS [ROWS]]`
#![allow(clippy::unwrap_used, clippy::print_stdout)] // A study prints, and stops at the first error.

use denavit_calibrate::{IdentifyOptions, Measurements};
use denavit_identify::identify;
use denavit_identify::noise::{Component, NoiseModel, noise_model};
use denavit_identify::parameters::NoEffects;
use denavit_identify::simulate::{SimulationOptions, simulate};
use denavit_measurements::kinds::ObservationKind;
use denavit_model::nalgebra::{Matrix3, Rotation3, Vector3};
use denavit_model::{Chain, examples};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal, StudentT};
use std::collections::BTreeMap;

/// The simulated noise, m and rad.
#[derive(Debug, Clone, PartialEq)]
pub struct World {
    /// Name in the table.
    pub name: &'static str,
    /// What is measured.
    pub kind: ObservationKind,
    /// In every component of a position.
    pub position: f64,
    /// In every component of an orientation.
    pub orientation: f64,
    /// Along the line of sight.
    pub range: f64,
    /// Across the line of sight.
    pub angle: f64,
    /// Of each joint.
    pub repeatability: [f64; 6],
    /// Degrees of freedom of Student's t for the noise of positions; `None`: normal.
    pub tails: Option<f64>,
    /// From the point about which a probe's orientation errs to the target, in the target's axes, m.
    pub lever: [f64; 3],
}

const WHITE: World = World {
    name: "white",
    kind: ObservationKind::Position,
    position: 3e-5,
    orientation: 3e-5,
    range: 0.0,
    angle: 0.0,
    repeatability: [0.0; 6],
    tails: None,
    lever: [0.0; 3],
};

/// Every world of the table.
pub fn worlds() -> Vec<World> {
    vec![
        WHITE,
        World { name: "white, poses", kind: ObservationKind::Pose, ..WHITE },
        World { name: "white, t with 5 degrees of freedom", tails: Some(5.0), ..WHITE },
        World { name: "range and angle", position: 5e-6, range: 1e-5, angle: 3e-5, ..WHITE },
        World { name: "range", position: 1e-5, range: 6e-5, ..WHITE },
        World { name: "joints 1 to 3", repeatability: [8e-5, 8e-5, 8e-5, 0.0, 0.0, 0.0], ..WHITE },
        World {
            name: "joints 1 to 3, poses",
            kind: ObservationKind::Pose,
            repeatability: [6e-5, 6e-5, 6e-5, 0.0, 0.0, 0.0],
            ..WHITE
        },
        World {
            name: "all joints alike, poses",
            kind: ObservationKind::Pose,
            position: 1e-5,
            repeatability: [4e-5; 6],
            ..WHITE
        },
        World {
            name: "poses of a probe that turns about a point 0.5 m away",
            kind: ObservationKind::Pose,
            lever: [0.3, 0.0, -0.4],
            ..WHITE
        },
        World {
            name: "the same, joints alike",
            kind: ObservationKind::Pose,
            position: 1e-5,
            orientation: 6e-5,
            lever: [0.3, 0.0, -0.4],
            repeatability: [4e-5; 6],
            ..WHITE
        },
        World {
            name: "joint 2 and angle",
            position: 1e-5,
            angle: 4e-5,
            repeatability: [0.0, 8e-5, 0.0, 0.0, 0.0, 0.0],
            ..WHITE
        },
    ]
}

/// Rows of a robot with errors of the size of its tolerances, measured in a world.
pub fn file(chain: &Chain, world: &World, rows: usize, seed: u64) -> Measurements {
    let turns = world.lever != [0.0; 3];
    let options = SimulationOptions {
        kind: world.kind,
        rows,
        seed,
        noise_position: if world.tails.is_some() { 0.0 } else { world.position },
        noise_orientation: if turns { 0.0 } else { world.orientation },
        noise_range: world.range,
        noise_angle: world.angle,
        repeatability: world.repeatability.to_vec(),
        ..SimulationOptions::default()
    };
    let mut data = simulate(chain, &options, &NoEffects).data;
    if turns {
        let mut random = ChaCha8Rng::seed_from_u64(seed ^ 0x1e4e5);
        for observation in 0..data.observations() {
            let values = data.observed.values_mut(observation);
            let target = Rotation3::from_matrix_unchecked(Matrix3::from_column_slice(&values[3..12]));
            let draw = |_, _| world.orientation * Distribution::<f64>::sample(&StandardNormal, &mut random);
            let off = Vector3::from_fn(draw);
            let moved = off.cross(&(target * Vector3::from(world.lever)));
            values[..3].iter_mut().zip(moved.iter()).for_each(|(value, moved)| *value += moved);
            values[3..12].copy_from_slice((Rotation3::from_scaled_axis(off) * target).matrix().as_slice());
        }
    }
    if let Some(freedom) = world.tails {
        let mut random = ChaCha8Rng::seed_from_u64(seed ^ 0x7a11);
        let student = StudentT::new(freedom).unwrap();
        // Of variance 1.
        let unit = (freedom / (freedom - 2.0)).sqrt().recip();
        for observation in 0..data.observations() {
            for value in &mut data.observed.values_mut(observation)[..3] {
                *value += world.position * unit * student.sample(&mut random);
            }
        }
    }
    data
}

/// The noise model of a file after the geometric fit.
pub fn found(chain: &Chain, data: &Measurements) -> NoiseModel {
    let fit = identify(chain, data, &IdentifyOptions::axes(chain)).geometric;
    noise_model(&fit, data, &[]).unwrap()
}

/// The name of a source, and its true size in a world.
pub fn truth(world: &World, component: &Component, chain: &Chain) -> (String, f64) {
    let joint = |name: &String| chain.coordinates().iter().position(|of| of.name == *name).unwrap();
    match (&*component.name, &component.joint) {
        ("position", _) => ("position".into(), world.position),
        ("orientation", _) => ("orientation".into(), world.orientation),
        ("range", _) => ("range".into(), world.range),
        ("angle", _) => ("angle".into(), world.angle),
        (_, Some(name)) => (name.clone(), world.repeatability[joint(name)]),
        _ => {
            let alike = world.repeatability.iter().all(|own| *own == world.repeatability[0]);
            ("all joints".into(), if alike { world.repeatability[0] } else { f64::NAN })
        }
    }
}

/// Counts of one source over many files.
#[derive(Debug, Clone, Default)]
pub struct Tally {
    /// Its true size.
    pub truth: f64,
    /// Files in which it was tried.
    pub files: usize,
    /// Files in which it was claimed.
    pub claimed: usize,
    /// Files in which the interval, or the bound, contains the truth.
    pub inside: usize,
    /// Sum of the estimates.
    pub sum: f64,
}

/// Runs of one world, source by source; and the numbers of files that claim an absent source, a correlation in run order, a lever.
pub fn tallied(
    chain: &Chain,
    world: &World,
    rows: usize,
    seeds: std::ops::Range<u64>,
) -> (BTreeMap<String, Tally>, [usize; 3]) {
    let mut tallies: BTreeMap<String, Tally> = BTreeMap::new();
    let mut wrong = [0; 3];
    for seed in seeds {
        let noise = found(chain, &file(chain, world, rows, 7_000 + seed));
        let mut any = false;
        for component in &noise.components {
            let (name, truth) = truth(world, component, chain);
            if truth.is_nan() {
                continue;
            }
            let tally = tallies.entry(name).or_default();
            tally.truth = truth;
            tally.files += 1;
            tally.claimed += usize::from(component.claimed);
            tally.inside += usize::from(component.low <= truth && component.high.is_none_or(|high| truth <= high));
            tally.sum += component.value;
            any |= component.claimed && truth == 0.0;
        }
        wrong[0] += usize::from(any);
        wrong[1] += usize::from(noise.run_order.is_some_and(|order| order.claimed));
        wrong[2] += usize::from(noise.lever.is_some());
    }
    (tallies, wrong)
}

fn main() {
    let mut arguments = std::env::args().skip(1).map(|word| word.parse::<usize>().unwrap());
    let runs = arguments.next().unwrap_or(200);
    let rows = arguments.next().unwrap_or(120);
    let only = arguments.next();
    let chain = examples::puma_like();
    println!("| noise | source | true size | mean estimate | inside 95 % | claimed |");
    println!("|---|---|---|---|---|---|");
    for (_, world) in worlds().iter().enumerate().filter(|(index, _)| only.is_none_or(|only| only == *index)) {
        let started = std::time::Instant::now();
        let (tallies, [wrong, order, lever]) = tallied(&chain, world, rows, 0..runs as u64);
        for (name, tally) in tallies {
            let share = |count: usize| 100.0 * count as f64 / tally.files as f64;
            println!(
                "| {} | {name} | {:.1} | {:.1} | {:.1} % | {:.1} % |",
                world.name,
                tally.truth * 1e6,
                tally.sum / tally.files as f64 * 1e6,
                share(tally.inside),
                share(tally.claimed)
            );
        }
        println!(
            "{}: {wrong} of {runs} files claim an absent source, {order} a correlation in run order, {lever} a lever; {:.2} s a file",
            world.name,
            started.elapsed().as_secs_f64() / runs as f64
        );
    }
}
