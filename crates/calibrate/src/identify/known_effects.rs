//! What a calibration knows of effects and error curves, kept for the next one: the file of effects, standard deviations and
//! correlations of the coefficients.
//!
//! In a calibration's JSON it stands in `posterior`, beside what is known of the axes:
//!
//! ```json
//! "effects": {"model": {"schema": "denavit.effects/1", …}, "fields": 2, "std": [2e-6, …],
//!             "correlations": [[0.1, …], …]}
//! ```
//! `model`: what a file of effects holds; its last `fields` effects are what joints give under gravity beside their curves. `std`: of
//! each coefficient, in the order of the model. Row k of `correlations`: those of coefficient k with each of the axes' parameters,
//! then with the coefficients before it. Curves are kept as they came out, with their spread, and without correlations.

use crate::effects::driver::Statics;
use crate::effects::model::EffectModel;
use crate::effects::saved::SavedEffects;
use crate::identify::solve::Fit;
use denavit_model::Chain;
use denavit_model::nalgebra::DMatrix;
use serde::{Deserialize, Serialize};

/// What a fit knows of effects and curves.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct EffectsPosterior {
    /// As a file of effects.
    model: serde_json::Value,
    /// How many of the last effects are what joints give under gravity.
    fields: usize,
    /// Standard deviation of each coefficient.
    std: Vec<f64>,
    /// For each coefficient its correlations with the axes' parameters and with the coefficients before it.
    correlations: Vec<Vec<f64>>,
}

/// The same, read for a chain.
#[derive(Debug, Clone, PartialEq)]
pub struct KnownEffects {
    /// The effects and curves.
    pub model: SavedEffects,
    /// How many of the last effects are what joints give under gravity.
    pub fields: usize,
    /// Standard deviation of each coefficient.
    pub std: Vec<f64>,
    /// For each coefficient its correlations with the axes' parameters and with the coefficients before it.
    pub correlations: Vec<Vec<f64>>,
}

impl EffectsPosterior {
    /// Of a fit's effects, the last `fields` of which are what joints give under gravity; `None` where it has neither effects nor curves,
    /// or several tips.
    pub fn of(fit: &Fit<EffectModel>, fields: usize) -> Option<Self> {
        let model = &fit.effects;
        if (model.effects.is_empty() && model.curves.is_empty()) || model.statics.tips.several() {
            return None;
        }
        let effects = fit.layout.effects.clone();
        let correlation = |i: usize, k: usize| {
            let size = fit.deviation(i) * fit.deviation(k);
            if size > 0.0 { (fit.covariance[(i, k)] / size).clamp(-1.0, 1.0) } else { 0.0 }
        };
        let with = |i: usize| fit.layout.joints.clone().chain(effects.start..i).map(|k| correlation(i, k)).collect();
        Some(Self {
            model: model.saved().to_value(),
            fields,
            std: effects.clone().map(|index| fit.deviation(index)).collect(),
            correlations: effects.clone().map(with).collect(),
        })
    }

    /// For this chain, whose parameters are so many.
    ///
    /// # Errors
    /// What is wrong with it.
    pub fn read(&self, file: &str, chain: &Chain, parameters: usize) -> Result<KnownEffects, String> {
        let model = SavedEffects::from_value(file, &self.model, &Statics::of_chain(chain));
        let model = model.map_err(|error| error.to_string())?;
        let count: usize = model.effects.iter().map(|effect| effect.coefficients.len()).sum();
        let bad = |why: String| Err(format!("{file}: posterior.effects: {why}; make the file again"));
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
                "each row of correlations needs one between -1 and 1 for each parameter and coefficient before it"
                    .into(),
            );
        }
        if self.fields > model.effects.len() {
            return bad(format!("fields is {}, and there are {} effects", self.fields, model.effects.len()));
        }
        let (std, correlations) = (self.std.clone(), self.correlations.clone());
        Ok(KnownEffects { model, fields: self.fields, std, correlations })
    }
}

impl KnownEffects {
    /// Covariance of these coefficients, and theirs with the axes' parameters, whose standard deviations are given.
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
