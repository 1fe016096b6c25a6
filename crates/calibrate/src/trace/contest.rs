//! Effects that look alike to first order, told apart by fitting each.

use crate::effects::catalogue::Candidate;
use crate::effects::driver::Driver;
use crate::identify::threads::in_parallel;
use crate::trace::search::{handicap, leaders};
use crate::trace::select::{CONTENDS, SWAP_GAIN, State, Tracer};
use std::ops::Range;

/// So many others are fitted in the place of an effect.
const FITTED: usize = 3;
/// What a rejected row costs: about the least χ² for which a row is rejected.
const REJECTION: f64 = 40.0;

impl Tracer<'_> {
    /// The state with one effect changed for another that fits better, or with the steps of two drifts as one.
    ///
    /// The scan compares effects on the model linearised where it stands. Large effects bend that: so those that come
    /// near are fitted, and the fits compared. `contested`: indices of the effects in question.
    pub(crate) fn contested(&self, state: &State, contested: Range<usize>) -> Option<State> {
        let had = self.criterion(state);
        let mut others = self.contenders(state, contested);
        others.extend(with_steps_elsewhere(&state.chosen));
        let fitted = in_parallel(&others, |chosen| {
            let next = self.followed(chosen.clone(), state);
            (self.criterion(&next), next)
        });
        let better = fitted.into_iter().filter(|(found, _)| *found < had - SWAP_GAIN);
        let best = better.min_by(|a, b| a.0.total_cmp(&b.0));
        // Other effects, other outliers.
        best.map(|(_, next)| self.rescanned(self.refitted(next.chosen.clone(), Some(&next))))
    }

    /// The sets of terms that are worth a fit.
    pub(crate) fn contenders(&self, state: &State, contested: Range<usize>) -> Vec<Vec<Candidate>> {
        let linear = self.linear(state);
        let scorer = self.scorer(linear);
        let mut sets = Vec::new();
        for index in contested {
            let model = self.loosely_without(state, &[index]);
            let own = scorer.own(&model, &state.chosen[index]);
            let mut scored = self.scored(state, &model);
            scored.retain(|other| other.gain.drop > CONTENDS * own.gain.drop);
            let near = leaders(&scored, FITTED, Some(&state.chosen[index]));
            sets.extend(in_parallel(&near, |other| {
                let mut chosen = state.chosen.clone();
                chosen[index] = scorer.refined(&model, &self.survey, other).candidate;
                chosen
            }));
        }
        sets
    }

    /// What a fit is judged by, less is better: n ln(RSS) of each channel, the prior, k ln n for the effects' numbers.
    pub(crate) fn criterion(&self, state: &State) -> f64 {
        let fit = &state.fit;
        let prior = fit.layout.prior_cost(&fit.arm, &self.geometric.arm);
        let values: f64 = fit.values.iter().sum();
        let numbers: usize =
            state.chosen.iter().map(|candidate| candidate.scanned).sum::<usize>() + fit.layout.effects.len();
        let handicaps: f64 = state.chosen.iter().map(|candidate| handicap(candidate.term.kind)).sum();
        let channels = fit.noise.levels.iter().zip(&fit.values).zip(&fit.parameters_used);
        let misfit: f64 = channels
            .filter(|((noise, values), _)| **noise > 0.0 && **values > 0.0)
            .map(|((noise, values), used)| values * (noise * noise * (values - used) / values).ln())
            .sum();
        let rejected = fit.weights.iter().filter(|weight| **weight == 0.0).count();
        misfit + prior + numbers as f64 * values.ln() + REJECTION * rejected as f64 + handicaps
    }
}

/// Drifts by steps at two places, written as steps at one of them.
fn with_steps_elsewhere(chosen: &[Candidate]) -> Vec<Vec<Candidate>> {
    let steps: Vec<usize> =
        (0..chosen.len()).filter(|&k| matches!(chosen[k].term.driver, Driver::Steps { .. })).collect();
    let mut sets = Vec::new();
    for &moved in &steps {
        for &onto in steps.iter().filter(|&&other| other != moved) {
            let mut set = chosen.to_vec();
            set[moved].term.carrier = chosen[onto].term.carrier;
            sets.push(set);
        }
    }
    sets
}
