//! One run told in several ways has the same causes.

#![allow(clippy::unwrap_used, reason = "a test that cannot make its input has failed")]

use crate::drawn::ur5e;
use denavit_calibrate::IdentifyOptions;
use denavit_identify::effects::{Carrier, Coupling, Driver, Effect, EffectModel, Kind, Statics, Term};
use denavit_identify::identify;
use denavit_identify::simulate::{SimulationOptions, readings, simulate};
use denavit_measurements::{Measurements, Units, read, write};
use denavit_model::Chain;
use denavit_trace::{TraceOptions, trace};

pub fn effect(kind: Kind, joint: usize, driver: Driver, coefficient: f64) -> Effect {
    let term = Term { kind, carrier: Carrier::Joint(joint), driver, coupling: Coupling::Each };
    Effect { term, coefficients: vec![coefficient] }
}

/// What is named, and where.
pub fn named((chain, statics): &(Chain, Statics), data: &Measurements) -> Vec<(Kind, String)> {
    let options = TraceOptions::new(IdentifyOptions::axes(chain));
    let geometric = identify(chain, data, &options.identify).geometric;
    let found = trace(statics, data, &geometric, &options);
    let named = found.findings.into_iter().filter(|finding| finding.named);
    let mut names: Vec<(Kind, String)> = named.map(|finding| (finding.term.kind, finding.place)).collect();
    names.sort();
    names
}

/// The text of the rows with every cell changed, by the column's name, and columns behind them.
fn rewritten(
    data: &Measurements,
    change: impl Fn(&str, f64, &dyn Fn(&str) -> f64) -> f64,
    more: &[(&str, &dyn Fn(usize) -> f64)],
) -> String {
    let text = write(data, &[]);
    let mut lines = text.lines();
    let header: Vec<&str> = lines.next().unwrap().split(',').collect();
    let names: Vec<&str> = header.iter().copied().chain(more.iter().map(|(name, _)| *name)).collect();
    let mut out = names.join(",");
    for (row, line) in lines.enumerate() {
        let cells: Vec<f64> = line.split(',').map(|cell| cell.parse().unwrap()).collect();
        let of = |name: &str| cells[header.iter().position(|other| *other == name).unwrap()];
        let changed = header.iter().zip(&cells).map(|(name, cell)| change(name, *cell, &of).to_string());
        let behind = more.iter().map(|(_, value)| value(row).to_string());
        out.push('\n');
        out.push_str(&changed.chain(behind).collect::<Vec<_>>().join(","));
    }
    out
}

#[test]
fn a_soft_joint_and_a_coupling_are_found_in_every_form_of_the_run() {
    let arm = ur5e();
    let (chain, statics) = &arm;
    let effects = vec![
        effect(Kind::JointCompliance, 2, Driver::Torque(2), 2e-5),
        effect(Kind::JointCoupling, 4, Driver::Reading(3), 6e-4),
    ];
    let options = SimulationOptions { rows: 150, seed: 5, ..SimulationOptions::default() };
    let data = simulate(chain, &options, &EffectModel::new(statics.clone(), effects)).data;
    let loaded = |text: &str, units: &str| {
        let units = if units.is_empty() { Units::default() } else { units.parse().unwrap() };
        read("told.csv", text.as_bytes(), chain, units).unwrap().data
    };
    let names = named(&arm, &data);
    let place = |joint: usize| chain.joints()[joint].name.clone();
    assert_eq!(names, [(Kind::JointCompliance, place(2)), (Kind::JointCoupling, place(4))]);
    // 61 and 150 have no common factor.
    let order: Vec<usize> = (0..data.len()).map(|row| row * 61 % data.len()).collect();
    assert_eq!(named(&arm, &data.subset(&order)), names, "rows in another order");
    let humidity = |row: usize| 40.0 + 10.0 * ((row * row) as f64 * 0.37).sin();
    let more = rewritten(&data, |_, cell, _| cell, &[("humidity", &humidity)]);
    assert_eq!(named(&arm, &loaded(&more, "")), names, "a column that means nothing");
    let scaled = |name: &str, cell: f64, _: &dyn Fn(&str) -> f64| {
        if ["x", "y", "z"].contains(&name) { cell * 1e3 } else { cell.to_degrees() }
    };
    assert_eq!(named(&arm, &loaded(&rewritten(&data, scaled, &[]), "mm,deg")), names, "mm and degrees");
}

/// Readings as a controller gives them that counts the elbow from the ground, and the same with that taken out.
#[test]
fn a_soft_joint_is_found_whether_or_not_a_coupling_was_taken_out_beforehand() {
    let arm = ur5e();
    let (chain, statics) = &arm;
    let effects = vec![
        effect(Kind::JointCompliance, 2, Driver::Torque(2), 4e-5),
        effect(Kind::JointCoupling, 2, Driver::Reading(1), -1.0),
    ];
    // Over full turns nothing that is linear leads from one way of counting to the other.
    let near: Vec<Vec<f64>> =
        readings(chain, 200, 9).iter().map(|row| row.iter().map(|reading| 0.3 * reading).collect()).collect();
    let options = SimulationOptions { readings: Some(near), seed: 9, ..SimulationOptions::default() };
    let data = simulate(chain, &options, &EffectModel::new(statics.clone(), effects)).data;
    let place = |joint: usize| chain.joints()[joint].name.clone();
    let coupled = named(&arm, &data);
    assert_eq!(coupled, [(Kind::JointCompliance, place(2)), (Kind::JointCoupling, place(2))]);
    let (elbow, upper_arm) = (place(2), place(1));
    let taken_out = |name: &str, cell: f64, of: &dyn Fn(&str) -> f64| {
        if name == elbow { cell - of(&upper_arm) } else { cell }
    };
    let text = rewritten(&data, taken_out, &[]);
    let corrected = read("told.csv", text.as_bytes(), chain, Units::default()).unwrap().data;
    assert_eq!(named(&arm, &corrected), [(Kind::JointCompliance, place(2))]);
}
