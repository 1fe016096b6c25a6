//! A calibration that goes on from an earlier one.

#![allow(clippy::unwrap_used, clippy::print_stdout)] // Tests: a panic is a failure, what is printed is read.

use denavit_calibrate::calibration::adoption::Adopted;
use denavit_calibrate::calibration::{CalibrateOptions, Calibration, calibrate};
use denavit_calibrate::{Arm, IdentifyOptions, Measurements};
use denavit_identify::effects::driver::Statics;
use denavit_identify::parameters::NoEffects;
use denavit_identify::posterior::{Earlier, EarlierError};
use denavit_identify::simulate::{SimulationOptions, simulate, simulate_arm};
use denavit_model::{Chain, examples};

/// Positions of one robot measured on two days, 40 and then `later` of them, and 40 to judge by.
fn two_days(chain: &Chain, later: usize, seed: u64) -> [Measurements; 3] {
    let run = simulate(chain, &SimulationOptions { rows: 40, seed, ..SimulationOptions::default() }, &NoEffects);
    let again = |rows, seed| {
        simulate_arm(&run.arm, &SimulationOptions { rows, seed, ..SimulationOptions::default() }, &NoEffects).data
    };
    [run.data.clone(), again(later, seed + 1000), again(40, seed + 2000)]
}

fn options(chain: &Chain, earlier: Option<Earlier>) -> CalibrateOptions {
    let identify = IdentifyOptions { earlier, ..IdentifyOptions::axes(chain) };
    CalibrateOptions { identify, ..CalibrateOptions::geometry(chain) }
}

fn calibrated(
    chain: &Chain,
    data: &Measurements,
    test: Option<&Measurements>,
    earlier: Option<Earlier>,
) -> Calibration {
    let statics = Statics::of_chain(chain);
    calibrate(chain, &statics, data.clone(), test.cloned(), &options(chain, earlier)).unwrap()
}

/// What the JSON of a calibration knows.
fn known(result: &Calibration, chain: &Chain) -> Earlier {
    Earlier::read("earlier.json", &result.report.to_json(), chain).unwrap()
}

fn rms(result: &Calibration, stage: &str) -> f64 {
    let stage = result.report.stages.iter().find(|found| found.name == stage).unwrap();
    stage.test.as_ref().unwrap().of("position").unwrap().rms
}

#[test]
fn two_days_one_after_the_other_are_as_good_as_both_at_once() {
    for chain in [examples::puma_like(), examples::scara_helical()] {
        let [first, second, _] = two_days(&chain, 30, 5);
        let both = Measurements::joined(vec![first.clone().of_setup("a"), second.clone().of_setup("b")]).unwrap();
        let both = calibrated(&chain, &both, None, None);
        let before = calibrated(&chain, &first, None, None);
        let after = calibrated(&chain, &second, None, Some(known(&before, &chain)));
        assert_eq!(after.report.earlier.as_ref().unwrap().weight, 1.0);
        let [before, after, both] = [&before, &after, &both].map(|result| &result.report.parameters);
        assert!(!both.is_empty());
        for ((before, after), both) in before.iter().zip(after).zip(both) {
            assert_eq!((&before.parameter, &after.parameter), (&both.parameter, &both.parameter));
            let apart = (after.change - both.change).abs() / both.std;
            let ratio = after.std / both.std;
            // The noise is estimated from 30 rows beside 70; the rest is the same sum of squares.
            assert!(apart < 0.5 && (0.75..1.3).contains(&ratio), "{}: {apart:.3} {ratio:.3}", both.parameter);
            assert!(after.std < before.std * 1.01, "{}: {} {}", both.parameter, after.std, before.std);
        }
    }
}

#[test]
fn eight_new_poses_bring_a_robot_up_to_date() {
    let chain = examples::puma_like();
    let (mut alone, mut continued, mut earlier) = (0.0, 0.0, 0.0);
    for seed in 0..6 {
        let [first, second, test] = two_days(&chain, 8, seed);
        let before = calibrated(&chain, &first, None, None);
        let anew = calibrated(&chain, &second, Some(&test), None);
        let after = calibrated(&chain, &second, Some(&test), Some(known(&before, &chain)));
        alone += rms(&anew, "geometric").powi(2);
        continued += rms(&after, "geometric").powi(2);
        earlier += rms(&after, "earlier").powi(2);
        let names: Vec<&str> = after.report.stages.iter().map(|stage| &stage.name[..]).collect();
        assert_eq!(names, ["nominal", "earlier", "geometric"]);
    }
    println!(
        "eight poses alone {alone:.3e}, continued {continued:.3e}, earlier robot {earlier:.3e}, sums of squares, m²"
    );
    assert!(continued < 0.5 * alone && continued < 1.05 * earlier, "{continued} {alone} {earlier}");
}

#[test]
fn a_joint_that_rests_now_keeps_what_was_known_of_it() {
    let chain = examples::puma_like();
    let [first, _, _] = two_days(&chain, 8, 3);
    let before = calibrated(&chain, &first, None, None);
    let arm = &before.identification.geometric.arm;
    let readings: Vec<Vec<f64>> = (0..20)
        .map(|row| (0..6).map(|k| if k == 5 { 0.3 } else { f64::from(row * (k + 3)).sin() * 1.2 }).collect())
        .collect();
    let options = SimulationOptions { rows: 20, readings: Some(readings), ..SimulationOptions::default() };
    let later = simulate_arm(arm, &options, &NoEffects).data;
    let alone = calibrated(&chain, &later, None, None);
    let after = calibrated(&chain, &later, None, Some(known(&before, &chain)));
    let turned = |arm: &Arm| arm.change(5).turned;
    assert!(turned(alone.arm()).iter().all(|turned| turned.abs() < 1e-7), "{:?}", turned(alone.arm()));
    for (now, then) in turned(after.arm()).iter().zip(turned(arm)) {
        assert!((now - then).abs() < 3e-4 && then.abs() > 1e-5, "{now} {then}");
    }
    assert!(after.report.parameters.iter().any(|parameter| parameter.joint == "joint_6"));
}

#[test]
fn rows_of_another_robot_do_not_spoil_what_was_known() {
    // Twelve rows of the arm next to it; the held-out rows are of the right one.
    let chain = examples::puma_like();
    let [first, _, test] = two_days(&chain, 8, 9);
    let before = calibrated(&chain, &first, None, None);
    let arm = before.arm();
    let drawn = SimulationOptions { rows: 30, seed: 77, ..SimulationOptions::default() };
    let other = Arm { joints: simulate(&chain, &drawn, &NoEffects).arm.joints, ..arm.clone() };
    let rows = simulate_arm(&other, &drawn, &NoEffects).data;
    let after = calibrated(&chain, &rows, Some(&test), Some(known(&before, &chain)));
    assert!(after.report.earlier.as_ref().unwrap().weight < 0.1, "{:?}", after.report.earlier);
    assert_eq!(after.report.adopted, Adopted::Geometric, "{:?}", after.report.stages);
    assert!(after.report.stages.last().unwrap().worse_on_held_out);
    // The instrument was placed by the wrong rows, so that neither is good.
    assert!(rms(&after, "earlier") < rms(&after, "geometric"));
}

#[test]
fn what_nothing_can_be_continued_from_is_said() {
    let chain = examples::puma_like();
    let [first, ..] = two_days(&chain, 8, 1);
    let before = calibrated(&chain, &first, None, None);
    let json = before.report.to_json();
    let refused = |text: &str, chain: &Chain| Earlier::read("e.json", text, chain).unwrap_err();
    let calibrated_chain = before.arm().chain();
    assert!(matches!(refused(&json, &calibrated_chain), EarlierError::OtherDrawing { .. }));
    assert!(matches!(refused(&json, &examples::scara_helical()), EarlierError::OtherChain { .. }));
    assert!(matches!(refused("joint,x\n", &chain), EarlierError::Form { .. }));
    let said = refused(&json.replace("denavit.calibration/2", "denavit.calibration/1"), &chain).to_string();
    assert!(said.starts_with("e.json: schema is \"denavit.calibration/1\", which holds no prior"), "{said}");
    let mut value: serde_json::Value = serde_json::from_str(&json).unwrap();
    value["posterior"]["correlations"][3][0] = 1.5.into();
    let said = refused(&value.to_string(), &chain).to_string();
    assert!(said.contains("it needs 3 correlations between -1 and 1"), "{said}");
    value.as_object_mut().unwrap().remove("posterior");
    let said = refused(&value.to_string(), &chain).to_string();
    assert!(
        said.contains("it holds no correlations of the parameters, so no calibration can continue from it"),
        "{said}"
    );
}
