//! `denavit fleet corpus`: thousands of files, or a history.

use crate::args::FleetCorpusArguments;
use crate::delivery::Delivery;
use crate::failure::Failure;
use crate::output::Status;
use crate::progress::Bar;
use denavit_fleet::corpus::{Became, Corpus, CorpusOptions, GitChange, changes, corpus, robots_in};
use serde::Serialize;
use std::fmt::Write as _;
use std::path::Path;

#[derive(Serialize)]
struct Answer<'a> {
    changes: &'a [GitChange],
}

/// Lines of each part on the terminal; the JSON has all.
const SHOWN: usize = 20;

pub fn run(arguments: &FleetCorpusArguments) -> Result<Status, Failure> {
    let delivery = Delivery::of(None, &arguments.json, [])?;
    let default = CorpusOptions::default();
    let options = CorpusOptions {
        same: arguments.tolerance,
        near: arguments.near,
        threads: arguments.threads.map_or(default.threads, usize::from),
    };
    if let Some(repository) = arguments.corpus.strip_prefix("git:") {
        let found = changes(Path::new(repository), &arguments.revision, &options)?;
        let json = || Ok(super::super::stamped("denavit.fleet.history/1", &Answer { changes: &found }));
        delivery.deliver(|| Ok(history_text(&found)), json)?;
        return Ok(Status::Same);
    }
    let names = robots_in(Path::new(&arguments.corpus))?;
    let bar = Bar::start(names.len());
    let found = corpus(&names, &options, &|name| bar.step(name, false))?;
    drop(bar);
    delivery.deliver(|| Ok(text(&found)), || Ok(super::super::stamped("denavit.fleet.corpus/1", &found)))?;
    Ok(Status::Same)
}

fn more(text: &mut String, count: usize) {
    if count > SHOWN {
        let _ = writeln!(text, "  … and {} more; --json has all", count - SHOWN);
    }
}

fn text(corpus: &Corpus) -> String {
    let Corpus { files, mechanisms, near } = corpus;
    let mut text = String::new();
    let bad: Vec<_> = files.iter().filter(|file| file.error.is_some()).collect();
    let failing = files.iter().filter(|file| file.findings.errors > 0).count();
    let _ = writeln!(
        text,
        "{} files: {} robots that move, {} mechanisms, {} without a robot, {failing} that certainly break a rule",
        files.len(),
        mechanisms.iter().map(Vec::len).sum::<usize>(),
        mechanisms.len(),
        bad.len(),
    );
    let several: Vec<_> = mechanisms.iter().filter(|set| set.len() > 1).collect();
    if !several.is_empty() {
        let _ = writeln!(text, "\nfiles with the same mechanism");
    }
    for set in several.iter().take(SHOWN) {
        let first = &files[set[0]];
        let _ = writeln!(text, "  {} files, {}, {:.3} m", set.len(), first.chain, first.size_m);
        for file in *set {
            let _ = writeln!(text, "    {}", files[*file].file);
        }
    }
    more(&mut text, several.len());
    if !near.is_empty() {
        let _ = writeln!(text, "\nmechanisms that are nearly alike, and the largest distance of their tips");
    }
    for set in near.iter().take(SHOWN) {
        let _ = writeln!(text, "  {:.3} mm", 1e3 * set.tips_apart_m);
        for mechanism in &set.mechanisms {
            let _ = writeln!(text, "    {}", files[mechanisms[*mechanism][0]].file);
        }
    }
    more(&mut text, near.len());
    if !bad.is_empty() {
        let _ = writeln!(text, "\nfiles without a robot");
    }
    for file in bad.iter().take(SHOWN) {
        let error = file.error.as_deref().unwrap_or_default();
        let _ = writeln!(text, "  {}: {}", file.file, error.lines().next().unwrap_or_default());
    }
    more(&mut text, bad.len());
    text
}

fn history_text(changes: &[GitChange]) -> String {
    let mut text = String::new();
    let mut last = "";
    for change in changes.iter().filter(|change| change.became != Became::Same) {
        if change.commit != last {
            let _ =
                writeln!(text, "{} {} {}", &change.commit[..10.min(change.commit.len())], change.date, change.subject);
            last = &change.commit;
        }
        let became = match change.became {
            Became::New => "new",
            Became::Removed => "removed",
            Became::Motion => "moves otherwise",
            Became::Matter => "same motion, other masses or shapes",
            Became::Same => "the same",
            Became::Unreadable => "not a robot before or after",
        };
        let _ = writeln!(text, "  {}: {became}", change.path);
    }
    let same = changes.iter().filter(|change| change.became == Became::Same).count();
    let _ = writeln!(text, "{} changes of robot files, {same} of them without effect on the robot", changes.len());
    text
}
