//! The score of a model: its log marginal likelihood, with all parameters except the hyperparameters integrated out.
//!
//! With A = Λ + G/σ² (Λ prior precision, G = XᵀX), b = Xᵀy/σ² plus the gradient of the prior, and d the distance from the prior mean:
//!
//! ```text
//! 2 log p(y) = -N log σ² - yᵀy/σ² - dᵀΛd + bᵀA⁻¹b - log|A| + log|Λ| + constants
//! ```
//! log|Λ| - log|A| is Occam's factor: it penalises a block that could explain anything. Constants (flat priors, the
//! held frame) are the same for all models of one robot and one file.

use crate::infer::gram::Gram;
use crate::infer::model::{Hyperparameters, Kernel};
use denavit_identify::effects::curve::Waves;
use denavit_linear::products::subtract;
use denavit_linear::triangle::{Triangle, dot};
use denavit_model::nalgebra::DMatrix;

/// The fastest waves of a curve are left out of the factor if the data determine fewer effective parameters of them than this, all
/// together: that changes a score by half as much. These are all waves of a zero curve, and most of a smooth one.
const UNSEEN: f64 = 0.01;

/// A model whose products are formed.
#[derive(Debug, Clone)]
pub struct Model<'a> {
    /// Products of all columns.
    pub gram: &'a Gram,
    /// Prior precision of the plain columns; 0 where the prior is flat.
    pub precision: &'a DMatrix<f64>,
    /// Gradient of the prior for the plain columns: precision times the step from the present state to the prior's mean.
    pub pull: &'a [f64],
    /// dᵀΛd at the present state.
    pub charge: f64,
    /// log |Λ| of the effects' part.
    pub log_precision: f64,
    /// The waves of each curve.
    pub waves: &'a [Waves],
    /// The mean of each curve's waves over the rows: a curve is constrained to zero mean, as its mean is the joint's zero, part of geometry.
    pub means: &'a [Vec<f64>],
    /// Precision of that constraint for each curve, 1/rad² or 1/m².
    pub firm: &'a [f64],
    /// For each curve its prior in gaps between rows: precision of its waves, row by row (`gaps`).
    pub gaps: &'a [Vec<f64>],
    /// For each curve the variance at which it is as large as the noise, rad² or m².
    pub visible: &'a [f64],
}

/// The posterior of all parameters at given hyperparameters.
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
        denavit_linear::products::gram_of(&self.root, self.size)
    }
}

/// The waves of a curve at given hyperparameters.
struct CurvePrior {
    /// Prior variance of each wave and the derivative of its logarithm by the length's.
    variances: Vec<(f64, f64)>,
    /// Number of waves that are solved for: the data do not determine the others.
    seen: usize,
}

impl CurvePrior {
    /// Those that are solved for.
    fn seen(&self) -> &[(f64, f64)] {
        &self.variances[..self.seen]
    }
}

/// The score with its derivatives at given hyperparameters.
pub struct Slope {
    /// The log marginal likelihood.
    pub score: f64,
    /// Its derivatives by [`Hyperparameters::to_vec`].
    pub gradient: Vec<f64>,
    /// The solved system of plain columns and waves, and the indices of their parameters.
    own: Posterior,
    columns: Vec<usize>,
    curves: Vec<CurvePrior>,
    plain: usize,
    /// Sum of squared residuals, in units of the noise.
    chi_squared: f64,
}

impl Slope {
    /// The posterior of every parameter: the prior for those that were not solved for.
    pub fn posterior(&self) -> Posterior {
        let size = self.plain + self.curves.iter().map(|expected| expected.variances.len()).sum::<usize>();
        let (mut root, mean) = (vec![0.0; size * size], whole(&self.columns, &self.own.mean, size));
        let mut first = self.plain;
        for CurvePrior { variances, seen } in &self.curves {
            for (offset, (variance, _)) in variances.iter().enumerate().skip(*seen) {
                root[(first + offset) * (size + 1)] = variance.sqrt();
            }
            first += variances.len();
        }
        for (index, column) in self.own.root.chunks_exact(self.own.size).enumerate() {
            let at = self.columns[index];
            for (cell, &row) in column[index..].iter().zip(&self.columns[index..]) {
                root[at * size + row] = *cell;
            }
        }
        Posterior { mean, root, size }
    }

    /// The score of the model without these plain columns (independent in the prior) and without these curves, at the same hyperparameters.
    /// `None` if the covariance is not positive definite.
    ///
    /// The Savage-Dickey ratio (Dickey, Annals of Mathematical Statistics 42 (1971), 204): the odds between a model and the same model without
    /// some parameters are the ratio of their posterior and prior densities at 0. With C their posterior covariance and m their mean, the
    /// logarithm of the likelihood falls by half of log|Λ| + log|C| + mᵀ C⁻¹ m.
    pub fn score_without(&self, model: &Model<'_>, columns: &[usize], curves: &[usize]) -> Option<f64> {
        let mut numbers = columns.to_vec();
        let mut log_prior: f64 = columns.iter().map(|&column| model.precision[(column, column)].ln()).sum();
        let mut first = self.plain;
        for (curve, expected) in self.curves.iter().enumerate() {
            if curves.contains(&curve) && expected.seen > 0 {
                numbers.extend(first..first + expected.seen);
                log_prior -= expected.seen().iter().map(|(variance, _)| variance.ln()).sum::<f64>();
                log_prior += model.charge_of_mean(curve, expected.seen()).ln();
            }
            first += expected.seen;
        }
        if numbers.is_empty() {
            return Some(self.score);
        }
        let size = numbers.len();
        let mut matrix = vec![0.0; size * size];
        for (i, &a) in numbers.iter().enumerate() {
            for (k, &b) in numbers[..=i].iter().enumerate() {
                matrix[i * size + k] = self.own.covariance(a, b);
            }
        }
        let right = numbers.iter().map(|&number| self.own.mean[number]).collect();
        let solved = System { matrix, right, square: 0.0, count: 0.0 }.solved()?;
        Some(self.score - 0.5 * (log_prior + solved.log_determinant() + solved.explained()))
    }

    /// Curvature of the score, square: the average of observed and expected information, which needs only the posterior's mean
    /// (average information; Gilmour, Thompson, Cullis, Biometrics 51 (1995), 1440).
    ///
    /// With V the prior variances of a curve's waves, m their expected values, S the shares by which two hyperparameters change V, x = S V⁻¹ m, g the pull
    /// of the prior on all numbers and C the numbers' covariance: half of mᵀ S V⁻¹ S' m - xᵀ C x' for two hyperparameters of curves (the first term where it is
    /// the same curve), half of χ² - gᵀ C g for the noise, half of xᵀ C g between noise and curve. What holds a curve's mean and what is expected in gaps is left out.
    pub fn information(&self, model: &Model<'_>) -> DMatrix<f64> {
        let (size, mean) = (self.own.size, &self.own.mean);
        // R x, C = Rᵀ R: first for the gradient of the prior of all parameters, then for each hyperparameter of a curve.
        let mut roots: Vec<Vec<f64>> = Vec::with_capacity(self.gradient.len());
        let along = |from: usize, pulls: &[f64]| {
            let mut root = vec![0.0; size];
            subtract(&self.own.root[from * size..(from + pulls.len()) * size], pulls, &mut root);
            root
        };
        let plain = (0..self.plain).map(|i| {
            let row: f64 = (0..self.plain).map(|k| model.precision[(i, k)] * mean[k]).sum();
            row - model.pull[i]
        });
        let mut all: Vec<f64> = plain.collect();
        let mut information = DMatrix::zeros(self.gradient.len(), self.gradient.len());
        let mut first = self.plain;
        roots.push(Vec::new());
        for (curve, prior) in self.curves.iter().enumerate() {
            let own = &mean[first..first + prior.seen];
            let pulls: Vec<f64> = own.iter().zip(prior.seen()).map(|(mean, (variance, _))| mean / variance).collect();
            let slopes = || prior.seen().iter().map(|(_, slope)| *slope);
            let sloped: Vec<f64> = pulls.iter().zip(slopes()).map(|(pull, slope)| pull * slope).collect();
            let place = 1 + 2 * curve;
            information[(place, place)] = dot(own, &pulls);
            information[(place, place + 1)] = dot(own, &sloped);
            let twice: Vec<f64> = sloped.iter().zip(slopes()).map(|(pull, slope)| pull * slope).collect();
            information[(place + 1, place + 1)] = dot(own, &twice);
            roots.extend([along(first, &pulls), along(first, &sloped)]);
            all.extend(pulls);
            first += prior.seen;
        }
        roots[0] = along(0, &all);
        information[(0, 0)] = self.chi_squared;
        for (i, root) in roots.iter().enumerate() {
            for (k, other) in roots.iter().enumerate().skip(i) {
                let shared = dot(root, other);
                information[(i, k)] += if i == 0 && k > 0 { shared } else { -shared };
            }
        }
        information.fill_lower_triangle_with_upper_triangle();
        information * 0.5
    }
}

struct Factored {
    score: f64,
    solved: Solved,
    /// Indices of the parameters that were solved for.
    columns: Vec<usize>,
    curves: Vec<CurvePrior>,
}

/// How many of a curve's waves the data determine: the others cannot be distinguished from 0. `precision`: that of the data for each wave.
pub(super) fn waves_seen(variances: &[(f64, f64)], precision: impl Fn(usize) -> f64) -> usize {
    let mut determined = 0.0;
    let last = (0..variances.len()).rev().find(|&k| {
        determined += variances[k].0 * precision(k);
        determined >= UNSEEN
    });
    last.map_or(0, |last| last + 1)
}

impl Model<'_> {
    /// The log marginal likelihood; `None` where the system is not positive.
    pub fn score(&self, hyper: &Hyperparameters) -> Option<f64> {
        self.factored(hyper).map(|factored| factored.score)
    }

    /// The same with its derivatives and the posterior of every parameter; also `None` if the score is below `least`.
    pub fn slope(&self, hyper: &Hyperparameters, least: f64) -> Option<Slope> {
        let factored = self.factored(hyper).filter(|factored| factored.score >= least)?;
        let posterior = factored.own();
        // Effective number of parameters: tr(C G/σ²) = n - tr(C Λ).
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
            // The data say nothing about what they do not determine.
            used -= (waves.len() - seen) as f64;
            if seen == 0 {
                gradient.extend([0.0, 0.0]);
                continue;
            }
            let charge = self.charge_of_mean(curve, variances);
            // The constrained mean is one effective parameter less.
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
        let mean = whole(&factored.columns, &posterior.mean, self.gram.size);
        let chi_squared = self.gram.misfit(&mean) * precision;
        gradient[0] = 0.5 * (chi_squared + used - self.gram.count);
        let Factored { score, columns, curves, .. } = factored;
        Some(Slope { score, gradient, own: posterior, columns, curves, plain: self.gram.plain, chi_squared })
    }

    /// The prior's penalty on these parameters: twice the negative logarithm of its density, up to a constant.
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

    /// Factor by which the constraint on the mean raises the prior's determinant: 1 + κ cᵀVc.
    fn charge_of_mean(&self, curve: usize, variances: &[(f64, f64)]) -> f64 {
        let sum: f64 =
            self.means[curve].iter().zip(variances).map(|(mean, (variance, _))| mean * mean * variance).sum();
        1.0 + self.firm[curve] * sum
    }

    /// The prior of all waves.
    fn expected(&self, hyper: &Hyperparameters) -> Vec<CurvePrior> {
        let all =
            |(kernel, waves): (&Kernel, &Waves)| CurvePrior { variances: kernel.variances(waves), seen: waves.len() };
        hyper.kernels.iter().zip(self.waves).map(all).collect()
    }

    /// The same without the waves that the data do not determine.
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

    /// The same for these columns: the plain ones and those of the waves that the data determine.
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
        // For waves that the data do not determine, prior and posterior are equal, and so are their determinants.
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
    /// The posterior of the parameters that were solved for.
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
}

/// Expected values of `size` numbers in all, of which these columns were solved for.
fn whole(columns: &[usize], own: &[f64], size: usize) -> Vec<f64> {
    let mut mean = vec![0.0; size];
    columns.iter().zip(own).for_each(|(&at, own)| mean[at] = *own);
    mean
}

/// A model's numbers as a linear system: A m = b, A the posterior precision.
#[derive(Debug, Clone)]
pub struct System {
    /// Lower triangle of A, row by row.
    pub matrix: Vec<f64>,
    /// b.
    pub right: Vec<f64>,
    /// The square of the data, plus the prior's penalty on the present state.
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

    /// How much of the square of the data the parameters explain: bᵀ A⁻¹ b.
    pub fn explained(&self) -> f64 {
        dot(&self.half, &self.half)
    }

    /// The posterior mean of each parameter: A⁻¹ b.
    pub fn mean(&self) -> Vec<f64> {
        self.factor.backward(&self.half).iter().zip(&self.scale).map(|(x, scale)| x * scale).collect()
    }

    /// The feature f = L⁻¹ D x of a value predicted by these columns: fᵀ f is its variance, fᵀ g its covariance with another value.
    pub fn feature(&self, columns: &[f64]) -> Vec<f64> {
        let scaled: Vec<f64> = columns.iter().zip(&self.scale).map(|(x, scale)| x * scale).collect();
        self.factor.forward(&scaled)
    }

    /// The expected value with this feature.
    pub fn expected(&self, feature: &[f64]) -> f64 {
        dot(feature, &self.half)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::infer::gram::Columns;
    use crate::infer::maximum;
    use denavit_model::nalgebra::DVector;

    const VALUES: usize = 80;

    fn cell(value: usize, k: usize) -> f64 {
        ((value * 5 + k * 11) as f64 * 0.53).sin() + 0.4 * ((value * k + 2) as f64 * 1.3).cos()
    }

    /// A model with this number of plain columns and two curves, for tests.
    fn with_model(plain: usize, means_are_held: bool, test: impl Fn(&Model<'_>, &[Vec<f64>; 2], &[Waves; 2])) {
        let columns: Vec<Vec<f64>> =
            (0..plain).map(|k| (0..VALUES).map(|value| cell(value, k + 1)).collect()).collect();
        let joints: [Vec<f64>; 2] = [31, 37].map(|k| (0..VALUES).map(|value| cell(value, k)).collect());
        let explained: Vec<f64> = (0..VALUES).map(|value| 1.3 * cell(value, 3) + 0.8 * cell(value, 41)).collect();
        let waves = [Waves::over(0.0, 1.0, false, 12.0, 6), Waves::over(0.0, 1.0, false, 12.0, 4)];
        let readings: [Vec<f64>; 2] = [17, 23].map(|k| (0..VALUES).map(|row| 0.5 + 0.3 * cell(row, k)).collect());
        let rows: Vec<usize> = (0..VALUES).collect();
        let cut: Vec<&[f64]> = columns.iter().map(Vec::as_slice).collect();
        let products = Columns {
            explained: &explained,
            plain: &cut,
            joints: &[&joints[0], &joints[1]],
            rows: &rows,
            weights: &[1.0; VALUES],
        };
        let gram = Gram::of(&products, &waves, &readings);
        let precision = DMatrix::from_diagonal(&DVector::from_fn(plain, |k, _| 0.2 + 0.1 * k as f64));
        let mean = |waves: &Waves| (0..waves.len()).map(|k| 0.1 + 0.05 * k as f64).collect::<Vec<f64>>();
        let driven: [Vec<f64>; 2] = std::array::from_fn(|curve| {
            let wave = |k: usize| (0..VALUES).map(move |value| (value, k));
            let cells = (0..waves[curve].len()).flat_map(wave);
            cells.map(|(value, k)| joints[curve][value] * waves[curve].values(readings[curve][value])[k]).collect()
        });
        let model = Model {
            gram: &gram,
            precision: &precision,
            pull: &vec![0.0; plain],
            charge: 0.0,
            log_precision: precision.diagonal().iter().map(|cell| cell.ln()).sum(),
            waves: &waves,
            means: &[mean(&waves[0]), mean(&waves[1])],
            firm: &[if means_are_held { 3.0 } else { 0.0 }; 2],
            gaps: &[Vec::new(), Vec::new()],
            visible: &[1.0; 2],
        };
        test(&model, &driven, &waves);
    }

    fn hyperparameters() -> Hyperparameters {
        let kernel = |log_variance, log_length| Kernel { log_variance, log_length };
        Hyperparameters { log_noise: 0.2, kernels: vec![kernel(-0.5, -1.5), kernel(-1.2, -1.1)] }
    }

    #[test]
    fn a_score_without_numbers_is_that_of_the_model_that_lacks_them() {
        with_model(4, true, |model, _, _| {
            let hyper = hyperparameters();
            let slope = model.slope(&hyper, f64::NEG_INFINITY).unwrap();
            for (columns, curves) in [(&[][..], &[][..]), (&[2], &[]), (&[1, 3], &[0]), (&[], &[0, 1])] {
                let (mut precision, mut log_precision) = (model.precision.clone(), model.log_precision);
                for &column in columns {
                    precision[(column, column)] *= 1e12;
                    log_precision += 1e12_f64.ln();
                }
                let mut without = hyper.clone();
                for &curve in curves {
                    let kernel: &mut Kernel = &mut without.kernels[curve];
                    kernel.log_variance -= 60.0;
                }
                let written = Model { precision: &precision, log_precision, ..model.clone() }.score(&without).unwrap();
                let found = slope.score_without(model, columns, curves).unwrap();
                assert!((found - written).abs() < 1e-7, "{columns:?} {curves:?}: {found} {written}");
            }
        });
    }

    #[test]
    fn no_step_from_the_maximum_leads_uphill_wherever_the_search_began() {
        with_model(2, true, |model, _, _| {
            let mut far = hyperparameters();
            far.log_noise = 2.0;
            far.kernels[1] = Kernel { log_variance: -9.0, log_length: -0.4 };
            let reached = [
                maximum::from_near(model, &hyperparameters(), maximum::NEGLIGIBLE).unwrap(),
                maximum::from_near(model, &far, maximum::NEGLIGIBLE).unwrap(),
                maximum::from_afar(model, None, maximum::NEGLIGIBLE).unwrap(),
            ]
            .map(|(slope, hyper)| (slope.score, hyper));
            for (score, hyper) in &reached {
                assert!((score - reached[0].0).abs() < 0.05, "{reached:?}");
                let at = hyper.to_vec();
                for (number, by) in (0..at.len()).flat_map(|number| [(number, -0.2), (number, 0.2)]) {
                    let mut other = at.clone();
                    other[number] += by;
                    // A length has bounds; beyond them it would be no length of a curve.
                    let there = model.score(&Hyperparameters::from_slice(&other)).unwrap();
                    assert!(
                        there < score + 0.02 || maximum::is_outside(model, &other),
                        "{number} {by}: {there} {score}"
                    );
                }
            }
        });
    }

    /// Half of yᵀ V⁻¹ ∂V V⁻¹ ∂V V⁻¹ y, V the covariance of the values y.
    #[test]
    fn the_information_is_the_mean_of_what_is_observed_and_expected() {
        with_model(3, false, |model, driven, waves| {
            let hyper = hyperparameters();
            let explained: Vec<f64> = (0..VALUES).map(|value| 1.3 * cell(value, 3) + 0.8 * cell(value, 41)).collect();
            let mut covariance = DMatrix::<f64>::identity(VALUES, VALUES) * hyper.log_noise.exp();
            let mut bent = vec![covariance.clone()];
            for k in 0..3 {
                let column = DVector::from_fn(VALUES, |value, _| cell(value, k + 1));
                covariance += &column * column.transpose() / model.precision[(k, k)];
            }
            for curve in 0..2 {
                let columns = DMatrix::from_column_slice(VALUES, waves[curve].len(), &driven[curve]);
                let variances = hyper.kernels[curve].variances(&waves[curve]);
                let of = |by: &dyn Fn(&(f64, f64)) -> f64| {
                    let diagonal = DVector::from_iterator(variances.len(), variances.iter().map(by));
                    &columns * DMatrix::from_diagonal(&diagonal) * columns.transpose()
                };
                covariance += of(&|(variance, _)| *variance);
                bent.extend([of(&|(variance, _)| *variance), of(&|(variance, slope)| variance * slope)]);
            }
            let inverse = covariance.try_inverse().unwrap();
            let pulled = &inverse * DVector::from_vec(explained);
            let found = model.slope(&hyper, f64::NEG_INFINITY).unwrap().information(model);
            for i in 0..5 {
                for k in 0..5 {
                    let written = 0.5 * (&bent[i] * &pulled).dot(&(&inverse * (&bent[k] * &pulled)));
                    let off = (found[(i, k)] - written).abs();
                    assert!(off < 1e-2 * (1.0 + written.abs()), "{i} {k}: {} {written}", found[(i, k)]);
                }
            }
        });
    }
}
