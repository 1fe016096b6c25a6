//! A calibration's posterior of effects and error curves, kept for the next one: the file of effects, standard deviations and
//! correlations of the coefficients.
//!
//! In a calibration's JSON it is in `posterior`, with the posterior of the axes:
//!
//! ```json
//! "effects": {"model": {"schema": "denavit.effects/1", …}, "fields": 2, "std": [2e-6, …],
//!             "modes": [[[1e-5, …], …]], "correlations": [[0.1, …], …]}
//! ```
//! `model`: a file of effects; its last `fields` effects are the compliances of joints that go with the curves. `modes`: for each curve
//! the shapes of its uncertainty, as weights of its waves ([`CurveModes`]). `std`: of each coefficient in the order of the model,
//! then of each mode. Row k of `correlations`: those of number k with each of the axes' parameters, then with the numbers before it.

use crate::effects::curve::Curve;
use crate::effects::curve_modes::CurveModes;
use crate::effects::driver::Statics;
use crate::effects::model::EffectModel;
use crate::effects::saved::SavedEffects;
use crate::solve::Fit;
use denavit_model::Chain;
use denavit_model::nalgebra::DMatrix;
use serde::{Deserialize, Serialize};

/// A fit's posterior of effects and curves.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct EffectsPosterior {
    /// As a file of effects.
    model: serde_json::Value,
    /// How many of the last effects are compliances of joints.
    fields: usize,
    /// For each curve its modes, as weights of its waves.
    #[serde(default)]
    modes: Vec<Vec<Vec<f64>>>,
    /// Standard deviation of each coefficient, then of each mode.
    std: Vec<f64>,
    /// For each of these its correlations with the axes' parameters and with the numbers before it.
    correlations: Vec<Vec<f64>>,
}

/// The same, read for a chain.
#[derive(Debug, Clone, PartialEq)]
pub struct KnownEffects {
    /// The effects and curves.
    pub model: SavedEffects,
    /// How many of the last effects are compliances of joints.
    pub fields: usize,
    /// For each curve its modes, as weights of its waves.
    pub modes: Vec<Vec<Vec<f64>>>,
    /// Standard deviation of each coefficient, then of each mode.
    pub std: Vec<f64>,
    /// For each of these its correlations with the axes' parameters and with the numbers before it.
    pub correlations: Vec<Vec<f64>>,
}

impl EffectsPosterior {
    /// Of a fit's effects, the last `fields` of which are compliances of joints; `None` where it has neither effects nor curves, or
    /// several tips.
    pub fn of(fit: &Fit<EffectModel>, fields: usize, modes: &CurveModes) -> Option<Self> {
        let model = &fit.effects;
        if (model.effects.is_empty() && model.curves.is_empty()) || model.statics.tips.several() {
            return None;
        }
        let effects = fit.layout.effects.clone();
        let (joints, coefficients) = (fit.layout.joints.len(), effects.len());
        // Axes, coefficients, modes.
        let covariance = |i: usize, k: usize| match (i.checked_sub(effects.end), k.checked_sub(effects.end)) {
            (None, None) => fit.covariance[(i, k)],
            (Some(i), Some(k)) => modes.covariance[(i, k)],
            (Some(i), None) => modes.cross[(i, k)],
            (None, Some(k)) => modes.cross[(k, i)],
        };
        let deviation = |i: usize| covariance(i, i).max(0.0).sqrt();
        let correlation = |i: usize, k: usize| {
            let size = deviation(i) * deviation(k);
            if size > 0.0 { (covariance(i, k) / size).clamp(-1.0, 1.0) } else { 0.0 }
        };
        let numbers = joints..joints + coefficients + modes.covariance.nrows();
        Some(Self {
            model: model.saved().to_value(),
            fields,
            modes: modes.shapes.clone(),
            std: numbers.clone().map(deviation).collect(),
            correlations: numbers.map(|i| (0..i).map(|k| correlation(i, k)).collect()).collect(),
        })
    }

    /// For this chain, with this number of parameters.
    ///
    /// # Errors
    /// What is wrong with the file.
    pub fn read(&self, file: &str, chain: &Chain, parameters: usize) -> Result<KnownEffects, String> {
        let model = SavedEffects::from_json(file, &self.model.to_string(), &Statics::of_chain(chain));
        let model = model.map_err(|error| error.to_string())?;
        let coefficients: usize = model.effects.iter().map(|effect| effect.coefficients.len()).sum();
        let mut modes = self.modes.clone();
        modes.resize(model.curves.len(), Vec::new());
        let count = coefficients + modes.iter().map(Vec::len).sum::<usize>();
        let bad = |why: String| Err(format!("{file}: posterior.effects: {why}; make the file again"));
        let fits = |(curve, modes): (&Curve, &Vec<Vec<f64>>)| {
            modes.iter().all(|mode| mode.len() == curve.waves.len() && mode.iter().all(|weight| weight.is_finite()))
        };
        if self.modes.len() > model.curves.len() || !model.curves.iter().zip(&modes).all(fits) {
            return bad("modes must match the curves, with a finite number for each wave".into());
        }
        if self.std.len() != count || self.correlations.len() != count {
            return bad(format!("std and correlations need {count} entries each"));
        }
        if self.std.iter().any(|std| !(std.is_finite() && *std >= 0.0)) {
            return bad("std must be finite and not below 0".into());
        }
        let wrong = |(k, row): (usize, &Vec<f64>)| {
            row.len() != parameters + k || row.iter().any(|value| !(-1.0..=1.0).contains(value))
        };
        if self.correlations.iter().enumerate().any(wrong) {
            return bad(
                "each row of correlations needs a number between -1 and 1 for each parameter and number before it"
                    .into(),
            );
        }
        if self.fields > model.effects.len() {
            return bad(format!("fields is {}, but there are {} effects", self.fields, model.effects.len()));
        }
        let (std, correlations) = (self.std.clone(), self.correlations.clone());
        Ok(KnownEffects { model, fields: self.fields, modes, std, correlations })
    }
}

impl KnownEffects {
    /// Covariance of these coefficients and modes, and with the axes' parameters, whose standard deviations are given.
    pub fn covariance(&self, coefficients: &[usize], parameters: &[f64]) -> (DMatrix<f64>, DMatrix<f64>) {
        let (count, joints) = (coefficients.len(), parameters.len());
        let own = |i: usize, k: usize| {
            let (first, last) = (coefficients[i].min(coefficients[k]), coefficients[i].max(coefficients[k]));
            let correlation = if first == last { 1.0 } else { self.correlations[last][joints + first] };
            correlation * self.std[first] * self.std[last]
        };
        let cross = |i: usize, k: usize| {
            let coefficient = coefficients[i];
            self.correlations[coefficient][k] * self.std[coefficient] * parameters[k]
        };
        (DMatrix::from_fn(count, count, own), DMatrix::from_fn(count, joints, cross))
    }
}
