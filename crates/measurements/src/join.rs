//! Several files in one fit, and separating the rows of some setups.

use super::{Covariate, DataError, DataProblem, Label, MeasurementError, Measurements, Scene, Target, label_of};
use crate::kinds::{Frame, ObservationKind};
use denavit_model::{Chain, Quantity};
use std::io::Read;

use super::rows::{Problems, line_of, number, rows_of, unreadable};
use super::units::Units;

impl Measurements {
    /// The rows of several files one after another; only columns that all files have are kept.
    ///
    /// Known distances are those of all parts.
    ///
    /// # Shape and units
    /// At least one part, all of them of the same joints.
    pub fn joined(parts: Vec<Self>) -> Option<Self> {
        let mut parts = parts.into_iter();
        let mut all = parts.next()?;
        for part in parts {
            all.source = format!("{}, {}", all.source, part.source);
            all.angles = match (all.angles.take(), part.angles.as_ref()) {
                (Some(mut own), Some(other)) if (own.read_as, own.by_axis) == (other.read_as, other.by_axis) => {
                    own.numbers.extend_from_slice(&other.numbers);
                    Some(own)
                }
                _ => None,
            };
            let series: Vec<usize> =
                part.scene.series.iter().map(|series| all.scene.adopt(&part.scene, series)).collect();
            for row in 0..part.len() {
                for observation in part.of_row(row) {
                    all.observed.adopt(series[part.observed.series(observation)], &part.observed, observation);
                }
                all.end_row(part.reading(row), part.lines[row], part.locate[row]);
            }
            let both = common(
                all.covariates.into_columns(),
                &part.covariates,
                |c| &c.name,
                |own: &mut Covariate, other| {
                    own.values.extend_from_slice(&other.values);
                },
            );
            all.covariates = both.into();
            all.labels = common(
                all.labels,
                &part.labels,
                |l| &l.name,
                |own: &mut Label, other| {
                    own.values.extend_from_slice(&other.values);
                },
            );
        }
        if let Some(range) = all.scene.range() {
            all.scene.set_range(range);
        }
        Some(all)
    }

    /// The same with this prefix in the name of every setup, so that each file has its own setups.
    #[must_use]
    pub fn of_setup(mut self, name: &str) -> Self {
        let none = self.scene.of_same_robot();
        let old = std::mem::replace(&mut self.scene, none);
        for series in &old.series {
            let (setup, of) = (&old.setups[series.setup], old.target(series.target));
            let point = series.point.map(|point| label_of(&old.points[point]).to_owned());
            let (setup, target, point) = if setup == series.kind.own_setup() {
                in_setup(series.kind, name, of.name, point.as_deref().unwrap_or(""))
            } else {
                (setup.clone(), of.name.to_owned(), point.unwrap_or_default())
            };
            let target = Target { name: &target, tip: of.tip };
            match &series.corner {
                Some(corner) => self.scene.add_corner(series.kind, &setup, target, corner.clone()),
                None => self.scene.add(series.kind, &setup, target, Some(&point)),
            };
        }
        self
    }

    /// The observations in one setup: its rows, and the indices of their observations.
    pub fn of_one_setup(&self, setup: usize) -> (Self, Vec<usize>) {
        let own = |observation: &usize| self.series_of(*observation).setup == setup;
        let rows: Vec<usize> = (0..self.len()).filter(|&row| self.of_row(row).any(|at| own(&at))).collect();
        let observations = rows.iter().flat_map(|&row| self.of_row(row)).filter(own).collect();
        let mut part = self.subset(&rows);
        part.keep_series(|series| self.scene.series[series].setup == setup);
        (part, observations)
    }

    /// The same with new positions for all sockets and tools held by two tips: they may have been moved since.
    #[must_use]
    pub fn placed_again(mut self) -> Self {
        let anew: Vec<usize> = self
            .scene
            .series
            .iter()
            .filter(|series| series.kind.own_target().is_some())
            .filter_map(|series| series.point)
            .collect();
        let held: Vec<usize> = (0..self.scene.setups.len()).filter(|&setup| self.scene.is_held(setup)).collect();
        for (_, name) in self.scene.points.iter_mut().enumerate().filter(|(index, _)| anew.contains(index)) {
            *name = name.replacen(' ', " test/", 1);
        }
        for setup in held {
            self.scene.setups[setup].insert_str(0, "test/");
        }
        self
    }

    /// The rows of no setup in `setups`, and the rows of these setups; a placement of sockets is a setup, too.
    ///
    /// # Errors
    /// The first name that is not a setup.
    pub fn apart(&self, setups: &[String]) -> Result<(Self, Self), String> {
        let placement = |observation: usize| {
            let series = self.series_of(observation);
            let setup = self.scene.setups[series.setup].as_str();
            let plane = setup.strip_suffix(series.kind.own_setup()).map_or("", str::trim_end);
            let point = series.point.map_or("", |point| label_of(&self.scene.points[point]));
            let placement = point.rsplit_once('/').map_or("", |(placement, _)| placement);
            [setup, plane, placement]
        };
        let of = |row: usize, name: &str| self.of_row(row).any(|observation| placement(observation).contains(&name));
        if let Some(unknown) = setups.iter().find(|name| !(0..self.len()).any(|row| of(row, name))) {
            return Err(unknown.clone());
        }
        let (held, kept): (Vec<usize>, Vec<usize>) =
            (0..self.len()).partition(|&row| setups.iter().any(|name| of(row, name)));
        Ok((self.subset(&kept).pruned(), self.subset(&held).pruned()))
    }
}

/// The names of setup, target and point in a setup of this name; targets that stay on the tip keep their names.
pub(super) fn in_setup(kind: ObservationKind, setup: &str, target: &str, point: &str) -> (String, String, String) {
    let own = kind.own_setup();
    // A plane is a setup, and so is a tool in a row, identified by its label.
    let (setup, point) = match (matches!(kind.unknowns().frame, Frame::Plane | Frame::Grip), setup.is_empty()) {
        (true, true) => (point.to_owned(), ""),
        (true, false) if !point.is_empty() => (format!("{setup}/{point}"), ""),
        _ => (setup.to_owned(), point),
    };
    if setup.is_empty() {
        return (own.into(), target.into(), point.into());
    }
    let separate = if point.is_empty() { setup.clone() } else { format!("{setup}/{point}") };
    let target = if kind.own_target().is_some() { target.into() } else { format!("{target}@{setup}") };
    let setup = if own.is_empty() { setup } else { format!("{setup} {own}") };
    (setup, target, separate)
}

fn common<T>(all: Vec<T>, others: &[T], name: impl Fn(&T) -> &String, join: impl Fn(&mut T, &T)) -> Vec<T> {
    let joined = all.into_iter().filter_map(|mut own| {
        let other = others.iter().find(|other| name(other) == name(&own))?;
        join(&mut own, other);
        Some(own)
    });
    joined.collect()
}

/// Reads a bare file of joint readings, a row per pose and no header, taken with the ball in the socket of this label.
///
/// # Shape and units
/// One number per coordinate of the chain, in its order; `units` are the file's.
///
/// # Errors
/// All problems found, each with file and line.
pub fn read_socket(
    source: &str,
    input: impl Read,
    label: &str,
    chain: &Chain,
    units: Units,
) -> Result<Measurements, DataError> {
    let coordinates = chain.coordinates();
    let mut problems = Problems::new(source);
    let mut reader = rows_of(input);
    let mut scene = Scene::default();
    let series = scene.add(
        ObservationKind::Socket,
        "",
        Target::alone(ObservationKind::Socket.own_target().unwrap_or("")),
        Some(label),
    );
    let joints = coordinates.iter().map(|coordinate| coordinate.name.clone()).collect();
    let mut data = Measurements::empty(source, joints, scene);
    let mut record = csv::StringRecord::new();
    loop {
        match reader.read_record(&mut record) {
            Ok(true) => {}
            Ok(false) => break,
            Err(error) => {
                problems.add(line_of(&error), unreadable(&error));
                break;
            }
        }
        let line = reader.position().line() - 1;
        if record.len() != coordinates.len() {
            let joints = coordinates.iter().map(|c| c.name.as_str()).collect::<Vec<_>>().join(", ");
            problems
                .add(line, MeasurementError::NotReadings { found: record.len(), expected: coordinates.len(), joints });
            continue;
        }
        let mut reading = Vec::new();
        for (cell, coordinate) in record.iter().zip(coordinates) {
            let unit = if coordinate.quantity == Quantity::Angle { units.angle } else { units.length };
            match number(&coordinate.name, cell) {
                Ok(value) => reading.push(value * unit),
                Err(problem) => problems.add(line, problem),
            }
        }
        if reading.len() == coordinates.len() {
            data.observed.push(series, &[]);
            data.end_row(&reading, usize::try_from(line).unwrap_or(usize::MAX), false);
        }
    }
    if data.is_empty() && problems.found.is_empty() {
        problems.add(0, MeasurementError::NoRows);
    }
    if !problems.found.is_empty() {
        return Err(problems.error());
    }
    let beyond = super::plausible::problems(&data, chain);
    let found: Vec<DataProblem> =
        beyond.into_iter().map(|(line, problem)| DataProblem { file: source.into(), line, problem }).collect();
    if found.is_empty() { Ok(data) } else { Err(DataError { problems: found, more: 0 }) }
}
