//! A model of one day tested on rows of a later day, with tracker and target mounted again.
//!
//! `cargo run --release -p denavit-calibrate --example later_real -- ROBOT.urdf BEFORE.csv LATER.csv [ROWS]`
//!
//! Each model (geometry, geometry with error curves, effects and curves, what a calibration recommends) is fitted to BEFORE. Some rows of
//! LATER (ROWS, or one in twenty) determine only the poses of instrument and target; the others are predicted. Then a geometry fitted to
//! 150 rows of BEFORE is updated with a few rows of LATER, and so is the whole model of BEFORE with its effects and curves. Environment
//! variables: `TIP`, `UNITS`, `SEED`.
#![allow(clippy::unwrap_used, clippy::print_stdout)] // A study prints, and stops at the first error.

mod real;

use self::real::Real;
use denavit_calibrate::calibration::contract::Stage;
use denavit_calibrate::calibration::{CalibrateOptions, Calibration, calibrate};
use denavit_calibrate::{Arm, Freedom, IdentifyOptions, Tolerances};
use denavit_identify::carried::PartState;
use denavit_identify::effects::Statics;
use denavit_identify::effects::survey::with_run_order_after;
use denavit_identify::identify;
use denavit_identify::parameters::Effects as _;
use denavit_identify::parameters::Layout;
use denavit_identify::parameters::NoEffects;
use denavit_identify::posterior::Earlier;
use denavit_identify::residual_statistics::residuals;
use denavit_identify::solve::{FitOptions, fit};
use denavit_measurements::Measurements;
use denavit_trace::TraceOptions;
use denavit_trace::infer::CurveOptions;
use rand::SeedableRng as _;
use rand::seq::SliceRandom as _;
use rand_chacha::ChaCha8Rng;

/// Rows of BEFORE for the geometry that is updated, and rows of LATER for the update.
const BEFORE: usize = 150;
const AFTER: [usize; 4] = [5, 10, 20, 40];
/// Test rows of LATER, and number of draws.
const JUDGED: usize = 600;
const DRAWS: u64 = 10;

fn main() {
    let arguments: Vec<String> = std::env::args().collect();
    let real = Real::robot(&arguments[1]);
    let (chain, statics) = (&real.chain, &real.statics);
    let (before, later) = (real.rows(&arguments[2]), real.rows(&arguments[3]));
    // The side of approach comes from the order of all rows, not of the drawn ones.
    let later = with_run_order_after(later, &before);
    let placing: usize = arguments.get(4).map_or(later.len() / 20, |word| word.parse().unwrap());
    let seed: u64 = std::env::var("SEED").map_or(0, |word| word.parse().unwrap());
    let mut order: Vec<usize> = (0..later.len()).collect();
    order.shuffle(&mut ChaCha8Rng::seed_from_u64(seed));
    let (placing, judged) = order.split_at(placing);
    let [placing, judged] = [placing, judged].map(|rows| {
        let mut rows = rows.to_vec();
        rows.sort_unstable();
        later.subset(&rows)
    });
    let within = within_range(&before, &judged);
    println!(
        "{} rows fitted; {} later rows, of which {} place instrument and target; {} of the others within the fitted range",
        before.len(),
        later.len(),
        placing.len(),
        within.iter().filter(|within| **within).count()
    );
    say_how_postures_differ(&before, &judged);
    println!("| model of {} | all later rows, mm rms | rows within its range |\n|---|---|---|", arguments[2]);
    let mut known = None;
    for word in ["geometry", "curves", "effects and curves", "recommended"] {
        let mut options = CalibrateOptions::geometry(chain);
        options.curves = (word == "curves").then(CurveOptions::default);
        options.average = word == "recommended";
        options.trace =
            matches!(word, "effects and curves" | "recommended").then(|| TraceOptions::new(options.identify.clone()));
        let found = calibrate(chain, statics, before.clone(), None, &options).unwrap_or_else(|error| panic!("{error}"));
        let [all, inside] = predicted(&found, statics, &placing, &judged, &within);
        println!("| {word} | {:.4} | {:.4} |", all * 1e3, inside * 1e3);
        if word == "effects and curves" {
            let report = found.report.to_json();
            known = Some(Earlier::read("earlier.json", &report, chain).unwrap_or_else(|error| panic!("{error}")));
        }
    }
    brought_up_to_date(statics, &before, &later, seed);
    with_effects_and_curves(statics, &known.unwrap(), &later, seed);
}

/// Prints the two joints whose correlation of readings changes most, and the interval of one joint's readings that has the largest
/// fraction of the later rows but only one fitted row.
fn say_how_postures_differ(before: &Measurements, later: &Measurements) {
    let joints = before.reading(0).len();
    let readings = |data: &Measurements, joint: usize| -> Vec<f64> {
        (0..data.len()).map(|row| data.reading(row)[joint]).collect()
    };
    let correlation = |data: &Measurements, a: usize, b: usize| {
        let centred = |joint: usize| {
            let values = readings(data, joint);
            let mean = values.iter().sum::<f64>() / values.len() as f64;
            values.into_iter().map(|value| value - mean).collect::<Vec<f64>>()
        };
        let (a, b) = (centred(a), centred(b));
        let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        product(&a, &b) / (product(&a, &a) * product(&b, &b)).sqrt()
    };
    let pairs = (0..joints).flat_map(|a| (a + 1..joints).map(move |b| (a, b)));
    let pairs = pairs.map(|(a, b)| (a, b, correlation(before, a, b), correlation(later, a, b)));
    let (a, b, was, is) = pairs.max_by(|x, y| (x.2 - x.3).abs().total_cmp(&(y.2 - y.3).abs())).unwrap();
    println!("readings {} and {}: correlation {was:.2} in the fitted rows, {is:.2} in the later ones", a + 1, b + 1);
    let gaps = (0..joints).flat_map(|joint| {
        let (mut fitted, later) = (readings(before, joint), readings(later, joint));
        fitted.sort_by(f64::total_cmp);
        let share = move |(low, high): (f64, f64)| {
            let inside = later.iter().filter(|value| (low..high).contains(*value)).count();
            (inside as f64 / later.len() as f64, joint, low, high)
        };
        let ends: Vec<(f64, f64)> = fitted.windows(3).map(|three| (three[0], three[2])).collect();
        ends.into_iter().map(share).collect::<Vec<_>>()
    });
    let (share, joint, low, high) = gaps.max_by(|x, y| x.0.total_cmp(&y.0)).unwrap();
    println!(
        "{:.0} % of the later rows have reading {} between {low:.2} and {high:.2}; only one fitted row does\n",
        share * 100.0,
        joint + 1
    );
}

/// Errors of the whole earlier model with its effects and curves on later test rows: unchanged, with instrument and target placed by a few
/// rows, and updated with these rows. With enough rows more causes are searched: the adopted stage.
fn with_effects_and_curves(statics: &Statics, known: &Earlier, later: &Measurements, seed: u64) {
    let chain = &statics.chain;
    println!(
        "\n| later rows | earlier model, mm rms | updated | adopted | parts left out, mean | weight of its axes, mean |"
    );
    println!("|---|---|---|---|---|---|");
    for count in AFTER {
        let mut sums = [0.0; 5];
        for draw in 0..DRAWS {
            let mut order: Vec<usize> = (0..later.len()).collect();
            order.shuffle(&mut ChaCha8Rng::seed_from_u64(seed + 1000 * draw + 1));
            let identify = IdentifyOptions { earlier: Some(known.clone()), ..IdentifyOptions::axes(chain) };
            let trace = Some(TraceOptions::new(identify.clone()));
            let options = CalibrateOptions { identify, trace, ..CalibrateOptions::geometry(chain) };
            let (train, test) = (later.subset(&order[..count]), later.subset(&order[order.len() - JUDGED..]));
            let found =
                calibrate(chain, statics, train, Some(test), &options).unwrap_or_else(|error| panic!("{error}"));
            let stages = &found.report.stages;
            let square = |stage: &Stage| stage.test.as_ref().unwrap().of("position").unwrap().rms.powi(2);
            let named = |name: &str| square(stages.iter().find(|stage| stage.name == name).unwrap());
            // Without held-out rows the last stage is adopted.
            let [earlier, updated, last] = [named("earlier"), named("updated"), square(stages.last().unwrap())];
            let continued = found.report.earlier.as_ref().unwrap();
            let left_out = continued.effects.iter().filter(|part| part.state != PartState::Kept).count();
            let own = [earlier, updated, last, left_out as f64, continued.weight];
            sums.iter_mut().zip(own).for_each(|(sum, own)| *sum += own / DRAWS as f64);
        }
        let [earlier, updated, last] = [0, 1, 2].map(|k: usize| sums[k].sqrt() * 1e3);
        println!("| {count} | {earlier:.3} | {updated:.3} | {last:.3} | {:.1} | {:.2} |", sums[3], sums[4]);
    }
}

/// Errors on later test rows: geometry from a few later rows alone, the earlier geometry, and the updated one.
fn brought_up_to_date(statics: &Statics, before: &Measurements, later: &Measurements, seed: u64) {
    let chain = &statics.chain;
    println!("\n| later rows | alone, mm rms | earlier robot | earlier robot, updated | weight, mean |");
    println!("|---|---|---|---|---|");
    for count in AFTER {
        let mut sums = [0.0; 4];
        for draw in 0..DRAWS {
            let mut random = ChaCha8Rng::seed_from_u64(seed + 1000 * draw + 1);
            let mut drawn = |data: &Measurements| {
                let mut order: Vec<usize> = (0..data.len()).collect();
                order.shuffle(&mut random);
                order
            };
            let (first, order) = (drawn(before), drawn(later));
            let fitted = |train: &[usize], of: &Measurements, test: Option<&[usize]>, earlier: Option<Earlier>| {
                let identify = IdentifyOptions { earlier, ..IdentifyOptions::axes(chain) };
                let options = CalibrateOptions { identify, ..CalibrateOptions::geometry(chain) };
                let test = test.map(|rows| of.subset(rows));
                calibrate(chain, statics, of.subset(train), test, &options).unwrap_or_else(|error| panic!("{error}"))
            };
            let known = fitted(&first[..BEFORE], before, None, None).report.to_json();
            let known = Earlier::read("earlier.json", &known, chain).unwrap();
            let (train, test) = (&order[..count], &order[order.len() - JUDGED..]);
            let alone = fitted(train, later, Some(test), None);
            let after = fitted(train, later, Some(test), Some(known));
            let square = |result: &Calibration, name: &str| {
                let stage = result.report.stages.iter().find(|stage| stage.name == name).unwrap();
                stage.test.as_ref().unwrap().of("position").unwrap().rms.powi(2)
            };
            let found = [square(&alone, "geometric"), square(&after, "earlier"), square(&after, "geometric")];
            sums.iter_mut().zip(found).for_each(|(sum, found)| *sum += found);
            sums[3] += after.report.earlier.as_ref().map_or(0.0, |earlier| earlier.weight);
        }
        let [alone, earlier, after] = [0, 1, 2].map(|k: usize| (sums[k] / DRAWS as f64).sqrt() * 1e3);
        println!("| {count} | {alone:.3} | {earlier:.3} | {after:.3} | {:.2} |", sums[3] / DRAWS as f64);
    }
}

/// For each row whether every reading is within the range of the fitted rows.
fn within_range(fitted: &Measurements, rows: &Measurements) -> Vec<bool> {
    let joints = fitted.reading(0).len();
    let span = |joint: usize| {
        let values = (0..fitted.len()).map(|row| fitted.reading(row)[joint]);
        values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], value| [low.min(value), high.max(value)])
    };
    let spans: Vec<[f64; 2]> = (0..joints).map(span).collect();
    let inside =
        |row: usize| rows.reading(row).iter().zip(&spans).all(|(value, [low, high])| low <= value && value <= high);
    (0..rows.len()).map(inside).collect()
}

/// Position error in m, root mean square: of all test rows, and of those within the range.
fn predicted(
    found: &Calibration,
    statics: &Statics,
    placing: &Measurements,
    judged: &Measurements,
    within: &[bool],
) -> [f64; 2] {
    let chain = &statics.chain;
    let options = IdentifyOptions { freedom: Freedom::placement(chain.joints().len()), ..IdentifyOptions::axes(chain) };
    // The drawn robot gives rough poses of instrument and target; the model then refines them.
    let guess = identify(chain, placing, &options).nominal.arm;
    let layout = Layout::new(chain, &placing.scene, &options.freedom, &Tolerances::default(), Vec::new());
    let start = Arm { joints: found.arm().joints.clone(), ..guess };
    let weights = vec![1.0; placing.observations()];
    let model = found.effects(statics);
    let [of_placing, of_judged] =
        [placing, judged].map(|rows| model.bound_to(rows).unwrap_or_else(|error| panic!("{error}")));
    let arm = if model.are_none() {
        fit(placing, &layout, &start, &NoEffects, &weights, &FitOptions::default()).arm
    } else {
        fit(placing, &layout, &start, &of_placing, &weights, &FitOptions::default()).arm
    };
    let errors = residuals(&arm, &of_judged, judged);
    let rms = |rows: &dyn Fn(usize) -> bool| {
        let squares: Vec<f64> =
            errors.iter().filter(|error| rows(error.row)).map(|error| error.place.norm_squared()).collect();
        (squares.iter().sum::<f64>() / squares.len() as f64).sqrt()
    };
    [rms(&|_| true), rms(&|row| within[row])]
}
