//! The averaged prediction: better than geometry alone where effects act, unsure where nothing was measured, the same once it was saved.

#![allow(clippy::unwrap_used, clippy::print_stdout)] // Tests: a panic is a failure, what is printed is read.

use denavit_calibrate::Measurements;
use denavit_calibrate::calibration::adoption::Adopted;
use denavit_calibrate::calibration::{CalibrateOptions, Calibration, calibrate};
use denavit_identify::arm::Row;
use denavit_identify::effects::{
    Carrier, Conditions, Correction, Coupling, Driver, Effect, EffectModel, Kind, SavedEffects, Statics, Term,
};
use denavit_identify::simulate::{SimulationOptions, simulate};
use denavit_measurements::kinds::ObservationKind;
use denavit_measurements::{MissingColumn, Units, read};
use denavit_model::examples::puma_like;

/// Gears that err with their own turn.
fn gears(statics: &Statics) -> EffectModel {
    let gear = |joint: usize, order: f64, size: f64| Effect {
        term: Term {
            kind: Kind::TransmissionError,
            carrier: Carrier::Joint(joint),
            driver: Driver::Harmonic { joint, order },
            coupling: Coupling::Each,
        },
        coefficients: vec![size, -size],
    };
    EffectModel::new(statics.clone(), vec![gear(0, 1.0, 6e-4), gear(1, 2.3, 5e-4), gear(2, 3.0, 5e-4)])
}

/// Rows to fit and rows of the same arm to judge by.
fn rows(kind: ObservationKind, count: usize, seed: u64) -> (Measurements, Measurements) {
    let chain = puma_like();
    let options = SimulationOptions { kind, rows: count + 100, seed, ..Default::default() };
    let all = simulate(&chain, &options, &gears(&Statics::of_chain(&chain))).data;
    let order: Vec<usize> = (0..all.len()).collect();
    (all.subset(&order[..count]), all.subset(&order[count..]))
}

fn averaged(train: Measurements, test: Option<Measurements>) -> Calibration {
    let chain = puma_like();
    let options = CalibrateOptions { average: true, ..CalibrateOptions::geometry(&chain) };
    calibrate(&chain, &Statics::of_chain(&chain), train, test, &options).unwrap()
}

#[test]
fn every_kind_of_rows_is_predicted_better_than_by_geometry_alone() {
    for (kind, count, word) in [
        (ObservationKind::Pose, 25, "position"),
        (ObservationKind::Position, 40, "position"),
        (ObservationKind::Distance, 120, "distance"),
    ] {
        let (train, test) = rows(kind, count, 5);
        let result = averaged(train, Some(test));
        let stages = &result.report.stages;
        let error = |name: &str| {
            let stage = stages.iter().find(|stage| stage.name == name).unwrap();
            stage.test.as_ref().unwrap().of(word).unwrap().rms
        };
        println!("{word} of {count}: geometric {:.6}, averaged {:.6}", error("geometric"), error("averaged"));
        assert_eq!((result.report.adopted, stages.last().unwrap().name.as_str()), (Adopted::Averaged, "averaged"));
        assert!(stages.last().unwrap().adopted && stages.iter().filter(|stage| stage.adopted).count() == 1);
        // A distance tells one number of a posture, and less of the gears.
        let at_most = if word == "distance" { 0.97 } else { 0.5 };
        assert!(
            error("averaged") < at_most * error("geometric"),
            "{word}: {} {}",
            error("averaged"),
            error("geometric")
        );
        // The calibrated robot is that of the geometric fit: what was averaged comes on top of it.
        assert_eq!(result.arm().joints, result.identification.geometric.arm.joints);
    }
}

#[test]
fn what_is_saved_predicts_the_same_and_does_without_unrecorded_columns() {
    let (train, _) = rows(ObservationKind::Position, 30, 8);
    let result = averaged(train, None);
    let chain = puma_like();
    let statics = Statics::of_chain(&chain);
    let model = result.effects(&statics);
    let saved = SavedEffects::from_json("effects.json", &model.to_json(), &statics).unwrap();
    assert!(saved.needed().is_empty(), "nothing must be given: {:?}", saved.needed());
    let data = &result.train;
    let bound = saved.clone().bound(&|name| data.column(name)).unwrap();
    let absent = |name: &str| Err(MissingColumn::Absent { file: "none".into(), column: name.into() });
    let plain = saved.bound(&absent).unwrap();
    let calibrated = result.arm().chain_to(0);
    for row in [0, 7, 29] {
        let conditions = Conditions::of(Row::new(data, row));
        let place = |model: &Correction| model.fk(&calibrated, &conditions).translation.vector;
        assert!((place(&model) - place(&bound)).norm() < 1e-9, "{}", (place(&model) - place(&bound)).norm());
        assert!((place(&model) - place(&plain)).norm() < 1e-3);
        assert!((place(&model) - calibrated.fk(conditions.reading).translation.vector).norm() > 1e-6);
    }
}

/// The same rows from an instrument that stands so much farther away along its x axis.
fn from_farther(data: &Measurements, by: f64) -> Measurements {
    let mut text = format!("{},x,y,z\n", data.joints.join(","));
    for row in 0..data.len() {
        let [x, y, z]: [f64; 3] = data.observed.values(row).try_into().unwrap();
        let cells = data.reading(row).iter().copied().chain([x + by, y, z]);
        text += &(cells.map(|cell| cell.to_string()).collect::<Vec<_>>().join(",") + "\n");
    }
    read("farther.csv", text.as_bytes(), &puma_like(), Units::default()).unwrap().data
}

#[test]
fn a_prediction_is_as_sure_from_an_instrument_far_away() {
    // The farther the instrument, the more its metre and the place of its frame make up for each other: neither is an error of a prediction.
    let (train, test) = rows(ObservationKind::Position, 30, 4);
    let judged = |by: f64| {
        let result = averaged(from_farther(&train, by), Some(from_farther(&test, by)));
        let error = result.report.stages.last().unwrap().test.as_ref().unwrap().of("position").unwrap().rms;
        (result.report.prediction.as_ref().unwrap().inside_m, error)
    };
    let ((near, near_error), (far, far_error)) = (judged(0.0), judged(6.0));
    println!("expected {near:.6} and {far:.6}, found {near_error:.6} and {far_error:.6}");
    assert!((far / near - 1.0).abs() < 0.25, "{near} {far}");
    assert!((far_error / near_error - 1.0).abs() < 0.25, "{near_error} {far_error}");
}

#[test]
fn outside_of_what_was_measured_the_prediction_is_unsure_and_goes_back_to_geometry() {
    let (train, _) = rows(ObservationKind::Position, 60, 3);
    // Joint 1 is measured in half of its range.
    let near: Vec<usize> = (0..train.len()).filter(|&row| train.reading(row)[0] < 0.0).collect();
    let result = averaged(train.subset(&near), None);
    let expected = result.report.prediction.as_ref().unwrap();
    let first = expected.outside.iter().find(|outside| outside.joint == train.joints[0]).unwrap();
    assert!(first.error_m > 1.5 * expected.inside_m, "{first:?} {}", expected.inside_m);
    let averaged = &result.averaging.as_ref().unwrap().fit.effects;
    let blend = |reading: &[f64]| {
        let mut conditions = Conditions::of(Row::new(&result.train, 0));
        conditions.reading = reading;
        averaged.blend(&conditions)
    };
    let here = result.train.reading(0).to_vec();
    let mut there = here.clone();
    there[0] = 2.5;
    assert!(blend(&there).shares[0] < blend(&here).shares[0]);
    assert!(blend(&there).variance > blend(&here).variance);
    assert!(
        denavit_calibrate::report::text::calibration(&result).contains("expected error of the averaged prediction")
    );
}
