//! `denavit fleet siblings`: what robots share, and who stands out.

use crate::args::FleetSiblingsArguments;
use crate::delivery::Delivery;
use crate::failure::Failure;
use crate::output::{self, Outputs, Status};
use denavit_fleet::nights::{Fleet, Shared};
use denavit_fleet::siblings::{Learned, Sibling, siblings};
use denavit_fleet::statistics::false_discovery::discoveries;
use denavit_fleet::store::Store;
use denavit_load::{Options, Selection};
use denavit_model::Reading;
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet};
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
    let mut files = Outputs::beside(arguments.robot.as_deref());
    let prior_out = files.add_if("--prior-out", arguments.prior_out.as_deref())?;
    let store = Store::open(&arguments.store)?;
    if let Some(slot) = prior_out {
        let (prior, said) = prior(&store, arguments)?;
        files.write(&[(slot, prior)])?;
        output::mention(said);
    }
    let fleet = Fleet::read(&store)?;
    let answer = answer(&fleet, &fleet.shared(), arguments.rate);
    delivery.deliver(|| Ok(text(&answer)), || Ok(super::super::stamped("denavit.fleet.siblings/1", &answer)))?;
    Ok(if answer.outliers.is_empty() { Status::Same } else { Status::Different })
}

/// The prior as JSON, and what it was learned from.
fn prior(store: &Store, arguments: &FleetSiblingsArguments) -> Result<(String, String), Failure> {
    let folder = arguments.store.display();
    let all = siblings(store, &|_, _| true)?;
    let refused = |why: String| Failure::Argument(format!("--prior-out: {folder}: {why}"));
    let all: Vec<Sibling> = match &arguments.tip {
        Some(tip) if !all.iter().any(|sibling| sibling.tip == *tip) => {
            return Err(refused(format!(
                "no robot was calibrated on its own to {tip}; the store has {}",
                tips(all.iter()).join(", ")
            )));
        }
        Some(tip) => all.into_iter().filter(|sibling| sibling.tip == *tip).collect(),
        None => all,
    };
    let without = arguments.without.as_deref();
    if let Some(serial) = without.filter(|serial| !all.iter().any(|sibling| sibling.serial == **serial)) {
        return Err(refused(format!("no robot \"{serial}\" was calibrated on its own; omit --without")));
    }
    let Some(one) = representative(&all, without) else {
        return Err(refused("no robot was calibrated on its own since this version; run the manifest again".into()));
    };
    // Arms of one robot are different chains: which is meant must be said.
    if let [first, second, ..] = &tips(all.iter().filter(|sibling| sibling.robot == one.robot))[..] {
        return Err(refused(format!("{} was calibrated to {first} and to {second}; choose one with --tip", one.robot)));
    }
    let file = arguments.robot.as_deref().unwrap_or(&one.robot);
    let options = Options { arguments_for_another: true, ..Options::default() };
    let loaded = denavit_load::load(file, &options)?.robot;
    let selection = Selection { file, base: Some(&one.base), tip: Some(&one.tip), reading: Reading::Intended };
    let chain = loaded.chain(&selection)?.value;
    let learned = Learned::of(&chain, &all);
    let learned = learned.as_ref().and_then(|learned| Some((learned, learned.prior(without)?)));
    let (learned, prior) = learned.ok_or_else(|| {
        let least = denavit_fleet::statistics::hierarchy::LEAST_ROBOTS;
        refused(format!(
            "fewer than {least} robots with the drawing {file} were calibrated on their own; calibrate more of them, or name \
             their drawing with --robot"
        ))
    })?;
    let count = learned.serials.iter().filter(|serial| Some(&serial[..]) != without).count();
    Ok((prior.to_json(), format!("the prior has {count} robots with the drawing {file}, to {}", one.tip)))
}

/// The links that robots were calibrated to.
fn tips<'a>(of: impl Iterator<Item = &'a Sibling>) -> Vec<&'a str> {
    of.map(|sibling| &sibling.tip[..]).collect::<BTreeSet<_>>().into_iter().collect()
}

/// A robot of the drawing that is meant.
fn representative<'a>(all: &'a [Sibling], without: Option<&str>) -> Option<&'a Sibling> {
    if without.is_some() {
        return all.iter().find(|sibling| Some(&sibling.serial[..]) == without);
    }
    let mut counts: BTreeMap<[&str; 3], (usize, &Sibling)> = BTreeMap::new();
    for sibling in all {
        counts.entry([&sibling.robot, &sibling.base, &sibling.tip]).or_insert((0, sibling)).0 += 1;
    }
    counts.into_values().reduce(|most, next| if next.0 > most.0 { next } else { most }).map(|(_, sibling)| sibling)
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
        text.push_str("no number is known better than its tolerance for at least six robots\n");
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
