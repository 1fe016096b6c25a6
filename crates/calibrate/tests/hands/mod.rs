//! Two hands of one robot that touch each other: rows as a user would write them, and how near a fit of them comes to the bound.

use crate::postures::brought_to;
use crate::webcam::derivatives;
use denavit_calibrate::apply::simulate::{SimulationOptions, readings, simulate, true_target};
use denavit_calibrate::observation::kinds::POSITION;
use denavit_calibrate::observation::measurements::import::ImportOptions;
use denavit_calibrate::observation::measurements::{Units, read_export};
use denavit_calibrate::{Arm, IdentifyOptions, Layout, Measurements, NoEffects, identify};
use denavit_model::nalgebra::{DMatrix, DVector, Vector3};
use denavit_model::{Chain, Reading, Tips, urdf};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::StandardNormal;
use std::fmt::Write as _;
use std::ops::Range;
use std::sync::Arc;

/// Two arms on a torso that turns.
pub const TWO_ARMS: &str = include_str!("../two_arms.urdf");
/// Scatter of a touch: each axis of the way between the two points, m.
pub const SCATTER: f64 = 1e-4;
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
        let options =
            SimulationOptions { kind: POSITION, rows: 1, seed, tips: Some(tips.clone()), ..Default::default() };
        let truth = simulate(&chain, &options, &NoEffects).arm;
        let mut random = ChaCha8Rng::seed_from_u64(seed ^ 0x0070_75c4);
        let mut postures = Vec::new();
        for round in 0..40 {
            for start in readings(&chain, 2 * rows, seed + 1000 * round) {
                let mut error = || SCATTER * random.sample::<f64, _>(StandardNormal);
                let apart = Vector3::new(error(), error(), error());
                if postures.len() < rows {
                    postures.extend(brought_to(&chain, |q| apart - between(&truth, q), start));
                }
            }
        }
        assert_eq!(postures.len(), rows, "the hands do not reach each other");
        Self { chain, tips, truth, postures }
    }

    /// The rows as a file has them, read.
    pub fn data(&self, postures: &[Vec<f64>]) -> Measurements {
        let names: Vec<&str> = self.chain.coordinates().iter().map(|coordinate| coordinate.name.as_str()).collect();
        let mut text = format!("tip,{},contact\n", names.join(","));
        for q in postures {
            let cells: Vec<String> = q.iter().map(f64::to_string).collect();
            let _ = writeln!(text, "left_hand+right_hand,{},pins", cells.join(","));
        }
        let options = ImportOptions { tips: Some(self.tips.clone()), ..ImportOptions::default() };
        read_export("touches.csv", text.as_bytes(), &self.chain, Units::default(), &options).unwrap().data
    }
}

/// From the point on the right hand to that on the left one, m.
pub fn between(arm: &Arm, q: &[f64]) -> Vector3<f64> {
    true_target(arm, q, 0).translation.vector - true_target(arm, q, 1).translation.vector
}

/// How the way between the points follows axes and points at each posture, three rows for each: where they touch is left out.
fn followed(data: &Measurements, layout: &Layout, arm: &Arm) -> DMatrix<f64> {
    let columns: Vec<usize> = layout.joints.clone().chain(layout.places[0]..layout.places[1] + 3).collect();
    let all = derivatives(data, layout, arm).select_columns(&columns);
    // Of each touch three rows of the right hand follow three of the left one.
    DMatrix::from_fn(all.nrows() / 2, all.ncols(), |row, k| {
        let left = 6 * (row / 3) + row % 3;
        all[(left + 3, k)] - all[(left, k)]
    })
}

/// The same robot by least squares without tolerances: the smallest steps that bring the points together.
fn by_least_squares(from: &Arm, postures: &[Vec<f64>], data: &Measurements, layout: &Layout) -> Arm {
    let mut arm = from.clone();
    for _ in 0..8 {
        let left = postures.iter().flat_map(|q| between(&arm, q).iter().copied().collect::<Vec<f64>>());
        let left = DVector::from_iterator(3 * postures.len(), left);
        let columns = followed(data, layout, &arm);
        let step = columns.svd(true, true).solve(&-left, 1e-9).unwrap();
        let mut whole = vec![0.0; layout.len()];
        let (joints, points) = step.as_slice().split_at(layout.joints.len());
        whole[layout.joints.clone()].copy_from_slice(joints);
        whole[layout.places[0]..layout.places[1] + 3].copy_from_slice(points);
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
            let off = later.iter().map(|q| between(arm, q) - between(&run.truth, q));
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
