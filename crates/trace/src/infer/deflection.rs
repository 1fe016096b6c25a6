//! Deflections of joints under gravity, fitted together with error curves.
//!
//! A joint's torque is a smooth function of all readings, and mostly of its own: a curve alone absorbs it, and is wrong at other
//! readings of the other joints than in the rows. So a deflection of every joint, with unknown masses, is fitted together with the
//! curves; the marginal likelihood selects the joints that have one.

use crate::infer::evidence::Model;
use crate::infer::maximum::{self, ROUGH};
use crate::infer::model::Hyperparameters;
use crate::linear::postures;
use denavit_identify::arm::Row;
use denavit_identify::effects::carrier::Carrier;
use denavit_identify::effects::catalogue::Kind;
use denavit_identify::effects::driver::{Conditions, Driver};
use denavit_identify::effects::model::{Coupling, Effect, EffectModel, Term};
use denavit_identify::effects::survey::Survey;
use denavit_identify::parameters::Effects as _;
use denavit_identify::solve::Fit;
use denavit_linear::threads::each_alone;
use denavit_measurements::Measurements;
use denavit_model::nalgebra::DMatrix;
use std::ops::Range;

/// Smallest number of measured values per parameter of the model with deflections of all joints.
const VALUES_PER_NUMBER: usize = 8;
/// Prior standard deviation of the deflection by each part of a joint's torque, with gravity perpendicular to its axis, rad. It keeps
/// parts that the rows hardly distinguish from growing against each other, and those of a joint whose axis is nearly vertical in all rows.
const EXPECTED: f64 = 1e-3;
/// Number of the weakest joints that are compared exactly before one is removed.
const WEAKEST: usize = 2;
/// If blocks raise the score by this multiple of the threshold, a new choice of hyperparameters cannot replace them.
const FAR: f64 = 10.0;
/// A prior with this multiple of the precision makes a parameter 0.
const NOTHING: f64 = 1e12;

/// The fit with a deflection, 0 at first, of every joint that has no compliance in the model; `None` if there are too few values.
pub(super) fn all(survey: &Survey, fit: &Fit<EffectModel>) -> Option<Fit<EffectModel>> {
    let compliant = |joint: usize| {
        fit.effects
            .effects
            .iter()
            .any(|effect| effect.term.kind == Kind::JointCompliance && effect.term.carrier == Carrier::Joint(joint))
    };
    let term = |joint: usize| Term {
        kind: Kind::JointCompliance,
        carrier: Carrier::Joint(joint),
        driver: Driver::TorqueTerms { joint, links: survey.statics.chain.joints().len() - joint },
        coupling: Coupling::Each,
    };
    let joints = survey.turning().filter(|&joint| survey.statics.feels_gravity(joint) && !compliant(joint));
    let with = with_terms(fit, joints.map(term));
    let values: f64 = fit.values.iter().sum();
    let enough = values >= (VALUES_PER_NUMBER * with.layout.len()) as f64;
    (enough && with.effects.effects.len() > fit.effects.effects.len()).then_some(with)
}

/// The same fit with more terms, all their numbers 0.
pub(crate) fn with_terms(fit: &Fit<EffectModel>, terms: impl Iterator<Item = Term>) -> Fit<EffectModel> {
    let mut with = fit.clone();
    for term in terms {
        let coefficients = vec![0.0; term.coefficients(&fit.effects.statics)];
        with.effects.effects.push(Effect { term, coefficients });
    }
    with.layout = fit.layout.with_effects(with.effects.parameters());
    with
}

/// Prior of an effect's coefficient.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Expected {
    /// The precision of one average measured value (unit information), but at least this.
    UnitInformation(f64),
    /// Unit information, or the present size if that is larger: a cause may be far stronger than what one value shows of it (the g of
    /// Zellner's prior by empirical Bayes; George, Foster 2000).
    OrAsNow(f64),
}

/// Priors of all effects' coefficients: first those of the causes, then those of the deflections.
pub(super) fn expected(model: &EffectModel, causes: usize) -> Vec<Expected> {
    let of_gravity = (model.statics.masses.gravity.norm() / EXPECTED).powi(2);
    let (causes, deflections) = model.effects.split_at(causes);
    let of_causes = causes.iter().flat_map(|effect| &effect.coefficients).map(|now| Expected::OrAsNow(*now));
    let of_deflections = deflections.iter().flat_map(|effect| &effect.coefficients);
    of_causes.chain(of_deflections.map(|_| Expected::UnitInformation(of_gravity))).collect()
}

/// Columns of each effect from index `first` on, after those of geometry and frames.
pub(super) fn columns(always: usize, effects: &EffectModel, first: usize) -> Vec<Range<usize>> {
    let mut end = always;
    let mut ranges = Vec::new();
    for effect in &effects.effects {
        ranges.push(end..end + effect.coefficients.len());
        end += effect.coefficients.len();
    }
    ranges.split_off(first)
}

/// Which of these blocks of columns raise the score by more than `least` each, compared with new hyperparameters without them.
///
/// The others are removed one by one. A block's gain at fixed hyperparameters is an upper bound of its true gain: new hyperparameters are
/// found only for the [`WEAKEST`], once no block falls below `least` without that. The last hyperparameters are returned, too.
pub(super) fn asked_for(
    model: &Model<'_>,
    blocks: &[Range<usize>],
    least: f64,
    known: Option<&Hyperparameters>,
) -> (Vec<bool>, Option<Hyperparameters>) {
    let mut kept = vec![true; blocks.len()];
    let Some((first, mut hyper)) = maximum::from_afar(model, known, ROUGH) else {
        return (vec![false; blocks.len()], None);
    };
    let mut score = first.score;
    if let Some(beside) = nobody_gives(model, blocks, least, (score, &hyper)) {
        return (vec![false; blocks.len()], Some(beside));
    }
    let mut chosen_anew = true;
    let mut slope = Some(first);
    loop {
        let left_out = |block: Option<usize>| -> Vec<usize> {
            let out = |index: &usize| Some(*index) == block || !kept[*index];
            (0..blocks.len()).filter(out).flat_map(|index| blocks[index].clone()).collect()
        };
        let without = |block: Option<usize>| nothing(model, left_out(block).into_iter());
        let Some(here) = &slope else { break };
        let there: Vec<usize> = (0..blocks.len()).filter(|&block| kept[block]).collect();
        let left = |&block: &usize| {
            (here.score_without(model, &left_out(Some(block)), &[]).unwrap_or(f64::NEG_INFINITY), block)
        };
        let mut order: Vec<(f64, usize)> = each_alone(&there, left);
        order.sort_by(|a, b| b.0.total_cmp(&a.0));
        let Some(&(left, weakest)) = order.first() else { break };
        let anew = |block: Option<usize>| {
            let reached = maximum::from_near(&under(model, &without(block)), &hyper, ROUGH);
            reached.map(|(there, hyper)| (there.score, hyper))
        };
        // After a block is removed, the hyperparameters are good enough for the next only if little changes.
        if (chosen_anew && score - left < least) || (score - left).abs() < least {
            kept[weakest] = false;
            (score, chosen_anew) = (left, false);
        } else if !chosen_anew {
            let Some(reached) = anew(None) else { break };
            ((score, hyper), chosen_anew) = (reached, true);
            slope = model.slope(&hyper, f64::NEG_INFINITY);
        } else {
            let weakest = &order[..order.len().min(WEAKEST)];
            let tried = each_alone(weakest, |&(_, block)| Some((block, anew(Some(block))?)));
            let best = tried.into_iter().flatten().max_by(|a, b| a.1.0.total_cmp(&b.1.0));
            let Some((block, reached)) = best.filter(|(_, reached)| score - reached.0 < least) else { break };
            kept[block] = false;
            (score, hyper) = reached;
            slope = model.slope(&hyper, f64::NEG_INFINITY);
        }
    }
    (kept, Some(hyper))
}

/// The hyperparameters without any block, if neither all blocks together nor any one alone makes a difference, as in most clean
/// files. `with`: the score with all of them, and its hyperparameters.
fn nobody_gives(
    model: &Model<'_>,
    blocks: &[Range<usize>],
    least: f64,
    (with, hyper): (f64, &Hyperparameters),
) -> Option<Hyperparameters> {
    let none = nothing(model, blocks.iter().cloned().flatten());
    let bare = under(model, &none);
    if with - bare.score(hyper)? > FAR * least {
        return None;
    }
    let (there, beside) = maximum::from_near(&bare, hyper, ROUGH)?;
    let score = there.score;
    if with - score >= least {
        return None;
    }
    let here = model.slope(&beside, f64::NEG_INFINITY)?;
    let alone = |block: &Range<usize>| {
        let others: Vec<usize> = blocks.iter().filter(|other| *other != block).cloned().flatten().collect();
        here.score_without(model, &others, &[]).is_some_and(|with| with - score > least)
    };
    (!blocks.iter().any(alone)).then_some(beside)
}

/// The model under another prior of the plain columns.
pub(super) fn under<'a>(model: &Model<'a>, (precision, log_precision): &'a (DMatrix<f64>, f64)) -> Model<'a> {
    Model { precision, log_precision: *log_precision, ..model.clone() }
}

/// The prior that removes these columns from the model.
pub(super) fn nothing(model: &Model<'_>, columns: impl Iterator<Item = usize>) -> (DMatrix<f64>, f64) {
    let (mut precision, mut log_precision) = (model.precision.clone(), model.log_precision);
    for column in columns {
        precision[(column, column)] *= NOTHING;
        log_precision += NOTHING.ln();
    }
    (precision, log_precision)
}

/// How far a joint turns by this effect over the rows, root mean square about the mean, rad.
pub fn turned(data: &Measurements, fit: &Fit<EffectModel>, effect: &Effect) -> f64 {
    let amounts = amounts(data, fit, effect);
    let mean = amounts.iter().sum::<f64>() / amounts.len().max(1) as f64;
    (amounts.iter().map(|amount| (amount - mean).powi(2)).sum::<f64>() / amounts.len().max(1) as f64).sqrt()
}

/// How far a joint turns by this effect, row by row, rad.
pub fn amounts(data: &Measurements, fit: &Fit<EffectModel>, effect: &Effect) -> Vec<f64> {
    let numbers = effect.coefficients.len();
    let values = torques(data, fit, &effect.term);
    values.chunks_exact(numbers).map(|row| row.iter().zip(&effect.coefficients).map(|(v, c)| v * c).sum()).collect()
}

/// Row by row what drives the term.
fn torques(data: &Measurements, fit: &Fit<EffectModel>, term: &Term) -> Vec<f64> {
    let mut values = Vec::new();
    for (index, posture) in postures(&fit.effects, &fit.arm, data).iter().enumerate() {
        let row = Row::new(data, index);
        let conditions = Conditions::of(row);
        term.driver.values_into(&fit.effects.statics, &conditions, posture, &mut values);
    }
    values
}

#[cfg(test)]
mod tests {
    use super::*;
    use denavit_identify::effects::driver::Statics;
    use denavit_model::examples;

    #[test]
    fn a_cause_is_expected_as_large_as_it_is_and_a_deflection_small() {
        let statics = Statics::of_chain(&examples::puma_like());
        let driver = Driver::TorqueTerms { joint: 1, links: usize::MAX };
        let term = Term { kind: Kind::JointCompliance, carrier: Carrier::Joint(1), driver, coupling: Coupling::Each };
        let count = term.coefficients(&statics);
        let effect = Effect { term, coefficients: vec![1e-3; count] };
        let found = expected(&EffectModel::new(statics, vec![effect.clone(), effect]), 1);
        assert!(count > 0 && found.len() == 2 * count);
        assert!(found[..count].iter().all(|of| *of == Expected::OrAsNow(1e-3)));
        assert!(found[count..].iter().all(|of| matches!(of, Expected::UnitInformation(least) if *least > 1e6)));
    }
}
