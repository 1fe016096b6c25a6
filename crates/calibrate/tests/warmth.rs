//! Joints that warm with their own work, where no thermometer is.

use crate::drawn::ur5e;
use denavit_calibrate::Measurements;
use denavit_calibrate::apply::compensate::{Allowed, in_order};
use denavit_calibrate::apply::plan::PlanOptions;
use denavit_calibrate::calibration::{CalibrateOptions, calibrate};
use denavit_identify::effects::survey::{Survey, with_run_order, with_run_order_after};
use denavit_identify::effects::{Carrier, Conditions, Driver, Effect, EffectModel, Kind, SavedEffects, Statics};
use denavit_identify::parameters::NoEffects;
use denavit_identify::simulate::effect_specification::specified_effects;
use denavit_identify::simulate::{SimulationOptions, readings, simulate};
use denavit_measurements::kinds::ObservationKind;
use denavit_measurements::poses::Poses;
use denavit_measurements::{Covariate, Covariates};
use denavit_model::Chain;
use denavit_trace::TraceOptions;

const ROWS: usize = 200;

/// A run in which each joint works hard for a while and little after that, one after the other.
fn by_turns(chain: &Chain, rows: usize, seed: u64) -> SimulationOptions {
    let mut all = readings(chain, rows, seed);
    for (row, reading) in all.iter_mut().enumerate() {
        for (joint, value) in reading.iter_mut().enumerate() {
            let works = (row * 3 / 50 + joint) % 3 == 0;
            *value *= if works { 0.45 } else { 0.12 };
        }
    }
    SimulationOptions { kind: ObservationKind::Position, rows, seed, readings: Some(all), ..Default::default() }
}

fn with_effect(text: &str, options: &SimulationOptions) -> (Measurements, EffectModel, Chain, Statics) {
    let (chain, statics) = ur5e();
    let bare = simulate(&chain, options, &NoEffects);
    let model = specified_effects(&[text.parse().unwrap()], &statics, &bare, options.seed).unwrap();
    (simulate(&chain, options, &model).data, model, chain, statics)
}

fn asked(chain: &Chain) -> CalibrateOptions {
    let asked = CalibrateOptions::geometry(chain);
    CalibrateOptions { trace: Some(TraceOptions::new(asked.identify.clone())), ..asked }
}

#[test]
fn a_joint_that_warms_with_its_work_is_no_drift() {
    let (chain, _) = ur5e();
    let (data, truth, chain, statics) = with_effect("thermal@elbow_joint:over=40=0.4mm", &by_turns(&chain, ROWS, 5));
    let found = calibrate(&chain, &statics, data, None, &asked(&chain)).unwrap();
    let trace = found.trace.as_ref().unwrap();
    let names: Vec<_> = trace.findings.iter().map(|one| (one.term.kind, one.term.carrier, one.named)).collect();
    assert_eq!(names, [(Kind::Thermal, Carrier::Joint(2), true)]);
    let (finding, acts) = (&trace.findings[0], &truth.effects[0]);
    assert_eq!(finding.term.driver.covariate(), Some("elbow_joint.warmth over 40 rows"));
    let value = &finding.values[0];
    assert!((value.value - acts.coefficients[0]).abs() < 4.0 * value.std.unwrap(), "{value:?} {acts:?}");
    assert_eq!(value.unit, "rad/(rad/row)");
    // What it leaves to be told apart, plans can deal with.
    let plan = PlanOptions { spread: 200, ..PlanOptions::new(&chain, 6, ObservationKind::Position) };
    assert_eq!(found.tell_apart(&statics, &plan).unwrap().poses.len(), 6);
}

#[test]
fn plain_drift_is_no_warmth() {
    let (chain, _) = ur5e();
    for text in ["drift@elbow_joint=0.3mm", "drift@elbow_joint:step=90=0.2mm"] {
        let (data, _, chain, statics) = with_effect(text, &by_turns(&chain, ROWS, 6));
        let found = calibrate(&chain, &statics, data, None, &asked(&chain)).unwrap();
        let trace = found.trace.as_ref().unwrap();
        let names: Vec<_> = trace.findings.iter().map(|one| (one.term.kind, one.term.carrier)).collect();
        assert_eq!(names, [(Kind::Drift, Carrier::Joint(2))], "{text}");
    }
}

#[test]
fn held_out_rows_continue_the_run() {
    let (chain, _) = ur5e();
    let time = |rows: std::ops::Range<usize>| Covariate {
        name: "time".into(),
        values: rows.map(|row| (15 * row + 7 * (row % 3)) as f64).collect(),
    };
    let whole = SimulationOptions { covariates: vec![time(0..60)], ..by_turns(&chain, 60, 3) };
    let whole = simulate(&chain, &whole, &NoEffects).data;
    let (first, second): (Vec<usize>, Vec<usize>) = (0..60).partition(|row| *row < 35);
    let together = with_run_order(whole.clone());
    let first = with_run_order(whole.subset(&first));
    let second = with_run_order_after(whole.subset(&second), &first);
    let mut compared = 0;
    for column in together.covariates.iter().filter(|column| column.name.contains(".warmth over ")) {
        let parts = [&first, &second].map(|part| part.covariate(&column.name).unwrap().values.clone());
        for (whole, part) in column.values.iter().zip(parts.iter().flatten()) {
            assert!((whole - part).abs() < 1e-15, "{}: {whole} {part}", column.name);
        }
        assert!(column.values[0] == 0.0 && column.values[40] > 0.0);
        compared += 1;
    }
    // Five lags in rows and five in seconds for each joint; without a clock those in rows alone.
    assert_eq!(compared, 60);
    let bare = with_run_order(simulate(&chain, &by_turns(&chain, 60, 3), &NoEffects).data);
    assert!(bare.column("elbow_joint.warmth over 40 rows").is_ok());
    let missing = bare.column("elbow_joint.warmth over 240 s").unwrap_err().to_string();
    assert!(missing.contains("there is no column \"elbow_joint.warmth over 240 s\""), "{missing}");
}

#[test]
fn lags_follow_the_run_and_its_clock() {
    let (chain, statics) = ur5e();
    let lags = |data: Measurements| -> Vec<String> {
        let survey = Survey::of(&statics, &with_run_order(data), Vec::new());
        survey.warmth(0).map(|column| column.name().replace("shoulder_pan_joint.warmth over ", "")).collect()
    };
    let data = |rows: usize| simulate(&chain, &by_turns(&chain, rows, 3), &NoEffects).data;
    assert_eq!(lags(data(60)), ["10 rows", "40 rows"]);
    assert_eq!(lags(data(200)), ["10 rows", "40 rows", "160 rows"]);
    let mut clocked = data(200);
    clocked
        .covariates
        .push(Covariate { name: "time".into(), values: (0..200).map(|row| 15.0 * f64::from(row)).collect() });
    assert_eq!(lags(clocked), ["240 s", "960 s", "3840 s"]);
}

#[test]
fn commands_in_order_keep_the_warmth_of_those_before() {
    let (chain, _) = ur5e();
    let (data, model, chain, statics) = with_effect("thermal@elbow_joint:over=10=0.3mm", &by_turns(&chain, 40, 4));
    let saved = SavedEffects::from_json("effects.json", &model.to_json(), &statics).unwrap();
    assert_eq!(saved, model.saved());
    assert_eq!(saved.needed(), ["elbow_joint.warmth over 10 rows"]);
    let joints: Vec<Vec<f64>> = (0..12).map(|row| data.reading(row).to_vec()).collect();
    let lines = (1..=joints.len()).collect();
    let poses = Poses { joints, poses: Vec::new(), covariates: Vec::new(), lines };
    let allowed = Allowed { position: 1e-6, orientation: 1e-6 };
    let commands = in_order(&chain, &chain, &saved, &poses, &[], allowed).unwrap();
    let mut warmth = 0.0;
    for (row, command) in commands.iter().enumerate() {
        if row > 0 {
            let travel: f64 = (command.nominal[2] - commands[row - 1].nominal[2]).abs();
            // The command itself differs from the nominal one by less than a milliradian.
            warmth += (travel - warmth) * -(-0.1_f64).exp_m1();
        }
        let off = model.effects[0].coefficients[0] * warmth;
        let mut actual = command.joints.clone();
        actual[2] += off;
        let missed = (chain.fk(&actual).translation.vector - chain.fk(&poses.joints[row]).translation.vector).norm();
        assert!(missed < 2e-7, "row {row}: {missed:e}, off by {off:e}");
    }
    assert!(warmth > 0.05);
    // By the clock only with a clock.
    let mut by_clock = saved;
    by_clock.effects = by_clock
        .effects
        .into_iter()
        .map(|effect| {
            let driver = Driver::Covariate("elbow_joint.warmth over 240 s".to_owned());
            Effect { term: denavit_identify::effects::Term { driver, ..effect.term }, ..effect }
        })
        .collect();
    let missing = in_order(&chain, &chain, &by_clock, &poses, &[], allowed).unwrap_err();
    assert_eq!(missing.column(), "elbow_joint.warmth over 240 s");
    let time = Covariate { name: "time".into(), values: (0..12).map(|row| 20.0 * f64::from(row)).collect() };
    let clocked = Poses { covariates: vec![time], ..poses };
    assert_eq!(in_order(&chain, &chain, &by_clock, &clocked, &[], allowed).unwrap().len(), 12);
    // Forward kinematics of one row asks for it by its name.
    let recorded: Covariates =
        vec![Covariate { name: "elbow_joint.warmth over 10 rows".into(), values: vec![0.2] }].into();
    let bound = model.saved().bound(&|name| recorded.column("one row", 1, name)).unwrap();
    let conditions = Conditions { reading: data.reading(0), recorded: recorded.row(0), tip: 0 };
    assert_ne!(bound.fk(&chain, &conditions), chain.fk(data.reading(0)));
}
