//! Measured data: joint readings and an instrument's measured values, row by row in the order of measurement.
//!
//! ```text
//! a file ─► import ─► header, columns, units ─► read ─► Measurements ─► write
//!                                                       scene: setups, targets, points, series of one kind each
//! ```
//! Lengths are m, angles rad. Predictions of rows are in `denavit-identify`. For denavit's own crates: its contents change
//! without notice; the stable names are those at the root of `denavit-calibrate`.

pub mod board;
pub mod columns;
mod copies;
pub mod covariates;
mod data_note;
mod header;
mod images;
pub mod import;
mod join;
pub mod kinds;
mod known_columns;
pub mod lens;
mod measurement_error;
mod near_miss;
mod observations;
pub mod plate;
mod plausible;
pub mod pose_pairs;
pub mod poses;
mod postures;
mod read;
mod rows;
mod scene;
mod units;
mod write;

pub use columns::ColumnUse;
pub use covariates::{Column, Covariate, Covariates, MissingColumn, RecordedRow};
pub use data_note::DataNote;
pub use header::word_of_two_tips;
pub use join::read_socket;
pub use measurement_error::{DataError, DataProblem, MeasurementError};
pub use observations::Observations;
pub use postures::Postures;
pub use read::{Loaded, read, read_export};
pub use scene::{KnownLength, Scene, Series, Target, label_of, target_on};
pub use units::{Units, UnitsError};
pub use write::write;

use denavit_model::nalgebra::Vector3;
use import::WrittenAngles;
use std::ops::Range;

/// A text column.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Label {
    /// The column's name.
    pub name: String,
    /// One text per row.
    pub values: Vec<String>,
}

/// A measurement file's content in SI units; row order is run order.
///
/// # Shape and units
/// With n coordinates and N rows `readings` has N·n values (rad, m), row by row in the order of `joints`. A row has any
/// number of observations; the scene describes them.
#[derive(Debug, Clone, PartialEq)]
pub struct Measurements {
    /// The file's name, for messages.
    pub source: String,
    /// Names of the coordinates, in the chain's order.
    pub joints: Vec<String>,
    /// Joint readings, row by row.
    pub readings: Vec<f64>,
    /// Targets, instruments and kinds of observation.
    pub scene: Scene,
    /// The observations of each row.
    pub observed: Observations,
    /// Other numeric columns.
    pub covariates: Covariates,
    /// Text columns.
    pub labels: Vec<Label>,
    /// The angles of an orientation as written in the file, if it has angles; row by row.
    pub angles: Option<WrittenAngles>,
    /// Rows that only locate a target on the tip, by row index; not counted in errors.
    pub locate: Vec<bool>,
    /// The line of each row in its file, counted from 1.
    pub lines: Vec<usize>,
}

/// Largest deviation of a quaternion's length from 1.
pub const QUATERNION_TOLERANCE: f64 = 1e-3;
/// Joint readings closer than this are equal, rad or m.
const SAME_READING: f64 = 1e-9;

impl Measurements {
    /// No rows yet.
    pub fn empty(source: &str, joints: Vec<String>, scene: Scene) -> Self {
        Self {
            source: source.into(),
            joints,
            readings: Vec::new(),
            scene,
            observed: Observations::default(),
            covariates: Covariates::none(),
            labels: Vec::new(),
            angles: None,
            locate: Vec::new(),
            lines: Vec::new(),
        }
    }

    /// Appends a row whose observations have been pushed already.
    ///
    /// # Shape and units
    /// `reading`: one value per coordinate, rad or m; `line` counts from 1.
    pub fn end_row(&mut self, reading: &[f64], line: usize, locate: bool) {
        self.readings.extend_from_slice(reading);
        self.observed.end_row();
        self.locate.push(locate);
        self.lines.push(line);
    }

    /// Index of the tip that a row is of.
    #[inline]
    pub fn tip_of(&self, row: usize) -> usize {
        let first = self.of_row(row).next();
        first.map_or(0, |observation| self.scene.tip_of(self.series_of(observation).target))
    }

    /// Whether a coordinate moves the tip that a row is of.
    pub fn moves_its_tip(&self, row: usize, coordinate: usize) -> bool {
        self.scene.tips().is_none_or(|tips| tips[self.tip_of(row)].coordinates[coordinate])
    }

    /// Whether a coordinate has one reading in all rows whose tip it moves.
    pub fn never_moves(&self, coordinate: usize) -> bool {
        let rows = || (0..self.len()).filter(|&row| self.moves_its_tip(row, coordinate));
        let values = || rows().map(|row| self.reading(row)[coordinate]);
        let (low, high) = values().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(v), b.max(v)));
        high - low < SAME_READING
    }

    /// Frees memory that was reserved for more rows.
    pub fn shrink(&mut self) {
        self.readings.shrink_to_fit();
        self.locate.shrink_to_fit();
        self.lines.shrink_to_fit();
        self.observed.shrink();
        self.covariates.shrink();
    }

    /// Number of rows.
    pub fn len(&self) -> usize {
        self.lines.len()
    }

    /// Whether there is no row.
    pub fn is_empty(&self) -> bool {
        self.lines.is_empty()
    }

    /// Joint readings of a row, rad or m.
    #[inline]
    pub fn reading(&self, row: usize) -> &[f64] {
        let n = self.joints.len();
        &self.readings[row * n..(row + 1) * n]
    }

    /// The series of an observation.
    #[inline]
    pub fn series_of(&self, observation: usize) -> &Series {
        &self.scene.series[self.observed.series(observation)]
    }

    /// Indices of a row's observations.
    #[inline]
    pub fn of_row(&self, row: usize) -> Range<usize> {
        self.observed.of_row(row)
    }

    /// Index of the first observation of a target in a row.
    pub fn of_target(&self, row: usize, target: usize) -> Option<usize> {
        self.of_row(row).find(|&observation| self.series_of(observation).target == target)
    }

    /// Measured position of a target in a row, m in the instrument's frame.
    pub fn position(&self, row: usize, target: usize) -> Option<Vector3<f64>> {
        if row >= self.len() {
            return None;
        }
        self.of_row(row).find_map(|observation| {
            let series = self.series_of(observation);
            let here = series.target == target;
            here.then(|| series.kind.position(self.observed.values(observation))).flatten()
        })
    }

    /// The numeric column of this name.
    pub fn covariate(&self, name: &str) -> Option<&Covariate> {
        self.covariates.iter().find(|covariate| covariate.name == name)
    }

    /// A recorded quantity that an effect may depend on: a numeric column with a value in every row.
    ///
    /// # Errors
    /// There is no such column, or a row has no value in it.
    pub fn column(&self, name: &str) -> Result<Column, MissingColumn> {
        self.covariates.column(&self.source, self.len(), name)
    }

    /// Number of observations.
    pub fn observations(&self) -> usize {
        self.observed.len()
    }

    /// Upper bound of the residual values of a row: no series is observed twice in a row.
    pub fn tallest_row(&self) -> usize {
        self.scene.series.iter().map(|series| series.kind.height()).sum()
    }

    /// Numbers measured: 6 per pose, 3 per position, 1 per distance.
    pub fn values(&self) -> usize {
        (0..self.observations()).map(|observation| self.series_of(observation).kind.height()).sum()
    }

    /// Indices of this many rows, at most all, spread evenly over the run.
    pub fn evenly_spread(&self, count: usize) -> Vec<usize> {
        (0..count).map(|k| k * self.len() / count).collect()
    }

    /// The rows of these indices, in that order.
    #[must_use]
    pub fn subset(&self, rows: &[usize]) -> Self {
        let pick = |values: &[f64]| rows.iter().map(|&row| values[row]).collect::<Vec<f64>>();
        Self {
            source: self.source.clone(),
            joints: self.joints.clone(),
            readings: rows.iter().flat_map(|&row| self.reading(row).iter().copied()).collect(),
            scene: self.scene.clone(),
            observed: self.observed.subset(rows.iter().copied(), Some),
            covariates: self
                .covariates
                .iter()
                .map(|column| Covariate { name: column.name.clone(), values: pick(&column.values) })
                .collect::<Vec<_>>()
                .into(),
            labels: self
                .labels
                .iter()
                .map(|column| Label {
                    name: column.name.clone(),
                    values: rows.iter().map(|&row| column.values[row].clone()).collect(),
                })
                .collect(),
            angles: self.angles.as_ref().map(|angles| WrittenAngles {
                numbers: rows.iter().map(|&row| angles.numbers[row]).collect(),
                ..angles.clone()
            }),
            locate: rows.iter().map(|&row| self.locate[row]).collect(),
            lines: rows.iter().map(|&row| self.lines[row]).collect(),
        }
    }

    /// Removes the targets for which `keep` is false, and their observations.
    pub fn keep_targets(&mut self, keep: &[bool]) {
        let series = self.scene.series.clone();
        self.keep_series(|index| keep[series[index].target]);
    }

    /// Removes series, and setups, targets and points that only they use.
    fn keep_series(&mut self, keep: impl Fn(usize) -> bool) {
        let none = self.scene.of_same_robot();
        let old = std::mem::replace(&mut self.scene, none);
        let series = old.series.iter().enumerate();
        let kept: Vec<Option<usize>> =
            series.map(|(index, series)| keep(index).then(|| self.scene.adopt(&old, series))).collect();
        self.observed = self.observed.subset(0..self.lines.len(), |series| kept[series]);
        for known in &old.lengths {
            let [a, b] = known.points.map(|point| self.scene.points.iter().position(|name| *name == old.points[point]));
            if let (Some(a), Some(b)) = (a, b) {
                self.scene.lengths.push(KnownLength { points: [a, b], ..known.clone() });
            }
        }
    }

    /// Removes setups, targets and points that no row uses.
    #[must_use]
    pub fn pruned(mut self) -> Self {
        let mut seen = vec![false; self.scene.series.len()];
        (0..self.observations()).for_each(|observation| seen[self.observed.series(observation)] = true);
        self.keep_series(|series| seen[series]);
        self
    }
}
