//! What a controller's table is to be changed by: on the nominal table's branch, within its standard deviations of the truth.

use super::diagnosis::robot;
use denavit_calibrate::IdentifyOptions;
use denavit_calibrate::report::deltas::{Nominal, of_fit};
use denavit_dh::convert::HAYATI_BELOW;
use denavit_dh::nearest::Parallels;
use denavit_dh::{NearParallel, Options, Parallelism, convert};
use denavit_export::deltas::{csv, deltas};
use denavit_identify::identify;
use denavit_identify::parameters::NoEffects;
use denavit_identify::posterior::{Earlier, Posterior};
use denavit_identify::simulate::{SimulationOptions, simulate};
use denavit_measurements::kinds::ObservationKind;

#[test]
fn a_calibrated_arm_is_given_on_the_branch_of_its_drawing() {
    let chain = robot("universal_robots/ur5e.urdf");
    let options = SimulationOptions {
        kind: ObservationKind::Pose,
        rows: 60,
        turn: 1e-3,
        shift: 5e-4,
        ..SimulationOptions::default()
    };
    let run = simulate(&chain, &options, &NoEffects);
    let fit = identify(&chain, &run.data, &IdentifyOptions::axes(&chain)).geometric;
    let nominal = Nominal { table: None, parallels: Parallels::Hayati };
    let found = of_fit(&fit, 0, &nominal).unwrap();
    let exact = Options {
        parallelism: Parallelism::Exact,
        near_parallel: NearParallel::HayatiBelow(HAYATI_BELOW),
        ..Options::default()
    };
    let drawn = convert::table(&chain, &exact).unwrap().value;
    let truth = deltas(&run.arm.chain_to(0), &drawn, denavit_dh::Convention::Distal, Parallels::Hayati).unwrap();
    assert_eq!(found.len(), truth.len());
    let number = |row: &str, number: &str| found.iter().find(|of| of.row == row && of.number == number).unwrap();
    assert!((number("shoulder_lift_joint", "a").actual + 0.425).abs() < 5e-3);
    assert!(number("shoulder_lift_joint", "theta").actual.abs() < 0.02);
    let mut seen = 0;
    for (found, truth) in found.iter().zip(&truth) {
        // The base and the tool of the calibrated arm are where its instrument and its target are.
        let inner =
            ["shoulder_lift_joint", "elbow_joint", "wrist_1_joint", "wrist_2_joint"].contains(&found.row.as_str());
        if inner && found.number != "d" || found.row == "wrist_2_joint" {
            let std = found.std.unwrap();
            assert!(std < 2e-3 && (found.actual - truth.actual).abs() <= 5.0 * std + 1e-12, "{found:?} {truth:?}");
            seen += 1;
        }
    }
    assert_eq!(seen, 3 * 4 + 2 + 1, "{found:?}");
    assert!(csv(&found).starts_with("row,number,nominal,actual,delta,std,unit\nbase,theta,0,0,0,"));
    let _ = Posterior::of(&fit).unwrap();
}

/// What the JSON of a calibration says of the axes is the calibrated chain.
#[test]
fn reported_changes_make_the_calibrated_chain() {
    let chain = robot("universal_robots/ur5e.urdf");
    let options = SimulationOptions {
        kind: ObservationKind::Pose,
        rows: 40,
        turn: 2e-3,
        shift: 1e-3,
        ..SimulationOptions::default()
    };
    let run = simulate(&chain, &options, &NoEffects);
    let fit = identify(&chain, &run.data, &IdentifyOptions::axes(&chain)).geometric;
    let parameters = fit.layout.joints.clone().map(|index| {
        let parameter = &fit.layout.parameters[index];
        let change = fit.layout.difference(&fit.arm, &fit.arm)[index];
        (parameter, change, fit.deviation(index))
    });
    let known = parameters.map(|(parameter, change, std)| denavit_identify::posterior::KnownParameter {
        parameter: parameter.name.clone(),
        change,
        std,
        unit: parameter.unit.to_owned(),
    });
    let correlations = Posterior::of(&fit).unwrap().correlations;
    let earlier = Earlier::of_siblings(&chain, known.collect(), correlations);
    let made = earlier.chain(&chain).unwrap();
    for (found, expected) in made.joints().iter().zip(fit.arm.chain().joints()) {
        let apart = (found.screw.twist() - expected.screw.twist()).norm();
        assert!(apart < 1e-13, "{}: {apart}", found.name);
    }
}
