//! Accuracy with a printed plate of holes: prints the table of docs/without-an-instrument.md. The servo arm is read from `../shared`.

#![allow(clippy::unwrap_used, clippy::print_stdout)] // A study prints its table.

#[path = "../tests/touched/mod.rs"]
mod touched;

use denavit_calibrate::IdentifyOptions;
use denavit_identify::identify;
use denavit_model::Reading;
use touched::Touching;

const RUNS: u64 = 20;
/// Placements for the test only.
const LATER: usize = 2;

/// An arm and how it is measured.
struct Kind {
    name: &'static str,
    file: &'static str,
    tip: Option<&'static str>,
    /// Errors of zeros, rad, and of axes, rad and m.
    zeros: f64,
    axes: [f64; 2],
    /// Error of a touch, m.
    noise: f64,
    /// Whether only zeros are fitted.
    only_zeros: bool,
}

const ARMS: [Kind; 3] = [
    Kind {
        name: "SO-100, servos",
        file: "../shared/vendor/robots/robotstudio/so100.urdf",
        tip: Some("gripper"),
        zeros: 0.05,
        axes: [2e-3, 5e-4],
        noise: 3e-4,
        only_zeros: true,
    },
    Kind {
        name: "xArm 7",
        file: "robots/ufactory/xarm7.urdf",
        tip: None,
        zeros: 0.01,
        axes: [1e-3, 5e-4],
        noise: 2e-4,
        only_zeros: true,
    },
    Kind {
        name: "Panda",
        file: "robots/franka/panda.urdf",
        tip: Some("panda_link8"),
        zeros: 2e-3,
        axes: [1e-3, 5e-4],
        noise: 2e-4,
        only_zeros: false,
    },
];

fn main() {
    println!(
        "| arm | placements | touches | as drawn, mm | fitted, mm | the true arm, mm |\n|---|---|---|---|---|---|"
    );
    for Kind { name, file, tip, zeros, axes, noise, only_zeros } in ARMS {
        let Ok(text) = std::fs::read_to_string(file) else {
            println!("{name}: skipped, because {file} does not exist");
            continue;
        };
        let robot = denavit_model::urdf::read(file, &text).unwrap();
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
