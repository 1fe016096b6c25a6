//! A model without some of its effects, computed in the basis of the whole model: only the effects' coordinates in that basis are made
//! orthogonal again, not the columns of the data.

use crate::projector::{DEPENDENT, Gain, Products, Projector, UNSEEN, gain};
use denavit_linear::products::cross_gram;
use denavit_linear::triangle::dot;
use denavit_model::nalgebra::{DMatrix, DVector};

/// Geometry and all effects of a model.
#[derive(Debug, Clone)]
pub struct Whole {
    /// Their basis: geometry first.
    pub projector: Projector,
    /// How many directions geometry has.
    geometry: usize,
    /// Coordinates of each effect's column in the basis, column by column.
    effects: Vec<f64>,
    /// Those of the residual before projection.
    residual: Vec<f64>,
}

/// A model without some of its effects, and the residual without them.
#[derive(Debug, Clone)]
pub struct Reduced<'a> {
    /// The model with them.
    pub model: &'a Projector,
    /// Orthonormal directions that only these effects span, as coordinates in its basis, one after the other.
    directions: Vec<f64>,
    /// The residual along each of these without them.
    along: Vec<f64>,
}

impl Whole {
    /// Geometry with columns of effects beside it.
    pub fn new(geometry: &Projector, effects: &DMatrix<f64>, residual: &DVector<f64>) -> Self {
        let projector = geometry.beside(&[effects], residual);
        let shares = |columns: &[f64]| cross_gram(projector.basis(), columns, residual.len());
        let (effects, residual) = (shares(effects.as_slice()), shares(residual.as_slice()));
        Self { geometry: geometry.rank(), effects, residual, projector }
    }

    /// The model without these columns of effects, given with their coefficients in the residual.
    pub fn leaving_out(&self, left_out: &[(usize, f64)]) -> Reduced<'_> {
        let rank = self.projector.rank();
        if left_out.is_empty() || rank == 0 {
            return Reduced::nothing(&self.projector);
        }
        let is_left_out = |column: usize| left_out.iter().any(|(other, _)| *other == column);
        let columns = self.effects.len() / rank;
        let (out, kept): (Vec<usize>, Vec<usize>) = (0..columns).partition(|&column| is_left_out(column));
        // After geometry come the effects that stay: what the others add is theirs alone.
        let mut basis: Vec<Vec<f64>> = Vec::new();
        let mut first = 0;
        for column in kept.iter().chain([&columns]).chain(&out) {
            if *column == columns {
                first = basis.len();
                continue;
            }
            let shares = &self.effects[column * rank..(column + 1) * rank];
            let norm = dot(shares, shares).sqrt().max(f64::MIN_POSITIVE);
            let mut own: Vec<f64> = shares[self.geometry..].iter().map(|share| share / norm).collect();
            for _ in 0..3 {
                for other in &basis {
                    let share = dot(other, &own);
                    own.iter_mut().zip(other).for_each(|(cell, other)| *cell -= share * other);
                }
            }
            let left = dot(&own, &own).sqrt();
            if left > DEPENDENT {
                basis.push(own.into_iter().map(|cell| cell / left).collect());
            }
        }
        let mut without = Reduced::nothing(&self.projector);
        for direction in &basis[first..] {
            let mut whole = vec![0.0; self.geometry];
            whole.extend(direction);
            let of = |(column, coefficient): &(usize, f64)| {
                coefficient * dot(&whole, &self.effects[column * rank..(column + 1) * rank])
            };
            without.along.push(dot(&whole, &self.residual) - left_out.iter().map(of).sum::<f64>());
            without.directions.extend(whole);
        }
        without
    }
}

impl<'a> Reduced<'a> {
    /// A model with all that it has.
    pub fn nothing(model: &'a Projector) -> Self {
        Self { model, directions: Vec::new(), along: Vec::new() }
    }

    /// Number of directions that the model has.
    pub fn rank(&self) -> usize {
        self.model.rank() - self.along.len()
    }

    /// The square of the model's residual.
    pub fn rss(&self) -> f64 {
        self.model.rss + dot(&self.along, &self.along)
    }

    /// What each block of columns explains alone, from its products with the model of all effects; see [`Products::gains`].
    pub fn gains(&self, products: &Products, least: f64) -> Vec<Gain> {
        let (lost, rank) = (self.along.len(), self.model.rank());
        let shares = cross_gram(&self.directions, &products.shares, rank);
        let (mut first, mut before) = (0, 0);
        let block_gain = |&count: &usize| {
            let cells = before..before + count * count;
            let mut left = products.left()[cells.clone()].to_vec();
            let mut along = products.along[first..first + count].to_vec();
            let of = |column: usize| &shares[(first + column) * lost..(first + column + 1) * lost];
            for a in 0..count {
                along[a] += dot(of(a), &self.along);
                for b in 0..count {
                    left[a * count + b] += dot(of(a), of(b));
                }
            }
            (first, before) = (first + count, cells.end);
            gain(&products.own[cells], left, along, least)
        };
        products.blocks.iter().map(block_gain).collect()
    }

    /// What a matrix of raw columns explains.
    pub fn gain_of(&self, columns: &DMatrix<f64>) -> Gain {
        self.gains(&Products::of(self.model, columns.as_slice(), &[columns.ncols()]), UNSEEN)[0]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_model_without_effects_explains_what_one_does_that_never_had_them() {
        let cell = |i: usize, k: usize| ((i * (k + 2)) as f64 * 0.37).sin() + 0.2 * ((i + 3 * k) as f64).cos();
        let geometry = DMatrix::from_fn(14, 3, cell);
        // The fourth effect does what the first two do together.
        let effects =
            DMatrix::from_fn(14, 4, |i, k| if k < 3 { cell(i, k + 5) } else { cell(i, 5) - 2.0 * cell(i, 6) });
        let columns = DMatrix::from_fn(14, 3, |i, k| cell(i, k + 9));
        let residual = DVector::from_fn(14, |i, _| cell(i, 20));
        let loose = Projector::new(&[&geometry], &residual);
        let whole = Whole::new(&loose, &effects, &residual);
        assert_eq!(whole.projector.rank(), 6);
        let products = Products::of(&whole.projector, columns.as_slice(), &[1, 2]);
        for left_out in [&[][..], &[(0, 0.7)], &[(2, -1.3)], &[(0, 0.7), (2, 0.4)], &[(1, 0.2), (3, 0.9), (0, -0.4)]] {
            let kept: Vec<usize> = (0..4).filter(|k| left_out.iter().all(|(other, _)| other != k)).collect();
            let mut without = residual.clone();
            for (column, times) in left_out {
                without.axpy(-times, &effects.column(*column), 1.0);
            }
            let part = loose.beside(&[&effects.select_columns(kept.iter())], &without);
            let found = whole.leaving_out(left_out);
            assert_eq!(found.rank(), part.rank(), "{left_out:?}");
            assert!((found.rss() - part.rss).abs() < 1e-12, "{left_out:?}: {} {}", found.rss(), part.rss);
            let direct = Products::of(&part, columns.as_slice(), &[1, 2]).gains(UNSEEN);
            for (found, wanted) in found.gains(&products, UNSEEN).iter().zip(direct) {
                assert!((found.drop - wanted.drop).abs() < 1e-12 && found.rank == wanted.rank, "{found:?} {wanted:?}");
            }
        }
    }
}
