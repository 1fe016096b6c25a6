//! Time of a fit to full poses of a UR5e: `study_time [ROWS] [FILE]`, 10 000 rows by default. Prints one line for reading
//! the text and one for each of three fits; writes the text to FILE, if given, for the command line to read.

#![allow(clippy::print_stdout, clippy::unwrap_used)] // A study prints its figures, and stops at the first error.

use denavit_calibrate::IdentifyOptions;
use denavit_identify::identify;
use denavit_identify::parameters::NoEffects;
use denavit_identify::simulate::{SimulationOptions, simulate};
use denavit_measurements::kinds::ObservationKind;
use denavit_measurements::{Units, read, write};
use denavit_model::{Reading, urdf};
use std::path::Path;
use std::time::Instant;

fn main() {
    let rows = std::env::args().nth(1).map_or(10_000, |rows| rows.parse().unwrap());
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../robots/universal_robots/ur5e.urdf");
    let robot = urdf::read("ur5e.urdf", &std::fs::read_to_string(file).unwrap()).unwrap();
    let chain = &robot.chain(None, None, Reading::Intended).unwrap().value;
    let options = SimulationOptions { kind: ObservationKind::Pose, rows, ..Default::default() };
    let text = write(&simulate(chain, &options, &NoEffects).data, &[]);
    if let Some(path) = std::env::args().nth(2) {
        std::fs::write(path, &text).unwrap();
    }
    let start = Instant::now();
    let loaded = read("simulation", text.as_bytes(), chain, Units::default()).unwrap();
    println!("reading {:.1} ms", start.elapsed().as_secs_f64() * 1e3);
    for _ in 0..3 {
        let start = Instant::now();
        let found = identify(chain, &loaded.data, &IdentifyOptions::axes(chain));
        println!(
            "fitting {:.1} ms, {} iterations, noise {:.2} um",
            start.elapsed().as_secs_f64() * 1e3,
            found.geometric.iterations,
            found.geometric.noise.first() * 1e6
        );
    }
}
