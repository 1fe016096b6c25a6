//! What acts at one carrier, against a model. A column is what the carrier does to each value times what drives it in the value's row: so
//! of the carrier's columns only the products within rows count, and these are formed once for all that drives it.

use crate::effects::carrier::Carrier;
use crate::effects::model::Coupling;
use crate::identify::gram::cross_gram;
use crate::trace::linear::Linear;
use crate::trace::projector::{Products, Projector};

/// Products of a carrier's columns within rows.
pub(crate) struct ByCarrier {
    /// The rows of the data that have values.
    rows: Vec<usize>,
    /// Of each direction with the model's basis and, last, with what the model leaves: a column of each, row by row.
    with_model: Vec<Vec<f64>>,
    /// Of each direction with each, row by row.
    own: Vec<Vec<Vec<f64>>>,
    rank: usize,
}

/// What drives the columns of one term: so many values per row of the data.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Driven<'a> {
    pub(crate) coupling: Coupling,
    pub(crate) per_row: usize,
    pub(crate) values: &'a [f64],
}

impl ByCarrier {
    /// Those of a carrier; one that the linearisation does not have has no directions.
    pub(crate) fn of(linear: &Linear, model: &Projector, carrier: Carrier) -> Self {
        let mut rows: Vec<usize> = linear.rows.clone();
        rows.dedup();
        let stretches: Vec<std::ops::Range<usize>> = linear
            .rows
            .chunk_by(|a, b| a == b)
            .scan(0, |from, row| {
                *from += row.len();
                Some(*from - row.len()..*from)
            })
            .collect();
        let directions = linear.columns_of(carrier).unwrap_or_default();
        let column = |direction: usize| &linear.carriers.as_slice()[direction * linear.residual.len()..];
        let within = |a: &[f64], b: &[f64], out: &mut Vec<f64>| {
            let product = |own: &std::ops::Range<usize>| -> f64 {
                a[own.clone()].iter().zip(&b[own.clone()]).map(|(a, b)| a * b).sum()
            };
            out.extend(stretches.iter().map(product));
        };
        let with_model = |direction: usize| {
            let mut cells = Vec::with_capacity((model.rank() + 1) * rows.len());
            let basis = (0..model.rank()).map(|k| model.direction(k));
            basis.chain([model.residual.as_slice()]).for_each(|other| within(other, column(direction), &mut cells));
            cells
        };
        let own = |direction: usize| {
            let with = |other: usize| {
                let mut cells = Vec::with_capacity(rows.len());
                within(column(direction), column(other), &mut cells);
                cells
            };
            directions.clone().map(with).collect()
        };
        Self {
            with_model: directions.clone().map(with_model).collect(),
            own: directions.clone().map(own).collect(),
            rank: model.rank(),
            rows,
        }
    }

    /// The products of terms' columns with the model, term by term.
    pub(crate) fn products(&self, terms: &[Driven<'_>]) -> Products {
        let count = self.rows.len();
        let mut driving = Vec::with_capacity(count * terms.iter().map(|term| term.per_row).sum::<usize>());
        for term in terms {
            for value in 0..term.per_row {
                driving.extend(self.rows.iter().map(|row| term.values[row * term.per_row + value]));
            }
        }
        let lines = self.rank + 1;
        let along: Vec<Vec<f64>> = self.with_model.iter().map(|table| cross_gram(table, &driving, count)).collect();
        let mut all = Products::default();
        let mut first = 0;
        for term in terms {
            let own = first..first + term.per_row;
            first = own.end;
            let driving = &driving[own.start * count..own.end * count];
            let of = |direction: usize, value: usize| &along[direction][(own.start + value) * lines..][..lines];
            match term.coupling {
                Coupling::Each => {
                    let columns: Vec<&[f64]> = (0..self.with_model.len())
                        .flat_map(|direction| (0..term.per_row).map(move |value| (direction, value)))
                        .map(|(direction, value)| of(direction, value))
                        .collect();
                    all.push(&columns, &self.squares(driving, term.per_row));
                }
                Coupling::Paired => {
                    let pairs = self.with_model.len().min(term.per_row);
                    let mut column = vec![0.0; lines];
                    for pair in 0..pairs {
                        column.iter_mut().zip(of(pair, pair)).for_each(|(sum, cell)| *sum += cell);
                    }
                    let squares = self.squares(driving, term.per_row);
                    let (width, place) =
                        (self.with_model.len() * term.per_row, |pair: usize| pair * term.per_row + pair);
                    let cells = (0..pairs).flat_map(|a| (0..pairs).map(move |b| (place(a), place(b))));
                    all.push(&[&column], &[cells.map(|(a, b)| squares[a * width + b]).sum()]);
                }
            }
        }
        all
    }

    /// Products of the columns of each direction and value with one another, square.
    fn squares(&self, driving: &[f64], per_row: usize) -> Vec<f64> {
        let (count, directions) = (self.rows.len(), self.own.len());
        let width = directions * per_row;
        let mut squares = vec![0.0; width * width];
        for a in 0..directions {
            for b in 0..=a {
                let shared = self.own[a][b].iter().cycle();
                let scaled: Vec<f64> = driving.iter().zip(shared).map(|(value, shared)| value * shared).collect();
                let block = cross_gram(driving, &scaled, count);
                for (k, line) in block.chunks_exact(per_row.max(1)).enumerate() {
                    for (l, cell) in line.iter().enumerate() {
                        squares[(a * per_row + k) * width + b * per_row + l] = *cell;
                        squares[(b * per_row + l) * width + a * per_row + k] = *cell;
                    }
                }
            }
        }
        squares
    }
}
