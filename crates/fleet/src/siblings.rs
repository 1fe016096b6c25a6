//! Learns the common errors of the robots in a store, and writes them as the prior of another robot's fit.
//!
//! The prior uses the last calibration of each robot without a siblings prior: then no robot's rows return to it through
//! the others, and the order of work has no effect.

use crate::Day;
use crate::error::FleetError;
use crate::manifest::{Entry, PriorSource, SIBLINGS};
use crate::run::slot;
use crate::statistics::hierarchy::{Hierarchy, RobotInformation};
use crate::store::schema::{AXES, INFORMATION, RUNS};
use crate::store::{Slot, Store};
use crate::tasks;
use denavit_identify::information::Information;
use denavit_identify::posterior::{Earlier, same_drawing};
use denavit_identify::siblings::Drawing;
use denavit_linear::threads::par_map;
use denavit_model::nalgebra::{DMatrix, DVector};
use denavit_model::{Chain, ChainJoint};
use std::collections::{BTreeMap, HashMap, HashSet};

/// A robot that was calibrated without a siblings prior.
#[derive(Debug, Clone)]
pub struct Sibling {
    /// The robot.
    pub serial: String,
    /// Its file as the manifest named it.
    pub robot: String,
    /// Link that its chain starts at.
    pub base: String,
    /// Link that it ends at.
    pub tip: String,
    /// The night.
    date: Option<Day>,
    /// Twist `[omega; v]` of each joint's nominal axis.
    axes: BTreeMap<String, [f64; 6]>,
    information: Information,
}

impl Sibling {
    /// A robot from the information of its rows.
    pub fn of(serial: &str, chain: &Chain, information: Information) -> Self {
        let axis = |joint: &ChainJoint| (joint.name.clone(), joint.screw.twist().into());
        Self {
            serial: serial.into(),
            robot: chain.name().into(),
            base: chain.base().into(),
            tip: chain.tip().into(),
            date: None,
            axes: chain.joints().iter().map(axis).collect(),
            information,
        }
    }
}

/// Reads the last calibration of each robot without a siblings prior, for each of its tips, in the order of their names
/// and nights; `counts` may exclude runs by robot, night, task and key.
///
/// Memory holds some hundred numbers for each robot.
///
/// # Errors
/// A file of the store cannot be read.
pub fn siblings(store: &Store, counts: &dyn Fn(&Slot, &str) -> bool) -> Result<Vec<Sibling>, FleetError> {
    let mut last: BTreeMap<[String; 3], Last> = BTreeMap::new();
    let wanted = ["key", "serial", "date", "task", "ok", "robot", "base", "tip", "prior"];
    let [key, serial, date, task, ok, robot, base, tip, prior] = wanted.map(|name| RUNS.index(name));
    store.each_group(&RUNS, &wanted, &mut |rows| {
        for row in rows {
            let by_itself = row[ok].is_true() && row[task].text() == "calibrate" && row[prior].text() != SIBLINGS;
            let (serial, key, day) = (row[serial].text(), row[key].text(), row[date].day());
            let slot = Slot { serial: serial.into(), date: day.map(Day), task: row[task].text().into() };
            if !by_itself || !counts(&slot, key) {
                continue;
            }
            let of = [serial, row[base].text(), row[tip].text()].map(str::to_owned);
            let own = Last { date: day, key: key.to_owned(), robot: row[robot].text().to_owned() };
            if last.get(&of).is_none_or(|then| (then.date, &then.key) < (own.date, &own.key)) {
                last.insert(of, own);
            }
        }
        Ok(())
    })?;
    let keys: HashSet<&str> = last.values().map(|run| &run.key[..]).collect();
    let (mut axes, mut information) = (read_axes(store, &keys)?, read_information(store, &keys)?);
    let sibling = |([serial, base, tip], Last { date, key, robot }): ([String; 3], Last)| {
        let (axes, information) = (axes.remove(&key)?, information.remove(&key)?);
        Some(Sibling { serial, robot, base, tip, date: date.map(Day), axes, information })
    };
    let mut siblings: Vec<Sibling> = last.into_iter().filter_map(sibling).collect();
    siblings.sort_by(|a, b| (&a.serial, a.date).cmp(&(&b.serial, b.date)));
    Ok(siblings)
}

/// By key.
fn read_axes(store: &Store, keys: &HashSet<&str>) -> Result<HashMap<String, BTreeMap<String, [f64; 6]>>, FleetError> {
    let [key, joint, first] = ["key", "joint", "omega_x"].map(|name| AXES.index(name));
    let mut axes: HashMap<String, BTreeMap<String, [f64; 6]>> = HashMap::new();
    store.each_group(&AXES, &[], &mut |rows| {
        for row in rows {
            let Some(run) = keys.get(row[key].text()) else { continue };
            let twist = std::array::from_fn(|k| row[first + k].real().unwrap_or(f64::NAN));
            axes.entry((*run).to_owned()).or_default().insert(row[joint].text().to_owned(), twist);
        }
        Ok(())
    })?;
    Ok(axes)
}

/// By key. Names of parameters are kept once for all robots.
fn read_information(store: &Store, keys: &HashSet<&str>) -> Result<HashMap<String, Information>, FleetError> {
    let wanted = ["key", "parameter", "other", "value"];
    let [key, parameter, other, value] = wanted.map(|name| INFORMATION.index(name));
    // Each name is kept once; rows hold its number.
    let (mut numbers, mut names) = (HashMap::<String, u32>::new(), Vec::<String>::new());
    let mut read: HashMap<String, Vec<(u32, Option<u32>, f64)>> = HashMap::new();
    store.each_group(&INFORMATION, &wanted, &mut |rows| {
        for row in rows {
            let Some(run) = keys.get(row[key].text()) else { continue };
            let mut number = |name: &str| {
                numbers.get(name).copied().unwrap_or_else(|| {
                    let next = u32::try_from(names.len()).expect("fewer names than rows of a store");
                    names.push(name.to_owned());
                    numbers.insert(name.to_owned(), next);
                    next
                })
            };
            let (of, beside) = (number(row[parameter].text()), row[other].text());
            let beside = (!beside.is_empty()).then(|| number(beside));
            let entry = (of, beside, row[value].real().unwrap_or(f64::NAN));
            read.entry((*run).to_owned()).or_default().push(entry);
        }
        Ok(())
    })?;
    let information = |rows: Vec<(u32, Option<u32>, f64)>| {
        let mut parameters: Vec<u32> = rows.iter().map(|(parameter, ..)| *parameter).collect();
        parameters.sort_unstable_by_key(|number| &names[*number as usize]);
        parameters.dedup();
        let count = parameters.len();
        let (mut matrix, mut pull) = (DMatrix::zeros(count, count), DVector::zeros(count));
        let places: HashMap<u32, usize> =
            parameters.iter().enumerate().map(|(place, number)| (*number, place)).collect();
        for (parameter, other, value) in &rows {
            let i = places[parameter];
            match other.map(|other| places.get(&other)) {
                Some(Some(&k)) => (matrix[(i, k)], matrix[(k, i)]) = (*value, *value),
                // A parameter paired with one that has no row.
                Some(None) => {}
                None => pull[i] = *value,
            }
        }
        let parameters = parameters.iter().map(|number| names[*number as usize].clone()).collect();
        Information { parameters, matrix, pull }
    };
    Ok(read.into_iter().map(|(run, rows)| (run, information(rows))).collect())
}

/// A run that is the last so far.
struct Last {
    date: Option<i32>,
    key: String,
    robot: String,
}

/// The population of robots of one nominal model.
#[derive(Debug)]
pub struct Learned {
    drawing: Drawing,
    /// Robots that it was learned from, in the order of their names.
    pub serials: Vec<String>,
    robots: Vec<RobotInformation>,
    /// The population.
    pub population: Hierarchy,
}

impl Learned {
    /// Learned from the robots with the nominal model of this chain, from the last run of each: a robot calibrated to two
    /// links after the same joints counts once. `None`: there are too few.
    pub fn of(chain: &Chain, siblings: &[Sibling]) -> Option<Self> {
        let drawing = Drawing::of(chain);
        let in_coordinates = |sibling: &Sibling| {
            if !same_drawing(chain, &sibling.axes) {
                return None;
            }
            let (information, pull) = drawing.in_coordinates(&sibling.information)?;
            let finite = information.iter().chain(&pull).all(|number| number.is_finite());
            finite.then(|| (sibling.serial.clone(), RobotInformation { information, pull }))
        };
        let last: BTreeMap<String, RobotInformation> = siblings.iter().filter_map(in_coordinates).collect();
        let (serials, robots): (Vec<String>, Vec<RobotInformation>) = last.into_iter().unzip();
        let population = Hierarchy::of(&robots.iter().collect::<Vec<_>>(), &drawing.moved())?;
        Some(Self { drawing, serials, robots, population })
    }

    /// The prior of a robot, from all others. `None`: there are too few others.
    pub fn prior(&self, of: Option<&str>) -> Option<Earlier> {
        let robots: Vec<&RobotInformation> = self.robots.iter().collect();
        let own = of.and_then(|of| self.serials.iter().position(|serial| serial == of));
        let others = own.map(|own| self.population.leaving_out(&robots, own, &self.drawing.moved()));
        let (mean, covariance) = others.unwrap_or_else(|| Some(self.population.clone()))?.next();
        Some(self.drawing.prior(&mean, &covariance))
    }
}

/// The priors of a run's robots.
#[derive(Debug, Default)]
pub(crate) struct Priors(HashMap<Kind, HashMap<String, String>>);

/// What identifies entries of one nominal model, as far as the manifest states it.
type Kind = (String, Option<String>, Option<String>, Vec<(String, String)>);

fn kind(entry: &Entry) -> Kind {
    let options = &entry.options;
    (entry.robot.clone(), options.base.clone(), options.tip.clone(), options.arguments.clone())
}

impl Priors {
    /// Learned for the entries of a run with a siblings prior, after the entries without one (with `keys`) are done. Runs in
    /// the store that this run replaces are excluded: repeating the run gives the same priors.
    pub(crate) fn learned(
        store: &Store,
        entries: &[Entry],
        keys: &HashSet<String>,
        threads: usize,
    ) -> Result<Self, FleetError> {
        let slots: HashSet<Slot> = entries.iter().map(slot).collect();
        let siblings = siblings(store, &|slot, key| keys.contains(key) || !slots.contains(slot))?;
        let mut robots: BTreeMap<Kind, BTreeMap<&str, &Entry>> = BTreeMap::new();
        for entry in entries.iter().filter(|entry| entry.learns()) {
            robots.entry(kind(entry)).or_default().insert(&entry.serial, entry);
        }
        let mut priors = HashMap::new();
        for (kind, robots) in robots {
            let chain = robots.values().next().and_then(|entry| tasks::chain(entry));
            let Some(learned) = chain.and_then(|chain| Learned::of(&chain, &siblings)) else { continue };
            let of = |(): &mut (), serial: &str| Some((serial.to_owned(), learned.prior(Some(serial))?.to_json()));
            priors.insert(kind, par_map(robots.into_keys(), threads, || (), of).into_iter().flatten().collect());
        }
        Ok(Self(priors))
    }

    /// The entry with its siblings prior.
    pub(crate) fn given(&self, entry: &Entry) -> Entry {
        let learned = self.0.get(&kind(entry)).and_then(|of| of.get(&entry.serial)).cloned();
        Entry { prior: Some(PriorSource::Siblings { learned }), ..entry.clone() }
    }
}
