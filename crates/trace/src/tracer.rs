//! The tracer and its state: the data, the candidates and the model with the effects chosen so far.

use crate::blocks::{self, Block};
use crate::downdate::Reduced;
use crate::linear::{Linear, linearise};
use crate::scorer::{CandidateScorer, Linearised, Scored, carriers_of, driven};
use crate::{ScanCell, TraceOptions};
use denavit_identify::arm::Arm;
use denavit_identify::effects::candidates::{Candidate, candidates};
use denavit_identify::effects::carrier::Carrier;
use denavit_identify::effects::catalogue::{KINDS, Kind};
use denavit_identify::effects::driver::{Driver, Statics};
use denavit_identify::effects::model::EffectModel;
use denavit_identify::effects::survey::Survey;
use denavit_identify::fit_stage;
use denavit_identify::parameters::NoEffects;
use denavit_identify::solve::{Fit, FitOptions};
use denavit_linear::threads::get_or_make;
use denavit_measurements::Measurements;
use std::sync::{Arc, OnceLock};

/// χ² that the last step of a fit may promise: far less than what an effect must gain.
const PROMISE_AT_END: f64 = 1e-2;

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
    /// Blocks of functions for unexplained structure.
    blocks: OnceLock<Vec<Block>>,
    carriers: Vec<Carrier>,
}

/// The model at one point of the search.
#[derive(Clone)]
pub struct State {
    pub(crate) chosen: Vec<Candidate>,
    pub(crate) fit: Fit<EffectModel>,
    /// Results that were computed there.
    at: Arc<OnceLock<Linearised>>,
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
            KINDS.iter().filter(|entry| wanted(entry.kind)).flat_map(|entry| candidates(entry.kind, &survey)).collect();
        let mut carriers = carriers_of(candidates.iter().map(|candidate| &candidate.term));
        for carrier in blocks::carriers(&survey) {
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

    /// The same on some of the rows, with the candidates that all rows allow.
    pub(crate) fn on<'b>(&'b self, data: &'b Measurements, geometric: &'b Fit<NoEffects>) -> Tracer<'b> {
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

    /// Functions of one or two variables that represent unexplained structure.
    pub(crate) fn blocks(&self) -> &[Block] {
        self.blocks.get_or_init(|| blocks::blocks(&self.survey, self.data))
    }

    /// Refits with these terms and refines their scanned numbers at the new state.
    pub(crate) fn refitted(&self, chosen: Vec<Candidate>, start: Option<&State>) -> State {
        let arm = start.map_or(&self.geometric.arm, |state| &state.fit.arm);
        self.fitted(chosen, arm, &vec![1.0; self.data.observations()], self.options.identify.fit.robust)
    }

    pub(crate) fn fitted(&self, chosen: Vec<Candidate>, arm: &Arm, weights: &[f64], robust: bool) -> State {
        let mut options = self.options.identify.clone();
        options.fit = FitOptions { robust, least_promise: PROMISE_AT_END, ..options.fit };
        let chosen = with_steps_joined(chosen);
        let terms: Vec<_> = chosen.iter().map(|candidate| candidate.term.clone()).collect();
        let model = EffectModel::of_terms(self.statics, self.options.earlier.as_ref(), &terms);
        let fit = fit_stage(self.data, arm, &model, weights, &options);
        State::new(chosen, fit)
    }

    /// The model linearised at a state.
    pub(crate) fn linear<'b>(&self, state: &'b State) -> &'b Linear {
        &self.linearised(state).linear
    }

    pub(crate) fn linearised<'b>(&self, state: &'b State) -> &'b Linearised {
        let linear = || linearise(self.data, &state.fit, &self.geometric.arm, &self.carriers);
        get_or_make(&state.at, || Linearised::new(linear()))
    }

    /// Loose geometry and all effects of a state except these indices, and the residual of that model: what the search for scanned numbers
    /// needs.
    pub(crate) fn loosely_without<'b>(&self, state: &'b State, left_out: &[usize]) -> Reduced<'b> {
        self.linearised(state).loose().leaving_out(&state.columns_of(left_out))
    }

    pub(crate) fn scorer<'b>(&'b self, linear: &'b Linear) -> CandidateScorer<'b> {
        CandidateScorer { data: self.data, statics: self.statics, linear }
    }

    /// Every candidate against geometry alone.
    pub(crate) fn first_pass(&self) -> Vec<ScanCell> {
        let state = self.refitted(Vec::new(), None);
        self.scan(&self.scored(&state, &self.linearised(&state).loose().leaving_out(&[])))
    }

    /// Scores every candidate of the catalogue, in its order, against loose geometry and all or some of a state's effects.
    pub(crate) fn scored(&self, state: &State, model: &Reduced<'_>) -> Vec<Scored> {
        let at = self.linearised(state);
        self.scorer(&at.linear).scored(at, model, &self.candidates, self.driven())
    }

    /// The best candidate of each kind at each place.
    pub(crate) fn scan(&self, scored: &[Scored]) -> Vec<ScanCell> {
        let mut cells: Vec<ScanCell> = Vec::new();
        for scored in scored {
            let kind = scored.candidate.term.kind;
            let place = scored.candidate.term.carrier.place(&self.statics.chain);
            match cells.iter_mut().find(|cell| cell.kind == kind && cell.place == place) {
                Some(cell) => cell.delta_bic = cell.delta_bic.max(scored.delta_bic),
                None => cells.push(ScanCell { kind, place, delta_bic: scored.delta_bic }),
            }
        }
        cells
    }
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
