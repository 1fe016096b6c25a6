//! What a printed plate of holes brings: prints the table of docs/without-an-instrument.md. The arm of servos is read from `../shared`.

#![allow(clippy::unwrap_used, clippy::print_stdout)] // A study prints its table.

#[path = "../tests/touched/mod.rs"]
mod touched;

use denavit_calibrate::{IdentifyOptions, identify};
use denavit_model::Reading;
use touched::Touching;

const RUNS: u64 = 20;
/// Placements on which no fit looks.
const LATER: usize = 2;

/// An arm of this kind, its tip, its errors (zeros, axes), the error of a touch, and whether zeros alone are fitted.
const ARMS: [(&str, &str, &str, f64, [f64; 2], f64, bool); 3] = [
    ("SO-100, servos", "../shared/vendor/robots/robotstudio/so100.urdf", "", 0.05, [2e-3, 5e-4], 3e-4, true),
    ("xArm 7", "robots/ufactory/xarm7.urdf", "", 0.01, [1e-3, 5e-4], 2e-4, true),
    ("Panda", "robots/franka/panda.urdf", "panda_link8", 2e-3, [1e-3, 5e-4], 2e-4, false),
];

fn main() {
    println!(
        "| arm | placements | touches | as drawn, mm | fitted, mm | the true arm, mm |\n|---|---|---|---|---|---|"
    );
    for (name, file, tip, zeros, axes, noise, only_zeros) in ARMS {
        let Ok(text) = std::fs::read_to_string(file) else {
            println!("{name}: skipped, because {file} is not there");
            continue;
        };
        let robot = denavit_model::urdf::read(file, &text).unwrap();
        let tip = Some(tip).filter(|tip| !tip.is_empty());
        let chain = robot.chain(None, tip, Reading::Intended).unwrap().value;
        let plate = "4x3:40mm".parse().unwrap();
        let touching = Touching { chain: &chain, plate, zeros, axes, noise };
        for placements in [1, 2, 3, 4] {
            let mut errors = [const { Vec::new() }; 3];
            for seed in 0..RUNS {
                let run = touching.run(placements + LATER, seed);
                let (fitted, later) = run.rows.split_at(placements * 12);
                let options = if only_zeros {
                    IdentifyOptions::zeros(&chain, vec![true; chain.joints().len()])
                } else {
                    IdentifyOptions::axes(&chain)
                };
                let found = identify(&chain, &touching.data(fitted), &options);
                for (errors, arm) in errors.iter_mut().zip([&found.nominal.arm, &found.geometric.arm, &run.truth]) {
                    errors.extend(later.chunks(12).map(|placed| touching.error(arm, placed)));
                }
            }
            let [drawn, fitted, truth] = errors.map(|mut errors| {
                errors.sort_by(f64::total_cmp);
                1e3 * errors[errors.len() / 2]
            });
            println!("| {name} | {placements} | {} | {drawn:.2} | {fitted:.2} | {truth:.2} |", placements * 12);
        }
    }
}
