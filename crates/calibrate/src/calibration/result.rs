//! The result of a calibration: its report, and the fits behind it.

use crate::calibration::adoption::AdoptedFit;
use crate::calibration::contract::CalibrationReport;
use crate::calibration::stages::geometry_at;
use denavit_identify::Identification;
use denavit_identify::arm::Arm;
use denavit_identify::averaging::{Averaging, NotAveraged};
use denavit_identify::carried::Carried;
use denavit_identify::effects::Correction;
use denavit_identify::effects::driver::Statics;
use denavit_identify::effects::model::EffectModel;
use denavit_identify::identifiability::Identifiability;
use denavit_identify::information::Information;
use denavit_identify::parameters::NoEffects;
use denavit_identify::quantization::Rounding;
use denavit_identify::solve::Fit;
use denavit_measurements::Measurements;
use denavit_trace::Trace;
use denavit_trace::infer::curves::CurveFit;
use std::sync::Arc;

/// A calibration's result.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct Calibration {
    /// The contract.
    pub report: CalibrationReport,
    /// Posterior of the parameters in the report from the rows alone, without the prior; `None` if no axis was identified.
    pub information: Option<Information>,
    /// Nominal and geometric fit.
    pub identification: Identification,
    /// The last stage with named causes or error curves.
    pub beyond: Option<Box<Fit<EffectModel>>>,
    /// The recommended prediction, averaged over the possible models; `Err` says why there is none.
    pub averaging: Result<Box<Averaging>, NotAveraged>,
    /// The result of the tracer, if requested.
    pub trace: Option<Trace>,
    /// Error curves of the joints, if requested.
    pub curves: Option<CurveFit>,
    /// The effects and curves of an earlier calibration on these rows, if it has some.
    pub carried: Option<Carried>,
    /// Counts, and what is unidentifiable.
    pub identifiability: Identifiability,
    /// Rounded readings, where there are any.
    pub rounding: Option<Rounding>,
    /// The rows fitted.
    pub train: Arc<Measurements>,
    /// The rows held out.
    pub test: Option<Arc<Measurements>>,
}

impl Calibration {
    /// The fit that was adopted.
    pub fn fit(&self) -> AdoptedFit<'_> {
        match (&self.averaging, self.named()) {
            (Ok(averaging), _) => AdoptedFit::Averaged(&averaging.fit),
            (Err(_), Some(named)) => AdoptedFit::Named(named),
            (Err(_), None) => AdoptedFit::Geometry(self.without_effects()),
        }
    }

    /// The arm at the stage that was adopted.
    pub fn arm(&self) -> &Arm {
        match self.fit() {
            AdoptedFit::Geometry(fit) => &fit.arm,
            AdoptedFit::Named(fit) => &fit.arm,
            AdoptedFit::Averaged(fit) => &fit.arm,
        }
    }

    /// The fit that was adopted, where it holds geometry alone; else the geometric one.
    pub fn without_effects(&self) -> &Fit<NoEffects> {
        geometry_at(&self.identification, self.report.adopted)
    }

    /// The last stage with causes or error curves.
    pub fn named(&self) -> Option<&Fit<EffectModel>> {
        self.beyond.as_deref()
    }

    /// What the adopted stage adds to its arm; nothing if there was no search for effects.
    pub fn effects(&self, statics: &Statics) -> Correction {
        match self.fit() {
            AdoptedFit::Geometry(_) => EffectModel::new(statics.clone(), Vec::new()).into(),
            AdoptedFit::Named(fit) => fit.effects.clone().into(),
            AdoptedFit::Averaged(fit) => fit.effects.clone().into(),
        }
    }
}
