//! The findings: each effect's numbers, and its partial residuals.

use crate::Value;
use crate::partial_residuals::PartialResiduals;
use crate::tracer::{State, Tracer};
use denavit_identify::effects::driver::{Driver, unit_of};
use denavit_identify::effects::model::EffectModel;
use denavit_identify::solve::Fit;

impl Tracer<'_> {
    /// The partial residuals of each effect of a state.
    pub(crate) fn all_partial_residuals(&self, state: &State) -> Vec<PartialResiduals> {
        if state.chosen.is_empty() {
            return Vec::new();
        }
        let linear = self.linear(state);
        let scorer = self.scorer(linear);
        let bare = self.refitted(Vec::new(), None);
        (0..state.chosen.len()).map(|index| self.partial_residuals(&scorer, self.linear(&bare), state, index)).collect()
    }
}

/// The numbers of an effect of a fit, the first of them at `first` in its layout.
pub(crate) fn values(fit: &Fit<EffectModel>, index: usize, first: usize) -> Vec<Value> {
    let effect = &fit.effects.effects[index];
    let statics = &fit.effects.statics;
    let mut values: Vec<Value> = effect
        .coefficients
        .iter()
        .enumerate()
        .map(|(k, value)| {
            let (name, carrier, driver) = effect.term.coefficient_name(statics, k);
            let variance = fit.covariance[(first + k, first + k)];
            let unit = if driver == "1" { carrier.to_string() } else { format!("{carrier}/({driver})") };
            Value { name, value: *value, std: Some(variance.max(0.0).sqrt()), unit }
        })
        .collect();
    let chosen = |name: &str, value: f64, unit: &str| Value { name: name.into(), value, std: None, unit: unit.into() };
    match &effect.term.driver {
        Driver::Harmonic { order, .. } => values.push(chosen("order", *order, "1")),
        Driver::Bump { joint, at, width, .. } => {
            let unit = Driver::Reading(*joint).unit(&statics.chain, 0);
            values.extend([chosen("at", *at, unit), chosen("width", *width, unit)]);
        }
        Driver::HardeningTorque { joint, knee } => {
            values.push(chosen("knee", *knee, Driver::Torque(*joint).unit(&statics.chain, 0)));
        }
        Driver::FrictionSide { side, friction } => {
            values.push(chosen("friction", *friction, Driver::Torque(side.joint).unit(&statics.chain, 0)));
        }
        Driver::Decay { constant, covariate, .. } => {
            values.push(chosen("time_constant", *constant, unit_of(covariate.name())));
        }
        Driver::Steps { at, covariate } => {
            let unit = unit_of(covariate.name());
            values.extend(at.iter().enumerate().map(|(k, at)| chosen(&format!("at_{}", k + 1), *at, unit)));
        }
        _ => {}
    }
    values
}
