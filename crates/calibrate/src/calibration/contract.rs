//! The JSON of `calibrate`: names and order are a contract.

use crate::apply::plan::tell_apart::Prospect;
use crate::calibration::adoption::Adopted;
use crate::calibration::diagnosis::Corrected;
use crate::calibration::diagnosis::explained::Explained;
use crate::calibration::drawing_differences::DrawingDifference;
use crate::calibration::expected::Expected;
use crate::calibration::placed_anew::PlacedAnew;
use crate::calibration::rows::{Placements, Rows};
use denavit_identify::carried::CarriedPart;
use denavit_identify::lack_of_fit::LackOfFit;
use denavit_identify::noise::NoiseModel;
use denavit_identify::parameters::is_zero;
use denavit_identify::posterior::Posterior;
use denavit_identify::redundancy::Redundancy;
use denavit_identify::residual_statistics::{Errors, LengthFound};
use denavit_measurements::ColumnUse;
use denavit_trace::infer::lines::Line;
use denavit_trace::loads::UndeclaredLoads;
use denavit_trace::masses::LinkMasses;
use serde::Serialize;
use serde_json::{Map, Value};

/// Version of the contract. The second adds `origin`, `placements`, `rows`, `repeats`, `noise`, `curves`, `fields` and `prospect` to the first, and changes
/// nothing of it.
pub const SCHEMA: &str = denavit_identify::posterior::CALIBRATION_SCHEMA;

/// The result of a calibration.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[non_exhaustive]
pub struct CalibrationReport {
    /// [`SCHEMA`].
    pub schema: &'static str,
    /// The program, the date and the files of this result.
    pub origin: Origin,
    /// The robot's name.
    pub robot: String,
    /// Name of the base link.
    pub base: String,
    /// Name of the tip link; of several, all of them with commas between.
    pub tip: String,
    /// The tips, where several were calibrated; left out where there is one.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub tips: Vec<TipEntry>,
    /// What was measured: `pose`, `position`, `distance`, or several joined by `+`.
    pub measurement: String,
    /// The meaning of every column of the data; empty if the rows did not come from a file.
    pub columns: Vec<ColumnUse>,
    /// Assumptions about rows that do not fit the robot as written; left out if they fit.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub read_as: Option<ReadAs>,
    /// Loads at the tip by which setups differ and that no column records: the rows are used with them; left out if there are none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub undeclared_loads: Option<UndeclaredLoads>,
    /// Masses of links that were fitted because the description has none; left out where there are none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub masses: Option<LinkMasses>,
    /// What was moved before the test rows were measured; left out if nothing was.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub placed_anew: Option<PlacedAnew>,
    /// Quantities with more than a fifth of their variation unexplained by the fitted geometry; left out if there are none.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub poorly_explained: Vec<Explained>,
    /// Rows used.
    pub samples: Samples,
    /// Measured numbers and degrees of freedom.
    pub redundancy: Redundancy,
    /// Pure error and lack of fit from repeated postures; left out if there are none.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub repeats: Vec<LackOfFit>,
    /// Components of the noise of the adopted stage; left out if none can be estimated.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub noise: Option<NoiseModel>,
    /// Counts of parameters.
    pub identifiability: Counts,
    /// What is not identifiable.
    pub unidentifiable: Vec<Unidentifiable>,
    /// Error after each stage.
    pub stages: Vec<Stage>,
    /// Which stage the calibrated robot is.
    pub adopted: Adopted,
    /// Where instruments, targets and points were found at that stage.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub placements: Option<Placements>,
    /// How far each axis is from its drawing at that stage.
    pub parameters: Vec<Identified>,
    /// Correlations of the parameters, and their reference: with them the next calibration can continue from here.
    /// Left out if no axis was identified.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub posterior: Option<Posterior>,
    /// Weight of the earlier calibration that this one continues from; left out if there is none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub earlier: Option<Continued>,
    /// Axes that are many tolerances from where they are drawn.
    pub differs_from_drawing: Vec<DrawingDifference>,
    /// The zeros of joints, if they explain nearly as much as fitted axes; else left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub joint_zeros: Option<JointZeros>,
    /// Effects that are certain enough to be named.
    pub effects: Vec<EffectEntry>,
    /// Effects that stay in the model although their cause is uncertain; left out if there are none.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub one_of: Vec<EffectEntry>,
    /// What further poses are expected to decide; left out if no cause is uncertain.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub prospect: Option<Prospect>,
    /// Expected error of the averaged prediction, within the measured ranges and outside; left out if it is not adopted.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub prediction: Option<Expected>,
    /// Error curves of joints, no cause claimed; left out where there is none.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub curves: Vec<CurveEntry>,
    /// Deflections that depend on several joints, no cause claimed; left out if there are none.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub fields: Vec<FieldEntry>,
    /// What no effect explains.
    pub unexplained: Unexplained,
    /// Residuals of the adopted stage, fitted rows first.
    pub rows: Rows,
}

/// A tip of several, and what is of it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TipEntry {
    /// Name of its link.
    pub tip: String,
    /// The joints from the base to it.
    pub joints: Vec<String>,
    /// Its rows that were fitted, rejected ones included.
    pub fitted: usize,
    /// Its rows that were held out.
    pub held_out: usize,
    /// Error of the adopted stage on its fitted rows, rejected ones left out.
    pub train: Errors,
    /// On its held-out rows; absent without any.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub test: Option<Errors>,
}

/// The program, date and files of a result, so that a later reader can check whether it belongs to the data at hand.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Origin {
    /// Program and version.
    pub program: &'static str,
    /// The day of the run in UTC, such as `2026-03-01`; left out if unknown.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub date: Option<String>,
    /// Files of measurements; left out where the rows came from none.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub files: Vec<FileRead>,
}

impl Default for Origin {
    fn default() -> Self {
        Self { program: concat!("denavit ", env!("CARGO_PKG_VERSION")), date: None, files: Vec::new() }
    }
}

/// A file of measurements that was read; of a bag each of its files, and of a camera its intrinsics.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct FileRead {
    /// Its name, as it was given.
    pub file: String,
    /// What it was read for.
    pub used: FileUse,
    /// SHA-256 of its bytes, hexadecimal.
    pub sha256: String,
}

/// What a file is read for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum FileUse {
    /// Its rows are fitted.
    Fit,
    /// Its rows are joint readings with the ball in a socket, fitted.
    Socket,
    /// Its rows judge the fit.
    Test,
    /// It holds the intrinsics of the camera whose pixels were read.
    Camera,
    /// It is an earlier calibration that the fit continues from.
    Prior,
}

/// Weight of an earlier calibration.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Continued {
    /// Weight of its axes: 1 in full, 0 not at all, as far as the new rows agree.
    pub weight: f64,
    /// State of its effects, error curves and deflections under gravity; left out if it has none.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub effects: Vec<CarriedPart>,
}

/// Assumptions about the rows, and how to write them.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ReadAs {
    /// The assumption, as the end of a sentence that begins with "if".
    pub supposed: Vec<String>,
    /// What to write instead.
    pub correction: Vec<String>,
    /// The joints whose readings were changed.
    pub joints: Vec<String>,
    /// Misfit of one component as written and as assumed, m.
    pub misfit_m: [f64; 2],
    /// The same of orientations, rad; 0 where none are measured.
    pub misfit_rad: [f64; 2],
    /// All of it in words.
    #[serde(skip)]
    pub said: String,
}

impl ReadAs {
    pub(super) fn of(corrected: &Corrected) -> Self {
        let mistakes = &corrected.mistakes;
        let joints = mistakes.iter().flat_map(|mistake| mistake.joints());
        Self {
            supposed: mistakes.iter().map(ToString::to_string).collect(),
            correction: mistakes.iter().map(super::diagnosis::mistakes::Mistake::fix).collect(),
            joints: joints.map(str::to_owned).collect(),
            misfit_m: [corrected.before[0], corrected.after[0]],
            misfit_rad: [corrected.before[1], corrected.after[1]],
            said: corrected.said(),
        }
    }
}

/// Rows used.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[non_exhaustive]
pub struct Samples {
    /// Rows fitted, rejected ones included.
    pub train: usize,
    /// Rows held out; `locate` rows not counted.
    pub test: usize,
    /// Rows with a rejected value: their lines in the file.
    pub rejected: Vec<usize>,
    /// Rows that repeat the measured values of the row before although a joint moved; left out of everything.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub stale: Vec<usize>,
    /// Rows that are exact copies of earlier ones, by their lines: each is counted once.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub copies: Vec<usize>,
    /// Test rows that are exact copies of others or of fitted rows, by their lines: left out of the test.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub test_copies: Vec<usize>,
    /// Held-out rows with gross errors, counted nevertheless: their lines in their file.
    pub test_outliers: Vec<usize>,
}

/// A parameter of a joint as it was identified.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Identified {
    /// Its name, such as `elbow_joint.turn_x`.
    pub parameter: String,
    /// Its joint.
    pub joint: String,
    /// Difference from the drawing, in the unit.
    pub change: f64,
    /// Standard deviation, the prior included.
    pub std: f64,
    /// Half the width of the interval that holds the true value with 95 %: Student's, the prior included.
    pub half_interval_95: f64,
    /// `rad`, `m`, `m/rad` or `1`.
    pub unit: &'static str,
    /// The prior's share of the spread: 1 if the data give no information.
    pub held_by_prior: f64,
}

/// Zeros of joints in place of axes.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct JointZeros {
    /// Share of what fitted axes explain (sums of squares).
    pub share: f64,
    /// Joint by joint.
    pub zeros: Vec<Identified>,
}

/// A zero with more than this share from the prior is not determined by the data.
const DETERMINED_BELOW: f64 = 0.5;

impl Identified {
    /// Whether the data determine it, beyond the prior.
    pub fn is_determined(&self) -> bool {
        self.held_by_prior < DETERMINED_BELOW
    }
}

impl CalibrationReport {
    /// The zeros of joints that were fitted, in the chain's order; none where axes were.
    pub fn zeros(&self) -> impl Iterator<Item = &Identified> {
        self.parameters.iter().filter(|parameter| is_zero(&parameter.parameter))
    }
}

/// What holds a parameter that the data cannot identify.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum HeldBy {
    /// It was not moved.
    Nominal,
    /// The prior keeps it near the drawing, together with what it cannot be separated from.
    Prior,
}

/// The paper's count and the numerical rank.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Counts {
    /// 5h + 4r + 2t + n and what the measurement adds.
    pub expected: usize,
    /// Rank of the identification Jacobian.
    pub rank: usize,
}

/// A parameter that the data cannot identify.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[non_exhaustive]
pub struct Unidentifiable {
    /// Its name.
    pub parameter: String,
    /// Its joint; empty where it has none.
    pub joint: String,
    /// Why.
    pub why: String,
    /// What holds it.
    pub held: HeldBy,
}

/// Error after a stage.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Stage {
    /// `nominal`, `geometric`, `geometric + <kind>(<where>)` …, `averaged`.
    pub name: String,
    /// On the fitted rows, rejected ones left out.
    pub train: Errors,
    /// On the held-out rows; absent without any.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub test: Option<Errors>,
    /// Known distances between points as the fitted rows alone say them; absent without any.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub train_lengths: Vec<LengthFound>,
    /// The same of the held-out rows.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub test_lengths: Vec<LengthFound>,
    /// Whether the fit converged.
    pub converged: bool,
    /// Whether this is the calibrated robot.
    pub adopted: bool,
    /// Whether held-out rows are worse than at the stage before, by more than chance; they test stages but do not choose one.
    pub worse_on_held_out: bool,
}

/// A selected effect.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[non_exhaustive]
pub struct EffectEntry {
    /// Its kind.
    pub kind: String,
    /// The joint that it acts at.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub joint: Option<String>,
    /// Where it acts, when that is no joint: `base`, `target`, `anchor`, `instrument`, …
    #[serde(rename = "where", skip_serializing_if = "Option::is_none")]
    pub place: Option<String>,
    /// The recorded quantity that drives it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub covariate: Option<String>,
    /// Its numbers by name: value, standard deviation, unit.
    pub parameters: Map<String, Value>,
    /// Posterior probability that it does not act.
    pub p_value: f64,
    /// Twice the logarithm of the odds of the best model with it against the best without it.
    pub delta_bic: f64,
    /// Posterior probability that this kind acts at this place.
    pub probability: f64,
    /// Share of half-sample refits that select it.
    pub found_again: f64,
    /// The joint that drives it, where that is not the one that it acts at.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub driven_by: Option<String>,
    /// Alternatives, the most probable first.
    pub ambiguous_with: Vec<Rival>,
}

/// A rival of an effect.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Rival {
    /// Its kind.
    pub kind: String,
    /// Where it acts: a joint, or `base`, `target`, …
    pub joint: String,
    /// Posterior probability that it acts and the named effect does not.
    pub probability: f64,
}

/// The error of a joint's value as a smooth function of its own reading, no cause claimed.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[non_exhaustive]
pub struct CurveEntry {
    /// The joint.
    pub joint: String,
    /// Of readings and errors: `rad` or `m`.
    pub unit: &'static str,
    /// Root mean square over the range of the data, about the mean.
    pub rms: f64,
    /// Length scale of its kernel: the distance of readings over which the curve changes.
    pub length: f64,
    /// Standard deviation of the curve far from the data, where its mean is 0.
    pub std_without_data: f64,
    /// Increase of the log marginal likelihood by the curve.
    pub log_evidence: f64,
    /// Sines with a large share of it, the strongest first.
    pub lines: Vec<Line>,
    /// The curve over the range of the data: add it to the reading to have the joint's true value.
    pub table: Vec<CurvePoint>,
}

/// A deflection of a joint under gravity with unknown masses: fitted together with the curves, which would otherwise absorb it. It depends
/// on several joints; no cause is claimed.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FieldEntry {
    /// `gravity`.
    pub kind: &'static str,
    /// The joint that turns by it.
    pub joint: String,
    /// Deflection of the joint over the rows, root mean square about the mean.
    pub rms: f64,
    /// Of that: `rad`, or `m` for a slide.
    pub unit: &'static str,
    /// Increase of the log marginal likelihood by it.
    pub log_evidence: f64,
}

/// A curve at one reading.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[non_exhaustive]
pub struct CurvePoint {
    /// The reading.
    pub at: f64,
    /// What is added to it.
    pub value: f64,
    /// Standard deviation of that.
    pub std: f64,
}

/// What no effect explains.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Unexplained {
    /// Whether the residual has structure.
    pub structured: bool,
    /// Probability of such structure by chance.
    pub p_value: f64,
    /// Where it is, the largest share first.
    #[serde(rename = "where")]
    pub places: Vec<denavit_trace::Structure>,
}

impl CalibrationReport {
    /// As JSON text, indented.
    pub fn to_json(&self) -> String {
        serde_json::to_string_pretty(self).expect("names are texts and numbers are numbers")
    }
}
