//! Postures that are measured again: the pure error, and whether the model misses more than that.

#![allow(clippy::unwrap_used)] // Tests: a panic is a failure.

use denavit_calibrate::Measurements;
use denavit_calibrate::calibration::{CalibrateOptions, Calibration, calibrate};
use denavit_calibrate::report::text;
use denavit_identify::effects::driver::Statics;
use denavit_identify::lack_of_fit::LackOfFit;
use denavit_identify::parameters::NoEffects;
use denavit_identify::simulate::{SimulationOptions, simulate};
use denavit_measurements::kinds::ObservationKind;
use denavit_model::{Chain, examples};

fn geometry(chain: &Chain, data: Measurements) -> Calibration {
    calibrate(chain, &Statics::of_chain(chain), data, None, &CalibrateOptions::geometry(chain)).unwrap()
}

/// Forty postures, each measured three times, with 0.05 mm and 0.05 mrad of noise; readings of joint 2 off by
/// `misfit`·sin 3q, which no geometry follows.
fn run(seed: u64, misfit: f64) -> (Chain, Measurements) {
    let chain = examples::puma_like();
    let options = SimulationOptions { kind: ObservationKind::Pose, rows: 40, seed, ..SimulationOptions::default() };
    let once = simulate(&chain, &options, &NoEffects).data;
    let readings: Vec<Vec<f64>> = (0..120).map(|row| once.reading(row % 40).to_vec()).collect();
    let mut data =
        simulate(&chain, &SimulationOptions { rows: 120, readings: Some(readings), ..options }, &NoEffects).data;
    for row in 0..data.len() {
        let reading = &mut data.readings[row * data.joints.len() + 1];
        *reading += misfit * (3.0 * *reading).sin();
    }
    (chain, data)
}

#[test]
fn the_pure_error_is_the_noise_and_a_true_model_misses_nothing() {
    let mut chance = Vec::new();
    for seed in 0..20 {
        let (chain, data) = run(seed, 0.0);
        let found = geometry(&chain, data).report.repeats;
        assert_eq!(
            found.iter().map(|it| (it.of, it.postures, it.observations)).collect::<Vec<_>>(),
            [("position", 40, 120), ("orientation", 40, 120)]
        );
        for LackOfFit { pure_error, pure_degrees, p_value, .. } in found {
            assert!((pure_error / 5e-5 - 1.0).abs() < 0.2, "{pure_error}");
            assert_eq!(pure_degrees, 240);
            chance.push(p_value);
        }
    }
    chance.sort_by(f64::total_cmp);
    // Evenly spread over 0 to 1, as p-values of what is true are; forty of them lie within 0.26 of that (Kolmogorov, 1 %).
    for (index, p) in chance.iter().enumerate() {
        assert!((p - (index as f64 + 0.5) / chance.len() as f64).abs() < 0.26, "{chance:?}");
    }
}

#[test]
fn what_the_model_misses_stands_out_of_the_pure_error() {
    let (chain, data) = run(1, 2e-4);
    let result = geometry(&chain, data);
    let position = result.report.repeats[0];
    assert!(position.p_value < 1e-6 && position.f.unwrap() > 2.0, "{position:?}");
    assert!((position.pure_error / 5e-5 - 1.0).abs() < 0.2 && position.missed > 3e-5, "{position:?}");
    let said = text::report(&result);
    assert!(said.contains("40 postures measured again (120 positions): repeats differ by 0.05"), "{said}");
    assert!(said.contains("lack of fit: 0.0"), "{said}");
}

#[test]
fn exact_copies_of_rows_are_no_repeats() {
    let (chain, data) = run(2, 2e-4);
    let data = data.subset(&(0..40).chain(0..40).collect::<Vec<_>>());
    assert!(geometry(&chain, data).report.repeats.is_empty(), "a copy tells nothing of the noise");
}

#[test]
fn one_posture_each_says_nothing() {
    let (chain, data) = run(3, 0.0);
    let result = geometry(&chain, data.subset(&(0..40).collect::<Vec<_>>()));
    assert!(result.report.repeats.is_empty() && !text::report(&result).contains("measured again"));
}
