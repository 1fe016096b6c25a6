//! Effects and error curves of an earlier calibration on new rows: each is kept if it can act there and the rows do not contradict it.
//!
//! Axes, coefficients and the modes of the curves have the earlier posterior as their joint prior. A part (an effect, a curve, the
//! compliance of a joint) is tested by the probability of the rows with and without it. It is left out where the rows are 20 n times
//! as probable without it, n the number of parts, so that chance does not contradict one of many. The axes count with a weight as
//! they do without effects, see [`crate::identify_options::IdentifyOptions::earlier`].

use crate::arm::Arm;
use crate::continued::{CONTRADICTED, WEIGHTS, borne_out, log_evidence};
use crate::effects::catalogue::Kind;
use crate::effects::curve::Curve;
use crate::effects::curve_modes::{CurveModes, Varying};
use crate::effects::driver::{RUN_ORDER, Statics};
use crate::effects::history::{History, Pace};
use crate::effects::model::{Effect, EffectModel};
use crate::effects_prior::EffectsPrior;
use crate::identification::Identification;
use crate::identify_options::{IdentifyOptions, fit_stage};
use crate::known_effects::KnownEffects;
use crate::parameters::{Effects as _, Layout, NoEffects};
use crate::posterior::{Earlier, expecting};
use crate::solve::{Fit, FitOptions, fit};
use denavit_measurements::Measurements;
use denavit_model::nalgebra::{DMatrix, DVector};
use serde::Serialize;
use std::ops::Range;
use std::sync::Arc;

/// Most rows that test the parts, spread over the run: more give the same result in more time.
const MOST_ROWS: usize = 300;

/// What happens to a part of an earlier model.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum PartState {
    /// It is kept.
    Kept,
    /// The new rows contradict it.
    Contradicted,
    /// It was a drift of the earlier run.
    OfThatRun,
    /// It belonged to the instrument or the target, which are placed again.
    OfThatSetup,
    /// The new rows lack a column that it depends on.
    NoColumn,
}

/// A part of an earlier model.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CarriedPart {
    /// `error_curve`, `gravity` or the kind of an effect.
    pub kind: &'static str,
    /// Where it acts.
    #[serde(rename = "where")]
    pub place: String,
    /// What happened to it.
    pub state: PartState,
    /// The column that is missing.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub column: Option<String>,
    /// Its gain in the log probability of the new rows: below 0 where it was left out. `null` where it was not tried.
    pub log_evidence: Option<f64>,
}

/// An earlier model on new rows.
#[derive(Debug, Clone)]
pub struct Carried {
    /// The parts that can act in these rows, unchanged, with instrument and targets placed again.
    pub earlier: Fit<EffectModel>,
    /// Of that.
    pub earlier_gains: Gains,
    /// Updated axes, coefficients and curves, without the parts that the rows contradict.
    pub updated: Fit<EffectModel>,
    /// The uncertainty of its curves.
    pub updated_modes: CurveModes,
    /// Of that.
    pub updated_gains: Gains,
    /// Weight of the earlier knowledge of the axes, from 0 to 1.
    pub weight: f64,
    /// The parts, in the earlier order: effects, then curves.
    pub parts: Vec<CarriedPart>,
}

/// Gains of a model's parts in the log probability of the rows.
#[derive(Debug, Clone, PartialEq)]
pub struct Gains {
    /// Compliance of joints: the last effects of the model.
    pub fields: Vec<f64>,
    /// The error curves.
    pub curves: Vec<f64>,
}

/// What acts in the rows: the effects bound to their columns, and the indices of their coefficients in the earlier order.
struct Usable {
    statics: Statics,
    effects: Vec<(Effect, Range<usize>)>,
    curves: Vec<AbleCurve>,
}

/// A curve with its modes, and the indices of their numbers in the earlier order.
struct AbleCurve {
    curve: Curve,
    modes: Vec<Vec<f64>>,
    places: Range<usize>,
}

impl Usable {
    fn parts(&self) -> usize {
        self.effects.len() + self.curves.len()
    }

    /// The model of these parts, and the indices of its coefficients and modes in the earlier order.
    fn model(&self, kept: &[bool]) -> (Varying, Vec<usize>) {
        let (of_effects, of_curves) = kept.split_at(self.effects.len());
        let chosen: Vec<_> =
            self.effects.iter().zip(of_effects).filter(|(_, kept)| **kept).map(|(own, _)| own).collect();
        let curves: Vec<_> = self.curves.iter().zip(of_curves).filter(|(_, kept)| **kept).map(|(own, _)| own).collect();
        let effects = chosen.iter().map(|(effect, _)| effect.clone()).collect();
        let mut model = EffectModel::new(self.statics.clone(), effects);
        model.curves = curves.iter().map(|own| own.curve.clone()).collect();
        let shapes: Vec<&[Vec<f64>]> = curves.iter().map(|own| &own.modes[..]).collect();
        let places = chosen.iter().map(|(_, places)| places).chain(curves.iter().map(|own| &own.places));
        (Varying::new(model, &shapes), places.flat_map(Clone::clone).collect())
    }
}

/// The rows that test the parts, and how they are fitted.
struct Judge<'a> {
    data: &'a Measurements,
    start: &'a Arm,
    weights: &'a [f64],
    options: &'a IdentifyOptions,
    earlier: &'a Earlier,
    usable: &'a Usable,
}

impl Judge<'_> {
    fn fitted(&self, kept: &[bool], weight: f64, robust: bool) -> Fit<Varying> {
        let (model, numbers) = self.usable.model(kept);
        let options = self.options;
        let counted = self.earlier.counted(weight);
        let chain = &self.start.nominal;
        let layout = Layout::new(chain, &self.data.scene, &options.freedom, &options.tolerances, model.parameters());
        let mut layout = expecting(layout, Some(&counted));
        layout.effects_prior = counted.of_effects(&layout, &numbers, model.numbers(), 0);
        fit(self.data, &layout, self.start, &model, self.weights, &FitOptions { robust, ..options.fit })
    }

    /// A fit with its updated curves and their uncertainty.
    fn with_updated_curves(&self, kept: &[bool], weight: f64, varying: Fit<Varying>) -> (Fit<EffectModel>, CurveModes) {
        let model = varying.effects.updated();
        let coefficients = model.numbers();
        let end = varying.layout.effects.start + coefficients.len();
        let modes: Vec<usize> = (end..varying.layout.effects.end).collect();
        let others: Vec<usize> = (0..varying.layout.len()).filter(|index| !modes.contains(index)).collect();
        let of_curves = kept[self.usable.effects.len()..].iter().zip(&self.usable.curves).filter(|(kept, _)| **kept);
        let unsure = CurveModes {
            shapes: of_curves.map(|(_, own)| own.modes.clone()).collect(),
            covariance: varying.covariance.select_rows(&modes).select_columns(&modes),
            cross: varying.covariance.select_rows(&modes).select_columns(&others),
        };
        let mut layout = varying.layout.with_effects(model.parameters());
        let places = &self.usable.model(kept).1[..coefficients.len()];
        // The prior of the coefficients, whatever the curves are.
        let before = self.usable.model(kept).0.numbers()[..coefficients.len()].to_vec();
        layout.effects_prior = self.earlier.counted(weight).of_effects(&layout, places, before, 0);
        let fit = Fit {
            arm: varying.arm,
            effects: model,
            layout,
            noise: varying.noise,
            weights: varying.weights,
            squares: varying.squares,
            covariance: varying.covariance.select_rows(&others).select_columns(&others),
            parameters_used: varying.parameters_used,
            values: varying.values,
            iterations: varying.iterations,
            jacobians: varying.jacobians,
            converged: varying.converged,
            unfinished: varying.unfinished,
        };
        (fit, unsure)
    }

    fn evidence(&self, kept: &[bool], weight: f64) -> f64 {
        let fit = self.fitted(kept, weight, false);
        if fit.converged_or_exact() { log_evidence(self.data, &fit) } else { f64::NEG_INFINITY }
    }

    /// The weight of the axes with these parts, and the log probability of the rows.
    fn weighted(&self, kept: &[bool]) -> (f64, f64) {
        borne_out(&WEIGHTS.map(|weight| (weight, self.evidence(kept, weight))))
    }

    /// The parts that the rows do not contradict, and the weight of the axes with them.
    fn parts(&self) -> (Vec<bool>, f64) {
        let contradicted = CONTRADICTED + (self.usable.parts().max(1) as f64).ln();
        let all = vec![true; self.usable.parts()];
        let (mut kept, (mut weight, mut reached)) = (all.clone(), self.weighted(&all));
        for _ in 0..2 * kept.len() {
            let changed = |part: usize| {
                let mut tried = kept.clone();
                tried[part] = !tried[part];
                tried
            };
            // A part that was left out returns where the rows no longer contradict it.
            let least = |part: usize| if kept[part] { contradicted } else { 0.0 };
            let gain = |part: usize| (self.evidence(&changed(part), weight) - reached - least(part), part);
            let best = (0..kept.len()).map(gain).max_by(|a, b| a.0.total_cmp(&b.0));
            let Some((_, part)) = best.filter(|(gain, _)| *gain > 0.0) else { break };
            kept = changed(part);
            (weight, reached) = self.weighted(&kept);
        }
        // Where many parts are wrong at once, leaving out a single one may not help.
        let none = vec![false; kept.len()];
        let without = self.weighted(&none);
        if without.1 > reached + CONTRADICTED { (none, without.0) } else { (kept, weight) }
    }
}

/// Carries the earlier effects and curves over to these rows; `None` where the earlier calibration has none.
pub fn carried(data: &Measurements, identification: &Identification, options: &IdentifyOptions) -> Option<Carried> {
    let (earlier, placed) = (options.earlier.as_ref()?, identification.earlier.as_ref()?);
    let known = earlier.effects.as_ref()?;
    let geometric = &identification.geometric;
    let options = options.for_data(&geometric.arm.nominal, data);
    let (usable, mut parts, indices) = usable(known, data);
    let all = vec![true; usable.parts()];
    let (whole, places) = usable.model(&all);
    let whole = Arc::new(whole.updated());
    let held = EffectModel::beside(&usable.statics, Some(&whole));
    let plain = FitOptions { robust: false, ..options.fit };
    let anew = fit(data, &identification.nominal.layout, &placed.fit.arm, &held, &geometric.weights, &plain);
    let std: Vec<f64> = places[..whole.numbers().len()].iter().map(|&index| known.std[index]).collect();

    let few = (data.len() > MOST_ROWS).then(|| data.subset(&data.evenly_spread(MOST_ROWS)));
    let some = few.as_ref().unwrap_or(data);
    // Gross outliers are found without the earlier calibration, so that it cannot reject what contradicts it.
    let by_itself = IdentifyOptions { earlier: Some(earlier.counted(0.0)), ..options.clone() };
    let ones = vec![1.0; some.observations()];
    let alone = fit_stage(some, &geometric.arm, &NoEffects, &ones, &by_itself);
    let judge =
        Judge { data: some, start: &anew.arm, weights: &alone.weights, options: &options, earlier, usable: &usable };
    let (kept, weight) = judge.parts();
    let reached = judge.evidence(&kept, weight);
    let gain = |part: usize| {
        let mut other = kept.clone();
        other[part] = !other[part];
        let other = judge.evidence(&other, weight);
        if kept[part] { reached - other } else { other - reached }
    };
    let gains: Vec<f64> = (0..kept.len()).map(gain).collect();
    for ((index, kept), gain) in indices.iter().zip(&kept).zip(&gains) {
        parts[*index].state = if *kept { PartState::Kept } else { PartState::Contradicted };
        parts[*index].log_evidence = Some(*gain);
    }
    let ones = vec![1.0; data.observations()];
    let judge = Judge { data, weights: &ones, ..judge };
    let (updated, updated_modes) =
        judge.with_updated_curves(&kept, weight, judge.fitted(&kept, weight, options.fit.robust));
    let first_field = known.model.effects.len() - known.fields;
    let gains_of = |wanted: &[bool]| {
        let of = |part: &usize| wanted[*part];
        let fields = (0..usable.effects.len()).filter(|part| indices[*part] >= first_field).filter(of);
        let curves = (usable.effects.len()..usable.parts()).filter(of);
        Gains { fields: fields.map(|part| gains[part]).collect(), curves: curves.map(|part| gains[part]).collect() }
    };
    Some(Carried {
        earlier: put_together(&anew, 0, &whole, &std),
        earlier_gains: gains_of(&all),
        updated,
        updated_modes,
        updated_gains: gains_of(&kept),
        weight,
        parts,
    })
}

/// A fit combined with the model that was held fixed: held effects come before the last `fields` of the fit's own effects.
/// Held numbers keep their standard deviations and have no correlation with the rest.
fn put_together(fit: &Fit<EffectModel>, fields: usize, held: &EffectModel, std: &[f64]) -> Fit<EffectModel> {
    let own = &fit.effects;
    let first = own.effects.len() - fields;
    let mut model = EffectModel::new(own.statics.clone(), own.effects[..first].to_vec());
    let before = model.numbers().len();
    model.effects.extend(held.effects.iter().cloned());
    model.effects.extend(own.effects[first..].iter().cloned());
    model.curves = own.curves.iter().chain(&held.curves).cloned().collect();
    let mut layout = fit.layout.with_effects(model.parameters());
    let (at, more) = (layout.effects.start + before, std.len());
    let of_held = EffectsPrior::held(before, DVector::from_vec(held.numbers()), std, layout.joints.len());
    layout.effects_prior = (more > 0).then_some(of_held);
    let own_place = |index: usize| if index < at { Some(index) } else { index.checked_sub(at + more).map(|k| k + at) };
    let covariance = DMatrix::from_fn(layout.len(), layout.len(), |i, k| match (own_place(i), own_place(k)) {
        (Some(i), Some(k)) => fit.covariance[(i, k)],
        (None, None) if i == k => std[i - at].powi(2),
        _ => 0.0,
    });
    Fit { effects: model, layout, covariance, ..fit.clone() }
}

/// The parts that can act in these rows; all parts; and the index of each of the former among the latter.
fn usable(known: &KnownEffects, data: &Measurements) -> (Usable, Vec<CarriedPart>, Vec<usize>) {
    let model = &known.model;
    let chain = &model.statics.chain;
    let (mut usable, mut parts, mut indices) =
        (Usable { statics: model.statics.clone(), effects: Vec::new(), curves: Vec::new() }, Vec::new(), Vec::new());
    let first_field = model.effects.len() - known.fields;
    let mut end = 0;
    for (index, effect) in model.effects.iter().enumerate() {
        let places = end..end + effect.coefficients.len();
        end = places.end;
        let term = &effect.term;
        let mut part = CarriedPart {
            kind: match term.kind {
                Kind::JointCompliance if index >= first_field => "gravity",
                kind => kind.name(),
            },
            place: term.carrier.place(chain),
            state: PartState::Kept,
            column: None,
            log_evidence: None,
        };
        let bound = model.bound_effect(effect, &|name| data.column(name));
        // The duration of a row differs from run to run.
        let by_rows = |name: &String| {
            let pace = History::of_column(name).map(|(_, history)| history);
            *name == RUN_ORDER || matches!(pace, Some(History::Warmth { pace: Pace::Rows, .. }))
        };
        if term.kind == Kind::Drift || term.driver.columns().into_iter().any(by_rows) {
            part.state = PartState::OfThatRun;
        } else if !term.moves_the_tip() {
            part.state = PartState::OfThatSetup;
        } else {
            match bound {
                Ok(effect) => {
                    usable.effects.push((effect, places));
                    indices.push(index);
                }
                Err(missing) => {
                    part.state = PartState::NoColumn;
                    part.column = Some(missing.column().into());
                }
            }
        }
        parts.push(part);
    }
    for (curve, modes) in model.curves.iter().zip(&known.modes) {
        let places = end..end + modes.len();
        end = places.end;
        usable.curves.push(AbleCurve { curve: curve.clone(), modes: modes.clone(), places });
        indices.push(parts.len());
        parts.push(CarriedPart {
            kind: "error_curve",
            place: chain.joints()[curve.joint].name.clone(),
            state: PartState::Kept,
            column: None,
            log_evidence: None,
        });
    }
    (usable, parts, indices)
}

impl Carried {
    /// The updated model, held fixed while other effects are searched.
    pub fn beside(&self) -> Arc<EffectModel> {
        Arc::new(self.updated.effects.clone())
    }

    /// The updated fit as one of geometry alone, with the effects held.
    pub fn geometry(&self) -> Fit<NoEffects> {
        let fit = &self.updated;
        let effects = &fit.layout.effects;
        let kept: Vec<usize> = (0..fit.layout.len()).filter(|index| !effects.contains(index)).collect();
        Fit {
            arm: fit.arm.clone(),
            effects: NoEffects,
            layout: fit.layout.with_effects(Vec::new()),
            noise: fit.noise.clone(),
            weights: fit.weights.clone(),
            squares: fit.squares.clone(),
            covariance: fit.covariance.select_rows(&kept).select_columns(&kept),
            parameters_used: fit.parameters_used.clone(),
            values: fit.values.clone(),
            iterations: fit.iterations,
            jacobians: fit.jacobians,
            converged: fit.converged,
            unfinished: fit.unfinished.clone(),
        }
    }

    /// A fit combined with the updated model: the last `fields` of its own effects come last. Also the uncertainty of its curves.
    pub fn with(&self, fit: &Fit<EffectModel>, fields: usize, modes: &CurveModes) -> (Fit<EffectModel>, CurveModes) {
        let held = &self.updated;
        let std: Vec<f64> = held.layout.effects.clone().map(|index| held.deviation(index)).collect();
        let whole = put_together(fit, fields, &held.effects, &std);
        // Held parts have no correlation with the rest: only their modes are copied.
        let own = fit.effects.effects.len() - fields;
        let before: usize = fit.effects.effects[..own].iter().map(|effect| effect.coefficients.len()).sum();
        let at = fit.layout.effects.start + before;
        let places: Vec<usize> =
            (0..fit.layout.len()).map(|index| if index < at { index } else { index + std.len() }).collect();
        let more = CurveModes {
            cross: DMatrix::zeros(self.updated_modes.covariance.nrows(), 0),
            ..self.updated_modes.clone()
        };
        let modes = modes.with(&places, &more, &[], whole.layout.len());
        (whole, modes)
    }
}
