//! Residuals of each stage, on request.

use crate::calibration::result::Calibration;
use crate::calibration::stages::{AVERAGED, Beyond, beyond, geometric_stages, kept};
use denavit_identify::parameters::Effects;
use denavit_identify::residual_statistics::{Residual, bound_later, placed, residuals};
use denavit_identify::solve::Fit;
use denavit_measurements::Measurements;

/// Residuals of one stage.
#[derive(Debug, Clone, PartialEq)]
pub struct StageResiduals {
    /// The stage.
    pub name: String,
    /// Of the fitted rows that were kept.
    pub train: Vec<Residual>,
    /// Of the held-out rows.
    pub test: Vec<Residual>,
}

impl StageResiduals {
    fn of<E: Effects>(name: &str, fit: &Fit<E>, train: &Measurements, test: Option<&Measurements>) -> Self {
        let arm = |test| placed(fit, train, test).expect("the held-out rows were placed when the stage was judged");
        let effects = |test| bound_later(&fit.effects, train, test).expect("the effects were bound when it was judged");
        let test = test.map_or_else(Vec::new, |test| residuals(&arm(test), &effects(test), test));
        Self { name: name.into(), train: kept(fit, train), test }
    }
}

impl Calibration {
    /// Residuals, stage by stage, computed on request: there may be a million rows.
    pub fn residuals(&self) -> Vec<StageResiduals> {
        let (train, test) = (&*self.train, self.test.as_deref());
        let geometry = geometric_stages(&self.identification, self.carried.is_some()).into_iter();
        let geometry = geometry.map(|(name, _, fit)| StageResiduals::of(name, fit, train, test));
        let beyond = self.beyond_stages().into_iter();
        let beyond = beyond.map(|stage| StageResiduals::of(&stage.name, &*stage.fit, train, test));
        let averaged = self.averaging.as_ref().ok().map(|found| StageResiduals::of(AVERAGED, &found.fit, train, test));
        geometry.chain(beyond).chain(averaged).collect()
    }

    /// The robot as drawn and the last stage, with residuals of the fitted rows, for plots.
    pub fn first_and_last(&self) -> [StageResiduals; 2] {
        let geometry = geometric_stages(&self.identification, self.carried.is_some());
        let of_geometry = |index: usize| {
            let (name, _, fit) = geometry[index];
            StageResiduals::of(name, fit, &self.train, None)
        };
        let beyond = self.beyond_stages();
        let last = match &self.averaging {
            Ok(found) => Some(StageResiduals::of(AVERAGED, &found.fit, &self.train, None)),
            Err(_) => beyond.last().map(|stage| StageResiduals::of(&stage.name, &*stage.fit, &self.train, None)),
        };
        [of_geometry(0), last.unwrap_or_else(|| of_geometry(geometry.len() - 1))]
    }

    fn beyond_stages(&self) -> Vec<Beyond<'_>> {
        beyond(self.carried.as_ref(), self.curves.as_ref(), self.trace.as_ref())
    }
}
