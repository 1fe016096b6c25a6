//! Two hands of one robot that touch each other or hold a tool: rows as a user would write them, and how near a fit of them comes to the bound.

use crate::webcam::derivatives;
use denavit_calibrate::{Arm, IdentifyOptions, Measurements};
use denavit_identify::identify;
use denavit_identify::parameters::Layout;
use denavit_identify::simulate::two_tips::{TwoTips, apart, simulate, touch, write};
use denavit_identify::simulate::{SimulationOptions, true_target};
use denavit_measurements::import::ImportOptions;
use denavit_measurements::kinds::ObservationKind;
use denavit_measurements::{Units, read_export};
use denavit_model::nalgebra::{DMatrix, DVector, Vector3};
use denavit_model::{Chain, Reading, Tips, urdf};
use std::ops::Range;
use std::sync::Arc;

/// Two arms on a torso that turns.
pub const TWO_ARMS: &str = include_str!("../two_arms.urdf");
/// Scatter of a touch: each axis of the way between the two points, m.
pub const SCATTER: f64 = 1e-4;
/// What a drawing promises, m and rad.
const DRAWN: f64 = 1e-3;
/// Touches that are not fitted.
const LATER: usize = 20;

/// Both hands of a robot: the joints of both, the tips, the two chains.
pub fn both(text: &str) -> (Chain, Arc<Tips>, [Chain; 2]) {
    let robot = urdf::read("robot", text).unwrap();
    let chains = ["left_hand", "right_hand"].map(|tip| robot.chain(None, Some(tip), Reading::Intended).unwrap().value);
    let (chain, tips) = Chain::joined(&chains[0], &chains[1..]).unwrap();
    (chain, Arc::new(tips), chains)
}

/// A robot drawn within the tolerances, and postures in which its hands touch each other.
pub struct Touches {
    pub chain: Chain,
    pub tips: Arc<Tips>,
    pub truth: Arm,
    pub postures: Vec<Vec<f64>>,
}

impl Touches {
    pub fn drawn(rows: usize, seed: u64) -> Self {
        let (chain, tips, _) = both(TWO_ARMS);
        let options = SimulationOptions {
            kind: ObservationKind::Socket,
            rows,
            seed,
            noise_position: SCATTER,
            tips: Some(tips.clone()),
            ..Default::default()
        };
        let TwoTips { arm: truth, readings: postures, .. } = simulate(&chain, &options);
        assert_eq!(postures.len(), rows, "the hands do not reach each other");
        Self { chain, tips, truth, postures }
    }

    /// The rows as a file has them, read.
    pub fn data(&self, postures: &[Vec<f64>]) -> Measurements {
        of_both_hands((&self.chain, &self.tips), (&self.truth, postures), ["contact", "pins"])
    }
}

/// Rows of both hands as a file has them, read; in the last column the same label in each.
fn of_both_hands(
    (chain, tips): (&Chain, &Arc<Tips>),
    (truth, postures): (&Arm, &[Vec<f64>]),
    [column, label]: [&str; 2],
) -> Measurements {
    let run = TwoTips { arm: truth.clone(), readings: postures.to_vec(), outliers: Vec::new(), holding: None };
    let text = write(&run, column, label, &[]);
    let options = ImportOptions { tips: Some(tips.clone()), ..ImportOptions::default() };
    read_export("hands.csv", text.as_bytes(), chain, Units::default(), &options).unwrap().data
}

/// How the way between the points follows axes and points at each posture, three rows for each: where they touch is left out.
fn followed(data: &Measurements, layout: &Layout, arm: &Arm) -> DMatrix<f64> {
    let columns: Vec<usize> =
        layout.joints.clone().chain(layout.places[0].unwrap()..layout.places[1].unwrap() + 3).collect();
    let all = derivatives(data, layout, arm).select_columns(&columns);
    // Of each touch three rows of the right hand follow three of the left one.
    DMatrix::from_fn(all.nrows() / 2, all.ncols(), |row, k| {
        let left = 6 * (row / 3) + row % 3;
        all[(left + 3, k)] - all[(left, k)]
    })
}

/// The same robot by least squares without a prior: the smallest steps that bring the points together. What the touches tell worse than a
/// drawing does stays as drawn (truncated singular values), above all the robot's size: free arms shrink to a point, where their tips meet in
/// every posture.
fn by_least_squares(from: &Arm, postures: &[Vec<f64>], data: &Measurements, layout: &Layout) -> Arm {
    let mut arm = from.clone();
    for _ in 0..8 {
        let left = postures.iter().flat_map(|q| touch(&arm, q).iter().copied().collect::<Vec<f64>>());
        let left = DVector::from_iterator(3 * postures.len(), left);
        let columns = followed(data, layout, &arm);
        let step = columns.svd(true, true).solve(&-left, SCATTER / DRAWN).unwrap();
        let mut whole = vec![0.0; layout.len()];
        let (joints, points) = step.as_slice().split_at(layout.joints.len());
        whole[layout.joints.clone()].copy_from_slice(joints);
        whole[layout.places[0].unwrap()..layout.places[1].unwrap() + 3].copy_from_slice(points);
        arm = layout.stepped(&arm, &whole);
    }
    arm
}

/// Root mean squares over these robots at touches that were not fitted, m for each axis of the way between the points, their scatter left out: as
/// drawn, fitted, by plain least squares, and what the Cramér-Rao bound allows with the tolerances known.
pub fn errors(rows: usize, seeds: Range<u64>) -> [f64; 4] {
    let count = (seeds.end - seeds.start) as f64 * 3.0 * LATER as f64;
    let mut sums = [0.0; 4];
    for seed in seeds {
        let run = Touches::drawn(rows + LATER, seed);
        let (fitted, later) = run.postures.split_at(rows);
        let (data, options) = (run.data(fitted), IdentifyOptions::axes(&run.chain));
        let found = identify(&run.chain, &data, &options);
        let layout = &found.geometric.layout;
        let plain = by_least_squares(&found.nominal.arm, fitted, &data, layout);
        for (sum, arm) in sums.iter_mut().zip([&found.nominal.arm, &found.geometric.arm, &plain]) {
            let off = later.iter().map(|q| touch(arm, q) - touch(&run.truth, q));
            *sum += off.map(|way| way.norm_squared()).sum::<f64>();
        }
        // The bound at the true robot. Parameters in units of a thousandth, for the numbers' sake.
        let all = run.data(&run.postures);
        let whole = Layout::new(&run.chain, &all.scene, &options.freedom, &options.tolerances, Vec::new());
        let truth = Arm { points: vec![Vector3::zeros(); all.scene.points.len()], ..run.truth.clone() };
        let columns = followed(&all, &whole, &truth) * 1e-3;
        let near = columns.rows(0, 3 * rows);
        let mut information = near.transpose() * near / SCATTER.powi(2);
        let joints = whole.joints.len();
        let mut prior = information.view_mut((0, 0), (joints, joints));
        prior += &whole.prior.precision * 1e-6;
        // A point moved along the last axis with nothing to tell it by: as good as free.
        (0..columns.ncols()).for_each(|k| information[(k, k)] += 1e-6);
        let bound = information.cholesky().unwrap().inverse();
        let far = columns.rows(3 * rows, 3 * LATER);
        sums[3] += (far * bound).component_mul(&far.into_owned()).sum();
    }
    sums.map(|sum| (sum / count).sqrt())
}

/// Which share of the 95 % intervals of the way between the points, each axis, holds it, at touches that were not fitted.
pub fn covered(rows: usize, seeds: Range<u64>) -> f64 {
    let (mut inside, mut all) = (0.0, 0.0);
    for seed in seeds {
        let run = Touches::drawn(rows + LATER, seed);
        let (fitted, later) = run.postures.split_at(rows);
        let (data, options) = (run.data(fitted), IdentifyOptions::axes(&run.chain));
        let fit = identify(&run.chain, &data, &options).geometric;
        let judged = run.data(later);
        let whole = Layout::new(&run.chain, &judged.scene, &options.freedom, &options.tolerances, Vec::new());
        let arm = Arm { points: vec![Vector3::zeros(); judged.scene.points.len()], ..fit.arm.clone() };
        let ahead = followed(&judged, &whole, &arm);
        let own = &fit.layout;
        let columns: Vec<usize> =
            own.joints.clone().chain(own.places[0].unwrap()..own.places[1].unwrap() + 3).collect();
        let covariance = fit.covariance.select_columns(&columns).select_rows(&columns);
        let variance = (&ahead * covariance).component_mul(&ahead).column_sum();
        let off = later.iter().flat_map(|q| <[f64; 3]>::from(touch(&fit.arm, q) - touch(&run.truth, q)));
        for (off, variance) in off.zip(variance.iter()) {
            inside += f64::from(u8::from(off.abs() < 1.96 * variance.sqrt()));
            all += 1.0;
        }
    }
    inside / all
}

/// Scatter of a grip: each axis of place, m, and of turn, rad.
const SLACK: [f64; 2] = [1e-4, 2e-4];

/// A robot drawn within the tolerances, and postures in which its hands hold one tool.
pub struct Grips {
    pub chain: Chain,
    pub tips: Arc<Tips>,
    pub truth: Arm,
    pub postures: Vec<Vec<f64>>,
}

impl Grips {
    /// The last [`LATER`] of the postures hold it without scatter.
    pub fn drawn(rows: usize, seed: u64) -> Self {
        let (chain, tips, _) = both(TWO_ARMS);
        let options = SimulationOptions {
            kind: ObservationKind::Grip,
            rows: rows - LATER,
            seed,
            noise_position: SLACK[0],
            noise_orientation: SLACK[1],
            tips: Some(tips.clone()),
            ..Default::default()
        };
        let run = simulate(&chain, &options);
        let exact = SimulationOptions {
            rows: LATER,
            seed: seed + 1000,
            noise_position: 0.0,
            noise_orientation: 0.0,
            ..options
        };
        let later = run.again(&exact).readings;
        let TwoTips { arm: truth, readings: mut postures, .. } = run;
        postures.extend(later);
        assert_eq!(postures.len(), rows, "the hands do not hold the tool");
        Self { chain, tips, truth, postures }
    }

    /// The rows as a file has them, read.
    pub fn data(&self, postures: &[Vec<f64>]) -> Measurements {
        of_both_hands((&self.chain, &self.tips), (&self.truth, postures), ["grip", "bar"])
    }
}

/// How what is [`apart`] follows axes and grips at each posture, six rows for each; and these columns.
fn apart_follows(data: &Measurements, layout: &Layout, arm: &Arm) -> (DMatrix<f64>, Vec<usize>) {
    let columns: Vec<usize> = layout.joints.clone().chain(layout.targets.clone()).collect();
    let held = Arm {
        instruments: (0..data.scene.setups.len())
            .map(|setup| {
                let row = (0..data.len()).find(|&row| data.series_of(data.of_row(row).start).setup == setup);
                true_target(arm, data.reading(row.unwrap()), 0).inverse()
            })
            .collect(),
        ..arm.clone()
    };
    let all = derivatives(data, layout, &held).select_columns(&columns);
    let ahead = DMatrix::from_fn(all.nrows() / 2, all.ncols(), |row, k| {
        let left = 12 * (row / 6) + row % 6;
        all[(left + 6, k)] - all[(left, k)]
    });
    (ahead, columns)
}

/// Root mean squares over these robots at grips that were not fitted, of place (m) and turn (rad): as drawn, fitted, and what the
/// Cramér-Rao bound allows with the tolerances known; and which share of the 95 % intervals holds the truth.
pub fn grip_errors(rows: usize, seeds: Range<u64>) -> ([[f64; 2]; 3], f64) {
    let count = (seeds.end - seeds.start) as f64 * 3.0 * LATER as f64;
    let (mut sums, mut inside) = ([[0.0; 2]; 3], 0.0);
    for seed in seeds {
        let run = Grips::drawn(rows + LATER, seed);
        let (fitted, later) = run.postures.split_at(rows);
        let (data, options) = (run.data(fitted), IdentifyOptions::axes(&run.chain));
        let found = identify(&run.chain, &data, &options);
        let judged = run.data(later);
        let whole = Layout::new(&run.chain, &judged.scene, &options.freedom, &options.tolerances, Vec::new());
        for (sum, arm) in sums.iter_mut().zip([&found.nominal.arm, &found.geometric.arm]) {
            for off in later.iter().map(|q| apart(arm, q)) {
                sum[0] += off.fixed_rows::<3>(0).norm_squared();
                sum[1] += off.fixed_rows::<3>(3).norm_squared();
            }
        }
        let fit = &found.geometric;
        let (ahead, _) = apart_follows(&judged, &whole, &fit.arm);
        let (_, columns) = apart_follows(&data, &fit.layout, &fit.arm);
        let covariance = fit.covariance.select_columns(&columns).select_rows(&columns);
        let variance = (&ahead * covariance).component_mul(&ahead).column_sum();
        for (row, q) in later.iter().enumerate() {
            let left = true_target(&fit.arm, q, 0).rotation;
            let off = apart(&fit.arm, q);
            // In the base frame, as the rows are.
            let off = [0, 3].map(|first| left * off.fixed_rows::<3>(first).into_owned());
            for k in 0..6 {
                inside += f64::from(u8::from(off[k / 3][k % 3].abs() < 1.96 * variance[6 * row + k].sqrt()));
            }
        }
        // The bound at the true robot. Parameters in units of a thousandth, for the numbers' sake.
        let layout = Layout::new(&run.chain, &data.scene, &options.freedom, &options.tolerances, Vec::new());
        let (near, _) = apart_follows(&data, &layout, &run.truth);
        let near = DMatrix::from_fn(near.nrows(), near.ncols(), |row, k| near[(row, k)] * 1e-3 / SLACK[row / 3 % 2]);
        let (far, _) = apart_follows(&judged, &whole, &run.truth);
        let far = far * 1e-3;
        let mut information = near.transpose() * near;
        let joints = layout.joints.len();
        let mut prior = information.view_mut((0, 0), (joints, joints));
        prior += &layout.prior.precision * 1e-6;
        (0..far.ncols()).for_each(|k| information[(k, k)] += 1e-6);
        let bound = information.cholesky().unwrap().inverse();
        let variance = (&far * bound).component_mul(&far).column_sum();
        variance.iter().enumerate().for_each(|(row, variance)| sums[2][row / 3 % 2] += variance);
    }
    (sums.map(|sum| sum.map(|sum| (sum / count).sqrt())), inside / (2.0 * count))
}
