//! Steps and smooth drift told apart: a fine curve may hide a few steps and a slow course.

use crate::effects::carrier::Carrier;
use crate::effects::catalogue::{Candidate, Kind};
use crate::effects::driver::Driver;
use crate::effects::model::{Coupling, Term};
use crate::trace::downdate::Reduced;
use crate::trace::select::{LEAST_DELTA_BIC, State, Tracer};
use denavit_model::nalgebra::DMatrix;

/// Pieces of the slow course that are tried under steps; 0: steps alone.
const PIECES: [usize; 4] = [0, 5, 10, 20];
/// While the search goes on, a curve of no more pieces than this is left as it is: it may still stand in for others.
pub(crate) const COARSE: usize = 5;
/// Steps at one place at most.
const MOST_STEPS: usize = 8;
/// Places that a pass looks at before the best is refined.
const PLACES: usize = 150;

impl Tracer<'_> {
    /// The state with its drift along a curve of more than `pieces` pieces written as steps and a coarser course, where
    /// that needs fewer numbers.
    pub(crate) fn separated(&self, state: &State, pieces: usize) -> Option<State> {
        let clock = self.survey.clock.as_ref()?;
        let fine = state.chosen.iter().position(|candidate| match &candidate.term.driver {
            Driver::Smooth { knots, .. } => knots.len() > pieces + 1,
            _ => false,
        })?;
        let carrier = state.chosen[fine].term.carrier;
        let own: Vec<usize> = (0..state.chosen.len())
            .filter(|&index| {
                let term = &state.chosen[index].term;
                index == fine || (term.carrier == carrier && matches!(term.driver, Driver::Steps { .. }))
            })
            .collect();
        let linear = self.linear(state);
        let scorer = self.scorer(linear);
        let (others, residual) = state.parts(linear, &own);
        let projector = linear.loose().beside(&[&others], &residual);
        let together = |terms: &[Candidate]| {
            let mut cells = Vec::new();
            for candidate in terms {
                scorer.columns_into(&candidate.term, &mut cells);
            }
            DMatrix::from_vec(residual.len(), cells.len() / residual.len(), cells)
        };
        let judged = |terms: &[Candidate]| {
            let scanned = terms.iter().map(|candidate| candidate.scanned).sum();
            let gain = projector.gain_of(&together(terms));
            scorer.judged(&Reduced::nothing(&projector), &Candidate { scanned, ..terms[0].clone() }, gain).delta_bic
        };
        let had: Vec<Candidate> = own.iter().map(|&index| state.chosen[index].clone()).collect();
        let mut best = (judged(&had), had);
        for pieces in PIECES {
            let mut terms = Vec::new();
            if pieces > 0 {
                let knots = clock.knots(pieces);
                terms.push(drift(carrier, Driver::Smooth { covariate: clock.column.clone(), knots }, 0));
            }
            let mut places: Vec<f64> = Vec::new();
            while places.len() < MOST_STEPS {
                let with_terms = projector.beside(&[&together(&terms)], &residual);
                let all = clock.all_places();
                let stride = all.len().div_ceil(PLACES).max(1);
                let step = |at: f64| drift(carrier, Driver::Steps { covariate: clock.column.clone(), at: vec![at] }, 1);
                let tried: Vec<Candidate> = all.into_iter().step_by(stride).map(step).collect();
                let scored = scorer.score(&with_terms, &tried);
                let Some(first) = scored.into_iter().max_by(|a, b| a.delta_bic.total_cmp(&b.delta_bic)) else { break };
                let refined = scorer.refined(&Reduced::nothing(&with_terms), &self.survey, &first.candidate);
                let Driver::Steps { at, .. } = &refined.candidate.term.driver else { break };
                if refined.delta_bic < LEAST_DELTA_BIC || places.contains(&at[0]) {
                    break;
                }
                places.push(at[0]);
                places.sort_by(f64::total_cmp);
                terms.truncate(usize::from(pieces > 0));
                let steps = Driver::Steps { covariate: clock.column.clone(), at: places.clone() };
                terms.push(drift(carrier, steps, places.len()));
            }
            if terms.is_empty() {
                continue;
            }
            let found = judged(&terms);
            if found > best.0 {
                best = (found, terms);
            }
        }
        let mut chosen: Vec<Candidate> = (0..state.chosen.len())
            .filter(|index| !own.contains(index))
            .map(|index| state.chosen[index].clone())
            .collect();
        let at = fine.min(chosen.len());
        chosen.splice(at..at, best.1);
        (chosen != state.chosen).then(|| self.refitted(chosen, Some(state)))
    }
}

fn drift(carrier: Carrier, driver: Driver, scanned: usize) -> Candidate {
    Candidate { term: Term { kind: Kind::Drift, carrier, driver, coupling: Coupling::Each }, scanned }
}
