//! The adopted stage of a calibration, and whether held-out rows are worse with it: they test stages but do not choose one.

use denavit_identify::effects::averaged::Averaged;
use denavit_identify::effects::model::EffectModel;
use denavit_identify::parameters::NoEffects;
use denavit_identify::residual_statistics::{Residual, above_zero};
use denavit_identify::solve::Fit;
use serde::Serialize;

/// Significance level: a stage that changes nothing looks worse on held-out rows in one file of a hundred.
const CHANCE: f64 = 0.01;
/// Smallest number of held-out rows for this test.
const LEAST_ROWS: usize = 4;

/// The stage whose model is the result of a calibration.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Adopted {
    /// The robot as drawn.
    Nominal,
    /// The robot of an earlier calibration, with its effects and error curves if it has some.
    Earlier,
    /// The axes as fitted.
    Geometric,
    /// Updated axes, effects and error curves of an earlier calibration.
    Updated,
    /// Axes and effects.
    Effects,
    /// Axes and error curves of joints.
    Curves,
    /// The average over the possible models, blended with plain geometry.
    Averaged,
}

/// The fit of the adopted stage.
#[derive(Debug, Clone, Copy)]
pub enum AdoptedFit<'a> {
    /// Geometry alone.
    Geometry(&'a Fit<NoEffects>),
    /// With effects or error curves.
    Named(&'a Fit<EffectModel>),
    /// Everything that may act, averaged.
    Averaged(&'a Fit<Averaged>),
}

/// Whether held-out rows are worse after a stage than before it, by more than chance.
///
/// Student's test of the mean change of the squared error, row by row; of poses, position and orientation each in units of
/// its rms before. Both lists are of the same rows and targets in the same order.
pub fn worse(before: &[Residual], after: &[Residual]) -> bool {
    let count = before.len();
    if count < LEAST_ROWS || count != after.len() {
        return false;
    }
    let mean = |values: &dyn Fn(&Residual) -> f64| before.iter().map(values).sum::<f64>() / count as f64;
    let moved = mean(&|residual| residual.place.norm_squared());
    let turned = mean(&|residual| residual.turn.norm_squared());
    let size = |residual: &Residual| {
        let share = |square: f64, unit: f64| if unit > 0.0 { square / unit } else { 0.0 };
        share(residual.place.norm_squared(), moved) + share(residual.turn.norm_squared(), turned)
    };
    let changes: Vec<f64> = before.iter().zip(after).map(|(before, after)| size(after) - size(before)).collect();
    above_zero(&changes, CHANCE)
}
