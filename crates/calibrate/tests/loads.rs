//! Loads that no column tells, by which the runs of one arm differ.

use crate::drawn::drawn;
use crate::measured::measured;
use denavit_calibrate::calibration::{CalibrateOptions, calibrate};
use denavit_calibrate::report::text;
use denavit_calibrate::{IdentifyOptions, Measurements};
use denavit_identify::effects::{Carrier, Coupling, Driver, Effect, EffectModel, Kind, Statics, Term};
use denavit_identify::identify;
use denavit_identify::parameters::NoEffects;
use denavit_identify::simulate::{SimulationOptions, simulate, simulate_arm};
use denavit_measurements::kinds::ObservationKind;
use denavit_measurements::{Covariate, Units, read};
use denavit_model::{Chain, Reading};
use denavit_trace::TraceOptions;
use denavit_trace::loads::{UndeclaredLoads, undeclared_loads};

/// Rows of a run.
const ROWS: usize = 60;

fn at_joint(kind: Kind, joint: usize, driver: Driver, coefficients: &[f64]) -> Effect {
    let term = Term { kind, carrier: Carrier::Joint(joint), driver, coupling: Coupling::Each };
    Effect { term, coefficients: coefficients.to_vec() }
}

/// A UR5e whose second and third joint give as those of its size do, rad per N·m.
fn soft(statics: &Statics) -> EffectModel {
    let of = |joint: usize, c: f64| at_joint(Kind::JointCompliance, joint, Driver::Torque(joint), &[c]);
    EffectModel::new(statics.clone(), vec![of(1, 2e-5), of(2, 4e-5)])
}

/// One run for each load, in a setup of its own, without the column that tells it.
fn runs(chain: &Chain, effects: &EffectModel, kind: ObservationKind, loads: &[f64], seed: u64) -> Measurements {
    let options = SimulationOptions { kind, rows: ROWS, seed, ..SimulationOptions::default() };
    let arm = simulate(chain, &SimulationOptions { rows: 1, ..options.clone() }, &NoEffects).arm;
    let run = |(number, load): (usize, &f64)| {
        let payload = Covariate { name: "payload".into(), values: vec![*load; ROWS] };
        let options =
            SimulationOptions { covariates: vec![payload], seed: 100 * seed + number as u64, ..options.clone() };
        let mut data = simulate_arm(&arm, &options, effects).data;
        data.covariates = Vec::new().into();
        data.of_setup(["A", "B", "C"][number])
    };
    Measurements::joined(loads.iter().enumerate().map(run).collect()).unwrap()
}

fn found(chain: &Chain, statics: &Statics, data: &Measurements) -> Option<UndeclaredLoads> {
    let geometric = identify(chain, data, &IdentifyOptions::axes(chain)).geometric;
    undeclared_loads(statics, data, &geometric)
}

#[test]
fn loads_by_which_runs_differ_are_found() {
    let (chain, statics) = drawn("universal_robots/ur5e.urdf");
    let (mut squares, mut count) = (0.0, 0.0);
    for seed in 0..8 {
        for (kind, loads) in [(ObservationKind::Position, [0.0, 2.0, 5.0]), (ObservationKind::Pose, [3.0, 0.0, 1.0])] {
            let data = runs(&chain, &soft(&statics), kind, &loads, seed);
            let found = found(&chain, &statics, &data).unwrap_or_else(|| panic!("{kind:?} {seed}: none"));
            for (run, load) in found.runs.iter().zip(loads) {
                println!("{kind:?} {seed} {}: {:.3} ± {:.3} kg, truth {load}", run.setup, run.kg, run.std);
                if run.std > 0.0 {
                    squares += ((run.kg - load) / run.std).powi(2);
                    count += 1.0;
                } else {
                    assert_eq!((run.kg, load), (0.0, 0.0));
                }
            }
        }
    }
    let scatter = f64::sqrt(squares / count);
    assert!((0.6..1.5).contains(&scatter), "errors over their deviations {scatter}");
}

#[test]
fn runs_with_equal_loads_are_not_reported_as_different() {
    let (chain, statics) = drawn("universal_robots/ur5e.urdf");
    let wave = at_joint(Kind::TransmissionError, 1, Driver::Harmonic { joint: 1, order: 3.0 }, &[2e-4, 1e-4]);
    let mut wavy = soft(&statics);
    wavy.effects.push(wave);
    let rigid = EffectModel::new(statics.clone(), Vec::new());
    for seed in 0..8 {
        for effects in [&soft(&statics), &wavy, &rigid] {
            assert_eq!(
                found(&chain, &statics, &runs(&chain, effects, ObservationKind::Position, &[2.0, 2.0, 2.0], seed)),
                None
            );
        }
        // A rigid arm does not show what it carries.
        assert_eq!(found(&chain, &statics, &runs(&chain, &rigid, ObservationKind::Position, &[0.0, 3.0], seed)), None);
    }
}

/// Three runs of one robot that carried the same, with play of a column that no entry of the catalogue has.
#[test]
fn structure_of_a_real_robot_is_no_load() {
    let Some(folder) = measured("hilti_jaibot") else { return };
    let text = std::fs::read_to_string(folder.join("trailblazer.urdf")).unwrap();
    let robot = denavit_model::urdf::read("trailblazer.urdf", &text).unwrap();
    let chain = robot.chain(None, None, Reading::Intended).unwrap().value;
    let statics = Statics::of(&robot, &chain);
    let run = |name: &str| {
        let file = std::fs::File::open(folder.join(name).with_extension("csv")).unwrap();
        read(name, file, &chain, Units::default()).unwrap().data.of_setup(name)
    };
    let data = Measurements::joined(["flat", "pallet", "outdoor"].map(run).into()).unwrap();
    assert_eq!(found(&chain, &statics, &data), None);
}

#[test]
fn a_calibration_uses_the_loads_and_says_so_first() {
    let (chain, statics) = drawn("universal_robots/ur5e.urdf");
    let data = runs(&chain, &soft(&statics), ObservationKind::Position, &[0.0, 2.0, 5.0], 3);
    let geometry = CalibrateOptions::geometry(&chain);
    let options = CalibrateOptions {
        trace: Some(TraceOptions::new(geometry.identify.clone())),
        hold_out: Some(denavit_calibrate::calibration::HoldOut { share: 0.3, seed: 1 }),
        ..geometry
    };
    let result = calibrate(&chain, &statics, data.clone(), None, &options).unwrap();
    let said = text::report(&result);
    assert!(said.starts_with("ATTENTION: the setups carry different loads"), "{said}");
    let named: Vec<_> =
        result.report.effects.iter().map(|effect| (effect.kind.as_str(), effect.joint.as_deref())).collect();
    assert!(named.contains(&("joint_compliance", Some("elbow_joint"))), "{said}");
    let errors: Vec<f64> =
        result.report.stages.iter().map(|stage| stage.test.as_ref().unwrap().of("position").unwrap().rms).collect();
    println!("{errors:?}\n{said}");
    // Noise of 0.05 mm in each component.
    assert!(errors[errors.len() - 1] < 1.2e-4, "{errors:?}");
    let without = CalibrateOptions { trace: None, ..options };
    assert_eq!(calibrate(&chain, &statics, data, None, &without).unwrap().report.undeclared_loads, None);
}
