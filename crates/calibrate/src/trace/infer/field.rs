//! A smooth function of two joints' readings beside geometry, effects and curves: a correction without a cause.
//!
//! Where a model leaves structure that hangs on two joints ([`crate::trace::unexplained`]), it may become a field of the model: an error of
//! one joint that is a sum of products of waves of two readings ([`crate::effects::field`]), as large as the marginal likelihood has it.
//! It has to pay: more by that likelihood than chance among all places would give it, and on rows that it was not fitted to, both
//! when stretches of the run are left out and when rows between the others are.

use crate::effects::carrier::Carrier;
use crate::effects::catalogue::Kind;
use crate::effects::driver::Driver;
use crate::effects::field::{Products, ShapedReading, Shapes};
use crate::effects::model::{Coupling, EffectModel, Term};
use crate::effects::survey::Survey;
use crate::identify::solve::Fit;
use crate::identify::threads::{each_alone, in_parallel};
use crate::observation::arm::Arm;
use crate::observation::measurements::Measurements;
use crate::trace::infer::curves::{CurveOptions, Round, State, borrowed, by_part, in_stretches};
use crate::trace::infer::deflection::{columns, nothing, under, with_terms};
use crate::trace::infer::evidence::Model;
use crate::trace::infer::gram::{Columns, Gram};
use crate::trace::infer::model::{Hyperparameters, LARGEST};
use denavit_model::nalgebra::DMatrix;
use std::cell::Cell;

/// Parts that are left out one after the other.
const PARTS: usize = 5;
/// The held-out error must fall by so many standard errors.
const BEYOND_CHANCE: f64 = 1.0;
/// The first step of a logarithm that is searched for, and the last.
const STEPS: (f64, f64) = (0.8, 0.1);
/// Where no step leads uphill the next is this much shorter.
const SHORTER: f64 = 0.4;
/// A score that rises by less does not rise.
const NEGLIGIBLE: f64 = 0.01;
/// The noise is not followed farther down than this, logarithm of its variance: rows without noise tell no size.
const LEAST_NOISE: f64 = -20.0;

/// Where a field may act: an error of a joint, as a function of two joints' readings.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Place {
    /// The joint that errs.
    pub joint: usize,
    /// Those whose readings it hangs on.
    pub of: [usize; 2],
}

/// The model on the rows that judge.
#[derive(Clone, Copy)]
pub(crate) struct Beside<'a> {
    /// Of all rows: a field spans what was measured.
    pub survey: &'a Survey,
    /// The rows.
    pub data: &'a Measurements,
    /// The model as it is, on these rows.
    pub fit: &'a Fit<EffectModel>,
    /// The arm that the geometric fit started from.
    pub reference: &'a Arm,
    /// How curves are sought: a field is as sure as a curve.
    pub options: CurveOptions,
}

/// One field beside the model.
struct Trial<'a> {
    beside: Beside<'a>,
    products: Products,
    joint: usize,
    round: Round,
    state: State,
    hyper: Hyperparameters,
}

/// A logarithm of the noise's variance under a prior, and the score there.
struct Scored {
    prior: (DMatrix<f64>, f64),
    log_noise: f64,
    score: f64,
}

impl Beside<'_> {
    /// The field at one of these places that pays.
    pub(crate) fn paying(&self, places: &[Place]) -> Option<Term> {
        let moving = self.survey.moving().count();
        let tests = moving * moving * moving.saturating_sub(1) / 2;
        let least = (tests as f64 / self.options.false_curves).ln();
        let tried = in_parallel(places, |place| {
            let trial = Trial::new(*self, *place);
            let without = trial.without()?;
            let (size, with) = trial.best()?;
            Some((with.score - without.score, size, with, without, trial))
        });
        let (gain, size, with, without, trial) = tried.into_iter().flatten().max_by(|a, b| a.0.total_cmp(&b.0))?;
        (gain > least && trial.pays(&with, &without)).then(|| trial.term(size))
    }

    fn products(&self, of: [usize; 2]) -> Products {
        let chain = &self.survey.statics.chain;
        let shapes = |joint: usize| {
            let (low, high) = self.survey.ranges[joint];
            let continuous = chain.coordinates()[chain.joints()[joint].coordinate].continuous;
            if continuous && high - low > std::f64::consts::TAU { Shapes::Turns } else { Shapes::Range { low, high } }
        };
        Products { of: of.map(|joint| ShapedReading { joint, shapes: shapes(joint) }), size: 1.0 }
    }
}

fn term(joint: usize, products: Products) -> Term {
    Term {
        kind: Kind::JointField,
        carrier: Carrier::Joint(joint),
        driver: Driver::Products(products),
        coupling: Coupling::Each,
    }
}

impl<'a> Trial<'a> {
    fn new(beside: Beside<'a>, place: Place) -> Self {
        let products = beside.products(place.of);
        let fit = with_terms(beside.fit, [term(place.joint, products)].into_iter());
        let state = State::of_curves(beside.survey, beside.data, &fit);
        let round = Round::new(beside.data, &state, beside.reference);
        let hyper = state.hyperparameters();
        Self { beside, products, joint: place.joint, round, state, hyper }
    }

    fn term(&self, size: f64) -> Term {
        term(self.joint, Products { size, ..self.products })
    }

    fn columns(&self) -> std::ops::Range<usize> {
        columns(self.round.always, &self.state.fit.effects, 0).pop().expect("the field is one of the effects")
    }

    fn without(&self) -> Option<Scored> {
        self.scored(nothing(&self.round.model(), self.columns()), (0.0, STEPS.0))
    }

    /// The size that suits the rows best.
    fn best(&self) -> Option<(f64, Scored)> {
        let columns = &self.round.plain[self.columns()];
        let square: f64 = columns.iter().flatten().map(|x| x * x).sum();
        // As large as the noise.
        let seen = (self.round.linear.values() as f64 / square.max(f64::MIN_POSITIVE)).sqrt();
        // The noise that suits one size is near that which suits the last.
        let near = Cell::new((0.0, STEPS.0));
        let at = |log_size: f64| {
            let scored = self.scored(self.of_size(log_size.exp()), near.get())?;
            near.set((scored.log_noise, STEPS.0 * SHORTER));
            Some(scored)
        };
        let first = seen.min(LARGEST).ln();
        let (log_size, scored) =
            uphill((first, STEPS.0), |log_size| at(log_size.min(LARGEST.ln())), |scored| scored.score)?;
        Some((log_size.min(LARGEST.ln()).exp(), scored))
    }

    /// The prior under which the field's numbers are expected to be of this size.
    fn of_size(&self, size: f64) -> (DMatrix<f64>, f64) {
        let (mut precision, mut log_precision) = (self.round.precision.clone(), self.round.model().log_precision);
        for column in self.columns() {
            log_precision -= precision[(column, column)].ln() + 2.0 * size.ln();
            precision[(column, column)] = size.powi(-2);
        }
        (precision, log_precision)
    }

    fn at_noise(&self, log_noise: f64) -> Hyperparameters {
        Hyperparameters { log_noise, ..self.hyper.clone() }
    }

    /// The score under a prior at the noise that suits it best, sought from a place on with a first step.
    fn scored(&self, prior: (DMatrix<f64>, f64), (start, step): (f64, f64)) -> Option<Scored> {
        let model = self.round.model();
        let model = under(&model, &prior);
        let at = |log_noise: f64| {
            let followed = log_noise > LEAST_NOISE;
            followed.then(|| model.score(&self.at_noise(log_noise))).flatten()
        };
        let (log_noise, score) = uphill((start, step), at, |score| *score)?;
        Some(Scored { prior, log_noise, score })
    }

    /// Whether rows that it was not fitted to become better, however they are left out.
    fn pays(&self, with: &Scored, without: &Scored) -> bool {
        let rows = self.beside.data.len();
        // What repeats a posture is left out with it.
        let mut stands: Vec<usize> = (0..rows).collect();
        for group in &self.state.groups {
            for &row in group {
                stands[row] = group[0];
            }
        }
        let stretches = in_stretches(rows, PARTS);
        let deals: [&(dyn Fn(usize) -> usize + Sync); 2] = [&|row| stretches(stands[row]), &|row| stands[row] % PARTS];
        deals.into_iter().all(|part_of| {
            let parts = self.parts(part_of);
            let squares = |scored: &Scored| self.held_out(&parts, part_of, scored, &stands);
            let (Some(with), Some(without)) = (squares(with), squares(without)) else { return false };
            let falls: Vec<f64> = without.iter().zip(&with).map(|(a, b)| a - b).filter(|fall| *fall != 0.0).collect();
            beyond_chance(&falls)
        })
    }

    fn parts(&self, part_of: &(dyn Fn(usize) -> usize + Sync)) -> Vec<Gram> {
        let Round { explained, plain, joints, linear, .. } = &self.round;
        let columns = Columns {
            explained,
            plain: &borrowed(plain),
            joints: &borrowed(joints),
            rows: &linear.rows,
            weights: &linear.weights,
        };
        by_part(&columns, &self.state.waves, &self.state.readings, PARTS, part_of)
    }

    /// Squares of what is left of each posture, in units of the noise, by a model of the other parts.
    fn held_out(
        &self,
        parts: &[Gram],
        part_of: &(dyn Fn(usize) -> usize + Sync),
        scored: &Scored,
        stands: &[usize],
    ) -> Option<Vec<f64>> {
        let hyper = self.at_noise(scored.log_noise);
        let numbers: Vec<usize> = (0..parts.len()).collect();
        let left = each_alone(&numbers, |&part| {
            let gram = Gram::of_others(parts, part);
            let model = self.round.model();
            let model = Model { gram: &gram, ..under(&model, &scored.prior) };
            let mean = model.system(&hyper).0.solved()?.mean();
            Some(self.left(&mean, part_of, part))
        });
        let mut squares = vec![0.0; stands.len()];
        for left in left {
            for (row, left) in left? {
                squares[stands[row]] += left * left;
            }
        }
        Some(squares)
    }

    /// What these numbers leave of each value of a part, with its row.
    fn left(&self, mean: &[f64], part_of: &dyn Fn(usize) -> usize, part: usize) -> Vec<(usize, f64)> {
        let (of_plain, mut rest) = mean.split_at(self.round.plain.len());
        let mut curves = Vec::new();
        for (waves, readings) in self.state.waves.iter().zip(&self.state.readings) {
            let (own, others) = rest.split_at(waves.len());
            let at = |reading: &f64| waves.values(*reading).iter().zip(own).map(|(wave, weight)| wave * weight).sum();
            curves.push(readings.iter().map(at).collect::<Vec<f64>>());
            rest = others;
        }
        let rows = self.round.linear.rows.iter().enumerate().filter(|(_, row)| part_of(**row) == part);
        rows.map(|(value, &row)| {
            let plain: f64 = self.round.plain.iter().zip(of_plain).map(|(column, mean)| column[value] * mean).sum();
            let curves: f64 = self.round.joints.iter().zip(&curves).map(|(column, at)| column[value] * at[row]).sum();
            (row, self.round.explained[value] - plain - curves)
        })
        .collect()
    }
}

/// Whether the mean of these is above 0 by more than chance.
pub(super) fn beyond_chance(falls: &[f64]) -> bool {
    let count = falls.len() as f64;
    let mean = falls.iter().sum::<f64>() / count;
    let variance = falls.iter().map(|fall| (fall - mean).powi(2)).sum::<f64>() / (count - 1.0);
    falls.len() > 1 && mean > BEYOND_CHANCE * (variance / count).sqrt()
}

/// The place where a score is largest, up to the last of [`STEPS`], and what is there.
fn uphill<T>((start, first): (f64, f64), at: impl Fn(f64) -> Option<T>, score: impl Fn(&T) -> f64) -> Option<(f64, T)> {
    let (mut place, mut here, mut step) = (start, at(start)?, first);
    let rises = |here: &T, next: &T| score(next) > score(here) + NEGLIGIBLE;
    while step > STEPS.1 {
        let tried = [step, -step].into_iter().find_map(|by| {
            let next = at(place + by)?;
            rises(&here, &next).then_some((by, next))
        });
        match tried {
            Some((by, next)) => {
                (place, here) = (place + by, next);
                step = by.abs();
                // On in the same direction as long as it rises.
                while let Some(next) = at(place + by).filter(|next| rises(&here, next)) {
                    (place, here) = (place + by, next);
                }
            }
            None => step *= SHORTER,
        }
    }
    Some((place, here))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_top_of_a_hill_is_found_and_what_is_no_number_is_none() {
        let (place, score) =
            uphill((0.0, STEPS.0), |x| (x > -5.0).then_some(-(x - 3.3).powi(2)), |score| *score).unwrap();
        assert!((place - 3.3).abs() < STEPS.1 && score > -0.01);
        assert!(uphill((0.0, STEPS.0), |_| None::<f64>, |score| *score).is_none());
    }

    #[test]
    fn a_fall_counts_beyond_its_standard_error() {
        assert!(beyond_chance(&[1.0, 2.0, 1.5, 0.5]) && !beyond_chance(&[1.0, -2.0, 1.5, 0.5]) && !beyond_chance(&[]));
    }
}
