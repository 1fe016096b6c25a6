//! `denavit fleet siblings`: what robots share, and who stands out.

use crate::args::FleetSiblingsArguments;
use crate::delivery::Delivery;
use crate::failure::Failure;
use crate::output::Status;
use denavit_fleet::nights::{Fleet, Shared};
use denavit_fleet::statistics::false_discovery::discoveries;
use denavit_fleet::store::Store;
use serde::Serialize;
use std::fmt::Write as _;

#[derive(Serialize)]
struct Answer {
    false_discovery_rate: f64,
    shared: Vec<SharedEntry>,
    outliers: Vec<OutlierEntry>,
}

#[derive(Serialize)]
struct SharedEntry {
    robot: String,
    parameter: String,
    unit: String,
    robots: usize,
    mean: f64,
    mean_std: f64,
    spread: f64,
}

#[derive(Serialize)]
struct OutlierEntry {
    serial: String,
    parameter: String,
    unit: String,
    off: f64,
    sigmas: f64,
    p_value: f64,
}

pub fn run(arguments: &FleetSiblingsArguments) -> Result<Status, Failure> {
    let delivery = Delivery::of(None, &arguments.json, [])?;
    let fleet = Fleet::read(&Store::open(&arguments.store)?)?;
    let answer = answer(&fleet, &fleet.shared(), arguments.rate);
    delivery.deliver(|| Ok(text(&answer)), || Ok(super::super::stamped("denavit.fleet.siblings/1", &answer)))?;
    Ok(if answer.outliers.is_empty() { Status::Same } else { Status::Different })
}

fn answer(fleet: &Fleet, shared: &[Shared], rate: f64) -> Answer {
    let tests: Vec<_> = shared.iter().flat_map(|of| of.off.iter().map(move |off| (of, off))).collect();
    let p_values: Vec<f64> = tests.iter().map(|(_, off)| off.p_value).collect();
    let found = tests.iter().zip(discoveries(&p_values, rate)).filter(|(_, found)| *found);
    let outlier = |(of, off): &(&Shared, &denavit_fleet::statistics::population::Outlier)| {
        let number = &fleet.numbers[of.number];
        OutlierEntry {
            serial: fleet.serials[of.robots[off.robot]].clone(),
            parameter: number.name(),
            unit: number.unit.clone(),
            off: off.off,
            sigmas: off.sigmas,
            p_value: off.p_value,
        }
    };
    let mut outliers: Vec<OutlierEntry> = found.map(|(test, _)| outlier(test)).collect();
    outliers.sort_by(|a, b| b.sigmas.abs().total_cmp(&a.sigmas.abs()));
    let entry = |of: &Shared| {
        let number = &fleet.numbers[of.number];
        SharedEntry {
            robot: number.robot.clone(),
            parameter: number.name(),
            unit: number.unit.clone(),
            robots: of.robots.len(),
            mean: of.population.mean,
            mean_std: of.population.mean_std,
            spread: of.population.spread,
        }
    };
    Answer { false_discovery_rate: rate, shared: shared.iter().map(entry).collect(), outliers }
}

fn text(answer: &Answer) -> String {
    let mut text = String::new();
    for of in &answer.shared {
        let (mean, spread) = (super::watch::shown(of.mean, &of.unit), super::watch::shown(of.spread, &of.unit));
        let _ = writeln!(
            text,
            "{:<32} {:>4} robots  mean {mean:>16}  spread {:>15}",
            of.parameter,
            of.robots,
            &spread[1..]
        );
    }
    if answer.shared.is_empty() {
        text.push_str("no number is known of at least six robots better than its tolerance says\n");
    }
    for of in &answer.outliers {
        let off = super::watch::shown(of.off, &of.unit);
        let _ = writeln!(text, "{}: {} is {:.1} σ off its siblings ({off})", of.serial, of.parameter, of.sigmas.abs());
    }
    let _ = writeln!(
        text,
        "{} outliers at a false discovery rate of {} over {} numbers",
        answer.outliers.len(),
        answer.false_discovery_rate,
        answer.shared.iter().map(|of| of.robots).sum::<usize>()
    );
    text
}
