//! The nightly watch over 10 000 healthy robots and 100 with a growing effect: false alarms, detections, nights until detection.
//!
//! A night of a UR5e is forty positions of one program, 0.05 mm noise. The joint scatter of its 24 parameters, and the response to a
//! growing effect, come from real calibrations of simulated nights; then 10 100 robots are simulated with these numbers.
//!
//! `cargo run --release -p denavit-fleet --example study_watch` prints the table of docs/fleet.md.

#![allow(clippy::print_stdout)] // A study prints its table.
#![allow(clippy::unwrap_used, clippy::cast_possible_truncation, clippy::cast_sign_loss)]

use denavit_calibrate::Measurements;
use denavit_calibrate::calibration::{CalibrateOptions, calibrate};
use denavit_fleet::statistics::vigil::{Night, Nights, Watch, scatters, watch_of};
use denavit_identify::arm::Arm;
use denavit_identify::effects::driver::Statics;
use denavit_identify::parameters::Effects;
use denavit_identify::parameters::NoEffects;
use denavit_identify::simulate::effect_specification::{EffectSpecification, specified_effects};
use denavit_identify::simulate::{Simulation, SimulationOptions, commanded_readings, simulate, simulate_arm};
use denavit_load::Selection;
use denavit_model::Chain;
use denavit_model::nalgebra::{DMatrix, DVector};
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;
use rand_distr::{ChiSquared, StandardNormal};

const HEALTHY: usize = 10_000;
const SICK: usize = 100;
const NIGHTS: i32 = 60;
/// The effect grows from this night on.
const ONSET: i32 = 20;
/// Growth of the tip displacement by the effect, root mean square, mm per night.
const GROWTH: f64 = 0.005;
/// Nights that are calibrated for the scatter.
const CALIBRATED: u64 = 300;
const NOISE: f64 = 5e-5;

struct Cell {
    chain: Chain,
    statics: Statics,
    arm: Arm,
    options: SimulationOptions,
}

impl Cell {
    fn new() -> Self {
        let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../robots/universal_robots/ur5e.urdf");
        let loaded = denavit_load::load(file, &denavit_load::Options::default()).unwrap().robot;
        let selection = Selection { file, ..Selection::default() };
        let chain = loaded.chain(&selection).unwrap().value;
        let statics = loaded.statics(&chain, selection.reading);
        let readings = Some(commanded_readings(&chain, 40, 7));
        let options = SimulationOptions { rows: 40, readings, noise_position: NOISE, ..SimulationOptions::default() };
        let arm = simulate(&chain, &options, &NoEffects).arm;
        Self { chain, statics, arm, options }
    }

    fn night<E: Effects>(&self, seed: u64, noise: f64, effects: &E) -> Simulation {
        simulate_arm(&self.arm, &SimulationOptions { seed, noise_position: noise, ..self.options.clone() }, effects)
    }

    fn numbers(&self, data: Measurements) -> DVector<f64> {
        let options = CalibrateOptions::geometry(&self.chain);
        let report = calibrate(&self.chain, &self.statics, data, None, &options).unwrap().report;
        let rms = report.stages.last().unwrap().train.0[0].rms;
        let numbers = report.parameters.iter().map(|parameter| parameter.change).chain([rms]);
        DVector::from_vec(numbers.collect())
    }

    /// Response of the numbers to 1 mm of an effect: a difference of two nights with the same noise, at a quarter of a mm.
    fn response(&self, written: &str) -> DVector<f64> {
        let bare = self.night(1, NOISE, &NoEffects);
        let specification: EffectSpecification = format!("{written}=0.25mm").parse().unwrap();
        let model = specified_effects(&[specification], &self.statics, &bare, 1).unwrap();
        let with = self.night(1, NOISE, &model);
        (self.numbers(with.data) - self.numbers(bare.data)) * 4.0
    }
}

fn main() {
    let cell = Cell::new();
    let calibrated: Vec<DVector<f64>> =
        (0..CALIBRATED).map(|seed| cell.numbers(cell.night(seed, NOISE, &NoEffects).data)).collect();
    let count = calibrated[0].len();
    let mean = calibrated.iter().sum::<DVector<f64>>() / CALIBRATED as f64;
    let mut covariance = DMatrix::zeros(count, count);
    for night in &calibrated {
        covariance += (night - &mean) * (night - &mean).transpose() / (CALIBRATED as f64 - 1.0);
    }
    // The parameters are correlated: the smallest eigenvalue of 25 needs a lower bound before the root is taken.
    let scale = DVector::from_iterator(count, (0..count).map(|k| covariance[(k, k)].sqrt()));
    let mut unit = covariance.component_div(&(&scale * scale.transpose()));
    (0..count).for_each(|k| unit[(k, k)] += 1e-9);
    let lower = unit.cholesky().unwrap().l();
    let sick = ["joint_compliance@elbow_joint", "backlash@shoulder_pan_joint", "transmission_error@wrist_1_joint"];
    println!("{HEALTHY} healthy robots, {SICK} sick of each kind, {NIGHTS} nights of 40 positions; an effect grows by");
    println!("{} µm of rms displacement a night from night {ONSET} on\n", 1e3 * GROWTH);
    for (name, tails) in [("normal", None), ("Student, 4 degrees of freedom", Some(4.0))] {
        println!("scatter from night to night: {name}");
        println!("effect                               found  nights until alarm: median   90 %   µm rms then");
        for (kind, effect) in sick.iter().enumerate() {
            let response = cell.response(effect).component_div(&scale);
            let fleet = fleet(&lower, &response, tails, kind as u64);
            let how = Watch::default();
            let scatters = scatters(&fleet, count, &how);
            let (mut false_alarms, mut called, mut false_marks, mut expected) =
                (0, std::collections::BTreeSet::new(), 0, 0.0);
            let mut found = vec![None; SICK];
            // Fraction of false marks among a night's marks, by whether any robot is sick.
            let mut mistakes: [Vec<f64>; 2] = [Vec::new(), Vec::new()];
            for tonight in 0..NIGHTS {
                let said = watch_of(&fleet, &scatters, tonight, &how);
                expected += said.expected_false;
                let anybody = tonight > ONSET;
                let wrong = said.marked.iter().filter(|robot| **robot < HEALTHY || !anybody).count();
                false_marks += wrong;
                if said.watched > 0 {
                    mistakes[usize::from(anybody)].push(wrong as f64 / said.marked.len().max(1) as f64);
                }
                for alarm in &said.alarms {
                    match alarm.robot.checked_sub(HEALTHY) {
                        None => {
                            false_alarms += 1;
                            called.insert(alarm.robot);
                        }
                        Some(_) if !anybody => false_alarms += 1,
                        Some(sick) => found[sick] = found[sick].or(Some(tonight - ONSET)),
                    }
                }
            }
            let mut nights: Vec<i32> = found.iter().flatten().copied().collect();
            nights.sort_unstable();
            let at = |share: f64| nights.get((share * SICK as f64) as usize).map_or("-".into(), ToString::to_string);
            let then = nights.get(SICK / 2).map_or(f64::NAN, |night| 1e3 * GROWTH * f64::from(*night));
            println!("{effect:<36} {:>3} of {SICK}  {:>18} {:>12} {then:>13.0}", nights.len(), at(0.5), at(0.9));
            println!(
                "    healthy: {false_alarms} false alarms of {} robots in {} nights ({expected:.1e} expected), {false_marks} \
                 false marks; share of mistakes among a night's marks: {}, with sick robots {}",
                called.len(),
                mistakes.iter().map(Vec::len).sum::<usize>(),
                share(&mistakes[0]),
                share(&mistakes[1]),
            );
        }
        println!();
    }
}

/// Mean and its standard deviation: the false discovery rate of a night.
fn share(nights: &[f64]) -> String {
    let count = nights.len() as f64;
    let mean = nights.iter().sum::<f64>() / count;
    let variance = nights.iter().map(|night| (night - mean).powi(2)).sum::<f64>() / (count - 1.0) / count;
    format!("{mean:.3} ± {:.3}", variance.sqrt())
}

/// Robots whose numbers have the joint scatter `lower`, in units of each number's scatter.
fn fleet(lower: &DMatrix<f64>, response: &DVector<f64>, tails: Option<f64>, seed: u64) -> Vec<Nights> {
    let count = lower.nrows();
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let robot = |index: usize| {
        let own: Vec<f64> = (0..count).map(|_| 100.0 * random.sample::<f64, _>(StandardNormal)).collect();
        let mut night = |day: i32| {
            let drawn = DVector::from_iterator(count, (0..count).map(|_| random.sample::<f64, _>(StandardNormal)));
            // One bad night affects all numbers together.
            let wide = tails.map_or(1.0, |freedom| {
                let chi: f64 = random.sample(ChiSquared::new(freedom).unwrap());
                (freedom / chi).sqrt()
            });
            let size = if index < HEALTHY { 0.0 } else { GROWTH * f64::from((day - ONSET).max(0)) };
            let values = lower * drawn * wide + response * size;
            Night {
                day,
                event: false,
                values: own.iter().zip(values.iter()).map(|(own, value)| Some(own + value)).collect(),
            }
        };
        Nights { nights: (0..NIGHTS).map(&mut night).collect() }
    };
    (0..HEALTHY + SICK).map(robot).collect()
}
