//! Taking out of a column what the model can already do, and asking what the rest explains.

use crate::identify::gram::{cross_gram, gram_of, subtract};
use crate::identify::panel::{Line, PANEL, lines_of};
use denavit_model::nalgebra::{DMatrix, DVector};
use std::sync::OnceLock;

/// A column of the model that is this nearly a sum of others adds nothing.
const DEPENDENT: f64 = 1e-9;
/// A column of which the model leaves less than this share cannot be seen: claiming it would be guessing.
pub const UNSEEN: f64 = 3e-3;

/// An orthonormal basis of what the model can do, and the residual that it leaves.
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
    /// How many of the block's directions can be seen.
    pub rank: usize,
}

impl Projector {
    /// The basis of these columns together; columns that others imply are left out.
    pub fn new(parts: &[&DMatrix<f64>], residual: &DVector<f64>) -> Self {
        let basis = DMatrix::zeros(residual.len(), 0);
        let none = Self { basis, panels: OnceLock::new(), residual: DVector::zeros(0), rss: 0.0 };
        none.beside(parts, residual)
    }

    /// The basis with these columns beside it, and what both leave of a residual.
    #[must_use]
    pub fn beside(&self, parts: &[&DMatrix<f64>], residual: &DVector<f64>) -> Self {
        let rows = residual.len();
        let count: usize = parts.iter().map(|part| part.ncols()).sum();
        let mut rank = self.rank();
        let mut basis = DMatrix::zeros(rows, rank + count);
        basis.columns_mut(0, rank).copy_from(&self.basis);
        for part in parts {
            for column in part.column_iter() {
                let norm = column.norm();
                if norm == 0.0 {
                    continue;
                }
                let mut rest = column / norm;
                for _ in 0..2 {
                    take_out(&basis.as_slice()[..rank * rows], rest.as_mut_slice());
                }
                let left = rest.norm();
                if left > DEPENDENT {
                    basis.set_column(rank, &(rest / left));
                    rank += 1;
                }
            }
        }
        let basis = basis.columns(0, rank).into_owned();
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

    /// Number of directions that the model has.
    pub fn rank(&self) -> usize {
        self.basis.ncols()
    }

    /// What each of several blocks of raw columns explains, each alone: `blocks` says how many columns each has.
    ///
    /// A column of which less than the share `least` is left, beside the model and the columns of its block before it,
    /// counts as nothing.
    pub fn gains(&self, columns: &[f64], blocks: &[usize], least: f64) -> Vec<Gain> {
        Products::of(self, columns, blocks).gains(least)
    }

    /// What a matrix of raw columns explains.
    pub fn gain_of(&self, columns: &DMatrix<f64>) -> Gain {
        self.gain_of_seen(columns, UNSEEN)
    }

    /// The same, with another share of a column that must be left.
    pub fn gain_of_seen(&self, columns: &DMatrix<f64>, least: f64) -> Gain {
        self.gains(columns.as_slice(), &[columns.ncols()], least)[0]
    }
}

/// Takes out of a column what lies along each of these of length 1.
fn take_out(basis: &[f64], column: &mut [f64]) {
    let shares = cross_gram(basis, column, column.len());
    subtract(basis, &shares, column);
}

/// Products of blocks of columns with all that a model can do and with what it leaves. They tell what each block explains beside the model,
/// and beside any part of it, without a look at the columns: what is left of C is CᵀC - (BᵀC)ᵀ(BᵀC), B the basis.
#[derive(Debug, Clone, Default)]
pub struct Products {
    /// How many columns each block has.
    blocks: Vec<usize>,
    /// With the basis, column by column.
    shares: Vec<f64>,
    /// With the residual outside the basis.
    along: Vec<f64>,
    /// Of each block's columns with one another, block by block.
    own: Vec<f64>,
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

    /// The products with a part of the model: a basis within the model's, and a residual that the model would bring to its own.
    #[must_use]
    pub fn beside(&self, model: &Projector, part: &Projector) -> Self {
        let (rows, rank) = (model.residual.len(), model.rank());
        if rank == 0 {
            return self.clone();
        }
        let within = cross_gram(model.basis.as_slice(), part.basis.as_slice(), rows);
        let returned = cross_gram(model.basis.as_slice(), part.residual.as_slice(), rows);
        let more = cross_gram(&returned, &self.shares, rank);
        Self {
            blocks: self.blocks.clone(),
            shares: cross_gram(&within, &self.shares, rank),
            along: self.along.iter().zip(more).map(|(along, more)| along + more).collect(),
            own: self.own.clone(),
        }
    }

    /// What each block explains alone; see [`Projector::gains`].
    pub fn gains(&self, least: f64) -> Vec<Gain> {
        let rank = self.shares.len() / self.along.len().max(1);
        let (mut first, mut before) = (0, 0);
        let block_gain = |&count: &usize| {
            let columns = first..first + count;
            let own = &self.own[before..before + count * count];
            (first, before) = (columns.end, before + own.len());
            let shares = &self.shares[columns.start * rank..columns.end * rank];
            let of_shares = if rank == 0 { vec![0.0; own.len()] } else { gram_of(shares, rank) };
            gain(own, &of_shares, self.along[columns].to_vec(), least)
        };
        self.blocks.iter().map(block_gain).collect()
    }
}

/// Columns made orthogonal one after the other by their products alone.
///
/// # Shape and units
/// `raw`: products of the columns, square; `shares`: of their parts in the model; `along`: with the residual.
fn gain(raw: &[f64], shares: &[f64], mut along: Vec<f64>, least: f64) -> Gain {
    let count = along.len();
    let mut left: Vec<f64> = raw.iter().zip(shares).map(|(whole, share)| whole - share).collect();
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
        let gain = projector.gain_of(&block);
        assert!((gain.drop - (rss(&model) - rss(&both))).abs() < 1e-10 && gain.rank == 2);
    }

    #[test]
    fn products_with_a_model_tell_what_is_explained_beside_a_part_of_it() {
        let cell = |i: usize, k: usize| ((i * (k + 2)) as f64 * 0.37).sin() + 0.2 * ((i + 3 * k) as f64).cos();
        let geometry = DMatrix::from_fn(12, 3, cell);
        let effects = DMatrix::from_fn(12, 2, |i, k| cell(i, k + 5));
        let columns = DMatrix::from_fn(12, 3, |i, k| cell(i, k + 9));
        let residual = DVector::from_fn(12, |i, _| cell(i, 20));
        let loose = Projector::new(&[&geometry], &residual);
        let whole = loose.beside(&[&effects], &residual);
        // The second effect is left out: what it explained is in the residual again.
        let part = loose.beside(&[&effects.columns(0, 1).into_owned()], &(&residual + effects.column(1) * 0.7));
        let products = Products::of(&whole, columns.as_slice(), &[1, 2]).beside(&whole, &part);
        let direct = part.gains(columns.as_slice(), &[1, 2], UNSEEN);
        for (found, wanted) in products.gains(UNSEEN).iter().zip(direct) {
            assert!((found.drop - wanted.drop).abs() < 1e-12 && found.rank == wanted.rank, "{found:?} {wanted:?}");
        }
    }

    #[test]
    fn what_the_model_can_do_gains_nothing() {
        let model = DMatrix::from_fn(8, 3, |i, k| ((i + 2 * k) as f64).sin());
        let residual = DVector::from_fn(8, |i, _| i as f64);
        let projector = Projector::new(&[&model], &residual);
        let implied = &model * DMatrix::from_column_slice(3, 1, &[1.0, -2.0, 0.5]);
        assert_eq!(projector.gain_of(&implied), Gain { drop: 0.0, rank: 0 });
    }
}
