//! The weight of an earlier calibration: as much as the new rows support.
//!
//! A posterior is overconfident for a real robot: it treats errors that its model lacks as noise, and an arm may have had a collision
//! since. The earlier rows therefore count with a power between 0 and 1 (the power prior of Ibrahim and Chen): the largest
//! of a few weights such that no other makes the new rows clearly more probable,
//!
//! ```text
//! log p(rows | w) = - ½ Σ_channels (N log σ² + RSS/σ²) - ½ δᵀ P_w δ + ½ log |P_w| + ½ log |C_w|
//! ```
//! with P_w the prior's precision, C_w the joints' covariance after the fit and δ their deviation from the prior's mean, in
//! the directions that the common frame does not absorb (MacKay 1992, Neural Computation 4, 415: Laplace's approximation).

use crate::arm::Arm;
use crate::gauge;
use crate::identify_options::{IdentifyOptions, fit_stage};
use crate::initial_guess::{with_plates_of, with_plates_turned};
use crate::parameters::{Effects, NoEffects};
use crate::solve::{Fit, FitOptions};
use denavit_measurements::Measurements;
use denavit_model::nalgebra::{DMatrix, DVector};

/// The weights that are tried.
pub(super) const WEIGHTS: [f64; 8] = [1.0, 0.5, 0.2, 0.1, 0.03, 0.01, 1e-3, 0.0];
/// Least gain in log probability for a weight below 1: odds of 20 to 1.
pub(super) const CONTRADICTED: f64 = 3.0;
/// A condition smaller than this fraction of the largest is rounding.
const SAYS_NOTHING: f64 = 1e-9;

/// The geometric fit that continues an earlier calibration, and the weight of that.
///
/// While the weight is chosen, gross outliers are found without the earlier calibration, so that it cannot
/// reject what contradicts it.
pub(super) fn continued(
    data: &Measurements,
    start: &Arm,
    weights: &[f64],
    options: &IdentifyOptions,
) -> (Fit<NoEffects>, f64) {
    let counted = |weight: f64, robust: bool| IdentifyOptions {
        earlier: options.earlier.as_ref().map(|earlier| earlier.counted(weight)),
        fit: FitOptions { robust, ..options.fit },
        ..options.clone()
    };
    let by_itself = counted(0.0, options.fit.robust);
    let staged = |arm: &Arm| fit_stage(data, arm, &NoEffects, weights, &by_itself);
    let alone = with_plates_turned(data, staged(start), &staged);
    let tried = WEIGHTS.map(|weight| {
        let fit = fit_stage(data, &alone.arm, &NoEffects, &alone.weights, &counted(weight, false));
        (weight, if fit.converged_or_exact() { log_evidence(data, &fit) } else { f64::NEG_INFINITY })
    });
    let (weight, _) = borne_out(&tried);
    let start = with_plates_of(data, start, &alone.arm);
    (fit_stage(data, &start, &NoEffects, weights, &counted(weight, options.fit.robust)), weight)
}

/// The largest of these weights such that no other makes the rows clearly more probable, and the log probability of the rows.
pub(super) fn borne_out(tried: &[(f64, f64)]) -> (f64, f64) {
    let best = tried.iter().map(|(_, evidence)| *evidence).fold(f64::NEG_INFINITY, f64::max);
    let enough = tried.iter().find(|(_, evidence)| *evidence >= best - CONTRADICTED);
    enough.copied().unwrap_or((0.0, f64::NEG_INFINITY))
}

/// Log probability of the rows under the layout's prior, up to terms that do not depend on the weight.
///
/// Effects, if any, are free under the layout's prior.
pub(super) fn log_evidence<E: Effects>(data: &Measurements, fit: &Fit<E>) -> f64 {
    let channels = &data.scene.channels;
    let mut sums = vec![0.0; channels.len()];
    for (at, square) in fit.squares.iter().enumerate() {
        for (part, channel) in data.series_of(at).channels.iter().enumerate() {
            if let Some(channel) = channel {
                sums[*channel] += fit.weights[at] * square[part];
            }
        }
    }
    let of_rows: f64 = sums
        .iter()
        .zip(&fit.values)
        .zip(&fit.noise.levels)
        .map(|((sum, count), level)| count * level.powi(2).ln() + sum / level.powi(2))
        .sum();
    let layout = &fit.layout;
    // The joints come first, then the effects.
    let (joints, count) = (layout.joints.len(), layout.effects.end);
    let prior = &layout.prior;
    let perturbation = layout.perturbation(&fit.arm, &fit.arm);
    let mut charge = perturbation.dot(&(&prior.precision * &perturbation));
    let mut precision = DMatrix::zeros(count, count);
    precision.view_mut((0, 0), (joints, joints)).copy_from(&prior.precision);
    if let Some(of_effects) = &layout.effects_prior {
        let numbers = fit.effects.numbers();
        charge += of_effects
            .known(&(&perturbation + &prior.mean), &numbers, joints)
            .iter()
            .map(|row| row.residual.powi(2))
            .sum::<f64>();
        precision += of_effects.precision();
    }
    let unit = DVector::from_fn(count, |k, _| match layout.parameters[k].tolerance {
        Some(tolerance) => tolerance,
        None if precision[(k, k)] > 0.0 => precision[(k, k)].sqrt().recip(),
        None => 1.0,
    });
    let of_joints = free_directions(fit, &unit.rows(0, joints).into_owned());
    let mut free = DMatrix::zeros(count, of_joints.ncols() + count - joints);
    free.view_mut((0, 0), of_joints.shape()).copy_from(&of_joints);
    (joints..count).for_each(|k| free[(k, of_joints.ncols() + k - joints)] = 1.0);
    let precision = DMatrix::from_fn(count, count, |i, k| precision[(i, k)] * unit[i] * unit[k]);
    let covariance = DMatrix::from_fn(count, count, |i, k| fit.covariance[(i, k)] / (unit[i] * unit[k]));
    let log_determinant = |matrix: &DMatrix<f64>| {
        let values = (free.transpose() * matrix * &free).symmetric_eigenvalues();
        values.iter().map(|value| value.max(f64::MIN_POSITIVE).ln()).sum::<f64>()
    };
    0.5 * (log_determinant(&precision) + log_determinant(&covariance) - of_rows - charge)
}

/// Orthonormal directions of the joints' parameters, in tolerances, that the common frame does not absorb.
fn free_directions<E>(fit: &Fit<E>, unit: &DVector<f64>) -> DMatrix<f64> {
    let count = unit.len();
    let mut held = gauge::conditions(&fit.layout, &fit.arm).rows(0, count).into_owned();
    for (mut row, unit) in held.row_iter_mut().zip(unit.iter()) {
        row.scale_mut(*unit);
    }
    let sizes: Vec<f64> = held.column_iter().map(|column| column.norm()).collect();
    let largest = sizes.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
    for (mut column, size) in held.column_iter_mut().zip(sizes) {
        column.scale_mut(if size > SAYS_NOTHING * largest { size.recip() } else { 0.0 });
    }
    let eigen = (&held * held.transpose()).symmetric_eigen();
    let free: Vec<usize> = (0..count).filter(|&k| eigen.eigenvalues[k] < SAYS_NOTHING).collect();
    eigen.eigenvectors.select_columns(&free)
}
