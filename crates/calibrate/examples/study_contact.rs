//! Errors relative to the Cramér-Rao bound for planes, dial gauges, hands that touch each other or hold a tool, and gravity sensors:
//! prints the tables of docs/without-an-instrument.md.

#![allow(clippy::unwrap_used, clippy::print_stdout)] // A study prints its table.

#[path = "../tests/webcam/mod.rs"]
#[allow(dead_code, reason = "the study of cameras needs the rest")]
mod webcam;

#[path = "../tests/hands/mod.rs"]
mod hands;

use denavit_identify::simulate::SimulationOptions;
use denavit_measurements::kinds::ObservationKind;

const RUNS: u64 = 100;
/// Fewer runs, because they take long: each grip has a frame of its own.
const GRIPS: u64 = 24;

fn main() {
    println!("| measured | readings | runs | error of predicted heights / Cramér-Rao bound |\n|---|---|---|---|");
    for (kind, word) in
        [(ObservationKind::Plane, "a ball on three planes"), (ObservationKind::Dial, "a dial gauge on three plates")]
    {
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
    println!("\n95 % intervals of 40 touches that contain the truth: {:.3}", hands::covered(40, 0..RUNS));
    println!(
        "\n| grips of a tool | runs | as drawn, mm and mrad | fitted | fitted over the bound | truth in 95 % intervals |\n|---|---|---|---|---|---|"
    );
    for rows in [20, 40] {
        let ([drawn, fitted, bound], inside) = hands::grip_errors(rows, 0..GRIPS);
        let pair = |[place, turn]: [f64; 2]| format!("{:.3}, {:.3}", place * 1e3, turn * 1e3);
        let over = [fitted[0] / bound[0] * 1e-3, fitted[1] / bound[1] * 1e-3];
        println!("| {rows} | {GRIPS} | {} | {} | {} | {inside:.3} |", pair(drawn), pair(fitted), pair(over));
    }
    println!(
        "\n| sensor of gravity | postures | runs | error of predicted directions / Cramér-Rao bound |\n|---|---|---|---|"
    );
    for (kind, word) in [(ObservationKind::Gravity, "accelerometer"), (ObservationKind::Inclination, "inclinometer")] {
        let options = SimulationOptions { kind, rows: 100, noise_orientation: 2e-4, ..SimulationOptions::default() };
        let ratio = webcam::efficiency_of(&webcam::panda(), &options, |_, options| options.noise_orientation, 0..RUNS);
        println!("| {word} | 100 | {RUNS} | {ratio:.3} |");
    }
}
