//! What a calibration hands on, and whether rows that it has not seen are worse by it: these judge, they choose nothing.

use denavit_identify::residual_statistics::{Residual, above_zero};
use serde::Serialize;

/// Chance makes a stage that changes nothing look worse on held-out rows in one file of a hundred.
const CHANCE: f64 = 0.01;
/// Fewer held-out rows judge nothing.
const LEAST_ROWS: usize = 4;

/// The stage whose model a calibration hands on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Adopted {
    /// The robot as drawn.
    Nominal,
    /// The robot as an earlier calibration left it, with its effects and error curves if it has some.
    Earlier,
    /// The axes as fitted.
    Geometric,
    /// Axes, effects and error curves of an earlier calibration brought up to date.
    Updated,
    /// Axes and effects.
    Effects,
    /// Axes and error curves of joints.
    Curves,
    /// Everything that may act, averaged, blended with plain geometry.
    Averaged,
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
