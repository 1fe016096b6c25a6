//! A target whose range depends on how it is turned to the instrument.

use crate::drawn::ur5e;
use denavit_calibrate::IdentifyOptions;
use denavit_identify::effects::candidates::candidates;
use denavit_identify::effects::survey::{Survey, with_run_order};
use denavit_identify::effects::{Carrier, Coupling, Driver, Effect, EffectModel, Kind, Statics, Term};
use denavit_identify::identify;
use denavit_identify::parameters::NoEffects;
use denavit_identify::residual_statistics::residuals;
use denavit_identify::simulate::{SimulationOptions, readings, simulate, simulate_arm};
use denavit_measurements::kinds::ObservationKind;
use denavit_trace::{Trace, TraceOptions, trace};

fn model(statics: &Statics, carrier: Carrier, coefficients: &[f64]) -> EffectModel {
    let term = Term { kind: Kind::TargetIncidence, carrier, driver: Driver::Constant, coupling: Coupling::Each };
    EffectModel::new(statics.clone(), vec![Effect { term, coefficients: coefficients.to_vec() }])
}

fn options(kind: ObservationKind, rows: usize, seed: u64) -> SimulationOptions {
    SimulationOptions { kind, rows, seed, ..Default::default() }
}

fn traced(kind: ObservationKind, carrier: Carrier, coefficients: &[f64], seed: u64) -> Trace {
    let (chain, statics) = ur5e();
    let data = simulate(&chain, &options(kind, 150, seed), &model(&statics, carrier, coefficients)).data;
    let options = TraceOptions::new(IdentifyOptions::axes(&chain));
    let geometric = identify(&chain, &data, &options.identify).geometric;
    trace(&statics, &with_run_order(data), &geometric, &options)
}

/// The range is read too far by c · u and the zero, the angles as they are.
#[test]
fn what_is_read_moves_along_the_line_of_sight_alone() {
    let (chain, statics) = ur5e();
    for kind in [ObservationKind::Position, ObservationKind::Pose] {
        // The same readings whoever simulates them.
        let given = Some(readings(&chain, 20, 3));
        let quiet =
            SimulationOptions { noise_position: 0.0, noise_orientation: 0.0, readings: given, ..options(kind, 20, 3) };
        let bare = simulate(&chain, &quiet, &NoEffects);
        let (c, zero) = ([2e-4, -1e-4, 3e-4], 5e-5);
        let mut both = model(&statics, Carrier::Sight, &c);
        both.effects.extend(model(&statics, Carrier::Range, &[zero]).effects);
        let with = simulate_arm(&bare.arm, &quiet, &both).data;
        let actual = bare.arm.chain();
        for row in 0..20 {
            let [plain, read] = [&bare.data, &with].map(|data| data.position(row, 0).unwrap());
            let sight = plain.normalize();
            let in_tip =
                (bare.arm.instruments[0].rotation * actual.fk(bare.data.reading(row)).rotation).inverse() * sight;
            let expected = c[0] * in_tip.x + c[1] * in_tip.y + c[2] * in_tip.z + zero;
            assert!((read - plain - sight * expected).norm() < 1e-12, "{kind:?} row {row}");
        }
        // With the effect in the model nothing is left; its columns are what a change of each coefficient leaves.
        let largest = |model: &EffectModel| {
            residuals(&bare.arm, model, &with).iter().map(|one| one.place.norm()).fold(0.0, f64::max)
        };
        assert!(largest(&both) < 1e-9, "{}", largest(&both));
        assert!(largest(&model(&statics, Carrier::Sight, &[0.0; 3])) > 1e-4);
    }
}

#[test]
fn an_eccentric_target_is_found_with_its_numbers() {
    for (kind, seed) in [(ObservationKind::Position, 7), (ObservationKind::Pose, 8)] {
        let truth = [1.2e-4, -0.8e-4, 1.5e-4];
        let found = traced(kind, Carrier::Sight, &truth, seed);
        let names: Vec<_> = found.findings.iter().map(|one| (one.term.kind, one.term.carrier, one.named)).collect();
        assert_eq!(names, [(Kind::TargetIncidence, Carrier::Sight, true)], "{kind:?} {:?}", found.findings);
        for (value, truth) in found.findings[0].values.iter().zip(truth) {
            let std = value.std.unwrap();
            assert!((value.value - truth).abs() < 4.0 * std && std < 6e-5, "{value:?} truth {truth}");
            assert_eq!(value.unit, "m");
        }
    }
}

#[test]
fn a_wrong_prism_constant_is_found() {
    let found = traced(ObservationKind::Position, Carrier::Range, &[4e-4], 9);
    let names: Vec<_> = found.findings.iter().map(|one| (one.term.kind, one.term.carrier)).collect();
    assert_eq!(names, [(Kind::TargetIncidence, Carrier::Range)], "{:?}", found.findings);
    let value = &found.findings[0].values[0];
    assert!((value.value - 4e-4).abs() < 4.0 * value.std.unwrap(), "{value:?}");
}

#[test]
fn it_is_no_candidate_without_a_line_of_sight() {
    let (chain, statics) = ur5e();
    let offered = |kind| {
        let data = with_run_order(simulate(&chain, &options(kind, 30, 1), &NoEffects).data);
        candidates(Kind::TargetIncidence, &Survey::of(&statics, &data, Vec::new())).len()
    };
    assert_eq!([ObservationKind::Position, ObservationKind::Pose, ObservationKind::Distance].map(offered), [2, 2, 0]);
}
