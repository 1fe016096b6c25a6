//! Normal equations, accumulated over blocks of rows in threads; sums do not depend on the number of threads.

use crate::arm::Arm;
use crate::jacobian_block::{Channel, JacobianBlock};
use crate::parameters::{Effects, Parameter, ParameterKind};
use crate::residual::{ResidualModel, Scratch};
use crate::simd_residuals;
use denavit_linear::threads::{available, in_stretches, par_map};
use fearless_simd::{Level, dispatch};
use std::ops::Range;

/// Sums over all rows, and the squared residual of each observation.
#[derive(Debug, Clone, PartialEq)]
pub struct Sums {
    /// One per noise channel of the scene.
    pub channels: Vec<Channel>,
    /// For each observation the squared residual norm of its lengths and of its angles, unweighted; m², rad².
    pub squares: Vec<[f64; 2]>,
}

/// Most blocks: they are added in order.
const BLOCKS: usize = 64;
/// Fewest rows of a block, unless there are fewer.
const LEAST_ROWS: usize = 32;
/// Fewest measured values for which a thread pays off.
const VALUES_FOR_THREADS: usize = 768;

impl<E: Effects> ResidualModel<'_, E> {
    /// Residuals and normal equations at this state of the arm.
    ///
    /// # Shape and units
    /// `weights`: one per observation; 0 leaves it out.
    pub fn sums(&self, arm: &Arm, weights: &[f64]) -> Sums {
        let rows = self.data.len();
        let block_rows = rows.div_ceil(BLOCKS).max(LEAST_ROWS);
        let mut squares = vec![[0.0; 2]; self.data.observations()];
        let mut blocks: Vec<(Range<usize>, &mut [[f64; 2]])> = Vec::new();
        let mut rest = squares.as_mut_slice();
        for first in (0..rows).step_by(block_rows) {
            let of = first..rows.min(first + block_rows);
            let count = self.data.of_row(of.end - 1).end - self.data.of_row(first).start;
            let (own, others) = rest.split_at_mut(count);
            blocks.push((of, own));
            rest = others;
        }
        let threads = if self.data.values() < VALUES_FOR_THREADS { 1 } else { available().min(blocks.len()) };
        let start = || self.scratch(arm);
        let done = par_map(blocks.into_iter(), threads, start, |scratch, (rows, squares)| {
            self.block(arm, weights, rows, squares, scratch)
        });
        let mut channels = vec![Channel::zeros(self.layout.len()); self.data.scene.channels.len()];
        for block in &done {
            for (sum, part) in channels.iter_mut().zip(block) {
                sum.add(part);
            }
        }
        Sums { channels, squares }
    }

    fn block(
        &self,
        arm: &Arm,
        weights: &[f64],
        rows: Range<usize>,
        squares: &mut [[f64; 2]],
        scratch: &mut Scratch<E::Standing>,
    ) -> Vec<Channel> {
        let columns = self.layout.len();
        let mut jacobian_blocks: Vec<JacobianBlock> =
            self.data.scene.channels.iter().map(|part| JacobianBlock::new(self.layout, part)).collect();
        let no_zero = |parameter: &Parameter| !matches!(parameter.kind, ParameterKind::Zero { .. });
        if self.effects.are_none()
            && self.layout.parameters[self.layout.joints.clone()].iter().all(no_zero)
            && let Some(geometry) = scratch.geometry(arm, self.data)
        {
            let of = (&geometry, arm, self.layout, self.data);
            dispatch!(Level::new(), simd => simd_residuals::rows(simd, of, weights, rows.clone(), squares, &mut jacobian_blocks));
            return jacobian_blocks.into_iter().map(JacobianBlock::finish).collect();
        }
        let height = self.data.tallest_row();
        let mut residual = vec![0.0; height];
        let mut jacobian = vec![0.0; height * columns];
        let first = self.data.of_row(rows.start).start;
        for row in rows {
            self.row_into(arm, row, scratch, &mut residual, Some(&mut jacobian));
            let mut at = 0;
            for observation in self.data.of_row(row) {
                let series = self.data.series_of(observation);
                let heights = [series.kind.place().height, series.kind.turn().map_or(0, |turn| turn.height)];
                for (part, height) in heights.into_iter().enumerate() {
                    let r = &residual[at..at + height];
                    squares[observation - first][part] = r.iter().map(|x| x * x).sum();
                    let block = series.channels[part].map(|channel| &mut jacobian_blocks[channel]);
                    if let Some(block) = block.filter(|_| weights[observation] != 0.0) {
                        block.take(r, &jacobian[at * columns..(at + height) * columns], weights[observation]);
                    }
                    at += height;
                }
            }
        }
        jacobian_blocks.into_iter().map(JacobianBlock::finish).collect()
    }

    /// Squared residual norms of every observation, lengths (m²) and angles (rad²), without derivatives.
    pub fn squares(&self, arm: &Arm) -> Vec<[f64; 2]> {
        let start = || (self.scratch(arm), vec![0.0; self.data.tallest_row()]);
        let of_stretch = |(scratch, residual): &mut (Scratch<E::Standing>, Vec<f64>), rows: Range<usize>| {
            let mut squares = Vec::new();
            for row in rows {
                self.row_into(arm, row, scratch, residual, None);
                let mut rest = residual.as_slice();
                for observation in self.data.of_row(row) {
                    let kind = self.data.series_of(observation).kind;
                    let (own, others) = rest.split_at(kind.height());
                    let (place, turn) = own.split_at(kind.place().height);
                    squares.push([place.iter().map(|x| x * x).sum(), turn.iter().map(|x| x * x).sum()]);
                    rest = others;
                }
            }
            squares
        };
        in_stretches(self.data.len(), start, of_stretch).concat()
    }
}
