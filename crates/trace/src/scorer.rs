//! One pass that scores every candidate at one state of the model.

use crate::by_carrier::{ByCarrier, ByRow, Driven, alike};
use crate::downdate::{Reduced, Whole};
use crate::linear::Linear;
use crate::projector::{Gain, Products, Projector, UNSEEN};
use denavit_identify::arm::Row;
use denavit_identify::effects::candidates::Candidate;
use denavit_identify::effects::carrier::Carrier;
use denavit_identify::effects::catalogue::Kind;
use denavit_identify::effects::driver::{Conditions, Posture, Statics};
use denavit_identify::effects::model::{Coupling, Term};
use denavit_linear::threads::{get_or_make, in_parallel};
use denavit_measurements::Measurements;
use denavit_model::nalgebra::DMatrix;
use statrs::distribution::{ContinuousCDF, FisherSnedecor};
use std::borrow::Cow;
use std::sync::OnceLock;

/// Candidates whose columns are projected together.
const BATCH: usize = 16;

/// A candidate's result.
#[derive(Debug, Clone, PartialEq)]
pub struct Scored {
    /// Which one.
    pub candidate: Candidate,
    /// What it explains.
    pub gain: Gain,
    /// Decrease of the Bayesian information criterion when it is added: positive favours it.
    pub delta_bic: f64,
    /// Degrees of freedom and sum of squares before, and the numbers that it uses.
    free: f64,
    rss: f64,
    used: usize,
}

impl Scored {
    /// The decrease of the criterion, less the handicap of its kind.
    pub fn worth(&self) -> f64 {
        self.delta_bic - handicap(self.candidate.term.kind)
    }

    /// Probability of such a gain by chance, this candidate alone.
    pub fn p_value(&self) -> f64 {
        p_value(self.free, self.rss, self.gain, self.used)
    }
}

/// Scores candidates against the model linearised at a state.
#[derive(Debug, Clone, Copy)]
pub struct CandidateScorer<'a> {
    /// Data.
    pub data: &'a Measurements,
    /// The chain and its masses.
    pub statics: &'a Statics,
    /// The model at its state.
    pub linear: &'a Linear,
}

/// A model linearised at a state, with the products of each candidate there; computed once and reused.
#[derive(Debug)]
pub(crate) struct Linearised {
    pub(crate) linear: Linear,
    /// Loose geometry and all effects.
    loose: OnceLock<Whole>,
    /// With the candidate that each block is of.
    products: OnceLock<(Products, Vec<usize>)>,
}

impl Linearised {
    pub(crate) fn new(linear: Linear) -> Self {
        Self { linear, loose: OnceLock::new(), products: OnceLock::new() }
    }

    /// Geometry far beyond its tolerances, and all effects.
    pub(crate) fn loose(&self) -> &Whole {
        let Linear { residual, effects, .. } = &self.linear;
        get_or_make(&self.loose, || Whole::new(self.linear.loose(), effects, residual))
    }
}

/// Driver values of each candidate, row by row; empty if they depend on the posture.
pub(crate) fn driven(data: &Measurements, statics: &Statics, candidates: &[Candidate]) -> Vec<Vec<f64>> {
    let nowhere = Posture::default();
    let of = |candidate: &Candidate| {
        let driver = &candidate.term.driver;
        let mut values = Vec::with_capacity(if driver.needs_posture() { 0 } else { data.len() * driver.len(statics) });
        for index in (0..data.len()).filter(|_| !driver.needs_posture()) {
            driver.values_into(statics, &Conditions::of(Row::new(data, index)), &nowhere, &mut values);
        }
        values
    };
    in_parallel(candidates, of)
}

impl CandidateScorer<'_> {
    /// Scores every candidate, in the given order, against loose geometry and all or some of a state's effects.
    pub(crate) fn scored(
        &self,
        at: &Linearised,
        model: &Reduced<'_>,
        candidates: &[Candidate],
        driven: &[Vec<f64>],
    ) -> Vec<Scored> {
        let all = || self.products(&at.loose().projector, candidates, driven);
        let (products, order) = get_or_make(&at.products, all);
        self.all_judged(model, candidates, model.gains(products, UNSEEN), order)
    }

    /// The term's columns in units of the noise, appended to `out`; returns how many.
    pub fn columns_into(&self, term: &Term, out: &mut Vec<f64>) -> usize {
        let values = self.driver_values(term);
        let Some(carrier) = self.linear.columns_of(term.carrier) else { return 0 };
        let count = term.driver.len(self.statics);
        let total = self.linear.residual.len();
        let pairs: Vec<Vec<(usize, usize)>> = match term.coupling {
            Coupling::Paired => vec![(0..carrier.len().min(count)).map(|k| (k, k)).collect()],
            Coupling::Each => (0..carrier.len()).flat_map(|d| (0..count).map(move |v| vec![(d, v)])).collect(),
        };
        for pair in &pairs {
            let start = out.len();
            out.resize(start + total, 0.0);
            for &(direction, value) in pair {
                let carrier = self.linear.carriers.column(carrier.start + direction);
                for ((cell, row), unit) in out[start..].iter_mut().zip(&self.linear.rows).zip(carrier.iter()) {
                    *cell += unit * values[row * count + value];
                }
            }
        }
        pairs.len()
    }

    /// The term's columns as a matrix.
    pub fn columns(&self, term: &Term) -> DMatrix<f64> {
        let mut cells = Vec::new();
        let count = self.columns_into(term, &mut cells);
        DMatrix::from_vec(self.linear.residual.len(), count, cells)
    }

    /// Values of the term's driver, row by row.
    pub fn driver_values(&self, term: &Term) -> Vec<f64> {
        let mut values = Vec::with_capacity(self.data.len() * term.driver.len(self.statics));
        for (index, posture) in self.linear.postures(self.data).iter().enumerate() {
            let row = Row::new(self.data, index);
            let conditions = Conditions::of(row);
            term.driver.values_into(self.statics, &conditions, posture, &mut values);
        }
        values
    }

    /// Every candidate with its gain, where these are in another order.
    fn all_judged(
        &self,
        model: &Reduced<'_>,
        candidates: &[Candidate],
        gains: Vec<Gain>,
        order: &[usize],
    ) -> Vec<Scored> {
        let mut in_order = vec![Gain { drop: 0.0, rank: 0 }; candidates.len()];
        order.iter().zip(gains).for_each(|(&index, gain)| in_order[index] = gain);
        candidates.iter().zip(in_order).map(|(candidate, gain)| self.judged(model, candidate, gain)).collect()
    }

    /// Products of the candidates' columns with a model, and the candidate of each block; `driven`: driver values row by row, as far as they
    /// are known.
    fn products(&self, model: &Projector, candidates: &[Candidate], driven: &[Vec<f64>]) -> (Products, Vec<usize>) {
        let alike = alike(candidates.iter().map(|candidate| candidate.term.carrier));
        let by_row = ByRow::new(self.linear, model);
        let known = |index: usize| match driven.get(index).map_or(&[][..], Vec::as_slice) {
            [] => Cow::Owned(self.driver_values(&candidates[index].term)),
            values => Cow::Borrowed(values),
        };
        let of_batch = |at: &ByCarrier<'_>, batch: &[usize]| {
            let values: Vec<Cow<'_, [f64]>> = batch.iter().map(|&index| known(index)).collect();
            let terms = batch.iter().zip(&values).map(|(&index, values)| Driven {
                coupling: candidates[index].term.coupling,
                per_row: candidates[index].term.driver.len(self.statics),
                values,
            });
            at.products(&terms.collect::<Vec<_>>())
        };
        let products = in_parallel(&alike, |(carrier, own)| {
            let at = by_row.with(*carrier);
            Products::joined(own.chunks(BATCH).map(|batch| of_batch(&at, batch)))
        });
        (Products::joined(products), alike.into_iter().flat_map(|(_, own)| own).collect())
    }

    /// What a term explains beyond a model or a part of it; the carrier's products are with the whole model.
    pub(crate) fn gain_at(&self, carrier: &ByCarrier<'_>, model: &Reduced<'_>, term: &Term) -> Gain {
        let values = self.driver_values(term);
        let driven = Driven { coupling: term.coupling, per_row: term.driver.len(self.statics), values: &values };
        model.gains(&carrier.products(&[driven]), UNSEEN)[0]
    }

    /// What an effect of the model explains when it is added back.
    pub fn own(&self, model: &Reduced<'_>, candidate: &Candidate) -> Scored {
        self.judged(model, candidate, model.gain_of(&self.columns(&candidate.term)))
    }

    /// Scores a gain: information criterion and F-test.
    pub fn judged(&self, model: &Reduced<'_>, candidate: &Candidate, gain: Gain) -> Scored {
        let used = gain.rank + candidate.scanned;
        let values = self.linear.values() as f64;
        let (free, rss) = ((self.linear.residual.len() - model.rank()) as f64, model.rss());
        Scored { candidate: candidate.clone(), gain, delta_bic: delta_bic(values, rss, gain, used), free, rss, used }
    }
}

/// Handicap of a kind against a similar one: odds of twelve to one for the more frequent cause.
///
/// A joint is softer than a link or a bearing; a slide's scale is wrong more often than an instrument's; a target is moved on the tip more
/// often than a range is wrong.
pub(crate) fn handicap(kind: Kind) -> f64 {
    match kind {
        Kind::LinkCompliance | Kind::InstrumentScale | Kind::TargetIncidence => 5.0,
        _ => 0.0,
    }
}

/// Decrease of the information criterion: m ln(RSS before/after) - k ln m.
fn delta_bic(values: f64, rss: f64, gain: Gain, used: usize) -> f64 {
    if gain.rank == 0 {
        return f64::NEG_INFINITY;
    }
    let after = (rss - gain.drop).max(f64::MIN_POSITIVE);
    values * (rss / after).ln() - used as f64 * values.ln()
}

/// F-test of a gain with `used` parameters and `free` degrees of freedom before.
pub fn p_value(free: f64, rss: f64, gain: Gain, used: usize) -> f64 {
    let left = free - used as f64;
    if gain.rank == 0 || left < 1.0 {
        return 1.0;
    }
    let after = (rss - gain.drop).max(f64::MIN_POSITIVE);
    let f = (gain.drop / used as f64) / (after / left);
    FisherSnedecor::new(used as f64, left).map_or(1.0, |distribution| distribution.sf(f))
}

/// The best candidates, up to a number: the best one of each kind at each place, except the kind and place of `but`.
pub(crate) fn leaders<'s>(scored: &'s [Scored], most: usize, but: Option<&Candidate>) -> Vec<&'s Candidate> {
    let key = |candidate: &Candidate| (candidate.term.kind, candidate.term.carrier);
    let mut order: Vec<&Scored> = scored.iter().filter(|scored| scored.gain.rank > 0).collect();
    order.sort_by(|a, b| b.delta_bic.total_cmp(&a.delta_bic));
    let mut seen: Vec<(Kind, Carrier)> = but.map(key).into_iter().collect();
    let mut leaders: Vec<&Candidate> = Vec::new();
    for Scored { candidate, .. } in order {
        if leaders.len() < most && !seen.contains(&key(candidate)) {
            seen.push(key(candidate));
            leaders.push(candidate);
        }
    }
    leaders
}

/// The carriers that these candidates use, each once.
pub fn carriers_of<'a>(terms: impl Iterator<Item = &'a Term>) -> Vec<Carrier> {
    let mut carriers: Vec<Carrier> = Vec::new();
    for term in terms {
        if !carriers.contains(&term.carrier) {
            carriers.push(term.carrier);
        }
    }
    carriers
}
