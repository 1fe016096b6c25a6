//! The most informative next pose, given the rows measured so far.
//!
//! With C the covariance of a fit's parameters and R a pose's Jacobian over the noise, measuring there makes the determinant of
//! the information det(I + R C Rᵀ) times as large, and the covariance C - C Rᵀ (I + R C Rᵀ)⁻¹ R C: the plan's criterion, a pose
//! at a time.

use super::{Design, PlanError, PlanOptions, allowed, as_predicted, candidates};
use denavit_identify::arm::Arm;
use denavit_identify::parameters::NoEffects;
use denavit_identify::residual::{ResidualModel, Scratch};
use denavit_identify::solve::Fit;
use denavit_measurements::Measurements;
use denavit_model::Chain;
use denavit_model::nalgebra::DMatrix;

/// A pose to measure next.
#[derive(Debug, Clone, PartialEq)]
pub struct NextPose {
    /// One value per coordinate, rad or m.
    pub joints: Vec<f64>,
    /// Covariance of the fit's parameters once it is measured, in their units.
    pub covariance: DMatrix<f64>,
}

/// The candidates evaluated for a fit.
#[derive(Debug, Clone, PartialEq)]
pub struct Outlook {
    /// The most informative candidate; `None` if no candidate can be measured.
    pub next: Option<NextPose>,
    /// Uncertainty of the fit's predictions at the candidates: root mean square over them of the standard deviation of all lengths
    /// together, m, without noise.
    pub prediction: f64,
}

/// The candidates of `options` that are within the joint limits.
///
/// # Errors
/// A candidate has the wrong length.
pub fn within_limits(chain: &Chain, options: &PlanOptions) -> Result<Vec<Vec<f64>>, PlanError> {
    let anywhere = PlanOptions { allowed: None, ..options.clone() };
    let arm = Arm {
        targets: vec![denavit_model::Pose::identity()],
        ..Arm::new(chain, &denavit_measurements::Scene::default())
    };
    Ok(candidates(chain, options)?.into_iter().filter(|q| allowed(chain, &arm, q, &anywhere)).collect())
}

/// Evaluates every candidate (one value per coordinate, rad or m), at which the `series` of the data would be observed.
///
/// Candidates without an observation, or with a target outside the box of `options`, are left out.
pub fn outlook(
    fit: &Fit<NoEffects>,
    data: &Measurements,
    series: &[usize],
    candidates: &[Vec<f64>],
    options: &PlanOptions,
) -> Outlook {
    let arm = &fit.arm;
    let fits = candidates.iter().filter(|q| options.allowed.is_none() || allowed(&arm.nominal, arm, q, options));
    let nothing_yet = Measurements::empty("candidates", data.joints.clone(), data.scene.clone());
    let data = as_predicted(arm, nothing_yet, series, fits);
    let problem = ResidualModel { data: &data, layout: &fit.layout, effects: &NoEffects };
    let (columns, height) = (fit.layout.len(), data.tallest_row());
    let mut scratch = Scratch::new(&fit.layout, arm);
    let (mut residual, mut jacobian) = (vec![0.0; height], vec![0.0; height * columns]);
    let mut best: Option<(f64, usize, DMatrix<f64>)> = None;
    let (mut variance, mut count) = (0.0, 0.0);
    for row in 0..data.len() {
        problem.row_into(arm, row, &mut scratch, &mut residual, Some(&mut jacobian));
        let mut rows =
            DMatrix::from_row_slice(problem.height_of(row), columns, &jacobian[..problem.height_of(row) * columns]);
        variance += over_noise(fit, &data, row, &mut rows);
        count += 1.0;
        let gain = Design::gain(&fit.covariance, &rows);
        if gain.is_finite() && best.as_ref().is_none_or(|(most, ..)| gain > *most) {
            best = Some((gain, row, rows));
        }
    }
    let next = best.and_then(|(_, row, rows)| {
        let covariance = Design::updated(&fit.covariance, &rows, 1.0)?;
        Some(NextPose { joints: data.reading(row).to_vec(), covariance })
    });
    Outlook { next, prediction: if count > 0.0 { f64::sqrt(variance / count) } else { f64::NAN } }
}

/// Divides the rows by the noise of their channels; returns the variance of the predicted lengths, the mean over what is
/// observed, m².
fn over_noise(fit: &Fit<NoEffects>, data: &Measurements, row: usize, rows: &mut DMatrix<f64>) -> f64 {
    let (mut at, mut variance) = (0, 0.0);
    for observation in data.of_row(row) {
        let series = data.series_of(observation);
        let parts = [Some(series.kind.place()), series.kind.turn()];
        for (part, channel) in parts.into_iter().zip(series.channels) {
            let Some(part) = part else { continue };
            let level = channel.map_or(1.0, |channel| fit.noise.levels[channel]);
            for line in at..at + part.height {
                let own = rows.row(line).clone_owned();
                if part.unit == "m" {
                    variance += (&own * &fit.covariance * own.transpose())[(0, 0)] / data.of_row(row).len() as f64;
                }
                rows.row_mut(line).scale_mut(level.recip());
            }
            at += part.height;
        }
    }
    variance
}
