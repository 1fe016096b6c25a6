//! Partial residuals of an effect: the residual along its direction against its driver, before, with and after the effect.

use crate::linear::Linear;
use crate::scorer::CandidateScorer;
use crate::tracer::{State, Tracer};
use denavit_identify::effects::candidates::Candidate;
use denavit_identify::effects::driver::{Driver, Side};
use denavit_identify::effects::model::Coupling;
use serde::Serialize;

/// Rows less sensitive to the direction than this fraction of the most sensitive row are not drawn.
const FEELS: f64 = 0.3;

/// An effect in one row.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct PartialResidual {
    /// Value of the driver, in [`PartialResiduals::abscissa`]'s unit.
    pub driver: f64,
    /// The residual of geometry alone along the effect's direction.
    pub before: Option<f64>,
    /// Partial residual: the residual of the model without this effect.
    pub partial: f64,
    /// The effect's contribution.
    pub model: f64,
    /// The residual with it.
    pub after: f64,
}

/// An effect, row by row.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PartialResiduals {
    /// The driver, with its unit.
    pub abscissa: String,
    /// The ordinates, with their unit: SI, or units of the noise.
    pub ordinate: String,
    /// Rows, in run order.
    pub points: Vec<PartialResidual>,
}

/// One direction of an effect: its contribution per row, and its column.
struct Along {
    /// Column over the values of a linear state, one per unit of `amount`.
    column: Vec<f64>,
    /// By data row: the effect's contribution along it.
    amount: Vec<f64>,
}

impl Tracer<'_> {
    /// The partial residuals of one effect of a state; `bare`: geometry alone, linearised.
    pub(crate) fn partial_residuals(
        &self,
        scorer: &CandidateScorer<'_>,
        bare: &Linear,
        state: &State,
        index: usize,
    ) -> PartialResiduals {
        let candidate = &state.chosen[index];
        let coefficients = &state.fit.effects.effects[index].coefficients;
        let values = scorer.driver_values(&candidate.term);
        let count = candidate.term.driver.len(self.statics);
        let direction = strongest(scorer.linear, candidate, coefficients, &values, count);
        let here = along(scorer.linear, candidate, coefficients, &values, count, direction);
        let there = along(bare, candidate, coefficients, &values, count, direction);
        let after = projected(scorer.linear, &here, self.data.len());
        let before = projected(bare, &there, self.data.len());
        let most = after.iter().flatten().map(|(_, felt)| *felt).fold(0.0, f64::max);
        let driver = self.abscissa(candidate, &values, count);
        let of_row = |(row, seen): (usize, &Option<(f64, f64)>)| {
            let (left, felt) = (*seen)?;
            (felt > FEELS * most).then(|| PartialResidual {
                driver: driver.as_ref().map_or(here.amount[row], |(_, values)| values[row]),
                before: before[row].map(|(left, _)| left),
                partial: left + here.amount[row],
                model: here.amount[row],
                after: left,
            })
        };
        let points = after.iter().enumerate().filter_map(of_row).collect();
        let place = candidate.term.carrier.place(&self.statics.chain);
        let unit = candidate.term.carrier.unit(&self.statics.chain, direction);
        let (abscissa, ordinate) = if candidate.term.coupling == Coupling::Paired {
            ("the effect's contribution, in units of the noise".into(), "residual, in units of the noise".into())
        } else {
            let words = candidate.term.carrier.direction_name(direction).replace('_', " ");
            let does = || format!("the effect's contribution, {unit}");
            let ordinate = format!("{place} {words}, {unit}").replace(" ,", ",");
            (driver.map_or_else(does, |(abscissa, _)| abscissa), ordinate)
        };
        PartialResiduals { abscissa, ordinate, points }
    }

    /// The driver as one number per row, with its name and unit; `None` if it has several numbers.
    fn abscissa(&self, candidate: &Candidate, values: &[f64], count: usize) -> Option<(String, Vec<f64>)> {
        if candidate.term.coupling == Coupling::Paired {
            return None;
        }
        let rows = 0..self.data.len();
        let chain = &self.statics.chain;
        let driver = &candidate.term.driver;
        let of_joint = |joint: usize| {
            let name = format!("{}, {}", chain.joints()[joint].name, Driver::Reading(joint).unit(chain, 0));
            (name, rows.clone().map(|row| chain.joints()[joint].value(self.data.reading(row))).collect())
        };
        match driver {
            Driver::Reading(joint) | Driver::Harmonic { joint, .. } | Driver::Bump { joint, .. } => {
                Some(of_joint(*joint))
            }
            Driver::Decay { .. } | Driver::Steps { .. } | Driver::Smooth { .. } | Driver::Covariate(_) => {
                let name = driver.covariate()?;
                let unit = match driver {
                    Driver::Covariate(_) => driver.unit(chain, 0),
                    _ => denavit_identify::effects::driver::unit_of(name),
                };
                let column = self.data.covariate(name)?;
                Some((format!("{name}, {unit}"), column.values.clone()))
            }
            Driver::Torque(joint) | Driver::SprungTorque(joint) | Driver::HardeningTorque { joint, .. } => {
                let name = format!("gravity on {}, {}", chain.joints()[*joint].name, driver.unit(chain, 0));
                Some((name, rows.map(|row| values[row * count]).collect()))
            }
            Driver::Approach(Side { joint, .. })
            | Driver::GravitySide(joint)
            | Driver::FrictionSide { side: Side { joint, .. }, .. } => {
                let name = format!("side of {}", chain.joints()[*joint].name);
                Some((name, rows.map(|row| values[row * count]).collect()))
            }
            _ => None,
        }
    }
}

/// The direction of the carrier in which the effect is largest.
fn strongest(linear: &Linear, candidate: &Candidate, coefficients: &[f64], values: &[f64], count: usize) -> usize {
    let Some(carrier) = linear.columns_of(candidate.term.carrier) else { return 0 };
    if candidate.term.coupling == Coupling::Paired {
        return 0;
    }
    let does = |direction: usize| -> f64 {
        let column = linear.carriers.column(carrier.start + direction);
        let amount = |row: usize| dot(&coefficients[direction * count..], &values[row * count..(row + 1) * count]);
        linear.rows.iter().zip(column.iter()).map(|(row, unit)| (unit * amount(*row)).powi(2)).sum()
    };
    (0..carrier.len()).max_by(|a, b| does(*a).total_cmp(&does(*b))).unwrap_or(0)
}

fn along(
    linear: &Linear,
    candidate: &Candidate,
    coefficients: &[f64],
    values: &[f64],
    count: usize,
    strongest: usize,
) -> Along {
    let rows = values.len() / count.max(1);
    let Some(carrier) = linear.columns_of(candidate.term.carrier) else {
        return Along { column: vec![0.0; linear.rows.len()], amount: vec![0.0; rows] };
    };
    if candidate.term.coupling == Coupling::Each {
        let column = linear.carriers.column(carrier.start + strongest);
        let column = column.iter().take(linear.rows.len()).copied().collect();
        let amount = |row: usize| dot(&coefficients[strongest * count..], &values[row * count..(row + 1) * count]);
        return Along { column, amount: (0..rows).map(amount).collect() };
    }
    // All directions move together: along their common effect in each row, in units of the noise.
    let mut column: Vec<f64> = linear
        .rows
        .iter()
        .enumerate()
        .map(|(index, row)| {
            let value = |k: usize| linear.carriers[(index, carrier.start + k)] * values[row * count + k];
            coefficients[0] * (0..carrier.len().min(count)).map(value).sum::<f64>()
        })
        .collect();
    let mut amount = vec![0.0; rows];
    for (row, cell) in linear.rows.iter().zip(&column) {
        amount[*row] += cell * cell;
    }
    for amount in &mut amount {
        *amount = amount.sqrt();
    }
    for (row, cell) in linear.rows.iter().zip(&mut column) {
        *cell /= amount[*row].max(f64::MIN_POSITIVE);
    }
    Along { column, amount }
}

/// By data row: the residual along a column, and the row's sensitivity to it. `None`: all values of the row were rejected.
fn projected(linear: &Linear, along: &Along, rows: usize) -> Vec<Option<(f64, f64)>> {
    let mut sums: Vec<(f64, f64)> = vec![(0.0, 0.0); rows];
    for ((row, cell), left) in linear.rows.iter().zip(&along.column).zip(linear.residual.iter()) {
        sums[*row].0 += cell * left;
        sums[*row].1 += cell * cell;
    }
    sums.into_iter().map(|(product, square)| (square > 0.0).then(|| (product / square, square.sqrt()))).collect()
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
