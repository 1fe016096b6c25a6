//! Images of a board in a measurement file: the rows of one image, the corner of each row, the pose of each image.

use super::Measurements;
use super::header::{CornerOf, Group, Header, Role};
use super::measurement_error::MeasurementError;
use super::rows::number;
use super::scene::Series;
use crate::board::{Camera, Corner, Sight};
use crate::kinds::ObservationKind;
use denavit_model::nalgebra::Vector2;
use std::sync::Arc;

/// The camera of a file, while it is read.
pub(super) struct Images<'a> {
    sight: &'a Sight,
    camera: Arc<Camera>,
    before: Option<csv::StringRecord>,
}

impl<'a> Images<'a> {
    pub fn new(sight: &'a Sight) -> Self {
        let camera = Camera { lens: sight.lens.clone(), on_hand: sight.on_hand, range: 1.0 };
        Self { sight, camera: Arc::new(camera), before: None }
    }

    /// Whether a row belongs to the same image as the one before: only the corner and its pixel differ.
    pub fn goes_on(&mut self, header: &Header, record: &csv::StringRecord) -> bool {
        if !header.roles.contains(&Role::Corner) {
            return false;
        }
        let own = |role: &Role| match role {
            Role::Corner => true,
            Role::Value(group, _) => header.groups[*group].corner.is_some(),
            _ => false,
        };
        let same = |before: &csv::StringRecord| {
            let cells = header.roles.iter().zip(before.iter().zip(record));
            before.len() == record.len() && cells.into_iter().all(|(role, (a, b))| own(role) || a == b)
        };
        let goes_on = self.before.as_ref().is_some_and(same);
        self.before = Some(record.clone());
        goes_on
    }

    /// The corner that a group's pixels are of.
    pub fn corner(
        &self,
        header: &Header,
        of: &Group,
        record: &csv::StringRecord,
        factors: &[f64],
    ) -> Result<Corner, MeasurementError> {
        let (label, at) = match &of.corner {
            Some(CornerOf::Placed(columns)) => {
                let cell = |column: usize| number(&header.names[column], &record[column]).map(|v| v * factors[column]);
                let at = Vector2::new(cell(columns[0])?, cell(columns[1])?);
                (format!("{},{}", at.x, at.y), Some(at))
            }
            Some(CornerOf::Numbered(column)) => self.numbered(record[*column].trim_end_matches(".0")),
            Some(CornerOf::Named(name)) => self.numbered(name),
            None => (String::new(), None),
        };
        let wrong = || {
            let last = self.sight.board.map_or(0, |board| board.corners() - 1);
            let board = self.sight.board.map_or_else(String::new, |board| board.to_string());
            MeasurementError::NoSuchCorner { corner: label.clone(), board, last }
        };
        let at = at.ok_or_else(wrong)?;
        Ok(Corner { label, at, camera: self.camera.clone() })
    }

    fn numbered(&self, text: &str) -> (String, Option<Vector2<f64>>) {
        let at = text.parse().ok().and_then(|number| self.sight.board?.corner(number));
        (text.to_owned(), at)
    }

    /// The error for a pixel outside the image.
    pub fn outside(&self, columns: &[String], pixel: [f64; 2]) -> Option<MeasurementError> {
        let [width, height] = self.sight.lens.size?;
        // Corners are found to fractions of a pixel, at the edge as well.
        let outside = |(value, size): (f64, f64)| value < -1.0 || value > size + 1.0;
        let which = (0..2).find(|&k| outside((pixel[k], [width, height][k])))?;
        Some(MeasurementError::OutsideImage { column: columns[which].clone(), value: pixel[which], width, height })
    }
}

/// Distance of the boards, m: the median of all images; `None` where no image determines it.
pub(super) fn range(data: &Measurements) -> Option<f64> {
    let mut ranges: Vec<f64> = (0..data.len())
        .flat_map(|row| together(data, row))
        .map(|(_, _, values)| Vector2::new(values[0], values[1]).push(values[2]).norm())
        .collect();
    ranges.sort_by(f64::total_cmp);
    ranges.get(ranges.len() / 2).copied()
}

/// The quantities that a row's observations determine together: the first series of each, the kind and its numbers.
fn together(data: &Measurements, row: usize) -> Vec<(&Series, ObservationKind, Vec<f64>)> {
    let mut parts: Vec<Vec<(&Series, &[f64])>> = Vec::new();
    for observation in data.of_row(row) {
        let (series, values) = (data.series_of(observation), data.observed.values(observation));
        let of = |series: &Series| (series.kind, series.setup, series.target);
        match parts.iter().position(|part| of(part[0].0) == of(series)) {
            Some(known) => parts[known].push((series, values)),
            None => parts.push(vec![(series, values)]),
        }
    }
    let said = parts.iter().filter_map(|part| {
        let corners = part.iter().filter_map(|(series, values)| Some((series.corner.as_ref()?, *values)));
        let (kind, values) = part[0].0.kind.together(&corners.collect::<Vec<_>>())?;
        Some((part[0].0, kind, values))
    });
    said.collect()
}

impl Measurements {
    /// The same with each image replaced by its board pose, for a fit to start from; `None` without images.
    ///
    /// Setups, targets and points keep their indices.
    pub fn as_poses(&self) -> Option<Self> {
        if !self.scene.series.iter().any(|series| series.corner.is_some()) {
            return None;
        }
        let mut posed = Self::empty(&self.source, self.joints.clone(), self.scene.unobserved());
        posed.covariates.clone_from(&self.covariates);
        for row in 0..self.len() {
            for observation in self.of_row(row) {
                let series = self.series_of(observation);
                if series.corner.is_none() {
                    let own = posed.scene.adopt(&self.scene, series);
                    posed.observed.adopt(own, &self.observed, observation);
                }
            }
            for (series, kind, values) in together(self, row) {
                let (setup, target) = (&self.scene.setups[series.setup], self.scene.target(series.target));
                let own = posed.scene.add(kind, setup, target, None);
                posed.observed.push(own, &values);
            }
            posed.end_row(self.reading(row), self.lines[row], self.locate[row]);
        }
        Some(posed)
    }
}
