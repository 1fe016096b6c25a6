//! Error of a webcam's calibration relative to the Cramér-Rao bound: prints the table of docs/camera.md.

#![allow(clippy::unwrap_used, clippy::print_stdout)] // A study prints its table.

#[path = "../tests/webcam/mod.rs"]
mod webcam;

const RUNS: u64 = 100;

fn main() {
    println!("| camera | runs | error of predicted pixels / Cramér-Rao bound |\n|---|---|---|");
    for (on_hand, word) in [(false, "fixed, board on the hand"), (true, "on the hand, board fixed")] {
        println!("| {word} | {RUNS} | {:.3} |", webcam::efficiency(on_hand, 0..RUNS));
    }
}
