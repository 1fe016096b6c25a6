//! Poses that settle what a run left open.

#[path = "../examples/study_tell_apart.rs"]
#[allow(dead_code, clippy::pedantic, reason = "a study is a program of its own; one case of it is a test")]
mod study;

use crate::drawn::ur5e;
use denavit_calibrate::apply::plan::tell_apart::TellApart;
use denavit_calibrate::apply::plan::{PlanError, PlanOptions};
use denavit_calibrate::calibration::{CalibrateOptions, Calibration, calibrate};
use denavit_identify::effects::Statics;
use denavit_identify::effects::survey::{with_run_order, with_run_order_after};
use denavit_identify::parameters::NoEffects;
use denavit_identify::simulate::effect_specification::specified_effects;
use denavit_identify::simulate::{SimulationOptions, readings, simulate};
use denavit_measurements::Measurements;
use denavit_measurements::Scene;
use denavit_measurements::kinds::ObservationKind;
use denavit_model::Chain;
use denavit_trace::TraceOptions;

/// A run with these effects, calibrated.
fn calibrated(kind: ObservationKind, rows: usize, seed: u64, effects: &[&str]) -> (Calibration, Chain, Statics) {
    let (chain, statics) = ur5e();
    let options = SimulationOptions { kind, rows, seed, ..Default::default() };
    let wanted: Vec<_> = effects.iter().map(|word| word.parse().unwrap()).collect();
    let run = simulate(&chain, &options, &NoEffects);
    let model = specified_effects(&wanted, &statics, &run, seed).unwrap();
    let data = simulate(&chain, &options, &model).data;
    let asked = CalibrateOptions::geometry(&chain);
    let asked = CalibrateOptions { trace: Some(TraceOptions::new(asked.identify.clone())), ..asked };
    let found = calibrate(&chain, &statics, data, None, &asked).unwrap();
    (found, chain, statics)
}

fn planned(found: &Calibration, statics: &Statics, options: &PlanOptions) -> TellApart {
    found.tell_apart(statics, options).unwrap()
}

#[test]
fn poses_from_the_whole_range_name_what_a_part_of_it_cannot_distinguish() {
    let (chain, statics) = ur5e();
    let case = study::case(&chain, &statics, study::WORLDS[0], 1013).expect("two possible causes");
    assert!(!case.before.right);
    let [told_apart, _, _] = case.after;
    assert!(told_apart.right && !told_apart.wrong, "{:?}", case.after);
    assert!(told_apart.error < case.before.error);
    let prospect = &case.planned.prospect;
    assert!(prospect.open() && prospect.for_separation > 0 && prospect.poses == 20);
    let sum: f64 = prospect.possible.iter().map(|possible| possible.probability).sum();
    assert!((sum - 1.0).abs() < 1e-9, "{sum}");
    for pair in &prospect.pairs {
        assert!(pair.expected_if_first >= pair.log_odds && pair.expected_if_second <= pair.log_odds, "{pair:?}");
    }
}

#[test]
fn where_nothing_is_open_poses_are_for_the_prediction() {
    for kind in [ObservationKind::Position, ObservationKind::Pose] {
        let (found, chain, statics) = calibrated(kind, 40, 3, &[]);
        assert!(found.report.prospect.is_none());
        let options = PlanOptions { spread: 200, ..PlanOptions::new(&chain, 8, kind) };
        let best = planned(&found, &statics, &options);
        assert!(!best.prospect.open() && best.prospect.pairs.is_empty() && best.prospect.for_separation == 0);
        let more = planned(&found, &statics, &PlanOptions { count: 16, ..options.clone() }).prospect.unsure;
        let best = best.prospect.unsure;
        assert_eq!(best.now, more.now);
        assert!(more.expected < best.expected && best.expected < 0.99 * best.now, "{best:?} {more:?}");
        // Poses that were given are chosen from, and judged at.
        let given = readings(&chain, 30, 11);
        let chosen = planned(&found, &statics, &PlanOptions { candidates: Some(given.clone()), ..options });
        assert!(chosen.at_given && chosen.poses.iter().zip(&chosen.candidates).all(|(pose, at)| *pose == given[*at]));
        assert!(chosen.prospect.unsure.expected < chosen.prospect.unsure.now);
    }
}

#[test]
fn the_report_speaks_of_it_where_something_is_open() {
    let (found, _, _) = calibrated(ObservationKind::Position, 60, 6, &["joint_compliance@elbow_joint=0.05mm"]);
    let text = denavit_calibrate::report::text::report(&found);
    assert_eq!(found.report.one_of.is_empty(), found.report.prospect.is_none(), "{text}");
    assert_eq!(text.contains("The uncertainty of the prediction is"), found.report.prospect.is_some(), "{text}");
    assert!(found.report.prospect.is_some(), "the run is to leave something open:\n{text}");
    let page = denavit_calibrate::report::html::page(&found).unwrap();
    assert!(page.contains("The uncertainty of the prediction is"));
}

#[test]
fn the_order_of_the_poses_makes_the_sides_that_were_chosen() {
    let (found, chain, statics) = calibrated(ObservationKind::Position, 60, 3, &["backlash@elbow_joint=0.035mm"]);
    let planned = planned(
        &found,
        &statics,
        &PlanOptions { spread: 300, ..PlanOptions::new(&chain, 12, ObservationKind::Position) },
    );
    let [approach] = &planned.approach[..] else { panic!("{:?}", planned.prospect.possible) };
    assert!(approach.by_order && approach.joint == "elbow_joint");
    let mut next = Measurements::empty("next", found.train.joints.clone(), Scene::of(ObservationKind::Position, 1));
    for (line, pose) in planned.poses.iter().enumerate() {
        next.observed.push(0, &[0.0; 3]);
        next.end_row(pose, line + 1, false);
    }
    let ordered = with_run_order_after(next, &with_run_order((*found.train).clone()));
    let sides = &ordered.covariate("elbow_joint.approach from run order").unwrap().values;
    // The first comes from where the run ended.
    assert_eq!(sides[1..], approach.sides[1..]);
    assert!(approach.sides.contains(&1.0) && approach.sides.contains(&-1.0), "{:?}", approach.sides);
}

#[test]
fn what_cannot_be_chosen_is_refused() {
    let (found, chain, statics) = calibrated(ObservationKind::Position, 40, 3, &[]);
    let few = PlanOptions {
        candidates: Some(readings(&chain, 3, 1)),
        ..PlanOptions::new(&chain, 5, ObservationKind::Position)
    };
    let error = found.tell_apart(&statics, &few).unwrap_err();
    assert!(matches!(error, PlanError::TooFewCandidates { wanted: 5, left: 3, .. }), "{error}");
    let short =
        PlanOptions { candidates: Some(vec![vec![0.0]]), ..PlanOptions::new(&chain, 1, ObservationKind::Position) };
    assert!(matches!(found.tell_apart(&statics, &short), Err(PlanError::Length { .. })));
    let puma = denavit_model::examples::puma_like();
    let options =
        SimulationOptions { kind: ObservationKind::Plane, rows: 300, noise_position: 1e-5, ..Default::default() };
    let data = simulate(&puma, &options, &NoEffects).data;
    let (statics, asked) = (Statics::of_chain(&puma), CalibrateOptions::geometry(&puma));
    let found = calibrate(&puma, &statics, data, None, &asked).unwrap();
    let error = found.tell_apart(&statics, &PlanOptions::new(&puma, 5, ObservationKind::Position)).unwrap_err();
    assert!(matches!(error, PlanError::InContact(_)), "{error}");
}
