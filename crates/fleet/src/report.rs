//! Static pages: one for the fleet, one for each robot.

mod plot;

use crate::day::Day;
use crate::error::FleetError;
use crate::nights::Fleet;
use crate::statistics::median;
use crate::statistics::trend::Shape;
use crate::statistics::vigil::{Said, Watch};
use crate::store::schema::EFFECTS;
use crate::store::{Failure, Store};
use minijinja::value::Serde;
use minijinja::{AutoEscape, Environment, Value, context};
use serde::Serialize;
use std::collections::{BTreeMap, HashMap};

/// Robots listed as worst, and as changed.
const LISTED: usize = 20;
const WEEK: i32 = 7;

/// The content of the pages.
#[derive(Debug)]
pub struct Report<'a> {
    fleet: &'a Fleet,
    said: Said,
    effects: HashMap<usize, Vec<EffectShown>>,
    environment: Environment<'static>,
}

/// An effect of a robot's last night.
#[derive(Debug, Clone, Serialize)]
struct EffectShown {
    kind: String,
    place: String,
    parameter: String,
    value: String,
    unit: String,
    named: bool,
}

#[derive(Debug, Serialize)]
struct RobotShown<'a> {
    serial: &'a str,
    page: String,
    rms_mm: String,
    week_mm: String,
    date: String,
    spark: String,
}

/// A run that failed.
#[derive(Debug, Serialize)]
struct FailedShown<'a> {
    serial: &'a str,
    /// Where the robot has one.
    page: Option<String>,
    date: String,
    task: &'a str,
    error: &'a str,
}

#[derive(Debug, Serialize)]
struct NumberShown {
    name: String,
    value: String,
    std: String,
    unit: &'static str,
    shape: String,
    spark: String,
}

/// A name of a file for a serial: letters, digits, `-`, `_` and `.` stay, other bytes become `~` and two hexadecimal digits.
pub fn file_name(serial: &str) -> String {
    use std::fmt::Write as _;
    let mut name = String::new();
    for (index, byte) in serial.bytes().enumerate() {
        let plain = byte.is_ascii_alphanumeric() || byte == b'-' || byte == b'_' || (byte == b'.' && index > 0);
        if plain {
            name.push(char::from(byte));
        } else {
            let _ = write!(name, "~{byte:02x}");
        }
    }
    name + ".html"
}

impl<'a> Report<'a> {
    /// Reads the content of the pages other than the nights.
    ///
    /// # Errors
    /// A file of the store cannot be read.
    pub fn new(store: &Store, fleet: &'a Fleet, how: &Watch) -> Result<Self, FleetError> {
        let robot_of: HashMap<&str, usize> =
            fleet.last_keys.iter().enumerate().map(|(robot, key)| (key.as_str(), robot)).collect();
        let names = ["key", "kind", "place", "parameter", "value", "unit", "named"];
        let [key, kind, place, parameter, value, unit, named] = names.map(|name| EFFECTS.index(name));
        let mut effects: HashMap<usize, Vec<EffectShown>> = HashMap::new();
        store.each_group(&EFFECTS, &names, &mut |rows| {
            for row in rows {
                let Some(robot) = robot_of.get(row[key].text()) else { continue };
                effects.entry(*robot).or_default().push(EffectShown {
                    kind: row[kind].text().into(),
                    place: row[place].text().into(),
                    parameter: row[parameter].text().into(),
                    value: row[value].real().map_or_else(String::new, |value| format!("{value:.4e}")),
                    unit: row[unit].text().into(),
                    named: row[named].is_true(),
                });
            }
            Ok(())
        })?;
        let mut environment = Environment::new();
        environment.set_auto_escape_callback(|_| AutoEscape::Html);
        environment.add_global("style", Value::from_safe_string(include_str!("report/style.css").to_owned()));
        environment.add_template("fleet.html", include_str!("report/fleet.html"))?;
        environment.add_template("robot.html", include_str!("report/robot.html"))?;
        Ok(Self { fleet, said: fleet.watch(how), effects, environment })
    }

    /// The page of the fleet.
    ///
    /// # Errors
    /// The template and what it is given do not fit.
    pub fn fleet_page(&self) -> Result<String, FleetError> {
        let fleet = self.fleet;
        let robots: Vec<(RobotShown, f64, f64)> =
            (0..fleet.serials.len()).filter_map(|robot| self.robot_shown(robot)).collect();
        let mut worst: Vec<&(RobotShown, f64, f64)> = robots.iter().collect();
        worst.sort_by(|a, b| b.1.total_cmp(&a.1));
        let worst: Vec<&RobotShown> = worst.iter().take(LISTED).map(|robot| &robot.0).collect();
        let mut changed: Vec<&(RobotShown, f64, f64)> = robots.iter().filter(|robot| robot.2.is_finite()).collect();
        changed.sort_by(|a, b| b.2.abs().total_cmp(&a.2.abs()));
        let changed: Vec<&RobotShown> = changed.iter().take(LISTED).map(|robot| &robot.0).collect();
        let mut map: BTreeMap<&str, BTreeMap<&str, Vec<usize>>> = BTreeMap::new();
        for (robot, effects) in &self.effects.iter().collect::<BTreeMap<_, _>>() {
            for effect in effects.iter().filter(|effect| effect.named) {
                let robots = map.entry(effect.kind.as_str()).or_default().entry(effect.place.as_str()).or_default();
                if robots.last() != Some(*robot) {
                    robots.push(**robot);
                }
            }
        }
        let mut places: Vec<&str> = map.values().flat_map(BTreeMap::keys).copied().collect();
        places.sort_unstable();
        places.dedup();
        let most = map.values().flat_map(BTreeMap::values).map(Vec::len).max().unwrap_or(1);
        let effects: Vec<_> = map
            .iter()
            .map(|(kind, of)| {
                let count = |place: &&str| of.get(*place).map_or(0, Vec::len);
                let cells = places.iter().map(|place| {
                    let count = count(place);
                    context! { count, share => (100 * count).div_ceil(most) }
                });
                context! { kind => *kind, cells => cells.collect::<Vec<_>>() }
            })
            .collect();
        let alarms: Vec<_> = self.said.alarms.iter().map(|alarm| {
            let number = &fleet.numbers[alarm.number];
            context! {
                serial => fleet.serials[alarm.robot].as_str(), page => file_name(&fleet.serials[alarm.robot]), number => number.name(),
                change => shown(alarm.change, &number.unit), sigmas => format!("{:+.1}", alarm.sigmas),
                since => Day(alarm.since).to_string(),
            }
        }).collect();
        Ok(self.environment.get_template("fleet.html")?.render(context! {
            night => fleet.tonight().map(|day| day.to_string()), count => fleet.serials.len(), watched => self.said.watched,
            waiting => self.said.waiting, expected => format!("{:.1e}", self.said.expected_false), alarms,
            failed => Value::from(Serde(&self.failed(|_| true))),
            worst => Value::from(Serde(&worst)), changed => Value::from(Serde(&changed)),
            places => Value::from(Serde(&places)), effects, trend => self.trend(), robots => Value::from(Serde(robots.iter().map(|robot| &robot.0).collect::<Vec<_>>())),
        })?)
    }

    /// The page of a robot: its file's name and text.
    ///
    /// # Errors
    /// The template and what it is given do not fit.
    pub fn robot_page(&self, robot: usize) -> Result<(String, String), FleetError> {
        let fleet = self.fleet;
        let serial = &fleet.serials[robot];
        let histories = fleet.histories(robot, Watch::default().reference, [5e-4, 1e-3]);
        let numbers = (0..fleet.numbers.len()).filter_map(|number| {
            let points = fleet.points(robot, number);
            let last = points.last()?;
            let unit = &fleet.numbers[number].unit;
            let (factor, unit) = scaled(unit);
            let std = fleet.last[robot].get(number).copied().flatten().map(|(std, _)| format!("{:.4}", factor * std));
            let shape = histories.iter().find(|history| history.number == number).map_or_else(String::new, |history| {
                match history.shape {
                    Shape::Steady => String::new(),
                    Shape::Drift(drift) => format!("{:+.4} {unit} a week", factor * drift.per_week),
                    #[expect(clippy::cast_possible_truncation, reason = "days of some years")]
                    Shape::Step(step) => format!("{:+.4} {unit} on {}", factor * step.size, Day(step.day as i32)),
                }
            });
            Some(NumberShown {
                name: fleet.numbers[number].name(),
                value: format!("{:+.4}", factor * last.value),
                std: std.unwrap_or_default(),
                unit,
                shape,
                spark: plot::spark(&points),
            })
        });
        let numbers: Vec<NumberShown> = numbers.collect();
        let alarm = self.said.alarms.iter().find(|alarm| alarm.robot == robot).map(|alarm| {
            let number = &fleet.numbers[alarm.number];
            format!("{} has changed by {} since {}", number.name(), shown(alarm.change, &number.unit), Day(alarm.since))
        });
        let events = fleet.nights[robot].nights.iter().filter(|night| night.event);
        let failed = self.failed(|of| of == serial);
        let text = self.environment.get_template("robot.html")?.render(context! {
            serial, alarm, failed => Value::from(Serde(&failed)), numbers => Value::from(Serde(&numbers)), nights => fleet.nights[robot].nights.len(), effects => Value::from(Serde(self.effects.get(&robot))),
            events => events.map(|night| Day(night.day).to_string()).collect::<Vec<_>>(),
        })?;
        Ok((file_name(serial), text))
    }

    /// Runs that failed and have not succeeded since, of some robots.
    fn failed(&self, of: impl Fn(&str) -> bool) -> Vec<FailedShown<'_>> {
        let shown = |failure: &'a Failure| FailedShown {
            serial: &failure.slot.serial,
            page: self.fleet.serials.contains(&failure.slot.serial).then(|| file_name(&failure.slot.serial)),
            date: failure.slot.date.map_or_else(String::new, |day| day.to_string()),
            task: &failure.slot.task,
            error: &failure.error,
        };
        self.fleet.failed.iter().filter(|failure| of(&failure.slot.serial)).map(shown).collect()
    }

    fn robot_shown(&self, robot: usize) -> Option<(RobotShown<'_>, f64, f64)> {
        let points = self.rms(robot);
        let last = points.last()?;
        let before = points.iter().rev().find(|point| point.day <= last.day - f64::from(WEEK));
        let week = before.map_or(f64::NAN, |before| last.value - before.value);
        let serial = &self.fleet.serials[robot];
        let shown = RobotShown {
            serial,
            page: file_name(serial),
            rms_mm: format!("{:.4}", 1e3 * last.value),
            week_mm: before.map_or_else(String::new, |_| format!("{:+.4}", 1e3 * week)),
            date: self.fleet.nights[robot].nights.last().map_or_else(String::new, |night| Day(night.day).to_string()),
            spark: plot::spark(&points),
        };
        Some((shown, last.value, week))
    }

    fn rms(&self, robot: usize) -> Vec<crate::statistics::trend::Point> {
        let of = |number: &usize| self.fleet.numbers[*number].parameter == "rms";
        let all = (0..self.fleet.numbers.len()).filter(of).map(|number| self.fleet.points(robot, number));
        all.max_by_key(Vec::len).unwrap_or_default()
    }

    /// Median and ninth decile of the fleet's error, night by night.
    fn trend(&self) -> String {
        let mut by_day: BTreeMap<i32, Vec<f64>> = BTreeMap::new();
        for robot in 0..self.fleet.serials.len() {
            for point in self.rms(robot) {
                #[expect(clippy::cast_possible_truncation, reason = "it was a day")]
                by_day.entry(point.day as i32).or_default().push(1e3 * point.value);
            }
        }
        let of = |(day, mut values): (i32, Vec<f64>)| {
            let middle = median(&mut values);
            (f64::from(day), middle, values[(9 * values.len() / 10).min(values.len() - 1)])
        };
        plot::trend(&by_day.into_iter().map(of).collect::<Vec<_>>())
    }
}

fn scaled(unit: &str) -> (f64, &'static str) {
    match unit {
        "m" => (1e3, "mm"),
        "rad" => (1e3, "mrad"),
        "m/rad" => (1e3, "mm/rad"),
        _ => (1.0, ""),
    }
}

fn shown(value: f64, unit: &str) -> String {
    let (factor, unit) = scaled(unit);
    format!("{:+.4} {unit}", factor * value)
}
