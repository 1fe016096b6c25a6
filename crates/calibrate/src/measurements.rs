//! Measured data: joint readings and what an instrument saw, row by row in the order in which they were taken.

mod header;
mod plausible;
pub mod poses;
mod problem;
mod read;
mod units;
mod write;

pub use problem::{DataError, DataProblem, Problem};
pub use read::{DataNote, Loaded, read};
pub use units::{Units, UnitsError};
pub use write::write;

use denavit_model::nalgebra::{Rotation3, Vector3};
use serde::{Deserialize, Serialize};

/// What the instrument measures.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum MeasurementKind {
    /// Position and orientation of one target: six numbers per row.
    Pose,
    /// Position of one or several targets: three numbers each.
    Position,
    /// Distance of one target from one fixed anchor: one number.
    Distance,
}

/// A numeric column that is neither a joint reading nor a measured value.
#[derive(Debug, Clone, PartialEq)]
pub struct Covariate {
    /// The column's name, such as `temperature` (°C) or `joint_2.approach`.
    pub name: String,
    /// One value per row, in the column's own unit.
    pub values: Vec<f64>,
}

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
/// With n coordinates, t targets and N rows: `readings` has N·n values (rad, m), row by row in the order of `joints`;
/// `positions` has N·t entries (m, instrument frame), `None` where a target was not seen; `orientations` N rotations
/// for poses, else none; `distances` N values (m) for distances, else none.
#[derive(Debug, Clone, PartialEq)]
pub struct Measurements {
    /// The file's name, for messages.
    pub source: String,
    /// What was measured.
    pub kind: MeasurementKind,
    /// Names of the coordinates, in the chain's order.
    pub joints: Vec<String>,
    /// Joint readings, row by row.
    pub readings: Vec<f64>,
    /// Names of the targets: `""` for `x,y,z`, `"1"` for `x1,y1,z1`; one empty name for distances.
    pub targets: Vec<String>,
    /// Positions of the targets, row by row.
    pub positions: Vec<Option<Vector3<f64>>>,
    /// instrument_from_target rotations.
    pub orientations: Vec<Rotation3<f64>>,
    /// Distances from the anchor, m.
    pub distances: Vec<f64>,
    /// Other numeric columns.
    pub covariates: Vec<Covariate>,
    /// Text columns.
    pub labels: Vec<Label>,
    /// Rows that only say where a target sits on the tip, by row index; not counted in errors.
    pub locate: Vec<bool>,
    /// The line of each row in its file, counted from 1.
    pub lines: Vec<usize>,
}

/// A quaternion whose length is further from 1 than this was not meant as one.
const QUATERNION_TOLERANCE: f64 = 1e-3;
/// Joint readings closer than this are one reading, rad or m.
const SAME_READING: f64 = 1e-9;

impl Measurements {
    /// Whether a coordinate has one reading in all rows.
    pub fn never_moves(&self, coordinate: usize) -> bool {
        let values = || (0..self.len()).map(|row| self.reading(row)[coordinate]);
        let (low, high) = values().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(v), b.max(v)));
        high - low < SAME_READING
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

    /// Measured position of a target in a row, m in the instrument's frame.
    #[inline]
    pub fn position(&self, row: usize, target: usize) -> Option<Vector3<f64>> {
        self.positions.get(row * self.targets.len() + target).copied().flatten()
    }

    /// The numeric column of this name.
    pub fn covariate(&self, name: &str) -> Option<&Covariate> {
        self.covariates.iter().find(|covariate| covariate.name == name)
    }

    /// Observations (row, target) in rows: one per target and row, seen or not.
    pub fn observations(&self) -> usize {
        self.len() * self.targets.len()
    }

    /// Numbers measured: 6 per pose, 3 per position seen, 1 per distance.
    pub fn values(&self) -> usize {
        match self.kind {
            MeasurementKind::Pose => 6 * self.len(),
            MeasurementKind::Position => 3 * self.positions.iter().flatten().count(),
            MeasurementKind::Distance => self.len(),
        }
    }

    /// The rows of these indices, in that order.
    #[must_use]
    pub fn subset(&self, rows: &[usize]) -> Self {
        let targets = self.targets.len();
        let pick = |values: &[f64]| rows.iter().map(|&row| values[row]).collect::<Vec<f64>>();
        Self {
            source: self.source.clone(),
            kind: self.kind,
            joints: self.joints.clone(),
            readings: rows.iter().flat_map(|&row| self.reading(row).iter().copied()).collect(),
            targets: self.targets.clone(),
            positions: if self.positions.is_empty() {
                Vec::new()
            } else {
                rows.iter()
                    .flat_map(|&row| self.positions[row * targets..(row + 1) * targets].iter().copied())
                    .collect()
            },
            orientations: if self.orientations.is_empty() {
                Vec::new()
            } else {
                rows.iter().map(|&row| self.orientations[row]).collect()
            },
            distances: if self.distances.is_empty() { Vec::new() } else { pick(&self.distances) },
            covariates: self
                .covariates
                .iter()
                .map(|column| Covariate { name: column.name.clone(), values: pick(&column.values) })
                .collect(),
            labels: self
                .labels
                .iter()
                .map(|column| Label {
                    name: column.name.clone(),
                    values: rows.iter().map(|&row| column.values[row].clone()).collect(),
                })
                .collect(),
            locate: rows.iter().map(|&row| self.locate[row]).collect(),
            lines: rows.iter().map(|&row| self.lines[row]).collect(),
        }
    }
}
