//! Candidate terms of every kind, and what the order of a run shows.

use denavit_identify::effects::candidates::candidates;
use denavit_identify::effects::catalogue::{KINDS, Kind};
use denavit_identify::effects::driver::{Conditions, Statics, VELOCITY};
use denavit_identify::effects::survey::{Survey, with_run_order};
use denavit_identify::parameters::NoEffects;
use denavit_identify::simulate::{SimulationOptions, simulate};
use denavit_measurements::kinds::ObservationKind;
use denavit_measurements::{Covariate, Measurements, Scene};
use denavit_model::examples;

fn rich(chain: &denavit_model::Chain) -> Measurements {
    let rows = 60;
    let joints: Vec<String> = chain.coordinates().iter().map(|c| c.name.clone()).collect();
    let value = |row: usize, k: usize| (row as f64 * (0.7 + 0.31 * k as f64)).sin();
    let column =
        |name: String, slope: f64| Covariate { name, values: (0..rows).map(|row| slope * row as f64).collect() };
    let velocities = joints.iter().map(|joint| column(format!("{joint}{VELOCITY}"), 0.01));
    let rooms = [("time", 30.0), ("temperature", 0.1), ("tilt_x", 1e-3)];
    let covariates = rooms.map(|(name, slope)| column(name.into(), slope)).into_iter().chain(velocities);
    let covariates: Vec<Covariate> = covariates.collect();
    let mut data = Measurements::empty("rich.csv", joints, Scene::of(ObservationKind::Position, 1));
    let width = data.joints.len();
    for row in 0..rows {
        let reading: Vec<f64> = (0..width).map(|k| value(row, k)).collect();
        data.end_row(&reading, row + 2, false);
    }
    data.covariates = covariates.into();
    with_run_order(data)
}

#[test]
fn every_kind_offers_terms_that_a_fit_can_use() {
    for chain in examples::all() {
        let statics = Statics::of_chain(&chain);
        let data = rich(&chain);
        let survey = Survey::of(&statics, &data, Vec::new());
        for entry in KINDS {
            let terms = candidates(entry.kind, &survey);
            let none = match entry.kind {
                Kind::JointCompliance => !survey.moving().any(|joint| statics.feels_gravity(joint)),
                _ => survey.turning().next().is_none(),
            };
            assert!(!terms.is_empty() || none, "{} on {}", entry.name, chain.name());
            for candidate in terms {
                assert_eq!(candidate.term.kind, entry.kind);
                let q = vec![0.2; chain.coordinates().len()];
                let conditions = Conditions { reading: &q, recorded: data.covariates.row(7), tip: 0 };
                let posture = statics.posture(chain.joints(), &conditions, None);
                let mut values = Vec::new();
                candidate.term.driver.values_into(&statics, &conditions, &posture, &mut values);
                assert!(candidate.term.coefficients(&statics) > 0 && values.iter().all(|value| value.is_finite()));
            }
        }
    }
}

#[test]
fn a_subset_keeps_what_the_order_of_the_whole_run_shows() {
    let run = with_run_order(simulate(&examples::puma_like(), &SimulationOptions::default(), &NoEffects).data);
    let some = run.subset(&[3, 8, 20]);
    assert_eq!(with_run_order(some.clone()), some);
}
