//! How near planes, dial gauges and hands that touch each other come to the Cramér-Rao bound: prints the tables of
//! docs/without-an-instrument.md.

#![allow(clippy::unwrap_used, clippy::print_stdout)] // A study prints its table.

#[path = "../tests/webcam/mod.rs"]
#[allow(dead_code, reason = "the study of cameras needs the rest")]
mod webcam;

#[path = "../tests/hands/mod.rs"]
mod hands;
#[path = "../tests/postures/mod.rs"]
mod postures;

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
    println!(
        "\n| touches of both hands | runs | as drawn, mm | fitted | plain least squares | fitted over the bound |\n|---|---|---|---|---|---|"
    );
    for rows in [20, 40, 80] {
        let [drawn, fitted, plain, bound] = hands::errors(rows, 0..RUNS);
        let [fitted_mm, plain, drawn] = [fitted, plain, drawn].map(|error| error * 1e3);
        println!("| {rows} | {RUNS} | {drawn:.2} | {fitted_mm:.3} | {plain:.3} | {:.3} |", fitted / bound);
    }
}
