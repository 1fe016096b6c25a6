//! Time of a fit to 10 000 poses of six joints: reading the text, both stages. Prints one line.

#![allow(clippy::print_stdout)] // A study prints its figures.

use denavit_calibrate::measurements::{Units, read, write};
use denavit_calibrate::simulate::{SimulationOptions, simulate};
use denavit_calibrate::{IdentifyOptions, MeasurementKind, NoEffects, identify};
use denavit_model::examples;
use std::time::Instant;

fn main() {
    let chain = &examples::all()[1];
    let options = SimulationOptions { kind: MeasurementKind::Pose, rows: 10_000, ..Default::default() };
    let text = write(&simulate(chain, &options, &NoEffects).data, &[]);
    let start = Instant::now();
    let loaded = match read("simulation", text.as_bytes(), chain, Units::default()) {
        Ok(loaded) => loaded,
        Err(error) => return println!("{error}"),
    };
    let read_in = start.elapsed();
    let start = Instant::now();
    let found = identify(chain, &loaded.data, &IdentifyOptions::axes(chain));
    println!(
        "reading {:.1} ms, fitting {:.1} ms, {} iterations, noise {:.2} um",
        read_in.as_secs_f64() * 1e3,
        start.elapsed().as_secs_f64() * 1e3,
        found.geometric.iterations,
        found.geometric.noise.position * 1e6
    );
}
