//! Unexplained structure: the part of the residual that smooth functions of one or two variables explain, but no effect of the catalogue.

use crate::blocks::{Block, Variable};
use crate::by_carrier::{ByRow, Driven, alike};
use crate::linear::Linear;
use crate::projector::{Gain, Projector};
use crate::scorer::{CandidateScorer, p_value};
use crate::tracer::Tracer;
use denavit_identify::effects::carrier::Carrier;
use denavit_linear::threads::in_parallel;
use denavit_model::nalgebra::DMatrix;
use serde::Serialize;

/// Largest number of blocks that are added.
const MOST_BLOCKS: usize = 6;
/// Number of blocks that are tested again after the best was added.
const STILL_OPEN: usize = 40;
/// A direction with less than this share outside the model does not count as structure.
const SEEN: f64 = 0.05;
/// Largest number of places in a report.
const LISTED: usize = 5;

/// A joint or a recorded quantity that the unexplained residual depends on.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Structure {
    /// The joint, where it is one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub joint: Option<String>,
    /// The recorded quantity, where it is one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub covariate: Option<String>,
    /// Share of the residual (sum of squares) that functions of it explain.
    pub share: f64,
}

/// Structure that no effect of the catalogue explains.
#[derive(Debug, Clone)]
pub struct UnexplainedStructure {
    /// Whether it is beyond chance, corrected for the number of blocks.
    pub structured: bool,
    /// Probability of the best block by chance, corrected for the number of blocks.
    pub p_value: f64,
    /// Where, the largest share first.
    pub places: Vec<Structure>,
    /// Columns of the blocks that explain it, in units of the noise.
    pub(crate) columns: DMatrix<f64>,
    /// Those blocks.
    pub(crate) blocks: Vec<Block>,
    /// How much of the sum of squares they explain.
    pub(crate) drop: f64,
}

impl Default for UnexplainedStructure {
    fn default() -> Self {
        Self {
            structured: false,
            p_value: 1.0,
            places: Vec::new(),
            columns: DMatrix::zeros(0, 0),
            blocks: Vec::new(),
            drop: 0.0,
        }
    }
}

/// Tests every block against the model, adds the best, and repeats until no block is significant.
pub fn examine(tracer: &Tracer<'_>, scorer: &CandidateScorer<'_>) -> UnexplainedStructure {
    let linear = scorer.linear;
    let blocks = tracer.blocks();
    let tests = blocks.len() as f64;
    let mut open: Vec<usize> = (0..blocks.len()).collect();
    let mut taken = DMatrix::zeros(linear.residual.len(), 0);
    let mut projector = linear.loose().beside(&[&linear.effects], &linear.residual);
    let mut unexplained = UnexplainedStructure::default();
    for round in 0..MOST_BLOCKS {
        let mut scored = gains(linear, &projector, blocks, &open);
        // Sorted by the distance from chance: probabilities of strong structure all round to zero.
        let beyond = |gain: &Gain| (gain.drop - gain.rank as f64) / (gain.rank.max(1) as f64).sqrt();
        scored.sort_by(|a, b| beyond(&b.1).total_cmp(&beyond(&a.1)));
        let Some(least) = scored.iter().map(|(p, _, _)| *p).min_by(f64::total_cmp) else { return unexplained };
        let corrected = (least * tests).min(1.0);
        if round == 0 {
            unexplained.p_value = corrected;
            unexplained.structured = corrected < tracer.options.false_claims;
        }
        if corrected >= tracer.options.false_claims {
            break;
        }
        let (_, gain, best) = scored[0];
        unexplained.drop += gain.drop;
        // What explains little in the first round explains little in the next.
        open = scored.iter().take(STILL_OPEN).map(|(_, _, index)| *index).collect();
        let block = &blocks[best];
        unexplained.blocks.push(block.clone());
        let acting = block.carrier.joint().map(Variable::Joint);
        for variable in acting.iter().chain(&block.variables) {
            let place = structure(variable, tracer, gain.drop / linear.residual.norm_squared());
            let known =
                unexplained.places.iter().any(|other| other.joint == place.joint && other.covariate == place.covariate);
            if !known && unexplained.places.len() < LISTED {
                unexplained.places.push(place);
            }
        }
        let (columns, before) = (block.columns(scorer), taken.ncols());
        projector = projector.beside(&[&columns], &linear.residual);
        taken = taken.resize_horizontally(before + columns.ncols(), 0.0);
        taken.columns_mut(before, columns.ncols()).copy_from(&columns);
    }
    unexplained.columns = taken;
    unexplained
}

/// These structures in the tracer's rows.
pub(crate) fn of_these_rows(tracer: &Tracer<'_>, structures: &[Vec<Block>]) -> Vec<Vec<Block>> {
    let same = |wanted: &Block| {
        tracer
            .blocks()
            .iter()
            .find(|block| block.carrier == wanted.carrier && block.variables == wanted.variables)
            .cloned()
    };
    structures.iter().map(|structure| structure.iter().filter_map(same).collect()).collect()
}

/// Probability and gain of each open block.
fn gains(linear: &Linear, projector: &Projector, blocks: &[Block], open: &[usize]) -> Vec<(f64, Gain, usize)> {
    let free = (linear.residual.len() - projector.rank()) as f64;
    let by_row = ByRow::new(linear, projector);
    let of_carrier = |(carrier, own): &(Carrier, Vec<usize>)| {
        let terms: Vec<Driven<'_>> = own.iter().map(|&place| blocks[open[place]].driven()).collect();
        let gains = by_row.with(*carrier).products(&terms).gains(SEEN);
        let judged = |(&place, gain): (&usize, Gain)| (place, (p_value(free, projector.rss, gain, gain.rank), gain));
        own.iter().zip(gains).map(judged).collect::<Vec<_>>()
    };
    let alike = alike(open.iter().map(|&index| blocks[index].carrier));
    let mut found: Vec<(usize, (f64, Gain))> = in_parallel(&alike, of_carrier).into_iter().flatten().collect();
    // In the given order: of two equally good blocks the first is taken.
    found.sort_by_key(|(place, _)| *place);
    found.into_iter().map(|(place, (p_value, gain))| (p_value, gain, open[place])).collect()
}

/// The variable as a report names it.
fn structure(variable: &Variable, tracer: &Tracer<'_>, share: f64) -> Structure {
    match variable {
        Variable::Joint(joint) => {
            let name = tracer.statics.chain.joints()[*joint].name.clone();
            Structure { joint: Some(name), covariate: None, share }
        }
        Variable::Recorded(name) => Structure { joint: None, covariate: Some(name.clone()), share },
    }
}
