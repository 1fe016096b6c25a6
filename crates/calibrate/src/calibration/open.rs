//! What a calibration left open, and the poses that would settle it.

use crate::apply::plan::tell_apart::{TellApart, tell_apart};
use crate::apply::plan::{PlanError, PlanOptions};
use crate::calibration::Calibration;
use crate::effects::driver::Statics;
use crate::effects::survey::Survey;
use crate::trace::infer::hypotheses::Open;
use std::sync::Arc;

impl Calibration {
    /// The sets of causes that the run leaves possible; where nothing is open the one model that was adopted, with its geometry,
    /// effects and curves.
    pub fn open(&self, statics: &Statics) -> Arc<Open> {
        if let Some(open) = self.trace.as_ref().and_then(|found| found.open.clone()) {
            return open;
        }
        let survey = Survey::of(statics, &self.train, Vec::new());
        let geometric = &self.identification.geometric;
        let plain = || geometric.with_model(statics);
        let fit = self.beyond_geometry().cloned().unwrap_or_else(plain);
        Arc::new(Open::of_fit(&survey, &self.train, &fit, &geometric.arm))
    }

    /// Chooses poses to measure next: those that tell apart what the run left open, else those that make the prediction
    /// surest; see [`tell_apart`](crate::apply::plan::tell_apart).
    ///
    /// # Errors
    /// Too few candidates, one of the wrong length, an observation that holds the target; a system without a solution.
    pub fn tell_apart(&self, statics: &Statics, options: &PlanOptions, exchange: bool) -> Result<TellApart, PlanError> {
        tell_apart(&self.open(statics), &self.train, options, exchange)
    }
}
