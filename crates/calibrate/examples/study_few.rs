//! Few rows of every real set: `cargo run --release -p denavit-calibrate --example study_few -- DRAWS.json [SIZES [SETS]]`.
//!
//! Ten draws of 15 to 200 rows of each set (postures are never split) are fitted and tested on up to 300 other rows: the error of each stage
//! relative to plain geometry, whether the predicted error is right, and which stage makes a set worse. The draws are written to the first
//! argument for other programs. Environment variables: `MEASURED`, the folder of the sets (`../shared/measured`); `FAST`: no search for
//! causes, so the stage with causes and the choice of `auto` are left out; `DRAWS` (10), `FIRST` (0); `LOCAL`: rows near each other, tested
//! on all others.
#![allow(clippy::unwrap_used, clippy::print_stdout)] // A study prints, and stops at the first error.

mod real;

use self::real::Real;
use denavit_calibrate::calibration::contract::Stage;
use denavit_calibrate::calibration::{CalibrateOptions, calibrate};
use denavit_identify::arm::Row;
use denavit_identify::averaging::averaged;
use denavit_identify::effects::Conditions;
use denavit_identify::effects::survey::with_run_order;
use denavit_identify::parameters::Effects;
use denavit_identify::residual_statistics::{Residual, bound_later, placed, residuals};
use denavit_identify::solve::Fit;
use denavit_identify::{IdentifyOptions, identify};
use denavit_measurements::{Covariate, Measurements};
use denavit_trace::TraceOptions;
use rand::SeedableRng as _;
use rand::seq::SliceRandom as _;
use rand_chacha::ChaCha8Rng;
use std::io::Write as _;
use std::time::Instant;

/// Name, robot, rows, units.
const SETS: &[(&str, &str, &str, &str)] = &[
    ("ur10oct", "robots/universal_robots/ur10.urdf", "ipa_ur10/joint_configurations.csv", ""),
    ("ur10july", "robots/universal_robots/ur10.urdf", "ipa_ur10/grid.csv", ""),
    ("ur5", "robots/universal_robots/ur5.urdf", "jacobi_ur5/grid.csv", "mm,deg"),
    ("wam", "@jacobi_wam/robot_dh.csv", "jacobi_wam/grid.csv", "mm,deg"),
    ("motoman", "@motoman_dual/motoman_right.csv", "motoman_dual/right_august2019.csv", ""),
    ("left", "@motoman_dual/motoman_left.csv", "motoman_dual/left_march2019.csv", ""),
    ("march", "@motoman_dual/motoman_right.csv", "motoman_dual/right_march2019.csv", ""),
    ("hilti", "@hilti_jaibot/trailblazer.urdf", "hilti_jaibot/flat.csv", ""),
    ("outdoor", "@hilti_jaibot/trailblazer.urdf", "hilti_jaibot/outdoor.csv", ""),
    ("pallet", "@hilti_jaibot/trailblazer.urdf", "hilti_jaibot/pallet.csv", ""),
    ("wire", "robots/abb/irb120.urdf", "robotcali_irb120/measurements.csv", ""),
    ("tiago", "robots/pal/tiago.urdf", "tiago_mocap/measurements.csv", ""),
];

/// Test rows, at most.
const JUDGES: usize = 300;

fn main() {
    let arguments: Vec<String> = std::env::args().collect();
    let list = |at: usize, otherwise: &str| -> Vec<String> {
        let words = arguments.get(at).map_or(otherwise, String::as_str);
        words.split(',').map(String::from).collect()
    };
    let sizes: Vec<usize> = list(2, "15,20,30,50,100,200").iter().map(|word| word.parse().unwrap()).collect();
    let sets = list(3, "");
    let number = |name: &str, otherwise: usize| std::env::var(name).map_or(otherwise, |word| word.parse().unwrap());
    let (draws, first, fast) = (number("DRAWS", 10), number("FIRST", 0), std::env::var("FAST").is_ok());
    let measured = std::env::var("MEASURED").unwrap_or_else(|_| "../shared/measured".into());
    let mut written = std::fs::OpenOptions::new().create(true).append(true).open(&arguments[1]).unwrap();
    let mut all: Vec<Outcome> = Vec::new();
    for (name, robot, rows, units) in SETS {
        if !sets.iter().any(|set| set.is_empty() || set == name) {
            continue;
        }
        let robot = robot.strip_prefix('@').map_or_else(|| (*robot).to_owned(), |own| format!("{measured}/{own}"));
        if !std::path::Path::new(&robot).exists() {
            println!("{name}: skipped, because {robot} is not here");
            continue;
        }
        let real = Real::in_units(&robot, units);
        let mut data = real.rows(&format!("{measured}/{rows}"));
        if data.covariate("time").is_none() {
            // The order of all rows: each drawn row keeps its time of measurement.
            let values = (0..data.len()).map(|row| row as f64).collect();
            data.covariates.push(Covariate { name: "time".into(), values });
        }
        let ordered = with_run_order(data.clone());
        for &size in &sizes {
            for draw in first..first + draws {
                let rows = if number("LOCAL", 0) > 0 { near(&data, size, draw) } else { drawn(&data, size, draw) };
                if let Some((train, test)) = rows {
                    let line = serde_json::json!({"set": name, "n": size, "draw": draw, "train": train, "test": test});
                    writeln!(written, "{line}").unwrap();
                    let outcome = judged(&real, &ordered, (&train, &test), fast, (name, size, draw));
                    outcome.print();
                    all.push(outcome);
                }
            }
        }
    }
    for (way, word) in ["causes and curves", "averaged", "chosen"].iter().enumerate() {
        println!(
            "\n| rows | {word}: median | 90th | worst | share > 1.1 | > 1.1 of drawing | refused | geometric mean | runs |\n|---|---|---|---|---|---|---|---|---|"
        );
        for &size in &sizes {
            table_line(&size.to_string(), &all.iter().filter(|o| o.size == size).collect::<Vec<_>>(), way);
        }
        table_line("15 to 50", &all.iter().filter(|o| o.size <= 50).collect::<Vec<_>>(), way);
        table_line("all", &all.iter().collect::<Vec<_>>(), way);
    }
    println!(
        "\n| set | runs | averaged/geometry: geometric mean | worst | inside 95 % of position components | outside |\n|---|---|---|---|---|---|"
    );
    for (name, ..) in SETS {
        let own: Vec<&Outcome> = all.iter().filter(|o| o.set == *name && o.averaged.is_finite()).collect();
        let ratios: Vec<f64> = own.iter().map(|o| o.averaged / o.geometric).collect();
        if ratios.is_empty() {
            continue;
        }
        let share = |k: usize| {
            let [held, of] = [0, 1].map(|part| own.iter().map(|o| o.covered[k][part]).sum::<f64>());
            100.0 * held / of.max(1.0)
        };
        let worst = ratios.iter().copied().fold(0.0, f64::max);
        println!("| {name} | {} | {:.3} | {worst:.3} | {:.1} | {:.1} |", own.len(), mean(&ratios), share(0), share(1));
    }
}

/// A draw's errors on test rows, mm; NaN without a result.
struct Outcome {
    set: String,
    size: usize,
    draw: usize,
    nominal: f64,
    geometric: f64,
    named: f64,
    averaged: f64,
    /// The stage that `auto` adopts.
    chosen: f64,
    /// Number of components within 1.96 predicted deviations, and number of all: within the measured ranges, and outside.
    covered: [[f64; 2]; 2],
    seconds: [f64; 2],
}

impl Outcome {
    fn print(&self) {
        let Self { set, size, draw, nominal, geometric, named, averaged, chosen, seconds, covered } = self;
        println!(
            "{set} {size} {draw}: nominal {nominal:.4} geometric {geometric:.4} named {named:.4} ({:.3}) averaged {averaged:.4} ({:.3}) chosen {chosen:.4}, {:.2} s + {:.2} s, covered {:.0} of {:.0}, outside {:.0} of {:.0}",
            named / geometric,
            averaged / geometric,
            seconds[0],
            seconds[1],
            covered[0][0],
            covered[0][1],
            covered[1][0],
            covered[1][1]
        );
    }
}

/// Geometric mean.
fn mean(ratios: &[f64]) -> f64 {
    (ratios.iter().map(|ratio| ratio.ln()).sum::<f64>() / ratios.len() as f64).exp()
}

fn table_line(word: &str, outcomes: &[&Outcome], way: usize) {
    let error = |outcome: &Outcome| [outcome.named, outcome.averaged, outcome.chosen][way];
    let judged: Vec<&&Outcome> = outcomes.iter().filter(|o| o.geometric.is_finite() && error(o).is_finite()).collect();
    if judged.is_empty() {
        return;
    }
    let mut ratios: Vec<f64> = judged.iter().map(|o| error(o) / o.geometric).collect();
    ratios.sort_by(f64::total_cmp);
    let at = |per_cent: usize| ratios[(per_cent * ratios.len() / 100).min(ratios.len() - 1)];
    let harmed = ratios.iter().filter(|ratio| **ratio > 1.1).count() as f64 / ratios.len() as f64;
    let beyond_drawing = judged.iter().filter(|o| error(o) > 1.1 * o.nominal).count() as f64 / ratios.len() as f64;
    println!(
        "| {word} | {:.2} | {:.2} | {:.2} | {:.1} % | {:.1} % | {} | {:.3} | {} |",
        at(50),
        at(90),
        at(100),
        100.0 * harmed,
        100.0 * beyond_drawing,
        outcomes.len() - judged.len(),
        mean(&ratios),
        outcomes.len()
    );
}

/// Training and test rows, whole postures; `None` if the set has too few.
fn drawn(data: &Measurements, size: usize, draw: usize) -> Option<(Vec<usize>, Vec<usize>)> {
    let postures = data.postures();
    let mut postures: Vec<Vec<usize>> = postures.iter().map(<[usize]>::to_vec).collect();
    if data.len() < size + 6 {
        return None;
    }
    postures.shuffle(&mut ChaCha8Rng::seed_from_u64((1000 * size + draw) as u64));
    let (mut train, mut test) = (Vec::new(), Vec::new());
    for posture in postures {
        if train.len() < size {
            train.extend(posture);
        } else if test.len() < JUDGES {
            test.extend(posture);
        }
    }
    train.sort_unstable();
    test.sort_unstable();
    (test.len() > 5).then_some((train, test))
}

/// Rows with postures near that of one row, and some of the others.
fn near(data: &Measurements, size: usize, draw: usize) -> Option<(Vec<usize>, Vec<usize>)> {
    if data.len() < size + 6 {
        return None;
    }
    let mut order: Vec<usize> = (0..data.len()).collect();
    order.shuffle(&mut ChaCha8Rng::seed_from_u64((1000 * size + draw) as u64));
    let middle = data.reading(order[0]);
    let width = |k: usize| {
        let values = || (0..data.len()).map(|row| data.reading(row)[k]);
        let (low, high) = (values().fold(f64::INFINITY, f64::min), values().fold(f64::NEG_INFINITY, f64::max));
        (high - low).max(1e-9)
    };
    let widths: Vec<f64> = (0..data.joints.len()).map(width).collect();
    let far = |row: &usize| {
        let there = data.reading(*row).iter().zip(middle).zip(&widths);
        there.map(|((a, b), width)| ((a - b) / width).powi(2)).sum::<f64>()
    };
    let mut by_distance = order.clone();
    by_distance.sort_by(|a, b| far(a).total_cmp(&far(b)));
    // From the nearest eighth.
    let nearest = &by_distance[..(2 * size).max(data.len() / 8).min(data.len())];
    let mut train: Vec<usize> = order.iter().copied().filter(|row| nearest.contains(row)).take(size).collect();
    let mut test: Vec<usize> = order.iter().copied().filter(|row| !train.contains(row)).take(JUDGES).collect();
    train.sort_unstable();
    test.sort_unstable();
    Some((train, test))
}

fn rms(residuals: &[Residual]) -> f64 {
    1e3 * (residuals.iter().map(|r| r.place.norm_squared()).sum::<f64>() / residuals.len() as f64).sqrt()
}

fn off<E: Effects>(fit: &Fit<E>, train: &Measurements, test: &Measurements) -> Vec<Residual> {
    let arm = placed(fit, train, test).unwrap();
    residuals(&arm, &bound_later(&fit.effects, train, test).unwrap(), test)
}

fn judged(
    real: &Real,
    ordered: &Measurements,
    (train_rows, test_rows): (&[usize], &[usize]),
    fast: bool,
    (set, size, draw): (&str, usize, usize),
) -> Outcome {
    let mut outcome = Outcome {
        set: set.into(),
        size,
        draw,
        nominal: f64::NAN,
        geometric: f64::NAN,
        named: f64::NAN,
        averaged: f64::NAN,
        chosen: f64::NAN,
        covered: [[0.0; 2]; 2],
        seconds: [0.0; 2],
    };
    // The side of approach of a joint comes from the rows measured before, drawn or not.
    let (train, test) = (ordered.subset(train_rows), ordered.subset(test_rows));
    let mut options = CalibrateOptions::geometry(&real.chain);
    options.trace = (!fast).then(|| TraceOptions::new(options.identify.clone()));
    options.average = true;
    let started = Instant::now();
    if !fast && let Ok(found) = calibrate(&real.chain, &real.statics, train.clone(), Some(test.clone()), &options) {
        let stages = &found.report.stages;
        let error = |stage: &Stage| {
            let error = stage.test.as_ref().unwrap();
            1e3 * ["position", "distance"].iter().find_map(|word| error.of(word)).unwrap().rms
        };
        outcome.named = error(stages.iter().rev().find(|stage| stage.converged && stage.name != "averaged").unwrap());
        outcome.chosen = error(stages.iter().find(|stage| stage.adopted).unwrap());
    }
    outcome.seconds[0] = started.elapsed().as_secs_f64();
    let started = Instant::now();
    let identify_options = IdentifyOptions::axes(&real.chain);
    let identification = identify(&real.chain, &train, &identify_options);
    outcome.nominal = rms(&off(&identification.nominal, &train, &test));
    outcome.geometric = rms(&off(&identification.geometric, &train, &test));
    let averaging = averaged(&real.statics, &train, &identification, &identify_options, (&[], None));
    outcome.seconds[1] = started.elapsed().as_secs_f64();
    if let Ok(averaging) = averaging {
        let left = off(&averaging.fit, &train, &test);
        outcome.averaged = rms(&left);
        if std::env::var("SIZES").is_ok() {
            println!(
                "   {:?} left out {:?} calibrated {:?}",
                averaging.sizes, averaging.left_out, averaging.fit.effects.known.calibrated
            );
        }
        let blend = bound_later(&averaging.fit.effects, &train, &test).unwrap();
        for residual in &left {
            let conditions = Conditions::of(Row::new(&test, residual.row));
            let inside =
                blend.known.ranges.iter().zip(conditions.reading).all(|(range, q)| (range.0..=range.1).contains(q));
            let held = &mut outcome.covered[usize::from(!inside)];
            let height = test.scene.series[residual.series].kind.place().height;
            let deviation = blend.variance_of_a_value(&conditions, height == 1).sqrt();
            held[0] += residual.place.iter().take(height).filter(|error| error.abs() < 1.96 * deviation).count() as f64;
            held[1] += height as f64;
        }
    }
    outcome
}
