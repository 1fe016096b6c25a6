//! The nights of a store as input of the statistics: robots by numbers by nights.

use crate::day::Day;
use crate::error::FleetError;
use crate::statistics::population::{Measured, Outlier, Population, off_siblings};
use crate::statistics::trend::{self, Crossing, Point, Shape};
use crate::statistics::vigil::{Night, Nights, Said, Watch, watch};
use crate::store::schema::{PARAMETERS, RUNS};
use crate::store::table::Cell;
use crate::store::{Failure, Store};
use serde::Serialize;
use std::collections::{BTreeMap, HashMap};

/// A number that robots of one kind have every night.
#[derive(Debug, Clone, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize)]
pub struct Number {
    /// Name of the kind of robot, as its file gives it.
    pub robot: String,
    /// Its joint; empty for what the whole robot has.
    pub joint: String,
    /// `turn_x` … `move_z`; `rms`: of the residuals.
    pub parameter: String,
    /// rad, m, m/rad or 1.
    pub unit: String,
}

impl Number {
    /// `elbow_joint.turn_x`.
    pub fn name(&self) -> String {
        if self.joint.is_empty() { self.parameter.clone() } else { format!("{}.{}", self.joint, self.parameter) }
    }
}

/// Every calibrated night of a store.
#[derive(Debug, Clone)]
pub struct Fleet {
    /// Robots.
    pub serials: Vec<String>,
    /// Their numbers.
    pub numbers: Vec<Number>,
    /// Nights of each robot, values in the order of `numbers`.
    pub nights: Vec<Nights>,
    /// Standard deviations of the last night, in the order of `numbers`, and the prior's share of each.
    pub last: Vec<Vec<Option<(f64, f64)>>>,
    /// Key of the last night of each robot.
    pub last_keys: Vec<String>,
    /// Runs that failed and have not succeeded since, of every task, by robot and night.
    pub failed: Vec<Failure>,
}

impl Fleet {
    /// Reads the successful calibrations with a date.
    ///
    /// Memory holds one number for each parameter and night, and some thousand rows of the table being read.
    ///
    /// # Errors
    /// A file of the store cannot be read.
    pub fn read(store: &Store) -> Result<Self, FleetError> {
        let Calendar { serials, kinds, nights: known } = Calendar::read(store)?;
        let place: HashMap<Key, usize> = known.iter().enumerate().map(|(at, night)| (night.key, at)).collect();
        let is_last = |at: usize| known.get(at + 1).is_none_or(|next: &KnownNight| next.robot != known[at].robot);
        let mut index: BTreeMap<Number, usize> = BTreeMap::new();
        // Of each night, by the places that numbers are given out in.
        let mut values: Vec<Vec<Option<f64>>> = vec![Vec::new(); known.len()];
        let mut sure: Vec<Vec<Option<(f64, f64)>>> = vec![Vec::new(); serials.len()];
        let wanted = ["key", "joint", "parameter", "value", "std", "held_by_prior", "unit"];
        let [key, joint, parameter, value, std, held, unit] = wanted.map(|name| PARAMETERS.index(name));
        store.each_group(&PARAMETERS, &wanted, &mut |rows| {
            for row in rows {
                let Some(&at) = key_of(&row[key]).and_then(|key| place.get(&key)) else { continue };
                let night = &known[at];
                let number = Number {
                    robot: kinds[night.kind].clone(),
                    joint: row[joint].text().to_owned(),
                    parameter: row[parameter].text().to_owned(),
                    unit: row[unit].text().to_owned(),
                };
                let next = index.len();
                let number = *index.entry(number).or_insert(next);
                if let Some(value) = row[value].real() {
                    put(&mut values[at], number, value);
                    // Of a number without its spread nothing is learned.
                    if let (true, Some(std), Some(held)) = (is_last(at), row[std].real(), row[held].real()) {
                        put(&mut sure[night.robot], number, (std, held));
                    }
                }
            }
            Ok(())
        })?;
        let mut of_kinds = Vec::new();
        for kind in &kinds {
            let next = index.len();
            let (joint, parameter, unit) = (String::new(), "rms".into(), "m".into());
            of_kinds.push(*index.entry(Number { robot: kind.clone(), joint, parameter, unit }).or_insert(next));
        }
        for (night, values) in known.iter().zip(&mut values) {
            if let Some(rms) = night.rms {
                put(values, of_kinds[night.kind], rms);
            }
        }
        // Indices in order of creation, reordered by name.
        let order: Vec<usize> = index.values().copied().collect();
        let mut fleet = Self {
            nights: serials.iter().map(|_| Nights::default()).collect(),
            last: sure.iter().map(|sure| in_order(sure, &order)).collect(),
            last_keys: Vec::new(),
            failed: store.runs()?.still_failed().into_iter().cloned().collect(),
            serials,
            numbers: index.into_keys().collect(),
        };
        for (at, (night, values)) in known.iter().zip(&mut values).enumerate() {
            let values = in_order(&std::mem::take(values), &order);
            fleet.nights[night.robot].nights.push(Night { day: night.day, event: night.event, values });
            if is_last(at) {
                fleet.last_keys.push(base16ct::lower::encode_string(&night.key));
            }
        }
        Ok(fleet)
    }

    /// The watch of the last night.
    pub fn watch(&self, how: &Watch) -> Said {
        watch(&self.nights, self.numbers.len(), how)
    }

    /// Day of the last night of all.
    pub fn tonight(&self) -> Option<Day> {
        self.nights.iter().filter_map(|robot| Some(Day(robot.nights.last()?.day))).max()
    }

    /// The points of a number of a robot since its last event, or all of them.
    pub fn points(&self, robot: usize, number: usize) -> Vec<Point> {
        let point = |night: &Night| {
            let value = night.values.get(number).copied().flatten()?;
            Some(Point { day: f64::from(night.day), value, event: night.event })
        };
        self.nights[robot].nights.iter().filter_map(point).collect()
    }

    /// Changes of each number of a robot that did not stay constant; tolerances in m and rad refer to the first nights.
    pub fn histories(&self, robot: usize, reference: usize, tolerances: [f64; 2]) -> Vec<History> {
        let of = |number: usize| {
            let mut points = self.points(robot, number);
            let shape = trend::shape(&points);
            if shape == Shape::Steady {
                return None;
            }
            let first = &points[..reference.min(points.len())];
            let level = first.iter().map(|point| point.value).sum::<f64>() / first.len().max(1) as f64;
            for point in &mut points {
                point.value -= level;
            }
            let tolerance = match self.numbers[number].unit.as_str() {
                "m" => Some(tolerances[0]),
                "rad" => Some(tolerances[1]),
                _ => None,
            };
            let drifts = matches!(shape, Shape::Drift(_));
            let crossing = tolerance.filter(|_| drifts).and_then(|tolerance| trend::crossing(&points, tolerance));
            Some(History { number, shape, level, crossing })
        };
        (0..self.numbers.len()).filter_map(of).collect()
    }
}

/// A number over the population.
#[derive(Debug, Clone, PartialEq)]
pub struct Shared {
    /// Which number.
    pub number: usize,
    /// Its mean and spread.
    pub population: Population,
    /// Robots that it was learned from, by place.
    pub robots: Vec<usize>,
    /// How far each of these is off the others.
    pub off: Vec<Outlier>,
}

impl Fleet {
    /// Populations of robots of a kind, from their last nights: numbers that at least six of them know better than the prior.
    pub fn shared(&self) -> Vec<Shared> {
        let of = |number: usize| {
            let mut robots = Vec::new();
            let mut measured = Vec::new();
            for robot in 0..self.serials.len() {
                let value =
                    self.nights[robot].nights.last().and_then(|night| night.values.get(number).copied().flatten());
                let sure = self.last[robot].get(number).copied().flatten();
                let found = value.zip(sure).and_then(|(value, (std, held))| Measured::without_prior(value, std, held));
                if let Some(found) = found {
                    robots.push(robot);
                    measured.push(found);
                }
            }
            let off = off_siblings(&measured);
            let population = Population::of(&measured).filter(|_| !off.is_empty())?;
            Some(Shared { number, population, robots, off })
        };
        (0..self.numbers.len()).filter_map(of).collect()
    }
}

/// A change of a number.
#[derive(Debug, Clone, PartialEq)]
pub struct History {
    /// Which.
    pub number: usize,
    /// Drift or step.
    pub shape: Shape,
    /// Mean of its first nights.
    pub level: f64,
    /// When a drift leaves the tolerance about that mean.
    pub crossing: Option<Crossing>,
}

/// A run's key, as bytes.
type Key = [u8; 32];

fn key_of(cell: &Cell) -> Option<Key> {
    let mut key = [0; 32];
    base16ct::lower::decode(cell.text(), &mut key).ok().filter(|key| key.len() == 32)?;
    Some(key)
}

/// Puts something at a place of a list that grows where it must.
fn put<T: Clone>(list: &mut Vec<Option<T>>, at: usize, item: T) {
    if list.len() <= at {
        list.resize(at + 1, None);
    }
    list[at] = Some(item);
}

/// A list in another order, as long as it need be.
fn in_order<T: Clone>(list: &[Option<T>], order: &[usize]) -> Vec<Option<T>> {
    let at = |old: &usize| list.get(*old).cloned().flatten();
    let long = order.iter().rposition(|old| at(old).is_some()).map_or(0, |last| last + 1);
    order[..long].iter().map(at).collect()
}

/// Data of a night before its values are read.
struct KnownNight {
    robot: usize,
    day: i32,
    key: Key,
    event: bool,
    kind: usize,
    rms: Option<f64>,
}

/// Which robot was calibrated when.
struct Calendar {
    serials: Vec<String>,
    /// Names of the kinds of robots.
    kinds: Vec<String>,
    /// One for each robot and day, in this order.
    nights: Vec<KnownNight>,
}

impl Calendar {
    /// Successful calibrations with a date.
    fn read(store: &Store) -> Result<Self, FleetError> {
        let wanted = ["key", "serial", "date", "task", "name", "event", "ok", "rms"];
        let [key, serial, date, task, name, event, ok, rms] = wanted.map(|name| RUNS.index(name));
        let (mut serials, mut kinds) = (BTreeMap::new(), BTreeMap::new());
        let place = |names: &mut BTreeMap<String, usize>, name: &str| {
            let next = names.len();
            // A name for each new one alone: there are many rows.
            names.get(name).copied().unwrap_or_else(|| *names.entry(name.to_owned()).or_insert(next))
        };
        let mut nights = Vec::new();
        store.each_group(&RUNS, &wanted, &mut |rows| {
            for row in rows.iter().filter(|row| row[ok].is_true() && row[task].text() == "calibrate") {
                let (Some(day), Some(key)) = (row[date].day(), key_of(&row[key])) else { continue };
                nights.push(KnownNight {
                    robot: place(&mut serials, row[serial].text()),
                    day,
                    key,
                    event: !row[event].text().is_empty(),
                    kind: place(&mut kinds, row[name].text()),
                    rms: row[rms].real(),
                });
            }
            Ok(())
        })?;
        let (serials, robots) = ranked(serials);
        let (kinds, kinds_ranked) = ranked(kinds);
        for night in &mut nights {
            (night.robot, night.kind) = (robots[night.robot], kinds_ranked[night.kind]);
        }
        nights.sort_by_key(|night| (night.robot, night.day, night.key));
        // Of two runs of a day the one with the greater key, whichever was read first.
        nights.reverse();
        nights.dedup_by_key(|night| (night.robot, night.day));
        nights.reverse();
        Ok(Self { serials, kinds, nights })
    }
}

/// Names in order, and the place in it of each place that was given out.
fn ranked(names: BTreeMap<String, usize>) -> (Vec<String>, Vec<usize>) {
    let mut ranks = vec![0; names.len()];
    for (rank, place) in names.values().enumerate() {
        ranks[*place] = rank;
    }
    (names.into_keys().collect(), ranks)
}
