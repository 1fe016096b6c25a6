//! The choice itself: the predictions of each hypothesis at every pose, conditional on the poses chosen before.
//!
//! For a value with variance v and noise 1, covariances k with all others and innovation r, everything is conditioned on it by
//! `expected += k r/(1 + v)`, `covariance -= k kᵀ/(1 + v)`: the update of a Kalman filter, a value at a time. If a is true and
//! its expected values are measured, the differences r of the predictions of a and b give the noncentrality d² of b's lack of fit:
//! d² = Σ r²/(1 + v).

use denavit_linear::products::{gram_of, subtract};
use denavit_linear::threads::in_parallel;
use denavit_linear::triangle::{Triangle, dot};
use denavit_model::nalgebra::{Cholesky, DMatrix, DVector, Dyn};
use denavit_trace::infer::hypotheses::{Hypotheses, Predicted};
use std::ops::Range;

/// Bound on the probability of choosing the wrong hypothesis below which further poses are for the prediction: a cause must be found
/// again on halves of the rows, whose evidence varies as much as that of another run; with half of the evidence this is 0.02.
const DECIDED: f64 = 4e-4;
/// A pose that lowers the logarithm of the bound by less than this is for the prediction: twenty such poses would not change odds by
/// a sixth.
const LEAST_STEP: f64 = 2e-3;

/// One hypothesis, conditioned on the poses chosen.
#[derive(Debug, Clone)]
struct Conditioned {
    /// For each value of the condition, its covariances with all values over √(1 + its variance); one after the other.
    shares: Vec<f64>,
    /// Covariances within each row, row by row of the block.
    blocks: Vec<Vec<f64>>,
}

/// All hypotheses, conditioned on the poses chosen.
#[derive(Debug, Clone)]
struct State {
    of: Vec<Conditioned>,
    /// For each pair (a, b): the prediction of a less that of b, for all values.
    apart: Vec<Vec<f64>>,
    /// For each pair the noncentrality so far.
    noncentrality: Vec<f64>,
    /// Under the first hypothesis: covariances of the candidates' values with those to be predicted, row by row of the former.
    toward: Vec<f64>,
}

/// The expected odds of a pair.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Separation {
    /// Index of the hypothesis that is taken to be true.
    pub true_one: usize,
    /// Index of the other.
    pub other: usize,
    /// The expected rise of the log odds for the true one.
    pub rise: f64,
}

/// The candidates and the poses at which the prediction is evaluated, one list of rows.
pub(super) struct Offered<'a> {
    /// The prediction of each hypothesis for all values.
    pub predicted: Vec<Predicted>,
    /// Logarithms of the hypotheses' probabilities.
    pub log_probabilities: Vec<f64>,
    /// Variance of the noise in units of which the values are.
    pub noise: f64,
    /// The values of each row.
    pub rows: &'a [Range<usize>],
    /// Factor from a value to a length in m; 0 for other quantities.
    pub metres: &'a [f64],
    /// The first this many rows are candidates.
    pub candidates: usize,
    /// Series that are seen in a row.
    pub series: usize,
}

impl<'a> Offered<'a> {
    /// The future rows of some hypotheses.
    pub fn of(hypotheses: &'a Hypotheses, candidates: usize, series: usize) -> Self {
        Self {
            predicted: (0..hypotheses.list.len()).map(|index| hypotheses.predicted(index)).collect(),
            log_probabilities: hypotheses.list.iter().map(|one| one.log_probability).collect(),
            noise: hypotheses.noise,
            rows: &hypotheses.lines.rows,
            metres: &hypotheses.lines.metres,
            candidates,
            series,
        }
    }

    /// Values of the candidates.
    fn split(&self) -> usize {
        self.rows.get(self.candidates).map_or(self.metres.len(), |row| row.start)
    }
}

/// The choice among what is offered.
pub(super) struct Design<'a> {
    offered: Offered<'a>,
    begun: State,
    now: State,
    /// Rows chosen.
    pub chosen: Vec<usize>,
    /// How many of them distinguish hypotheses; the others are for the prediction.
    pub for_separation: usize,
}

impl<'a> Design<'a> {
    /// Nothing chosen yet.
    pub fn new(offered: Offered<'a>) -> Self {
        let count = offered.predicted.len();
        let block = |of: &Predicted, row: &Range<usize>| of.covariances(row.clone(), row.clone());
        let of = offered.predicted.iter().map(|of| Conditioned {
            shares: Vec::new(),
            blocks: offered.rows.iter().map(|row| block(of, row)).collect(),
        });
        let apart = (0..count * count).map(|pair| {
            let (a, b) = (&offered.predicted[pair / count].expected, &offered.predicted[pair % count].expected);
            a.iter().zip(b).map(|(a, b)| a - b).collect()
        });
        let split = offered.split();
        let toward = offered.predicted[0].covariances(0..split, split..offered.metres.len());
        let noncentrality = vec![0.0; count * count];
        let begun = State { of: of.collect(), apart: apart.collect(), noncentrality, toward };
        Self { offered, now: begun.clone(), begun, chosen: Vec::new(), for_separation: 0 }
    }

    /// Ordered pairs of different hypotheses, by index.
    fn pairs(&self) -> impl Iterator<Item = usize> + use<> {
        let count = self.offered.predicted.len();
        (0..count * count).filter(move |pair| pair / count != pair % count)
    }

    /// Conditions everything on the values of a row.
    fn add(&mut self, row: usize) {
        let (count, split) = (self.offered.predicted.len(), self.offered.split());
        let (all, values) = (self.offered.metres.len(), self.offered.rows[row].clone());
        for (b, predicted) in self.offered.predicted.iter().enumerate() {
            let own = &mut self.now.of[b];
            let known = own.shares.len();
            let lines = predicted.covariances(values.clone(), 0..all);
            for (mut covariances, value) in lines.chunks_exact(all).map(<[f64]>::to_vec).zip(values.clone()) {
                let at: Vec<f64> = own.shares.iter().skip(value).step_by(all).copied().collect();
                subtract(&own.shares, &at, &mut covariances);
                let variance = 1.0 + covariances[value].max(0.0);
                for a in (0..count).filter(|a| *a != b) {
                    let pair = a * count + b;
                    let innovation = self.now.apart[pair][value];
                    self.now.noncentrality[pair] += innovation * innovation / variance;
                    subtract(&covariances, &[innovation / variance], &mut self.now.apart[pair]);
                }
                let root = variance.sqrt().recip();
                for cell in &mut covariances {
                    *cell *= root;
                }
                own.shares.extend(covariances);
            }
            let new = &own.shares[known..];
            for (block, row) in own.blocks.iter_mut().zip(self.offered.rows) {
                for share in new.chunks_exact(all).map(|share| &share[row.clone()]) {
                    for (cells, left) in block.chunks_exact_mut(row.len().max(1)).zip(share) {
                        cells.iter_mut().zip(share).for_each(|(cell, right)| *cell -= left * right);
                    }
                }
            }
            if b == 0 && split < all {
                let wanted: Vec<f64> = new.chunks_exact(all).flat_map(|share| &share[split..]).copied().collect();
                for (candidate, cells) in self.now.toward.chunks_exact_mut(all - split).enumerate() {
                    let left: Vec<f64> = new.iter().skip(candidate).step_by(all).copied().collect();
                    subtract(&wanted, &left, cells);
                }
            }
        }
    }

    /// 1 + the covariance of a row's values under a hypothesis, factored.
    fn innovation(&self, hypothesis: usize, row: usize) -> Option<Cholesky<f64, Dyn>> {
        let height = self.offered.rows[row].len();
        let block = &self.now.of[hypothesis].blocks[row];
        let one = |i: usize, k: usize| if i == k { 1.0 } else { 0.0 };
        DMatrix::from_fn(height, height, |i, k| block[i * height + k] + one(i, k)).cholesky()
    }

    /// Logarithm of the bound on the probability of a wrong choice after one more row: Σ √(p_a p_b) exp(-d²/8)
    /// over the pairs (the union of Bhattacharyya's bounds, Kailath 1967).
    fn log_bound(&self, row: Option<usize>) -> f64 {
        let count = self.offered.predicted.len();
        let noise = self.offered.noise;
        let factors: Vec<Option<Cholesky<f64, Dyn>>> =
            row.map_or_else(Vec::new, |row| (0..count).map(|b| self.innovation(b, row)).collect());
        let parts: Vec<f64> = self
            .pairs()
            .map(|pair| {
                let (a, b) = (pair / count, pair % count);
                let mut square = self.now.noncentrality[pair];
                if let (Some(row), Some(Some(factor))) = (row, factors.get(b)) {
                    let apart = DVector::from_column_slice(&self.now.apart[pair][self.offered.rows[row].clone()]);
                    square += apart.dot(&factor.solve(&apart));
                }
                let log = |index: usize| self.offered.log_probabilities[index];
                0.5 * (log(a) + log(b)) - square / noise / 8.0
            })
            .collect();
        let top = parts.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        top + parts.iter().map(|part| (part - top).exp()).sum::<f64>().ln()
    }

    /// How much a candidate lowers the sum of the variances of the prediction, under the first hypothesis, m².
    fn lowers(&self, row: usize) -> f64 {
        let values = self.offered.rows[row].clone();
        let split = self.offered.split();
        let wanted = self.offered.metres.len() - split;
        let Some(factor) = self.innovation(0, row) else { return 0.0 };
        let toward = DMatrix::from_fn(values.len(), wanted, |i, k| {
            self.now.toward[(values.start + i) * wanted + k] * self.offered.metres[split + k]
        });
        factor.l().solve_lower_triangular(&toward).expect("the diagonal of a factor is not 0").norm_squared()
    }

    /// The candidate not yet chosen for which this is largest.
    fn best(&self, of: impl Fn(usize) -> f64 + Sync) -> Option<(usize, f64)> {
        let open: Vec<usize> = (0..self.offered.candidates).filter(|row| !self.chosen.contains(row)).collect();
        let gains = open.iter().copied().zip(in_parallel(&open, |&row| of(row)));
        gains.filter(|(_, gain)| gain.is_finite()).max_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// Chooses this many of the candidates, alternating between one that distinguishes the hypotheses and one that lowers the variance of
    /// the prediction, which is useful in itself and spreads the poses; once nothing more can be distinguished, all are of the second sort.
    pub fn choose(&mut self, count: usize) {
        let mut places = Vec::new();
        let mut open = self.offered.predicted.len() > 1;
        while self.chosen.len() < count {
            let here = if open { self.log_bound(None) } else { f64::NEG_INFINITY };
            open &= here > DECIDED.ln();
            let wanted = open && self.chosen.len() == 2 * places.len();
            let tells = if wanted { self.best(|row| -self.log_bound(Some(row))) } else { None };
            let tells = tells.filter(|(_, bound)| *bound > LEAST_STEP - here);
            open &= !wanted || tells.is_some();
            if tells.is_some() {
                places.push(self.chosen.len());
            }
            let Some((row, _)) = tells.or_else(|| self.best(|row| self.lowers(row))) else { break };
            self.chosen.push(row);
            self.add(row);
        }
        self.for_separation = places.len();
    }

    /// The expected rise of each pair's log odds: the divergence of the predictions of all chosen rows,
    /// ½ (tr(S_b⁻¹ S_a) - n + dᵀ S_b⁻¹ d - log|S_a|/|S_b|) (Kullback 1959; Box, Hill 1967), S a hypothesis' covariance of
    /// the values with their noise, d the difference of the two predictions.
    pub fn separations(&self) -> Vec<Separation> {
        let values: Vec<usize> = self.chosen.iter().flat_map(|&row| self.offered.rows[row].clone()).collect();
        let size = values.len();
        let count = self.offered.predicted.len();
        let spread = |of: &Predicted| -> Vec<f64> {
            let cell =
                |k: usize| of.covariance(values[k / size], values[k % size]) + f64::from(k.is_multiple_of(size + 1));
            (0..size * size).map(cell).collect()
        };
        let spreads: Vec<Vec<f64>> = in_parallel(&self.offered.predicted, spread);
        // Of each spread the logarithm of the determinant and the inverse.
        let solved: Vec<Option<(f64, Vec<f64>)>> = in_parallel(&spreads, |spread| {
            let factor = Triangle::factor(spread.clone(), size)?;
            Some((factor.log_determinant(), gram_of(&factor.inverse_columns(), size)))
        });
        let of = |pair: usize| {
            let (a, b) = (pair / count, pair % count);
            let (Some((log_own, _)), Some((log_other, inverse))) = (&solved[a], &solved[b]) else {
                return Separation { true_one: a, other: b, rise: 0.0 };
            };
            let expected = |index: usize| &self.offered.predicted[index].expected;
            let apart: Vec<f64> = values.iter().map(|&value| expected(a)[value] - expected(b)[value]).collect();
            let along = inverse.chunks_exact(size.max(1)).map(|row| dot(row, &apart));
            let square = along.zip(&apart).map(|(along, apart)| along * apart).sum::<f64>() / self.offered.noise;
            let trace = dot(inverse, &spreads[a]);
            let rise = 0.5 * (trace - size as f64 + square + log_other - log_own);
            Separation { true_one: a, other: b, rise: rise.max(0.0) }
        };
        self.pairs().map(of).collect()
    }

    /// The uncertainty of the prediction, now and after the chosen poses are measured: root mean square over the poses to be predicted, m.
    /// It has the variance within each hypothesis, and the distance of the averaged prediction from that of the true hypothesis; each
    /// hypothesis is weighted by its probability.
    pub fn unsure(&self, separations: &[Separation]) -> [f64; 2] {
        let log = |index: usize| self.offered.log_probabilities[index];
        let now = |_: usize, b: usize| log(b);
        let after = |a: usize, b: usize| {
            let rise = separations.iter().find(|one| (one.true_one, one.other) == (a, b));
            log(b) - rise.map_or(0.0, |one| one.rise)
        };
        [self.error(&self.begun, &now), self.error(&self.now, &after)]
    }

    /// `weights`: logarithm of the weight of hypothesis b if a is true.
    fn error(&self, state: &State, weights: &dyn Fn(usize, usize) -> f64) -> f64 {
        let count = self.offered.predicted.len();
        let rows = self.offered.candidates..self.offered.rows.len();
        let mut sum = 0.0;
        for a in 0..count {
            let top = (0..count).map(|b| weights(a, b)).fold(f64::NEG_INFINITY, f64::max);
            let weight: Vec<f64> = (0..count).map(|b| (weights(a, b) - top).exp()).collect();
            let total: f64 = weight.iter().sum();
            let mut square = 0.0;
            for row in rows.clone() {
                let height = self.offered.rows[row].len();
                for (line, value) in self.offered.rows[row].clone().enumerate() {
                    let variance = state.of[a].blocks[row][line * height + line].max(0.0) * self.offered.noise;
                    let off: f64 = (0..count).map(|b| weight[b] / total * state.apart[a * count + b][value]).sum();
                    square += (variance + off * off) * self.offered.metres[value].powi(2);
                }
            }
            sum += self.offered.log_probabilities[a].exp() * square;
        }
        (sum / rows.len().max(1) as f64 / self.offered.series.max(1) as f64).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;
    use rand_distr::StandardNormal;

    const ROWS: usize = 12;
    const CANDIDATES: usize = 9;
    const HEIGHT: usize = 2;
    const SIZE: usize = 5;

    /// Two hypotheses about rows of two values each, drawn.
    fn predictions() -> Vec<Predicted> {
        let mut random = ChaCha8Rng::seed_from_u64(7);
        let mut draw = |count: usize, size: f64| -> Vec<f64> {
            (0..count).map(|_| size * random.sample::<f64, _>(StandardNormal)).collect()
        };
        let values = ROWS * HEIGHT;
        (0..2).map(|_| Predicted::new(draw(values, 0.6), draw(values * SIZE, 0.5), SIZE)).collect()
    }

    fn rows() -> Vec<Range<usize>> {
        (0..ROWS).map(|row| row * HEIGHT..(row + 1) * HEIGHT).collect()
    }

    fn design<'a>(rows: &'a [Range<usize>], metres: &'a [f64]) -> Design<'a> {
        let log_probabilities = vec![0.7f64.ln(), 0.3f64.ln()];
        let predicted = predictions();
        Design::new(Offered {
            predicted,
            log_probabilities,
            noise: 1.0,
            rows,
            metres,
            candidates: CANDIDATES,
            series: 1,
        })
    }

    /// As if these rows had been chosen.
    fn begin(design: &mut Design<'_>, rows: &[usize]) {
        for &row in rows {
            design.add(row);
        }
    }

    /// Covariance of the values of some rows with their noise, and what is expected of them.
    fn written_out(of: &Predicted, chosen: &[usize]) -> (DMatrix<f64>, DVector<f64>) {
        let values: Vec<usize> = chosen.iter().flat_map(|row| row * HEIGHT..(row + 1) * HEIGHT).collect();
        let one = |i: usize, k: usize| if i == k { 1.0 } else { 0.0 };
        let covariance =
            DMatrix::from_fn(values.len(), values.len(), |i, k| of.covariance(values[i], values[k]) + one(i, k));
        (covariance, DVector::from_iterator(values.len(), values.iter().map(|&value| of.expected[value])))
    }

    #[test]
    fn values_one_by_one_say_what_they_say_together() {
        let (rows, metres) = (rows(), vec![1.0; ROWS * HEIGHT]);
        let mut design = design(&rows, &metres);
        let chosen = [4, 0, 7];
        begin(&mut design, &chosen);
        let predicted = predictions();
        for (pair, [a, b]) in [(1, [0, 1]), (2, [1, 0])] {
            let (covariance, own) = written_out(&predicted[b], &chosen);
            let apart = written_out(&predicted[a], &chosen).1 - own;
            let together = apart.dot(&covariance.clone().cholesky().unwrap().solve(&apart));
            assert!((design.now.noncentrality[pair] - together).abs() < 1e-9, "{pair}");
            // What the pose promises is what it brings.
            let before = design.log_bound(Some(2));
            let mut with = self::design(&rows, &metres);
            begin(&mut with, &[4, 0, 7, 2]);
            assert!((before - with.log_bound(None)).abs() < 1e-9);
            // A row that was not chosen, given those that were.
            let cross = DMatrix::from_fn(chosen.len() * HEIGHT, 1, |i, _| {
                predicted[b].covariance(chosen[i / HEIGHT] * HEIGHT + i % HEIGHT, 11)
            });
            let known = (cross.transpose() * covariance.cholesky().unwrap().solve(&cross))[(0, 0)];
            let left = predicted[b].covariance(11, 11) - known;
            assert!((design.now.of[b].blocks[5][3] - left).abs() < 1e-9);
        }
    }

    #[test]
    fn odds_rise_on_average_as_expected() {
        let (rows, metres) = (rows(), vec![1.0; ROWS * HEIGHT]);
        let mut design = design(&rows, &metres);
        design.chosen = vec![1, 5, 8];
        let predicted = predictions();
        let mut random = ChaCha8Rng::seed_from_u64(3);
        for separation in design.separations() {
            let (own, expected) = written_out(&predicted[separation.true_one], &design.chosen);
            let (other, expected_else) = written_out(&predicted[separation.other], &design.chosen);
            let (own, other) = (own.cholesky().unwrap(), other.cholesky().unwrap());
            let log_density = |of: &Cholesky<f64, Dyn>, left: DVector<f64>| {
                -0.5 * left.dot(&of.solve(&left)) - of.l().diagonal().iter().map(|cell| cell.ln()).sum::<f64>()
            };
            let draws = 40_000;
            let mut ratios = Vec::with_capacity(draws);
            for _ in 0..draws {
                let noise = DVector::from_fn(expected.len(), |_, _| random.sample::<f64, _>(StandardNormal));
                let drawn = &expected + own.l() * noise;
                ratios.push(log_density(&own, &drawn - &expected) - log_density(&other, &drawn - &expected_else));
            }
            let mean = ratios.iter().sum::<f64>() / draws as f64;
            let spread = (ratios.iter().map(|ratio| (ratio - mean).powi(2)).sum::<f64>() / draws as f64).sqrt();
            let off = (mean - separation.rise).abs();
            assert!(off < 4.0 * spread / (draws as f64).sqrt(), "{separation:?}: {mean} drawn");
        }
    }

    #[test]
    fn every_pose_lowers_what_is_left_unsure_and_the_choice_lowers_it_most() {
        let (rows, metres) = (rows(), vec![1e-3; ROWS * HEIGHT]);
        let mut chosen = design(&rows, &metres);
        chosen.choose(3);
        assert_eq!(chosen.chosen.len(), 3);
        let [now, after] = chosen.unsure(&chosen.separations());
        assert!(after < now, "{now} {after}");
        // One hypothesis: the first pose is the one of all that lowers the variance most.
        let one = || {
            let predicted = predictions().into_iter().take(1).collect();
            let offered = Offered {
                predicted,
                log_probabilities: vec![0.0],
                noise: 1.0,
                rows: &rows,
                metres: &metres,
                candidates: CANDIDATES,
                series: 1,
            };
            Design::new(offered)
        };
        let mut best = one();
        best.choose(1);
        let left = |row: usize| {
            let mut design = one();
            begin(&mut design, &[row]);
            design.unsure(&[])[1]
        };
        let least = (0..CANDIDATES).min_by(|a, b| left(*a).total_cmp(&left(*b))).unwrap();
        assert_eq!(best.chosen, [least]);
        assert_eq!(best.for_separation, 0);
    }
}
