//! Noise level, intervals, outliers and speed of convergence: small slices of what `study_statistics` prints.

#![allow(clippy::print_stdout)] // What is printed is read.

use denavit_calibrate::IdentifyOptions;
use denavit_identify::gauge;
use denavit_identify::identify;
use denavit_identify::parameters::NoEffects;
use denavit_identify::simulate::{SimulationOptions, simulate};
use denavit_measurements::kinds::ObservationKind;
use denavit_model::examples;

#[test]
fn intervals_cover_and_chi_squared_is_its_degrees_of_freedom() {
    let chain = examples::puma_like();
    let (mut inside, mut count, mut chi) = (0.0, 0.0, 0.0);
    let runs = 40;
    for seed in 0..runs {
        let options = SimulationOptions { kind: ObservationKind::Pose, rows: 60, seed, ..Default::default() };
        let run = simulate(&chain, &options, &NoEffects);
        let found = identify(&chain, &run.data, &IdentifyOptions::axes(&chain));
        let fit = found.geometric;
        let truth = gauge::centred(&fit.layout, &run.arm, &found.nominal.arm);
        let (a, b) = (fit.layout.difference(&truth, &truth), fit.layout.difference(&fit.arm, &truth));
        for k in fit.layout.joints.clone() {
            count += 1.0;
            inside += f64::from(u8::from((a[k] - b[k]).abs() < 1.96 * fit.covariance[(k, k)].sqrt()));
        }
        let sum: f64 = fit.squares.iter().map(|square| (square[0] + square[1]) / options.noise_position.powi(2)).sum();
        let freedom = fit.values.iter().sum::<f64>() - fit.parameters_used.iter().sum::<f64>();
        chi += sum / freedom / f64::from(u32::try_from(runs).unwrap_or(1));
    }
    println!("inside {:.2} %, chi2/dof {chi:.4}", 100.0 * inside / count);
    assert!((0.93..0.97).contains(&(inside / count)), "{}", inside / count);
    assert!((chi - 1.0).abs() < 0.03, "{chi}");
}

#[test]
fn gross_outliers_are_listed_and_leave_the_noise_level_alone() {
    for kind in [ObservationKind::Pose, ObservationKind::Position, ObservationKind::Distance] {
        for chain in &examples::all()[1..] {
            let clean = SimulationOptions { kind, rows: 300, seed: 5, ..Default::default() };
            let noise = |options: &SimulationOptions| {
                let run = simulate(chain, options, &NoEffects);
                let fit = identify(chain, &run.data, &IdentifyOptions::axes(chain)).geometric;
                let rejected: Vec<usize> = (0..300).filter(|&row| fit.weights[row] == 0.0).collect();
                assert_eq!(rejected, run.outliers, "{} {kind:?}", chain.name());
                fit.noise.first()
            };
            let ratio = noise(&SimulationOptions { outliers: 0.05, ..clean.clone() }) / noise(&clean);
            println!("{} {kind:?}: {ratio:.4}", chain.name());
            assert!((ratio - 1.0).abs() < 0.05, "{} {kind:?}: {ratio}", chain.name());
        }
    }
}

#[test]
fn parallel_axes_converge_in_six_iterations() {
    for chain in [examples::puma_like(), examples::scara_helical()] {
        for (kind, noise) in
            [(ObservationKind::Pose, 5e-5), (ObservationKind::Position, 5e-5), (ObservationKind::Pose, 0.0)]
        {
            let options = SimulationOptions {
                kind,
                rows: 100,
                turn: 2e-3,
                shift: 2e-3,
                noise_position: noise,
                noise_orientation: noise,
                ..Default::default()
            };
            let run = simulate(&chain, &options, &NoEffects);
            let fit = identify(&chain, &run.data, &IdentifyOptions::axes(&chain)).geometric;
            assert!(fit.converged && fit.iterations <= 6, "{} {kind:?} {noise}: {}", chain.name(), fit.iterations);
        }
    }
}

#[test]
fn little_is_held_by_the_prior_where_poses_tell_it() {
    // Moving along the SCARA's parallel axes changes none of them: one of the frame's six conditions says nothing.
    for chain in [examples::puma_like(), examples::scara_helical()] {
        let options = SimulationOptions { kind: ObservationKind::Pose, rows: 40, ..Default::default() };
        let run = simulate(&chain, &options, &NoEffects);
        let fit = identify(&chain, &run.data, &IdentifyOptions::axes(&chain)).geometric;
        let held: Vec<f64> = fit.layout.joints.clone().map(|k| fit.held_by_prior(k)).collect();
        let most = held.iter().fold(0.0f64, |a, b| a.max(*b));
        println!("{}: {held:.3?}", chain.name());
        assert!(most > 0.0 && most < 0.3, "{}: {held:?}", chain.name());
    }
}
