//! The search: add the best, refit, swap, merge, drop, and say what cannot be told apart.

use crate::effects::carrier::Carrier;
use crate::effects::catalogue::{Candidate, KINDS, Kind};
use crate::effects::driver::{Driver, Statics};
use crate::effects::model::EffectModel;
use crate::effects::survey::Survey;
use crate::identify::averaging::LEAST_REJECTED;
use crate::identify::fit_stage;
use crate::identify::solve::{Fit, FitOptions};
use crate::identify::threads::{available, each_alone, get_or_make, in_parallel, join};
use crate::observation::arm::Arm;
use crate::observation::kinds::{DISTANCE, POSE, POSITION};
use crate::observation::measurements::Measurements;
use crate::observation::parameters::NoEffects;
use crate::trace::downdate::{Reduced, Whole};
use crate::trace::drifts::COARSE;
use crate::trace::holdout::{Folds, held_out};
use crate::trace::linear::{Linear, linearise};
use crate::trace::search::{CandidateScorer, Linearised, Models, Scored, carriers_of, driven, leaders};
use crate::trace::unexplained::{self, Block};
use crate::trace::{ScanCell, TraceOptions};
use denavit_model::nalgebra::{DMatrix, DVector};
use std::sync::{Arc, OnceLock};

/// An effect must lower the information criterion by this much: odds of e^5 against chance, the search not counted.
pub(crate) const LEAST_DELTA_BIC: f64 = 10.0;
/// A swap must gain this much, or the search would go round in circles.
pub(crate) const SWAP_GAIN: f64 = 2.0;
/// Scanned numbers that explain no more than this (χ²) beyond those at hand are the same.
const SAME_DROP: f64 = 0.1;
/// States that hold the same kinds and whose criteria differ by less than this are one.
const SAME: f64 = 0.5;
/// Changes of one effect for another by fitting both, at the end.
const MOST_CONTESTS: usize = 3;
/// No effect of a machine leaves this much in each measured component, m: only a joint that counts another joint's angle with its own.
const FAR_OFF: f64 = 0.02;
/// Changes for the better, one after the other, at most.
const MOST_CHANGES: usize = 8;
/// An effect that explains less than this share of what the present one does is no contender.
pub(crate) const CONTENDS: f64 = 0.7;
/// How many of the best candidates of a pass have their scanned numbers refined.
const REFINED: usize = 6;
/// So many of the best that could still be added are proposed.
const PROPOSED: usize = 24;
/// χ² that the last step of a fit may promise: far less than what a swap must gain.
const PROMISE_AT_END: f64 = 1e-2;
/// So many effects may hide behind rejected rows.
const MOST_LOCAL: usize = 3;
/// Effects that the search takes step by step: with what comes near them and could be added there are candidates enough. How many act says the
/// judgement.
const STEPPED: usize = 8;
/// Pull of a rejected row that comes back, in units of the noise.
const BOUNDED: f64 = 4.0;
/// Where structure is left that no entry explains, an effect that explains less than this share of it is spurious and not named.
const SPURIOUS: f64 = 0.5;
/// So is one that explains less than this many times what is left, if it adds nothing beside that structure.
const SPURIOUS_BESIDE: f64 = 3.0;

/// The search and what it works with.
pub struct Tracer<'a> {
    pub(crate) data: &'a Measurements,
    pub(crate) statics: &'a Statics,
    pub(crate) options: &'a TraceOptions,
    pub(crate) geometric: &'a Fit<NoEffects>,
    pub(crate) survey: Survey,
    pub(crate) candidates: Vec<Candidate>,
    /// What drives each of them, see [`driven`].
    driven: OnceLock<Vec<Vec<f64>>>,
    /// What may be left that no entry explains.
    blocks: OnceLock<Vec<Block>>,
    carriers: Vec<Carrier>,
}

/// The model at one point of the search.
#[derive(Clone)]
pub struct State {
    pub(crate) chosen: Vec<Candidate>,
    pub(crate) fit: Fit<EffectModel>,
    /// What was asked of the model there.
    at: Arc<OnceLock<Linearised>>,
}

/// What the search puts before the judge.
pub struct Proposals {
    /// The terms.
    pub(crate) candidates: Vec<Candidate>,
    /// The models that the search ended with.
    pub(crate) states: Vec<State>,
    /// The first pass.
    pub(crate) scan: Vec<ScanCell>,
}

impl State {
    /// The model of a fit.
    pub(crate) fn new(chosen: Vec<Candidate>, fit: Fit<EffectModel>) -> Self {
        Self { chosen, fit, at: Arc::default() }
    }

    /// The columns of these effects, with their coefficients.
    fn columns_of(&self, effects: &[usize]) -> Vec<(usize, f64)> {
        let all = self.fit.effects.effects.iter().enumerate();
        let numbers = all.flat_map(|(index, effect)| effect.coefficients.iter().map(move |number| (index, *number)));
        let own = numbers.enumerate().filter(|(_, (index, _))| effects.contains(index));
        own.map(|(column, (_, number))| (column, number)).collect()
    }

    /// The columns of the other effects, and the residual without these.
    pub(crate) fn parts(&self, linear: &Linear, left_out: &[usize]) -> (DMatrix<f64>, DVector<f64>) {
        let mut residual = linear.residual.clone();
        let mut kept = Vec::new();
        let mut column = 0;
        for (index, effect) in self.fit.effects.effects.iter().enumerate() {
            for coefficient in &effect.coefficients {
                if left_out.contains(&index) {
                    residual.axpy(-coefficient, &linear.effects.column(column), 1.0);
                } else {
                    kept.push(column);
                }
                column += 1;
            }
        }
        (linear.effects.select_columns(kept.iter()), residual)
    }
}

impl<'a> Tracer<'a> {
    /// Looks at the data and lists the candidates.
    pub fn new(
        statics: &'a Statics,
        data: &'a Measurements,
        geometric: &'a Fit<NoEffects>,
        options: &'a TraceOptions,
    ) -> Self {
        let survey = Survey::of(statics, data, options.gear_ratios.clone());
        let wanted = |kind: Kind| options.kinds.is_empty() || options.kinds.contains(&kind);
        let candidates: Vec<Candidate> =
            KINDS.iter().filter(|entry| wanted(entry.kind)).flat_map(|entry| (entry.terms)(&survey)).collect();
        let mut carriers = carriers_of(candidates.iter().map(|candidate| &candidate.term));
        for carrier in unexplained::carriers(&survey) {
            if !carriers.contains(&carrier) {
                carriers.push(carrier);
            }
        }
        Self {
            data,
            statics,
            options,
            geometric,
            survey,
            candidates,
            driven: OnceLock::new(),
            blocks: OnceLock::new(),
            carriers,
        }
    }

    /// The terms that are worth being judged: a search step by step, from geometry alone.
    pub fn run(&self) -> Proposals {
        self.ended(self.searched())
    }

    /// The same where the search looks at some of the rows: so many show what there is to be found, but not to the last digit where it is.
    pub(crate) fn run_on(&self, data: &Measurements, geometric: &Fit<NoEffects>) -> Proposals {
        self.ended(self.on(data, geometric).searched())
    }

    /// What a search proposes, its states as all rows have them.
    fn ended(&self, Proposals { mut candidates, states, scan }: Proposals) -> Proposals {
        let mut ended: Vec<State> = Vec::with_capacity(states.len());
        for (index, state) in states.iter().enumerate() {
            let known = states[..index].iter().position(|other| same_terms(&other.chosen, &state.chosen));
            let all = known.map_or_else(|| self.on_all_rows(state), |known| ended[known].clone());
            for (some, all) in state.chosen.iter().zip(&all.chosen) {
                candidates
                    .iter_mut()
                    .filter(|candidate| candidate.term == some.term)
                    .for_each(|candidate| *candidate = all.clone());
            }
            ended.push(all);
        }
        Proposals { candidates, states: ended, scan }
    }

    /// A state that was found on some of the rows, or on all, its scanned numbers where all say that they are.
    fn on_all_rows(&self, state: &State) -> State {
        let mut all = if state.fit.weights.len() == self.data.observations() {
            state.clone()
        } else {
            let fitted = self.refitted(state.chosen.clone(), Some(state));
            self.moved(&fitted).unwrap_or(fitted)
        };
        for _ in 0..MOST_CHANGES {
            let before = rejected(&all.fit);
            if before == 0 {
                break;
            }
            let Some(next) = self.moved(&all).filter(|next| rejected(&next.fit) < before) else { break };
            all = next;
        }
        all
    }

    /// A state with its scanned numbers where all rows say that they are, those that it takes for outliers as well, if that is elsewhere: a step
    /// that stands on the wrong side of some rows makes outliers of them, and none of the others say so.
    fn moved(&self, state: &State) -> Option<State> {
        let moved = self.rescanned(self.opened(state));
        (!same_terms(&moved.chosen, &state.chosen)).then(|| self.refitted(moved.chosen.clone(), Some(&moved)))
    }

    /// The same on some of the rows: what may be looked for is what all of them let one ask.
    fn on<'b>(&'b self, data: &'b Measurements, geometric: &'b Fit<NoEffects>) -> Tracer<'b> {
        Tracer {
            data,
            statics: self.statics,
            options: self.options,
            geometric,
            survey: self.survey.clone(),
            candidates: self.candidates.clone(),
            driven: OnceLock::new(),
            blocks: OnceLock::new(),
            carriers: self.carriers.clone(),
        }
    }

    /// What drives each candidate, see [`driven`].
    pub(crate) fn driven(&self) -> &[Vec<f64>] {
        get_or_make(&self.driven, || driven(self.data, self.statics, &self.candidates)).as_slice()
    }

    /// Functions of one or two variables that what no entry explains is written as.
    pub(crate) fn blocks(&self) -> &[Block] {
        self.blocks.get_or_init(|| unexplained::blocks(self))
    }

    /// A search step by step, from geometry alone.
    fn searched(&self) -> Proposals {
        let bare = self.refitted(Vec::new(), None);
        let mut state = bare.clone();
        for _ in 0..MOST_LOCAL {
            let Some(next) = self.local(&state) else { break };
            state = next;
        }
        let mut scan = Vec::new();
        let most = self.options.max_effects.map_or(STEPPED, |most| most.min(STEPPED));
        while state.chosen.len() < most {
            let Some(next) = self.asked_for(&state, &mut scan) else { break };
            let before = state.clone();
            state = self.pruned(self.added(&state, &next));
            if let Some(next) = self.separated(&state, COARSE) {
                state = self.rescanned(next);
            }
            if self.criterion(&before) - self.criterion(&state) < LEAST_DELTA_BIC {
                // What is asked for where a model stands need not be worth it when all is fitted with it.
                state = before;
                break;
            }
        }
        if let Some(next) = self.separated(&state, 0) {
            state = self.rescanned(next);
        }
        let mut candidates = Vec::new();
        self.propose(&state, &mut candidates);
        let mut plain = self.without_spurious(&state);
        for _ in 0..MOST_CONTESTS {
            let Some(next) = self.contested(&plain, 0..plain.chosen.len()) else { break };
            plain = self.without_spurious(&next);
        }
        if !same_terms(&plain.chosen, &state.chosen) {
            self.propose(&plain, &mut candidates);
        }
        if !state.chosen.is_empty() && !plain.chosen.is_empty() {
            self.propose(&bare, &mut candidates);
        }
        Proposals { candidates, states: vec![plain, state], scan }
    }

    /// What the data ask for first beside a state, if they do.
    fn asked_for(&self, state: &State, scan: &mut Vec<ScanCell>) -> Option<Candidate> {
        let linear = self.linear(state);
        let scorer = self.scorer(linear);
        let models = self.linearised(state).models();
        let mut scored = self.scored(state, &models.loose);
        if scan.is_empty() {
            *scan = self.scan(&scored);
        }
        if self.far_off(state) {
            scored.retain(|scored| scored.candidate.term.kind == Kind::JointCoupling);
        }
        let best = self.best(&scorer, &models, &scored)?;
        self.helps_held_out(&scorer, &best).then_some(best.candidate)
    }

    /// Whether a model leaves so much that readings must mean something else than angles from link to link: any cause would be found in that.
    fn far_off(&self, state: &State) -> bool {
        let in_metres = self.data.scene.series.iter().all(|series| [POSITION, POSE, DISTANCE].contains(&series.kind));
        in_metres && state.fit.noise.first() > FAR_OFF
    }

    /// Adds the terms of a state, those that come near each of them, and the best that could still be added.
    fn propose(&self, state: &State, proposed: &mut Vec<Candidate>) {
        let mut add = |candidate: Candidate| {
            if !proposed.iter().any(|known| known.term == candidate.term) {
                proposed.push(candidate);
            }
        };
        state.chosen.iter().cloned().for_each(&mut add);
        for index in 0..state.chosen.len() {
            for mut set in self.contenders(state, index..index + 1) {
                add(set.swap_remove(index));
            }
        }
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

    /// Refits with these terms and refines their scanned numbers at the new state.
    pub(crate) fn refitted(&self, chosen: Vec<Candidate>, start: Option<&State>) -> State {
        let arm = start.map_or(&self.geometric.arm, |state| &state.fit.arm);
        self.fitted(chosen, arm, &vec![1.0; self.data.observations()], self.options.identify.fit.robust)
    }

    fn fitted(&self, chosen: Vec<Candidate>, arm: &Arm, weights: &[f64], robust: bool) -> State {
        let mut options = self.options.identify.clone();
        options.fit = FitOptions { robust, least_promise: PROMISE_AT_END, ..options.fit };
        let chosen = with_steps_joined(chosen);
        let terms: Vec<_> = chosen.iter().map(|candidate| candidate.term.clone()).collect();
        let model = EffectModel::of_terms(self.statics, self.options.earlier.as_ref(), &terms);
        let fit = fit_stage(self.data, arm, &model, weights, &options);
        State::new(chosen, fit)
    }

    /// An effect that makes rows of the model that the robust fit took for outliers.
    ///
    /// Rejected rows come back with the weight that keeps their pull bounded; what is found there counts only if the
    /// robust fit then keeps at least half of them.
    fn local(&self, state: &State) -> Option<State> {
        let before = rejected(&state.fit);
        if before < LEAST_REJECTED {
            return None;
        }
        let open = self.opened(state);
        let linear = self.linear(&open);
        let models = self.linearised(&open).models();
        let scorer = self.scorer(linear);
        let scored = self.scored(&open, &models.loose);
        let best = self.best(&scorer, &models, &scored)?;
        let next = self.rescanned(self.added(state, &best.candidate));
        // Rows that the place as first scanned left out may come back.
        let next = self.refitted(next.chosen.clone(), Some(&next));
        (rejected(&next.fit) * 2 <= before).then_some(next)
    }

    /// A state with the rows that were rejected back, their pull bounded.
    fn opened(&self, state: &State) -> State {
        let mut open = State::new(state.chosen.clone(), state.fit.clone());
        for (at, (weight, square)) in open.fit.weights.iter_mut().zip(&state.fit.squares).enumerate() {
            let size = state.fit.noise.chi_squared(self.data.series_of(at), *square).sqrt();
            *weight = (BOUNDED / size.max(BOUNDED)).max(f64::MIN_POSITIVE);
        }
        open
    }

    /// The model linearised at a state.
    pub(crate) fn linear<'b>(&self, state: &'b State) -> &'b Linear {
        &self.linearised(state).linear
    }

    pub(crate) fn linearised<'b>(&self, state: &'b State) -> &'b Linearised {
        let linear = || linearise(self.data, &state.fit, &self.geometric.arm, &self.carriers);
        get_or_make(&state.at, || Linearised::new(linear()))
    }

    /// Loose geometry and all effects of a state but those of these indices, and the residual that this would leave: all that finding scanned
    /// numbers takes.
    pub(crate) fn loosely_without<'b>(&self, state: &'b State, left_out: &[usize]) -> Reduced<'b> {
        self.linearised(state).loose().leaving_out(&state.columns_of(left_out))
    }

    /// The same on loose geometry and on geometry in its tolerances.
    fn models_leaving_out<'b>(&self, state: &'b State, left_out: &[usize]) -> Models<'b> {
        let (at, columns) = (self.linearised(state), state.columns_of(left_out));
        Models { loose: at.loose().leaving_out(&columns), firm: at.firm().leaving_out(&columns) }
    }

    pub(crate) fn scorer<'b>(&'b self, linear: &'b Linear) -> CandidateScorer<'b> {
        CandidateScorer { data: self.data, statics: self.statics, linear }
    }

    /// The best candidate of a pass, the leaders' scanned numbers refined.
    pub(crate) fn best(&self, scorer: &CandidateScorer<'_>, models: &Models<'_>, scored: &[Scored]) -> Option<Scored> {
        let leaders = leaders(scored, REFINED, None);
        let leaders = in_parallel(&leaders, |leader| scorer.refined(&models.loose, &self.survey, leader));
        let firm = |scored: &Scored| scorer.firm_bic(models, &scored.candidate);
        let judged = leaders.into_iter().filter(|scored| self.passes(scored)).map(|scored| (firm(&scored), scored));
        judged.max_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, scored)| scored)
    }

    /// Beyond chance, with the whole search counted.
    pub(crate) fn passes(&self, scored: &Scored) -> bool {
        scored.delta_bic > LEAST_DELTA_BIC && self.corrected(scored.p_value()) < self.options.false_claims
    }

    /// A probability with the whole search counted.
    pub(crate) fn corrected(&self, p_value: f64) -> f64 {
        (p_value * self.candidates.len() as f64).min(1.0)
    }

    fn helps_held_out(&self, scorer: &CandidateScorer<'_>, scored: &Scored) -> bool {
        let linear = scorer.linear;
        let clock = self.survey.clock.as_ref().map(|clock| clock.column.name());
        let follows_run = scored.candidate.term.driver.covariate().is_some_and(|name| Some(name) == clock);
        // A stretch of a file that moves one joint after the other holds all that there is of one: then every fifth row.
        let folds = if follows_run { &[Folds::Interleaved][..] } else { &[Folds::Stretches, Folds::Interleaved] };
        let columns = scorer.columns(&scored.candidate.term);
        let stands = self.data.first_of_posture();
        folds.iter().any(|&folds| {
            let (without, with) = join(
                || held_out(linear, &[&linear.geometry, &linear.effects], &linear.residual, folds, &stands),
                || held_out(linear, &[&linear.geometry, &linear.effects, &columns], &linear.residual, folds, &stands),
            );
            with < without
        })
    }

    /// The state with one more term.
    fn added(&self, state: &State, candidate: &Candidate) -> State {
        let chosen = state.chosen.iter().chain([candidate]).cloned().collect();
        self.refitted(chosen, Some(state))
    }

    /// Swaps, merges and drops until nothing changes.
    fn pruned(&self, state: State) -> State {
        let mut state = self.rescanned(state);
        let before = state.chosen.clone();
        let mut been = vec![(self.criterion(&state), state.clone())];
        for _ in 0..MOST_CHANGES {
            let Some(next) = self.improved(&state) else { break };
            state = self.rescanned(next);
            let now = self.criterion(&state);
            if let Some(circle) = in_circle(&been, now, &state) {
                state = circle;
                break;
            }
            been.push((now, state.clone()));
        }
        if !same_terms(&state.chosen, &before) {
            // Other effects, other outliers.
            state = self.refitted(state.chosen.clone(), Some(&state));
        }
        let newest = state.chosen.len().saturating_sub(1)..state.chosen.len();
        self.contested(&state, newest).unwrap_or(state)
    }

    /// Refines every scanned number with all else in the model.
    pub(crate) fn rescanned(&self, state: State) -> State {
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

    /// Refits after a small change: from the state, which rows are outliers being known.
    pub(crate) fn followed(&self, chosen: Vec<Candidate>, state: &State) -> State {
        self.fitted(chosen, &state.fit.arm, &state.fit.weights, false)
    }

    /// One change for the better: effects dropped, one swapped for a better one, or two of one place merged into one.
    fn improved(&self, state: &State) -> Option<State> {
        let needed = self.needed(state);
        if needed.len() < state.chosen.len() {
            let chosen = needed.into_iter().map(|index| state.chosen[index].clone()).collect();
            return Some(self.followed(chosen, state));
        }
        // The first that is for the better is made: so many are looked at together as there are threads.
        let effects: Vec<usize> = (0..state.chosen.len()).collect();
        for some in effects.chunks(available()) {
            let swapped = each_alone(some, |&index| self.swapped(state, index));
            if let Some(chosen) = swapped.into_iter().flatten().next() {
                return Some(self.followed(chosen, state));
            }
        }
        self.merged(state, &self.scorer(self.linear(state)))
    }

    /// Which effects are needed: those that are not are left out one after the other, the weakest first.
    fn needed(&self, state: &State) -> Vec<usize> {
        let linear = self.linear(state);
        let scorer = self.scorer(linear);
        let mut needed: Vec<usize> = (0..state.chosen.len()).collect();
        loop {
            let own = in_parallel(&needed, |&index| {
                let others = |other: &usize| *other == index || !needed.contains(other);
                let left_out: Vec<usize> = (0..state.chosen.len()).filter(others).collect();
                scorer.own(&self.loosely_without(state, &left_out), &state.chosen[index]).delta_bic
            });
            let weakest = own.into_iter().enumerate().min_by(|a, b| a.1.total_cmp(&b.1));
            match weakest {
                Some((place, own)) if own < LEAST_DELTA_BIC => needed.remove(place),
                _ => return needed,
            };
        }
    }

    /// The terms with a better one in the place of an effect.
    fn swapped(&self, state: &State, index: usize) -> Option<Vec<Candidate>> {
        let linear = self.linear(state);
        let scorer = self.scorer(linear);
        let model = self.loosely_without(state, &[index]);
        let own = scorer.own(&model, &state.chosen[index]);
        let mut scored = self.scored(state, &model);
        scored.retain(|other| other.gain.drop > CONTENDS * own.gain.drop && other.candidate.term != own.candidate.term);
        if scored.is_empty() {
            return None;
        }
        let models = self.models_leaving_out(state, &[index]);
        let mut chosen = state.chosen.clone();
        let best = self.best(&scorer, &models, &scored)?;
        let bic = |candidate: &Candidate| scorer.firm_bic(&models, candidate);
        if best.candidate.term == chosen[index].term || bic(&best.candidate) <= bic(&chosen[index]) + SWAP_GAIN {
            return None;
        }
        chosen[index] = best.candidate;
        Some(chosen)
    }

    /// Several effects at one place where a single candidate does as well.
    fn merged(&self, state: &State, scorer: &CandidateScorer<'_>) -> Option<State> {
        for first in 0..state.chosen.len() {
            // An effect of no joint is merged with none; the others may be.
            let Some(joint) = state.chosen[first].term.carrier.joint() else { continue };
            let same: Vec<usize> = (0..state.chosen.len())
                .filter(|&other| state.chosen[other].term.carrier.joint() == Some(joint))
                .collect();
            if same.len() < 2 || same[0] != first {
                continue;
            }
            let models = self.models_leaving_out(state, &same);
            let mut columns = Vec::new();
            let mut scanned = 0;
            for &index in &same {
                scorer.columns_into(&state.chosen[index].term, &mut columns);
                scanned += state.chosen[index].scanned;
            }
            let total = scorer.linear.residual.len();
            let count = columns.len() / total;
            let gain = models.loose.gain_of(&DMatrix::from_vec(total, count, columns));
            let together = scorer.judged(&models.loose, &Candidate { scanned, ..state.chosen[first].clone() }, gain);
            let scored = self.scored(state, &models.loose);
            let Some(best) = self.best(scorer, &models, &scored) else { continue };
            if best.delta_bic > together.delta_bic {
                let mut chosen: Vec<Candidate> =
                    (0..state.chosen.len()).filter(|k| !same.contains(k)).map(|k| state.chosen[k].clone()).collect();
                chosen.push(best.candidate);
                return Some(self.refitted(chosen, Some(state)));
            }
        }
        None
    }

    /// Drops spurious effects, which only stand in for a structure that no entry describes.
    fn without_spurious(&self, state: &State) -> State {
        let (first, mut state) = (state, state.clone());
        loop {
            if state.chosen.is_empty() {
                break;
            }
            let linear = self.linear(&state);
            let scorer = self.scorer(linear);
            let unexplained = unexplained::examine(self, &scorer);
            if !unexplained.structured {
                break;
            }
            let structure = linear.loose().beside(&[&unexplained.columns], &linear.residual);
            let beside_structure = Whole::new(&structure, &linear.effects, &linear.residual);
            let effects: Vec<usize> = (0..state.chosen.len()).collect();
            let spurious = in_parallel(&effects, |&index| {
                let alone = scorer.own(&self.loosely_without(&state, &[index]), &state.chosen[index]);
                let own = scorer.own(&beside_structure.leaving_out(&state.columns_of(&[index])), &state.chosen[index]);
                let nothing_beside = !self.passes(&own) && alone.gain.drop < SPURIOUS_BESIDE * unexplained.drop;
                (nothing_beside || alone.gain.drop < SPURIOUS * unexplained.drop).then_some((own.delta_bic, index))
            });
            let mut spurious: Vec<(f64, usize)> = spurious.into_iter().flatten().collect();
            if spurious.is_empty() {
                break;
            }
            // The weaker half of them: what is left then may say otherwise of the others.
            spurious.sort_by(|a, b| a.0.total_cmp(&b.0));
            spurious.truncate(spurious.len().div_ceil(2));
            let dropped = |index: usize| spurious.iter().any(|(_, other)| *other == index);
            let kept = state.chosen.iter().enumerate().filter(|(index, _)| !dropped(*index));
            let chosen = kept.map(|(_, candidate)| candidate.clone()).collect();
            state = self.followed(chosen, &state);
        }
        // Other effects, other outliers.
        if state.chosen.len() < first.chosen.len() { self.refitted(state.chosen.clone(), Some(&state)) } else { state }
    }
}

/// How many rows a fit takes for outliers.
fn rejected(fit: &Fit<EffectModel>) -> usize {
    fit.weights.iter().filter(|weight| **weight == 0.0).count()
}

pub(crate) fn same_terms(a: &[Candidate], b: &[Candidate]) -> bool {
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| a.term == b.term)
}

/// Where a search that comes to this state has been here before: in a circle terms come and go, so the state with the fewest, of these the best.
fn in_circle(been: &[(f64, State)], criterion: f64, state: &State) -> Option<State> {
    let here = |(other, known): &(f64, State)| (other - criterion).abs() < SAME && alike(known, state);
    let order =
        |a: &&(f64, State), b: &&(f64, State)| a.1.chosen.len().cmp(&b.1.chosen.len()).then(a.0.total_cmp(&b.0));
    let first = been.iter().position(here)?;
    been[first..].iter().min_by(order).map(|(_, least)| least.clone())
}

/// Whether two states hold the same kinds at the same places.
fn alike(a: &State, b: &State) -> bool {
    let mut left: Vec<(Kind, Carrier)> = b.chosen.iter().map(|one| (one.term.kind, one.term.carrier)).collect();
    let known = a.chosen.iter().all(|one| {
        let place = left.iter().position(|other| *other == (one.term.kind, one.term.carrier));
        place.map(|place| left.swap_remove(place)).is_some()
    });
    known && left.is_empty()
}

/// Steps that act at one place are one effect with several steps.
fn with_steps_joined(chosen: Vec<Candidate>) -> Vec<Candidate> {
    let mut joined: Vec<Candidate> = Vec::with_capacity(chosen.len());
    for candidate in chosen {
        let known = joined.iter_mut().find_map(|other| match (&mut other.term.driver, &candidate.term.driver) {
            (Driver::Steps { at, .. }, Driver::Steps { at: more, .. })
                if other.term.carrier == candidate.term.carrier =>
            {
                at.extend(more);
                at.sort_by(f64::total_cmp);
                at.dedup();
                other.scanned = at.len();
                Some(())
            }
            _ => None,
        });
        if known.is_none() {
            joined.push(candidate);
        }
    }
    joined
}
