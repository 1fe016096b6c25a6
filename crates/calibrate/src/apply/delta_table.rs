//! Delta tables, the factory calibration of one arm: a controller adds them to the ideal Denavit-Hartenberg table of its model.

use denavit_dh::DhRow;
use denavit_model::nalgebra::{Point3, Unit, Vector3};
use denavit_model::{AxisLine, Chain, ChainError, ChainJoint, Coordinate, Pose, Quantity, Screw};
use serde::Deserialize;
use thiserror::Error;

/// A row of a delta table: added to the row of one joint in the standard (distal) table; rad and m.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Delta {
    /// Which arm.
    pub robot: String,
    /// Which model.
    pub model: String,
    /// Which joint, counted from 1.
    pub joint: usize,
    /// Added to θ.
    pub delta_theta: f64,
    /// Added to d.
    pub delta_d: f64,
    /// Added to a.
    pub delta_a: f64,
    /// Added to α.
    pub delta_alpha: f64,
}

/// Why a delta table cannot be used.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum DeltaError {
    /// A cell does not parse.
    #[error(
        "{file}:{line}: {what}; the columns are robot,model,joint,delta_theta,delta_d,delta_a,delta_alpha in rad and m"
    )]
    Row {
        /// The file.
        file: String,
        /// Counted from 1.
        line: u64,
        /// What the reader says.
        what: String,
    },
    /// A joint without a delta.
    #[error("robot \"{robot}\" has no delta for joint {joint}; each joint of the ideal table needs one")]
    MissingJoint {
        /// The arm.
        robot: String,
        /// Counted from 1.
        joint: usize,
    },
    /// Not a chain.
    #[error(transparent)]
    Chain(#[from] ChainError),
}

/// Reads a delta table; `#` lines are comments.
///
/// # Errors
/// A row does not parse.
pub fn read(file: &str, text: &str) -> Result<Vec<Delta>, DeltaError> {
    let mut reader = csv::ReaderBuilder::new().comment(Some(b'#')).trim(csv::Trim::All).from_reader(text.as_bytes());
    reader
        .deserialize()
        .map(|row| {
            row.map_err(|error| DeltaError::Row {
                file: file.into(),
                line: error.position().map_or(0, csv::Position::line),
                what: error.to_string(),
            })
        })
        .collect()
}

/// The chain of an ideal standard table with one arm's deltas: base_from_tip = Π Rz(θi + qi) Tz(di) Rx(αi) Tx(ai).
///
/// # Errors
/// A joint has no delta.
pub fn chain(robot: &str, ideal: &[DhRow], deltas: &[Delta], names: &[&str]) -> Result<Chain, DeltaError> {
    let mut frame = Pose::identity();
    let mut joints = Vec::new();
    for (index, (row, name)) in ideal.iter().zip(names).enumerate() {
        let delta = deltas
            .iter()
            .find(|delta| delta.robot == robot && delta.joint == index + 1)
            .ok_or_else(|| DeltaError::MissingJoint { robot: robot.into(), joint: index + 1 })?;
        let direction = Unit::new_normalize(frame.rotation * Vector3::z());
        let point = Point3::from(frame.translation.vector);
        joints.push(ChainJoint {
            name: (*name).into(),
            screw: Screw::Revolute(AxisLine { direction, point }),
            coordinate: index,
            scale: 1.0,
            offset: 0.0,
        });
        let actual = DhRow {
            theta: row.theta + delta.delta_theta,
            d: row.d + delta.delta_d,
            alpha: row.alpha + delta.delta_alpha,
            a: row.a + delta.delta_a,
        };
        frame *= actual.pose();
    }
    let coordinates = names.iter().map(|name| Coordinate::unlimited(*name, Quantity::Angle)).collect();
    Ok(Chain::new((robot, "base", "tool0"), coordinates, joints, frame)?)
}
