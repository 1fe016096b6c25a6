//! Uncertainty of an error curve: the shapes by which its posterior varies most, so that a later calibration can continue from it.
//!
//! With Σ the posterior covariance of a curve's weights and Σ = V Λ Vᵀ, a mode is a column of V √Λ: the curve is its mean plus the
//! modes, each times a number of mean 0 and variance 1. The largest `MOST` are kept (Karhunen-Loève); the rest is neglected.

use crate::arm::{Arm, Perturbation, Perturbed, Row};
use crate::effects::carrier::Action;
use crate::effects::curve::{Curve, Waves};
use crate::effects::driver::Conditions;
use crate::effects::model::{EffectModel, Standing, add_sensitivity};
use crate::parameters::{Effects, Parameter, ParameterKind, Sensitivity};
use denavit_model::nalgebra::DMatrix;

/// Most modes of a curve.
const MOST: usize = 8;
/// A mode with less than this fraction of the largest one's variance is left out.
const LEAST: f64 = 1e-3;

/// The modes of a fit's curves, and their covariance with the fit's numbers.
#[derive(Debug, Clone, PartialEq)]
pub struct CurveModes {
    /// For each curve its modes: weights of its waves, a list for each mode, rad or m.
    pub shapes: Vec<Vec<Vec<f64>>>,
    /// Covariance of their numbers.
    pub covariance: DMatrix<f64>,
    /// Their covariance with the numbers of the fit's layout, a row for each mode.
    pub cross: DMatrix<f64>,
}

impl CurveModes {
    /// No curves, with a layout of this many numbers.
    pub fn none(numbers: usize) -> Self {
        Self { shapes: Vec::new(), covariance: DMatrix::zeros(0, 0), cross: DMatrix::zeros(0, numbers) }
    }

    /// Of curves whose weights have these indices in a covariance, with other numbers at other indices.
    pub fn of(covariance: impl Fn(usize, usize) -> f64, curves: &[std::ops::Range<usize>], numbers: &[usize]) -> Self {
        let block = |rows: &[usize], columns: &[usize]| {
            DMatrix::from_fn(rows.len(), columns.len(), |i, k| covariance(rows[i], columns[k]))
        };
        let places: Vec<Vec<usize>> = curves.iter().map(|range| range.clone().collect()).collect();
        let (mut shapes, mut taken) = (Vec::new(), Vec::new());
        for own in &places {
            let eigen = block(own, own).symmetric_eigen();
            let mut order: Vec<usize> = (0..own.len()).collect();
            order.sort_by(|a, b| eigen.eigenvalues[*b].total_cmp(&eigen.eigenvalues[*a]));
            let largest = order.first().map_or(0.0, |k| eigen.eigenvalues[*k]);
            order.truncate(MOST);
            order.retain(|k| eigen.eigenvalues[*k] > (LEAST * largest).max(f64::MIN_POSITIVE));
            let size = |k: &usize| eigen.eigenvalues[*k].sqrt();
            shapes.push(
                order.iter().map(|k| (eigen.eigenvectors.column(*k) * size(k)).iter().copied().collect()).collect(),
            );
            // The number of a mode is (row of Vᵀ / √λ) times the weights.
            taken.push(DMatrix::from_fn(order.len(), own.len(), |i, w| {
                eigen.eigenvectors[(w, order[i])] / size(&order[i])
            }));
        }
        let count: usize = taken.iter().map(DMatrix::nrows).sum();
        let (mut all, mut cross) = (DMatrix::zeros(count, count), DMatrix::zeros(count, numbers.len()));
        let mut row = 0;
        for (own, of_own) in places.iter().zip(&taken) {
            cross.rows_mut(row, of_own.nrows()).copy_from(&(of_own * block(own, numbers)));
            let mut column = 0;
            for (other, of_other) in places.iter().zip(&taken) {
                let cells = of_own * block(own, other) * of_other.transpose();
                all.view_mut((row, column), cells.shape()).copy_from(&cells);
                column += of_other.nrows();
            }
            row += of_own.nrows();
        }
        Self { shapes, covariance: all, cross }
    }

    /// These and the modes of more curves, without correlation between them: `places` are the indices of the first one's numbers in a layout
    /// of `of`, and `others` those of the others.
    #[must_use]
    pub fn with(&self, places: &[usize], more: &Self, others: &[usize], of: usize) -> Self {
        let (own, added) = (self.covariance.nrows(), more.covariance.nrows());
        let mut covariance = DMatrix::zeros(own + added, own + added);
        covariance.view_mut((0, 0), (own, own)).copy_from(&self.covariance);
        covariance.view_mut((own, own), (added, added)).copy_from(&more.covariance);
        let mut cross = DMatrix::zeros(own + added, of);
        for (from, to) in places.iter().enumerate() {
            cross.view_mut((0, *to), (own, 1)).copy_from(&self.cross.column(from));
        }
        for (from, to) in others.iter().enumerate() {
            cross.view_mut((own, *to), (added, 1)).copy_from(&more.cross.column(from));
        }
        Self { shapes: [&self.shapes[..], &more.shapes].concat(), covariance, cross }
    }
}

/// A mode of a joint's curve.
#[derive(Debug, Clone, PartialEq)]
struct Mode {
    /// The curve, counted from 0.
    curve: usize,
    /// One number per wave.
    weights: Vec<f64>,
}

/// A model whose curves may vary by their modes.
#[derive(Debug, Clone, PartialEq)]
pub struct Varying {
    model: EffectModel,
    modes: Vec<Mode>,
    /// Amount of each mode.
    amounts: Vec<f64>,
}

impl Varying {
    /// With unchanged curves. `shapes`: for each curve of the model its modes.
    pub fn new(model: EffectModel, shapes: &[&[Vec<f64>]]) -> Self {
        let of = |(curve, shapes): (usize, &&[Vec<f64>])| {
            shapes.iter().map(move |weights| Mode { curve, weights: weights.clone() }).collect::<Vec<Mode>>()
        };
        let modes: Vec<Mode> = shapes.iter().enumerate().flat_map(of).collect();
        Self { model, amounts: vec![0.0; modes.len()], modes }
    }

    /// The model with its updated curves.
    pub fn updated(&self) -> EffectModel {
        let mut model = self.model.clone();
        for (mode, amount) in self.modes.iter().zip(&self.amounts) {
            let curve = &mut model.curves[mode.curve];
            curve.weights.iter_mut().zip(&mode.weights).for_each(|(weight, shape)| *weight += amount * shape);
        }
        model
    }

    /// Each mode at a reading of the row, with its joint, rad or m.
    fn values(&self, row: Row<'_>) -> impl Iterator<Item = (usize, f64)> {
        let reading = Conditions::of(row).reading;
        let joints = self.model.statics.chain.joints();
        let of = |curve: &Curve| -> (usize, Vec<f64>) {
            let waves: &Waves = &curve.waves;
            (curve.joint, waves.values(joints[curve.joint].value(reading)))
        };
        let waves: Vec<(usize, Vec<f64>)> = self.model.curves.iter().map(of).collect();
        self.modes.iter().map(move |mode| {
            let (joint, values) = &waves[mode.curve];
            (*joint, values.iter().zip(&mode.weights).map(|(wave, weight)| wave * weight).sum())
        })
    }
}

impl Effects for Varying {
    type Standing = Standing;

    fn standing(&self, arm: &Arm) -> Standing {
        self.model.standing(arm)
    }

    fn parameters(&self) -> Vec<Parameter> {
        let mut parameters = self.model.parameters();
        for _ in &self.modes {
            let kind = ParameterKind::Effect { index: parameters.len() };
            parameters.push(Parameter { name: "mode of an error curve".into(), kind, unit: "1", tolerance: None });
        }
        parameters
    }

    fn perturb(&self, row: Row<'_>, arm: &Arm, standing: &mut Standing, out: &mut Perturbation) -> bool {
        let any = self.model.perturb(row, arm, standing, out);
        for ((joint, value), amount) in self.values(row).zip(&self.amounts) {
            out.twists[joint] += arm.joints[joint].screw.twist() * (value * amount);
        }
        any || !self.modes.is_empty()
    }

    fn sensitivities(
        &self,
        row: Row<'_>,
        arm: &Arm,
        standing: &mut Standing,
        at: Perturbed<'_>,
        out: &mut [Sensitivity],
    ) {
        let (of_model, of_modes) = out.split_at_mut(self.parameters_of_model());
        self.model.sensitivities(row, arm, standing, at, of_model);
        for ((joint, value), out) in self.values(row).zip(of_modes) {
            let action = Action::Twist { slot: joint, twist: arm.joints[joint].screw.twist() };
            add_sensitivity(&action, value, at.state, out);
        }
    }

    fn numbers(&self) -> Vec<f64> {
        let mut numbers = self.model.numbers();
        numbers.extend(&self.amounts);
        numbers
    }

    fn stepped(&self, step: &[f64]) -> Self {
        let (of_model, of_modes) = step.split_at(self.parameters_of_model());
        let amounts = self.amounts.iter().zip(of_modes).map(|(amount, step)| amount + step).collect();
        Self { model: self.model.stepped(of_model), modes: self.modes.clone(), amounts }
    }
}

impl Varying {
    fn parameters_of_model(&self) -> usize {
        self.model.effects.iter().map(|effect| effect.coefficients.len()).sum()
    }
}
