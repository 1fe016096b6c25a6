//! Projects out of a column what the model can already represent, and tests what the rest explains.

use denavit_linear::panel::{Line, PANEL, lines_of};
use denavit_linear::products::{cross_gram, gram_of, subtract, subtract_each};
use denavit_linear::triangle::dot;
use denavit_model::nalgebra::{DMatrix, DVector};
use std::sync::OnceLock;

/// A column of the model with less than this share outside the others is linearly dependent.
pub(super) const DEPENDENT: f64 = 1e-9;
/// A unit column with more than this share left needs no second pass of orthogonalisation.
const ENOUGH: f64 = 0.1;
/// A column reduced to less than this share is orthogonalised once more.
const SMALL: f64 = 1e-3;
/// A column with less than this share outside the model is not identifiable and must not be claimed.
pub const UNSEEN: f64 = 3e-3;

/// An orthonormal basis of the model's columns, and the residual outside it.
#[derive(Debug, Clone)]
pub struct Projector {
    basis: DMatrix<f64>,
    panels: OnceLock<Vec<Vec<Line>>>,
    /// The residual outside the basis.
    pub residual: DVector<f64>,
    /// Its square.
    pub rss: f64,
}

/// What a block of columns explains beyond the model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gain {
    /// How much the sum of squares falls.
    pub drop: f64,
    /// How many of the block's directions are identifiable.
    pub rank: usize,
}

impl Projector {
    /// The basis of these columns together; columns that others imply are left out.
    pub fn new(parts: &[&DMatrix<f64>], residual: &DVector<f64>) -> Self {
        let basis = DMatrix::zeros(residual.len(), 0);
        let none = Self { basis, panels: OnceLock::new(), residual: DVector::zeros(0), rss: 0.0 };
        none.beside(parts, residual)
    }

    /// The basis extended by these columns, and the residual outside it.
    #[must_use]
    pub fn beside(&self, parts: &[&DMatrix<f64>], residual: &DVector<f64>) -> Self {
        let rows = residual.len();
        let columns: Vec<f64> = parts.iter().flat_map(|part| part.as_slice()).copied().collect();
        let mut basis = self.basis.as_slice().to_vec();
        basis.reserve(columns.len());
        for some in columns.chunks((PANEL * rows).max(1)) {
            extend(&mut basis, some.to_vec(), rows);
        }
        let rank = basis.len() / rows.max(1);
        let basis = DMatrix::from_vec(rows, rank, basis);
        let mut result = Self { basis, panels: OnceLock::new(), residual: residual.clone(), rss: 0.0 };
        take_out(result.basis.as_slice(), result.residual.as_mut_slice());
        result.rss = result.residual.norm_squared();
        result
    }

    /// The basis and, last, the residual outside it: [`PANEL`] columns together, value by value.
    pub(super) fn panels(&self) -> &[Vec<Line>] {
        let rows = self.residual.len();
        let panels = || {
            let all: Vec<&[f64]> =
                self.basis.as_slice().chunks_exact(rows.max(1)).chain([self.residual.as_slice()]).collect();
            let panel = |columns: &[&[f64]]| {
                let mut lines = Vec::new();
                lines_of(columns.iter().copied(), rows, &mut lines);
                lines
            };
            all.chunks(PANEL).map(panel).collect()
        };
        self.panels.get_or_init(panels)
    }

    /// An orthonormal basis of the model's columns, column by column.
    pub(super) fn basis(&self) -> &[f64] {
        self.basis.as_slice()
    }

    /// Number of directions that the model has.
    pub fn rank(&self) -> usize {
        self.basis.ncols()
    }
}

/// Subtracts from a column its components along each of these unit columns.
fn take_out(basis: &[f64], column: &mut [f64]) {
    let shares = cross_gram(basis, column, column.len());
    subtract(basis, &shares, column);
}

/// Extends an orthonormal basis by these columns of `rows` cells: the basis is projected out of all of them first, twice where rounding
/// requires it, then the columns before out of each.
fn extend(basis: &mut Vec<f64>, mut columns: Vec<f64>, rows: usize) {
    let known = basis.len();
    for column in columns.chunks_exact_mut(rows) {
        let norm = norm_of(column).max(f64::MIN_POSITIVE);
        for cell in column {
            *cell /= norm;
        }
    }
    for _ in 0..2 {
        let shares = cross_gram(basis, &columns, rows);
        subtract_each(basis, &shares, &mut columns, rows);
        if columns.chunks_exact(rows).all(|column| norm_of(column) > ENOUGH) {
            break;
        }
    }
    for column in columns.chunks_exact_mut(rows) {
        let before = norm_of(column);
        for _ in 0..2 {
            take_out(&basis[known..], column);
        }
        if norm_of(column) < SMALL * before {
            // Little is left, and rounding of what was taken out is no longer small beside it.
            take_out(basis, column);
        }
        let left = norm_of(column);
        if left > DEPENDENT {
            basis.extend(column.iter().map(|cell| cell / left));
        }
    }
}

fn norm_of(column: &[f64]) -> f64 {
    dot(column, column).sqrt()
}

/// Products of blocks of columns with a model's basis B and with its residual. They give what each block C explains beyond the model, or
/// beyond a part of it ([`super::without`]), without the columns: outside the basis, CᵀC becomes CᵀC - (BᵀC)ᵀ(BᵀC).
#[derive(Debug, Clone, Default)]
pub struct Products {
    /// How many columns each block has.
    pub(super) blocks: Vec<usize>,
    /// With the basis, column by column.
    pub(super) shares: Vec<f64>,
    /// With the residual outside the basis.
    pub(super) along: Vec<f64>,
    /// Of each block's columns with one another, block by block.
    pub(super) own: Vec<f64>,
    left: OnceLock<Vec<f64>>,
}

impl Products {
    /// Of these columns with a model; `blocks` says how many columns each block has.
    pub fn of(model: &Projector, columns: &[f64], blocks: &[usize]) -> Self {
        let rows = model.residual.len();
        let mut own = Vec::new();
        let mut first = 0;
        for count in blocks {
            let block = &columns[first * rows..(first + count) * rows];
            own.extend(gram_of(block, rows));
            first += count;
        }
        Self {
            blocks: blocks.to_vec(),
            shares: cross_gram(model.basis.as_slice(), columns, rows),
            along: cross_gram(model.residual.as_slice(), columns, rows),
            own,
            left: OnceLock::new(),
        }
    }

    /// Adds a block: of each of its columns the products with the basis and, last, with the residual; and those with one another.
    pub(super) fn push(&mut self, columns: &[&[f64]], own: &[f64]) {
        self.blocks.push(columns.len());
        for (along, shares) in columns.iter().filter_map(|column| column.split_last()) {
            self.shares.extend(shares);
            self.along.push(*along);
        }
        self.own.extend(own);
    }

    /// Those of several parts of the columns, one after the other.
    pub fn joined(parts: impl IntoIterator<Item = Self>) -> Self {
        let mut all = Self::default();
        for part in parts {
            all.blocks.extend(part.blocks);
            all.shares.extend(part.shares);
            all.along.extend(part.along);
            all.own.extend(part.own);
        }
        all
    }

    /// Products of each block's columns with one another after projection, block by block.
    pub(super) fn left(&self) -> &[f64] {
        let rank = self.shares.len() / self.along.len().max(1);
        let left = || {
            let mut left = self.own.clone();
            let (mut first, mut before) = (0, 0);
            for count in self.blocks.iter().filter(|_| rank > 0) {
                let shares = gram_of(&self.shares[first * rank..(first + count) * rank], rank);
                left[before..].iter_mut().zip(shares).for_each(|(cell, share)| *cell -= share);
                (first, before) = (first + count, before + count * count);
            }
            left
        };
        self.left.get_or_init(left)
    }

    /// What each block explains alone. A column with less than the share `least` outside the model and the block's earlier columns counts as
    /// nothing.
    pub fn gains(&self, least: f64) -> Vec<Gain> {
        let (mut first, mut before) = (0, 0);
        let block_gain = |&count: &usize| {
            let (columns, cells) = (first..first + count, before..before + count * count);
            (first, before) = (columns.end, cells.end);
            gain(&self.own[cells.clone()], self.left()[cells].to_vec(), self.along[columns].to_vec(), least)
        };
        self.blocks.iter().map(block_gain).collect()
    }
}

/// Gram-Schmidt orthogonalisation of columns from their products alone.
///
/// # Shape and units
/// `raw`: products of the columns, square; `left`: the same after projection; `along`: with the residual.
pub(super) fn gain(raw: &[f64], mut left: Vec<f64>, mut along: Vec<f64>, least: f64) -> Gain {
    let count = along.len();
    let mut gain = Gain { drop: 0.0, rank: 0 };
    for k in 0..count {
        let square = left[k * count + k];
        if square <= least * least * raw[k * count + k] {
            continue;
        }
        gain.drop += along[k] * along[k] / square;
        gain.rank += 1;
        for other in k + 1..count {
            let share = left[k * count + other] / square;
            along[other] -= share * along[k];
            for cell in k + 1..count {
                left[other * count + cell] -= share * left[k * count + cell];
            }
        }
    }
    gain
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gain_is_the_fall_of_the_least_squares_sum() {
        let model = DMatrix::from_fn(9, 2, |i, k| ((i + 1) as f64 * (k as f64 + 0.7)).sin());
        let block = DMatrix::from_fn(9, 2, |i, k| ((i as f64) * (k as f64 + 1.3) + 0.4).cos());
        let residual = DVector::from_fn(9, |i, _| (i as f64 * 0.9).sin() + 0.3 * i as f64);
        let both = DMatrix::from_fn(9, 4, |i, k| if k < 2 { model[(i, k)] } else { block[(i, k - 2)] });
        let rss = |a: &DMatrix<f64>| {
            let solution = a.clone().svd(true, true).solve(&residual, 1e-14).unwrap();
            (&residual - a * solution).norm_squared()
        };
        let projector = Projector::new(&[&model], &residual);
        let gain = Products::of(&projector, block.as_slice(), &[2]).gains(UNSEEN)[0];
        assert!((gain.drop - (rss(&model) - rss(&both))).abs() < 1e-10 && gain.rank == 2);
    }

    #[test]
    fn what_the_model_can_do_gains_nothing() {
        let model = DMatrix::from_fn(8, 3, |i, k| ((i + 2 * k) as f64).sin());
        let residual = DVector::from_fn(8, |i, _| i as f64);
        let projector = Projector::new(&[&model], &residual);
        let implied = &model * DMatrix::from_column_slice(3, 1, &[1.0, -2.0, 0.5]);
        assert_eq!(Products::of(&projector, implied.as_slice(), &[1]).gains(UNSEEN)[0], Gain { drop: 0.0, rank: 0 });
    }
}
