//! Calibration: identification of a large file, the tracer's scan over all candidates, and its whole search.

use denavit_benches::{ROBOTS, report, robot_text};
use denavit_calibrate::IdentifyOptions;
use denavit_identify::effects::survey::with_run_order;
use denavit_identify::effects::{Carrier, Coupling, Driver, Effect, EffectModel, Kind, Statics, Term};
use denavit_identify::identify;
use denavit_identify::parameters::NoEffects;
use denavit_identify::simulate::{SimulationOptions, simulate};
use denavit_measurements::Covariate;
use denavit_measurements::kinds::ObservationKind;
use denavit_model::{Chain, Reading, Robot, urdf};
use denavit_trace::{TraceOptions, scan, trace};
use std::hint::black_box;

fn robot(file: &str, tip: &str) -> (Robot, Chain) {
    let robot = urdf::read(file, &robot_text(file)).expect("robots/ holds URDFs");
    let chain = robot.chain(None, Some(tip), Reading::Intended).expect("the robot has the link").value;
    (robot, chain)
}

/// 10 000 full poses of a 6R arm: both stages, to convergence.
pub fn identification() {
    let (name, file, tip) = ROBOTS[0];
    let (_, chain) = robot(file, tip);
    let options = SimulationOptions { kind: ObservationKind::Pose, rows: 10_000, ..Default::default() };
    let data = simulate(&chain, &options, &NoEffects).data;
    let options = IdentifyOptions::axes(&chain);
    report(name, "denavit, 10 000 poses identified", "calibration", 1, || {
        assert!(identify(black_box(&chain), black_box(&data), &options).geometric.converged);
    });
}

/// 400 full poses of a 7R arm with time and temperature recorded: without effects, and with a compliant joint.
pub fn tracing() {
    let (name, file, tip) = ROBOTS[1];
    let (robot, chain) = robot(file, tip);
    let statics = Statics::of(&robot, &chain);
    let rows = 400;
    let time: Vec<f64> = (0..rows).map(|row| 60.0 * row as f64).collect();
    let temperature = time.iter().map(|time| 20.0 + 9.0 * (1.0 - (-time / 7200.0).exp())).collect();
    let covariates = vec![
        Covariate { name: "time".into(), values: time },
        Covariate { name: "temperature".into(), values: temperature },
    ];
    let simulated = SimulationOptions { kind: ObservationKind::Pose, rows, covariates, ..Default::default() };
    let soft = Effect {
        term: Term {
            kind: Kind::JointCompliance,
            carrier: Carrier::Joint(1),
            driver: Driver::Torque(1),
            coupling: Coupling::Each,
        },
        coefficients: vec![2e-5],
    };
    let options = TraceOptions::new(IdentifyOptions::axes(&chain));
    for (what, effects) in [("clean", Vec::new()), ("one effect", vec![soft])] {
        let model = EffectModel::new(statics.clone(), effects);
        let data = with_run_order(simulate(&chain, &simulated, &model).data);
        let geometric = identify(&chain, &data, &options.identify).geometric;
        let candidates = trace(&statics, &data, &geometric, &options).candidates;
        let who = format!("denavit, 400 poses, {what}: scan over {candidates} candidates");
        report(name, &who, "calibration", 1, || _ = black_box(scan(&statics, &data, &geometric, &options)));
        let who = format!("denavit, 400 poses, {what}: whole search");
        report(name, &who, "calibration", 1, || _ = black_box(trace(&statics, &data, &geometric, &options)));
    }
}
