//! Zeros of joints and nothing else, from what was measured.

use denavit_calibrate::calibration::{CalibrateOptions, calibrate};
use denavit_calibrate::report::text;
use denavit_calibrate::{Arm, IdentifyOptions, Measurements};
use denavit_identify::effects::driver::Statics;
use denavit_identify::identify;
use denavit_identify::parameters::NoEffects;
use denavit_identify::parameters::ParameterKind;
use denavit_identify::simulate::{SimulationOptions, simulate, simulate_arm};
use denavit_measurements::kinds::ObservationKind;
use denavit_model::{Chain, examples};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Noise of the simulated instrument, m and rad.
const NOISE: f64 = 2e-4;

/// Rows of a robot that is as drawn but for its zeros.
fn measured(chain: &Chain, kind: ObservationKind, zeros: &[f64], seed: u64) -> (Arm, Measurements) {
    let options = SimulationOptions {
        kind,
        rows: 40,
        seed,
        turn: 0.0,
        shift: 0.0,
        noise_position: NOISE,
        noise_orientation: NOISE,
        ..Default::default()
    };
    let mut arm = simulate(chain, &SimulationOptions { rows: 1, ..options.clone() }, &NoEffects).arm;
    zeros.iter().enumerate().for_each(|(joint, zero)| arm.shift_zero(joint, *zero));
    let data = simulate_arm(&arm, &options, &NoEffects).data;
    (arm, data)
}

fn all(chain: &Chain) -> IdentifyOptions {
    IdentifyOptions::zeros(chain, vec![true; chain.joints().len()])
}

/// Zeros up to 5°.
fn drawn(chain: &Chain, random: &mut ChaCha8Rng) -> Vec<f64> {
    chain.joints().iter().map(|_| random.random_range(-0.09..0.09)).collect()
}

#[test]
fn zeros_are_found_as_well_as_can_be() {
    let chain = examples::puma_like();
    for kind in [ObservationKind::Position, ObservationKind::Pose, ObservationKind::Distance] {
        let mut random = ChaCha8Rng::seed_from_u64(7);
        let (mut squares, mut inside, mut count) = (0.0, 0.0, 0.0);
        for seed in 0..60 {
            let zeros = drawn(&chain, &mut random);
            let (truth, data) = measured(&chain, kind, &zeros, seed);
            let fit = identify(&chain, &data, &all(&chain)).geometric;
            assert!(fit.converged_or_exact(), "{kind:?} {seed}");
            let (found, expected) = (fit.layout.difference(&fit.arm, &fit.arm), fit.layout.difference(&truth, &truth));
            for k in fit.layout.joints.clone().filter(|&k| fit.held_by_prior(k) < 0.5) {
                // The bound by the noise that was drawn, not by the one that was estimated.
                let bound = fit.deviation(k) * NOISE / fit.noise.first();
                squares += ((found[k] - expected[k]) / bound).powi(2);
                inside += f64::from(u8::from((found[k] - expected[k]).abs() < fit.half_interval(k, 0.95)));
                count += 1.0;
            }
        }
        let (error, covered) = ((squares / count).sqrt(), inside / count);
        println!(
            "{kind:?}: {count} zeros, error over the bound {error:.3}, 95 % intervals cover {:.1} %",
            100.0 * covered
        );
        assert!((error - 1.0).abs() < 0.05 + 1.5 / f64::sqrt(2.0 * count), "{kind:?} {error}");
        assert!((covered - 0.95).abs() < 0.03, "{kind:?} {covered}");
    }
}

#[test]
fn the_first_and_the_last_zero_hide_behind_instrument_and_target() {
    let chain = examples::puma_like();
    let (_, data) = measured(&chain, ObservationKind::Pose, &[0.05, -0.04, 0.03, 0.05, -0.06, 0.02], 3);
    let options = CalibrateOptions { identify: all(&chain), ..CalibrateOptions::geometry(&chain) };
    let result = calibrate(&chain, &Statics::of_chain(&chain), data, None, &options).unwrap();
    let determined: Vec<bool> =
        result.report.zeros().map(denavit_calibrate::calibration::contract::Identified::is_determined).collect();
    assert_eq!(determined, [false, true, true, true, true, false]);
    let said = text::report(&result);
    println!("{said}");
    assert!(said.contains("zero of joint_1: it has the effect of another pose of the instrument"), "{said}");
    assert!(said.contains("zero of joint_6: it has the effect of another pose of the target"), "{said}");
    for (zero, expected) in
        result.report.zeros().zip([0.05, -0.04, 0.03, 0.05, -0.06, 0.02]).filter(|(z, _)| z.is_determined())
    {
        assert!((zero.change - expected).abs() < 5.0 * zero.std, "{} {}", zero.joint, zero.change);
    }
}

#[test]
fn a_zero_of_a_quarter_turn_is_found_too() {
    let chain = examples::puma_like();
    let quarter = std::f64::consts::FRAC_PI_2;
    let (_, data) = measured(&chain, ObservationKind::Position, &[0.0, 0.02, quarter, 0.0, 0.01, 0.0], 5);
    let options = CalibrateOptions { identify: all(&chain), ..CalibrateOptions::geometry(&chain) };
    let result = calibrate(&chain, &Statics::of_chain(&chain), data, None, &options).unwrap();
    let zero = result.report.zeros().find(|zero| zero.joint == "joint_3").unwrap();
    assert!((zero.change - quarter).abs() < 0.01, "{}", zero.change);
}

#[test]
fn a_calibration_says_when_it_found_zeros_and_little_else() {
    let chain = examples::puma_like();
    let zeros = [0.0, 0.03, -0.04, 0.02, 0.05, 0.0];
    let (_, data) = measured(&chain, ObservationKind::Position, &zeros, 11);
    let of =
        |data| calibrate(&chain, &Statics::of_chain(&chain), data, None, &CalibrateOptions::geometry(&chain)).unwrap();
    let result = of(data);
    let found = result.report.joint_zeros.as_ref().unwrap();
    assert!(found.share > 0.999, "{}", found.share);
    assert!(text::report(&result).contains("joint zeros alone explain"), "{}", text::report(&result));
    // A robot of links that are a millimetre off is not one of zeros.
    let options = SimulationOptions { turn: 2e-3, shift: 2e-3, noise_position: NOISE, ..Default::default() };
    let result = of(simulate(&chain, &options, &NoEffects).data);
    assert_eq!(result.report.joint_zeros, None);
}

#[test]
fn only_the_named_zeros_move() {
    let chain = examples::puma_like();
    let mut which = vec![false; 6];
    (which[1], which[2]) = (true, true);
    let (_, data) = measured(&chain, ObservationKind::Position, &[0.0, 0.03, -0.04, 0.0, 0.0, 0.0], 13);
    let fit = identify(&chain, &data, &IdentifyOptions::zeros(&chain, which)).geometric;
    let names: Vec<&str> = fit.layout.parameters[fit.layout.joints.clone()].iter().map(|p| p.name.as_str()).collect();
    assert_eq!(names, ["joint_2.zero", "joint_3.zero"]);
    assert!(
        fit.layout.parameters[fit.layout.joints.clone()].iter().all(|p| matches!(p.kind, ParameterKind::Zero { .. }))
    );
    assert!((fit.arm.change(1).zero - 0.03).abs() < 1e-3 && (fit.arm.change(2).zero + 0.04).abs() < 1e-3);
    assert!((0..6).all(|joint| fit.arm.change(joint).turned == [0.0; 2]));
}
