//! Priors that cannot be.

use super::Trial;
use serde_json::{Value, json};

/// A UR5e, a run of it and what a calibration knows of it.
fn calibrated() -> (Trial, Value) {
    let trial = Trial::new();
    trial.run("simulate arm.urdf --rows 60 -o data.csv").succeeded();
    trial.run("calibrate arm.urdf --data data.csv --effects none --json known.json").succeeded();
    let known = serde_json::from_str(&trial.text("known.json")).unwrap();
    (trial, known)
}

#[test]
fn a_prior_that_no_numbers_can_have_is_refused() {
    let (trial, known) = calibrated();
    trial.run("calibrate arm.urdf --data data.csv --effects none --prior known.json").succeeded();
    let correlations = |first: Value, second: Value| {
        let mut bad = known.clone();
        bad["posterior"]["correlations"][1] = first;
        bad["posterior"]["correlations"][2] = second;
        bad.to_string()
    };
    // The second moves with the first; the third with both, but not equally.
    let trial = trial.with("bad.json", &correlations(json!([1.0]), json!([0.99, 0.5])));
    let command = "calibrate arm.urdf --data data.csv --effects none --prior bad.json --json out.json";
    trial.refuses(command, "bad.json: posterior.correlations: these correlations are impossible");
    let mut large = known.clone();
    large["parameters"][0]["std"] = json!(1e200);
    let trial = trial.with("bad.json", &large.to_string());
    trial.refuses(command, "its change and std must be below 1e6");
}
