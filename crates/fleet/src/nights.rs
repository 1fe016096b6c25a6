//! The nights of a store as the statistics take them: robots by numbers by nights.

use crate::day::Day;
use crate::error::FleetError;
use crate::statistics::population::{Measured, Outlier, Population, off_siblings};
use crate::statistics::trend::{self, Crossing, Point, Shape};
use crate::statistics::vigil::{Night, Nights, Said, Watch, watch};
use crate::store::Store;
use crate::store::schema::{PARAMETERS, RUNS};
use serde::Serialize;
use std::collections::{BTreeMap, HashMap};

/// A number that robots of one kind have every night.
#[derive(Debug, Clone, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize)]
pub struct Number {
    /// Name of the kind of robot, as its file gives it.
    pub robot: String,
    /// Its joint; empty for what the whole robot has.
    pub joint: String,
    /// `turn_x` … `move_z`; `rms`: what the model leaves.
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
    /// Standard deviations of the last night, in the order of `numbers`, and how much of each is the prior's.
    pub last: Vec<Vec<Option<(f64, f64)>>>,
    /// Key of the last night of each robot.
    pub last_keys: Vec<String>,
}

/// What is known of a night before its values are.
struct Known {
    robot: usize,
    day: i32,
    event: bool,
    kind: String,
    rms: Option<f64>,
}

/// A night and what is known of it beside its values.
struct Calibrated {
    night: Night,
    sure: Vec<Option<(f64, f64)>>,
    key: String,
}

impl Fleet {
    /// Reads the calibrations that have a date and were done.
    ///
    /// # Errors
    /// A file of the store cannot be read.
    pub fn read(store: &Store) -> Result<Self, FleetError> {
        let runs = runs(store)?;
        let mut serials: Vec<String> = runs.values().map(|(serial, _)| serial.clone()).collect();
        serials.sort();
        serials.dedup();
        let place: HashMap<&str, usize> =
            serials.iter().enumerate().map(|(at, serial)| (serial.as_str(), at)).collect();
        let known: HashMap<String, Known> =
            runs.iter().map(|(key, (serial, known))| (key.clone(), known(place[serial.as_str()]))).collect();
        let mut index: BTreeMap<Number, usize> = BTreeMap::new();
        let mut values: HashMap<&str, Vec<(usize, f64, f64, f64)>> = HashMap::new();
        let wanted = ["key", "joint", "parameter", "value", "std", "held_by_prior", "unit", "task"];
        let [key, joint, parameter, value, std, held, unit, _] = wanted.map(|name| PARAMETERS.index(name));
        store.each_file(&PARAMETERS, &wanted, &mut |rows| {
            for row in rows {
                let Some((name, night)) = known.get_key_value(row[key].text()) else { continue };
                let number = Number {
                    robot: night.kind.clone(),
                    joint: row[joint].text().to_owned(),
                    parameter: row[parameter].text().to_owned(),
                    unit: row[unit].text().to_owned(),
                };
                let next = index.len();
                let at = *index.entry(number).or_insert(next);
                if let Some(number) = row[value].real() {
                    let std = row[std].real().unwrap_or(f64::NAN);
                    values.entry(name).or_default().push((at, number, std, row[held].real().unwrap_or(0.0)));
                }
            }
            Ok(())
        })?;
        let mut kinds: Vec<&String> = known.values().map(|night| &night.kind).collect();
        kinds.sort();
        kinds.dedup();
        for kind in kinds {
            let next = index.len();
            let (joint, parameter, unit) = (String::new(), "rms".into(), "m".into());
            index.entry(Number { robot: kind.clone(), joint, parameter, unit }).or_insert(next);
        }
        // Places as they were given out; they are put in the order of the names below.
        let order: Vec<usize> = index.values().copied().collect();
        let mut rank = vec![0; order.len()];
        for (new, old) in order.iter().enumerate() {
            rank[*old] = new;
        }
        let numbers: Vec<Number> = index.into_keys().collect();
        let mut nights: Vec<BTreeMap<i32, Calibrated>> = serials.iter().map(|_| BTreeMap::new()).collect();
        let mut keys: Vec<&String> = known.keys().collect();
        keys.sort();
        for key in keys {
            let night = &known[key];
            let mut row = vec![None; numbers.len()];
            let mut sure = vec![None; numbers.len()];
            for (at, value, std, held) in values.get(key.as_str()).into_iter().flatten() {
                row[rank[*at]] = Some(*value);
                sure[rank[*at]] = Some((*std, *held));
            }
            let rms = numbers.iter().position(|number| number.parameter == "rms" && number.robot == night.kind);
            if let Some(at) = rms {
                row[at] = night.rms;
            }
            let found = Night { day: night.day, event: night.event, values: row };
            nights[night.robot].insert(night.day, Calibrated { night: found, sure, key: key.clone() });
        }
        let (mut last, mut last_keys) = (Vec::new(), Vec::new());
        for of in &nights {
            let (_, night) = of.last_key_value().expect("a robot is there by a night");
            last.push(night.sure.clone());
            last_keys.push(night.key.clone());
        }
        let nights =
            nights.into_iter().map(|of| Nights { nights: of.into_values().map(|found| found.night).collect() });
        Ok(Self { nights: nights.collect(), serials, numbers, last, last_keys })
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

    /// What became of each number of a robot that did not stay; tolerances are of m and rad, about the first nights.
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
    /// What robots of a kind share, by their last nights: numbers that at least six of them know better than the prior.
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

/// What became of a number.
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

type OfRobot = Box<dyn Fn(usize) -> Known>;

/// Calibrations with a date that were done: key to serial, and what is known of the night once its robot has a place.
fn runs(store: &Store) -> Result<HashMap<String, (String, OfRobot)>, FleetError> {
    let wanted = ["key", "serial", "date", "task", "name", "event", "ok", "rms"];
    let [key, serial, date, task, name, event, ok, rms] = wanted.map(|name| RUNS.index(name));
    let mut runs: HashMap<String, (String, OfRobot)> = HashMap::new();
    store.each_file(&RUNS, &wanted, &mut |rows| {
        for row in rows.iter().filter(|row| row[ok].is_true() && row[task].text() == "calibrate") {
            let Some(day) = row[date].day() else { continue };
            let (kind, event, rms) = (row[name].text().to_owned(), !row[event].text().is_empty(), row[rms].real());
            let known = move |robot| Known { robot, day, event, kind: kind.clone(), rms };
            runs.insert(row[key].text().to_owned(), (row[serial].text().to_owned(), Box::new(known)));
        }
        Ok(())
    })?;
    Ok(runs)
}
