//! Normal equations, accumulated over blocks of rows in threads; sums do not depend on how many threads there are.

use crate::arm::Arm;
use crate::lanes;
use crate::measurements::MeasurementKind;
use crate::panel::{Panel, Part};
use crate::parameters::Effects;
use crate::residual::{Problem, Scratch, width};
use fearless_simd::{Level, dispatch};
use std::sync::Mutex;

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
/// Fewer rows are done before a thread has started.
const ROWS_FOR_THREADS: usize = 256;

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
        let blocks: Vec<(usize, &mut [[f64; 2]])> = squares.chunks_mut(block_rows * targets).enumerate().collect();
        let threads = if rows < ROWS_FOR_THREADS {
            1
        } else {
            std::thread::available_parallelism().map_or(1, usize::from).min(blocks.len())
        };
        let mut done: Vec<(usize, Vec<Channel>)> = Vec::with_capacity(blocks.len());
        let queue = Mutex::new(blocks.into_iter());
        let work = || {
            let mut scratch = Scratch::new(self.layout, arm);
            let mut done = Vec::new();
            loop {
                let next = queue.lock().expect("taking a block does not panic").next();
                let Some((index, squares)) = next else { return done };
                done.push((index, self.block(arm, weights, index * block_rows, squares, &mut scratch)));
            }
        };
        std::thread::scope(|scope| {
            let others: Vec<_> = (1..threads).map(|_| scope.spawn(work)).collect();
            done.extend(work());
            for other in others {
                done.extend(other.join().expect("a block's computation does not panic"));
            }
        });
        done.sort_by_key(|(index, _)| *index);
        let mut channels = vec![Channel::zeros(self.layout.len()); self.parts().len()];
        for (_, block) in &done {
            for (sum, part) in channels.iter_mut().zip(block) {
                sum.add(part);
            }
        }
        Sums { channels, squares }
    }

    fn parts(&self) -> &'static [Part] {
        if self.data.kind == MeasurementKind::Pose { &[Part::Place, Part::Turn] } else { &[Part::Place] }
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
        let mut panels: Vec<Panel> = self.parts().iter().map(|part| Panel::new(self.layout, *part)).collect();
        if self.effects.are_none()
            && let Some(geometry) = scratch.geometry(arm, self.data.kind)
        {
            let of = (&geometry, arm, self.layout, self.data);
            dispatch!(Level::new(), simd => lanes::rows(simd, of, weights, first, squares, &mut panels));
            return panels.into_iter().map(Panel::finish).collect();
        }
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
                panels[0].take(&r[..split], &j[..split * columns], weight);
                if let Some(orientations) = panels.get_mut(1) {
                    orientations.take(&r[split..], &j[split * columns..], weight);
                }
            }
        }
        panels.into_iter().map(Panel::finish).collect()
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
