//! Products of all columns of the linearised model with each other and with the residual. They are formed once; the cost of a score
//! then does not depend on the number of rows.
//!
//! A curve's columns are the joint's column times its waves at the row's reading. So only one product of joint columns is
//! taken per row and pair of joints, and the waves are multiplied with that.

use denavit_identify::effects::curve::Waves;
use denavit_linear::products::{cross_gram, gram_of};
use denavit_linear::stop::check_cancelled;
use denavit_linear::threads::{available, par_map};
use denavit_linear::triangle::dot;

/// Rows whose waves are computed at once: they fit into the processor's cache.
const ROWS: usize = 256;
/// Largest number of partial sums held at once.
const PARTIAL_SUMS: usize = 8;

/// The linearised model, value by value, in units of the noise.
#[derive(Debug, Clone, Copy)]
pub struct Columns<'a> {
    /// The residual.
    pub explained: &'a [f64],
    /// Columns of geometry, frames and effects.
    pub plain: &'a [&'a [f64]],
    /// The column of each curve's joint.
    pub joints: &'a [&'a [f64]],
    /// The row of each value, ascending.
    pub rows: &'a [usize],
    /// Each value's weight.
    pub weights: &'a [f64],
}

/// Products of all columns.
#[derive(Debug, Clone)]
pub struct Gram {
    /// Lower triangle, row by row: plain columns first, then curve by curve.
    pub matrix: Vec<f64>,
    /// With the residual.
    pub right: Vec<f64>,
    /// Of the residual with itself.
    pub square: f64,
    /// Values, weighted.
    pub count: f64,
    /// How many columns are plain.
    pub plain: usize,
    /// How many columns there are.
    pub size: usize,
}

impl Gram {
    fn zeros(plain: usize, size: usize) -> Self {
        // Written directly: adding to zeroed memory from the system costs twice as much.
        let matrix = std::iter::repeat_n(0.0, size * size).collect();
        Self { matrix, right: vec![0.0; size], square: 0.0, count: 0.0, plain, size }
    }

    fn add(&mut self, other: &Self, weight: f64) {
        let add = |sums: &mut [f64], parts: &[f64]| {
            sums.iter_mut().zip(parts).for_each(|(sum, part)| *sum += part * weight);
        };
        let rows = self.matrix.chunks_exact_mut(self.size).zip(other.matrix.chunks_exact(self.size));
        rows.enumerate().for_each(|(row, (sums, parts))| add(&mut sums[..=row], &parts[..=row]));
        add(&mut self.right, &other.right);
        self.square += other.square * weight;
        self.count += other.count * weight;
    }

    /// The weighted sum of the products of several parts of the values.
    ///
    /// # Panics
    /// There is no part.
    pub fn weighted(parts: &[Self], weights: &[f64]) -> Self {
        let mut sum = Self::zeros(parts[0].plain, parts[0].size);
        for (part, weight) in parts.iter().zip(weights).filter(|(_, weight)| **weight != 0.0) {
            sum.add(part, *weight);
        }
        sum
    }

    /// The products of `columns`; `readings[curve][row]` is what each curve is a function of.
    pub fn of(columns: &Columns<'_>, waves: &[Waves], readings: &[Vec<f64>]) -> Self {
        let plain = columns.plain.len();
        let size = plain + waves.iter().map(Waves::len).sum::<usize>();
        // Stretches of values that cover whole rows.
        let mut stretches = Vec::new();
        let mut from = 0;
        while from < columns.rows.len() {
            let last = columns.rows[from] + ROWS;
            let to = from + columns.rows[from..].partition_point(|row| *row < last);
            stretches.push(from..to);
            from = to;
        }
        // Partial sums, each of every `parts`th stretch, added in order: no sum depends on the timing of the threads.
        let parts = stretches.len().clamp(1, PARTIAL_SUMS);
        let partial = |part: usize| {
            let mut sums = Self::zeros(plain, size);
            for range in stretches.iter().skip(part).step_by(parts) {
                check_cancelled();
                add_stretch(columns, waves, readings, range.clone(), &mut sums);
            }
            sums
        };
        let mut done = par_map(0..parts, available().min(parts), || (), |(), part| partial(part)).into_iter();
        let mut sum = done.next().expect("there is a part");
        done.for_each(|part| sum.add(&part, 1.0));
        sum
    }

    /// The product of two columns.
    pub fn cell(&self, i: usize, k: usize) -> f64 {
        self.matrix[i.max(k) * self.size + i.min(k)]
    }

    /// |y - X m|² from the products alone.
    pub fn misfit(&self, mean: &[f64]) -> f64 {
        let mut sum = self.square;
        for (i, row) in self.matrix.chunks_exact(self.size).enumerate() {
            sum += mean[i] * (2.0 * dot(&row[..i], &mean[..i]) + row[i] * mean[i] - 2.0 * self.right[i]);
        }
        sum
    }
}

fn add_stretch(
    columns: &Columns<'_>,
    waves: &[Waves],
    readings: &[Vec<f64>],
    own: std::ops::Range<usize>,
    sums: &mut Gram,
) {
    let (plain, size) = (columns.plain.len(), sums.right.len());
    let explained = &columns.explained[own.clone()];
    let cells: Vec<f64> = columns.plain.iter().flat_map(|column| &column[own.clone()]).copied().collect();
    sums.square += explained.iter().map(|y| y * y).sum::<f64>();
    sums.count += columns.weights[own.clone()].iter().sum::<f64>();
    let of_plain = gram_of(&cells, own.len());
    for row in 0..plain {
        for column in 0..=row {
            sums.matrix[row * size + column] += of_plain[row * plain + column];
        }
    }
    for (sum, part) in sums.right.iter_mut().zip(cross_gram(&cells, explained, own.len())) {
        *sum += part;
    }
    // From here on one line per row: the place of each value's row among them.
    let mut rows: Vec<usize> = Vec::new();
    let place: Vec<usize> = columns.rows[own.clone()]
        .iter()
        .map(|row| {
            if rows.last() != Some(row) {
                rows.push(*row);
            }
            rows.len() - 1
        })
        .collect();
    let count = rows.len();
    let per_row = |a: &[f64], b: &[f64], out: &mut [f64]| {
        for ((a, b), &place) in a.iter().zip(b).zip(&place) {
            out[place] += a * b;
        }
    };
    let joints: Vec<&[f64]> = columns.joints.iter().map(|column| &column[own.clone()]).collect();
    let waves_at: Vec<Vec<f64>> = waves
        .iter()
        .zip(readings)
        .map(|(waves, readings)| {
            let mut at = vec![0.0; waves.len() * count];
            let mut values = vec![0.0; waves.len()];
            for (line, &row) in rows.iter().enumerate() {
                waves.values_into(readings[row], &mut values);
                for (wave, value) in values.iter().enumerate() {
                    at[wave * count + line] = *value;
                }
            }
            at
        })
        .collect();
    let mut first = plain;
    for (i, own_waves) in waves_at.iter().enumerate() {
        let many = waves[i].len();
        let mut driven = vec![0.0; (plain + 1) * count];
        for (column, out) in driven.chunks_exact_mut(count).enumerate() {
            let other = if column < plain { &cells[column * own.len()..(column + 1) * own.len()] } else { explained };
            per_row(joints[i], other, out);
        }
        for (line, cells) in cross_gram(&driven, own_waves, count).chunks_exact(plain + 1).enumerate() {
            let row = first + line;
            for (sum, cell) in sums.matrix[row * size..].iter_mut().zip(&cells[..plain]) {
                *sum += cell;
            }
            sums.right[row] += cells[plain];
        }
        let mut column = plain;
        for (j, other_waves) in waves_at.iter().enumerate().take(i + 1) {
            let mut scale = vec![0.0; count];
            per_row(joints[i], joints[j], &mut scale);
            let scaled: Vec<f64> =
                own_waves.chunks_exact(count).flat_map(|wave| wave.iter().zip(&scale).map(|(b, s)| b * s)).collect();
            let block = cross_gram(other_waves, &scaled, count);
            for (line, cells) in block.chunks_exact(waves[j].len()).enumerate() {
                let row = first + line;
                for (sum, cell) in sums.matrix[row * size + column..].iter_mut().zip(cells) {
                    *sum += cell;
                }
            }
            column += waves[j].len();
        }
        first += many;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn products_are_those_of_the_columns_written_out() {
        let rows: Vec<usize> = (0..600).flat_map(|row| [row; 6]).collect();
        let cell = |value: usize, k: usize| ((value * 7 + k * 13) as f64 * 0.61).sin();
        let column = |k: usize| -> Vec<f64> { (0..rows.len()).map(|value| cell(value, k)).collect() };
        let (y, plain, joints) = (column(0), [column(1), column(2)], [column(3), column(4)]);
        let weights = vec![1.0; rows.len()];
        let waves = [Waves::over(0.0, 1.0, false, 12.0, 9), Waves::over(-4.0, 4.0, true, 3.0, 9)];
        let readings: Vec<Vec<f64>> =
            (0..2).map(|k| (0..600).map(|row| 0.5 + 0.5 * cell(row, 9 + k)).collect()).collect();
        let columns = Columns {
            explained: &y,
            plain: &plain.each_ref().map(Vec::as_slice),
            joints: &joints.each_ref().map(Vec::as_slice),
            rows: &rows,
            weights: &weights,
        };
        let gram = Gram::of(&columns, &waves, &readings);
        let written = |value: usize| -> Vec<f64> {
            let mut cells = vec![plain[0][value], plain[1][value]];
            for k in 0..2 {
                cells.extend(waves[k].values(readings[k][rows[value]]).iter().map(|b| b * joints[k][value]));
            }
            cells
        };
        assert_eq!(gram.count, rows.len() as f64);
        let all = || (0..rows.len()).map(|value| (value, written(value)));
        for a in 0..gram.size {
            let right: f64 = all().map(|(value, own)| own[a] * y[value]).sum();
            assert!((gram.right[a] - right).abs() < 1e-9);
            for b in 0..=a {
                let sum: f64 = all().map(|(_, own)| own[a] * own[b]).sum();
                assert!((gram.cell(b, a) - sum).abs() < 1e-9, "{a} {b}");
            }
        }
        let mean: Vec<f64> = (0..gram.size).map(|k| cell(k, 31)).collect();
        let left = |(value, own): (usize, Vec<f64>)| y[value] - own.iter().zip(&mean).map(|(x, m)| x * m).sum::<f64>();
        let misfit: f64 = all().map(|own| left(own).powi(2)).sum();
        assert!((gram.misfit(&mean) - misfit).abs() < 1e-8 * misfit);
    }
}
