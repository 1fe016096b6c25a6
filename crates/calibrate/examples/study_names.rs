//! Which effects are named if only a fraction of the rows is used (four fifths by default), drawn at random:
//! `cargo run --release -p denavit-calibrate --example study_names -- ROBOT.urdf DATA.csv [DRAWS [SHARE]]`.
//!
//! Environment variables: `TIP` (link), `UNITS` (such as mm,deg). At the end: the names that recur in fewer than eight of ten draws.
#![allow(clippy::unwrap_used, clippy::print_stdout)] // A study prints, and stops at the first error.

mod real;

use self::real::Real;
use denavit_calibrate::calibration::{CalibrateOptions, HoldOut, calibrate};
use denavit_trace::TraceOptions;
use std::collections::BTreeMap;

/// Fraction of the draws in which a name must recur.
const RECURS: f64 = 0.8;

fn main() {
    let arguments: Vec<String> = std::env::args().collect();
    let real = Real::robot(&arguments[1]);
    let (chain, statics) = (&real.chain, &real.statics);
    let draws: u64 = arguments.get(3).map_or(10, |word| word.parse().unwrap());
    let given: f64 = arguments.get(4).map_or(0.8, |word| word.parse().unwrap());
    let mut times: BTreeMap<String, u64> = BTreeMap::new();
    for seed in 0..draws {
        let data = real.rows(&arguments[2]);
        let mut options = CalibrateOptions::geometry(chain);
        options.trace = Some(TraceOptions::new(options.identify.clone()));
        options.hold_out = Some(HoldOut { share: 1.0 - given, seed });
        let found = calibrate(chain, statics, data, None, &options).unwrap_or_else(|error| panic!("{error}"));
        let place = |effect: &denavit_calibrate::calibration::contract::EffectEntry| {
            effect.joint.clone().or(effect.place.clone()).unwrap_or_default()
        };
        for effect in found.report.effects.iter().chain(&found.report.one_of) {
            let kind = &effect.kind;
            let order = effect.parameters.get("order").map_or_else(String::new, |order| format!(" of order {order}"));
            println!(
                "  {kind} at {}{order}: {:.3}, again {:.2}",
                place(effect),
                effect.probability,
                effect.found_again
            );
        }
        let mut names: Vec<String> =
            found.report.effects.iter().map(|effect| format!("{} at {}", effect.kind, place(effect))).collect();
        names.sort();
        names.dedup();
        let open: Vec<String> =
            found.report.one_of.iter().map(|effect| format!("{} at {}", effect.kind, place(effect))).collect();
        let stages: Vec<String> = found
            .report
            .stages
            .iter()
            .map(|stage| {
                let rms = stage.test.as_ref().map_or(f64::NAN, |test| {
                    ["position", "distance"].iter().find_map(|word| test.of(word)).map_or(f64::NAN, |error| error.rms)
                });
                format!("{:.4}{}", rms * 1e3, if stage.adopted { " (adopted)" } else { "" })
            })
            .collect();
        println!("draw {seed}: named {names:?}, one of several {open:?}; held out {} mm", stages.join(" → "));
        for name in names {
            *times.entry(name).or_default() += 1;
        }
    }
    let mut rare = 0;
    for (name, times) in times {
        let recurs = times as f64 >= RECURS * draws as f64;
        rare += if recurs { 0 } else { times };
        println!("{name}: {times} of {draws}{}", if recurs { "" } else { ", does not recur" });
    }
    println!("names that do not recur: {:.2} a draw", rare as f64 / draws as f64);
}
