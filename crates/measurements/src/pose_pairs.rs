//! Reading pairs of poses: the robot's tip and the pose measured by an instrument, without joint readings.

use super::header::naming;
use super::import::AngleConvention;
use super::measurement_error::{DataError, MeasurementError};
use super::poses::rotation;
use super::rows::{Problems, header_row, line_of, number, rows_of, unreadable};
use super::units::Units;
use denavit_model::nalgebra::Vector3;
use denavit_model::{Pose, se3};
use std::io::Read;

/// Pairs of poses, row by row.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct PosePairs {
    /// base_from_tip, m.
    pub robot: Vec<Pose>,
    /// instrument_from_target, m.
    pub seen: Vec<Pose>,
    /// The line of each row, counted from 1.
    pub lines: Vec<usize>,
    /// Lines of rows in which nothing was seen.
    pub unseen: Vec<usize>,
}

/// Meaning of three numbers of an orientation, for the robot and for the measured pose.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PairAngles {
    /// Of `robot_rx,robot_ry,robot_rz`.
    pub robot: AngleConvention,
    /// Of `rx,ry,rz`.
    pub seen: AngleConvention,
}

impl Default for PairAngles {
    /// Rotation vectors, as a UR controller and OpenCV write them.
    fn default() -> Self {
        Self { robot: AngleConvention::RotationVector, seen: AngleConvention::RotationVector }
    }
}

/// Prefix of the robot's columns.
const ROBOT: &str = "robot_";

const PLACE: [&str; 3] = ["x", "y", "z"];
const QUATERNION: [&str; 4] = ["qx", "qy", "qz", "qw"];
const TURN: [&str; 3] = ["rx", "ry", "rz"];
const RPY: [&str; 3] = ["roll", "pitch", "yaw"];

/// Indices of the columns of one pose.
struct Columns {
    place: [usize; 3],
    turn: Turn,
}

enum Turn {
    Quaternion([usize; 4]),
    Angles([usize; 3], AngleConvention),
    Rpy([usize; 3]),
}

/// Reads pairs of poses.
///
/// # Shape and units
/// CSV with a header row; `#` lines are comments. `robot_x, robot_y, robot_z` and the robot's orientation, and `x, y, z` and the
/// measured orientation; an orientation is `qx, qy, qz, qw`, or `rx, ry, rz` (a rotation vector unless `angles` says
/// otherwise), or `roll, pitch, yaw`. `units` are the file's. In a row with no measured cells nothing was seen. Other columns are
/// ignored.
///
/// # Errors
/// All problems found, each with file and line.
pub fn read(source: &str, input: impl Read, units: Units, angles: PairAngles) -> Result<PosePairs, DataError> {
    let mut reader = rows_of(input);
    let mut problems = Problems::new(source);
    let (names, header_line) = header_row(&mut reader, source)?;
    let columns = naming(&names).and_then(|twice| {
        let (robot, seen) = (columns(&names, ROBOT, angles.robot), columns(&names, "", angles.seen));
        match (twice.is_empty(), robot, seen) {
            (true, Ok(robot), Ok(seen)) => Ok([robot, seen]),
            (_, robot, seen) => Err(twice.into_iter().chain(robot.err()).chain(seen.err()).collect()),
        }
    });
    let [robot, seen] = match columns {
        Ok(columns) => columns,
        Err(found) => {
            for problem in found {
                problems.add(header_line, problem);
            }
            return Err(problems.error());
        }
    };
    let mut pairs = PosePairs::default();
    let mut record = csv::StringRecord::new();
    loop {
        match reader.read_record(&mut record) {
            Ok(true) => {
                let line = reader.position().line() - 1;
                let at = usize::try_from(line).unwrap_or(usize::MAX);
                if record.len() != names.len() {
                    problems.add(line, MeasurementError::Ragged { found: record.len(), expected: names.len() });
                } else if seen.are_empty(&record) {
                    pairs.unseen.push(at);
                } else {
                    let mut pose = |columns: &Columns| {
                        columns.pose(&record, &names, units).unwrap_or_else(|problem| {
                            problems.add(line, problem);
                            Pose::identity()
                        })
                    };
                    pairs.robot.push(pose(&robot));
                    pairs.seen.push(pose(&seen));
                    pairs.lines.push(at);
                }
            }
            Ok(false) => break,
            Err(error) => {
                problems.add(line_of(&error), unreadable(&error));
                break;
            }
        }
    }
    if pairs.lines.is_empty() && problems.found.is_empty() {
        problems.add(0, MeasurementError::NoRows);
    }
    if problems.found.is_empty() { Ok(pairs) } else { Err(problems.error()) }
}

fn columns(names: &[String], prefix: &str, angles: AngleConvention) -> Result<Columns, MeasurementError> {
    let at = |name: &str| names.iter().position(|known| *known == format!("{prefix}{name}"));
    let any = |group: &[&str]| group.iter().any(|name| at(name).is_some());
    let turn: &[&str] = if any(&QUATERNION) {
        &QUATERNION
    } else if any(&RPY) && !any(&TURN) {
        &RPY
    } else {
        &TURN
    };
    let group: Vec<&str> = PLACE.iter().chain(turn).copied().collect();
    if let Some(missing) = group.iter().find(|name| at(name).is_none()) {
        let full = |name: &str| format!("{prefix}{name}");
        return Err(MeasurementError::NoPosePair {
            missing: full(missing),
            group: group.iter().map(|name| full(name)).collect::<Vec<_>>().join(", "),
            present: names.join(", "),
        });
    }
    let three = |names: [&str; 3]| names.map(|name| at(name).unwrap_or(0));
    Ok(Columns {
        place: three(PLACE),
        turn: match turn.len() {
            4 => Turn::Quaternion(QUATERNION.map(|name| at(name).unwrap_or(0))),
            _ if turn == TURN => Turn::Angles(three(TURN), angles),
            _ => Turn::Rpy(three(RPY)),
        },
    })
}

impl Columns {
    fn all(&self) -> impl Iterator<Item = usize> {
        let turn: &[usize] = match &self.turn {
            Turn::Quaternion(columns) => columns,
            Turn::Angles(columns, _) | Turn::Rpy(columns) => columns,
        };
        self.place.iter().chain(turn).copied()
    }

    fn are_empty(&self, record: &csv::StringRecord) -> bool {
        self.all().all(|column| record.get(column).is_none_or(|cell| cell.trim().is_empty()))
    }

    fn pose(&self, record: &csv::StringRecord, names: &[String], units: Units) -> Result<Pose, MeasurementError> {
        let cell = |column: usize| number(&names[column], record.get(column).unwrap_or_default());
        let three = |[a, b, c]: [usize; 3], unit: f64| -> Result<[f64; 3], MeasurementError> {
            Ok([cell(a)? * unit, cell(b)? * unit, cell(c)? * unit])
        };
        let place = three(self.place, units.length)?;
        let rotation = match &self.turn {
            Turn::Quaternion([x, y, z, w]) => rotation([cell(*x)?, cell(*y)?, cell(*z)?, cell(*w)?])
                .map_err(|length| MeasurementError::NotAUnitQuaternion { length })?,
            Turn::Angles(columns, convention) => convention.rotation(three(*columns, units.angle)?, false),
            Turn::Rpy(columns) => se3::rotation_from_rpy(three(*columns, units.angle)?),
        };
        Ok(se3::pose(rotation, Vector3::from(place)))
    }
}
