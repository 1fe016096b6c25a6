//! Screw axes as in code for Lynch and Park's *Modern Robotics*: `M` and `Slist` (in the base frame) or `Blist` (in
//! the end frame).
//!
//! ```text
//! T(q) = e^[S1]q1 … e^[Sn]qn M = M e^[B1]q1 … e^[Bn]qn        Si = Ad(M) Bi
//! ```
//! The book's lists are 6 × n with a screw in each column; code keeps them so, or as n rows of six. The shape decides or,
//! for six joints, the rule that a screw axis has |ω| = 1, or ω = 0 and |v| = 1.

use super::keys::line_of;
use super::stated::Stated;
use super::{Read, Source, SourceError, SourceErrorKind, place, stem};
use denavit_model::chain::{Chain, ChainJoint, Coordinate, Quantity};
use denavit_model::nalgebra::{Matrix3, Rotation3, Vector3, Vector6};
use denavit_model::notes::Note;
use denavit_model::screw::Screw;
use denavit_model::se3::{self, Pose};
use denavit_model::units::Unit;
use denavit_model::{Inventory, words};
use serde_json::Value;

/// Screw axes are written to a few digits: |ω| may miss 1 by this.
const UNIT: f64 = 1e-3;

/// Two lists agree to this, relative to a length of 1 m or the largest number.
const SAME: f64 = 1e-3;

const SPACE: [&str; 3] = ["slist", "s_list", "slistspace"];
const BODY: [&str; 3] = ["blist", "b_list", "slistbody"];

fn entry<'a>(value: &'a Value, names: &[&str]) -> Option<(&'a str, &'a Value)> {
    let entries = value.as_object()?;
    let found = entries.iter().find(|(key, _)| names.contains(&key.to_lowercase().as_str()));
    found.map(|(key, value)| (key.as_str(), value))
}

/// Whether a JSON file holds such screw axes.
pub(super) fn is_one(value: &Value) -> bool {
    value.get("schema").is_none()
        && entry(value, &["m"]).is_some()
        && (entry(value, &SPACE).is_some() || entry(value, &BODY).is_some())
}

struct Reader<'a> {
    file: &'a str,
    text: &'a str,
}

impl Reader<'_> {
    fn wrong(&self, key: &str, what: impl Into<String>) -> SourceError {
        let place = place(self.file, line_of(self.text, key), format!("key \"{}\"", words::quoted(key)));
        SourceError::at(place, SourceErrorKind::Axes(what.into()))
    }

    fn matrix(&self, key: &str, value: &Value) -> Result<Vec<Vec<f64>>, SourceError> {
        let number = |value: &Value| value.as_f64().filter(|number| number.is_finite());
        let row = |value: &Value| value.as_array()?.iter().map(number).collect::<Option<Vec<f64>>>();
        let rows: Option<Vec<Vec<f64>>> = value.as_array().and_then(|rows| rows.iter().map(row).collect());
        let rows = rows.ok_or_else(|| self.wrong(key, "this is not a list of rows of finite numbers"))?;
        let width = rows.first().map_or(0, Vec::len);
        if width == 0 || rows.iter().any(|row| row.len() != width) {
            return Err(self.wrong(key, "its rows have different lengths, or there are none"));
        }
        Ok(rows)
    }

    fn home(&self, key: &str, value: &Value, metre: f64) -> Result<Pose, SourceError> {
        let rows = self.matrix(key, value)?;
        let square = rows.len() == 4 && rows[0].len() == 4 && rows[3] == [0.0, 0.0, 0.0, 1.0];
        if !square {
            return Err(self.wrong(key, "the home pose must have four rows of four numbers, the last row 0 0 0 1"));
        }
        let rotation = Matrix3::from_fn(|row, column| rows[row][column]);
        let place = Vector3::from_fn(|row, _| rows[row][3] * metre);
        Ok(se3::pose(Rotation3::from_matrix_unchecked(rotation), place))
    }

    fn screws(&self, key: &str, value: &Value, metre: f64) -> Result<Vec<Vector6<f64>>, SourceError> {
        let rows = self.matrix(key, value)?;
        let (height, width) = (rows.len(), rows[0].len());
        let of_rows: Vec<Vector6<f64>> =
            if width == 6 { rows.iter().map(|row| Vector6::from_fn(|k, _| row[k])).collect() } else { Vec::new() };
        let of_columns: Vec<Vector6<f64>> =
            if height == 6 { (0..width).map(|j| Vector6::from_fn(|k, _| rows[k][j])).collect() } else { Vec::new() };
        let (by_rows, by_columns) = (are_axes(&of_rows), are_axes(&of_columns));
        let found = match (by_rows, by_columns) {
            (true, false) => of_rows,
            (false, true) => of_columns,
            (true, true) => {
                return Err(
                    self.wrong(key, "both rows and columns can be screw axes; write n rows of six in denavit.poe/1")
                );
            }
            (false, false) if width != 6 && height != 6 => {
                return Err(
                    self.wrong(key, format!("each screw axis needs six numbers, but this is {height} × {width}"))
                );
            }
            (false, false) => {
                return Err(
                    self.wrong(key, "a screw axis is not of unit length (|ω| = 1, or ω = 0 and |v| = 1); normalise it")
                );
            }
        };
        // v of a slide is a direction.
        let scaled = |axis: Vector6<f64>| {
            let turns = axis.fixed_rows::<3>(0).norm() > 0.5;
            Vector6::from_fn(|k, _| if turns && k > 2 { axis[k] * metre } else { axis[k] })
        };
        Ok(found.into_iter().map(scaled).collect())
    }
}

fn are_axes(axes: &[Vector6<f64>]) -> bool {
    let is_axis = |axis: &Vector6<f64>| {
        let (omega, v) = (axis.fixed_rows::<3>(0).norm(), axis.fixed_rows::<3>(3).norm());
        (omega - 1.0).abs() <= UNIT || (omega == 0.0 && (v - 1.0).abs() <= UNIT)
    };
    !axes.is_empty() && axes.iter().all(is_axis)
}

/// The robot of such a file.
pub(super) fn of_value(file: &str, text: &str, value: &Value, given: Stated) -> Result<Read, SourceError> {
    let reader = Reader { file, text };
    let unit = given.length.unwrap_or(Unit::Metre);
    let metre = unit.in_si();
    let (key, home) = entry(value, &["m"]).unwrap_or(("M", value));
    let home = reader.home(key, home, metre)?;
    let space = entry(value, &SPACE).map(|(key, list)| Ok((key, reader.screws(key, list, metre)?))).transpose()?;
    let body = entry(value, &BODY).map(|(key, list)| Ok((key, reader.screws(key, list, metre)?))).transpose()?;
    let moved = |axes: Vec<Vector6<f64>>| -> Vec<Vector6<f64>> {
        axes.iter().map(|axis| se3::adjoint_times(&home, axis)).collect()
    };
    let axes = match (space, body) {
        (Some((_, space)), None) => space,
        (None, Some((_, body))) => moved(body),
        (Some((_, space)), Some((key, body))) => {
            let body = moved(body);
            let size = space.iter().map(denavit_model::nalgebra::Matrix::amax).fold(1.0, f64::max);
            let same = space.len() == body.len()
                && space.iter().zip(&body).all(|(one, other)| (one - other).amax() <= SAME * size);
            if !same {
                return Err(reader.wrong(
                    key,
                    "the two lists are not the same axes: Ad(M) times Blist is not Slist; remove the wrong one",
                ));
            }
            space
        }
        (None, None) => Vec::new(),
    };
    let name = value.get("name").or_else(|| value.get("robot")).and_then(Value::as_str);
    let (mut joints, mut coordinates) = (Vec::new(), Vec::new());
    for (index, axis) in axes.iter().enumerate() {
        let wrong =
            |error| SourceError::at(place(file, 1, format!("joint {}", index + 1)), SourceErrorKind::Twist(error));
        let (screw, scale) = Screw::from_twist(axis).map_err(wrong)?;
        // A length that differs from 1 by rounding is not a gear ratio.
        let scale = if (scale - 1.0).abs() <= UNIT { 1.0 } else { scale };
        let quantity = if screw.line().is_some() { Quantity::Angle } else { Quantity::Length };
        let name = format!("joint_{}", index + 1);
        coordinates.push(Coordinate::unlimited(name.clone(), quantity));
        joints.push(ChainJoint { name, screw, coordinate: index, scale, offset: 0.0 });
    }
    let chain = Chain::new((name.map_or_else(|| stem(file), str::to_owned), "base", "tool"), coordinates, joints, home)
        .and_then(Chain::within_reach)
        .map_err(|error| SourceError::at(place(file, 1, "file"), error.into()))?;
    let mut inventory = Inventory::default();
    let mut notes = Vec::new();
    for (key, _) in value.as_object().into_iter().flatten() {
        let lower = key.to_lowercase();
        let lists = SPACE.contains(&lower.as_str()) || BODY.contains(&lower.as_str());
        if lists || lower == "m" || ["name", "robot"].contains(&key.as_str()) {
            inventory.understand();
            continue;
        }
        let place = place(file, line_of(text, key), format!("key \"{}\"", words::quoted(key)));
        let what = "the key is unknown and was ignored".to_owned();
        inventory.report(place.clone(), what.clone());
        notes.push(Note::NotUnderstood { place, what });
    }
    let mut assumed = Vec::new();
    if given.length.is_none() {
        assumed.push(format!(
            "{file}: read as screw axes of Modern Robotics; the file states no unit of length, so lengths are read as \
             m (‹table-units› mm reads them as mm)"
        ));
    }
    Ok(Read { source: Source::Poe(chain), assumed, notes, inventory })
}
