//! Smooth errors of two joints: corrected for where they pay on rows that were not fitted, named nowhere.

#[path = "../examples/study_fields.rs"]
#[allow(dead_code, reason = "the study has a main of its own")]
mod study;

use denavit_calibrate::IdentifyOptions;
use denavit_calibrate::apply::compensate::{Wanted, compensate};
use denavit_calibrate::calibration::{CalibrateOptions, calibrate};
use denavit_calibrate::effects::{Conditions, Kind, SavedEffects};
use denavit_calibrate::identify::carried::PartState;
use denavit_calibrate::identify::posterior::Earlier;
use denavit_calibrate::report::html::page;
use denavit_calibrate::report::text;
use denavit_calibrate::trace::TraceOptions;
use denavit_ik::Solver;
use study::study_coverage::ur5e;
use study::{World, calibrated, judged, run};

/// Noise of each component, m, times the root of three.
const NOISE: f64 = 0.0866e-3;

#[test]
fn an_error_of_two_joints_is_corrected_for_and_no_cause_is_named() {
    let result = calibrated(World::Field(1000), 300, 300);
    let (fields, with, without, named) = judged(&result);
    println!("held out {:.4} mm, without the field {:.4} mm", with * 1e3, without * 1e3);
    assert!(fields > 0 && named == 0 && with < 1.15 * NOISE && with < 0.9 * without, "{fields} {with} {without}");
    let field = result.report.fields.iter().find(|field| field.kind == "two_joints").unwrap();
    assert_eq!(field.of, ["shoulder_lift_joint", "elbow_joint"]);
    assert!(field.rms > 1e-4 && field.rms < 1e-3 && field.log_evidence > 9.0, "{field:?}");
    let said = text::calibration(&result);
    let line =
        format!("joint {} errs by a smooth function of shoulder_lift_joint and elbow_joint, rms 0.", field.joint);
    assert!(said.contains(&line) && said.contains(" + fields"), "{said}");
    assert!(page(&result).unwrap().contains("error as a smooth function of two joints"));
    let json: serde_json::Value = serde_json::from_str(&result.report.to_json()).unwrap();
    let of = |entry: &serde_json::Value| entry["kind"] == "two_joints" && entry["of"][1] == "elbow_joint";
    assert!(json["fields"].as_array().unwrap().iter().any(of), "{}", json["fields"]);
}

#[test]
fn a_field_is_saved_read_compensated_and_goes_on() {
    let (chain, statics) = ur5e();
    let (train, later) = run(World::Field(1000), 300, 300);
    let traced = |data, earlier: Option<Earlier>| {
        let identify = IdentifyOptions { earlier, ..IdentifyOptions::axes(&chain) };
        let trace = Some(TraceOptions::new(identify.clone()));
        let options = CalibrateOptions { identify, trace, ..CalibrateOptions::geometry(&chain) };
        calibrate(&chain, &statics, data, None, &options).unwrap()
    };
    let before = traced(train, None);
    let model = before.effects(&statics);
    assert!(model.effects.iter().any(|effect| effect.term.kind == Kind::JointField));
    let again = SavedEffects::from_json("effects.json", &model.to_json(), &statics).unwrap();
    let again = again.bound(&|name| before.train.column(name)).unwrap();
    assert_eq!(again, model);
    let at =
        Conditions { reading: &[0.3, -1.1, 0.9, 0.2, 1.3, -0.4], recorded: before.train.covariates.row(0), tip: 0 };
    let moved = (again.fk(&chain, &at).translation.vector - chain.fk(at.reading).translation.vector).norm();
    assert!(moved > 1e-5, "{moved}");
    let acting = |q: &[f64]| again.fk(&chain, &Conditions { reading: q, ..at });
    let wanted = Wanted::Joints(at.reading.to_vec());
    let command = compensate(&Solver::new(&chain), &chain, &acting, &wanted, at.reading);
    assert!(command.uncompensated.0 > 1e-5 && command.position_error < 1e-10, "{command:?}");
    let mut beyond: serde_json::Value = serde_json::from_str(&model.to_json()).unwrap();
    let last = model.effects.len() - 1;
    beyond["effects"][last]["driver"]["products"]["of"][1]["joint"] = 9.into();
    let refused = SavedEffects::from_json("e.json", &beyond.to_string(), &statics).unwrap_err().to_string();
    assert!(refused.contains("(joint_field): it names joint 9; joints are 0 to 5"), "{refused}");
    let earlier = Earlier::read("earlier.json", &before.report.to_json(), &chain).unwrap();
    let after = traced(later, Some(earlier));
    let parts = &after.report.earlier.as_ref().unwrap().effects;
    let field = parts.iter().find(|part| part.kind == "joint_field").unwrap();
    assert_eq!(field.state, PartState::Kept);
}

#[test]
fn where_nothing_of_two_joints_acts_there_is_no_field() {
    for world in [World::Clean, World::Gears, World::Gravity] {
        for seed in 0..2 {
            let (fields, ..) = judged(&calibrated(world, 300, 900 + seed));
            assert_eq!(fields, 0, "{world:?}, seed {seed}");
        }
    }
}
