//! `denavit fleet run`: a manifest into a store.

use crate::args::FleetRunArguments;
use crate::delivery::Delivery;
use crate::failure::Failure;
use crate::output::Status;
use crate::progress::Bar;
use denavit_fleet::store::Store;
use denavit_fleet::{Outcome, RunOptions, RunReport, manifest};
use std::fmt::Write as _;
use std::ops::ControlFlow;

/// Failures shown on the terminal; the store has all.
const SHOWN: usize = 10;

pub fn run(arguments: &FleetRunArguments) -> Result<Status, Failure> {
    let delivery = Delivery::of(None, &arguments.json, [arguments.manifest.as_str()])?;
    let pair = |word: &String| {
        let split = word.split_once('=').map(|(name, value)| (name.to_owned(), value.to_owned()));
        split.ok_or_else(|| Failure::Argument(format!("--set: \"{word}\" is not WORD=VALUE, such as robot=arm.urdf")))
    };
    let defaults = arguments.set.iter().map(pair).collect::<Result<Vec<_>, _>>()?;
    let entries = manifest::read(&arguments.manifest, &defaults)?;
    let held = Store::hold(&arguments.output)?;
    let threads = arguments.threads.map_or_else(|| RunOptions::default().threads, usize::from);
    let bar = Bar::start(entries.len());
    let options = RunOptions { threads, ..RunOptions::default() };
    let answer = denavit_fleet::run(&entries, &held, &options, &|entry, outcome| {
        bar.step(&entry.serial, *outcome == Outcome::Known);
        ControlFlow::Continue(())
    })?;
    drop(bar);
    let json = || Ok(super::super::stamped("denavit.fleet.run/1", &answer));
    delivery.deliver(|| Ok(text(&answer)), json)?;
    Ok(if answer.failed > 0 { Status::Different } else { Status::Same })
}

fn text(answer: &RunReport) -> String {
    let mut text = String::new();
    let RunReport { store, entries, done, known, failed, replaced, failures } = answer;
    let _ = writeln!(
        text,
        "{entries} entries: {done} done now, {known} done before, {failed} failed → {}",
        store.display()
    );
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
