//! Two days of one robot with joint compliance and gear errors: a few poses of the second day with the first day's calibration, compared
//! with one fit of both days.
//!
//! `cargo run --release -p denavit-calibrate --example study_prior -- [RUNS]`
//!
//! UR5e as in `study_coverage`: 300 poses on the first day, instrument and target placed again on the second; errors on 200 test rows of
//! the second day, including the noise of these rows.
#![allow(clippy::unwrap_used, clippy::print_stdout)] // A study prints, and stops at the first error.

#[path = "study_coverage.rs"]
#[allow(dead_code, reason = "one study takes a part of the other")]
pub mod study_coverage;

use denavit_calibrate::calibration::{CalibrateOptions, Calibration, calibrate};
use denavit_calibrate::{Arm, IdentifyOptions, Measurements};
use denavit_identify::effects::{Carrier, Coupling, Driver, Effect, EffectModel, Kind, Term};
use denavit_identify::gauge;
use denavit_identify::posterior::Earlier;
use denavit_identify::simulate::{SimulationOptions, simulate, simulate_arm};
use denavit_trace::infer::CurveOptions;
use study_coverage::{SMOOTH, gears, readings, ur5e};

/// Poses of the first day.
const FIRST: usize = 300;

/// One run.
pub struct Run {
    /// Errors on the second day, m, rms: its poses alone, with the axes of the first day, with its whole model, one fit of both days.
    pub errors: [f64; 4],
    /// Fraction of the axes' parameters whose 95 % interval contains the truth: the first day, the second after it, both in one fit.
    pub inside: [f64; 3],
}

/// Simulates both days; `poses`: poses of the second day.
pub fn run(poses: usize, seed: u64) -> Run {
    let (chain, statics) = ur5e();
    let first = readings(FIRST, seed);
    let mut effects = gears(SMOOTH, &first, seed);
    effects.extend([1, 2].map(|joint| Effect {
        term: Term {
            kind: Kind::JointCompliance,
            carrier: Carrier::Joint(joint),
            driver: Driver::Torque(joint),
            coupling: Coupling::Each,
        },
        coefficients: vec![1e-5],
    }));
    let model = EffectModel::new(statics.clone(), effects);
    let of = |readings: Vec<Vec<f64>>, seed| SimulationOptions {
        rows: readings.len(),
        seed,
        readings: Some(readings),
        ..Default::default()
    };
    let before = simulate(&chain, &of(first, seed), &model);
    let again = |rows, seed| simulate_arm(&before.arm, &of(readings(rows, seed), seed), &model).data;
    let all = again(poses + 200, seed + 50_000);
    let (now, test) =
        (all.subset(&(0..poses).collect::<Vec<_>>()), all.subset(&(poses..poses + 200).collect::<Vec<_>>()));
    let calibrated = |data: &Measurements, test: Option<&Measurements>, earlier: Option<Earlier>| {
        let identify = IdentifyOptions { earlier, ..IdentifyOptions::axes(&chain) };
        let curves = Some(CurveOptions::default());
        let options = CalibrateOptions { identify, curves, ..CalibrateOptions::geometry(&chain) };
        calibrate(&chain, &statics, data.clone(), test.cloned(), &options).unwrap()
    };
    let first_day = calibrated(&before.data, None, None);
    let known = Earlier::read("earlier.json", &first_day.report.to_json(), &chain).unwrap();
    let alone = calibrated(&now, Some(&test), None);
    let after = calibrated(&now, Some(&test), Some(known));
    let both = Measurements::joined(vec![before.data.clone().of_setup("a"), now.of_setup("b")]).unwrap();
    let both = calibrated(&both, Some(&test.of_setup("b")), None);
    let rms = |result: &Calibration, name: &str| {
        let stage = result.report.stages.iter().find(|stage| stage.name == name).unwrap();
        stage.test.as_ref().unwrap().of("position").unwrap().rms
    };
    // The true robot in the frame of the fit's report.
    let inside = |result: &Calibration| {
        let updated = result.carried.as_ref().map(|carried| &carried.updated);
        let fit = updated.or(result.named()).unwrap();
        let truth = Arm { joints: before.arm.joints.clone(), ..fit.arm.clone() };
        let truth = gauge::centred(&fit.layout, &truth, &fit.arm);
        let [expected, estimated] = [&truth, &fit.arm].map(|arm| fit.layout.difference(arm, &truth));
        let determined: Vec<usize> = fit.layout.joints.clone().filter(|&k| fit.deviation(k) > 1e-12).collect();
        let hits = determined.iter().filter(|&&k| (estimated[k] - expected[k]).abs() < fit.half_interval(k, 0.95));
        hits.count() as f64 / determined.len() as f64
    };
    Run {
        errors: [
            rms(&alone, "geometric"),
            rms(&after, "geometric"),
            rms(&after, "updated"),
            rms(&both, "geometric + curves"),
        ],
        inside: [inside(&first_day), inside(&after), inside(&both)],
    }
}

#[allow(dead_code, reason = "the tests take the parts")]
fn main() {
    let runs: u64 = std::env::args().nth(1).map_or(50, |word| word.parse().unwrap());
    println!(
        "| poses of the second day | alone, mm rms | with the axes of the first | with its effects and curves | both days in one fit \
         | axes inside 95 %: first day | second | both |"
    );
    println!("|---|---|---|---|---|---|---|---|");
    for poses in [5, 10, 20, 40] {
        let found: Vec<Run> = (0..runs).map(|seed| run(poses, 100 + seed)).collect();
        let mean = |of: &dyn Fn(&Run) -> f64| found.iter().map(of).sum::<f64>() / runs as f64;
        let rms = |k: usize| mean(&|run| run.errors[k].powi(2)).sqrt() * 1e3;
        let inside = |k: usize| mean(&|run| run.inside[k]) * 100.0;
        println!(
            "| {poses} | {:.4} | {:.4} | {:.4} | {:.4} | {:.1} % | {:.1} % | {:.1} % |",
            rms(0),
            rms(1),
            rms(2),
            rms(3),
            inside(0),
            inside(1),
            inside(2)
        );
    }
}
