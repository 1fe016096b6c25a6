//! Rows of a Jacobian gathered until there are enough to form their products in vectors of the machine.

#![expect(clippy::inline_always, reason = "SIMD code must be compiled into the function that enables the instructions")]

use crate::normal::Channel;
use crate::parameters::{Layout, ParameterKind};
use fearless_simd::{Level, Simd, SimdBase as _, SimdFloat as _, dispatch};

/// Rows that are gathered: with forty columns 30 KB, which the cache nearest to the processor holds.
const ROWS: usize = 96;
/// Columns of a tile of the products: one vector of 512 bits or more of narrower ones.
const TILE: usize = 8;
/// Rows of a tile: as many sums as registers hold.
const TILE_ROWS: usize = 4;

/// Which part of an observation a row belongs to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Part {
    /// Position or distance.
    Place,
    /// Orientation.
    Turn,
}

impl Part {
    /// Whether a parameter moves it at all.
    fn depends_on(self, kind: ParameterKind) -> bool {
        match self {
            Self::Place => !matches!(kind, ParameterKind::TargetTurn { .. }),
            Self::Turn => match kind {
                ParameterKind::Move { .. }
                | ParameterKind::Pitch { .. }
                | ParameterKind::Anchor { .. }
                | ParameterKind::Target { .. } => false,
                ParameterKind::Instrument { component } => component < 3,
                _ => true,
            },
        }
    }
}

/// Weighted rows `[J | r]` and the sums of their products so far. Columns that are always 0 are left out.
#[derive(Debug, Clone)]
pub(crate) struct Panel {
    /// Column of the Jacobian for each column of the panel; the residual's comes after them, then zeros.
    columns: Vec<usize>,
    /// As many of them are the Jacobian's first.
    leading: usize,
    all: usize,
    width: usize,
    /// Rows in `cells`.
    rows: usize,
    cells: Vec<f64>,
    /// Upper triangle, width × width.
    sums: Vec<f64>,
    count: f64,
}

impl Panel {
    pub(crate) fn new(layout: &Layout, part: Part) -> Self {
        let columns: Vec<usize> =
            (0..layout.len()).filter(|&column| part.depends_on(layout.parameters[column].kind)).collect();
        let leading = columns.iter().enumerate().take_while(|(index, column)| index == *column).count();
        let width = (columns.len() + 1).next_multiple_of(TILE);
        let (cells, sums) = (vec![0.0; ROWS * width], vec![0.0; width * width]);
        Self { columns, leading, all: layout.len(), width, rows: 0, cells, sums, count: 0.0 }
    }

    /// Adds one value or three of one weight: `jacobian` holds as many rows.
    pub(crate) fn take(&mut self, residual: &[f64], jacobian: &[f64], weight: f64) {
        self.count += weight * residual.len() as f64;
        let factor = weight.sqrt();
        for (r, row) in residual.iter().zip(jacobian.chunks_exact(self.all)) {
            let line = &mut self.cells[self.rows * self.width..(self.rows + 1) * self.width];
            let (cells, rest) = line.split_at_mut(self.columns.len());
            let (leading, scattered) = cells.split_at_mut(self.leading);
            for (cell, value) in leading.iter_mut().zip(row) {
                *cell = factor * value;
            }
            for (cell, &column) in scattered.iter_mut().zip(&self.columns[self.leading..]) {
                *cell = factor * row[column];
            }
            rest[0] = factor * r;
            self.rows += 1;
        }
        if self.rows + 3 > ROWS {
            self.flush();
        }
    }

    fn flush(&mut self) {
        let cells = &self.cells[..self.rows * self.width];
        dispatch!(Level::new(), simd => add_products(simd, cells, self.width, &mut self.sums));
        self.rows = 0;
    }

    /// The sums over all rows taken.
    pub(crate) fn finish(mut self) -> Channel {
        self.flush();
        let mut channel = Channel::zeros(self.all);
        let residual = self.columns.len();
        for (i, &to) in self.columns.iter().enumerate() {
            for (k, &other) in self.columns.iter().enumerate().skip(i) {
                channel.matrix[to * self.all + other] = self.sums[i * self.width + k];
            }
            channel.gradient[to] = self.sums[i * self.width + residual];
        }
        channel.cost = self.sums[residual * self.width + residual];
        channel.count = self.count;
        channel
    }
}

/// Adds to `sums` the upper triangle of Aᵀ A, A the rows of `width` cells; some cells below it are touched, too.
#[inline(always)]
fn add_products<S: Simd>(simd: S, cells: &[f64], width: usize, sums: &mut [f64]) {
    for right in (0..width).step_by(TILE) {
        for left in (0..right + TILE).step_by(TILE_ROWS) {
            match TILE / S::f64s::LEN {
                1 => add_tile::<S, 1>(simd, cells, width, (left, right), sums),
                2 => add_tile::<S, 2>(simd, cells, width, (left, right), sums),
                _ => add_tile::<S, 4>(simd, cells, width, (left, right), sums),
            }
        }
    }
}

/// One tile, `VECTORS` vectors wide.
#[inline(always)]
fn add_tile<S: Simd, const VECTORS: usize>(
    simd: S,
    cells: &[f64],
    width: usize,
    (left, right): (usize, usize),
    sums: &mut [f64],
) {
    let lanes = S::f64s::LEN;
    let mut tile = [[S::f64s::splat(simd, 0.0); VECTORS]; TILE_ROWS];
    for row in cells.chunks_exact(width) {
        let (row_left, row_right) = (&row[left..left + TILE_ROWS], &row[right..right + TILE]);
        for v in 0..VECTORS {
            let cell = S::f64s::from_slice(simd, &row_right[v * lanes..(v + 1) * lanes]);
            for k in 0..TILE_ROWS {
                tile[k][v] = cell.mul_add(row_left[k], tile[k][v]);
            }
        }
    }
    for (k, tile) in tile.iter().enumerate() {
        let line = &mut sums[(left + k) * width + right..(left + k) * width + right + TILE];
        for (sum, part) in line.chunks_exact_mut(lanes).zip(tile) {
            (S::f64s::from_slice(simd, sum) + *part).store_slice(sum);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measurements::MeasurementKind;
    use crate::parameters::{Freedom, Tolerances};
    use denavit_model::examples;

    #[test]
    fn sums_are_those_of_the_rows_one_by_one() {
        let chain = examples::puma_like();
        let freedom = Freedom::axes(chain.joints().len());
        let targets = [String::new()];
        let layout = Layout::new(&chain, MeasurementKind::Pose, &targets, &freedom, &Tolerances::default(), Vec::new());
        let n = layout.len();
        let mut panel = Panel::new(&layout, Part::Place);
        let mut expected = vec![0.0; (n + 1) * (n + 1)];
        for observation in 0..50 {
            let weight = if observation % 7 == 0 { 0.3 } else { 1.0 };
            let value = |k: usize| ((observation * 31 + k * 7) as f64 * 0.37).sin();
            let residual = [value(1000), value(1001), value(1002)];
            let mut jacobian: Vec<f64> = (0..3 * n).map(value).collect();
            for (column, parameter) in layout.parameters.iter().enumerate() {
                if !Part::Place.depends_on(parameter.kind) {
                    (0..3).for_each(|row| jacobian[row * n + column] = 0.0);
                }
            }
            panel.take(&residual, &jacobian, weight);
            for (row, r) in jacobian.chunks_exact(n).zip(residual) {
                let line: Vec<f64> = row.iter().copied().chain([r]).collect();
                for i in 0..=n {
                    for k in i..=n {
                        expected[i * (n + 1) + k] += weight * line[i] * line[k];
                    }
                }
            }
        }
        let found = panel.finish();
        let near = |a: f64, b: f64| assert!((a - b).abs() < 1e-12 * (1.0 + b.abs()), "{a} {b}");
        for i in 0..n {
            near(found.gradient[i], expected[i * (n + 1) + n]);
            (i..n).for_each(|k| near(found.matrix[i * n + k], expected[i * (n + 1) + k]));
        }
        near(found.cost, expected[n * (n + 1) + n]);
        near(found.count, (8.0 * 0.3 + 42.0) * 3.0);
    }
}
