//! The calibrated model compared with rows that were measured later.

use crate::calibration::{AdoptedFit, Calibration};
use denavit_identify::effects::survey::with_run_order_after;
use denavit_identify::parameters::Effects;
use denavit_identify::residual_statistics::{Errors, Residual, TestError, bound_later, errors, placed, residuals};
use denavit_identify::solve::Fit;
use denavit_measurements::Measurements;

/// Errors of the calibrated model's predictions for later rows.
#[derive(Debug, Clone, PartialEq)]
pub struct Prediction {
    /// For every measured quantity.
    pub errors: Errors,
    /// Row by row; `locate` rows left out.
    pub residuals: Vec<Residual>,
}

impl Calibration {
    /// Compare the adopted model, effects included, with rows measured after the fitted ones; sockets count as new positions.
    ///
    /// # Errors
    /// Rows of another kind, of a target or setup that nothing places, or without a column that an effect follows.
    pub fn predict(&self, later: Measurements) -> Result<Prediction, TestError> {
        let later = with_run_order_after(later.placed_again(), &self.train);
        match self.fit() {
            AdoptedFit::Geometry(fit) => self.predicted(fit, &later),
            AdoptedFit::Named(fit) => self.predicted(fit, &later),
            AdoptedFit::Averaged(fit) => self.predicted(fit, &later),
        }
    }

    fn predicted<E: Effects>(&self, fit: &Fit<E>, later: &Measurements) -> Result<Prediction, TestError> {
        let effects = bound_later(&fit.effects, &self.train, later)?;
        let residuals = residuals(&placed(fit, &self.train, later)?, &effects, later);
        Ok(Prediction { errors: errors(&residuals, &later.scene), residuals })
    }
}
