//! The model linearised at its fitted state, in units of the noise: every candidate is tested against it.

use crate::projector::Projector;
use denavit_identify::arm::{Arm, Perturbation, Row};
use denavit_identify::effects::carrier::Carrier;
use denavit_identify::effects::driver::{Conditions, Posture};
use denavit_identify::effects::model::EffectModel;
use denavit_identify::effects::probe::Probe;
use denavit_identify::gauge;
use denavit_identify::parameters::Effects;
use denavit_identify::residual::{ResidualModel, Scratch};
use denavit_identify::solve::Fit;
use denavit_identify::symmetric;
use denavit_linear::threads::{get_or_make, in_stretches};
use denavit_measurements::Measurements;
use denavit_model::nalgebra::{DMatrix, DMatrixView, DVector};
use std::sync::OnceLock;

/// Geometry gets this multiple of its tolerances while candidates are tested: an effect is what geometry of any
/// reasonable size cannot explain.
const RELAXED: f64 = 10.0;

/// Residual and derivatives in units of the noise; rows of the relaxed prior and of the
/// conditions on the common frame come after those of the data.
#[derive(Debug, Clone)]
pub struct Linear {
    /// Measured minus predicted.
    pub residual: DVector<f64>,
    /// Columns of geometry, instrument and targets.
    pub geometry: DMatrix<f64>,
    /// Columns of the model's effects, coefficient by coefficient.
    pub effects: DMatrix<f64>,
    /// Columns of the carriers' directions, for a driver of 1.
    pub carriers: DMatrix<f64>,
    /// Which columns belong to which carrier.
    pub places: Vec<(Carrier, std::ops::Range<usize>)>,
    /// The data row that each value belongs to.
    pub rows: Vec<usize>,
    /// The noise channel of each value.
    pub channels: Vec<usize>,
    /// The weight that each value has in residual and columns.
    pub weights: Vec<f64>,
    /// Effects and arm about which it was linearised.
    at: (EffectModel, Arm),
    postures: OnceLock<Vec<Posture>>,
    /// The basis of geometry, formed once for all tests.
    loose: OnceLock<Projector>,
}

/// Linearises a fit about its state, with columns for these carriers.
pub fn linearise(data: &Measurements, fit: &Fit<EffectModel>, reference: &Arm, carriers: &[Carrier]) -> Linear {
    let model = &fit.effects;
    let mut places = Vec::new();
    let mut end = 0;
    for carrier in carriers {
        let start = end;
        end += carrier.directions(&model.statics, &fit.arm.joints, 0).len();
        places.push((*carrier, start..end));
    }
    let own = fit.layout.effects.len();
    let probe = Probe::of_carriers(model, &model.statics, &fit.arm, carriers);
    let layout = fit.layout.with_effects(probe.parameters());
    let problem = ResidualModel { data, layout: &layout, effects: &probe };
    let columns = layout.len();
    let stretches = stretches(&problem, fit);
    let values = stretches.iter().map(|stretch| stretch.residual.len()).sum();
    // With the prior's inverse covariance P = L Lᵀ, its rows are Lᵀ · perturbation.
    let prior = symmetric::lower(&layout.prior.precision, 0.0).transpose();
    let priors = prior.nrows();
    // The common frame is held as in a fit: to first order an effect does not move along with its axis, so a common motion,
    // which in truth changes no measured value, would replace it.
    let held =
        if layout.joints.is_empty() { DMatrix::zeros(columns, 0) } else { gauge::conditions(&layout, reference) };
    let lengths = layout.known_lengths(&data.scene, &fit.arm);
    let total = values + priors + held.ncols() + lengths.len();
    let (first, last) = (layout.effects.start + own, layout.effects.end);
    let geometry_columns: Vec<usize> = (0..layout.effects.start).chain(last..columns).collect();
    let mut result = Linear {
        residual: DVector::zeros(total),
        geometry: DMatrix::zeros(total, geometry_columns.len()),
        effects: DMatrix::zeros(total, own),
        carriers: DMatrix::zeros(total, last - first),
        places,
        rows: Vec::with_capacity(values),
        channels: Vec::with_capacity(values),
        weights: Vec::with_capacity(values),
        at: (model.clone(), fit.arm.clone()),
        postures: OnceLock::new(),
        loose: OnceLock::new(),
    };
    let mut from = 0;
    for stretch in stretches {
        let count = stretch.residual.len();
        result.residual.rows_mut(from, count).copy_from_slice(&stretch.residual);
        let cells = DMatrixView::from_slice(&stretch.cells, columns, count);
        let put = |to: &mut DMatrix<f64>, column: usize, own: usize| {
            to.column_mut(column).rows_mut(from, count).tr_copy_from(&cells.row(own));
        };
        geometry_columns.iter().enumerate().for_each(|(k, &own)| put(&mut result.geometry, k, own));
        (0..own).for_each(|k| put(&mut result.effects, k, layout.effects.start + k));
        (0..last - first).for_each(|k| put(&mut result.carriers, k, first + k));
        result.rows.extend(stretch.rows);
        result.channels.extend(stretch.channels);
        result.weights.extend(stretch.weights);
        from += count;
    }
    if priors > 0 {
        let perturbation = &prior * layout.perturbation(&fit.arm, reference) / RELAXED;
        result.residual.rows_mut(values, priors).copy_from(&perturbation);
        result.geometry.view_mut((values, 0), (priors, priors)).copy_from(&(&prior / RELAXED));
    }
    for (k, known) in lengths.iter().enumerate() {
        let row = total - lengths.len() + k;
        result.residual[row] = known.residual;
        for (from, value) in &known.columns {
            if let Some(column) = geometry_columns.iter().position(|column| column == from) {
                result.geometry[(row, column)] = *value;
            }
        }
    }
    let norms: Vec<f64> = result.geometry.column_iter().map(|column| column.norm()).collect();
    let scale: Vec<f64> = norms.iter().map(|norm| if *norm > 0.0 { 1.0 / norm } else { 0.0 }).collect();
    let frame = gauge::in_scaled(held.select_rows(&geometry_columns), &scale);
    for (k, condition) in frame.column_iter().enumerate() {
        for (column, (cell, norm)) in condition.iter().zip(&norms).enumerate() {
            result.geometry[(values + priors + k, column)] = cell * norm;
        }
    }
    result
}

/// Some rows of a fit, in units of the noise, value by value.
struct Stretch {
    residual: Vec<f64>,
    /// Derivatives by all parameters, value by value.
    cells: Vec<f64>,
    rows: Vec<usize>,
    channels: Vec<usize>,
    weights: Vec<f64>,
}

/// All rows of a fit, stretch by stretch.
fn stretches<E: Effects>(problem: &ResidualModel<'_, E>, fit: &Fit<EffectModel>) -> Vec<Stretch> {
    let start = || problem.scratch(&fit.arm);
    in_stretches(problem.data.len(), start, |scratch, rows| stretch(problem, fit, rows, scratch))
}

fn stretch<E: Effects>(
    problem: &ResidualModel<'_, E>,
    fit: &Fit<EffectModel>,
    rows: std::ops::Range<usize>,
    scratch: &mut Scratch<E::Standing>,
) -> Stretch {
    let (data, columns) = (problem.data, problem.layout.len());
    let (mut residual, mut jacobian) = (vec![0.0; data.tallest_row()], vec![0.0; data.tallest_row() * columns]);
    let mut found = Stretch { residual: vec![], cells: vec![], rows: vec![], channels: vec![], weights: vec![] };
    for row in rows {
        if !data.of_row(row).any(|observation| fit.weights[observation] > 0.0) {
            continue;
        }
        problem.row_into(&fit.arm, row, scratch, &mut residual, Some(&mut jacobian));
        let mut first = 0;
        for observation in data.of_row(row) {
            let series = data.series_of(observation);
            let lines = first..first + series.kind.height();
            first = lines.end;
            let weight = fit.weights[observation];
            if weight <= 0.0 {
                continue;
            }
            for (k, line) in lines.enumerate() {
                let channel = series.channels[usize::from(k >= series.kind.place().height)];
                let factor = weight.sqrt() / channel.map_or(1.0, |channel| fit.noise.levels[channel]);
                found.residual.push(residual[line] * factor);
                found.cells.extend(jacobian[line * columns..(line + 1) * columns].iter().map(|cell| cell * factor));
                found.rows.push(row);
                found.channels.push(channel.unwrap_or(0));
                found.weights.push(weight);
            }
        }
    }
    found
}

impl Linear {
    /// The arm in every row of the linearised data, with the model's deflections.
    pub fn postures(&self, data: &Measurements) -> &[Posture] {
        let (model, arm) = &self.at;
        get_or_make(&self.postures, || postures(model, arm, data)).as_slice()
    }

    /// Measured values that were not rejected.
    pub fn values(&self) -> usize {
        self.rows.len()
    }

    /// The basis of geometry far beyond its tolerances.
    pub fn loose(&self) -> &Projector {
        self.loose.get_or_init(|| Projector::new(&[&self.geometry], &self.residual))
    }

    /// Columns of one carrier.
    pub fn columns_of(&self, carrier: Carrier) -> Option<std::ops::Range<usize>> {
        self.places.iter().find(|(place, _)| *place == carrier).map(|(_, range)| range.clone())
    }
}

/// The arm in every row of the data, with the model's deflections.
pub fn postures(model: &EffectModel, arm: &Arm, data: &Measurements) -> Vec<Posture> {
    let start = || (model.standing(arm), Perturbation::none(arm.joints.len()));
    let stretches = in_stretches(data.len(), start, |(standing, perturbation), rows| {
        let mut at = |index: usize| {
            perturbation.clear();
            model.stand(&Conditions::of(Row::new(data, index)), &arm.joints, standing, perturbation).clone()
        };
        rows.map(&mut at).collect::<Vec<_>>()
    });
    stretches.into_iter().flatten().collect()
}
