//! Noise of positions that is correlated with that of orientations: a probe turns about a point of its own, so an orientation error also
//! causes a position error, by the lever from that point to the target.
//!
//! With ω the noise of an orientation and R base_from_target, ω × (R ℓ) is added to the noise of the position, ℓ constant in the target's
//! axes. The lever is tested by a score test at ℓ = 0, which takes one evaluation: the derivative of a row's covariance by ℓ_k is
//!
//! ```text
//! B₀ B_kᵀ + B_k B₀ᵀ = ½ (B₀ + B_k)(B₀ + B_k)ᵀ - ½ (B₀ - B_k)(B₀ - B_k)ᵀ
//! ```
//! with B₀ the part of orientations alone and B_k that of a lever along axis k: halves of the slopes by two sources of variance 0.
//! If the lever is claimed, scoring steps find it.

use super::reml::{Factor, Reml, Slope};
use denavit_model::nalgebra::{DMatrix, Matrix3, Vector3};
use serde::Serialize;
use statrs::distribution::{ChiSquared, ContinuousCDF};

/// Scoring steps, at most; each gains about two digits.
const STEPS: usize = 6;
/// A step below this fraction of the lever's standard deviation is the last.
const CONVERGED: f64 = 0.05;
/// Smallest fraction to which a step is shortened.
const LEAST_SHARE: f64 = 0.05;

/// Effect of a lever along each axis of the target in every row.
#[derive(Debug, Clone)]
pub(super) struct Arms {
    /// The source that is the noise of orientations.
    pub source: usize,
    /// Length of a lever at which the noise of orientations alone would explain that of positions, m.
    pub unit: f64,
    /// Row by row, axis by axis: columns like those of the source's factor; `None` for rows without it.
    pub rows: Vec<Option<[Vec<f64>; 3]>>,
}

/// The point about which the noise turns.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Lever {
    /// From that point to the target, in the target's axes, m.
    pub value: [f64; 3],
    /// Standard deviations, m.
    pub std: [f64; 3],
    /// Probability of a correlation at least this strong if position and orientation are independent.
    pub p_value: f64,
}

impl Arms {
    /// p-value of the lever, against no lever; 1 if it cannot be tested.
    ///
    /// `variances`: the likeliest without a lever.
    pub fn p_value(&self, reml: &Reml, variances: &[f64]) -> f64 {
        if variances[self.source] <= 0.0 {
            return 1.0;
        }
        let chi = ChiSquared::new(3.0).expect("three degrees of freedom are positive");
        self.scored(reml, variances, &Vector3::zeros()).map_or(1.0, |scored| chi.sf(scored.ratio))
    }

    /// The likeliest lever at these variances, in its unit, its standard deviation, and the rows with it in the noise of orientations;
    /// `None` if it cannot be estimated.
    pub fn likeliest(&self, reml: &Reml, variances: &[f64], start: Vector3<f64>) -> Option<Found> {
        let mut at = start;
        let mut scored = self.scored(reml, variances, &at)?;
        for _ in 0..STEPS {
            if scored.step.component_div(&scored.std).amax() < CONVERGED {
                break;
            }
            let mut share = 1.0;
            let next = loop {
                let next = at + scored.step * share;
                match self.scored(reml, variances, &next) {
                    Some(there) if there.deviance < scored.deviance => break Some((next, there)),
                    _ if share < LEAST_SHARE => break None,
                    _ => share *= 0.5,
                }
            };
            let Some(next) = next else { break };
            (at, scored) = next;
        }
        Some(Found { at, std: scored.std, reml: self.with(reml, &at) })
    }

    /// The lever in m.
    pub fn lever(&self, found: &Found, p_value: f64) -> Lever {
        Lever { value: (found.at * self.unit).into(), std: (found.std * self.unit).into(), p_value }
    }

    /// The rows with this lever, in its unit, in the noise of orientations.
    fn with(&self, reml: &Reml, lever: &Vector3<f64>) -> Reml {
        reml.clone().refactored(|row, factors| {
            let (Some(arms), Some(own)) = (&self.rows[row], own_factor(factors, self.source)) else { return };
            for (arm, length) in arms.iter().zip(lever.iter()) {
                own.cells.iter_mut().zip(arm).for_each(|(cell, arm)| *cell += length * arm);
            }
        })
    }

    /// Score and information at a lever, with all nonzero variances free.
    fn scored(&self, reml: &Reml, variances: &[f64], lever: &Vector3<f64>) -> Option<Scored> {
        let sources = variances.len();
        let with = self.with(reml, lever).with_sources(6, |row, factors| {
            let (Some(arms), Some(own)) = (&self.rows[row], own_factor(factors, self.source)) else { return };
            let own = own.cells.clone();
            for (axis, arm) in arms.iter().enumerate() {
                for (side, sign) in [1.0, -1.0].into_iter().enumerate() {
                    let cells = own.iter().zip(arm).map(|(own, arm)| own + sign * arm).collect();
                    factors.push(Factor { source: sources + 2 * axis + side, cells });
                }
            }
        });
        let mut all = variances.to_vec();
        all.resize(sources + 6, 0.0);
        let slope = with.slope(&all)?;
        let nuisance: Vec<usize> = (0..sources).filter(|&k| variances[k] > 0.0).collect();
        let weight = 0.5 * variances[self.source];
        Scored::of(&slope, &nuisance, sources, weight)
    }
}

fn own_factor(factors: &mut [Factor], source: usize) -> Option<&mut Factor> {
    factors.iter_mut().find(|factor| factor.source == source)
}

/// A lever, in its unit, and the rows with it.
pub(super) struct Found {
    pub at: Vector3<f64>,
    std: Vector3<f64>,
    pub reml: Reml,
}

impl Found {
    /// Whether it has converged to the one before.
    pub fn same(&self, before: &Self) -> bool {
        (self.at - before.at).component_div(&self.std).amax() < CONVERGED
    }
}

/// One scoring step.
#[derive(Debug, Clone, Copy)]
struct Scored {
    deviance: f64,
    step: Vector3<f64>,
    std: Vector3<f64>,
    /// χ² with three degrees of freedom if there is no lever.
    ratio: f64,
}

impl Scored {
    /// `first`: the first of six sources, two for each axis.
    fn of(slope: &Slope, nuisance: &[usize], first: usize, weight: f64) -> Option<Self> {
        // Numbers: the nuisance variances, then the lever's three.
        let count = nuisance.len();
        let mut numbers = DMatrix::zeros(count + 3, slope.gradient.len());
        for (number, &source) in nuisance.iter().enumerate() {
            numbers[(number, source)] = 1.0;
        }
        for axis in 0..3 {
            numbers[(count + axis, first + 2 * axis)] = weight;
            numbers[(count + axis, first + 2 * axis + 1)] = -weight;
        }
        let gradient = &numbers * &slope.gradient;
        let information = &numbers * &slope.information * numbers.transpose();
        let inverse = information.try_inverse()?;
        let block: Matrix3<f64> = inverse.fixed_view::<3, 3>(count, count).into_owned();
        let whole = &inverse * gradient;
        let step: Vector3<f64> = -whole.fixed_rows::<3>(count).into_owned();
        let variance = block * 2.0;
        // The rows' scores may vary more than those of normal rows.
        let influence = inverse.rows(count, 3) * &numbers * &slope.scores;
        let mean = influence.column_mean();
        let mut spread = Matrix3::zeros();
        for column in influence.column_iter() {
            let off = column - &mean;
            spread += Matrix3::from_fn(|i, k| off[i] * off[k]);
        }
        let along = variance.try_inverse()? * step;
        let normal = step.dot(&along);
        let tails = (along.dot(&(spread * along)) / normal).max(1.0);
        let ratio = normal / if tails.is_finite() { tails } else { 1.0 };
        let deviance = slope.deviance;
        Some(Self { deviance, step, std: variance.diagonal().map(|own| (own * tails.max(1.0)).max(0.0).sqrt()), ratio })
    }
}
