//! Traces one file of measurements: `cargo run --release --example trace_real -- ROBOT.urdf TRAIN.csv [TEST.csv|SHARE]`.
//!
//! Environment variables: `TIP` (link), `UNITS` (such as mm,deg), `EFFECTS` (auto, curves, none), `SEED` of the split.
#![allow(clippy::unwrap_used, clippy::print_stdout)] // A study prints, and stops at the first error.

mod real;

use self::real::Real;
use denavit_calibrate::calibration::{CalibrateOptions, HoldOut, calibrate};
use denavit_calibrate::report::text;
use denavit_trace::TraceOptions;
use denavit_trace::infer::CurveOptions;
use std::time::Instant;

fn main() {
    let arguments: Vec<String> = std::env::args().collect();
    let real = Real::robot(&arguments[1]);
    let (chain, statics) = (&real.chain, &real.statics);
    let mut options = CalibrateOptions { noise: true, ..CalibrateOptions::geometry(chain) };
    let word = std::env::var("EFFECTS").unwrap_or_else(|_| "auto".into());
    options.trace = (word == "auto").then(|| TraceOptions::new(options.identify.clone()));
    options.average = word == "auto";
    options.curves = (word == "curves").then(CurveOptions::default);
    let seed = std::env::var("SEED").map_or(0, |word| word.parse().unwrap());
    let mut test = None;
    match arguments.get(3).map(|word| (word, word.parse::<f64>())) {
        Some((_, Ok(share))) => options.hold_out = Some(HoldOut { share, seed }),
        Some((path, _)) => test = Some(real.rows(path)),
        None => {}
    }
    let started = Instant::now();
    let found =
        calibrate(chain, statics, real.rows(&arguments[2]), test, &options).unwrap_or_else(|error| panic!("{error}"));
    println!("{:.2} s", started.elapsed().as_secs_f64());
    println!("{}", text::calibration(&found));
    println!("left out: {:?}", found.averaging.as_ref().map(|averaging| (averaging.left_out, averaging.named)));
    if let Some(trace) = &found.trace {
        for f in &trace.findings {
            println!("{}({}) {:?} {:?}", f.term.kind.name(), f.place, f.term.carrier, f.term.driver);
        }
        println!("{:?}", found.rounding.map(|r| r.to_string()));
    }
}
