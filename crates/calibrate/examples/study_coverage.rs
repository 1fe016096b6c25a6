//! How often intervals contain the truth: bands of error curves, coefficients of effects.
//!
//! `cargo run --release -p denavit-calibrate --example study_coverage -- [RUNS] [others]`
//!
//! UR5e with errors of 1 mrad and 1 mm on each axis, 0.05 mm noise of each component of position, readings spread over ±2.5 rad. Curves:
//! three joints have errors of four sines of orders between 1.5 and 8. A curve is compared with the truth minus its mean over the rows,
//! which is the zero of the joint and therefore part of the geometry. `others` uses other errors, with few rows: draws from the prior kernel
//! of curves, and sines of higher orders.
#![allow(clippy::unwrap_used, clippy::print_stdout)] // A study prints, and stops at the first error.

use denavit_calibrate::calibration::{CalibrateOptions, Calibration, calibrate};
use denavit_identify::effects::{Carrier, Coupling, Driver, Effect, EffectModel, Kind, Statics, Term};
use denavit_identify::simulate::{SimulationOptions, simulate};
use denavit_model::tree::Reading;
use denavit_model::{Chain, urdf};
use denavit_trace::TraceOptions;
use denavit_trace::infer::CurveOptions;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::StandardNormal;

/// Readings are spread over this range to either side, rad.
const REACH: f64 = 2.5;
/// Half of a 95 % interval, in standard deviations of a normal distribution.
const NORMAL_95: f64 = 1.959_963_984_540_054;
/// Root mean square of a joint's error, rad.
const GEAR: f64 = 3e-4;
/// Joints with errors.
const GEARS: [usize; 3] = [1, 2, 4];
/// Sines in the error of a joint.
const SINES: usize = 4;
/// Waves in a draw of the kernel.
const WAVES: usize = 100;

/// Kind of the joints' errors.
#[derive(Debug, Clone, Copy)]
pub enum Errors {
    /// Four sines of orders between these, of 0.3 mrad in all.
    Sines(f64, f64),
    /// Draws from the prior kernel of curves (Matérn, 5/2): size and length scale, rad.
    Kernel(f64, f64),
}

/// Those of gears.
pub const SMOOTH: Errors = Errors::Sines(1.5, 8.0);

impl Errors {
    /// Of a joint, each with its order and the size of its parts, rad.
    fn waves(self, random: &mut ChaCha8Rng) -> Vec<(f64, [f64; 2])> {
        let count = match self {
            Self::Sines(..) => SINES,
            Self::Kernel(..) => WAVES,
        };
        let mut wave = || {
            let normal = |random: &mut ChaCha8Rng| random.sample::<f64, _>(StandardNormal);
            let (order, size) = match self {
                Self::Sines(low, high) => (random.random_range(low..high), GEAR),
                // The kernel's spectrum is that of Student's t with five degrees of freedom.
                Self::Kernel(size, length) => {
                    let squares: f64 = (0..5).map(|_| normal(random).powi(2)).sum();
                    ((normal(random) / (squares / 5.0).sqrt() / length).abs(), size)
                }
            };
            (order, [(); 2].map(|()| size / (count as f64).sqrt() * normal(random)))
        };
        (0..count).map(|_| wave()).collect()
    }
}

/// The robot.
pub fn ur5e() -> (Chain, Statics) {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../robots/universal_robots/ur5e.urdf");
    let robot = urdf::read(path, &std::fs::read_to_string(path).unwrap()).unwrap();
    let chain = robot.chain(None, None, Reading::Intended).unwrap().value;
    let statics = Statics::of(&robot, &chain);
    (chain, statics)
}

/// Joint readings, rad, row by row.
pub fn readings(rows: usize, seed: u64) -> Vec<Vec<f64>> {
    let mut random = ChaCha8Rng::seed_from_u64(seed ^ 0xa11);
    (0..rows).map(|_| (0..6).map(|_| random.random_range(-REACH..REACH)).collect()).collect()
}

fn at_joint(kind: Kind, joint: usize, driver: Driver, coefficients: Vec<f64>) -> Effect {
    Effect { term: Term { kind, carrier: Carrier::Joint(joint), driver, coupling: Coupling::Each }, coefficients }
}

/// Random smooth errors of joints, of mean 0 over these readings.
pub fn gears(errors: Errors, readings: &[Vec<f64>], seed: u64) -> Vec<Effect> {
    let mut random = ChaCha8Rng::seed_from_u64(seed ^ 0x6ea5);
    let mut effects = Vec::new();
    for joint in GEARS {
        let own = effects.len();
        for (order, parts) in errors.waves(&mut random) {
            effects.push(at_joint(Kind::TransmissionError, joint, Driver::Harmonic { joint, order }, parts.to_vec()));
        }
        let mean = readings.iter().map(|row| error(&effects[own..], row[joint])).sum::<f64>() / readings.len() as f64;
        effects.push(at_joint(Kind::JointScale, joint, Driver::Constant, vec![-mean]));
    }
    effects
}

/// Sum of one joint's effects on its reading, rad.
pub fn error(effects: &[Effect], reading: f64) -> f64 {
    let of = |effect: &Effect| match effect.term.driver {
        Driver::Harmonic { order, .. } => {
            effect.coefficients[0] * (order * reading).sin() + effect.coefficients[1] * (order * reading).cos()
        }
        Driver::Constant => effect.coefficients[0],
        _ => 0.0,
    };
    effects.iter().map(of).sum()
}

fn calibrated(effects: Vec<Effect>, readings: Vec<Vec<f64>>, seed: u64, traced: bool) -> Calibration {
    let (chain, statics) = ur5e();
    let rows = readings.len();
    let options = SimulationOptions { rows, seed, readings: Some(readings), ..Default::default() };
    let data = simulate(&chain, &options, &EffectModel::new(statics.clone(), effects)).data;
    let mut options = CalibrateOptions::geometry(&chain);
    options.trace = traced.then(|| TraceOptions::new(options.identify.clone()));
    options.curves = (!traced).then(CurveOptions::default);
    calibrate(&chain, &statics, data, None, &options).unwrap()
}

/// Counts of values inside and of all, and the sum of squares of errors divided by standard deviations.
#[derive(Debug, Clone, Copy, Default)]
pub struct Share {
    /// Number of values inside.
    pub inside: f64,
    /// Number of values.
    pub all: f64,
    /// Sum of squares of errors divided by standard deviations.
    pub squares: f64,
}

impl Share {
    fn add(&mut self, error: f64, deviation: f64) {
        self.inside += f64::from(u8::from(error.abs() < NORMAL_95 * deviation));
        self.squares += (error / deviation).powi(2);
        self.all += 1.0;
    }

    fn of(&self, share: f64) -> f64 {
        share / self.all
    }
}

/// The bands of one run's curves, over the fitted rows' readings; the numbers of curves at joints with errors, and at other joints.
pub fn bands(errors: Errors, rows: usize, seed: u64) -> (Share, usize, usize) {
    let readings = readings(rows, seed);
    let truth = gears(errors, &readings, seed);
    let found = calibrated(truth.clone(), readings.clone(), seed, false);
    let mut share = Share::default();
    let curves = found.named().map_or(&[][..], |fit| &fit.effects.curves);
    for curve in curves {
        let own: Vec<Effect> =
            truth.iter().filter(|effect| effect.term.carrier == Carrier::Joint(curve.joint)).cloned().collect();
        for row in &readings {
            let at = row[curve.joint];
            share.add(curve.value(at) - error(&own, at), curve.deviation(at));
        }
    }
    let right = curves.iter().filter(|curve| GEARS.contains(&curve.joint)).count();
    (share, right, curves.len() - right)
}

/// An effect, of a size that moves the tip by about 0.2 mm.
fn one(kind: Kind) -> Effect {
    let joint = 1;
    match kind {
        Kind::JointCompliance => at_joint(kind, joint, Driver::Torque(joint), vec![6e-6]),
        Kind::TransmissionError => at_joint(kind, joint, Driver::Harmonic { joint, order: 3.0 }, vec![2e-4, -2.5e-4]),
        Kind::JointScale => at_joint(kind, joint, Driver::Reading(joint), vec![4e-4]),
        _ => at_joint(Kind::Backlash, joint, Driver::GravitySide(joint), vec![3e-4]),
    }
}

/// The coefficients of one effect in one run: `None` where it was not found.
pub fn coefficients(kind: Kind, rows: usize, seed: u64) -> Option<Share> {
    let truth = one(kind);
    let found = calibrated(vec![truth.clone()], readings(rows, seed), seed, true);
    let trace = found.trace.as_ref()?;
    let same = |effect: &Effect| effect.term == truth.term;
    let at =
        trace.findings.iter().position(|finding| same(&Effect { term: finding.term.clone(), coefficients: vec![] }))?;
    let fit = &trace.fit;
    let first: usize = fit.effects.effects[..at].iter().map(|effect| effect.coefficients.len()).sum();
    let mut share = Share::default();
    for (k, wanted) in truth.coefficients.iter().enumerate() {
        let index = fit.layout.effects.start + first + k;
        share.add(fit.effects.effects[at].coefficients[k] - wanted, fit.deviation(index));
    }
    Some(share)
}

#[allow(dead_code, reason = "the tests take the parts")]
fn main() {
    let runs: u64 = std::env::args().nth(1).map_or(100, |word| word.parse().unwrap());
    println!("| {runs} files each | found | inside 95 % | ± | error over std, rms |\n|---|---|---|---|---|");
    let line = |what: &str, found: String, shares: &[Share]| {
        let sum = |of: &dyn Fn(&Share) -> f64| shares.iter().map(of).sum::<f64>();
        let all = sum(&|share| share.all).max(1.0);
        let inside = sum(&|share| share.inside) / all;
        // Values of one curve are correlated: the spread is that of the runs.
        let count = shares.len().max(1) as f64;
        let spread = (sum(&|share| (share.of(share.inside) - inside).powi(2)) / count).sqrt() / count.sqrt();
        let size = (sum(&|share| share.squares) / all).sqrt();
        println!("| {what} | {found} | {:.1} % | {:.1} | {size:.2} |", inside * 100.0, spread * 100.0);
    };
    let of_curves = |what: &str, errors: Errors, rows: usize, first: u64| -> Vec<(Share, usize, usize)> {
        let found: Vec<(Share, usize, usize)> = (first..first + runs).map(|seed| bands(errors, rows, seed)).collect();
        let (right, wrong) = found.iter().fold((0, 0), |sum, run| (sum.0 + run.1, sum.1 + run.2));
        let shares: Vec<Share> = found.iter().map(|run| run.0).filter(|share| share.all > 0.0).collect();
        let said = format!("{right} of {}, {wrong} at other joints", found.len() * GEARS.len());
        line(&format!("{what}, {rows} rows"), said, &shares);
        found
    };
    if std::env::args().nth(2).is_some_and(|word| word == "others") {
        let worlds = [
            ("kernel, length 0.3 rad, 0.3 mrad", Errors::Kernel(3e-4, 0.3)),
            ("kernel, length 0.15 rad, 1 mrad", Errors::Kernel(1e-3, 0.15)),
            ("kernel, length 1 rad, 0.1 mrad", Errors::Kernel(1e-4, 1.0)),
            ("sines of orders 1.5 to 8, 0.3 mrad", SMOOTH),
            ("sines of orders 6 to 20, 0.3 mrad", Errors::Sines(6.0, 20.0)),
        ];
        for (what, errors) in worlds {
            for rows in [60, 100] {
                of_curves(what, errors, rows, 5000);
            }
        }
        return;
    }
    for rows in [100, 300, 1000] {
        let found = of_curves("error curves", SMOOTH, rows, 7000);
        let whole = found.iter().filter(|run| run.1 == GEARS.len());
        let whole: Vec<Share> = whole.map(|run| run.0).collect();
        if whole.len() < found.len() {
            line("- files with all three joints found", format!("{} of {runs} files", whole.len()), &whole);
        }
    }
    for kind in [Kind::JointCompliance, Kind::TransmissionError, Kind::JointScale, Kind::Backlash] {
        let found: Vec<Share> = (0..runs).filter_map(|seed| coefficients(kind, 200, 9000 + seed)).collect();
        line(&format!("{}, 200 rows", kind.name()), format!("{} of {runs}", found.len()), &found);
    }
}
