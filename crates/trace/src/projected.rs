//! Columns at the geometric fit, with geometry and other terms projected out, and their products in all rows or in half of the postures.

use crate::linear::Linear;
use crate::projector::Projector;
use denavit_identify::effects::driver::Statics;
use denavit_identify::effects::model::{EffectModel, Term};
use denavit_identify::parameters::{Effects as _, NoEffects};
use denavit_identify::solve::Fit;
use denavit_linear::products::{cross_gram, gram_of, subtract_each};
use denavit_measurements::Measurements;
use denavit_model::nalgebra::{DMatrix, DVector};

/// The geometric fit with these terms, their coefficients zero.
pub(super) fn fit_with(statics: &Statics, geometric: &Fit<NoEffects>, terms: &[Term]) -> Fit<EffectModel> {
    let mut fit = geometric.with_model(statics, None);
    fit.effects = EffectModel::of_terms(statics, None, terms);
    fit.layout = fit.layout.with_effects(fit.effects.parameters());
    fit
}

/// Columns and residual after projection.
pub(super) struct Projected {
    /// Column by column.
    cells: Vec<f64>,
    residual: Vec<f64>,
    /// For each value the half that its posture belongs to, 0 or 1; none for rows of priors.
    half: Vec<Option<usize>>,
    /// Directions that are projected out.
    pub rank: usize,
}

/// Products of columns with one another and with the residual, in some rows.
pub(super) struct RowProducts {
    pub gram: DMatrix<f64>,
    pub along: DVector<f64>,
    /// Of the residual with itself.
    pub square: f64,
    /// How many of the rows are measured values.
    pub values: usize,
}

impl Projected {
    /// `cells`: column by column, in the rows of `linear`.
    pub fn new(projector: &Projector, mut cells: Vec<f64>, linear: &Linear, data: &Measurements) -> Self {
        let rows = linear.residual.len();
        let shares = cross_gram(projector.basis(), &cells, rows);
        subtract_each(projector.basis(), &shares, &mut cells, rows);
        let mut postures = 0_usize;
        let mut of_row: Vec<usize> = Vec::with_capacity(data.len());
        for (row, first) in data.first_of_posture().into_iter().enumerate() {
            of_row.push(of_row.get(first).copied().unwrap_or(postures % 2));
            postures += usize::from(first == row);
        }
        let half = (0..rows).map(|at| linear.rows.get(at).map(|&row| of_row[row])).collect();
        Self { cells, residual: projector.residual.as_slice().to_vec(), half, rank: projector.rank() }
    }

    /// Rows of values and of priors.
    pub fn rows(&self) -> usize {
        self.residual.len()
    }

    /// Those in one half of the postures, or in all rows.
    pub fn products(&self, half: Option<usize>) -> RowProducts {
        let kept = |at: &usize| half.is_none() || self.half[*at] == half;
        let rows: Vec<usize> = (0..self.rows()).filter(kept).collect();
        let pick = |column: &[f64]| rows.iter().map(|&at| column[at]).collect::<Vec<f64>>();
        let own: Vec<f64> = self.cells.chunks_exact(self.rows()).flat_map(pick).collect();
        let residual = pick(&self.residual);
        let count = own.len() / rows.len().max(1);
        RowProducts {
            gram: DMatrix::from_vec(count, count, gram_of(&own, rows.len())),
            along: DVector::from_vec(cross_gram(&own, &residual, rows.len())),
            square: residual.iter().map(|value| value * value).sum(),
            values: rows.iter().filter(|&&at| self.half[at].is_some()).count(),
        }
    }
}
