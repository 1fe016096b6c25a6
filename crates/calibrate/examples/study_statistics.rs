//! Are the noise level, the standard deviations and the held-out error right? Prints the table of docs/calibration.md.

#![allow(clippy::print_stdout)] // A study prints its table.

use denavit_calibrate::errors::{errors, residuals};
use denavit_calibrate::simulate::{SimulationOptions, simulate, simulate_arm};
use denavit_calibrate::{IdentifyOptions, MeasurementKind, NoEffects, gauge, identify};
use denavit_model::{Chain, examples};

struct Tally {
    inside: f64,
    parameters: f64,
    chi_squared: f64,
    excess: f64,
    iterations: usize,
    rejected: usize,
    missed: usize,
}

fn runs(chain: &Chain, base: &SimulationOptions, count: u64) -> Tally {
    let mut tally =
        Tally { inside: 0.0, parameters: 0.0, chi_squared: 0.0, excess: 0.0, iterations: 0, rejected: 0, missed: 0 };
    for seed in 0..count {
        let run = simulate(chain, &SimulationOptions { seed, ..base.clone() }, &NoEffects);
        let found = identify(chain, &run.data, &IdentifyOptions::axes(chain));
        let fit = found.geometric;
        let truth = gauge::centred(&fit.layout, &run.arm, &found.nominal.arm);
        let estimated = fit.layout.departure(&fit.arm, &truth);
        let (a, b) = (fit.layout.departure(&truth, &truth), estimated);
        for k in fit.layout.joints.clone() {
            let deviation = fit.covariance[(k, k)].sqrt();
            tally.parameters += 1.0;
            tally.inside += f64::from(u8::from((a[k] - b[k]).abs() < 1.96 * deviation));
        }
        // Orientation in the tally too, each in its true noise.
        let mut chi = 0.0;
        for (square, weight) in fit.squares.iter().zip(&fit.weights) {
            let turned =
                if base.kind == MeasurementKind::Pose { square[1] / base.noise_orientation.powi(2) } else { 0.0 };
            chi += weight * (square[0] / base.noise_position.powi(2) + turned);
        }
        let values: f64 = fit.values.iter().sum();
        let used: f64 = fit.parameters_used.iter().sum();
        tally.chi_squared += chi / (values - used) / count as f64;
        let test = SimulationOptions { rows: 500, seed: 1_000_000 + seed, outliers: 0.0, ..base.clone() };
        let test = simulate_arm(&run.arm, &test, &NoEffects);
        let error = errors(&residuals(&fit.arm, &NoEffects, &test.data), base.kind);
        let components: f64 = if base.kind == MeasurementKind::Distance { 1.0 } else { 3.0 };
        let rms = error.position_rms_m.or(error.distance_rms_m).unwrap_or(f64::NAN) / components.sqrt();
        let attainable = base.noise_position * (1.0 + used / values).sqrt();
        tally.excess += rms / attainable / count as f64;
        tally.iterations = tally.iterations.max(fit.iterations);
        let targets = run.data.targets.len();
        for (observation, weight) in fit.weights.iter().enumerate() {
            if *weight == 0.0 && !run.outliers.contains(&(observation / targets)) {
                tally.rejected += 1;
            }
        }
        for row in &run.outliers {
            tally.missed += usize::from(fit.weights[row * targets] > 0.0);
        }
    }
    tally
}

fn main() {
    println!(
        "robot          measured  rows  outliers  inside 95 %  chi2/dof  error/attainable  iterations  wrongly rejected  missed"
    );
    let chains = examples::all();
    for chain in &chains[1..] {
        for kind in [MeasurementKind::Pose, MeasurementKind::Position, MeasurementKind::Distance] {
            for (rows, outliers, count) in [(40, 0.0, 200), (200, 0.0, 100), (200, 0.05, 100)] {
                let base = SimulationOptions { kind, rows, outliers, ..Default::default() };
                let tally = runs(chain, &base, count);
                println!(
                    "{:14} {:9} {rows:4}  {outliers:8}  {:10.2} %  {:8.4}  {:16.4}  {:10}  {:16}  {:6}",
                    chain.name(),
                    format!("{kind:?}"),
                    100.0 * tally.inside / tally.parameters,
                    tally.chi_squared,
                    tally.excess,
                    tally.iterations,
                    tally.rejected,
                    tally.missed
                );
            }
        }
    }
}
