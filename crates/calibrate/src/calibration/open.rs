//! Causes that a calibration cannot distinguish, and the poses that would.

use crate::apply::plan::tell_apart::{Prospect, TellApart, tell_apart};
use crate::apply::plan::{PlanError, PlanOptions};
use crate::calibration::Calibration;
use denavit_identify::carried::Carried;
use denavit_identify::effects::driver::Statics;
use denavit_identify::effects::survey::Survey;
use denavit_measurements::kinds::ObservationKind;
use denavit_trace::infer::hypotheses::Open;
use std::sync::Arc;

/// Poses that the report speaks of.
pub const MORE_POSES: usize = 20;
/// Number of candidates for them.
const FEW_CANDIDATES: usize = 60;

impl Calibration {
    /// The possible sets of causes of the run; if no cause is uncertain, only the adopted model, with its geometry, effects and curves.
    pub fn open(&self, statics: &Statics) -> Arc<Open> {
        if let Some(open) = self.trace.as_ref().and_then(|found| found.open.clone()) {
            return open;
        }
        let survey = Survey::of(statics, &self.train, Vec::new());
        let geometric = &self.identification.geometric;
        let earlier = self.carried.as_ref().map(Carried::beside);
        let plain = || geometric.with_model(statics, earlier.as_ref());
        let fit = self.named().cloned().unwrap_or_else(plain);
        Arc::new(Open::of_fit(&survey, &self.train, &fit, &geometric.arm))
    }

    /// Chooses poses to measure next: those that distinguish causes that the run cannot, else those that reduce the variance of the
    /// prediction; see [`tell_apart`](crate::apply::plan::tell_apart).
    ///
    /// # Errors
    /// Too few candidates, one of the wrong length, an observation that holds the target; a system without a solution.
    pub fn tell_apart(&self, statics: &Statics, options: &PlanOptions) -> Result<TellApart, PlanError> {
        tell_apart(&self.open(statics), &self.train, options)
    }

    /// What further poses would decide about causes that are not named; `None` if all are named or poses cannot be planned. Cheap: few candidates.
    pub(super) fn prospect(&self, statics: &Statics) -> Option<Prospect> {
        if self.report.one_of.is_empty() {
            return None;
        }
        let usual = PlanOptions::new(&self.arm().nominal, MORE_POSES, ObservationKind::Position);
        let options = PlanOptions { spread: FEW_CANDIDATES, ..usual };
        self.tell_apart(statics, &options).ok().map(|planned| planned.prospect)
    }
}
