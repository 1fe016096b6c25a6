//! The nightly watch: which of thousands of robots have changed, tested every night.
//!
//! 1. A robot's first nights are its reference, with a new one after each event on record. A night's number is compared with
//!    the mean of the reference; the scatter from night to night is learned from the whole fleet ([`super::scatter`]).
//! 2. A robot's p-value of a night is its smallest, times the count of its numbers (Bonferroni: numbers of one calibration
//!    depend on each other).
//! 3. Benjamini and Hochberg's rule marks discoveries among the robots of a night.
//! 4. A robot that is marked again raises an alarm: in two of its last three nights, including tonight, by the same number
//!    in the same direction.
//! 5. With heavy tails a single night must deviate far to be significant. A lasting change therefore also raises an alarm:
//!    by the median of the last nights and the median of as many before them (`lasting`).

use super::false_discovery::discoveries;
use super::lasting::{self, Limit, both_beyond};
use super::scatter::Scatter;
use statrs::distribution::{ContinuousCDF as _, Normal};
use std::collections::{BTreeMap, BTreeSet};

/// To learn the scatter, a night is compared with the mean of at least this many nights before it.
const LEAST_BEFORE: usize = 3;

/// Nights of one robot.
#[derive(Debug, Clone, Default)]
pub struct Nights {
    /// In order of their days.
    pub nights: Vec<Night>,
}

/// One night of one robot.
#[derive(Debug, Clone)]
pub struct Night {
    /// Counted from an arbitrary day.
    pub day: i32,
    /// Whether an event happened before it, so that a new reference begins.
    pub event: bool,
    /// The robot's numbers, in an order that all robots share; `None`: not found this night.
    pub values: Vec<Option<f64>>,
}

/// Options of the watch.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Watch {
    /// False discovery rate over the robots of a night.
    pub rate: f64,
    /// Nights of the reference.
    pub reference: usize,
    /// Marked in this many …
    pub marked: usize,
    /// … of its last nights.
    pub of_last: usize,
    /// Nights of each of the two consecutive medians that detect a lasting change.
    pub lasting: usize,
    /// Allowed false alarms per night of a healthy fleet by lasting changes.
    pub lasting_rate: f64,
}

impl Default for Watch {
    fn default() -> Self {
        Self { rate: 0.05, reference: 8, marked: 2, of_last: 3, lasting: 5, lasting_rate: 1e-4 }
    }
}

/// A robot that has changed.
#[derive(Debug, Clone, PartialEq)]
pub struct Alarm {
    /// Which robot.
    pub robot: usize,
    /// Which of its numbers, by the smallest p-value tonight.
    pub number: usize,
    /// Tonight's value minus the reference's mean.
    pub change: f64,
    /// The same in units of its scatter.
    pub sigmas: f64,
    /// Tonight's p-value of the robot, corrected for all its numbers.
    pub p_value: f64,
    /// Day of the first of the marks.
    pub since: i32,
}

/// The result of one night's watch.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Said {
    /// Robots that were measured and have a reference.
    pub watched: usize,
    /// Robots that were measured, but without enough nights for a reference.
    pub waiting: usize,
    /// Robots that were tested tonight, in order; those that were measured and are not among them were not tested.
    pub tested: Vec<usize>,
    /// Marked tonight, by robot: not alarms yet.
    pub marked: Vec<usize>,
    /// Alarms, the most significant first.
    pub alarms: Vec<Alarm>,
    /// Expected false alarms of such a night if every robot is healthy.
    pub expected_false: f64,
}

/// Scatter of each number over the fleet; `None` where a number does not scatter or is too rare.
#[derive(Debug, Clone, PartialEq)]
pub struct Scatters {
    /// Of a night, about the mean of those before it.
    pub nights: Vec<Option<Scatter>>,
    /// Of the median of some nights, about the median of a reference before them.
    pub medians: Vec<Option<Scatter>>,
}

/// Learns how each number scatters.
///
/// Every night is compared with the mean of the nights just before it, so that a slow change hardly widens the interval.
pub fn scatters(robots: &[Nights], numbers: usize, how: &Watch) -> Scatters {
    let of = |number: usize| {
        let mut deviations = Vec::new();
        for robot in robots {
            let mut before: Vec<f64> = Vec::new();
            for night in &robot.nights {
                if night.event {
                    before.clear();
                }
                let Some(Some(value)) = night.values.get(number) else { continue };
                let last = &before[before.len().saturating_sub(how.reference)..];
                if last.len() >= LEAST_BEFORE {
                    let count = last.len() as f64;
                    deviations.push((value - last.iter().sum::<f64>() / count) / (1.0 + 1.0 / count).sqrt());
                }
                before.push(*value);
            }
        }
        Scatter::of(&deviations)
    };
    let medians = |number: usize| Scatter::of(&lasting::deviations(robots, number, how));
    Scatters { nights: (0..numbers).map(of).collect(), medians: (0..numbers).map(medians).collect() }
}

/// One robot's test of one night.
struct Test {
    number: usize,
    change: f64,
    sigmas: f64,
    p_value: f64,
}

/// The watch of the last night of the fleet.
pub fn watch(robots: &[Nights], numbers: usize, how: &Watch) -> Said {
    let scatters = scatters(robots, numbers, how);
    let Some(tonight) = robots.iter().filter_map(|robot| Some(robot.nights.last()?.day)).max() else {
        return Said::default();
    };
    watch_of(robots, &scatters, tonight, how)
}

/// The watch of one night, with the learned scatter.
pub fn watch_of(robots: &[Nights], scatters: &Scatters, tonight: i32, how: &Watch) -> Said {
    // The last nights of each robot that is there tonight: what is marked in any of them.
    let mut by_day: BTreeMap<i32, Vec<(usize, Test)>> = BTreeMap::new();
    let (mut waiting, mut changed) = (0, Vec::new());
    for (index, robot) in robots.iter().enumerate() {
        let until = robot.nights.partition_point(|night| night.day <= tonight);
        let nights = &robot.nights[..until];
        if nights.last().is_none_or(|night| night.day != tonight) {
            continue;
        }
        let from = nights.iter().rposition(|night| night.event).unwrap_or(0);
        let nights = &nights[from..];
        if nights.len() <= how.reference {
            waiting += 1;
            continue;
        }
        let (reference, others) = nights.split_at(how.reference);
        changed.extend(lasting::test(reference, others, scatters, how).map(|test| (index, test)));
        for night in &others[others.len().saturating_sub(how.of_last)..] {
            if let Some(test) = test(reference, night, &scatters.nights) {
                by_day.entry(night.day).or_default().push((index, test));
            }
        }
    }
    let mut marks: BTreeMap<usize, Vec<(i32, &Test)>> = BTreeMap::new();
    let mut said = Said { waiting, ..Said::default() };
    for (day, tests) in &by_day {
        let p_values: Vec<f64> = tests.iter().map(|(_, test)| test.p_value).collect();
        for ((robot, test), found) in tests.iter().zip(discoveries(&p_values, how.rate)) {
            if found {
                marks.entry(*robot).or_default().push((*day, test));
                if *day == tonight {
                    said.marked.push(*robot);
                }
            }
        }
    }
    let watched: BTreeSet<usize> = by_day.get(&tonight).into_iter().flatten().map(|(robot, _)| *robot).collect();
    said.watched = watched.len();
    said.tested = watched.into_iter().collect();
    for (robot, marks) in marks {
        let Some((_, now)) = marks.last().filter(|(day, _)| *day == tonight) else { continue };
        let alike = |test: &Test| test.number == now.number && (test.change > 0.0) == (now.change > 0.0);
        let again: Vec<i32> = marks.iter().filter(|(_, test)| alike(test)).map(|(day, _)| *day).collect();
        if again.len() >= how.marked {
            let Test { number, change, sigmas, p_value } = **now;
            said.alarms.push(Alarm { robot, number, change, sigmas, p_value, since: again[0] });
        }
    }
    let numbers = scatters.nights.iter().flatten().count();
    let limit = Limit::of(said.watched, numbers, how);
    for (robot, test) in changed {
        if limit.is_passed_by(test.p_value) && !said.alarms.iter().any(|alarm| alarm.robot == robot) {
            let lasting::Test { number, change, sigmas, since, .. } = test;
            let p_value = limit.p_value(test.p_value, numbers);
            said.alarms.push(Alarm { robot, number, change, sigmas, p_value, since });
        }
    }
    said.alarms.sort_by(|a, b| a.p_value.total_cmp(&b.p_value).then(b.sigmas.total_cmp(&a.sigmas)));
    said.expected_false = expected_false(said.watched, numbers, how) + limit.expected_false;
    said
}

fn test(reference: &[Night], night: &Night, scatters: &[Option<Scatter>]) -> Option<Test> {
    let mut best: Option<Test> = None;
    let mut count = 0;
    for (number, scatter) in scatters.iter().enumerate() {
        let (Some(scatter), Some(Some(value))) = (scatter, night.values.get(number)) else { continue };
        let known: Vec<f64> = reference.iter().filter_map(|night| *night.values.get(number)?).collect();
        // A number that was not found in most of the reference has none.
        if 2 * known.len() < reference.len() || known.len() < 2 {
            continue;
        }
        count += 1;
        let change = value - known.iter().sum::<f64>() / known.len() as f64;
        let spread = (1.0 + 1.0 / known.len() as f64).sqrt();
        let p_value = scatter.p_value(change, spread);
        if best.as_ref().is_none_or(|best| p_value < best.p_value) {
            best = Some(Test { number, change, sigmas: change / (scatter.scale * spread), p_value });
        }
    }
    best.map(|best| Test { p_value: (best.p_value * f64::from(count)).min(1.0), ..best })
}

/// False alarms per night of a healthy fleet by single marked nights.
///
/// If all are healthy, the rule marks as if each number were tested at rate / (robots · numbers). An alarm needs the same
/// number on the same side again; two nights share the mean of the reference, so they have correlation
/// 1 / (reference + 1). The bivariate normal probability is integrated over the shared part.
pub fn expected_false(robots: usize, numbers: usize, how: &Watch) -> f64 {
    if robots == 0 || numbers == 0 {
        return 0.0;
    }
    let each = how.rate / (robots * numbers) as f64;
    if how.marked <= 1 {
        return how.rate;
    }
    let limit = Normal::new(0.0, 1.0).expect("a standard deviation of 1").inverse_cdf(1.0 - each / 2.0);
    let shared = 1.0 / (how.reference as f64 + 1.0);
    // Tonight, and at least `marked` - 1 of the nights before.
    let again = i32::try_from(how.marked - 1).unwrap_or(1);
    let tries = (how.of_last.saturating_sub(1) as f64).powi(again);
    2.0 * tries * both_beyond(limit, shared, 1 + again) * (robots * numbers) as f64
}
