//! One result, many views: the rows of the report are those that its errors are made of.

#![allow(clippy::unwrap_used)] // Tests: a panic is a failure.

use denavit_calibrate::calibration::rows::{RowEntry, to_csv};
use denavit_calibrate::calibration::{CalibrateOptions, Calibration, HoldOut, calibrate};
use denavit_calibrate::report::html;
use denavit_identify::effects::driver::Statics;
use denavit_identify::parameters::NoEffects;
use denavit_identify::simulate::{SimulationOptions, simulate};
use denavit_measurements::kinds::ObservationKind;
use denavit_model::examples;

fn calibrated(options: SimulationOptions) -> (Calibration, denavit_calibrate::Arm) {
    let chain = examples::puma_like();
    let run = simulate(&chain, &SimulationOptions { rows: 120, outliers: 0.03, seed: 5, ..options }, &NoEffects);
    let options =
        CalibrateOptions { hold_out: Some(HoldOut { share: 0.3, seed: 1 }), ..CalibrateOptions::geometry(&chain) };
    (calibrate(&chain, &Statics::of_chain(&chain), run.data, None, &options).unwrap(), run.arm)
}

fn rms(rows: impl Iterator<Item = RowEntry>) -> f64 {
    let squares: Vec<f64> = rows.map(|row| row.place.iter().map(|value| value * value).sum()).collect();
    (squares.iter().sum::<f64>() / squares.len() as f64).sqrt()
}

#[test]
fn the_errors_are_those_of_the_rows() {
    for (kind, targets) in [(ObservationKind::Pose, 1), (ObservationKind::Position, 2), (ObservationKind::Distance, 1)]
    {
        let (result, _) = calibrated(SimulationOptions { kind, targets, ..SimulationOptions::default() });
        let report = &result.report;
        let adopted = report.stages.iter().find(|stage| stage.adopted).unwrap();
        let word = kind.place().word;
        let (train, test) = (adopted.train.of(word).unwrap().rms, adopted.test.as_ref().unwrap().of(word).unwrap().rms);
        let kept = rms(report.rows.iter().filter(|row| !row.held_out && !row.rejected));
        assert!((kept - train).abs() < 1e-12 * train, "{kept} {train}");
        let held_out = rms(report.rows.iter().filter(|row| row.held_out));
        assert!((held_out - test).abs() < 1e-12 * test, "{held_out} {test}");
        let mut rejected: Vec<usize> = report.rows.iter().filter(|row| row.rejected).map(|row| row.line).collect();
        rejected.dedup();
        assert_eq!(rejected, report.samples.rejected);
        assert!(!rejected.is_empty(), "no gross error among these rows");
        assert_eq!(report.rows.len(), 120 * targets);
        assert!(report.rows.iter().all(|row| row.turn.is_empty() == (kind != ObservationKind::Pose)));
    }
}

#[test]
fn a_fit_of_geometry_keeps_nothing_of_the_rows_order() {
    // Seven columns beside six readings: a third of the memory that a million rows take.
    let (result, _) = calibrated(SimulationOptions::default());
    assert!(result.train.covariates.is_empty() && result.test.unwrap().covariates.is_empty());
}

#[test]
fn instruments_and_targets_are_where_the_simulation_put_them() {
    let (result, truth) = calibrated(SimulationOptions { kind: ObservationKind::Pose, ..SimulationOptions::default() });
    let placements = result.report.placements.clone().unwrap();
    let (found, target) = (&placements.instruments[0], &placements.targets[0]);
    assert!(found.quaternion.is_some() && target.quaternion.is_some() && placements.points.is_empty());
    let instrument = truth.instruments[0].translation.vector;
    let off = (0..3).map(|k| (found.xyz[k] - instrument[k]).abs()).fold(0.0, f64::max);
    // The frame is free to follow the arm's own change, which is about a millimetre.
    assert!(off < 0.02, "{off}");
}

#[test]
fn rows_go_to_csv_and_the_page_lists_the_worst() {
    let (result, _) = calibrated(SimulationOptions { kind: ObservationKind::Pose, ..SimulationOptions::default() });
    let text = to_csv(&result.report.rows);
    let mut reader = csv::Reader::from_reader(text.as_bytes());
    let header = "line,setup,target,held_out,rejected,dx_mm,dy_mm,dz_mm,rx_mrad,ry_mrad,rz_mrad";
    assert_eq!(reader.headers().unwrap().iter().collect::<Vec<_>>().join(","), header);
    for (record, row) in reader.records().map(Result::unwrap).zip(result.report.rows.iter()) {
        assert_eq!(record[0].parse::<usize>().unwrap(), row.line);
        assert_eq!(&record[3] == "1", row.held_out);
        for k in 0..3 {
            assert!((record[5 + k].parse::<f64>().unwrap() - row.place[k] * 1e3).abs() < 1e-12);
        }
    }
    let page = html::page(&result).unwrap();
    for heading in ["Rows that fit worst", "Instruments and targets", "table, as drawn", "table, as calibrated"] {
        assert!(page.contains(heading), "{heading}");
    }
    assert!(page.contains("instrument from base") && page.contains("rejected"));
}
