//! The calibrated model compared with rows that were measured later.

use crate::calibration::Calibration;
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
        if let Some(fit) = self.beyond_geometry() {
            return self.predicted(fit, &later);
        }
        self.predicted(self.without_effects(), &later)
    }

    fn predicted<E: Effects>(&self, fit: &Fit<E>, later: &Measurements) -> Result<Prediction, TestError> {
        let effects = bound_later(&fit.effects, &self.train, later)?;
        let residuals = residuals(&placed(fit, &self.train, later)?, &effects, later);
        Ok(Prediction { errors: errors(&residuals, &later.scene), residuals })
    }
}
