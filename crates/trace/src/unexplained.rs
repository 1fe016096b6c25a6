//! Unexplained structure: the part of the residual that smooth functions of one or two variables explain, but no effect of the catalogue.

use crate::by_carrier::{ByRow, Driven, alike};
use crate::linear::Linear;
use crate::projector::{Gain, Projector};
use crate::search::{CandidateScorer, p_value};
use crate::select::Tracer;
use denavit_identify::arm::Row;
use denavit_identify::effects::carrier::Carrier;
use denavit_identify::effects::driver::{Conditions, Driver, Posture};
use denavit_identify::effects::model::Coupling;
use denavit_identify::effects::recorded::told_by_order;
use denavit_identify::effects::survey::Survey;
use denavit_linear::threads::in_parallel;
use denavit_measurements::Column;
use denavit_model::nalgebra::DMatrix;
use serde::Serialize;
use std::sync::Arc;

/// Periods per joint range of the waves that make a smooth function of one joint.
const WAVES: [f64; 4] = [0.5, 1.0, 1.5, 2.0];
/// Waves that are multiplied for a function of two joints.
const PAIR_WAVES: [f64; 2] = [0.5, 1.0];
/// Linear pieces of a smooth function of a recorded quantity.
const PIECES: usize = 6;
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

/// Functions of one or two variables, acting at one carrier.
#[derive(Debug, Clone)]
pub(crate) struct Block {
    /// Where they act.
    pub(crate) carrier: Carrier,
    variables: Vec<Variable>,
    /// Values row by row.
    values: Arc<[f64]>,
    per_row: usize,
}

#[derive(Debug, Clone, PartialEq)]
enum Variable {
    Joint(usize),
    Recorded(String),
}

/// Carriers that blocks act at.
pub fn carriers(survey: &Survey) -> Vec<Carrier> {
    survey.moving().map(Carrier::Joint).chain([Carrier::Base]).collect()
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
            let place = variable.place(tracer, gain.drop / linear.residual.norm_squared());
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

impl Variable {
    fn joint(&self) -> Option<usize> {
        match self {
            Self::Joint(joint) => Some(*joint),
            Self::Recorded(_) => None,
        }
    }

    fn place(&self, tracer: &Tracer<'_>, share: f64) -> Structure {
        match self {
            Self::Joint(joint) => {
                let name = tracer.statics.chain.joints()[*joint].name.clone();
                Structure { joint: Some(name), covariate: None, share }
            }
            Self::Recorded(name) => Structure { joint: None, covariate: Some(name.clone()), share },
        }
    }
}

impl Block {
    fn driven(&self) -> Driven<'_> {
        Driven { coupling: Coupling::Each, per_row: self.per_row, values: &self.values }
    }

    /// In units of the noise.
    pub(crate) fn columns(&self, scorer: &CandidateScorer<'_>) -> DMatrix<f64> {
        let linear = scorer.linear;
        let Some(carrier) = linear.columns_of(self.carrier) else {
            return DMatrix::zeros(linear.residual.len(), 0);
        };
        let mut columns = DMatrix::zeros(linear.residual.len(), carrier.len() * self.per_row);
        for (d, direction) in carrier.enumerate() {
            for value in 0..self.per_row {
                let mut column = columns.column_mut(d * self.per_row + value);
                for (index, row) in linear.rows.iter().enumerate() {
                    column[index] = linear.carriers[(index, direction)] * self.values[row * self.per_row + value];
                }
            }
        }
        columns
    }
}

/// Every function of one or two variables that is tested; they depend on the data's columns alone.
pub(super) fn blocks(tracer: &Tracer<'_>) -> Vec<Block> {
    let survey = &tracer.survey;
    let rows = tracer.data.len();
    let moving: Vec<usize> = survey.moving().collect();
    let tips = &survey.statics.tips;
    let waves = |joint: usize, counts: &[f64]| -> Vec<Vec<f64>> {
        let (low, high) = survey.ranges[joint];
        let moving = &tracer.statics.chain.joints()[joint];
        (0..rows)
            .map(|row| {
                let part = (moving.value(tracer.data.reading(row)) - low) / (high - low);
                let wave = |count: &f64| {
                    let (sine, cosine) = (std::f64::consts::TAU * count * part).sin_cos();
                    [sine, cosine]
                };
                counts.iter().flat_map(wave).collect()
            })
            .collect()
    };
    let mut functions: Vec<(Vec<Variable>, Vec<Vec<f64>>)> = Vec::new();
    for (index, &joint) in moving.iter().enumerate() {
        functions.push((vec![Variable::Joint(joint)], waves(joint, &WAVES)));
        for &other in moving[index + 1..].iter().filter(|&&other| tips.carries(joint, other)) {
            let (a, b) = (waves(joint, &PAIR_WAVES), waves(other, &PAIR_WAVES));
            let products =
                a.iter().zip(&b).map(|(a, b)| a.iter().flat_map(|x| b.iter().map(move |y| x * y)).collect()).collect();
            functions.push((vec![Variable::Joint(joint), Variable::Joint(other)], products));
        }
    }
    for column in &survey.recorded {
        if told_by_order(column.name()) {
            continue;
        }
        if let Some(values) = pieces(tracer, column) {
            functions.push((vec![Variable::Recorded(column.name().to_owned())], values));
        }
    }
    for label in &tracer.data.labels {
        let mut words: Vec<&String> = label.values.iter().collect();
        words.sort();
        words.dedup();
        if words.len() > 1 && words.len() <= 2 * PIECES {
            let of = |value: &String| words[1..].iter().map(|word| f64::from(u8::from(*word == value))).collect();
            functions.push((vec![Variable::Recorded(label.name.clone())], label.values.iter().map(of).collect()));
        }
    }
    let mut blocks = Vec::new();
    for (variables, values) in functions {
        let per_row = values.first().map_or(0, Vec::len);
        let flat: Arc<[f64]> = values.into_iter().flatten().collect();
        let recorded = matches!(variables[0], Variable::Recorded(_));
        let carriers = moving.iter().map(|&joint| Carrier::Joint(joint)).chain(recorded.then_some(Carrier::Base));
        // The error of one arm does not depend on the other arm's readings.
        let one_way = |carrier: &Carrier| {
            let own = carrier.joint().into_iter().chain(variables.iter().filter_map(Variable::joint));
            let own: Vec<usize> = own.collect();
            tips.all().iter().any(|tip| own.iter().all(|&joint| tip.joints[joint]))
        };
        for carrier in carriers.filter(one_way) {
            blocks.push(Block { carrier, variables: variables.clone(), values: flat.clone(), per_row });
        }
    }
    blocks
}

/// Linear pieces over a recorded quantity, with knots at its quantiles.
fn pieces(tracer: &Tracer<'_>, column: &Column) -> Option<Vec<Vec<f64>>> {
    let recorded = |row: usize| tracer.data.covariates.row(row).value(column);
    let mut sorted: Vec<f64> = (0..tracer.data.len()).map(recorded).collect();
    sorted.sort_by(f64::total_cmp);
    let mut knots: Vec<f64> = (0..=PIECES).map(|k| sorted[k * (sorted.len() - 1) / PIECES]).collect();
    knots.dedup();
    if knots.len() < 2 {
        return None;
    }
    let driver = Driver::Smooth { covariate: column.clone(), knots };
    let values = |row: usize| {
        let mut values = Vec::new();
        let conditions = Conditions::of(Row::new(tracer.data, row));
        driver.values_into(tracer.statics, &conditions, &Posture::default(), &mut values);
        values
    };
    Some((0..tracer.data.len()).map(values).collect())
}
