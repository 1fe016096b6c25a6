//! What the search says of each effect: its numbers, how sure it is, and what it cannot be told from.

use crate::effects::carrier::Carrier;
use crate::effects::catalogue::Kind;
use crate::effects::driver::{Driver, unit_of};
use crate::trace::projector::Projector;
use crate::trace::search::{Field, Scored};
use crate::trace::select::{State, Tracer};
use crate::trace::{Finding, ScanCell, Value};

/// Two effects whose criteria differ by less than this cannot be told apart.
const TOLD_APART: f64 = 10.0;
/// Candidates this far behind the best are not worth refining as rivals.
const BEHIND: f64 = 60.0;

impl Tracer<'_> {
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

    pub(crate) fn findings(&self, state: &State) -> Vec<Finding> {
        if state.chosen.is_empty() {
            return Vec::new();
        }
        let linear = self.linear(state);
        let field = self.field(&linear);
        let bare = self.linear(&self.refitted(Vec::new(), None));
        let mut column = state.fit.layout.effects.start;
        let mut findings = Vec::new();
        for (index, candidate) in state.chosen.iter().enumerate() {
            let rest = state.without(&linear, &[index]);
            let own = field.own(&rest.loose, candidate);
            let count = state.fit.effects.effects[index].coefficients.len();
            findings.push(Finding {
                term: candidate.term.clone(),
                place: candidate.term.carrier.place(&self.statics.chain),
                values: self.values(state, index, column),
                p_value: self.corrected(own.p_value),
                delta_bic: own.delta_bic,
                ambiguous_with: self.rivals(&field, &rest.loose, &own, self.as_good_when_fitted(state, index)),
                portrait: self.portrait(&field, &bare, state, index),
            });
            column += count;
        }
        findings
    }

    /// Kinds and places that do as well as an effect in its place.
    ///
    /// `fitted`: those that were fitted in its place and do as well.
    fn rivals(
        &self,
        field: &Field<'_>,
        projector: &Projector,
        own: &Scored,
        fitted: Vec<(Kind, String)>,
    ) -> Vec<(Kind, String)> {
        let chain = &self.statics.chain;
        let key = |scored: &Scored| (scored.candidate.term.kind, scored.candidate.term.carrier.place(chain));
        let mut best: Vec<Scored> = Vec::new();
        for scored in field.score(projector, &self.candidates) {
            if scored.gain.rank == 0 || key(&scored) == key(own) || scored.delta_bic < own.delta_bic - BEHIND {
                continue;
            }
            match best.iter_mut().find(|other| key(other) == key(&scored)) {
                Some(other) if other.delta_bic >= scored.delta_bic => {}
                Some(other) => *other = scored,
                None => best.push(scored),
            }
        }
        let mut rivals: Vec<Scored> = best
            .into_iter()
            .map(|scored| field.refined(projector, &self.survey, &scored.candidate))
            .filter(|scored| scored.delta_bic > own.delta_bic - TOLD_APART)
            .collect();
        rivals.sort_by(|a, b| b.delta_bic.total_cmp(&a.delta_bic));
        let mut rivals: Vec<(Kind, String)> = rivals.iter().map(key).collect();
        rivals.extend(fitted);
        // One distance sees the same whether the anchor moves or the base against it.
        if own.candidate.term.carrier == Carrier::Anchor {
            rivals.push((own.candidate.term.kind, Carrier::Base.place(chain)));
        }
        let mut listed = Vec::new();
        rivals.retain(|rival| {
            let new = *rival != key(own) && !listed.contains(rival);
            listed.push(rival.clone());
            new
        });
        rivals
    }

    fn values(&self, state: &State, index: usize, first: usize) -> Vec<Value> {
        let effect = &state.fit.effects.effects[index];
        let mut values: Vec<Value> = effect
            .coefficients
            .iter()
            .enumerate()
            .map(|(k, value)| {
                let (name, carrier, driver) = effect.term.coefficient_name(self.statics, k);
                let variance = state.fit.covariance[(first + k, first + k)];
                let unit = if driver == "1" { carrier.to_string() } else { format!("{carrier}/({driver})") };
                Value { name, value: *value, std: Some(variance.max(0.0).sqrt()), unit }
            })
            .collect();
        let chosen =
            |name: &str, value: f64, unit: &str| Value { name: name.into(), value, std: None, unit: unit.into() };
        match &effect.term.driver {
            Driver::Harmonic { order, .. } => values.push(chosen("order", *order, "1")),
            Driver::Bump { joint, at, width, .. } => {
                let unit = Driver::Reading(*joint).unit(&self.statics.chain);
                values.extend([chosen("at", *at, unit), chosen("width", *width, unit)]);
            }
            Driver::Decay { constant, covariate, .. } => {
                values.push(chosen("time_constant", *constant, unit_of(covariate)));
            }
            Driver::Steps { at, covariate } => {
                let unit = unit_of(covariate);
                values.extend(at.iter().enumerate().map(|(k, at)| chosen(&format!("at_{}", k + 1), *at, unit)));
            }
            _ => {}
        }
        values
    }
}
