//! Causes that a calibration cannot distinguish, and the poses that would.

use crate::apply::plan::tell_apart::{Prospect, TellApart, tell_apart};
use crate::apply::plan::{PlanError, PlanOptions};
use crate::calibration::result::Calibration;
use denavit_identify::arm::Arm;
use denavit_identify::carried::Carried;
use denavit_identify::effects::driver::Statics;
use denavit_identify::effects::model::EffectModel;
use denavit_identify::effects::survey::Survey;
use denavit_identify::solve::Fit;
use denavit_measurements::Measurements;
use denavit_measurements::kinds::ObservationKind;
use denavit_trace::Trace;
use denavit_trace::infer::hypotheses::Open;
use std::sync::Arc;

/// Poses that the report speaks of.
pub const MORE_POSES: usize = 20;
/// Number of candidates for them.
const FEW_CANDIDATES: usize = 40;

impl Calibration {
    /// The possible sets of causes of the run; if no cause is uncertain, only the adopted model, with its geometry, effects and curves.
    pub fn open(&self, statics: &Statics) -> Arc<Open> {
        let geometric = &self.identification.geometric;
        let earlier = self.carried.as_ref().map(Carried::beside);
        let fit = || self.named().cloned().unwrap_or_else(|| geometric.with_model(statics, earlier.as_ref()));
        open(self.trace.as_ref(), statics, &self.train, fit, &geometric.arm)
    }

    /// Chooses poses to measure next: those that distinguish causes that the run cannot, else those that reduce the variance of the
    /// prediction; see [`tell_apart`](crate::apply::plan::tell_apart).
    ///
    /// # Errors
    /// Too few candidates, one of the wrong length, an observation that holds the target; a system without a solution.
    pub fn tell_apart(&self, statics: &Statics, options: &PlanOptions) -> Result<TellApart, PlanError> {
        tell_apart(&self.open(statics), &self.train, options)
    }
}

/// The possible sets of causes; if none is uncertain, only this model.
pub(super) fn open(
    found: Option<&Trace>,
    statics: &Statics,
    data: &Measurements,
    fit: impl FnOnce() -> Fit<EffectModel>,
    reference: &Arm,
) -> Arc<Open> {
    let of_fit = || Arc::new(Open::of_fit(&Survey::of(statics, data, Vec::new()), data, &fit(), reference));
    found.and_then(|found| found.open.clone()).unwrap_or_else(of_fit)
}

/// What further poses would decide about these sets of causes; `None` if poses cannot be planned. Cheap: few candidates.
pub(super) fn prospect(open: &Open, data: &Measurements) -> Option<Prospect> {
    let usual = PlanOptions::new(&open.arm().nominal, MORE_POSES, ObservationKind::Position);
    let options = PlanOptions { spread: FEW_CANDIDATES, ..usual };
    tell_apart(open, data, &options).ok().map(|planned| planned.prospect)
}
