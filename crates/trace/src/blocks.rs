//! Smooth functions of one or two variables, acting at one carrier: unexplained structure is written as these.

use crate::by_carrier::Driven;
use crate::scorer::CandidateScorer;
use denavit_identify::arm::Row;
use denavit_identify::effects::carrier::Carrier;
use denavit_identify::effects::driver::{Conditions, Driver, Posture};
use denavit_identify::effects::model::Coupling;
use denavit_identify::effects::recorded::given_by_order;
use denavit_identify::effects::survey::Survey;
use denavit_measurements::{Column, Measurements};
use denavit_model::nalgebra::DMatrix;
use std::sync::Arc;

/// Periods per joint range of the waves that make a smooth function of one joint.
const WAVES: [f64; 4] = [0.5, 1.0, 1.5, 2.0];
/// Waves that are multiplied for a function of two joints.
const PAIR_WAVES: [f64; 2] = [0.5, 1.0];
/// Linear pieces of a smooth function of a recorded quantity.
const PIECES: usize = 6;

/// Functions of one or two variables, acting at one carrier.
#[derive(Debug, Clone)]
pub(crate) struct Block {
    /// Where they act.
    pub(crate) carrier: Carrier,
    /// The variables.
    pub(crate) variables: Vec<Variable>,
    /// Values row by row.
    values: Arc<[f64]>,
    per_row: usize,
}

/// A variable of a block.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Variable {
    /// The reading of a joint.
    Joint(usize),
    /// A recorded quantity.
    Recorded(String),
}

/// Carriers that blocks act at.
pub fn carriers(survey: &Survey) -> Vec<Carrier> {
    survey.moving().map(Carrier::Joint).chain([Carrier::Base]).collect()
}

impl Variable {
    fn joint(&self) -> Option<usize> {
        match self {
            Self::Joint(joint) => Some(*joint),
            Self::Recorded(_) => None,
        }
    }
}

impl Block {
    /// The values that drive the carrier, row by row.
    pub(crate) fn driven(&self) -> Driven<'_> {
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
pub(crate) fn blocks(survey: &Survey, data: &Measurements) -> Vec<Block> {
    let rows = data.len();
    let moving: Vec<usize> = survey.moving().collect();
    let tips = &survey.statics.tips;
    let waves = |joint: usize, counts: &[f64]| -> Vec<Vec<f64>> {
        let (low, high) = survey.ranges[joint];
        let moving = &survey.statics.chain.joints()[joint];
        (0..rows)
            .map(|row| {
                let part = (moving.value(data.reading(row)) - low) / (high - low);
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
        if given_by_order(column.name()) {
            continue;
        }
        if let Some(values) = pieces(survey, data, column) {
            functions.push((vec![Variable::Recorded(column.name().to_owned())], values));
        }
    }
    for label in &data.labels {
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
fn pieces(survey: &Survey, data: &Measurements, column: &Column) -> Option<Vec<Vec<f64>>> {
    let recorded = |row: usize| data.covariates.row(row).value(column);
    let mut sorted: Vec<f64> = (0..data.len()).map(recorded).collect();
    sorted.sort_by(f64::total_cmp);
    let mut knots: Vec<f64> = (0..=PIECES).map(|k| sorted[k * (sorted.len() - 1) / PIECES]).collect();
    knots.dedup();
    if knots.len() < 2 {
        return None;
    }
    let driver = Driver::Smooth { covariate: column.clone(), knots };
    let values = |row: usize| {
        let mut values = Vec::new();
        let conditions = Conditions::of(Row::new(data, row));
        driver.values_into(&survey.statics, &conditions, &Posture::default(), &mut values);
        values
    };
    Some((0..data.len()).map(values).collect())
}
