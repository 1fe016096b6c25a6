//! Normal equations, accumulated row by row over blocks in threads; sums do not depend on how many threads there are.

use crate::arm::Arm;
use crate::measurements::MeasurementKind;
use crate::parameters::Effects;
use crate::residual::{Problem, Scratch, width};

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
    fn zeros(columns: usize) -> Self {
        Self { matrix: vec![0.0; columns * columns], gradient: vec![0.0; columns], cost: 0.0, count: 0.0 }
    }

    fn add(&mut self, other: &Self) {
        for (sum, value) in self.matrix.iter_mut().zip(&other.matrix) {
            *sum += value;
        }
        for (sum, value) in self.gradient.iter_mut().zip(&other.gradient) {
            *sum += value;
        }
        self.cost += other.cost;
        self.count += other.count;
    }

    /// Add one value or three of one weight: `jacobian` holds as many rows.
    fn take(&mut self, residual: &[f64], jacobian: &[f64], weight: f64) {
        let columns = self.gradient.len();
        self.count += weight * residual.len() as f64;
        self.cost += weight * residual.iter().map(|r| r * r).sum::<f64>();
        if let [r0, r1, r2] = *residual {
            let (x, rest) = jacobian.split_at(columns);
            let (y, z) = rest.split_at(columns);
            for i in 0..columns {
                let (a, b, c) = (weight * x[i], weight * y[i], weight * z[i]);
                self.gradient[i] += a * r0 + b * r1 + c * r2;
                let sums = &mut self.matrix[i * columns + i..(i + 1) * columns];
                for (((sum, x), y), z) in sums.iter_mut().zip(&x[i..]).zip(&y[i..]).zip(&z[i..]) {
                    *sum += a * x + b * y + c * z;
                }
            }
        } else {
            for (r, row) in residual.iter().zip(jacobian.chunks_exact(columns)) {
                for i in 0..columns {
                    let a = weight * row[i];
                    self.gradient[i] += a * r;
                    for (sum, x) in self.matrix[i * columns + i..(i + 1) * columns].iter_mut().zip(&row[i..]) {
                        *sum += a * x;
                    }
                }
            }
        }
    }
}

/// Sums over all rows, and the squared residual of each observation.
#[derive(Debug, Clone, PartialEq)]
pub struct Sums {
    /// Positions or distances (0), orientations (1; absent unless poses are measured).
    pub channels: Vec<Channel>,
    /// For each observation (row by row, target by target) the squared residual norm by channel, unweighted; m², rad².
    pub squares: Vec<[f64; 2]>,
}

/// No more blocks than this: what they hold is added in order.
const BLOCKS: usize = 64;
/// No block is smaller than this many rows, unless there are fewer.
const LEAST_ROWS: usize = 32;

impl<E: Effects> Problem<'_, E> {
    /// Residuals and normal equations at this state of the arm.
    ///
    /// # Shape and units
    /// `weights`: one per observation (row by row, target by target); 0 leaves it out.
    pub fn sums(&self, arm: &Arm, weights: &[f64]) -> Sums {
        let rows = self.data.len();
        let targets = self.data.targets.len();
        let block_rows = rows.div_ceil(BLOCKS).max(LEAST_ROWS);
        let mut squares = vec![[0.0; 2]; rows * targets];
        let mut blocks: Vec<(usize, &mut [[f64; 2]])> = squares
            .chunks_mut(block_rows * targets)
            .enumerate()
            .map(|(index, part)| (index * block_rows, part))
            .collect();
        let threads = std::thread::available_parallelism().map_or(1, usize::from).min(blocks.len()).max(1);
        let share = blocks.len().div_ceil(threads).max(1);
        let work = |part: &mut [(usize, &mut [[f64; 2]])]| -> Vec<Vec<Channel>> {
            let mut scratch = Scratch::new(self.layout, arm);
            part.iter_mut().map(|(first, squares)| self.block(arm, weights, *first, squares, &mut scratch)).collect()
        };
        let done: Vec<Vec<Channel>> = if threads == 1 {
            work(&mut blocks)
        } else {
            std::thread::scope(|scope| {
                let work = &work;
                let handles: Vec<_> = blocks.chunks_mut(share).map(|part| scope.spawn(move || work(part))).collect();
                handles
                    .into_iter()
                    .flat_map(|handle| handle.join().expect("a block's computation does not panic"))
                    .collect()
            })
        };
        let mut channels = self.no_channels();
        for block in &done {
            for (sum, part) in channels.iter_mut().zip(block) {
                sum.add(part);
            }
        }
        Sums { channels, squares }
    }

    fn no_channels(&self) -> Vec<Channel> {
        let count = if self.data.kind == MeasurementKind::Pose { 2 } else { 1 };
        vec![Channel::zeros(self.layout.len()); count]
    }

    fn block(
        &self,
        arm: &Arm,
        weights: &[f64],
        first: usize,
        squares: &mut [[f64; 2]],
        scratch: &mut Scratch,
    ) -> Vec<Channel> {
        let (targets, step, columns) = (self.data.targets.len(), width(self.data.kind), self.layout.len());
        let mut channels = self.no_channels();
        let mut residual = vec![0.0; targets * step];
        let mut jacobian = vec![0.0; targets * step * columns];
        for (offset, squares) in squares.chunks_exact_mut(targets).enumerate() {
            let row = first + offset;
            self.row_into(arm, row, scratch, &mut residual, Some(&mut jacobian));
            for (target, square) in squares.iter_mut().enumerate() {
                let r = &residual[target * step..(target + 1) * step];
                let split = step.min(3);
                square[0] = r[..split].iter().map(|x| x * x).sum();
                square[1] = r[split..].iter().map(|x| x * x).sum();
                let weight = weights[row * targets + target];
                let seen = self.data.kind != MeasurementKind::Position || self.data.position(row, target).is_some();
                if weight == 0.0 || !seen {
                    continue;
                }
                let j = &jacobian[target * step * columns..(target + 1) * step * columns];
                channels[0].take(&r[..split], &j[..split * columns], weight);
                if let Some(orientations) = channels.get_mut(1) {
                    orientations.take(&r[split..], &j[split * columns..], weight);
                }
            }
        }
        channels
    }

    /// Squared residual norms of every observation by channel, m² and rad², without derivatives.
    pub fn squares(&self, arm: &Arm) -> Vec<[f64; 2]> {
        let (targets, step) = (self.data.targets.len(), width(self.data.kind));
        let mut scratch = Scratch::new(self.layout, arm);
        let mut residual = vec![0.0; targets * step];
        let mut squares = Vec::with_capacity(self.data.observations());
        for row in 0..self.data.len() {
            self.row_into(arm, row, &mut scratch, &mut residual, None);
            for r in residual.chunks_exact(step) {
                let (first, second) = r.split_at(step.min(3));
                squares.push([first.iter().map(|x| x * x).sum(), second.iter().map(|x| x * x).sum()]);
            }
        }
        squares
    }
}
