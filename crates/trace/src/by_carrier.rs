//! Fast products of all terms at one carrier with a model. A term's column is the carrier's column times the driver's value in each row, so
//! the carrier's products are formed once within each row and reused for every driver.

use crate::linear::Linear;
use crate::projector::{Products, Projector};
use denavit_identify::effects::carrier::Carrier;
use denavit_identify::effects::model::Coupling;
use denavit_linear::panel::{Line, PANEL, each_sum};
use denavit_linear::products::cross_gram;
use fearless_simd::{Level, dispatch};
use std::ops::Range;

/// A model, prepared for products within rows.
pub(crate) struct ByRow<'a> {
    linear: &'a Linear,
    /// The rows of the data that have values, and those.
    rows: Vec<usize>,
    values: Vec<Range<usize>>,
    model: &'a Projector,
}

/// Products of a carrier's columns within rows.
pub(crate) struct ByCarrier<'a> {
    by_row: &'a ByRow<'a>,
    /// Of each direction with the panels of the model, row by row.
    with_model: Vec<Vec<Vec<Line>>>,
    /// Of each direction with each, row by row.
    own: Vec<Vec<Vec<f64>>>,
}

/// Driver values of one term: a number of values per row of the data.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Driven<'a> {
    pub(crate) coupling: Coupling,
    pub(crate) per_row: usize,
    pub(crate) values: &'a [f64],
}

/// Indices of the terms at the same carrier, carrier by carrier.
pub(crate) fn alike(carriers: impl Iterator<Item = Carrier>) -> Vec<(Carrier, Vec<usize>)> {
    let mut alike: Vec<(Carrier, Vec<usize>)> = Vec::new();
    for (place, carrier) in carriers.enumerate() {
        match alike.iter_mut().find(|(known, _)| *known == carrier) {
            Some((_, own)) => own.push(place),
            None => alike.push((carrier, vec![place])),
        }
    }
    alike
}

impl<'a> ByRow<'a> {
    pub(crate) fn new(linear: &'a Linear, model: &'a Projector) -> Self {
        let mut rows: Vec<usize> = linear.rows.clone();
        rows.dedup();
        let mut values: Vec<Range<usize>> = Vec::with_capacity(rows.len());
        for row in linear.rows.chunk_by(|a, b| a == b) {
            let from = values.last().map_or(0, |last| last.end);
            values.push(from..from + row.len());
        }
        Self { linear, rows, values, model }
    }

    /// Products with a carrier's columns; a carrier that the linearisation does not have has none.
    pub(crate) fn with(&self, carrier: Carrier) -> ByCarrier<'_> {
        let linear = self.linear;
        let directions = linear.columns_of(carrier).unwrap_or_default();
        let column = |direction: usize| &linear.carriers.as_slice()[direction * linear.residual.len()..];
        let with_model = |direction: usize| {
            let panel = |lines: &Vec<Line>| {
                let mut sums = vec![[0.0; PANEL]; self.rows.len()];
                dispatch!(Level::new(), _simd => within(&self.values, lines, column(direction), &mut sums));
                sums
            };
            self.model.panels().iter().map(panel).collect()
        };
        let own = |direction: usize| {
            let with = |other: usize| {
                let (a, b) = (column(direction), column(other));
                let product = |own: &Range<usize>| -> f64 {
                    a[own.clone()].iter().zip(&b[own.clone()]).map(|(a, b)| a * b).sum()
                };
                self.values.iter().map(product).collect()
            };
            directions.clone().map(with).collect()
        };
        ByCarrier {
            by_row: self,
            with_model: directions.clone().map(with_model).collect(),
            own: directions.clone().map(own).collect(),
        }
    }
}

/// Sums over the values of each row of lines times a column's cells.
#[expect(clippy::inline_always, reason = "SIMD code must be compiled into the function that enables the instructions")]
#[inline(always)]
fn within(values: &[Range<usize>], lines: &[Line], column: &[f64], sums: &mut [Line]) {
    for (own, sum) in values.iter().zip(sums) {
        for (line, times) in lines[own.clone()].iter().zip(&column[own.clone()]) {
            sum.iter_mut().zip(line).for_each(|(sum, cell)| *sum += times * cell);
        }
    }
}

impl ByCarrier<'_> {
    /// The products of terms' columns with the model, term by term.
    pub(crate) fn products(&self, terms: &[Driven<'_>]) -> Products {
        let rows = &self.by_row.rows;
        let count = rows.len();
        let mut driving = Vec::with_capacity(count * terms.iter().map(|term| term.per_row).sum::<usize>());
        for term in terms {
            for value in 0..term.per_row {
                driving.extend(rows.iter().map(|row| term.values[row * term.per_row + value]));
            }
        }
        let lines = self.by_row.model.rank() + 1;
        let products: Vec<Vec<f64>> = self.with_model.iter().map(|panels| along(panels, &driving, lines)).collect();
        let mut all = Products::default();
        let mut first = 0;
        for term in terms {
            let own = first..first + term.per_row;
            first = own.end;
            let driving = &driving[own.start * count..own.end * count];
            let of = |direction: usize, value: usize| &products[direction][(own.start + value) * lines..][..lines];
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
        let (count, directions) = (self.by_row.rows.len(), self.own.len());
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

/// Products of `lines` columns, in panels, with others, column by column of the latter.
fn along(panels: &[Vec<Line>], columns: &[f64], lines: usize) -> Vec<f64> {
    let rows = panels[0].len();
    let mut result = vec![0.0; lines * columns.len() / rows.max(1)];
    for (panel, cells) in panels.iter().enumerate().filter(|_| rows > 0) {
        let own = panel * PANEL..((panel + 1) * PANEL).min(lines);
        dispatch!(Level::new(), simd => each_sum(simd, columns, rows, cells, |column, sums| {
            result[column * lines..][own.clone()].copy_from_slice(&sums[..own.len()]);
        }));
    }
    result
}

#[cfg(test)]
mod tests {
    use crate::TraceOptions;
    use crate::projector::{Products, Projector, UNSEEN};
    use crate::tracer::Tracer;
    use denavit_identify::effects::driver::Statics;
    use denavit_identify::effects::survey::with_run_order;
    use denavit_identify::parameters::NoEffects;
    use denavit_identify::simulate::{SimulationOptions, simulate};
    use denavit_identify::{IdentifyOptions, identify};
    use denavit_measurements::kinds::ObservationKind;
    use denavit_model::examples;
    use denavit_model::nalgebra::DVector;

    /// Every candidate of the catalogue, with outliers whose rows are left out, beside a model with an effect of its own.
    #[test]
    fn products_within_rows_are_those_of_the_columns_written_out() {
        for (chain, kind) in
            [(examples::puma_like(), ObservationKind::Pose), (examples::rail_arm(), ObservationKind::Position)]
        {
            let options = SimulationOptions { kind, rows: 60, targets: 2, outliers: 0.05, ..Default::default() };
            let data = with_run_order(simulate(&chain, &options, &NoEffects).data);
            let statics = Statics::of_chain(&chain);
            let options = TraceOptions::new(IdentifyOptions::axes(&chain));
            let geometric = identify(&chain, &data, &options.identify).geometric;
            let tracer = Tracer::new(&statics, &data, &geometric, &options);
            let state = tracer.refitted(vec![tracer.candidates[7].clone()], None);
            let linear = tracer.linear(&state);
            let coefficients = DVector::from_column_slice(&state.fit.effects.effects[0].coefficients);
            let residual = &linear.residual - &linear.effects * coefficients;
            let (scorer, projector) = (tracer.scorer(linear), Projector::new(&[&linear.geometry], &residual));
            let mut seen = 0;
            for scored in tracer.scored(&state, &tracer.loosely_without(&state, &[0])) {
                let columns = scorer.columns(&scored.candidate.term);
                let written = Products::of(&projector, columns.as_slice(), &[columns.ncols()]).gains(UNSEEN)[0];
                let name = format!("{:?}", scored.candidate.term);
                assert_eq!(scored.gain.rank, written.rank, "{name}");
                let off = (scored.gain.drop - written.drop).abs();
                assert!(off < 1e-6 * (1.0 + written.drop), "{name}: {} {}", scored.gain.drop, written.drop);
                seen += written.rank;
            }
            assert!(seen > tracer.candidates.len() / 2, "{seen} of {}", tracer.candidates.len());
        }
    }
}
