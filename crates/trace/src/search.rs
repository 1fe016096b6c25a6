//! The stepwise search that proposes candidates: add the best, refit, and list its close rivals. Which of them act is decided later, by
//! the comparison of sets (`infer`).

use crate::ScanCell;
use crate::downdate::Reduced;
use crate::scorer::{CandidateScorer, Scored, leaders};
use crate::tracer::{State, Tracer};
use denavit_identify::averaging::LEAST_REJECTED;
use denavit_identify::effects::candidates::Candidate;
use denavit_identify::effects::model::EffectModel;
use denavit_identify::parameters::NoEffects;
use denavit_identify::solve::Fit;
use denavit_linear::threads::in_parallel;
use denavit_measurements::Measurements;

/// An effect must lower the information criterion by this much: odds of e^5 against chance, the search not counted.
const LEAST_DELTA_BIC: f64 = 10.0;
/// New scanned numbers that explain less than this (χ²) beyond the present ones count as the same.
const SAME_DROP: f64 = 0.1;
/// An effect that explains less than this share of what the present one does is not a rival.
const CONTENDS: f64 = 0.7;
/// Number of rivals of each effect that are proposed.
const NEAREST: usize = 3;
/// How many of the best candidates of a pass have their scanned numbers refined.
const REFINED: usize = 6;
/// Number of further candidates that are proposed, the best that could still be added.
const PROPOSED: usize = 24;
/// Largest number of effects found through rejected rows.
const MOST_LOCAL: usize = 3;
/// Largest number of effects that the search adds: with their rivals and further candidates these are enough. The comparison of sets
/// decides how many act.
const STEPPED: usize = 8;
/// Bound on the influence of a rejected row that is restored, in units of the noise.
const BOUNDED: f64 = 4.0;

/// What the search proposes for the comparison of sets.
pub struct Proposals {
    /// The terms.
    pub(crate) candidates: Vec<Candidate>,
    /// The model that the search ended with.
    pub(crate) state: State,
    /// The first pass.
    pub(crate) scan: Vec<ScanCell>,
}

impl Tracer<'_> {
    /// The candidates for the comparison of sets: a stepwise search, from geometry alone. `some`: the rows that it uses and the fit there, if
    /// they are not all. These rows show which effects there are, but their scanned numbers only roughly.
    pub(crate) fn proposals(&self, some: Option<(&Measurements, &Fit<NoEffects>)>) -> Proposals {
        let Proposals { mut candidates, state: found, scan } = match some {
            Some((data, geometric)) => self.on(data, geometric).searched(),
            None => self.searched(),
        };
        let mut state = found.clone();
        if some.is_some() {
            let fitted = self.refitted(found.chosen.clone(), Some(&found));
            state = self.moved(&fitted).unwrap_or(fitted);
        }
        while rejected(&state.fit) > 0
            && let Some(next) = self.moved(&state).filter(|next| rejected(&next.fit) < rejected(&state.fit))
        {
            state = next;
        }
        for (found, moved) in found.chosen.iter().zip(&state.chosen) {
            let same = candidates.iter_mut().filter(|candidate| candidate.term == found.term);
            same.for_each(|candidate| *candidate = moved.clone());
        }
        Proposals { candidates, state, scan }
    }

    /// A state with scanned numbers from all rows, rejected ones included; `None` if they do not change. A step on the wrong side of some rows
    /// makes outliers of them, and the other rows do not show that.
    fn moved(&self, state: &State) -> Option<State> {
        let moved = self.rescanned(self.opened(state));
        (!same_terms(&moved.chosen, &state.chosen)).then(|| self.refitted(moved.chosen.clone(), Some(&moved)))
    }

    /// A stepwise search, from geometry alone.
    fn searched(&self) -> Proposals {
        let bare = self.refitted(Vec::new(), None);
        let mut state = bare.clone();
        for _ in 0..MOST_LOCAL {
            let Some(next) = self.local(&state) else { break };
            state = next;
        }
        let mut scan = Vec::new();
        for _ in 0..self.options.max_effects.map_or(STEPPED, |most| most.min(STEPPED)) {
            let Some(next) = self.asked_for(&state, &mut scan) else { break };
            state = self.rescanned(self.added(&state, &next));
        }
        for index in 0..state.chosen.len() {
            state = self.swapped(&state, index).unwrap_or(state);
        }
        let mut candidates = Vec::new();
        self.propose(&state, &mut candidates);
        if !state.chosen.is_empty() {
            self.propose(&bare, &mut candidates);
        }
        Proposals { candidates, state, scan }
    }

    /// The candidate that the data support most at a state, if any.
    fn asked_for(&self, state: &State, scan: &mut Vec<ScanCell>) -> Option<Candidate> {
        let linear = self.linear(state);
        let scorer = self.scorer(linear);
        let model = self.loosely_without(state, &[]);
        let scored = self.scored(state, &model);
        if scan.is_empty() {
            *scan = self.scan(&scored);
        }
        self.best(&scorer, &model, &scored).map(|best| best.candidate)
    }

    /// Adds the terms of a state, the rivals of each, and the best that could still be added.
    fn propose(&self, state: &State, proposed: &mut Vec<Candidate>) {
        let mut add = |candidate: Candidate| {
            if !proposed.iter().any(|known| known.term == candidate.term) {
                proposed.push(candidate);
            }
        };
        state.chosen.iter().cloned().for_each(&mut add);
        (0..state.chosen.len()).flat_map(|index| self.contenders(state, index)).for_each(&mut add);
        let linear = self.linear(state);
        let model = self.loosely_without(state, &[]);
        let scorer = self.scorer(linear);
        let mut scored = self.scored(state, &model);
        scored.retain(|scored| scored.delta_bic > 0.0);
        let best = leaders(&scored, PROPOSED, None);
        let (first, others) = best.split_at(best.len().min(REFINED));
        let refined = |candidate: &&Candidate| scorer.refined(&model, &self.survey, candidate).candidate;
        in_parallel(first, refined).into_iter().chain(others.iter().copied().cloned()).for_each(&mut add);
    }

    /// An effect that explains rows which the robust fit rejected as outliers.
    ///
    /// Rejected rows are restored with weights that bound their influence; an effect found with them counts only if the
    /// robust fit then keeps at least half of them.
    fn local(&self, state: &State) -> Option<State> {
        let before = rejected(&state.fit);
        if before < LEAST_REJECTED {
            return None;
        }
        let open = self.opened(state);
        let linear = self.linear(&open);
        let model = self.loosely_without(&open, &[]);
        let scorer = self.scorer(linear);
        let scored = self.scored(&open, &model);
        let best = self.best(&scorer, &model, &scored)?;
        let next = self.rescanned(self.added(state, &best.candidate));
        // Rows that were rejected at the first scanned place may be restored.
        let next = self.refitted(next.chosen.clone(), Some(&next));
        (rejected(&next.fit) * 2 <= before).then_some(next)
    }

    /// A state with rejected rows restored, their influence bounded.
    fn opened(&self, state: &State) -> State {
        let mut open = State::new(state.chosen.clone(), state.fit.clone());
        for (at, (weight, square)) in open.fit.weights.iter_mut().zip(&state.fit.squares).enumerate() {
            let size = state.fit.noise.chi_squared(self.data.series_of(at), *square).sqrt();
            *weight = (BOUNDED / size.max(BOUNDED)).max(f64::MIN_POSITIVE);
        }
        open
    }

    /// The best candidate of a pass, after refinement of the leaders' scanned numbers.
    fn best(&self, scorer: &CandidateScorer<'_>, model: &Reduced<'_>, scored: &[Scored]) -> Option<Scored> {
        let leaders = leaders(scored, REFINED, None);
        let leaders = in_parallel(&leaders, |leader| scorer.refined(model, &self.survey, leader));
        let passing = leaders.into_iter().filter(|scored| self.passes(scored));
        passing.max_by(|a, b| a.worth().total_cmp(&b.worth()))
    }

    /// Beyond chance, with the whole search counted.
    fn passes(&self, scored: &Scored) -> bool {
        scored.delta_bic > LEAST_DELTA_BIC && self.corrected(scored.p_value()) < self.options.false_claims
    }

    /// A probability with the whole search counted.
    fn corrected(&self, p_value: f64) -> f64 {
        (p_value * self.candidates.len() as f64).min(1.0)
    }

    /// The state with one more term.
    fn added(&self, state: &State, candidate: &Candidate) -> State {
        let chosen = state.chosen.iter().chain([candidate]).cloned().collect();
        self.refitted(chosen, Some(state))
    }

    /// Refines every scanned number, with everything else in the model.
    fn rescanned(&self, state: State) -> State {
        if state.chosen.iter().all(|candidate| candidate.scanned == 0) {
            return state;
        }
        let linear = self.linear(&state);
        let scorer = self.scorer(linear);
        let moved = |&index: &usize| {
            let candidate = &state.chosen[index];
            let model = self.loosely_without(&state, &[index]);
            let refined = scorer.refined(&model, &self.survey, candidate);
            let better = refined.candidate.scanned != candidate.scanned
                || refined.gain.drop > scorer.own(&model, candidate).gain.drop + SAME_DROP;
            better.then_some((index, refined.candidate))
        };
        let scanned: Vec<usize> = (0..state.chosen.len()).filter(|&index| state.chosen[index].scanned > 0).collect();
        let moved: Vec<(usize, Candidate)> = in_parallel(&scanned, moved).into_iter().flatten().collect();
        if moved.is_empty() {
            return state;
        }
        let mut chosen = state.chosen.clone();
        for (index, candidate) in moved {
            chosen[index] = candidate;
        }
        self.followed(chosen, &state)
    }

    /// Refits after a small change, starting from the state and its known outliers.
    fn followed(&self, chosen: Vec<Candidate>, state: &State) -> State {
        self.fitted(chosen, &state.fit.arm, &state.fit.weights, false)
    }

    /// The state with an effect replaced by a better one: an effect that was added first may have absorbed others that were added later.
    fn swapped(&self, state: &State, index: usize) -> Option<State> {
        let (scorer, own) = (self.scorer(self.linear(state)), state.chosen.get(index)?);
        let model = self.loosely_without(state, &[index]);
        let best = self.best(&scorer, &model, &self.scored(state, &model))?;
        (best.candidate.term != own.term && best.worth() > scorer.own(&model, own).worth()).then(|| {
            let mut chosen = state.chosen.clone();
            chosen[index] = best.candidate;
            self.rescanned(self.followed(chosen, state))
        })
    }

    /// Candidates that explain nearly as much as an effect of a state, in place of it.
    fn contenders(&self, state: &State, index: usize) -> Vec<Candidate> {
        let scorer = self.scorer(self.linear(state));
        let model = self.loosely_without(state, &[index]);
        let own = scorer.own(&model, &state.chosen[index]);
        let mut scored = self.scored(state, &model);
        scored.retain(|other| other.gain.drop > CONTENDS * own.gain.drop);
        let near = leaders(&scored, NEAREST, Some(&state.chosen[index]));
        in_parallel(&near, |other| scorer.refined(&model, &self.survey, other).candidate)
    }
}

/// How many rows a fit rejects as outliers.
fn rejected(fit: &Fit<EffectModel>) -> usize {
    fit.weights.iter().filter(|weight| **weight == 0.0).count()
}

pub(crate) fn same_terms(a: &[Candidate], b: &[Candidate]) -> bool {
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| a.term == b.term)
}
