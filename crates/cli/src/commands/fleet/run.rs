//! `denavit fleet run`: a manifest into a store.

use crate::args::FleetRunArguments;
use crate::delivery::Delivery;
use crate::failure::Failure;
use crate::output::Status;
use crate::progress::Bar;
use denavit_fleet::store::Store;
use denavit_fleet::{Outcome, RunOptions, Tally, manifest};
use serde::Serialize;
use std::fmt::Write as _;
use std::ops::ControlFlow;
use std::path::Path;
use std::sync::Mutex;

#[derive(Serialize)]
struct Answer<'a> {
    store: &'a Path,
    entries: usize,
    done: usize,
    known: usize,
    failed: usize,
    replaced: usize,
    failures: &'a [FailedEntry],
}

#[derive(Serialize)]
struct FailedEntry {
    serial: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    date: Option<String>,
    task: &'static str,
    error: String,
}

/// Failures shown on the terminal; the store has all.
const SHOWN: usize = 10;

pub fn run(arguments: &FleetRunArguments) -> Result<Status, Failure> {
    let delivery = Delivery::of(None, &arguments.json, [arguments.manifest.as_str()])?;
    let pair = |word: &String| {
        let split = word.split_once('=').map(|(name, value)| (name.to_owned(), value.to_owned()));
        split.ok_or_else(|| Failure::Argument(format!("--set: \"{word}\" is no WORD=VALUE, such as robot=arm.urdf")))
    };
    let defaults = arguments.set.iter().map(pair).collect::<Result<Vec<_>, _>>()?;
    let entries = manifest::read(&arguments.manifest, &defaults)?;
    let held = Store::hold(&arguments.output)?;
    let threads = arguments.threads.map_or_else(|| RunOptions::default().threads, usize::from);
    let bar = Bar::start(entries.len());
    let failures = Mutex::new(Vec::new());
    let tally = denavit_fleet::run(&entries, &held, RunOptions { threads }, &|entry, outcome| {
        bar.step(&entry.serial, *outcome == Outcome::Known);
        if let Outcome::Failed(error) = outcome {
            let date = entry.date.map(|day| day.to_string());
            let failed =
                FailedEntry { serial: entry.serial.clone(), date, task: entry.task.name(), error: error.clone() };
            failures.lock().expect("counting does not panic").push(failed);
        }
        ControlFlow::Continue(())
    })?;
    drop(bar);
    let mut failures = failures.into_inner().expect("counting does not panic");
    failures.sort_by(|a, b| (&a.serial, &a.date, a.task).cmp(&(&b.serial, &b.date, b.task)));
    let Tally { done, known, failed, replaced } = tally;
    let answer =
        Answer { store: &arguments.output, entries: entries.len(), done, known, failed, replaced, failures: &failures };
    let json = || Ok(super::super::stamped("denavit.fleet.run/1", &answer));
    delivery.deliver(|| Ok(text(&answer)), json)?;
    Ok(if failed > 0 { Status::Different } else { Status::Same })
}

fn text(answer: &Answer) -> String {
    let mut text = String::new();
    let Answer { store, entries, done, known, failed, replaced, failures } = answer;
    let _ =
        writeln!(text, "{entries} entries: {done} done now, {known} were there, {failed} failed → {}", store.display());
    if *replaced > 0 {
        let _ = writeln!(text, "{replaced} runs of older inputs or options were replaced");
    }
    for failed in failures.iter().take(SHOWN) {
        let date = failed.date.as_ref().map_or_else(String::new, |date| format!(" {date}"));
        let first = failed.error.lines().next().unwrap_or_default();
        let _ = writeln!(text, "  {}{date} {}: {first}", failed.serial, failed.task);
    }
    if failures.len() > SHOWN {
        let _ = writeln!(text, "  … and {} more, in {}/runs", failures.len() - SHOWN, store.display());
    }
    text
}
