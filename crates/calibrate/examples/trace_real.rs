//! Traces one file of measurements: `cargo run --release --example trace_real -- ROBOT.urdf TRAIN.csv [TEST.csv|SHARE]`.
#![allow(clippy::unwrap_used, clippy::print_stdout)] // A study prints, and stops at the first trouble.

use denavit_calibrate::calibration::{CalibrateOptions, HoldOut, calibrate};
use denavit_calibrate::effects::Statics;
use denavit_calibrate::observation::measurements::{Units, read};
use denavit_calibrate::trace::TraceOptions;
use denavit_model::tree::Reading;
use std::time::Instant;

fn main() {
    let arguments: Vec<String> = std::env::args().collect();
    let robot = denavit_model::urdf::read(&arguments[1], &std::fs::read_to_string(&arguments[1]).unwrap()).unwrap();
    let tip = std::env::var("TIP").ok();
    let chain = robot.chain(None, tip.as_deref(), Reading::Intended).unwrap().value;
    let statics = Statics::of(&robot, &chain);
    let load = |path: &str| {
        read(path, std::fs::File::open(path).unwrap(), &chain, Units::default())
            .unwrap_or_else(|error| panic!("{error}"))
            .data
    };
    let mut options = CalibrateOptions::geometry(&chain);
    options.trace = Some(TraceOptions::new(options.identify.clone()));
    let mut test = None;
    match arguments.get(3).map(|word| (word, word.parse::<f64>())) {
        Some((_, Ok(share))) => options.hold_out = Some(HoldOut { share, seed: 0 }),
        Some((path, _)) => test = Some(load(path)),
        None => {}
    }
    let started = Instant::now();
    let found =
        calibrate(&chain, &statics, load(&arguments[2]), test, &options).unwrap_or_else(|error| panic!("{error}"));
    println!("{:.2} s", started.elapsed().as_secs_f64());
    println!("{}", found.report.to_json());
    if let Some(trace) = &found.trace {
        for f in &trace.findings {
            println!("{}({}) {:?} {:?}", f.term.kind.name(), f.place, f.term.carrier, f.term.driver);
        }
        println!("{:?}", found.rounding.map(|r| r.to_string()));
    }
}
