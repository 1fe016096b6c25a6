//! The JSON of `calibrate`: names and order are a contract.

use crate::errors::Errors;
use serde::Serialize;
use serde_json::{Map, Value};

/// Version of the contract.
pub const SCHEMA: &str = "denavit.calibration/1";

/// The result of a calibration.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CalibrationReport {
    /// [`SCHEMA`].
    pub schema: &'static str,
    /// The robot's name.
    pub robot: String,
    /// Name of the base link.
    pub base: String,
    /// Name of the tip link.
    pub tip: String,
    /// What was measured: `pose`, `position`, `distance`, or several joined by `+`.
    pub measurement: String,
    /// Rows used.
    pub samples: Samples,
    /// Counts of parameters.
    pub identifiability: Counts,
    /// What cannot be told.
    pub unidentifiable: Vec<Unidentifiable>,
    /// Error after each stage.
    pub stages: Vec<Stage>,
    /// Effects that the data ask for.
    pub effects: Vec<EffectEntry>,
    /// What no effect explains.
    pub unexplained: Unexplained,
}

/// Rows used.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Samples {
    /// Rows fitted, rejected ones included.
    pub train: usize,
    /// Rows held out; `locate` rows not counted.
    pub test: usize,
    /// Rows with a rejected value: their lines in the file.
    pub rejected: Vec<usize>,
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
pub struct Unidentifiable {
    /// Its name.
    pub parameter: String,
    /// Its joint; empty where it has none.
    pub joint: String,
    /// Why.
    pub why: String,
}

/// Error after a stage.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Stage {
    /// `nominal`, `geometric`, `geometric + <kind>(<where>)` …
    pub name: String,
    /// On the fitted rows, rejected ones left out.
    pub train: Errors,
    /// On the held-out rows; absent without any.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub test: Option<Errors>,
}

/// An effect that the data ask for.
#[derive(Debug, Clone, PartialEq, Serialize)]
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
    /// Probability that chance makes the best of all candidates look as good.
    pub p_value: f64,
    /// Fall of the information criterion.
    pub delta_bic: f64,
    /// What the data cannot tell it from.
    pub ambiguous_with: Vec<Rival>,
}

/// A rival of an effect.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Rival {
    /// Its kind.
    pub kind: String,
    /// Where it acts: a joint, or `base`, `target`, …
    pub joint: String,
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
    pub places: Vec<crate::trace::Structure>,
}

impl CalibrationReport {
    /// As JSON text, indented.
    pub fn to_json(&self) -> String {
        serde_json::to_string_pretty(self).expect("names are texts and numbers are numbers")
    }
}
