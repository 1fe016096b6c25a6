//! The effects and error curves of an earlier calibration go on: each as long as the new rows do not speak against it.

#![allow(clippy::unwrap_used, clippy::print_stdout)] // Tests: a panic is a failure, what is printed is read.

use denavit_calibrate::calibration::adoption::Adopted;
use denavit_calibrate::calibration::{CalibrateOptions, Calibration, calibrate};
use denavit_calibrate::report::text;
use denavit_calibrate::{Arm, IdentifyOptions, Measurements};
use denavit_identify::carried::PartState;
use denavit_identify::effects::{Carrier, Coupling, Driver, Effect, EffectModel, Kind, SavedEffects, Statics, Term};
use denavit_identify::posterior::{Earlier, EarlierError};
use denavit_identify::simulate::{SimulationOptions, simulate, simulate_arm};
use denavit_model::examples::puma_like;
use denavit_model::nalgebra::Vector6;
use denavit_model::{Chain, se3};
use denavit_trace::infer::CurveOptions;

fn statics() -> Statics {
    Statics::of_chain(&puma_like())
}

/// Gears of joints 2 and 3 that err with several orders.
fn gears(second: f64, third: f64) -> EffectModel {
    let wave = |joint: usize, order: f64, sine: f64, cosine: f64| Effect {
        term: Term {
            kind: Kind::TransmissionError,
            carrier: Carrier::Joint(joint),
            driver: Driver::Harmonic { joint, order },
            coupling: Coupling::Each,
        },
        coefficients: vec![sine, cosine],
    };
    let waves = vec![
        wave(1, 2.3, 3e-4 * second, -2e-4 * second),
        wave(1, 5.7, -2e-4 * second, 2e-4 * second),
        wave(1, 9.1, 2e-4 * second, 2e-4 * second),
        wave(2, 3.4, 3e-4 * third, 2e-4 * third),
        wave(2, 7.2, -2e-4 * third, 3e-4 * third),
    ];
    EffectModel::new(statics(), waves)
}

/// An arm, its first day of 300 rows, and rows of later days.
fn first_day(model: &EffectModel, seed: u64) -> (Arm, Measurements) {
    let run = simulate(&puma_like(), &SimulationOptions { rows: 300, seed, ..Default::default() }, model);
    (run.arm, run.data)
}

fn later(arm: &Arm, model: &EffectModel, rows: usize, seed: u64) -> Measurements {
    simulate_arm(arm, &SimulationOptions { rows, seed, ..Default::default() }, model).data
}

fn calibrated(data: &Measurements, test: Option<&Measurements>, earlier: Option<Earlier>) -> Calibration {
    let chain = puma_like();
    let identify = IdentifyOptions { earlier, ..IdentifyOptions::axes(&chain) };
    let curves = Some(CurveOptions::default());
    let options = CalibrateOptions { identify, curves, ..CalibrateOptions::geometry(&chain) };
    calibrate(&chain, &statics(), data.clone(), test.cloned(), &options).unwrap()
}

fn known(result: &Calibration, chain: &Chain) -> Earlier {
    Earlier::read("earlier.json", &result.report.to_json(), chain).unwrap()
}

fn rms(result: &Calibration, stage: &str) -> f64 {
    let names: Vec<&str> = result.report.stages.iter().map(|stage| &stage.name[..]).collect();
    let stage = result.report.stages.iter().find(|found| found.name == stage).unwrap_or_else(|| panic!("{names:?}"));
    stage.test.as_ref().unwrap().of("position").unwrap().rms
}

#[test]
fn ten_poses_bring_curves_up_to_date_as_one_fit_of_both_days_does() {
    let (mut alone, mut updated, mut both_days, mut axes) = (0.0, 0.0, 0.0, 0.0);
    for seed in 0..3 {
        let (arm, first) = first_day(&gears(1.0, 1.0), seed);
        let second = later(&arm, &gears(1.0, 1.0), 10, seed + 100);
        let test = later(&arm, &gears(1.0, 1.0), 100, seed + 200);
        let before = calibrated(&first, None, None);
        assert_eq!(before.report.curves.len(), 2);
        let anew = calibrated(&second, Some(&test), None);
        let after = calibrated(&second, Some(&test), Some(known(&before, &puma_like())));
        let both = Measurements::joined(vec![first.of_setup("a"), second.of_setup("b")]).unwrap();
        let both = calibrated(&both, Some(&test.of_setup("b")), None);
        alone += rms(&anew, "geometric").powi(2);
        axes += rms(&after, "geometric").powi(2);
        updated += rms(&after, "updated").powi(2);
        both_days += rms(&both, "geometric + curves").powi(2);
        assert_eq!(after.report.adopted, Adopted::Updated);
        let earlier = after.report.earlier.as_ref().unwrap();
        assert!(
            earlier.weight >= 0.5 && earlier.effects.iter().all(|part| part.state == PartState::Kept),
            "{earlier:?}"
        );
        // What was carried over is in the model that is handed on, and in the report.
        let found: Vec<&str> = after.report.curves.iter().map(|curve| curve.joint.as_str()).collect();
        assert_eq!(found, ["joint_2", "joint_3"]);
        assert_eq!(after.effects(&statics()).effects.curves.len(), 2);
        assert!(
            text::calibration(&after).contains("2 of its 2 effects and error curves are carried over"),
            "{}",
            text::calibration(&after)
        );
    }
    println!(
        "sums of squares, m²: ten poses alone {alone:.3e}, with the axes {axes:.3e}, with axes and curves {updated:.3e}, both days {both_days:.3e}"
    );
    assert!(updated < 1.15 * both_days && updated < 0.5 * axes && updated < 0.2 * alone);
}

#[test]
fn a_gear_that_was_exchanged_is_not_held_to_its_old_curve() {
    for seed in 0..3 {
        let (arm, first) = first_day(&gears(3.0, 1.0), seed);
        let before = calibrated(&first, None, None);
        // The gear of joint 2 is another now.
        let now = gears(-2.0, 1.0);
        let (second, test) = (later(&arm, &now, 25, seed + 100), later(&arm, &now, 100, seed + 200));
        let anew = calibrated(&second, Some(&test), None);
        let after = calibrated(&second, Some(&test), Some(known(&before, &puma_like())));
        let states: Vec<(&str, PartState)> =
            after.report.earlier.as_ref().unwrap().effects.iter().map(|part| (&part.place[..], part.state)).collect();
        println!(
            "alone {:.3e}, earlier {:.3e}, updated {:.3e} m; {states:?}",
            rms(&anew, "geometric"),
            rms(&after, "earlier"),
            rms(&after, "updated")
        );
        assert_eq!(states[0], ("joint_2", PartState::Contradicted));
        assert!(rms(&after, "updated") < 1.02 * rms(&anew, "geometric"));
        assert!(
            text::calibration(&after).contains("left out: the error curve of joint_2, as these rows contradict it")
        );
        assert!(after.report.curves.iter().all(|curve| curve.joint != "joint_2"));
    }
}

/// The arm after a knock: everything from a joint on is turned and shifted.
fn knocked(arm: &Arm, from: usize, twist: Vector6<f64>) -> Arm {
    let mut knocked = arm.clone();
    let moved = se3::exp(&twist);
    for joint in &mut knocked.joints[from..] {
        joint.screw = joint.screw.moved(&moved);
    }
    knocked
}

#[test]
fn a_knock_of_the_geometry_is_no_change_of_the_effects() {
    let (mut dropped, mut parts) = (0, 0);
    for seed in 0..3 {
        let (arm, first) = first_day(&gears(1.0, 1.0), seed);
        let before = calibrated(&first, None, None);
        // 2 mrad and 1 mm between the links before joint 4, and a zero that is off by 3 mrad.
        let knocks =
            [(3, Vector6::new(2e-3, -1e-3, 0.0, 5e-4, 1e-3, 0.0)), (2, Vector6::new(0.0, 3e-3, 0.0, 0.0, 0.0, 0.0))];
        for (from, twist) in knocks {
            let second = later(&knocked(&arm, from, twist), &gears(1.0, 1.0), 25, seed + 100);
            let after = calibrated(&second, None, Some(known(&before, &puma_like())));
            let earlier = after.report.earlier.as_ref().unwrap();
            println!("weight of the axes {}, {:?}", earlier.weight, earlier.effects);
            parts += earlier.effects.len();
            dropped += earlier.effects.iter().filter(|part| part.state != PartState::Kept).count();
        }
    }
    assert!(dropped == 0 && parts >= 12, "{dropped} of {parts} were dropped");
}

#[test]
fn the_third_day_continues_the_second() {
    let (arm, first) = first_day(&gears(1.0, 1.0), 4);
    let chain = puma_like();
    let before = calibrated(&first, None, None);
    let second = calibrated(&later(&arm, &gears(1.0, 1.0), 10, 40), None, Some(known(&before, &chain)));
    let test = later(&arm, &gears(1.0, 1.0), 100, 42);
    let third = calibrated(&later(&arm, &gears(1.0, 1.0), 10, 41), Some(&test), Some(known(&second, &chain)));
    assert_eq!(third.report.earlier.as_ref().unwrap().effects.len(), 2);
    assert!(rms(&third, "updated") < 0.115e-3, "{}", rms(&third, "updated"));
}

#[test]
fn many_rows_look_for_more_beside_what_was_known() {
    // Joint 5 got a gear that errs since.
    let (arm, first) = first_day(&gears(1.0, 1.0), 5);
    let before = calibrated(&first, None, None);
    let mut now = gears(1.0, 1.0);
    let mut more = gears(0.0, 3.0).effects.split_off(3);
    for effect in &mut more {
        effect.term.carrier = Carrier::Joint(4);
        if let Driver::Harmonic { joint, .. } = &mut effect.term.driver {
            *joint = 4;
        }
    }
    now.effects.extend(more);
    let (second, test) = (later(&arm, &now, 300, 50), later(&arm, &now, 100, 51));
    let after = calibrated(&second, Some(&test), Some(known(&before, &puma_like())));
    let [updated, more] = ["updated", "updated + curves"].map(|stage| rms(&after, stage));
    assert!(more < 0.8 * updated && more < 0.1e-3, "{updated} {more}");
    let mut joints: Vec<&str> = after.report.curves.iter().map(|curve| curve.joint.as_str()).collect();
    joints.dedup();
    assert!(joints.contains(&"joint_5") && joints.contains(&"joint_2"), "{joints:?}");
    // And all of that goes on, too.
    let again = known(&after, &puma_like());
    let third = calibrated(&later(&arm, &now, 12, 52), Some(&test), Some(again));
    assert!(rms(&third, "updated") < 0.115e-3, "{}", rms(&third, "updated"));
}

/// A calibration's JSON that knows these effects beside its curves, their coefficients to 1 %.
fn with_effects(result: &Calibration, effects: Vec<Effect<Driver<String>>>) -> Earlier {
    let mut json: serde_json::Value = serde_json::from_str(&result.report.to_json()).unwrap();
    let parameters = json["parameters"].as_array().unwrap().len();
    let numbers: Vec<f64> = effects.iter().flat_map(|effect| effect.coefficients.clone()).collect();
    let saved = SavedEffects { effects, ..SavedEffects::none(statics()) };
    json["posterior"]["effects"] = serde_json::json!({
        "model": serde_json::from_str::<serde_json::Value>(&saved.to_json()).unwrap(),
        "fields": 0,
        "std": numbers.iter().map(|value| 0.01 * value.abs()).collect::<Vec<f64>>(),
        "correlations": (0..numbers.len()).map(|k| vec![0.0; parameters + k]).collect::<Vec<_>>(),
    });
    Earlier::read("earlier.json", &json.to_string(), &puma_like()).unwrap()
}

#[test]
fn what_was_of_that_day_is_left_out_and_named() {
    let (arm, first) = first_day(&gears(0.0, 0.0), 6);
    let before = calibrated(&first, None, None);
    let effect = |kind: Kind, carrier: Carrier, driver: Driver<String>, coefficients: &[f64]| Effect {
        term: Term { kind, carrier, driver, coupling: Coupling::Each },
        coefficients: coefficients.to_vec(),
    };
    let column = |name: &str| Driver::Covariate(name.to_string());
    let earlier = with_effects(
        &before,
        vec![
            effect(Kind::Drift, Carrier::Joint(1), column("time"), &[1e-6]),
            effect(Kind::InstrumentScale, Carrier::Scale, Driver::Constant, &[1e-5]),
            effect(Kind::Thermal, Carrier::Joint(2), column("temperature"), &[1e-5]),
            effect(Kind::JointCoupling, Carrier::Joint(5), Driver::Reading(4), &[1e-9]),
        ],
    );
    let after = calibrated(&later(&arm, &gears(0.0, 0.0), 10, 60), None, Some(earlier));
    let parts = &after.report.earlier.as_ref().unwrap().effects;
    let states: Vec<PartState> = parts.iter().map(|part| part.state).collect();
    let wanted = [PartState::OfThatRun, PartState::OfThatSetup, PartState::NoColumn, PartState::Kept];
    assert_eq!(states, wanted, "{parts:?}");
    let said = text::calibration(&after);
    for words in ["drift at joint_2, as it was a drift of the earlier run", "these rows do not have, \"temperature\""] {
        assert!(said.contains(words), "{said}");
    }
}

#[test]
fn effects_of_a_prior_that_cannot_be_are_refused() {
    let (_, first) = first_day(&gears(1.0, 1.0), 7);
    let text = calibrated(&first, None, None).report.to_json();
    let refused = |change: &dyn Fn(&mut serde_json::Value)| -> EarlierError {
        let mut json: serde_json::Value = serde_json::from_str(&text).unwrap();
        change(&mut json["posterior"]["effects"]);
        Earlier::read("e.json", &json.to_string(), &puma_like()).unwrap_err()
    };
    let error = refused(&|effects| effects["std"] = serde_json::json!([1.0])).to_string();
    assert!(error.starts_with("e.json: posterior.effects: std and correlations need "), "{error}");
    let error = refused(&|effects| effects["modes"][0][0] = serde_json::json!([1.0])).to_string();
    assert!(error.starts_with("e.json: posterior.effects: modes must match the curves"), "{error}");
    let error = refused(&|effects| effects["model"]["curves"][0]["joint"] = 9.into()).to_string();
    assert!(error.starts_with("e.json: curve 1: it names joint 9"), "{error}");
    let error = refused(&|effects| effects["fields"] = 3.into()).to_string();
    assert!(error.contains("fields is 3, but there are 0 effects"), "{error}");
}

#[path = "../examples/study_prior.rs"]
#[allow(dead_code, reason = "the study has a main of its own")]
pub mod study;

#[test]
fn a_second_day_of_ten_poses_does_what_one_fit_of_both_days_does_and_says_how_sure_it_is() {
    let runs: Vec<study::Run> = (0..4).map(|seed| study::run(10, 300 + seed)).collect();
    let mean = |of: &dyn Fn(&study::Run) -> f64| runs.iter().map(of).sum::<f64>() / runs.len() as f64;
    let rms = |k: usize| mean(&|run| run.errors[k].powi(2)).sqrt();
    let inside = mean(&|run| run.inside[1]);
    println!("{:.4} {:.4} {:.4} {:.4} mm, {inside:.3} inside", rms(0) * 1e3, rms(1) * 1e3, rms(2) * 1e3, rms(3) * 1e3);
    assert!(rms(2) < 1.1 * rms(3) && rms(2) < 0.5 * rms(1), "{} {} {}", rms(1), rms(2), rms(3));
    assert!(inside > 0.85, "{inside}");
}
