//! A run with more rows than causes are judged by: the others must show a cause, too.

#![allow(clippy::unwrap_used, reason = "a test that cannot make its input has failed")]

use crate::drawn::ur5e;
use crate::retold::{effect, named};
use denavit_identify::effects::{Driver, EffectModel, Kind};
use denavit_identify::simulate::{SimulationOptions, simulate};
use denavit_measurements::{Units, read, write};

/// 1600 positions are judged by 800: here every other row.
const ROWS: usize = 1600;

#[test]
fn a_cause_of_every_other_row_is_not_named_and_one_of_all_rows_is() {
    let arm = ur5e();
    let (chain, statics) = &arm;
    let options = SimulationOptions { rows: ROWS, seed: 11, ..SimulationOptions::default() };
    let run = |effects| simulate(chain, &options, &EffectModel::new(statics.clone(), effects)).data;
    let (with, without) = (run(vec![effect(Kind::JointScale, 1, Driver::Reading(1), 4e-4)]), run(Vec::new()));
    assert_eq!(named(&arm, &with), [(Kind::JointScale, "shoulder_lift_joint".to_owned())]);

    let (with, without) = (write(&with, &[]), write(&without, &[]));
    let lines = with.lines().zip(without.lines()).enumerate();
    // The first line is the header; the rows that are judged by are 0, 2, 4, …
    let mixed: Vec<&str> = lines.map(|(line, (with, without))| if line % 2 == 1 { with } else { without }).collect();
    let mixed = read("mixed.csv", mixed.join("\n").as_bytes(), chain, Units::default()).unwrap().data;
    assert_eq!(named(&arm, &mixed), []);
}
