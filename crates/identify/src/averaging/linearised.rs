//! Measured rows as y = X b + e, linearised about the current model.

use crate::arm::Arm;
use crate::effects::everything::Everything;
use crate::parameters::{Effects as _, Layout};
use crate::residual::ResidualModel;
use denavit_linear::threads::in_stretches;
use denavit_measurements::Measurements;
use denavit_model::nalgebra::{DMatrix, DVector};
use std::ops::Range;

/// Some rows, linearised.
///
/// With r the residual at numbers b₀ and J its derivatives, r + J (b - b₀) = e: y = r - J b₀, X = -J. The numbers of the model come first,
/// then the unknowns of instruments, points and targets, relative to their current values.
pub struct Linearised {
    /// X.
    pub columns: DMatrix<f64>,
    /// y, m and rad.
    pub data: DVector<f64>,
    /// The values of each row; rows that see several tips in one posture are joined, known lengths are rows of their own.
    pub rows: Vec<Range<usize>>,
    /// The noise channel of each value; `None`: its standard deviation is 1.
    pub channels: Vec<Option<usize>>,
    /// Weight of each row.
    pub weights: Vec<f64>,
    /// The data rows in each, and their numbers of values; none for a known length.
    pub sources: Vec<Vec<(usize, usize)>>,
    /// Number of columns of the model.
    pub of_model: usize,
}

struct Stretch {
    residual: Vec<f64>,
    cells: Vec<f64>,
    channels: Vec<Option<usize>>,
    heights: Vec<usize>,
    weights: Vec<f64>,
    sources: Vec<usize>,
}

/// Linearises these rows. `observed`: weight of each observation, 0 to leave it out; `weights`: of each row.
pub fn linearised(
    data: &Measurements,
    rows: &[usize],
    (arm, model, layout): (&Arm, &Everything, &Layout),
    (observed, weights): (&[f64], &[f64]),
) -> Linearised {
    let problem = ResidualModel { data, layout, effects: model };
    let columns = layout.len();
    let one = |scratch: &mut _, range: Range<usize>| {
        let tallest = data.tallest_row();
        let (mut residual, mut jacobian) = (vec![0.0; tallest], vec![0.0; tallest * columns]);
        let mut found = Stretch {
            residual: vec![],
            cells: vec![],
            channels: vec![],
            heights: vec![],
            weights: vec![],
            sources: vec![],
        };
        for &row in &rows[range] {
            problem.row_into(arm, row, scratch, &mut residual, Some(&mut jacobian));
            let (mut first, before) = (0, found.residual.len());
            for observation in data.of_row(row) {
                let series = data.series_of(observation);
                let lines = first..first + series.kind.height();
                first = lines.end;
                if observed[observation] <= 0.0 {
                    continue;
                }
                for (k, line) in lines.enumerate() {
                    found.residual.push(residual[line]);
                    found.cells.extend_from_slice(&jacobian[line * columns..(line + 1) * columns]);
                    found.channels.push(series.channels[usize::from(k >= series.kind.place().height)]);
                }
            }
            if found.residual.len() > before {
                found.heights.push(found.residual.len() - before);
                found.weights.push(weights[row]);
                found.sources.push(row);
            }
        }
        found
    };
    let stretches = in_stretches(rows.len(), || problem.scratch(arm), one);
    let known = layout.known_lengths(&data.scene, arm);
    let values: usize = stretches.iter().map(|stretch| stretch.residual.len()).sum::<usize>() + known.len();
    let mut result = Linearised {
        columns: DMatrix::zeros(values, columns),
        data: DVector::zeros(values),
        rows: Vec::new(),
        channels: Vec::with_capacity(values),
        weights: Vec::new(),
        sources: Vec::new(),
        of_model: layout.effects.len(),
    };
    let mut from = 0;
    for stretch in stretches {
        let count = stretch.residual.len();
        result.data.rows_mut(from, count).copy_from_slice(&stretch.residual);
        for (k, cells) in stretch.cells.chunks_exact(columns).enumerate() {
            cells.iter().enumerate().for_each(|(column, cell)| result.columns[(from + k, column)] = -cell);
        }
        result.channels.extend(stretch.channels);
        for ((height, weight), source) in stretch.heights.into_iter().zip(stretch.weights).zip(stretch.sources) {
            let values = from..from + height;
            from = values.end;
            let together = |of: &Vec<(usize, usize)>| {
                of.first().is_some_and(|(row, _)| data.same_posture_of_other_tip(*row, source))
            };
            if let Some(of) = result.sources.last_mut().filter(|of| together(of)) {
                of.push((source, height));
                let last = result.rows.len() - 1;
                result.rows[last].end = values.end;
                result.weights[last] += (weight - result.weights[last]) / of.len() as f64;
            } else {
                result.rows.push(values);
                result.weights.push(weight);
                result.sources.push(vec![(source, height)]);
            }
        }
    }
    for known in known {
        result.data[from] = known.residual;
        known.columns.iter().for_each(|(column, value)| result.columns[(from, *column)] = -value);
        result.rows.push(from..from + 1);
        result.channels.push(None);
        result.weights.push(1.0);
        result.sources.push(Vec::new());
        from += 1;
    }
    let numbers = DVector::from_vec(model.numbers());
    result.data += result.columns.columns(0, numbers.len()) * numbers;
    result
}
