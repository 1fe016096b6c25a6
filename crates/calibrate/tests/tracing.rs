//! The tracer on small simulated runs, and on the robot of the paper's first author.
//!
//! The judge of detection rates is the blind data of `tests/oracle/calibration`, made by other code.

#![allow(clippy::print_stdout, reason = "tests say what they skipped")]
#![allow(clippy::unwrap_used, reason = "a test that cannot make its input has failed")]

use crate::drawn::drawn;
use crate::measured::measured;
use denavit_calibrate::calibration::{CalibrateOptions, calibrate};
use denavit_calibrate::{IdentifyOptions, Measurements};
use denavit_identify::effects::survey::with_run_order;
use denavit_identify::effects::{Carrier, Coupling, Driver, Effect, EffectModel, Kind, Statics, Term};
use denavit_identify::identify;
use denavit_identify::parameters::NoEffects;
use denavit_identify::simulate::effect_specification::specified_effects;
use denavit_identify::simulate::{SimulationOptions, simulate};
use denavit_measurements::kinds::ObservationKind;
use denavit_measurements::{Units, read};
use denavit_model::Chain;
use denavit_trace::{Trace, TraceOptions, trace};

fn traced(effects: Vec<Effect>, seed: u64) -> Trace {
    let (chain, statics) = drawn("universal_robots/ur5e.urdf");
    let options = SimulationOptions { rows: 150, seed, ..SimulationOptions::default() };
    traced_in(&chain, &statics, &simulate(&chain, &options, &EffectModel::new(statics.clone(), effects)).data)
}

fn traced_in(chain: &Chain, statics: &Statics, data: &Measurements) -> Trace {
    let options = TraceOptions::new(IdentifyOptions::axes(chain));
    let geometric = identify(chain, data, &options.identify).geometric;
    trace(statics, data, &geometric, &options)
}

fn effect(kind: Kind, carrier: Carrier, driver: Driver, coefficients: &[f64]) -> Effect {
    let term = Term { kind, carrier, driver, coupling: Coupling::Each };
    Effect { term, coefficients: coefficients.to_vec() }
}

fn check(kind: Kind, carrier: Carrier, driver: Driver, coefficients: &[f64]) {
    let found = traced(vec![effect(kind, carrier, driver, coefficients)], 7);
    let names: Vec<_> = found.findings.iter().map(|finding| (finding.term.kind, finding.term.carrier)).collect();
    assert_eq!(names, [(kind, carrier)], "{:?}", found.findings);
    let finding = &found.findings[0];
    for (value, truth) in finding.values.iter().zip(coefficients) {
        let std = value.std.unwrap();
        assert!((value.value - truth).abs() < 4.5 * std, "{}: {} ± {std}, truth {truth}", value.name, value.value);
    }
    assert!(finding.probability > 0.5 && !found.unexplained.structured);
    assert!((found.fit.noise.first() / 5e-5 - 1.0).abs() < 0.12, "{}", found.fit.noise.first());
}

#[test]
fn clean_data_name_nothing() {
    for seed in 0..4 {
        let found = traced(Vec::new(), seed);
        assert!(found.findings.is_empty(), "{:?}", found.findings);
        assert!(!found.unexplained.structured && !found.scan.is_empty());
    }
}

#[test]
fn an_eccentric_encoder_is_found_at_its_order() {
    check(Kind::TransmissionError, Carrier::Joint(2), Driver::Harmonic { joint: 2, order: 2.0 }, &[3e-4, 2e-4]);
}

#[test]
fn a_soft_joint_is_found_by_its_torque() {
    check(Kind::JointCompliance, Carrier::Joint(1), Driver::Torque(1), &[8e-6]);
}

/// Loads on the drawing's axes made this a joint with a balancer's spring, whose sine and cosine took up what 2 mrad do.
#[test]
fn a_soft_joint_stays_plain_on_an_arm_that_is_not_as_drawn() {
    let (chain, statics) = drawn("universal_robots/ur5e.urdf");
    let soft = |joint: usize, c: f64| effect(Kind::JointCompliance, Carrier::Joint(joint), Driver::Torque(joint), &[c]);
    let model = EffectModel::new(statics.clone(), vec![soft(1, 4.5e-5), soft(2, 8.8e-5)]);
    let options =
        SimulationOptions { rows: 300, seed: 22, turn: 2e-3, shift: 2e-3, noise_position: 2e-5, ..Default::default() };
    let found = traced_in(&chain, &statics, &simulate(&chain, &options, &model).data);
    let mut drivers: Vec<Driver> = found.findings.iter().map(|finding| finding.term.driver.clone()).collect();
    drivers.sort_by_key(Driver::joint);
    assert_eq!(drivers, [Driver::Torque(1), Driver::Torque(2)]);
}

#[test]
fn an_order_within_a_gear_is_found_without_its_ratio() {
    check(Kind::TransmissionError, Carrier::Joint(3), Driver::Harmonic { joint: 3, order: 17.3 }, &[4e-4, 3e-4]);
}

#[test]
fn a_base_that_is_softer_one_way_is_one_base_and_no_wobble() {
    let softness = [2e-5, 4e-6, 4e-6, 5e-6, 0.0, 0.0];
    check(Kind::BaseCompliance, Carrier::BaseTurn, Driver::LevelOverturning, &softness);
}

#[test]
fn a_gear_that_stiffens_is_one_compliance_and_no_play() {
    let driver = Driver::HardeningTorque { joint: 2, knee: 4.0 };
    let found = traced(vec![effect(Kind::JointCompliance, Carrier::Joint(2), driver, &[5e-6, 8e-5])], 11);
    let [finding] = &found.findings[..] else { panic!("{:?}", found.findings) };
    assert_eq!((finding.term.kind, finding.term.carrier), (Kind::JointCompliance, Carrier::Joint(2)));
    assert!(matches!(finding.term.driver, Driver::HardeningTorque { .. }), "{:?}", finding.term.driver);
}

#[test]
fn pitch_and_coupling_are_separated() {
    let pitch = effect(Kind::HelicalPitch, Carrier::Along(0), Driver::Reading(0), &[2e-4]);
    let scale = effect(Kind::JointScale, Carrier::Joint(2), Driver::Reading(2), &[8e-4]);
    let found = traced(vec![pitch, scale], 3);
    let mut kinds: Vec<Kind> = found.findings.iter().map(|finding| finding.term.kind).collect();
    kinds.sort();
    // A scale is the straightest of curves: it is named, or it is left to its joint's curve, for which no cause is claimed.
    kinds.retain(|kind| *kind != Kind::JointScale);
    assert_eq!(kinds, [Kind::HelicalPitch]);
}

/// A step that stands on the wrong side of some rows makes outliers of them, and what is left does not say that it is elsewhere: the first of
/// these stayed ten to thirty rows away.
#[test]
fn a_base_that_was_pushed_twice_is_found_to_the_row() {
    let (chain, statics) = drawn("universal_robots/ur5e.urdf");
    for seed in [0, 5] {
        let options =
            SimulationOptions { kind: ObservationKind::Position, rows: 250, targets: 3, seed, ..Default::default() };
        let bare = simulate(&chain, &options, &NoEffects);
        let pushes = ["drift@base:step=139=3mm", "drift@base:step=219=3mm"].map(|text| text.parse().unwrap());
        let model = specified_effects(&pushes, &statics, &bare, seed).unwrap();
        let found = traced_in(&chain, &statics, &with_run_order(simulate(&chain, &options, &model).data));
        let [finding] = &found.findings[..] else { panic!("{:?}", found.findings) };
        assert_eq!((finding.term.kind, finding.term.carrier), (Kind::Drift, Carrier::Base));
        let Driver::Steps { at, .. } = &finding.term.driver else { panic!("{:?}", finding.term.driver) };
        assert_eq!(at, &[138.5, 218.5]);
        assert!(found.fit.weights.iter().all(|weight| *weight > 0.0));
    }
}

/// Wu, Yang, Chen, Ren 2015: 0.266 mm mean and 0.525 mm largest on the same 40 rows.
#[test]
fn wu_irb120_lacks_compliance() {
    let (chain, statics) = drawn("abb/irb120.urdf");
    let load = |name: &str| {
        let path = measured(name)?;
        Some(read(name, std::fs::File::open(path).unwrap(), &chain, Units::default()).unwrap().data)
    };
    let (Some(train), Some(test)) = (load("wu_irb120/train.csv"), load("wu_irb120/test.csv")) else { return };
    let mut options = CalibrateOptions::geometry(&chain);
    options.trace = Some(TraceOptions::new(options.identify.clone()));
    let found = calibrate(&chain, &statics, train, Some(test), &options).unwrap();
    let last = serde_json::to_value(found.report.stages.last().unwrap()).unwrap();
    let (mean, max) = (&last["test"]["position_mean_m"], &last["test"]["position_max_m"]);
    println!("{}: mean {mean} m, largest {max} m", last["name"]);
    assert!(mean.as_f64().unwrap() <= 0.175e-3 && max.as_f64().unwrap() <= 0.364e-3);
}
