//! Runs made by pinocchio (`tests/oracle/calibration/runs.py`), the fit to one, and what the fit is to be judged by.

use denavit_calibrate::{Arm, IdentifyOptions, Measurements};
use denavit_identify::Identification;
use denavit_identify::gauge;
use denavit_identify::identify;
use denavit_identify::parameters::NoEffects;
use denavit_identify::residual_statistics::{Residual, residuals};
use denavit_identify::solve::Fit;
use denavit_measurements::{Units, read};
use denavit_model::nalgebra::{Matrix3, Rotation3, Vector3};
use denavit_model::{Chain, Pose, Reading, se3, urdf};
use serde::Deserialize;

/// One line of the file; its fields are described in `runs.py`.
#[derive(Debug, Deserialize)]
struct Line {
    case: String,
    noise_m: f64,
    noise_rad: f64,
    nominal: String,
    built: String,
    train: String,
    test: String,
    instrument: Vec<f64>,
    tool: Vec<Vec<f64>>,
    anchor: [f64; 3],
    outliers: Vec<usize>,
    rounding_m: f64,
    rank: Option<usize>,
    attainable_m: Option<f64>,
}

/// A run, read.
#[derive(Debug)]
pub struct Run {
    pub case: String,
    /// m and rad.
    pub noise: [f64; 2],
    pub chain: Chain,
    pub train: Measurements,
    /// Unseen, without noise.
    pub test: Measurements,
    /// What was measured with, written with the nominal home pose.
    pub truth: Arm,
    pub outliers: Vec<usize>,
    pub rounding: f64,
    pub rank: Option<usize>,
    /// Of one component over the test rows, m.
    pub attainable: Option<f64>,
}

fn pose(m: &[f64]) -> Pose {
    let rotation = Matrix3::from_fn(|row, column| m[4 * row + column]);
    se3::pose(Rotation3::from_matrix_unchecked(rotation), Vector3::new(m[3], m[7], m[11]))
}

fn chain(text: &str) -> Chain {
    let robot = urdf::read("run", text).unwrap();
    robot.chain(Some("base"), Some("tip"), Reading::AsWritten).unwrap().value
}

/// The case of a line, which comes first in it, without reading the rest.
pub fn case_of(line: &str) -> &str {
    line.strip_prefix("{\"case\": \"").and_then(|rest| rest.split('"').next()).unwrap()
}

impl Run {
    pub fn parse(line: &str) -> Self {
        let line: Line = serde_json::from_str(line).unwrap();
        let (nominal, built) = (chain(&line.nominal), chain(&line.built));
        let data = |text: &str| read(&line.case, text.as_bytes(), &nominal, Units::default()).unwrap().data;
        let train = data(&line.train);
        // base_from_tip · tool = motion · built home · tool = motion · nominal home · target
        let home = nominal.home().inverse() * built.home();
        let truth = Arm {
            joints: built.joints().to_vec(),
            instruments: vec![pose(&line.instrument)],
            points: vec![Vector3::from(line.anchor); train.scene.points.len()],
            targets: line.tool.iter().map(|tool| home * pose(tool)).collect(),
            ..Arm::new(&nominal, &train.scene)
        };
        Self {
            train,
            test: data(&line.test),
            truth,
            chain: nominal,
            case: line.case,
            noise: [line.noise_m, line.noise_rad],
            outliers: line.outliers,
            rounding: line.rounding_m,
            rank: line.rank,
            attainable: line.attainable_m,
        }
    }

    pub fn identify(&self) -> Identification {
        identify(&self.chain, &self.train, &IdentifyOptions::axes(&self.chain))
    }

    /// Rows with a rejected value.
    pub fn rejected(&self, fit: &Fit<NoEffects>) -> Vec<usize> {
        let out = |row: &usize| fit.weights[self.train.of_row(*row)].contains(&0.0);
        (0..self.train.len()).filter(out).collect()
    }

    /// Root mean square of one component, and the largest error (its norm), on the unseen poses, m.
    pub fn unseen(&self, arm: &Arm) -> (f64, f64) {
        let found = residuals(arm, &NoEffects, &self.test);
        let components = self.train.scene.channels[0].height as f64;
        let squares: f64 = found.iter().map(|residual| residual.place.norm_squared()).sum();
        let largest = found.iter().map(Residual::distance).fold(0.0, f64::max);
        ((squares / components / found.len() as f64).sqrt(), largest)
    }
}

/// Standard deviation that a measured number cannot reach, rad or m.
const FIXED_BY_FRAME: f64 = 1e-12;

/// What a fit to a noisy run is judged by.
pub struct Score {
    /// Joint and target parameters whose 95 % interval holds the truth.
    pub inside: f64,
    pub parameters: f64,
    /// Of the kept rows, in the true noise.
    pub chi_squared: f64,
    pub degrees_of_freedom: f64,
    /// p / N: numbers that the data tell over numbers measured and kept.
    pub load: f64,
    /// Mean square of the unseen error of one component, noise of the test left out, in units of the noise.
    pub unseen: f64,
    /// The same for the best unbiased fit.
    pub attainable: f64,
}

impl Score {
    pub fn of(run: &Run, found: &Identification) -> Self {
        let fit = &found.geometric;
        // The same robot in the frame that the fit reports in.
        let truth = gauge::centred(&fit.layout, &run.truth, &fit.arm);
        let difference = |arm: &Arm| fit.layout.difference(arm, &truth);
        let (expected, estimated) = (difference(&truth), difference(&fit.arm));
        // What the frame itself fixes (a SCARA's target along its parallel axes) is known without spread.
        let identifiable = || {
            let reported = fit.layout.joints.clone().chain(fit.layout.targets.clone());
            reported.filter(|&k| fit.deviation(k) > FIXED_BY_FRAME)
        };
        let inside =
            identifiable().filter(|&k| (estimated[k] - expected[k]).abs() < fit.half_interval(k, 0.95)).count();
        let [position, orientation] = run.noise;
        let chi = |square: &[f64; 2]| square[0] / position.powi(2) + square[1] / orientation.powi(2);
        let values: f64 = fit.values.iter().sum();
        Self {
            inside: inside as f64,
            parameters: identifiable().count() as f64,
            chi_squared: fit.squares.iter().zip(&fit.weights).map(|(square, weight)| weight * chi(square)).sum(),
            degrees_of_freedom: fit.degrees_of_freedom(),
            load: run.rank.unwrap_or_default() as f64 / values,
            unseen: (run.unseen(&fit.arm).0 / position).powi(2),
            attainable: run.attainable.map_or(f64::NAN, |attainable| (attainable / position).powi(2)),
        }
    }
}
