//! Runs every entry of a manifest into a store, and prints what failed: `fleet_run MANIFEST STORE`.

use denavit_fleet::store::Store;
use denavit_fleet::{RunOptions, manifest, run};
use std::ops::ControlFlow;
use std::path::Path;

#[expect(clippy::print_stdout, reason = "this is a program")]
fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut words = std::env::args().skip(1);
    let (Some(file), Some(folder)) = (words.next(), words.next()) else {
        return Err("usage: fleet_run MANIFEST STORE".into());
    };
    let entries = manifest::read(&file, &[])?;
    let held = Store::hold(Path::new(&folder))?;
    let report = run(&entries, &held, &RunOptions::default(), &|entry, outcome| {
        println!("{} {}: {outcome:?}", entry.serial, entry.task.name());
        ControlFlow::Continue(())
    })?;
    println!("{} computed, {} known, {} failed", report.done, report.known, report.failed);
    Ok(())
}
