//! What effects follow is bound to columns: one that is missing, or that has an empty cell, is an error and never 0.

use denavit_calibrate::Measurements;
use denavit_identify::effects::candidates::candidates;
use denavit_identify::effects::survey::{Survey, with_run_order};
use denavit_identify::effects::{Carrier, Coupling, Driver, Effect, EffectModel, Kind, Statics, Term};
use denavit_identify::parameters::Effects as _;
use denavit_identify::parameters::NoEffects;
use denavit_identify::residual_statistics::{Residual, bound_later, residuals};
use denavit_identify::simulate::{SimulationOptions, simulate, simulate_arm};
use denavit_measurements::{Covariate, Units, read};
use denavit_model::examples::{planar_arm, puma_like};

const ROWS: usize = 30;

fn column(name: &str, of: impl Fn(usize) -> f64) -> Covariate {
    Covariate { name: name.into(), values: (0..ROWS).map(of).collect() }
}

fn temperature() -> Covariate {
    column("temperature", |row| 20.0 + 0.1 * row as f64)
}

fn options(covariates: Vec<Covariate>) -> SimulationOptions {
    SimulationOptions { rows: ROWS, covariates, noise_position: 0.0, ..SimulationOptions::default() }
}

/// Joint 2 turns by 0.1 mrad per °C.
fn warm(data: &Measurements) -> EffectModel {
    let driver = Driver::Covariate(data.column("temperature").unwrap());
    let term = Term { kind: Kind::Thermal, carrier: Carrier::Joint(1), driver, coupling: Coupling::Each };
    EffectModel::new(Statics::of_chain(&puma_like()), vec![Effect { term, coefficients: vec![1e-4] }])
}

#[test]
fn an_empty_cell_is_no_zero() {
    let text = "joint_1,joint_2,temperature,x,y,z\n0,0,20,1,0,0\n0.1,0,,1,0,0\n0.2,0,21,1,0,0\n";
    let error = read("m.csv", text.as_bytes(), &planar_arm(), Units::default()).unwrap_err();
    assert_eq!(
        error.to_string(),
        "m.csv:3: column \"temperature\" is empty; every row needs this value: fill it in or remove the row"
    );
    // A column of another name is text where a row has no number in it, so that no effect can follow it.
    let text = "joint_1,joint_2,load,x,y,z\n0,0,,1,0,0\n0.1,0,2,1,0,0\n";
    let data = read("m.csv", text.as_bytes(), &planar_arm(), Units::default()).unwrap().data;
    assert_eq!(data.labels[0].name, "load");
    assert!(data.column("load").unwrap_err().to_string().starts_with("m.csv: there is no column \"load\""));
}

#[test]
fn a_model_goes_to_other_rows_with_its_columns_or_not_at_all() {
    let chain = puma_like();
    let run = simulate(&chain, &options(vec![temperature()]), &NoEffects);
    let model = warm(&run.data);
    let measured = simulate_arm(&run.arm, &options(vec![temperature()]), &model).data;
    // The same rows with another column before that of the temperature.
    let mut other = measured.clone();
    other.covariates = vec![column("time", |row| 30.0 * row as f64), temperature()].into();
    let bound = model.bound_to(&other).unwrap();
    assert_ne!(bound, model);
    assert_eq!(residuals(&run.arm, &bound, &other), residuals(&run.arm, &model, &measured));
    let still = residuals(&run.arm, &NoEffects, &other);
    assert!(still.iter().map(Residual::distance).fold(0.0, f64::max) > 1e-4);
    // A part of the rows has the same columns.
    let part = measured.subset(&[4, 9]);
    let whole = residuals(&run.arm, &model, &measured);
    for (own, row) in residuals(&run.arm, &model, &part).iter().zip([4, 9]) {
        assert_eq!(own.place, whole[row].place);
    }

    let mut without = measured.clone();
    without.source = "later.csv".into();
    without.covariates = vec![column("time", |row| row as f64)].into();
    assert_eq!(
        bound_later(&model, &measured, &without).unwrap_err().to_string(),
        "later.csv: column \"temperature\" of simulation is missing here, but effects may depend on it; add it, or remove it from \
         both files"
    );
    without.covariates = vec![column("temperature", |row| if row == 11 { f64::NAN } else { 20.0 })].into();
    assert_eq!(
        bound_later(&model, &measured, &without).unwrap_err().to_string(),
        "later.csv: row 12 has no value in column \"temperature\", but an effect depends on it; fill it in, or remove the row or \
         the column"
    );
}

#[test]
#[should_panic(expected = "\"temperature\" was looked up in a run with other columns")]
fn a_model_that_was_not_bound_again_is_not_evaluated() {
    let run = simulate(&puma_like(), &options(vec![temperature()]), &NoEffects);
    let mut other = run.data.clone();
    other.covariates = vec![column("time", |row| row as f64)].into();
    residuals(&run.arm, &warm(&run.data), &other);
}

#[test]
fn latency_needs_the_velocity_of_every_joint_that_moves() {
    let chain = puma_like();
    let statics = Statics::of_chain(&chain);
    let velocity = |joint: usize| {
        column(&format!("{}.velocity", chain.coordinates()[joint].name), |row| 0.01 * (row * (joint + 1)) as f64)
    };
    let offered = |joints: &[usize], still: Option<usize>| {
        let covariates = joints.iter().map(|&joint| velocity(joint)).collect();
        let mut data = simulate(&chain, &options(covariates), &NoEffects).data;
        if let Some(still) = still {
            let n = data.joints.len();
            data.readings.iter_mut().skip(still).step_by(n).for_each(|reading| *reading = 0.4);
        }
        let survey = Survey::of(&statics, &with_run_order(data), Vec::new());
        candidates(Kind::Latency, &survey).len()
    };
    assert_eq!(offered(&[0, 1, 2, 3, 4, 5], None), 1);
    assert_eq!(offered(&[0, 1, 2, 3, 5], None), 0);
    assert_eq!(offered(&[0, 1, 2, 3, 5], Some(4)), 1);
    assert_eq!(offered(&[], None), 0);
}
