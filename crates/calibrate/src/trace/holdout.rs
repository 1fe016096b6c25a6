//! Does a term help on rows that it was not fitted to? Cross-validation of the linearised model.

use crate::trace::linear::Linear;
use denavit_model::nalgebra::{Cholesky, DMatrix, DVector};

/// Parts that the rows are split into.
const FOLDS: usize = 5;

/// How rows are told off to folds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Folds {
    /// Stretches of the run: what is shared by neighbouring rows does not help.
    Stretches,
    /// Every fifth row: for what follows the run itself.
    Interleaved,
}

/// Sum of squared errors on held-out rows, in units of the noise, of the model with these extra columns.
///
/// # Shape and units
/// `stands`: for each row of the data the first that took its posture; what repeats a posture is held out with it.
pub fn held_out(
    linear: &Linear,
    parts: &[&DMatrix<f64>],
    residual: &DVector<f64>,
    folds: Folds,
    stands: &[usize],
) -> f64 {
    let values = linear.values();
    let count: usize = parts.iter().map(|part| part.ncols()).sum();
    let mut all = DMatrix::zeros(residual.len(), count + 1);
    let mut at = 0;
    for part in parts {
        all.columns_mut(at, part.ncols()).copy_from(part);
        at += part.ncols();
    }
    all.set_column(count, residual);
    let scale: Vec<f64> = (0..count).map(|k| all.column(k).norm().max(f64::MIN_POSITIVE)).collect();
    for (k, scale) in scale.iter().enumerate() {
        all.column_mut(k).unscale_mut(*scale);
    }
    let rows = linear.rows.iter().max().map_or(1, |last| last + 1);
    let numbers = numbered(stands);
    let fold_of = |index: usize| match folds {
        Folds::Stretches => stands[linear.rows[index]] * FOLDS / rows,
        Folds::Interleaved => numbers[linear.rows[index]] % FOLDS,
    };
    let pick = |fold: usize| -> DMatrix<f64> {
        let held: Vec<usize> = (0..values).filter(|&index| fold_of(index) == fold).collect();
        all.select_rows(held.iter())
    };
    let held: Vec<DMatrix<f64>> = (0..FOLDS).map(pick).collect();
    let total = all.transpose() * &all;
    let mut sum = 0.0;
    for part in &held {
        if part.nrows() == 0 {
            continue;
        }
        let gram = &total - part.transpose() * part;
        let mut matrix = gram.view((0, 0), (count, count)).into_owned();
        for k in 0..count {
            // What the other folds do not see at all stays at zero.
            matrix[(k, k)] += 1e-10;
        }
        let right = gram.view((0, count), (count, 1)).into_owned();
        let Some(solved) = Cholesky::new(matrix).map(|cholesky| cholesky.solve(&right)) else { return f64::INFINITY };
        let left = part.column(count) - part.columns(0, count) * solved.column(0);
        sum += left.norm_squared();
    }
    sum
}

/// Postures counted in the order in which they were taken first: the number of each row's.
fn numbered(stands: &[usize]) -> Vec<usize> {
    let mut numbers = vec![0; stands.len()];
    let mut next = 0;
    for (row, &stand) in stands.iter().enumerate() {
        if stand == row {
            numbers[row] = next;
            next += 1;
        } else {
            numbers[row] = numbers[stand];
        }
    }
    numbers
}

#[cfg(test)]
mod tests {
    use super::numbered;

    #[test]
    fn a_posture_that_is_taken_again_has_its_number_again() {
        assert_eq!(numbered(&[0, 0, 2, 0, 4, 2]), [0, 0, 1, 0, 2, 1]);
    }
}
