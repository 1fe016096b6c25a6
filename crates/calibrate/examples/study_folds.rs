//! Every row held out once: `cargo run --release -p denavit-calibrate --example study_folds -- ROBOT.urdf|TABLE.csv DATA.csv [FOLDS]`.
//!
//! Postures are assigned at random to this many folds; each fold is predicted by a model of all the others. Environment variables: `TIP`
//! (links, separated by commas), `UNITS` (such as mm,deg), `SEED` of the assignment.
#![allow(clippy::unwrap_used, clippy::print_stdout)] // A study prints, and stops at the first error.

mod real;

use self::real::Real;
use denavit_calibrate::calibration::{CalibrateOptions, calibrate};
use denavit_trace::TraceOptions;
use denavit_trace::infer::CurveOptions;
use rand::SeedableRng as _;
use rand::seq::SliceRandom as _;
use rand_chacha::ChaCha8Rng;

fn main() {
    let arguments: Vec<String> = std::env::args().collect();
    let real = Real::robot(&arguments[1]);
    let data = real.rows(&arguments[2]);
    let folds: usize = arguments.get(3).map_or(5, |word| word.parse().unwrap());
    let seed: u64 = std::env::var("SEED").map_or(0, |word| word.parse().unwrap());
    let postures = data.postures();
    let mut order: Vec<&[usize]> = postures.iter().collect();
    order.sort_unstable();
    order.shuffle(&mut ChaCha8Rng::seed_from_u64(seed));
    // Per model: sum of squares, sum, largest, rows.
    let words = ["nominal", "geometry", "curves", "result"];
    let mut sums = [[0.0, 0.0, 0.0, 0.0]; 4];
    for fold in 0..folds {
        let part = |held: bool| {
            let own = order.iter().enumerate().filter(|(place, _)| (place % folds == fold) == held);
            let mut rows: Vec<usize> = own.flat_map(|(_, rows)| *rows).copied().collect();
            rows.sort_unstable();
            data.subset(&rows)
        };
        let (train, test) = (part(false), part(true));
        for curves in [true, false] {
            let mut options = CalibrateOptions::geometry(&real.chain);
            if curves {
                options.curves = Some(CurveOptions::default());
            } else {
                options.trace = Some(TraceOptions::new(options.identify.clone()));
                options.average = true;
            }
            let found = calibrate(&real.chain, &real.statics, train.clone(), Some(test.clone()), &options)
                .unwrap_or_else(|error| panic!("{error}"));
            let mut add = |way: usize, stage: &denavit_calibrate::calibration::contract::Stage| {
                let error = stage.test.as_ref().unwrap();
                let error = ["position", "distance"].iter().find_map(|word| error.of(word)).unwrap();
                let rows = test.len() as f64;
                sums[way][0] += rows * error.rms * error.rms;
                sums[way][1] += rows * error.mean;
                sums[way][2] = sums[way][2].max(error.max);
                sums[way][3] += rows;
            };
            let stages = &found.report.stages;
            let adopted = stages.iter().rev().find(|stage| stage.adopted).unwrap();
            if curves {
                add(0, &stages[0]);
                add(1, stages.iter().find(|stage| stage.name == "geometric").unwrap());
                add(2, adopted);
            } else {
                add(3, adopted);
                let names = |list: &[denavit_calibrate::calibration::contract::EffectEntry]| {
                    let place = |effect: &denavit_calibrate::calibration::contract::EffectEntry| {
                        effect.joint.clone().or(effect.place.clone()).unwrap_or_default()
                    };
                    list.iter().map(|effect| format!("{} at {}", effect.kind, place(effect))).collect::<Vec<_>>()
                };
                println!(
                    "fold {fold}: named {:?}, one of several {:?}",
                    names(&found.report.effects),
                    names(&found.report.one_of)
                );
            }
        }
    }
    println!("| model | held out, rms, mm | mean | largest |\n|---|---|---|---|");
    for (word, [squares, sum, largest, rows]) in words.iter().zip(sums) {
        println!("| {word} | {:.4} | {:.4} | {:.4} |", (squares / rows).sqrt() * 1e3, sum / rows * 1e3, largest * 1e3);
    }
}
