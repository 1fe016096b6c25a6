//! The stages of a calibration: the error of each, which one is adopted, and residuals on request.

use crate::calibration::adoption::{Adopted, worse};
use crate::calibration::contract::Stage;
use crate::calibration::placed_anew::PlacedAnew;
use denavit_identify::Identification;
use denavit_identify::carried::{Carried, Gains};
use denavit_identify::effects::averaged::Averaged;
use denavit_identify::effects::curve_modes::CurveModes;
use denavit_identify::effects::model::EffectModel;
use denavit_identify::parameters::{Effects, NoEffects};
use denavit_identify::residual_statistics::{
    ErrorSums, Errors, Residual, TestError, bound_later, each_residual, errors, lengths_found, placed, residuals,
};
use denavit_identify::solve::Fit;
use denavit_linear::threads::in_stretches;
use denavit_measurements::Measurements;
use denavit_trace::infer::curves::CurveFit;
use denavit_trace::{Finding, Trace};
use std::borrow::Cow;

/// Names of the stages that others are built on: the axes alone, and an updated earlier model.
const GEOMETRIC: &str = "geometric";
const UPDATED: &str = "updated";
/// The last stage: everything that may act, averaged.
pub(super) const AVERAGED: &str = "averaged";

/// A stage with geometry alone: its name, its kind when adopted, its fit.
pub(super) type GeometricStage<'a> = (&'static str, Adopted, &'a Fit<NoEffects>);

/// Residuals of the fitted rows that were kept.
pub(super) fn kept<E: Effects>(fit: &Fit<E>, train: &Measurements) -> Vec<Residual> {
    let mut all = residuals(&fit.arm, &fit.effects, train);
    all.retain(|residual| is_kept(fit, residual));
    all
}

fn is_kept<E>(fit: &Fit<E>, residual: &Residual) -> bool {
    fit.weights[residual.observation] > 0.0
}

/// Errors of the fitted rows that were kept.
fn errors_of_kept<E: Effects>(fit: &Fit<E>, train: &Measurements) -> Errors {
    let of_rows = |(): &mut (), rows| {
        let mut sums = ErrorSums::new(&train.scene);
        let own = each_residual(rows, &fit.arm, &fit.effects, train).filter(|residual| is_kept(fit, residual));
        own.for_each(|residual| sums.add(&residual));
        sums
    };
    let mut all = ErrorSums::new(&train.scene);
    for sums in in_stretches(train.len(), || (), of_rows) {
        all.add_all(&sums);
    }
    all.errors()
}

/// The stages that hold geometry alone, in the order in which they are listed, each with its name. Where an earlier calibration's
/// effects are carried over, the stage `earlier` has them and is not one of these.
pub(super) fn geometric_stages(identification: &Identification, carried: bool) -> Vec<GeometricStage<'_>> {
    let mut stages = vec![("nominal", Adopted::Nominal, &identification.nominal)];
    let earlier = identification.earlier.as_ref().filter(|_| !carried);
    stages.extend(earlier.map(|earlier| ("earlier", Adopted::Earlier, &earlier.fit)));
    stages.push(("geometric", Adopted::Geometric, &identification.geometric));
    stages
}

/// The fit of a stage that holds geometry alone; the geometric one for all others.
pub(super) fn geometry_at(identification: &Identification, adopted: Adopted) -> &Fit<NoEffects> {
    let own = geometric_stages(identification, false).into_iter().find(|(_, stage, _)| *stage == adopted);
    own.map_or(&identification.geometric, |(.., fit)| fit)
}

/// The stages while they are judged.
pub(super) struct Stages<'a> {
    train: &'a Measurements,
    test: Option<&'a Measurements>,
    placed_anew: Option<&'a PlacedAnew>,
    /// Each stage as the report has it.
    pub done: Vec<Stage>,
    /// Of each stage the residuals of the held-out rows.
    pub held_out: Vec<Vec<Residual>>,
}

impl<'a> Stages<'a> {
    /// None yet.
    pub fn new(train: &'a Measurements, test: Option<&'a Measurements>, placed_anew: Option<&'a PlacedAnew>) -> Self {
        Self { train, test, placed_anew, done: Vec::new(), held_out: Vec::new() }
    }

    fn add<E: Effects>(&mut self, name: String, fit: &Fit<E>) -> Result<(), TestError> {
        let train_lengths = lengths_found(&fit.arm, &fit.effects, self.train);
        let mut test_lengths = Vec::new();
        let mut held_out = Vec::new();
        let mut test_errors: Option<Errors> = None;
        if let Some(test) = self.test {
            let mut arm = placed(fit, self.train, test)?;
            self.placed_anew.iter().for_each(|anew| anew.apply(&mut arm));
            let effects = bound_later(&fit.effects, self.train, test)?;
            held_out = residuals(&arm, &effects, test);
            test_lengths = lengths_found(&arm, &effects, test);
            test_errors = Some(errors(&held_out, &test.scene));
        }
        self.done.push(Stage {
            name,
            train: errors_of_kept(fit, self.train),
            test: test_errors,
            train_lengths,
            test_lengths,
            converged: fit.converged_or_exact(),
            adopted: false,
            worse_on_held_out: false,
        });
        self.held_out.push(held_out);
        Ok(())
    }

    /// Judges all stages.
    pub fn add_all(&mut self, geometry: &[GeometricStage<'_>], beyond: &[Beyond<'_>]) -> Result<(), TestError> {
        for (name, _, fit) in geometry {
            self.add((*name).into(), *fit)?;
        }
        beyond.iter().try_for_each(|reached| self.add(reached.name.clone(), &*reached.fit))
    }

    /// Adds the averaged stage.
    pub fn add_averaged(&mut self, averaged: &Fit<Averaged>) -> Result<(), TestError> {
        self.add(AVERAGED.into(), averaged)
    }

    /// The last stage that converged.
    pub fn last(&self) -> usize {
        self.done.iter().rposition(|stage| stage.converged).unwrap_or(0)
    }

    /// Marks the adopted stage, the last one that converged, and returns its index. Held-out rows do not choose a stage: a stage that is worse
    /// on them than the one before is marked.
    pub fn adopt(&mut self) -> usize {
        let mut before = 0;
        for stage in 1..self.done.len() {
            self.done[stage].worse_on_held_out = worse(&self.held_out[before], &self.held_out[stage]);
            if self.done[stage].converged {
                before = stage;
            }
        }
        let last = self.last();
        self.done[last].adopted = true;
        last
    }
}

/// A stage after geometry.
pub(super) struct Beyond<'a> {
    /// Its name in the report.
    pub name: String,
    /// What it is adopted as.
    pub adopted: Adopted,
    /// Its model.
    pub fit: Cow<'a, Fit<EffectModel>>,
    /// Of its curves.
    pub gains: Vec<f64>,
    /// Of deflections under gravity: its last effects.
    pub deflections: Vec<f64>,
    /// How many of its curves were fitted to these rows: the first ones. The others are those of an earlier calibration.
    pub own_curves: usize,
    /// Uncertainty of its curves.
    pub modes: Cow<'a, CurveModes>,
}

/// An earlier model, as it was and updated; curves alone; effects alone, if there are also curves; both. What was found in addition to an
/// earlier model is combined with it.
pub(super) fn beyond<'a>(
    carried: Option<&'a Carried>,
    curves: Option<&'a CurveFit>,
    found: Option<&'a Trace>,
) -> Vec<Beyond<'a>> {
    let mut stages = Vec::new();
    let base = if carried.is_some() { UPDATED } else { GEOMETRIC };
    if let Some(carried) = carried {
        let stage = |name: &str, adopted, fit: &'a Fit<EffectModel>, gains: &Gains, modes| Beyond {
            name: name.into(),
            adopted,
            fit: Cow::Borrowed(fit),
            gains: gains.curves.clone(),
            deflections: gains.fields.clone(),
            own_curves: 0,
            modes,
        };
        let left = Cow::Owned(CurveModes::none(carried.earlier.layout.len()));
        stages.push(stage("earlier", Adopted::Earlier, &carried.earlier, &carried.earlier_gains, left));
        let modes = Cow::Borrowed(&carried.updated_modes);
        stages.push(stage(UPDATED, Adopted::Updated, &carried.updated, &carried.updated_gains, modes));
    }
    let known = carried.map(|carried| carried.updated_gains.clone());
    let known = known.unwrap_or(Gains { fields: Vec::new(), curves: Vec::new() });
    let put_together = |fit: &'a Fit<EffectModel>, deflections: &[f64], modes: Cow<'a, CurveModes>| match carried {
        Some(carried) => {
            let (fit, modes) = carried.with(fit, deflections.len(), &modes);
            (Cow::Owned(fit), Cow::Owned(modes))
        }
        None => (Cow::Borrowed(fit), modes),
    };
    let stage = |name: String, adopted, fit: &'a Fit<EffectModel>, of: (&[f64], &[f64], Cow<'a, CurveModes>)| {
        let (gains, deflections, modes) = of;
        let own_curves = fit.effects.curves.len();
        let (fit, modes) = put_together(fit, deflections, modes);
        let gains = [gains, &known.curves].concat();
        let deflections = [&known.fields, deflections].concat();
        Beyond { name, adopted, fit, gains, deflections, own_curves, modes }
    };
    if let Some(curves) = curves.filter(|curves| !curves.fit.effects.curves.is_empty()) {
        let name = format!("{base} + curves");
        let modes = Cow::Borrowed(&curves.modes);
        stages.push(stage(name, Adopted::Curves, &curves.fit, (&curves.gains, &curves.deflections, modes)));
    }
    if let Some(found) = found.filter(|found| !found.findings.is_empty()) {
        let name = stage_name(base, found);
        if !found.fit.effects.curves.is_empty() {
            let none = Cow::Owned(CurveModes::none(found.plain.layout.len()));
            stages.push(stage(name.clone(), Adopted::Effects, &found.plain, (&[], &[], none)));
        }
        let beside = if found.fit.effects.curves.is_empty() { "" } else { " + curves" };
        let name = format!("{name}{beside}");
        let modes = Cow::Borrowed(&found.modes);
        stages.push(stage(name, Adopted::Effects, &found.fit, (&found.curve_gains, &found.deflections, modes)));
    }
    stages
}

/// The name of a stage from its effects; effects of uncertain cause are marked.
fn stage_name(base: &str, found: &Trace) -> String {
    let of = |finding: &Finding| {
        let doubt = if finding.named { "" } else { "?" };
        format!(" + {}({}){doubt}", finding.term.kind.name(), finding.place)
    };
    format!("{base}{}", found.findings.iter().map(of).collect::<String>())
}
