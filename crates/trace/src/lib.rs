//! Trace the residual of a geometric fit to effects that the model lacks.
//!
//! ```text
//! geometric fit ─► error curves of all joints ─► a stepwise search proposes candidates ─► sets of candidates are scored, with curves
//! and unexplained structure in the model ─► causes that are probable, and selected in half-sample refits, are named ─► all refitted
//! ```
//! Candidates do not depend on measured values. All are tested against geometry at the same state of the model. This crate is for
//! denavit's other crates and changes without notice; the stable names are those at the root of `denavit-calibrate`.

pub mod infer;

mod blocks;
mod by_carrier;
mod downdate;
mod findings;
pub mod linear;
pub mod loads;
pub mod masses;
mod partial_residuals;
mod projected;
mod projector;
mod refine;
mod scorer;
mod search;
mod selection;
mod tracer;
pub mod unexplained;

use crate::infer::curves::{CurveFit, CurveOptions};
use crate::infer::hypotheses::Open;
use crate::infer::named::{Alternative, sure};
use denavit_identify::IdentifyOptions;
use denavit_identify::effects::catalogue::Kind;
use denavit_identify::effects::curve_modes::CurveModes;
use denavit_identify::effects::driver::Statics;
use denavit_identify::effects::model::{EffectModel, Term};
use denavit_identify::parameters::NoEffects;
use denavit_identify::solve::Fit;
use denavit_linear::threads::with_threads;
use denavit_measurements::Measurements;
pub use partial_residuals::{PartialResidual, PartialResiduals};
use serde::Serialize;
use std::sync::Arc;
pub use unexplained::{Structure, UnexplainedStructure};

/// Options of the tracer: what to search for, and the level of confidence.
#[derive(Debug, Clone, PartialEq)]
pub struct TraceOptions {
    /// How the model is refitted.
    pub identify: IdentifyOptions,
    /// Kinds to look for; empty: all.
    pub kinds: Vec<Kind>,
    /// Largest number of effects; `None`: as many as the evidence selects.
    pub max_effects: Option<usize>,
    /// Motor turns per joint turn, joint by joint, where known.
    pub gear_ratios: Vec<Option<f64>>,
    /// Accepted share of clean files in which an effect is claimed (false alarm rate).
    pub false_claims: f64,
    /// How error curves are sought beside them.
    pub curves: CurveOptions,
    /// Mass of all links from the first joint on, kg, where the description has none and it is known.
    pub total_mass: Option<f64>,
    /// Effects known from an earlier calibration: they act in every row, and further effects are searched for.
    pub earlier: Option<Arc<EffectModel>>,
}

impl TraceOptions {
    /// All kinds, one false claim in two hundred clean files.
    pub fn new(identify: IdentifyOptions) -> Self {
        Self {
            identify,
            kinds: Vec::new(),
            max_effects: None,
            gear_ratios: Vec::new(),
            false_claims: 0.005,
            curves: CurveOptions::default(),
            total_mass: None,
            earlier: None,
        }
    }
}

/// A number with its standard deviation and unit.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Value {
    /// What it is.
    pub name: String,
    /// SI.
    pub value: f64,
    /// Standard deviation, SI; `None` for numbers that a scan chose.
    pub std: Option<f64>,
    /// Unit.
    pub unit: String,
}

/// An effect that the data support: named, or one of several that the data cannot distinguish.
#[derive(Debug, Clone, PartialEq)]
pub struct Finding {
    /// The term.
    pub term: Term,
    /// Where it acts, as a report says it.
    pub place: String,
    /// Its numbers.
    pub values: Vec<Value>,
    /// Whether it is sure enough to be named as the cause.
    pub named: bool,
    /// Posterior probability that this kind acts at this place.
    pub probability: f64,
    /// Share of half-sample refits that select it.
    pub found_again: f64,
    /// Posterior probability that it does not act.
    pub p_value: f64,
    /// Twice the logarithm of the odds of the best set with it against the best without it.
    pub delta_bic: f64,
    /// Alternative kinds and places, the most probable first.
    pub rivals: Vec<Alternative>,
    /// Its partial residuals, row by row.
    pub partial_residuals: PartialResiduals,
}

impl Finding {
    /// Whether it would be certain, but the remaining unexplained structure is larger.
    pub fn is_outweighed(&self) -> bool {
        !self.named && sure(self.probability, self.found_again)
    }

    /// The joint that drives it, where that is not the one that it acts at.
    pub fn driven_by(&self) -> Option<usize> {
        self.term.driver.joint().filter(|driver| Some(*driver) != self.term.carrier.joint())
    }
}

/// One cell of the scan over all pairs, before anything was added.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ScanCell {
    /// The kind of the best candidate here.
    pub kind: Kind,
    /// Where it acts.
    pub place: String,
    /// Fall of the information criterion.
    pub delta_bic: f64,
}

/// What the tracer found.
#[derive(Debug, Clone)]
pub struct Trace {
    /// Geometry, effects and error curves, fitted together.
    pub fit: Fit<EffectModel>,
    /// For each curve, its increase of the log marginal likelihood.
    pub curve_gains: Vec<f64>,
    /// The same for deflections of joints under gravity: the last effects of the fit, which are not among the findings.
    pub deflections: Vec<f64>,
    /// Uncertainty of its curves.
    pub modes: CurveModes,
    /// Geometry and effects without curves.
    pub plain: Fit<EffectModel>,
    /// Geometry and curves without effects.
    pub curves: CurveFit,
    /// The effects, in the model's order.
    pub findings: Vec<Finding>,
    /// How many candidates were tried in one pass.
    pub candidates: usize,
    /// The first pass: the best candidate of each kind at each place.
    pub scan: Vec<ScanCell>,
    /// Structure that no effect of the catalogue explains.
    pub unexplained: UnexplainedStructure,
    /// The sets of causes that remain possible, if more than one.
    pub open: Option<Arc<Open>>,
}

/// The first pass of the search alone: every candidate against the geometric fit, the best of each kind at each place.
///
/// # Shape and units
/// As [`trace`].
pub fn scan(
    statics: &Statics,
    data: &Measurements,
    geometric: &Fit<NoEffects>,
    options: &TraceOptions,
) -> Vec<ScanCell> {
    tracer::Tracer::new(statics, data, geometric, options).first_pass()
}

/// Searches for effects beyond a geometric fit.
///
/// # Shape and units
/// `data` as given to the geometric fit, with run order added by
/// [`denavit_identify::effects::survey::with_run_order`] where it is known.
pub fn trace(statics: &Statics, data: &Measurements, geometric: &Fit<NoEffects>, options: &TraceOptions) -> Trace {
    with_threads(|| selection::trace(statics, data, geometric, options))
}
