//! The score of a model: its log marginal likelihood, all numbers but the hyperparameters integrated out.
//!
//! With A = Λ + G/σ² (Λ prior precision, G = XᵀX, b = Xᵀy/σ² and what the prior pulls):
//!
//! ```text
//! 2 log p(y) = -N log σ² - yᵀy/σ² - dᵀΛd + bᵀA⁻¹b - log|A| + log|Λ| + constants
//! ```
//! It holds Occam's factor (log|Λ| - log|A|): a block that could explain anything pays for it. Constants (flat priors, the
//! held frame) are the same for all models of one robot and one file.

use crate::effects::curve::Waves;
use crate::identify::triangle::{Triangle, dot};
use crate::trace::infer::gram::Gram;
use crate::trace::infer::model::{Hyperparameters, Kernel};
use denavit_model::nalgebra::DMatrix;

/// The fastest waves of a curve of which the data tell less than this, in numbers, all together, are left out of the factor: they change a
/// score by half of that. Of a curve that is nothing these are all, of a smooth one most.
const UNSEEN: f64 = 0.01;

/// A model whose products are formed.
#[derive(Debug, Clone)]
pub struct Model<'a> {
    /// Products of all columns.
    pub gram: &'a Gram,
    /// Prior precision of the plain columns; 0 where the prior is flat.
    pub precision: &'a DMatrix<f64>,
    /// What the prior pulls the plain columns by: precision times the way from the present state to the prior's mean.
    pub pull: &'a [f64],
    /// dᵀΛd at the present state.
    pub charge: f64,
    /// log |Λ| of the effects' part.
    pub log_precision: f64,
    /// The waves of each curve.
    pub waves: &'a [Waves],
    /// The mean of each curve's waves over the rows: a curve has no mean, for that is the joint's zero and geometry's.
    pub means: &'a [Vec<f64>],
    /// How firmly that holds for each curve, 1/rad² or 1/m².
    pub firm: &'a [f64],
    /// For each curve what is expected of it where no rows are: precision of its waves, row by row ([`super::gaps`]).
    pub gaps: &'a [Vec<f64>],
    /// For each curve the variance at which it is as large as the noise, rad² or m².
    pub visible: &'a [f64],
}

/// What the data say of every number at given hyperparameters.
#[derive(Debug, Clone)]
pub struct Posterior {
    /// Expected values: plain columns, then curve by curve.
    pub mean: Vec<f64>,
    /// Inverse of the scaled factor, column by column, each multiplied by its column's scale: C = Rᵀ R.
    root: Vec<f64>,
    size: usize,
}

impl Posterior {
    /// Covariance of two numbers.
    pub fn covariance(&self, a: usize, b: usize) -> f64 {
        let first = a.max(b);
        dot(&self.column(a)[first..], &self.column(b)[first..])
    }

    fn column(&self, index: usize) -> &[f64] {
        &self.root[index * self.size..(index + 1) * self.size]
    }

    /// The whole covariance, row by row.
    pub fn covariances(&self) -> Vec<f64> {
        crate::identify::gram::gram_of(&self.root, self.size)
    }
}

/// The waves of a curve as the hyperparameters have them.
struct CurvePrior {
    /// Prior variance of each wave and the derivative of its logarithm by the length's.
    variances: Vec<(f64, f64)>,
    /// So many of the waves are solved for: the data do not see the others.
    seen: usize,
}

impl CurvePrior {
    /// Those that are solved for.
    fn seen(&self) -> &[(f64, f64)] {
        &self.variances[..self.seen]
    }
}

struct Factored {
    score: f64,
    solved: Solved,
    /// Which of the model's numbers were solved for.
    columns: Vec<usize>,
    curves: Vec<CurvePrior>,
}

/// How many of a curve's waves the data see: the others could not be told from nothing. `precision`: what the data tell of each.
pub(super) fn waves_seen(variances: &[(f64, f64)], precision: impl Fn(usize) -> f64) -> usize {
    let mut told = 0.0;
    let last = (0..variances.len()).rev().find(|&k| {
        told += variances[k].0 * precision(k);
        told >= UNSEEN
    });
    last.map_or(0, |last| last + 1)
}

impl Model<'_> {
    /// The log marginal likelihood; `None` where the system is not positive.
    pub fn score(&self, hyper: &Hyperparameters) -> Option<f64> {
        self.factored(hyper).map(|factored| factored.score)
    }

    /// The same with its derivatives by [`Hyperparameters::to_vec`].
    pub fn score_and_gradient(&self, hyper: &Hyperparameters) -> Option<(f64, Vec<f64>)> {
        let factored = self.factored(hyper)?;
        let posterior = factored.own();
        // Numbers that the data pay for: tr(C G/σ²) = n - tr(C Λ).
        let mut used = self.gram.size as f64;
        for i in 0..self.gram.plain {
            for k in 0..self.gram.plain {
                let precision = self.precision[(i, k)];
                if precision != 0.0 {
                    used -= precision * posterior.covariance(i, k);
                }
            }
        }
        let mut gradient = vec![0.0];
        let mut first = self.gram.plain;
        for (curve, (waves, expected)) in self.waves.iter().zip(&factored.curves).enumerate() {
            let (mut by_variance, mut by_length) = (0.0, 0.0);
            let (seen, variances) = (expected.seen, expected.seen());
            // Of what the data do not see they say nothing.
            used -= (waves.len() - seen) as f64;
            if seen == 0 {
                gradient.extend([0.0, 0.0]);
                continue;
            }
            let charge = self.charge_of_mean(curve, variances);
            // Held to nothing, the mean is one number less that the data pay for.
            used -= 1.0;
            for (row, cells) in self.gaps[curve].chunks_exact(waves.len()).take(seen).enumerate() {
                used -= cells[row] * posterior.covariance(first + row, first + row);
                let before = cells[..row].iter().enumerate();
                used -= 2.0 * before.map(|(k, cell)| cell * posterior.covariance(first + row, first + k)).sum::<f64>();
            }
            for (offset, &(variance, slope)) in variances.iter().enumerate() {
                let index = first + offset;
                let own = posterior.covariance(index, index) / variance;
                let held = self.firm[curve] * self.means[curve][offset].powi(2) * variance / charge;
                let part = 0.5 * (posterior.mean[index].powi(2) / variance + own - 1.0 + held);
                used -= own;
                by_variance += part;
                by_length += part * slope;
            }
            gradient.extend([by_variance, by_length]);
            first += seen;
        }
        let precision = (-hyper.log_noise).exp();
        let mean = factored.whole(&posterior.mean, self.gram.size);
        gradient[0] = 0.5 * (self.gram.misfit(&mean) * precision + used - self.gram.count);
        Some((factored.score, gradient))
    }

    /// What the data say of every number.
    pub fn posterior(&self, hyper: &Hyperparameters) -> Option<Posterior> {
        Some(self.factored(hyper)?.posterior(self.gram.size))
    }

    /// What the prior takes of these numbers: twice the negative logarithm of its density, but for a constant.
    pub fn cost(&self, hyper: &Hyperparameters, numbers: &[f64]) -> f64 {
        let (plain, mut rest) = numbers.split_at(self.gram.plain);
        let mut sum = self.charge;
        for (i, own) in plain.iter().enumerate() {
            let row: f64 = plain.iter().enumerate().map(|(k, other)| self.precision[(i, k)] * other).sum();
            sum += own * (row - 2.0 * self.pull[i]);
        }
        for (curve, (kernel, waves)) in hyper.kernels.iter().zip(self.waves).enumerate() {
            let (own, others) = rest.split_at(waves.len());
            rest = others;
            sum += own.iter().zip(kernel.variances(waves)).map(|(w, (variance, _))| w * w / variance).sum::<f64>();
            sum += self.firm[curve] * dot(own, &self.means[curve]).powi(2);
            let rows = self.gaps[curve].chunks_exact(waves.len());
            sum += own.iter().zip(rows).map(|(w, row)| w * dot(row, own)).sum::<f64>();
        }
        sum
    }

    /// By how much holding the mean raises the prior's determinant: 1 + κ cᵀVc.
    fn charge_of_mean(&self, curve: usize, variances: &[(f64, f64)]) -> f64 {
        let sum: f64 =
            self.means[curve].iter().zip(variances).map(|(mean, (variance, _))| mean * mean * variance).sum();
        1.0 + self.firm[curve] * sum
    }

    /// What is expected of all waves.
    fn expected(&self, hyper: &Hyperparameters) -> Vec<CurvePrior> {
        let all =
            |(kernel, waves): (&Kernel, &Waves)| CurvePrior { variances: kernel.variances(waves), seen: waves.len() };
        hyper.kernels.iter().zip(self.waves).map(all).collect()
    }

    /// The same, with those left out that the data could not tell from nothing.
    fn seen(&self, hyper: &Hyperparameters) -> Vec<CurvePrior> {
        let noise = (-hyper.log_noise).exp();
        let mut index = self.gram.plain;
        let mut curves = self.expected(hyper);
        for (CurvePrior { variances, seen }, gaps) in curves.iter_mut().zip(self.gaps) {
            let precision = |k: usize| {
                self.gram.cell(index + k, index + k) * noise + gaps.get(k * variances.len() + k).copied().unwrap_or(0.0)
            };
            *seen = waves_seen(variances, precision);
            index += variances.len();
        }
        curves
    }

    /// The system at given hyperparameters, in units of its noise, and log |Λ|.
    pub fn system(&self, hyper: &Hyperparameters) -> (System, f64) {
        let all: Vec<usize> = (0..self.gram.size).collect();
        self.system_of(hyper, &all, &self.expected(hyper))
    }

    /// The same of these columns: the plain ones and those of the waves that are seen.
    fn system_of(&self, hyper: &Hyperparameters, columns: &[usize], curves: &[CurvePrior]) -> (System, f64) {
        let (whole, size, plain) = (self.gram.size, columns.len(), self.gram.plain);
        let noise = (-hyper.log_noise).exp();
        let mut matrix = vec![0.0; size * size];
        for (row, &i) in matrix.chunks_exact_mut(size).zip(columns) {
            let cells = &self.gram.matrix[i * whole..=i * whole + i];
            row.iter_mut().zip(columns.iter().take_while(|k| **k <= i)).for_each(|(cell, &k)| *cell = cells[k] * noise);
        }
        let mut right: Vec<f64> = columns.iter().map(|&i| self.gram.right[i] * noise).collect();
        for (sum, pull) in right.iter_mut().zip(self.pull) {
            *sum += pull;
        }
        let square = self.charge + self.gram.square * noise;
        for i in 0..plain {
            for k in 0..=i {
                matrix[i * size + k] += self.precision[(i, k)];
            }
        }
        let mut log_prior = self.log_precision;
        let mut index = plain;
        for (curve, expected) in curves.iter().enumerate().filter(|(_, expected)| expected.seen > 0) {
            log_prior += self.charge_of_mean(curve, expected.seen()).ln();
            let (first, means) = (index, &self.means[curve]);
            for (own, (variance, _)) in expected.seen().iter().enumerate() {
                matrix[index * size + index] += 1.0 / variance;
                log_prior -= variance.ln();
                let held = self.firm[curve] * means[own];
                let cells = &mut matrix[index * size + first..=index * size + index];
                cells.iter_mut().zip(means).for_each(|(cell, mean)| *cell += held * mean);
                let gap = self.gaps[curve].chunks_exact(means.len()).nth(own).unwrap_or_default();
                cells.iter_mut().zip(gap).for_each(|(cell, gap)| *cell += gap);
                index += 1;
            }
        }
        (System { matrix, right, square, count: self.gram.count }, log_prior)
    }

    fn factored(&self, hyper: &Hyperparameters) -> Option<Factored> {
        // Of waves that the data do not see they say nothing: prior and posterior are the same, and their determinants.
        let curves = self.seen(hyper);
        let mut columns: Vec<usize> = (0..self.gram.plain).collect();
        let mut first = self.gram.plain;
        for expected in &curves {
            columns.extend(first..first + expected.seen);
            first += expected.variances.len();
        }
        let (system, log_prior) = self.system_of(hyper, &columns, &curves);
        let square = system.square;
        let solved = system.solved()?;
        let half = &solved.half;
        let score =
            0.5 * (log_prior - solved.log_determinant() - self.gram.count * hyper.log_noise - square + dot(half, half));
        score.is_finite().then_some(Factored { score, solved, columns, curves })
    }
}

impl Factored {
    /// What is said of the numbers that were solved for.
    fn own(&self) -> Posterior {
        let Solved { factor, half, scale } = &self.solved;
        let size = scale.len();
        let mut root = factor.inverse_columns();
        let mut mean = vec![0.0; size];
        for (index, (column, scale)) in root.chunks_exact_mut(size).zip(scale).enumerate() {
            column[index..].iter_mut().for_each(|cell| *cell *= scale);
            mean[index] = dot(&column[index..], &half[index..]);
        }
        Posterior { mean, root, size }
    }

    /// The same of `size` numbers in all: of those that were not solved for, what was expected.
    fn posterior(&self, size: usize) -> Posterior {
        let own = self.own();
        let (mut root, mean) = (vec![0.0; size * size], self.whole(&own.mean, size));
        let mut first = size - self.curves.iter().map(|expected| expected.variances.len()).sum::<usize>();
        for CurvePrior { variances, seen } in &self.curves {
            for (offset, (variance, _)) in variances.iter().enumerate().skip(*seen) {
                root[(first + offset) * (size + 1)] = variance.sqrt();
            }
            first += variances.len();
        }
        for (index, column) in own.root.chunks_exact(own.size).enumerate() {
            let at = self.columns[index];
            for (cell, &row) in column[index..].iter().zip(&self.columns[index..]) {
                root[at * size + row] = *cell;
            }
        }
        Posterior { mean, root, size }
    }

    /// Expected values of `size` numbers in all, of which these were solved for.
    fn whole(&self, own: &[f64], size: usize) -> Vec<f64> {
        let mut mean = vec![0.0; size];
        self.columns.iter().zip(own).for_each(|(&at, own)| mean[at] = *own);
        mean
    }
}

/// A model's numbers as a linear system: A m = b, A the posterior precision.
#[derive(Debug, Clone)]
pub struct System {
    /// Lower triangle of A, row by row.
    pub matrix: Vec<f64>,
    /// b.
    pub right: Vec<f64>,
    /// What there is to explain, with what the prior takes of the present state.
    pub square: f64,
    /// Values, weighted.
    pub count: f64,
}

/// A solved system: D A D = L Lᵀ with D the inverse root of A's diagonal.
#[derive(Debug, Clone)]
pub struct Solved {
    factor: Triangle,
    /// L⁻¹ D b.
    half: Vec<f64>,
    /// The diagonal of D.
    scale: Vec<f64>,
}

impl System {
    /// `None` where it is not positive.
    pub fn solved(self) -> Option<Solved> {
        let Self { mut matrix, mut right, .. } = self;
        let size = right.len();
        let scale: Vec<f64> = (0..size).map(|i| matrix[i * size + i].powf(-0.5)).collect();
        for i in 0..size {
            for k in 0..=i {
                matrix[i * size + k] *= scale[i] * scale[k];
            }
            right[i] *= scale[i];
        }
        let factor = Triangle::factor(matrix, size)?;
        let half = factor.forward(&right);
        Some(Solved { factor, half, scale })
    }
}

impl Solved {
    /// log |A|.
    fn log_determinant(&self) -> f64 {
        self.factor.log_determinant() - 2.0 * self.scale.iter().map(|scale| scale.ln()).sum::<f64>()
    }

    /// How much of what there is to explain the numbers explain: bᵀ A⁻¹ b.
    pub fn explained(&self) -> f64 {
        dot(&self.half, &self.half)
    }

    /// What is expected of each number: A⁻¹ b.
    pub fn mean(&self) -> Vec<f64> {
        self.factor.backward(&self.half).iter().zip(&self.scale).map(|(x, scale)| x * scale).collect()
    }

    /// A value that is predicted by these columns, as a vector f with fᵀ f its variance and fᵀ g its covariance with another: L⁻¹ D x.
    pub fn feature(&self, columns: &[f64]) -> Vec<f64> {
        let scaled: Vec<f64> = columns.iter().zip(&self.scale).map(|(x, scale)| x * scale).collect();
        self.factor.forward(&scaled)
    }

    /// What is expected of the value with this feature.
    pub fn expected(&self, feature: &[f64]) -> f64 {
        dot(feature, &self.half)
    }
}
