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
    /// By what it was made, when, and of which files.
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
    /// What every column of the data was taken for; empty where the rows came from no file.
    pub columns: Vec<ColumnUse>,
    /// What was supposed of the rows because they fit no robot as they are written; left out where they do.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub read_as: Option<ReadAs>,
    /// Loads at the tip by which setups differ, although no column says so: the rows are used with them; left out where there are none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub undeclared_loads: Option<UndeclaredLoads>,
    /// Masses of links that were fitted because the description has none; left out where there are none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub masses: Option<LinkMasses>,
    /// What was placed anew before the test rows were measured; left out where everything stands as it did.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub placed_anew: Option<PlacedAnew>,
    /// Sorts of values of whose variation the fitted geometry leaves more than a fifth; left out where there is none.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub poorly_explained: Vec<Explained>,
    /// Rows used.
    pub samples: Samples,
    /// Numbers measured beside numbers found.
    pub redundancy: Redundancy,
    /// What postures that were measured more than once say of the noise and of the model; left out where there are none.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub repeats: Vec<LackOfFit>,
    /// What the noise of the adopted stage is made of; left out where nothing can be estimated of it.
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
    /// How the parameters hang together, and what they are counted from: with them the next calibration can continue from here.
    /// Left out where no axis was identified.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub posterior: Option<Posterior>,
    /// What the earlier calibration counted for that this one continues from; left out where there is none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub earlier: Option<Continued>,
    /// Axes that are many tolerances from where they are drawn.
    pub differs_from_drawing: Vec<DrawingDifference>,
    /// The zeros of joints that explain nearly all that the axes do; left out where they do not.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub joint_zeros: Option<JointZeros>,
    /// Effects that are sure enough to be named.
    pub effects: Vec<EffectEntry>,
    /// Effects that stay in the model although there are alternatives; left out if there are none such.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub one_of: Vec<EffectEntry>,
    /// What poses measured next are expected to decide; left out where no cause is uncertain.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub prospect: Option<Prospect>,
    /// How far the averaged prediction is expected to be off, within the measured ranges and outside; left out where it is not adopted.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub prediction: Option<Expected>,
    /// Error curves of joints, no cause claimed; left out where there is none.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub curves: Vec<CurveEntry>,
    /// What depends on several joints and is no named cause; left out where there is none.
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

/// By what a result was made, when, and of which files: who reads it later can tell whether it is of the data at hand.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Origin {
    /// Program and version.
    pub program: &'static str,
    /// The day of the run in UTC, such as `2026-03-01`; left out where nobody said it.
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

/// What an earlier calibration counted for.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Continued {
    /// Of what it knows of the axes: 1 in full, 0 not at all, as much as the new rows bear out.
    pub weight: f64,
    /// What became of its effects, of its error curves and of what joints give under gravity; left out where it has none.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub effects: Vec<CarriedPart>,
}

/// What was supposed of the rows, and how they are to be written.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ReadAs {
    /// What was supposed, as the end of a sentence that begins with "if".
    pub supposed: Vec<String>,
    /// What to write instead.
    pub correction: Vec<String>,
    /// The joints whose readings were changed.
    pub joints: Vec<String>,
    /// Misfit of one component as written and as supposed, m.
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
    /// Held-out rows that are off by far more than the others, and are counted all the same: their lines in their file.
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
    /// DrawingDifference from the drawing, in the unit.
    pub change: f64,
    /// Standard deviation, the prior included.
    pub std: f64,
    /// Half the width of the interval that holds the true value with 95 %: Student's, the prior included.
    pub half_interval_95: f64,
    /// `rad`, `m`, `m/rad` or `1`.
    pub unit: &'static str,
    /// How much of the spread is the prior's: 1 where the data say nothing.
    pub held_by_prior: f64,
}

/// Zeros of joints in place of axes.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct JointZeros {
    /// Share of the squares that the axes explain.
    pub share: f64,
    /// Joint by joint.
    pub zeros: Vec<Identified>,
}

/// A zero of which the prior gives more than this share is not told by the data.
const TOLD_BELOW: f64 = 0.5;

impl Identified {
    /// Whether the data say more of it than what is expected of any robot.
    pub fn is_told(&self) -> bool {
        self.held_by_prior < TOLD_BELOW
    }
}

impl CalibrationReport {
    /// The zeros of joints that were fitted, in the chain's order; none where axes were.
    pub fn zeros(&self) -> impl Iterator<Item = &Identified> {
        self.parameters.iter().filter(|parameter| is_zero(&parameter.parameter))
    }
}

/// What a parameter is held by that the data cannot tell.
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

/// A parameter that the data cannot tell.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[non_exhaustive]
pub struct Unidentifiable {
    /// Its name.
    pub parameter: String,
    /// Its joint; empty where it has none.
    pub joint: String,
    /// Why.
    pub why: String,
    /// What it is held by.
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
    /// Whether this is the calibrated robot that is handed on.
    pub adopted: bool,
    /// Whether held-out rows came out worse than at the stage before, by more than chance; they judge, and choose no stage.
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
    /// Probability that it does not act: what is left of the posterior mass.
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
    /// Posterior probability that it acts and the other does not.
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
    /// How far apart readings must be for the curve to differ: the length scale of its kernel.
    pub length: f64,
    /// How unsure the curve is where no data were: there it is taken as 0.
    pub std_without_data: f64,
    /// By how much the curve raises the logarithm of the marginal likelihood.
    pub log_evidence: f64,
    /// Sines that hold much of it, the strongest first.
    pub lines: Vec<Line>,
    /// The curve over the range of the data: add it to the reading to have the joint's true value.
    pub table: Vec<CurvePoint>,
}

/// What is fitted beside the curves and depends on several joints, no cause claimed: what a joint gives under gravity, with masses that nobody
/// knows, which curves would absorb.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FieldEntry {
    /// `gravity`.
    pub kind: &'static str,
    /// The joint that turns by it.
    pub joint: String,
    /// How far the joint turns by it over the rows, root mean square about the mean.
    pub rms: f64,
    /// Of that: `rad`, or `m` for a slide.
    pub unit: &'static str,
    /// By how much it raises the logarithm of the marginal likelihood.
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
    /// Whether what is left has structure.
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
