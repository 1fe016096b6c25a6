//! How near planes and dial gauges come to the Cramér-Rao bound: prints the table of docs/without-an-instrument.md.

#![allow(clippy::unwrap_used, clippy::print_stdout)] // A study prints its table.

#[path = "../tests/webcam/mod.rs"]
#[allow(dead_code, reason = "the study of cameras needs the rest")]
mod webcam;

use denavit_calibrate::apply::simulate::SimulationOptions;
use denavit_calibrate::observation::kinds::{DIAL, PLANE};

const RUNS: u64 = 100;

fn main() {
    println!("| measured | readings | runs | error of predicted heights / Cramér-Rao bound |\n|---|---|---|---|");
    for (kind, word) in [(PLANE, "a ball on three planes"), (DIAL, "a dial gauge on three plates")] {
        for rows in [150, 300] {
            let options = SimulationOptions { kind, rows, noise_position: 1e-5, ..SimulationOptions::default() };
            let ratio = webcam::efficiency_of(&webcam::panda(), &options, |_, options| options.noise_position, 0..RUNS);
            println!("| {word} | {rows} | {RUNS} | {ratio:.3} |");
        }
    }
}
