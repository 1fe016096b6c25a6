//! Prediction errors, on the rows of a fit and on other rows.

use crate::arm::{Arm, Perturbation, Row, RowState};
use crate::initial_guess::{level, mean_pose};
use crate::observe::{Discrepancy, Seen, model_of};
use crate::parameters::Effects;
use crate::solve::Fit;
use denavit_linear::threads::in_stretches;
use denavit_measurements::kinds::{Frame, Part};
use denavit_measurements::{Measurements, MissingColumn, Scene, Series, label_of};
use denavit_model::nalgebra::{Point3, Vector3};
use serde::ser::SerializeMap as _;
use serde::{Serialize, Serializer};
use statrs::distribution::{ContinuousCDF, StudentsT};
use std::ops::Range;
use thiserror::Error;

/// Root mean square, mean and largest of the errors of one kind, m or rad: norms where there are three components.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct ErrorSummary {
    /// The kind of error.
    pub part: Part,
    /// Root mean square.
    pub rms: f64,
    /// Mean.
    pub mean: f64,
    /// Largest.
    pub max: f64,
    /// Metres per pixel, for pixels.
    pub per_pixel: Option<f64>,
}

/// Errors of every measured kind, as JSON `position_rms_m`, `position_mean_m`, `position_max_m`,
/// `orientation_rms_rad` and so on; of pixels both `reprojection_rms_m` and `reprojection_rms_px`.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Errors(pub Vec<ErrorSummary>);

impl Errors {
    /// The errors of this word, such as `position`.
    pub fn of(&self, word: &str) -> Option<&ErrorSummary> {
        self.0.iter().find(|error| error.part.word == word)
    }
}

impl Serialize for Errors {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(3 * self.0.len()))?;
        for error in &self.0 {
            let Part { word, unit, .. } = error.part;
            for (what, value) in [("rms", error.rms), ("mean", error.mean), ("max", error.max)] {
                map.serialize_entry(&format!("{word}_{what}_{unit}"), &value)?;
            }
            let pixels = error.per_pixel.map(|size| {
                [("rms", error.rms), ("mean", error.mean), ("max", error.max)].map(|(what, value)| (what, value / size))
            });
            for (what, value) in pixels.into_iter().flatten() {
                map.serialize_entry(&format!("{word}_{what}_px"), &value)?;
            }
        }
        map.end()
    }
}

/// Why a test file cannot be predicted.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum TestError {
    /// Another kind of value was measured.
    #[error("{file}: it holds {found}, but the model was fitted to {expected}; test with the same kind of value")]
    OtherKind {
        /// The test file.
        file: String,
        /// What it holds.
        found: String,
        /// What was fitted.
        expected: String,
    },
    /// A setup whose instrument the fit does not know.
    #[error(
        "{file}: setup \"{setup}\" is not among the fitted ones ({known}), so the position of its instrument is unknown; \
         fit some of its rows, too"
    )]
    UnplacedSetup {
        /// The test file.
        file: String,
        /// The setup.
        setup: String,
        /// Those of the fit.
        known: String,
    },
    /// The rows that were fitted.
    #[error(
        "{file}: these are the rows of {fitted}; a test needs rows that were not fitted: measure some, or say ‹hold-out› 0.3"
    )]
    SameRows {
        /// The test file.
        file: String,
        /// The fitted file.
        fitted: String,
    },
    /// A recorded quantity that the fitted rows have and these lack.
    #[error(
        "{file}: column \"{column}\" of {fitted} is missing here, but effects may depend on it; add it, or remove it from \
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
    /// A recorded quantity that an effect depends on and that some of these rows lack.
    #[error(transparent)]
    IncompleteColumn(MissingColumn),
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

/// Readings closer than this are the same configuration, rad or m: a micrometre on a metre.
const SAME_READING: f64 = 1e-6;

/// One residual: measured minus predicted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Residual {
    /// Index of the row.
    pub row: usize,
    /// Index of the observation.
    pub observation: usize,
    /// Index of the series that it belongs to.
    pub series: usize,
    /// Of the lengths, base frame, m; a single number is in x.
    pub place: Vector3<f64>,
    /// Of the orientation, a rotation vector in the base frame, rad; 0 where none is measured.
    pub turn: Vector3<f64>,
}

impl Residual {
    /// Norm of the error of the lengths, m.
    pub fn distance(&self) -> f64 {
        self.place.norm()
    }
}

/// Residuals of all observations of `data` that do not only place targets.
///
/// # Shape and units
/// The arm's targets, instruments and points are those of `data`: see [`placed`].
pub fn residuals<E: Effects>(arm: &Arm, effects: &E, data: &Measurements) -> Vec<Residual> {
    residuals_of(0..data.len(), arm, effects, data)
}

/// As [`residuals`], of some rows.
pub fn residuals_of<E: Effects>(rows: Range<usize>, arm: &Arm, effects: &E, data: &Measurements) -> Vec<Residual> {
    let first = rows.start;
    let of_rows = |(): &mut (), rows: Range<usize>| {
        EachResidual::of(rows.start + first..rows.end + first, arm, effects, data).collect::<Vec<Residual>>()
    };
    in_stretches(rows.len(), || (), of_rows).concat()
}

/// As [`residuals`] of some rows, one after the other, without keeping all of them.
pub fn each_residual<'a, E: Effects>(
    rows: Range<usize>,
    arm: &'a Arm,
    effects: &'a E,
    data: &'a Measurements,
) -> impl Iterator<Item = Residual> {
    EachResidual::of(rows, arm, effects, data)
}

struct EachResidual<'a, E: Effects> {
    data: &'a Measurements,
    /// In `row`.
    arm: InRow<'a, E>,
    row: usize,
    /// The remaining rows.
    rows: Range<usize>,
    /// The remaining observations of the row.
    observations: Range<usize>,
}

impl<'a, E: Effects> EachResidual<'a, E> {
    fn of(rows: Range<usize>, arm: &'a Arm, effects: &'a E, data: &'a Measurements) -> Self {
        Self { data, arm: InRow::new(arm, effects), row: 0, rows, observations: 0..0 }
    }
}

impl<E: Effects> Iterator for EachResidual<'_, E> {
    type Item = Residual;

    fn next(&mut self) -> Option<Residual> {
        let data = self.data;
        let observation = loop {
            if let Some(observation) = self.observations.next() {
                break observation;
            }
            self.row = self.rows.find(|&row| !data.locate[row])?;
            self.arm.stand(data, self.row);
            self.observations = data.of_row(self.row);
        };
        let (series, values) = (data.series_of(observation), data.observed.values(observation));
        let Discrepancy { place, turn } = model_of(series.kind).discrepancy(&self.arm.seen(series, values));
        Some(Residual { row: self.row, observation, series: data.observed.series(observation), place, turn })
    }
}

/// An arm's state in a row, and the perturbation by effects.
struct InRow<'a, E: Effects> {
    arm: &'a Arm,
    effects: &'a E,
    standing: E::Standing,
    state: RowState,
    perturbation: Perturbation,
}

impl<'a, E: Effects> InRow<'a, E> {
    fn new(arm: &'a Arm, effects: &'a E) -> Self {
        let (standing, perturbation) = (effects.standing(arm), Perturbation::none(arm.joints.len()));
        Self { arm, effects, standing, state: RowState::default(), perturbation }
    }

    fn stand(&mut self, data: &Measurements, row: usize) {
        let Self { arm, effects, standing, state, perturbation } = self;
        perturbation.clear();
        let perturbed = effects.perturb(Row::new(data, row), arm, standing, perturbation);
        arm.state_into(data.reading(row), data.tip_of(row), perturbed.then_some(perturbation), state);
    }

    fn seen<'s>(&'s self, series: &'s Series, values: &'s [f64]) -> Seen<'s> {
        Seen::new(self.arm, &self.state.tip, &self.perturbation, series, values, false)
    }
}

/// The arm with the targets of other data: fitted ones by name, others placed by the `locate` rows.
///
/// The model's residual in a `locate` row must not enter the target's position. Where a fitted row has the same readings, the
/// fitted targets show this residual: the target is placed relative to their measured, not their predicted, positions.
///
/// # Errors
/// Another kind of value, or a target that no row places.
pub fn placed<E: Effects>(fit: &Fit<E>, fitted: &Measurements, data: &Measurements) -> Result<Arm, TestError> {
    let arm = &fit.arm;
    let effects = bound_later(&fit.effects, fitted, data)?;
    let (here, known) = (&data.scene, &fitted.scene);
    if !here.kinds().iter().all(|kind| known.kinds().contains(kind)) {
        return Err(TestError::OtherKind { file: data.source.clone(), found: here.words(), expected: known.words() });
    }
    let sits_on = (0..here.targets.len()).map(|target| here.tip_of(target)).collect();
    let mut placed = Arm { targets: Vec::new(), sits_on, instruments: Vec::new(), points: Vec::new(), ..arm.clone() };
    let fitted_place = |names: &[String], name: &String| names.iter().position(|other| other == name);
    for name in &here.setups {
        let setup = fitted_place(&known.setups, name).map(|setup| arm.instruments[setup]);
        placed.instruments.push(setup.unwrap_or_else(denavit_model::Pose::identity));
    }
    for name in &here.points {
        let point = fitted_place(&known.points, name).map(|point| arm.points[point]);
        placed.points.push(point.unwrap_or_else(Vector3::zeros));
    }
    let unplaced: Vec<usize> =
        (0..here.points.len()).filter(|&point| fitted_place(&known.points, &here.points[point]).is_none()).collect();
    for (target, name) in here.targets.iter().enumerate() {
        let located = locate(fit, &effects, fitted, data, target);
        let own = fitted_place(&known.targets, name).map(|index| arm.targets[index]);
        let pose = match (located, own) {
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
                    known: known.targets.join(", "),
                });
            }
        };
        placed.targets.push(pose);
    }
    for series in here.series.iter().filter(|series| series.kind.unknowns().frame == Frame::Instrument) {
        if !known.setups.contains(&here.setups[series.setup]) {
            let (file, setup) = (data.source.clone(), here.setups[series.setup].clone());
            return Err(TestError::UnplacedSetup { file, setup, known: known.setups.join(", ") });
        }
    }
    place_points(&mut placed, &effects, data, &unplaced);
    let planes = (0..here.setups.len()).filter(|&setup| here.has_plane(setup));
    for plane in planes.filter(|&setup| !known.setups.contains(&here.setups[setup])) {
        place_plane(&mut placed, &effects, data, plane);
    }
    let tools = (0..here.setups.len()).filter(|&setup| here.is_held(setup));
    for setup in tools.filter(|&setup| !known.setups.contains(&here.setups[setup])) {
        place_tool(&mut placed, &effects, data, setup);
    }
    let levels = (0..here.setups.len()).filter(|&setup| here.has_level(setup));
    for setup in levels.filter(|&setup| !known.setups.contains(&here.setups[setup])) {
        place_level(&mut placed, &effects, data, setup);
    }
    Ok(placed)
}

/// Places points that were not fitted, by the rows that see them.
fn place_points<E: Effects>(arm: &mut Arm, effects: &E, data: &Measurements, points: &[usize]) {
    for &point in points {
        let mut there = InRow::new(arm, effects);
        let (mut predicted, mut values, mut kind) = (Vec::new(), Vec::new(), None);
        for row in 0..data.len() {
            for observation in data.of_row(row) {
                let series = data.series_of(observation);
                if series.point == Some(point) {
                    there.stand(data, row);
                    let own = data.observed.values(observation);
                    predicted.push(there.seen(series, own).predicted);
                    values.push(own);
                    kind = Some(series.kind);
                }
            }
        }
        if let Some(place) = kind.and_then(|kind| model_of(kind).points(&predicted, &values).first().copied()) {
            arm.points[point] = place;
        }
    }
}

/// Places a plane that was not fitted, by the rows that touch it.
fn place_plane<E: Effects>(arm: &mut Arm, effects: &E, data: &Measurements, setup: usize) {
    let mut there = InRow::new(arm, effects);
    let (mut predicted, mut values, mut kind) = (Vec::new(), Vec::new(), None);
    for row in 0..data.len() {
        for observation in data.of_row(row).filter(|&observation| data.series_of(observation).setup == setup) {
            let (series, own) = (data.series_of(observation), data.observed.values(observation));
            there.stand(data, row);
            predicted.push(there.seen(series, own).predicted);
            values.push(own);
            kind = Some(series.kind);
        }
    }
    if let Some(plane) = kind.and_then(|kind| model_of(kind).plane(&predicted, &values)) {
        arm.instruments[setup] = plane;
    }
}

/// Places a tool that was not fitted at the mean of the poses by its tips.
fn place_tool<E: Effects>(arm: &mut Arm, effects: &E, data: &Measurements, setup: usize) {
    let mut there = InRow::new(arm, effects);
    let mut tools = Vec::new();
    for row in 0..data.len() {
        for observation in data.of_row(row).filter(|&observation| data.series_of(observation).setup == setup) {
            there.stand(data, row);
            tools.push(there.state.tip * there.arm.targets[data.series_of(observation).target]);
        }
    }
    arm.instruments[setup] = mean_pose(&tools).inverse();
}

/// Levels a frame that was not fitted, by the sensors of its rows.
fn place_level<E: Effects>(arm: &mut Arm, effects: &E, data: &Measurements, setup: usize) {
    let mut there = InRow::new(arm, effects);
    let mut sum = Vector3::zeros();
    for row in 0..data.len() {
        for observation in data.of_row(row).filter(|&observation| data.series_of(observation).setup == setup) {
            let series = data.series_of(observation);
            if let Some(down) = series.kind.down(data.observed.values(observation)) {
                there.stand(data, row);
                sum += there.state.tip.rotation * there.arm.targets[series.target].rotation * down;
            }
        }
    }
    arm.instruments[setup] = level(&sum);
}

/// A known distance between two points, and its value by the rows that see them.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LengthFound {
    /// The points' labels.
    pub between: [String; 2],
    /// As known, m.
    pub known_m: f64,
    /// Between the mean positions, m.
    pub found_m: f64,
}

/// The known distances by the rows alone, with each point at the position of its own rows.
pub fn lengths_found<E: Effects>(arm: &Arm, effects: &E, data: &Measurements) -> Vec<LengthFound> {
    if data.scene.lengths.is_empty() {
        return Vec::new();
    }
    let mut arm = arm.clone();
    place_points(&mut arm, effects, data, &(0..data.scene.points.len()).collect::<Vec<usize>>());
    let found = data.scene.lengths.iter().map(|known| {
        let [a, b] = known.points;
        LengthFound {
            between: known.points.map(|point| label_of(&data.scene.points[point]).to_owned()),
            known_m: known.length,
            found_m: (arm.points[a] - arm.points[b]).norm(),
        }
    });
    found.collect()
}

/// The effects of a fit for other rows than the fitted ones.
///
/// # Errors
/// The rows lack a column that an effect depends on, or a value in it.
pub fn bound_later<E: Effects>(effects: &E, fitted: &Measurements, data: &Measurements) -> Result<E, TestError> {
    effects.bound_to(data).map_err(|missing| match missing {
        MissingColumn::Absent { file, column } => {
            TestError::MissingColumn { file, column, fitted: fitted.source.clone() }
        }
        incomplete => TestError::IncompleteColumn(incomplete),
    })
}

/// Mean position of a target on the tip over the `locate` rows that see it, m; `None` without such rows. `effects`: those of the
/// fit, for `data`.
fn locate<E: Effects>(
    fit: &Fit<E>,
    effects: &E,
    fitted: &Measurements,
    data: &Measurements,
    target: usize,
) -> Option<Vector3<f64>> {
    let arm = &fit.arm;
    let mut there = InRow::new(arm, effects);
    let (mut sum, mut count) = (Vector3::zeros(), 0.0);
    for row in (0..data.len()).filter(|&row| data.locate[row]) {
        for observation in data.of_row(row) {
            let (series, values) = (data.series_of(observation), data.observed.values(observation));
            let Some(measured) = series.kind.position(values).filter(|_| series.target == target) else { continue };
            there.stand(data, row);
            let InRow { state, perturbation, .. } = &there;
            let instrument = instrument_of(arm, fitted, &data.scene.setups[series.setup]);
            let in_base =
                instrument.rotation.inverse() * (measured / (1.0 + perturbation.scale) - instrument.translation.vector);
            let beyond = perturbation.sight.beyond(&measured, &instrument, &state.tip);
            let on_tip = state.tip.inverse()
                * Point3::from(in_base - beyond - mean_residual(fit, fitted, (data.reading(row), data.tip_of(row))));
            sum += on_tip.coords - perturbation.target;
            count += 1.0;
        }
    }
    (count > 0.0).then(|| sum / count)
}

/// Mean residual (measured minus predicted) of the fitted rows with these readings, base frame, m; 0 without such rows.
fn mean_residual<E: Effects>(fit: &Fit<E>, fitted: &Measurements, (reading, tip): (&[f64], usize)) -> Vector3<f64> {
    let alike = |row: &usize| {
        fitted.tip_of(*row) == tip
            && fitted
                .reading(*row)
                .iter()
                .zip(reading)
                .all(|(fitted, reading)| (fitted - reading).abs() <= SAME_READING)
    };
    let rows: Vec<usize> = (0..fitted.len()).filter(alike).collect();
    let weights: Vec<f64> =
        rows.iter().flat_map(|&row| fitted.of_row(row)).map(|observation| fit.weights[observation]).collect();
    let kept: Vec<Vector3<f64>> = residuals(&fit.arm, &fit.effects, &fitted.subset(&rows))
        .into_iter()
        .filter(|residual| {
            weights[residual.observation] > 0.0 && fitted.scene.series[residual.series].kind.place().height == 3
        })
        .map(|residual| residual.place)
        .collect();
    kept.iter().sum::<Vector3<f64>>() / kept.len().max(1) as f64
}

fn instrument_of(arm: &Arm, fitted: &Measurements, setup: &String) -> denavit_model::Pose {
    let index = fitted.scene.setups.iter().position(|name| name == setup);
    index.map_or_else(denavit_model::Pose::identity, |index| arm.instruments[index])
}

/// Whether the mean of these changes is above zero, at the significance level `chance`: Student's test.
pub fn above_zero(changes: &[f64], chance: f64) -> bool {
    let count = changes.len() as f64;
    let Ok(distribution) = StudentsT::new(0.0, 1.0, count - 1.0) else { return false };
    let mean = changes.iter().sum::<f64>() / count;
    let variance = changes.iter().map(|change| (change - mean).powi(2)).sum::<f64>() / (count - 1.0);
    mean > 0.0 && mean > distribution.inverse_cdf(1.0 - chance) * (variance / count).sqrt()
}

/// Root mean square, mean and largest of each kind of error.
pub fn errors<'r>(residuals: impl IntoIterator<Item = &'r Residual>, scene: &Scene) -> Errors {
    let mut sums = ErrorSums::new(scene);
    residuals.into_iter().for_each(|residual| sums.add(residual));
    sums.errors()
}

/// The sums for [`errors`], updated residual by residual.
#[derive(Debug, Clone)]
pub struct ErrorSums<'s> {
    scene: &'s Scene,
    /// For each channel: count, sum, sum of squares, maximum.
    of_channels: Vec<[f64; 4]>,
}

impl<'s> ErrorSums<'s> {
    /// Without residuals.
    pub fn new(scene: &'s Scene) -> Self {
        Self { scene, of_channels: vec![[0.0; 4]; scene.channels.len()] }
    }

    /// Counts a residual.
    pub fn add(&mut self, residual: &Residual) {
        let channels = self.scene.series[residual.series].channels;
        for (channel, vector) in channels.into_iter().zip([&residual.place, &residual.turn]) {
            if let Some(channel) = channel {
                let norm = vector.norm();
                let [count, sum, squares, most] = &mut self.of_channels[channel];
                *count += 1.0;
                *sum += norm;
                *squares += norm * norm;
                *most = most.max(norm);
            }
        }
    }

    /// Adds the sums of others.
    pub fn add_all(&mut self, others: &Self) {
        for (own, other) in self.of_channels.iter_mut().zip(&others.of_channels) {
            let [count, sum, squares, most] = own;
            *count += other[0];
            *sum += other[1];
            *squares += other[2];
            *most = most.max(other[3]);
        }
    }

    /// The errors of every kind that has a residual.
    pub fn errors(&self) -> Errors {
        let of = |(channel, [count, sum, squares, max]): (usize, &[f64; 4])| {
            (*count > 0.0).then(|| ErrorSummary {
                part: self.scene.channels[channel],
                rms: (squares / count).sqrt(),
                mean: sum / count,
                max: *max,
                per_pixel: self.scene.per_pixel(channel),
            })
        };
        Errors(self.of_channels.iter().enumerate().filter_map(of).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::above_zero;

    #[test]
    fn a_mean_is_above_zero_where_chance_hardly_puts_it_there() {
        assert!(above_zero(&[0.9, 1.0, 1.1], 0.025) && above_zero(&[1.0, 1.0], 0.025));
        assert!(!above_zero(&[1.0, -1.0, 1.5, -0.5], 0.025) && !above_zero(&[-1.0, -1.1], 0.025));
        // Student's t of two degrees of freedom: 4.303 at 2.5 %, and this one is 3.46.
        assert!(!above_zero(&[1.0, 2.0, 3.0], 0.025) && above_zero(&[1.0, 2.0, 3.0], 0.05));
        assert!(!above_zero(&[5.0], 0.025) && !above_zero(&[], 0.025));
    }
}
