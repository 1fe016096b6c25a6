//! The residual of each channel of measured values, and the degrees of freedom that the model's parameters use there.

use crate::infer::curves::{Round, State};
use crate::infer::evidence::Posterior;
use denavit_identify::effects::curve::Curve;
use denavit_linear::products::cross_gram;
use denavit_linear::triangle::dot;
use denavit_measurements::Measurements;

/// Rows from which the parameters' degrees of freedom are divided among the channels.
const ROWS_SAMPLED: usize = 128;

/// Sums of a channel's values, for its noise.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct ChannelMisfit {
    /// Sum of squared residuals, in units of its previous noise.
    pub misfit: f64,
    /// Values, weighted.
    pub count: f64,
    /// Degrees of freedom that the model's parameters use.
    pub used: f64,
}

impl Round {
    /// Residual and used degrees of freedom of each channel at the posterior mean, which the curves have. The total of the latter comes from
    /// the products; some rows show how it is divided among the channels.
    pub(super) fn channel_misfits(
        &self,
        data: &Measurements,
        state: &State,
        (posterior, curves): (&Posterior, &[Curve]),
        precision: f64,
    ) -> Vec<ChannelMisfit> {
        let mut found = vec![ChannelMisfit::default(); data.scene.channels.len()];
        let mut left = self.explained.clone();
        for (column, mean) in self.plain.iter().zip(&posterior.mean) {
            left.iter_mut().zip(column).for_each(|(left, x)| *left -= x * mean);
        }
        for ((curve, readings), joint) in curves.iter().zip(&state.readings).zip(&self.joints) {
            let curve: Vec<f64> = readings.iter().map(|reading| curve.value(*reading)).collect();
            for ((left, x), row) in left.iter_mut().zip(joint).zip(&self.linear.rows) {
                *left -= x * curve[*row];
            }
        }
        for ((left, weight), channel) in left.iter().zip(&self.linear.weights).zip(&self.linear.channels) {
            let Some(own) = found.get_mut(*channel) else { continue };
            own.misfit += left * left;
            own.count += weight;
        }
        let size = self.gram.size;
        let covariances = posterior.covariances();
        let used: f64 = (0..size)
            .map(|i| {
                let (row, own) = (&covariances[i * size..=i * size + i], &self.gram.matrix[i * size..=i * size + i]);
                2.0 * dot(row, own) - row[i] * own[i]
            })
            .sum();
        self.distribute(state, &covariances, used * precision, &mut found);
        found
    }

    /// Divides the used degrees of freedom among the channels, as in rows spread over the run.
    fn distribute(&self, state: &State, covariances: &[f64], used: f64, channels: &mut [ChannelMisfit]) {
        let size = self.gram.size;
        let rows = state.readings.first().map_or(0, Vec::len);
        let every = rows.div_ceil(ROWS_SAMPLED).max(1);
        let some: Vec<usize> =
            (0..self.linear.rows.len()).filter(|&value| self.linear.rows[value].is_multiple_of(every)).collect();
        let mut cells = vec![0.0; some.len() * size];
        for (&value, cells) in some.iter().zip(cells.chunks_exact_mut(size)) {
            let (plain, mut rest) = cells.split_at_mut(self.gram.plain);
            plain.iter_mut().zip(&self.plain).for_each(|(cell, column)| *cell = column[value]);
            for ((waves, readings), joint) in self.waves.iter().zip(&state.readings).zip(&self.joints) {
                let (own, others) = rest.split_at_mut(waves.len());
                waves.values_into(readings[self.linear.rows[value]], own);
                for cell in own.iter_mut() {
                    *cell *= joint[value];
                }
                rest = others;
            }
        }
        let through = cross_gram(covariances, &cells, size);
        let mut shares = vec![0.0; channels.len()];
        for ((&value, cells), through) in some.iter().zip(cells.chunks_exact(size)).zip(through.chunks_exact(size)) {
            if let Some(share) = shares.get_mut(self.linear.channels[value]) {
                *share += dot(cells, through);
            }
        }
        let all: f64 = shares.iter().sum();
        for (channel, share) in channels.iter_mut().zip(shares) {
            channel.used = if all > 0.0 { used * share / all } else { 0.0 };
        }
    }
}
