//! `denavit fleet watch`: the nightly job, and `denavit fleet history`: what became of a robot.

use crate::args::{FleetHistoryArguments, FleetWatchArguments};
use crate::delivery::Delivery;
use crate::failure::Failure;
use crate::output::{Outputs, Status};
use denavit_compare::report::junit::{self, Case, CaseFailure};
use denavit_fleet::Day;
use denavit_fleet::nights::{Fleet, History};
use denavit_fleet::statistics::trend::Shape;
use denavit_fleet::statistics::vigil::{Alarm, Said, Watch};
use denavit_fleet::store::Store;
use serde::Serialize;
use std::fmt::Write as _;

#[derive(Serialize)]
struct WatchAnswer {
    night: Option<String>,
    watched: usize,
    waiting: usize,
    marked: Vec<String>,
    false_alarms_expected: f64,
    false_discovery_rate: f64,
    alarms: Vec<AlarmEntry>,
    failed: Vec<FailedRun>,
}

/// A run that failed and has not succeeded since.
#[derive(Serialize)]
struct FailedRun {
    serial: String,
    date: Option<String>,
    task: String,
    error: String,
}

impl FailedRun {
    fn of(fleet: &Fleet, counts: impl Fn(&str) -> bool) -> Vec<Self> {
        let failed = fleet.failed.iter().filter(|failure| counts(&failure.slot.serial));
        let of = |failure: &denavit_fleet::store::Failure| Self {
            serial: failure.slot.serial.clone(),
            date: failure.slot.date.map(|day| day.to_string()),
            task: failure.slot.task.clone(),
            error: failure.error.clone(),
        };
        failed.map(of).collect()
    }

    /// `2026-01-02 calibrate: why`.
    fn line(&self) -> String {
        let date = self.date.as_ref().map_or_else(String::new, |date| format!("{date} "));
        format!("{date}{}: {}", self.task, self.error.lines().next().unwrap_or("no reason is stored"))
    }
}

#[derive(Serialize)]
struct AlarmEntry {
    serial: String,
    parameter: String,
    change: f64,
    unit: String,
    sigmas: f64,
    p_value: f64,
    since: String,
    message: String,
}

pub fn watch(arguments: &FleetWatchArguments) -> Result<Status, Failure> {
    let delivery = Delivery::of(None, &arguments.json, [])?;
    let mut files = Outputs::beside([]);
    let junit = files.add_if("--junit", arguments.junit.as_deref())?;
    let markdown = files.add_if("--markdown", arguments.markdown.as_deref())?;
    let fleet = Fleet::read(&Store::open(&arguments.store)?)?;
    let how = Watch { rate: arguments.rate, reference: usize::from(arguments.reference), ..Watch::default() };
    let said = fleet.watch(&how);
    let answer = answer(&fleet, &said, &how);
    let mut texts = Vec::new();
    if let Some(slot) = junit {
        texts.push((slot, junit_text(&fleet, &said, &answer)));
    }
    if let Some(slot) = markdown {
        texts.push((slot, markdown_text(&answer)));
    }
    files.write(&texts)?;
    let json = || Ok(super::super::stamped("denavit.fleet.watch/1", &answer));
    delivery.deliver(|| Ok(text(&answer)), json)?;
    Ok(if answer.alarms.is_empty() && answer.failed.is_empty() { Status::Same } else { Status::Different })
}

fn answer(fleet: &Fleet, said: &Said, how: &Watch) -> WatchAnswer {
    WatchAnswer {
        night: fleet.tonight().map(|day| day.to_string()),
        watched: said.watched,
        waiting: said.waiting,
        marked: said.marked.iter().map(|robot| fleet.serials[*robot].clone()).collect(),
        false_alarms_expected: said.expected_false,
        false_discovery_rate: how.rate,
        alarms: said.alarms.iter().map(|alarm| alarm_entry(fleet, alarm)).collect(),
        failed: FailedRun::of(fleet, |_| true),
    }
}

fn alarm_entry(fleet: &Fleet, alarm: &Alarm) -> AlarmEntry {
    let number = &fleet.numbers[alarm.number];
    let (serial, parameter) = (fleet.serials[alarm.robot].clone(), number.name());
    let since = Day(alarm.since).to_string();
    let message = format!(
        "{serial}: {parameter} has changed by {} ({:+.1} σ of a night), seen since {since}",
        shown(alarm.change, &number.unit),
        alarm.sigmas
    );
    let Alarm { change, sigmas, p_value, .. } = *alarm;
    AlarmEntry { serial, parameter, change, unit: number.unit.clone(), sigmas, p_value, since, message }
}

/// A number for people: mm and mrad.
pub(super) fn shown(value: f64, unit: &str) -> String {
    match unit {
        "m" => format!("{:+.4} mm", 1e3 * value),
        "rad" => format!("{:+.4} mrad", 1e3 * value),
        other => format!("{value:+.3e} {other}"),
    }
}

fn text(answer: &WatchAnswer) -> String {
    let mut text = String::new();
    let night = answer.night.as_deref().unwrap_or("no night");
    let _ = writeln!(text, "{night}: {} robots watched, {} wait for a reference", answer.watched, answer.waiting);
    for alarm in &answer.alarms {
        let _ = writeln!(text, "ALARM {}", alarm.message);
    }
    for failed in &answer.failed {
        let _ = writeln!(text, "FAILED {} {}", failed.serial, failed.line());
    }
    let fresh =
        answer.marked.iter().filter(|serial| !answer.alarms.iter().any(|alarm| alarm.serial == **serial)).count();
    let _ =
        writeln!(text, "{} alarms; {fresh} robots marked tonight, an alarm needs a second mark", answer.alarms.len());
    let _ = writeln!(
        text,
        "false discovery rate of a night's marks: {}; expected in a healthy fleet: {:.1e} false alarms a night",
        answer.false_discovery_rate, answer.false_alarms_expected
    );
    text
}

fn markdown_text(answer: &WatchAnswer) -> String {
    let mut text = format!("## Fleet, night of {}\n\n", answer.night.as_deref().unwrap_or("none"));
    if answer.alarms.is_empty() {
        let _ = writeln!(text, "No alarm among the {} robots that were tested.", answer.watched);
    } else {
        text.push_str("| robot | parameter | change | σ | since |\n|---|---|---|---|---|\n");
        for alarm in &answer.alarms {
            let change = shown(alarm.change, &alarm.unit);
            let (serial, parameter) = (alarm.serial.replace('|', "\\|"), alarm.parameter.replace('|', "\\|"));
            let _ = writeln!(text, "| {serial} | {parameter} | {change} | {:+.1} | {} |", alarm.sigmas, alarm.since);
        }
    }
    if answer.waiting > 0 {
        let _ = writeln!(text, "\nNot tested: {} robots, which wait for a reference.", answer.waiting);
    }
    if !answer.failed.is_empty() {
        text.push_str("\nFailed; the next run repeats them:\n\n| robot | run |\n|---|---|\n");
        for failed in &answer.failed {
            let (serial, line) = (failed.serial.replace('|', "\\|"), failed.line().replace('|', "\\|"));
            let _ = writeln!(text, "| {serial} | {line} |");
        }
    }
    let _ = write!(text, "\nExpected in a healthy fleet: {:.1e} false alarms a night.\n", answer.false_alarms_expected);
    text
}

/// A case for each robot that was measured tonight, and one for each run that failed.
fn junit_text(fleet: &Fleet, said: &Said, answer: &WatchAnswer) -> String {
    let tonight = fleet.tonight().map(|day| day.0);
    let there = fleet.serials.iter().zip(&fleet.nights).enumerate();
    let there = there.filter(|(_, (_, nights))| nights.nights.last().map(|night| night.day) == tonight);
    let mut cases: Vec<Case> = there
        .map(|(robot, (serial, _))| {
            let alarms: Vec<&str> =
                answer.alarms.iter().filter(|alarm| alarm.serial == *serial).map(|alarm| &alarm.message[..]).collect();
            let failure = alarms.first().map(|&first| CaseFailure { message: first.into(), text: alarms.join("\n") });
            let skipped = (!said.tested.contains(&robot))
                .then(|| "not tested: this robot, or the whole fleet, has too few nights for a reference".to_owned());
            Case { class: "denavit.fleet".into(), name: serial.clone(), failure, skipped }
        })
        .collect();
    cases.extend(answer.failed.iter().map(|failed| {
        let failure = Some(CaseFailure { message: failed.line(), text: failed.error.clone() });
        Case { class: "denavit.fleet.failed".into(), name: failed.serial.clone(), failure, skipped: None }
    }));
    junit::suite("denavit fleet watch", &cases)
}

#[derive(Serialize)]
struct HistoryAnswer {
    robots: Vec<RobotHistory>,
}

#[derive(Serialize)]
struct RobotHistory {
    serial: String,
    nights: usize,
    changes: Vec<ChangeEntry>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    failed: Vec<FailedRun>,
}

#[derive(Serialize)]
struct ChangeEntry {
    parameter: String,
    unit: String,
    shape: &'static str,
    per_week: Option<f64>,
    step: Option<f64>,
    half_interval_95: f64,
    date: Option<String>,
    event: Option<bool>,
    crosses: Option<String>,
    crosses_earliest: Option<String>,
    crosses_latest: Option<String>,
    message: String,
}

pub fn history(arguments: &FleetHistoryArguments) -> Result<Status, Failure> {
    let delivery = Delivery::of(None, &arguments.json, [])?;
    let fleet = Fleet::read(&Store::open(&arguments.store)?)?;
    let chosen: Vec<usize> = match &arguments.serial {
        None => (0..fleet.serials.len()).collect(),
        Some(serial) => {
            let at = fleet.serials.iter().position(|known| known == serial);
            vec![at.ok_or_else(|| {
                let store = arguments.store.display();
                Failure::Argument(format!("{store}: no robot \"{serial}\" was calibrated with a date"))
            })?]
        }
    };
    let tolerances = [arguments.tolerance_m, arguments.tolerance_rad];
    let robots = chosen.into_iter().map(|robot| {
        let changes = fleet.histories(robot, Watch::default().reference, tolerances);
        RobotHistory {
            serial: fleet.serials[robot].clone(),
            nights: fleet.nights[robot].nights.len(),
            changes: changes.iter().map(|history| change_entry(&fleet, history)).collect(),
            failed: FailedRun::of(&fleet, |serial| serial == fleet.serials[robot]),
        }
    });
    let answer = HistoryAnswer { robots: robots.collect() };
    let json = || Ok(super::super::stamped("denavit.fleet.robots/1", &answer));
    delivery.deliver(|| Ok(history_text(&answer)), json)?;
    Ok(Status::Same)
}

#[expect(clippy::cast_possible_truncation, reason = "days of some years")]
fn day(day: f64) -> String {
    Day(day.round() as i32).to_string()
}

fn change_entry(fleet: &Fleet, history: &History) -> ChangeEntry {
    let number = &fleet.numbers[history.number];
    let (parameter, unit) = (number.name(), number.unit.clone());
    let mut entry = ChangeEntry {
        shape: "drift",
        per_week: None,
        step: None,
        half_interval_95: 0.0,
        date: None,
        event: None,
        crosses: None,
        crosses_earliest: None,
        crosses_latest: None,
        message: String::new(),
        parameter,
        unit,
    };
    match history.shape {
        Shape::Steady => {}
        Shape::Drift(drift) => {
            (entry.per_week, entry.half_interval_95) = (Some(drift.per_week), drift.half_interval_95);
            let half = shown(drift.half_interval_95, &entry.unit);
            let mut message =
                format!("{} drifts by {} ± {} a week", entry.parameter, shown(drift.per_week, &entry.unit), &half[1..]);
            if let Some(when) = history.crossing {
                entry.crosses = Some(day(when.day));
                entry.crosses_earliest = Some(day(when.earliest));
                entry.crosses_latest = when.latest.map(day);
                let latest = entry.crosses_latest.as_deref().unwrap_or("perhaps never");
                let _ =
                    write!(message, "; leaves the tolerance on {} ({} to {latest})", day(when.day), day(when.earliest));
            }
            entry.message = message;
        }
        Shape::Step(step) => {
            entry.shape = "step";
            (entry.step, entry.half_interval_95) = (Some(step.size), step.half_interval_95);
            (entry.date, entry.event) = (Some(day(step.day)), Some(step.event));
            let half = shown(step.half_interval_95, &entry.unit);
            let why = if step.event { "with an event on record" } else { "without an event on record" };
            entry.message = format!(
                "{} stepped by {} ± {} on {}, {why}",
                entry.parameter,
                shown(step.size, &entry.unit),
                &half[1..],
                day(step.day)
            );
        }
    }
    entry
}

fn history_text(answer: &HistoryAnswer) -> String {
    let mut text = String::new();
    let mut steady = 0;
    for robot in &answer.robots {
        if robot.changes.is_empty() && robot.failed.is_empty() && answer.robots.len() > 1 {
            steady += 1;
            continue;
        }
        let _ = writeln!(text, "{}, {} nights", robot.serial, robot.nights);
        for change in &robot.changes {
            let _ = writeln!(text, "  {}", change.message);
        }
        for failed in &robot.failed {
            let _ = writeln!(text, "  failed: {}", failed.line());
        }
        if robot.changes.is_empty() {
            let _ = writeln!(text, "  no parameter has changed");
        }
    }
    if steady > 0 {
        let _ = writeln!(text, "{steady} robots: no parameter has changed");
    }
    text
}
