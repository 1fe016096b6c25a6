//! From the proposals of the search to the claimed effects: curves, the comparison of sets, and the model that is kept.

use crate::blocks::Block;
use crate::findings::values;
use crate::infer::curves::{CurveFit, fit_curves, fit_curves_near};
use crate::infer::named::{Judged, Judgement, OtherRows, Question, judge};
use crate::search::{Proposals, same_terms};
use crate::tracer::{State, Tracer};
use crate::unexplained::{self, UnexplainedStructure};
use crate::{Finding, PartialResiduals, Trace, TraceOptions};
use denavit_identify::effects::candidates::Candidate;
use denavit_identify::effects::carrier::Carrier;
use denavit_identify::effects::catalogue::Kind;
use denavit_identify::effects::curve::Curve;
use denavit_identify::effects::driver::{Driver, Statics};
use denavit_identify::effects::model::{EffectModel, Term};
use denavit_identify::effects::survey::Survey;
use denavit_identify::fit_stage;
use denavit_identify::parameters::NoEffects;
use denavit_identify::solve::Fit;
use denavit_linear::threads::{in_parallel, join};
use denavit_measurements::Measurements;
use std::sync::Arc;

/// Largest number of rows and values for the comparison: 800 positions, 400 poses. More rows determine curves better, but a cause that
/// these do not show is too small to be named, and the time grows with them.
const MOST_ROWS: usize = 800;
const MOST_VALUES: usize = 2400;
/// Values that the search uses per row of the run, and at least in total; its proposals are compared on all rows. Long runs show smaller
/// causes, and more of them at once.
const SEARCHED_PER_ROW: usize = 2;
const FEWEST_SEARCHED: usize = 800;
/// If the run has more rows, up to this many further sets of rows must support a cause, too.
const MOST_OTHERS: usize = 4;
/// Largest number of candidates in the comparison.
const MOST_JUDGED: usize = 100;
/// A cause is not named if it explains less than this share of the remaining unexplained structure.
const OUTWEIGHED: f64 = 0.5;

/// Smallest number of rows in a bump.
const ROWS_IN_BUMP: usize = 5;

/// The whole trace: search, comparison, final fit.
pub(crate) fn trace(
    statics: &Statics,
    data: &Measurements,
    geometric: &Fit<NoEffects>,
    options: &TraceOptions,
) -> Trace {
    let survey = Survey::of(statics, data, options.gear_ratios.clone());
    let thinnings = thinnings(data);
    let rows = &thinnings[0];
    let thin: Vec<(Measurements, Fit<NoEffects>)> =
        thinnings.iter().map(|rows| (data.subset(rows), on_rows(geometric, data, rows))).collect();
    let part = &thin[0].0;
    let tracers: Vec<Tracer<'_>> =
        thin.iter().map(|(part, geometric)| Tracer::new(statics, part, geometric, options)).collect();
    let tracer = &tracers[0];
    let all_curves = || {
        fit_curves(
            &survey,
            data,
            &geometric.with_model(statics, options.earlier.as_ref()),
            &geometric.arm,
            &options.curves,
        )
    };
    let (curves, found) = join(all_curves, || search(tracer, data.len()));
    let known = &curves.fit.effects.curves;
    let with = |terms: &[Candidate], from: &Fit<EffectModel>, data: &Measurements, survey: &Survey| {
        let terms: Vec<_> = terms.iter().map(|candidate| candidate.term.clone()).collect();
        let model = EffectModel::of_terms(statics, options.earlier.as_ref(), &terms);
        let plain = fit_stage(data, &from.arm, &model, &vec![1.0; data.observations()], &options.identify);
        let beside = fit_curves_near(survey, data, &plain, &geometric.arm, options.curves, known);
        (plain, beside)
    };
    // With the final model of the search, other curves are fitted.
    let ended = Some(&found.state).filter(|state| !state.chosen.is_empty());
    let models: Vec<Option<&State>> = [None].into_iter().chain(ended.map(Some)).collect();
    let bare = geometric.with_model(statics, options.earlier.as_ref());
    let fitted = in_parallel(&models, |model| match model {
        Some(state) => with(&state.chosen, &state.fit, part, &tracer.survey),
        None if rows.len() == data.len() => (bare.clone(), curves.clone()),
        None => {
            let plain = on_rows(&bare, data, rows);
            let beside = fit_curves_near(&tracer.survey, part, &plain, &geometric.arm, options.curves, known);
            (plain, beside)
        }
    });
    let near: Vec<&CurveFit> = fitted.iter().map(|(_, near)| near).collect();
    let proposed = proposed(tracer, &near, found.candidates);
    let Judgement { members: judged, open } = if proposed.is_empty() {
        Judgement::default()
    } else {
        let structures = in_parallel(&near, |near| remains(tracer, &near.fit).blocks);
        let structures: Vec<Vec<Block>> = structures.into_iter().filter(|blocks| !blocks.is_empty()).collect();
        let state = near.get(1).unwrap_or(&near[0]);
        let others = other_rows(&tracers, &structures);
        let all: Vec<&[Curve]> = near.iter().map(|near| near.fit.effects.curves.as_slice()).collect();
        let question = Question {
            candidates: &proposed,
            counted: &tracer.candidates,
            start: &found.state.chosen,
            curves: &all,
            structures: &structures,
            others: &others,
        };
        judge(&tracer.survey, part, &state.fit, &geometric.arm, &question)
    };
    let mut judged: Vec<Judged> = judged.into_iter().filter(Judged::kept).collect();
    judged.truncate(options.max_effects.unwrap_or(usize::MAX));
    // In the order of the search: its final model need not be fitted again.
    let order = &found.state.chosen;
    judged.sort_by_key(|one| order.iter().position(|known| known.term == one.candidate.term).unwrap_or(order.len()));
    let terms = |judged: &[Judged]| judged.iter().map(|one| one.candidate.clone()).collect::<Vec<Candidate>>();
    let fit_with = |kept: &[Candidate]| {
        let same = |state: &&State| same_terms(&state.chosen, kept);
        let known_fit =
            models.iter().position(|model| model.as_ref().is_some_and(same)).filter(|_| rows.len() == data.len());
        match known_fit {
            _ if kept.is_empty() => (bare.clone(), curves.clone()),
            Some(model) => fitted[model].clone(),
            None => with(kept, &found.state.fit, data, &survey),
        }
    };
    let (mut plain, mut last) = fit_with(&terms(&judged));
    if !last.fit.converged && !judged.iter().all(Judged::named) {
        // Uncertain effects may be large and cancel each other: they are left out.
        judged.retain(Judged::named);
        (plain, last) = fit_with(&terms(&judged));
    }
    let kept = terms(&judged);
    let (unexplained, partial_residuals) = join(
        || remains(tracer, &on_rows(&last.fit, data, rows)),
        || tracer.all_partial_residuals(&tracer.refitted(kept, None)),
    );
    let spurious = spurious(&judged, &unexplained, (&tracers, &thinnings), data, &last.fit);
    let findings = findings(judged, partial_residuals, &spurious, &last.fit);
    Trace {
        fit: last.fit,
        curve_gains: last.gains,
        modes: last.modes,
        deflections: last.deflections,
        plain,
        curves,
        findings,
        candidates: tracer.candidates.len(),
        scan: found.scan,
        unexplained,
        open: open.map(Arc::new),
    }
}

/// The other sets of rows, with the structures' columns there.
fn other_rows<'a>(tracers: &'a [Tracer<'a>], structures: &[Vec<Block>]) -> Vec<OtherRows<'a>> {
    let of = |tracer: &'a Tracer<'a>| OtherRows {
        survey: &tracer.survey,
        data: tracer.data,
        structures: unexplained::of_these_rows(tracer, structures),
    };
    tracers.iter().skip(1).map(of).collect()
}

/// Which causes are smaller than the unexplained structure of a fit, in the mean over the rows of the comparison (`unexplained`) and the
/// other rows.
fn spurious(
    judged: &[Judged],
    unexplained: &UnexplainedStructure,
    (tracers, thinnings): (&[Tracer<'_>], &[Vec<usize>]),
    data: &Measurements,
    fit: &Fit<EffectModel>,
) -> Vec<bool> {
    if judged.is_empty() || !unexplained.structured {
        return vec![false; judged.len()];
    }
    let others: Vec<(&Tracer<'_>, &Vec<usize>)> = tracers.iter().zip(thinnings).skip(1).collect();
    let drops = in_parallel(&others, |(tracer, rows)| remains(tracer, &on_rows(fit, data, rows)).drop);
    let drop = (unexplained.drop + drops.iter().sum::<f64>()) / tracers.len() as f64;
    judged.iter().map(|one| outweighed(one, drop)).collect()
}

/// The candidates of the comparison: first those that an engineer would try, then those that the search found.
fn proposed(tracer: &Tracer<'_>, near: &[&CurveFit], found: Vec<Candidate>) -> Vec<Candidate> {
    let curves = near.iter().flat_map(|near| &near.fit.effects.curves);
    let plain = curves.flat_map(|curve| plain_causes(&tracer.candidates, curve.joint));
    let mut proposed: Vec<Candidate> = Vec::new();
    for candidate in plain.chain(found) {
        if !proposed.iter().any(|other| other.term == candidate.term) {
            proposed.push(candidate);
        }
    }
    proposed.retain(|candidate| wide_enough(candidate, tracer.data, tracer.statics));
    proposed.truncate(MOST_JUDGED);
    proposed
}

/// Whether unexplained structure, `drop` of the sum of squares, is larger than a cause: the cause may then only absorb a part of it.
fn outweighed(one: &Judged, drop: f64) -> bool {
    2.0 * one.gain < OUTWEIGHED * drop
}

/// The findings, with their numbers in the fit, where their effects come first.
fn findings(
    judged: Vec<Judged>,
    partial_residuals: Vec<PartialResiduals>,
    spurious: &[bool],
    fit: &Fit<EffectModel>,
) -> Vec<Finding> {
    let mut first = fit.layout.effects.start;
    let mut findings = Vec::new();
    for ((index, one), partial_residuals) in judged.into_iter().enumerate().zip(partial_residuals) {
        findings.push(Finding {
            term: one.candidate.term.clone(),
            place: one.candidate.term.carrier.place(&fit.effects.statics.chain),
            values: values(fit, index, first),
            named: one.named() && !spurious[index],
            probability: one.probability,
            found_again: one.found_again,
            p_value: one.log_absent.exp(),
            delta_bic: 2.0 * one.gain,
            rivals: one.rivals,
            partial_residuals,
        });
        first += fit.effects.effects[index].coefficients.len();
    }
    findings
}

/// The proposals of a search in a run with this number of rows.
fn search(tracer: &Tracer<'_>, rows: usize) -> Proposals {
    let all = tracer.data;
    let searched = rows_of(all, (SEARCHED_PER_ROW * rows).max(FEWEST_SEARCHED));
    if searched == all.len() {
        return tracer.proposals(None);
    }
    let some = all.evenly_spread(searched);
    tracer.proposals(Some((&all.subset(&some), &on_rows(tracer.geometric, all, &some))))
}

/// Rows spread evenly over the run; if it has more than are compared, further sets of rows between them.
fn thinnings(data: &Measurements) -> Vec<Vec<usize>> {
    let rows = data.len();
    let most = rows_of(data, MOST_VALUES).min(MOST_ROWS);
    let count = (rows / most.max(1)).clamp(1, 1 + MOST_OTHERS);
    let all = data.evenly_spread(most * count);
    (0..count).map(|first| all.iter().copied().skip(first).step_by(count).collect()).collect()
}

/// How many rows have this number of values, or all.
fn rows_of(data: &Measurements, values: usize) -> usize {
    (data.len() * values).div_ceil(data.values().max(1)).min(data.len())
}

/// The part of a fit's residual that smooth functions explain.
fn remains(tracer: &Tracer<'_>, fit: &Fit<EffectModel>) -> UnexplainedStructure {
    let state = State::new(Vec::new(), fit.clone());
    let linear = tracer.linear(&state);
    unexplained::examine(tracer, &tracer.scorer(linear))
}

/// Causes that a joint's own curve may hide: its scale, its compliance, its play. Only the plain forms are proposed; the search
/// finds the others.
fn plain_causes(candidates: &[Candidate], joint: usize) -> Vec<Candidate> {
    let plain = |candidate: &&Candidate| {
        let Term { kind, carrier, driver, .. } = &candidate.term;
        *carrier == Carrier::Joint(joint)
            && match kind {
                Kind::JointScale => true,
                Kind::JointCompliance => matches!(driver, Driver::Torque(_) | Driver::Covariate(_)),
                Kind::Backlash => matches!(driver, Driver::Approach { .. } | Driver::GravitySide(_)),
                _ => false,
            }
    };
    candidates.iter().filter(plain).cloned().collect()
}

/// Whether a bump has enough rows to be recognised.
fn wide_enough(candidate: &Candidate, data: &Measurements, statics: &Statics) -> bool {
    let Driver::Bump { joint, at, width, .. } = candidate.term.driver else { return true };
    let moving = &statics.chain.joints()[joint];
    let readings = (0..data.len()).map(|row| moving.value(data.reading(row)));
    readings.filter(|reading| (reading - at).abs() < width).count() >= ROWS_IN_BUMP
}

/// A fit restricted to some of its rows.
fn on_rows<E: Clone>(fit: &Fit<E>, data: &Measurements, rows: &[usize]) -> Fit<E> {
    let observations: Vec<usize> = rows.iter().flat_map(|row| data.of_row(*row)).collect();
    Fit {
        weights: observations.iter().map(|&k| fit.weights[k]).collect(),
        squares: observations.iter().map(|&k| fit.squares[k]).collect(),
        ..fit.clone()
    }
}
