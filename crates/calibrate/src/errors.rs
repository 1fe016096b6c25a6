//! How far predictions are from measured values, on the rows of a fit and on rows that it never saw.

use crate::arm::{Arm, Deviation, Row, RowState};
use crate::measurements::{MeasurementKind, Measurements};
use crate::parameters::Effects;
use crate::solve::Fit;
use denavit_model::nalgebra::{Point3, Rotation3, Vector3};
use denavit_model::se3;
use serde::{Deserialize, Serialize};
use thiserror::Error;

/// Norms of the residuals: of positions in three dimensions, of orientations as angles, of distances as they are.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Errors {
    /// Root mean square of the position error, m.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub position_rms_m: Option<f64>,
    /// Mean position error, m.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub position_mean_m: Option<f64>,
    /// Largest position error, m.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub position_max_m: Option<f64>,
    /// Root mean square of the orientation error, rad.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub orientation_rms_rad: Option<f64>,
    /// Mean orientation error, rad.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub orientation_mean_rad: Option<f64>,
    /// Largest orientation error, rad.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub orientation_max_rad: Option<f64>,
    /// Root mean square of the distance error, m.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub distance_rms_m: Option<f64>,
    /// Mean distance error, m.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub distance_mean_m: Option<f64>,
    /// Largest distance error, m.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub distance_max_m: Option<f64>,
}

/// Why a test file cannot be predicted.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum TestError {
    /// Another kind of value was measured.
    #[error("{file}: it measures {found}, but the model was fitted to {expected}; test with the same kind of value")]
    OtherKind {
        /// The test file.
        file: String,
        /// What it holds.
        found: &'static str,
        /// What was fitted.
        expected: &'static str,
    },
    /// The rows that were fitted.
    #[error(
        "{file}: these are the rows of {fitted}; a test needs rows that were not fitted: measure some, or say --hold-out 0.3"
    )]
    SameRows {
        /// The test file.
        file: String,
        /// The fitted file.
        fitted: String,
    },
    /// A recorded quantity that the fitted rows have and these lack.
    #[error(
        "{file}: column \"{column}\" of {fitted} is missing here, and effects may follow it; add it, or remove it from \
         both files"
    )]
    MissingColumn {
        /// The test file.
        file: String,
        /// The column.
        column: String,
        /// The fitted file.
        fitted: String,
    },
    /// A target that the fit does not know and no row places.
    #[error(
        "{file}: target \"{target}\" is not among the fitted ones ({known}) and no row places it; set locate = 1 in a \
         row that sees it, or measure a fitted target"
    )]
    UnplacedTarget {
        /// The test file.
        file: String,
        /// The target.
        target: String,
        /// Those of the fit.
        known: String,
    },
}

/// Readings nearer than this are the same configuration, rad or m: a micrometre on a metre.
const SAME_READING: f64 = 1e-6;

/// The word for a kind of measurement.
pub fn kind_word(kind: MeasurementKind) -> &'static str {
    match kind {
        MeasurementKind::Pose => "poses",
        MeasurementKind::Position => "positions",
        MeasurementKind::Distance => "distances",
    }
}

/// One residual: measured minus predicted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Residual {
    /// Index of the row.
    pub row: usize,
    /// Index of the target.
    pub target: usize,
    /// Of the position, base frame, m; for distances along x.
    pub position: Vector3<f64>,
    /// Rotation vector, base frame, rad; 0 unless poses are measured.
    pub orientation: Vector3<f64>,
}

impl Residual {
    /// Norm of the position (or distance) error, m.
    pub fn distance(&self) -> f64 {
        self.position.norm()
    }
}

/// Residuals of all observations of `data` that were seen and do not only place targets.
///
/// # Shape and units
/// The arm's targets are those of `data`: see [`placed`].
pub fn residuals<E: Effects>(arm: &Arm, effects: &E, data: &Measurements) -> Vec<Residual> {
    let mut found = Vec::new();
    let (mut state, mut deviation) = (RowState::default(), Deviation::none(arm.joints.len()));
    for row in (0..data.len()).filter(|&row| !data.locate[row]) {
        stand(arm, effects, data, row, &mut state, &mut deviation);
        for (target, on_tip) in arm.targets.iter().enumerate() {
            let predicted =
                state.tip.rotation * (on_tip.translation.vector + deviation.target) + state.tip.translation.vector;
            if data.kind == MeasurementKind::Distance {
                let distance = (predicted - arm.anchor - deviation.anchor).norm() * (1.0 + deviation.scale);
                let error = data.distances[row] - distance - deviation.reading;
                let position = Vector3::new(error, 0.0, 0.0);
                found.push(Residual { row, target, position, orientation: Vector3::zeros() });
                continue;
            }
            let Some(measured) = data.position(row, target) else { continue };
            let position = in_base(arm, measured, deviation.scale) - predicted;
            let orientation = data.orientations.get(row).map_or_else(Vector3::zeros, |measured: &Rotation3<f64>| {
                let predicted = state.tip.rotation * on_tip.rotation;
                se3::rotation_vector(&(arm.instrument.rotation.inverse() * measured * predicted.inverse()))
            });
            found.push(Residual { row, target, position, orientation });
        }
    }
    found
}

fn stand<E: Effects>(
    arm: &Arm,
    effects: &E,
    data: &Measurements,
    row: usize,
    state: &mut RowState,
    deviation: &mut Deviation,
) {
    deviation.clear();
    let deviates = effects.deviate(Row::new(data, row), arm, deviation);
    arm.state_into(data.reading(row), deviates.then_some(deviation), state);
}

fn in_base(arm: &Arm, measured: Vector3<f64>, scale: f64) -> Vector3<f64> {
    arm.instrument.rotation.inverse() * (measured / (1.0 + scale) - arm.instrument.translation.vector)
}

/// The arm with the targets of other data: fitted ones by name, others where the `locate` rows put them.
///
/// What the model leaves unexplained where a `locate` row stands is no part of the target's place. Where a fitted row has
/// the same readings, the fitted targets show it: the target is placed beside where they are seen, not beside where they
/// are predicted.
///
/// # Errors
/// Another kind of value, or a target that nothing places.
pub fn placed<E: Effects>(fit: &Fit<E>, fitted: &Measurements, data: &Measurements) -> Result<Arm, TestError> {
    let arm = &fit.arm;
    if data.kind != fitted.kind {
        return Err(TestError::OtherKind {
            file: data.source.clone(),
            found: kind_word(data.kind),
            expected: kind_word(fitted.kind),
        });
    }
    let mut placed = arm.clone();
    placed.targets.clear();
    for (target, name) in data.targets.iter().enumerate() {
        let located = locate(fit, fitted, data, target);
        let known = fitted.targets.iter().position(|other| other == name).map(|index| arm.targets[index]);
        let pose = match (located, known) {
            (Some(place), orientation) => {
                let mut pose = orientation.unwrap_or_default();
                pose.translation.vector = place;
                pose
            }
            (None, Some(pose)) => pose,
            (None, None) => {
                return Err(TestError::UnplacedTarget {
                    file: data.source.clone(),
                    target: name.clone(),
                    known: fitted.targets.join(", "),
                });
            }
        };
        placed.targets.push(pose);
    }
    Ok(placed)
}

/// Mean place of a target on the tip over the `locate` rows that see it, m; `None` without such rows.
fn locate<E: Effects>(fit: &Fit<E>, fitted: &Measurements, data: &Measurements, target: usize) -> Option<Vector3<f64>> {
    let arm = &fit.arm;
    let (mut state, mut deviation) = (RowState::default(), Deviation::none(arm.joints.len()));
    let (mut sum, mut count) = (Vector3::zeros(), 0.0);
    for row in (0..data.len()).filter(|&row| data.locate[row] && data.kind != MeasurementKind::Distance) {
        let Some(measured) = data.position(row, target) else { continue };
        stand(arm, &fit.effects, data, row, &mut state, &mut deviation);
        let seen = in_base(arm, measured, deviation.scale) - leftover(fit, fitted, data.reading(row));
        let on_tip = state.tip.inverse() * Point3::from(seen);
        sum += on_tip.coords - deviation.target;
        count += 1.0;
    }
    (count > 0.0).then(|| sum / count)
}

/// Mean residual (measured minus predicted) of the fitted rows with these readings, base frame, m; 0 without such rows.
fn leftover<E: Effects>(fit: &Fit<E>, fitted: &Measurements, reading: &[f64]) -> Vector3<f64> {
    let alike = |row: &usize| {
        fitted.reading(*row).iter().zip(reading).all(|(fitted, reading)| (fitted - reading).abs() <= SAME_READING)
    };
    let rows: Vec<usize> = (0..fitted.len()).filter(alike).collect();
    let targets = fitted.targets.len();
    let kept: Vec<Vector3<f64>> = residuals(&fit.arm, &fit.effects, &fitted.subset(&rows))
        .into_iter()
        .filter(|residual| fit.weights[rows[residual.row] * targets + residual.target] > 0.0)
        .map(|residual| residual.position)
        .collect();
    kept.iter().sum::<Vector3<f64>>() / kept.len().max(1) as f64
}

/// Root mean square, mean and largest of each kind of value.
pub fn errors(residuals: &[Residual], kind: MeasurementKind) -> Errors {
    if residuals.is_empty() {
        return Errors::default();
    }
    let summary = |values: Vec<f64>| {
        let count = values.len() as f64;
        let rms = (values.iter().map(|v| v * v).sum::<f64>() / count).sqrt();
        (Some(rms), Some(values.iter().sum::<f64>() / count), Some(values.iter().fold(0.0f64, |a, b| a.max(*b))))
    };
    let (rms, mean, max) = summary(residuals.iter().map(Residual::distance).collect());
    match kind {
        MeasurementKind::Distance => {
            Errors { distance_rms_m: rms, distance_mean_m: mean, distance_max_m: max, ..Errors::default() }
        }
        MeasurementKind::Position => {
            Errors { position_rms_m: rms, position_mean_m: mean, position_max_m: max, ..Errors::default() }
        }
        MeasurementKind::Pose => {
            let (o_rms, o_mean, o_max) = summary(residuals.iter().map(|r| r.orientation.norm()).collect());
            Errors {
                position_rms_m: rms,
                position_mean_m: mean,
                position_max_m: max,
                orientation_rms_rad: o_rms,
                orientation_mean_rad: o_mean,
                orientation_max_rad: o_max,
                ..Errors::default()
            }
        }
    }
}
