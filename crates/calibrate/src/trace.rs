//! Trace the residual of a geometric fit to the effects that the model lacks.
//!
//! ```text
//! geometric fit ─► every candidate, projected ─► best by BIC, p over the whole search, held-out ─► refit all ─┐
//!                         ▲                                                                               │
//!                         └──────────── until nothing passes; swap, merge, drop ◄─────────────────────────┘
//!                                                      └─► rivals ─► structure left over
//! ```
//! No candidate sees a measured value. All of them are tested against geometry at the same state of the model.

pub mod infer;

mod contest;
mod drifts;
mod findings;
mod holdout;
mod leftover;
pub(crate) mod linear;
mod portrait;
mod projector;
mod refine;
mod search;
mod select;

use crate::effects::catalogue::Kind;
use crate::effects::driver::Statics;
use crate::effects::model::{EffectModel, Term};
use crate::identify::IdentifyOptions;
use crate::identify::solve::Fit;
use crate::observation::measurements::Measurements;
use crate::observation::parameters::NoEffects;
pub use leftover::{Leftover, Structure};
pub use portrait::{Portrait, PortraitPoint};
use serde::Serialize;

/// What the tracer may look for, and how sure it must be.
#[derive(Debug, Clone, PartialEq)]
pub struct TraceOptions {
    /// How the model is refitted.
    pub identify: IdentifyOptions,
    /// Kinds to look for; empty: all.
    pub kinds: Vec<Kind>,
    /// No more effects than this.
    pub max_effects: usize,
    /// Motor turns per joint turn, joint by joint, where known.
    pub gear_ratios: Vec<Option<f64>>,
    /// Share of clean files in which an effect may be claimed.
    pub false_claims: f64,
}

impl TraceOptions {
    /// All kinds, eight effects at most, one false claim in two hundred clean files.
    pub fn new(identify: IdentifyOptions) -> Self {
        Self { identify, kinds: Vec::new(), max_effects: 8, gear_ratios: Vec::new(), false_claims: 0.005 }
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

/// An effect that the data ask for.
#[derive(Debug, Clone, PartialEq)]
pub struct Finding {
    /// The term.
    pub term: Term,
    /// Where it acts, as a report says it.
    pub place: String,
    /// Its numbers.
    pub values: Vec<Value>,
    /// Probability that chance alone makes the best of all candidates look as good.
    pub p_value: f64,
    /// Fall of the information criterion, the effect removed and put back.
    pub delta_bic: f64,
    /// Kinds and places that the data cannot tell from it.
    pub ambiguous_with: Vec<(Kind, String)>,
    /// What the rows say of it.
    pub portrait: Portrait,
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
    /// Geometry and effects, fitted together.
    pub fit: Fit<EffectModel>,
    /// The fit after each effect that was added, in order.
    pub stages: Vec<Fit<EffectModel>>,
    /// The effects, in the model's order.
    pub findings: Vec<Finding>,
    /// How many candidates were tried in one pass.
    pub candidates: usize,
    /// The first pass: the best candidate of each kind at each place.
    pub scan: Vec<ScanCell>,
    /// What no entry explains.
    pub leftover: Leftover,
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
    select::Tracer::new(statics, data, geometric, options).first_pass()
}

/// Searches for effects beyond a geometric fit.
///
/// # Shape and units
/// `data` as given to the geometric fit, with run order added by
/// [`crate::effects::survey::with_run_order`] where it is known.
pub fn trace(statics: &Statics, data: &Measurements, geometric: &Fit<NoEffects>, options: &TraceOptions) -> Trace {
    select::Tracer::new(statics, data, geometric, options).run()
}
