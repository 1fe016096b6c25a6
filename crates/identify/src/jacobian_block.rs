//! Rows of a Jacobian, collected until there are enough to form their products in SIMD vectors.

use crate::parameters::{Layout, Parameter, ParameterKind};
use denavit_linear::products::{TILE, add_gram};
use denavit_measurements::kinds::Part;
use fearless_simd::{Simd, SimdBase as _};

/// Jᵀ W J, Jᵀ W r and rᵀ W r of one kind of value.
#[derive(Debug, Clone, PartialEq)]
pub struct Channel {
    /// Upper triangle of Jᵀ W J, columns × columns, row by row.
    pub matrix: Vec<f64>,
    /// Jᵀ W r.
    pub gradient: Vec<f64>,
    /// rᵀ W r.
    pub cost: f64,
    /// Sum of weights over values.
    pub count: f64,
}

impl Channel {
    pub(crate) fn zeros(columns: usize) -> Self {
        Self { matrix: vec![0.0; columns * columns], gradient: vec![0.0; columns], cost: 0.0, count: 0.0 }
    }

    pub(crate) fn add(&mut self, other: &Self) {
        for (sum, value) in self.matrix.iter_mut().zip(&other.matrix) {
            *sum += value;
        }
        for (sum, value) in self.gradient.iter_mut().zip(&other.gradient) {
            *sum += value;
        }
        self.cost += other.cost;
        self.count += other.count;
    }
}

/// Rows of a block: with forty columns 60 KB.
const ROWS: usize = 192;

/// A vector for each SIMD row.
pub(crate) type Triple<S> = [<S as Simd>::f64s; 3];

/// Whether a parameter moves a part of an observation at all.
fn depends_on(part: &Part, kind: ParameterKind) -> bool {
    if let ParameterKind::TargetTurn { .. } = kind {
        return part.by_turn;
    }
    if part.unit == "m" {
        return true;
    }
    match kind {
        ParameterKind::Move { .. }
        | ParameterKind::Pitch { .. }
        | ParameterKind::Point { .. }
        | ParameterKind::Target { .. } => false,
        ParameterKind::Instrument { component, .. } => component < 3,
        ParameterKind::Plane { component, .. } => component < 2,
        _ => true,
    }
}

/// Weighted rows `[J | r]`, column by column, and the sums of their products so far. Columns that are always 0 are left
/// out.
#[derive(Debug, Clone)]
pub(crate) struct JacobianBlock {
    /// Column of the block for each parameter.
    places: Vec<Option<usize>>,
    /// Column of the residual; the ones after it are zero.
    residual: usize,
    /// Rows in `cells`.
    rows: usize,
    cells: Vec<f64>,
    /// Products of columns l ≤ r, see [`add_gram`].
    sums: Vec<f64>,
    count: f64,
}

impl JacobianBlock {
    pub(crate) fn new(layout: &Layout, part: &Part) -> Self {
        let mut residual = 0usize;
        let place = |parameter: &Parameter| {
            depends_on(part, parameter.kind).then(|| {
                residual += 1;
                residual - 1
            })
        };
        let places = layout.parameters.iter().map(place).collect();
        let width = (residual + 1).next_multiple_of(TILE.0);
        let (cells, sums) = (vec![0.0; ROWS * width], vec![0.0; width * width]);
        Self { places, residual, rows: 0, cells, sums, count: 0.0 }
    }

    /// Adds one value or three of one weight: `jacobian` holds as many rows.
    pub(crate) fn take(&mut self, residual: &[f64], jacobian: &[f64], weight: f64) {
        self.make_room(residual.len());
        self.count += weight * residual.len() as f64;
        let factor = weight.sqrt();
        for (r, row) in residual.iter().zip(jacobian.chunks_exact(self.places.len())) {
            for (value, place) in row.iter().zip(&self.places) {
                if let Some(place) = place {
                    self.cells[place * ROWS + self.rows] = factor * value;
                }
            }
            self.cells[self.residual * ROWS + self.rows] = factor * r;
            self.rows += 1;
        }
    }

    /// Adds three values of each SIMD row: `of` gives the derivatives by a parameter, `factor` is the root of the weights.
    #[inline(always)]
    pub(crate) fn take_simd<S: Simd>(&mut self, residual: Triple<S>, factor: S::f64s, of: impl Fn(usize) -> Triple<S>) {
        self.make_room(3 * S::f64s::LEN);
        self.count += 3.0 * factor.as_slice().iter().map(|factor| factor * factor).sum::<f64>();
        let mut put = |column: usize, value: Triple<S>| {
            let start = column * ROWS + self.rows;
            let cells = &mut self.cells[start..start + 3 * S::f64s::LEN];
            for (cells, value) in cells.chunks_exact_mut(S::f64s::LEN).zip(value) {
                (value * factor).store_slice(cells);
            }
        };
        for (parameter, place) in self.places.iter().enumerate() {
            if let Some(place) = place {
                put(*place, of(parameter));
            }
        }
        put(self.residual, residual);
        self.rows += 3 * S::f64s::LEN;
    }

    fn make_room(&mut self, rows: usize) {
        if self.rows + rows > ROWS {
            add_gram(&self.cells, ROWS, self.rows, &mut self.sums);
            self.rows = 0;
        }
    }

    /// The sums over all rows taken.
    pub(crate) fn finish(mut self) -> Channel {
        self.make_room(ROWS + 1);
        let (all, width) = (self.places.len(), self.cells.len() / ROWS);
        let mut channel = Channel::zeros(all);
        for (k, right) in self.places.iter().enumerate() {
            let Some(right) = right else { continue };
            for (i, left) in self.places[..=k].iter().enumerate() {
                if let Some(left) = left {
                    channel.matrix[i * all + k] = self.sums[right * width + left];
                }
            }
            channel.gradient[k] = self.sums[self.residual * width + right];
        }
        channel.cost = self.sums[self.residual * width + self.residual];
        channel.count = self.count;
        channel
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parameters::{Freedom, Tolerances};
    use denavit_measurements::Scene;
    use denavit_measurements::kinds::ObservationKind;
    use denavit_model::examples;

    #[test]
    fn sums_are_those_of_the_rows_one_by_one() {
        let chain = examples::puma_like();
        let freedom = Freedom::axes(chain.joints().len());
        let scene = Scene::of(ObservationKind::Pose, 1);
        let layout = Layout::new(&chain, &scene, &freedom, &Tolerances::default(), Vec::new());
        let n = layout.len();
        let mut block = JacobianBlock::new(&layout, &ObservationKind::Pose.place());
        let mut expected = vec![0.0; (n + 1) * (n + 1)];
        for observation in 0..50 {
            let weight = if observation % 7 == 0 { 0.3 } else { 1.0 };
            let value = |k: usize| ((observation * 31 + k * 7) as f64 * 0.37).sin();
            let residual = [value(1000), value(1001), value(1002)];
            let mut jacobian: Vec<f64> = (0..3 * n).map(value).collect();
            for (column, parameter) in layout.parameters.iter().enumerate() {
                if !depends_on(&ObservationKind::Pose.place(), parameter.kind) {
                    (0..3).for_each(|row| jacobian[row * n + column] = 0.0);
                }
            }
            block.take(&residual, &jacobian, weight);
            for (row, r) in jacobian.chunks_exact(n).zip(residual) {
                let line: Vec<f64> = row.iter().copied().chain([r]).collect();
                for i in 0..=n {
                    for k in i..=n {
                        expected[i * (n + 1) + k] += weight * line[i] * line[k];
                    }
                }
            }
        }
        let found = block.finish();
        let near = |a: f64, b: f64| assert!((a - b).abs() < 1e-12 * (1.0 + b.abs()), "{a} {b}");
        for i in 0..n {
            near(found.gradient[i], expected[i * (n + 1) + n]);
            (i..n).for_each(|k| near(found.matrix[i * n + k], expected[i * (n + 1) + k]));
        }
        near(found.cost, expected[n * (n + 1) + n]);
        near(found.count, (8.0 * 0.3 + 42.0) * 3.0);
    }
}
