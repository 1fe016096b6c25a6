//! Reading a list of poses: joint readings to measure at, poses to reach, or both.

use super::header::{naming, no_column, numbered_joints};
use super::import::{ImportOptions, Imported};
use super::measurement_error::{DataError, MeasurementError};
use super::read::in_our_form;
use super::rows::{Problems, header_row, line_of, number, rows_of, unreadable};
use super::units::Units;
use super::{Covariate, QUATERNION_TOLERANCE};
use denavit_model::nalgebra::{Quaternion, Rotation3, UnitQuaternion, Vector3};
use denavit_model::{Chain, Pose, Quantity, se3};
use std::io::Read;

/// Poses, row by row in the order in which the robot takes them.
#[derive(Debug, Clone, PartialEq)]
pub struct Poses {
    /// Joint values per row in the chain's coordinate order, rad or m; empty where the file has no joint columns.
    pub joints: Vec<Vec<f64>>,
    /// base_from_tip per row; empty where the file has no pose columns.
    pub poses: Vec<Pose>,
    /// Other columns that hold numbers alone, in their own units.
    pub covariates: Vec<Covariate>,
    /// The line of each row, counted from 1.
    pub lines: Vec<usize>,
}

const PLACE: [&str; 3] = ["x", "y", "z"];
const TURN: [&str; 4] = ["qx", "qy", "qz", "qw"];
const ANGLES: [&str; 3] = ["roll", "pitch", "yaw"];

#[derive(Clone, Copy, PartialEq)]
enum Role {
    Joint(usize),
    Place(usize),
    Turn(usize),
    Angle(usize),
    Other,
}

/// Reads a list of poses for a chain.
///
/// # Shape and units
/// CSV with a header row; `#` lines are comments. One column per coordinate of the chain, by name; or `x,y,z` with
/// `qx,qy,qz,qw` or `roll,pitch,yaw` (R = Rz(yaw) Ry(pitch) Rx(roll)), the tip in the base frame; or both. `units` are
/// the file's; the result is in m and rad.
///
/// # Errors
/// All problems found, each with file and line.
pub fn read(source: &str, input: impl Read, chain: &Chain, units: Units) -> Result<Poses, DataError> {
    read_export(source, input, chain, units, &ImportOptions::default())
}

/// As [`read`], with options that describe the file's columns.
///
/// # Errors
/// As [`read`].
pub fn read_export(
    source: &str,
    input: impl Read,
    chain: &Chain,
    units: Units,
    options: &ImportOptions,
) -> Result<Poses, DataError> {
    read_as(source, input, chain, units, options, true)
}

/// Reads joint values alone, from a list of poses, a plan or a measurement file: one value per coordinate and row, rad or m.
///
/// # Errors
/// As [`read`].
pub fn read_joints(source: &str, input: impl Read, chain: &Chain, units: Units) -> Result<Vec<Vec<f64>>, DataError> {
    read_joints_of_export(source, input, chain, units, &ImportOptions::default())
}

/// As [`read_joints`], with options that describe the file's columns.
///
/// # Errors
/// As [`read`].
pub fn read_joints_of_export(
    source: &str,
    input: impl Read,
    chain: &Chain,
    units: Units,
    options: &ImportOptions,
) -> Result<Vec<Vec<f64>>, DataError> {
    Ok(read_as(source, input, chain, units, options, false)?.joints)
}

fn read_as(
    source: &str,
    input: impl Read,
    chain: &Chain,
    units: Units,
    options: &ImportOptions,
    with_poses: bool,
) -> Result<Poses, DataError> {
    let Imported { text, converted, .. } = in_our_form(source, input, chain, units, options)?;
    let units = if converted { Units::default() } else { units };
    read_contract(source, text.as_bytes(), chain, units, with_poses)
}

fn read_contract(
    source: &str,
    input: impl Read,
    chain: &Chain,
    units: Units,
    with_poses: bool,
) -> Result<Poses, DataError> {
    let mut reader = rows_of(input);
    let mut problems = Problems::new(source);
    let mut record = csv::StringRecord::new();
    let (names, header_line) = header_row(&mut reader, source)?;
    let roles = match roles(&names, chain, with_poses) {
        Ok(roles) => roles,
        Err(found) => {
            for problem in found {
                problems.add(header_line, problem);
            }
            return Err(problems.error());
        }
    };
    let mut poses = Poses { joints: Vec::new(), poses: Vec::new(), covariates: Vec::new(), lines: Vec::new() };
    let mut others: Vec<Option<Vec<f64>>> = vec![Some(Vec::new()); names.len()];
    loop {
        match reader.read_record(&mut record) {
            Ok(true) => {
                let line = reader.position().line() - 1;
                if record.len() == names.len() {
                    poses.row(&record, &names, &roles, (chain, units), line, &mut problems);
                    for (other, cell) in others.iter_mut().zip(&record) {
                        let value = cell.parse::<f64>().ok().filter(|value| value.is_finite());
                        *other = other.take().zip(value).map(|(mut values, value)| {
                            values.push(value);
                            values
                        });
                    }
                } else {
                    problems.add(line, MeasurementError::Ragged { found: record.len(), expected: names.len() });
                }
            }
            Ok(false) => break,
            Err(error) => {
                problems.add(line_of(&error), unreadable(&error));
                break;
            }
        }
    }
    if poses.lines.is_empty() && problems.found.is_empty() {
        problems.add(0, MeasurementError::NoRows);
    }
    if !problems.found.is_empty() {
        return Err(problems.error());
    }
    let numeric = names.into_iter().zip(roles).zip(others).filter(|((_, role), _)| *role == Role::Other);
    poses.covariates =
        numeric.filter_map(|((name, _), values)| values.map(|values| Covariate { name, values })).collect();
    Ok(poses)
}

fn roles(names: &[String], chain: &Chain, with_poses: bool) -> Result<Vec<Role>, Vec<MeasurementError>> {
    let mut problems = naming(names)?;
    let coordinates = chain.coordinates();
    let within = |list: &[&str], name: &String| list.iter().position(|known| known == name);
    let role = |name: &String| {
        let joint = coordinates.iter().position(|coordinate| coordinate.name == *name).map(Role::Joint);
        let of_pose = || {
            let place = within(&PLACE, name).map(Role::Place);
            place
                .or_else(|| within(&TURN, name).map(Role::Turn))
                .or_else(|| within(&ANGLES, name).map(Role::Angle))
                .filter(|_| with_poses)
        };
        joint.or_else(of_pose).unwrap_or(Role::Other)
    };
    let roles: Vec<Role> = names.iter().map(role).collect();
    let free: Vec<&str> =
        names.iter().zip(&roles).filter(|(_, role)| **role == Role::Other).map(|(name, _)| name.as_str()).collect();
    let has = |wanted: fn(&Role) -> bool| roles.iter().any(wanted);
    let has_joints = has(|role| matches!(role, Role::Joint(_)));
    let has_pose = has(|role| matches!(role, Role::Place(_) | Role::Turn(_)));
    if with_poses && !has_joints && !has_pose && problems.is_empty() {
        let joints = coordinates.iter().map(|coordinate| coordinate.name.as_str()).collect::<Vec<_>>().join(", ");
        let neither = MeasurementError::NeitherJointsNorPose { joints };
        problems.push(numbered_joints(&free, coordinates).unwrap_or(neither));
    }
    if has_joints || !with_poses {
        let numbered = if has_joints { None } else { numbered_joints(&free, coordinates) };
        problems.extend(numbered.clone());
        for (index, coordinate) in coordinates.iter().enumerate() {
            if !roles.contains(&Role::Joint(index)) && numbered.is_none() {
                problems.push(no_column(coordinate, free.iter().copied(), coordinates));
            }
        }
    }
    if has_pose {
        let by_angles = has(|role| matches!(role, Role::Angle(_))) && !has(|role| matches!(role, Role::Turn(_)));
        let turn: &[&str] = if by_angles { &ANGLES } else { &TURN };
        let group: Vec<&str> = PLACE.iter().chain(turn).copied().collect();
        let present = group.iter().find(|name| names.iter().any(|known| known == *name));
        for missing in group.iter().filter(|name| names.iter().all(|known| known != *name)) {
            problems.push(MeasurementError::Incomplete {
                missing: (*missing).into(),
                present: present.map_or_else(String::new, |name| (*name).into()),
                group: group.join(", "),
            });
        }
    }
    if problems.is_empty() { Ok(roles) } else { Err(problems) }
}

impl Poses {
    fn row(
        &mut self,
        record: &csv::StringRecord,
        names: &[String],
        roles: &[Role],
        (chain, units): (&Chain, Units),
        line: u64,
        problems: &mut Problems<'_>,
    ) {
        let coordinates = chain.coordinates();
        let mut joints = vec![0.0; coordinates.len()];
        let (mut place, mut turn, mut angles) = ([0.0; 3], [0.0; 4], [0.0; 3]);
        let mut good = true;
        for ((cell, name), role) in record.iter().zip(names).zip(roles) {
            if *role == Role::Other {
                continue;
            }
            let value = number(name, cell).unwrap_or_else(|problem| {
                problems.add(line, problem);
                good = false;
                0.0
            });
            match *role {
                Role::Joint(index) if coordinates[index].quantity == Quantity::Length => {
                    joints[index] = value * units.length;
                }
                Role::Joint(index) => joints[index] = value * units.angle,
                Role::Place(index) => place[index] = value * units.length,
                Role::Turn(index) => turn[index] = value,
                Role::Angle(index) => angles[index] = value * units.angle,
                Role::Other => {}
            }
        }
        let has = |wanted: fn(&Role) -> bool| roles.iter().any(wanted);
        if has(|role| matches!(role, Role::Joint(_))) {
            self.joints.push(joints);
        }
        if has(|role| matches!(role, Role::Place(_))) {
            let rotation = if has(|role| matches!(role, Role::Turn(_))) {
                rotation(turn).unwrap_or_else(|length| {
                    if good {
                        problems.add(line, MeasurementError::NotAUnitQuaternion { length });
                    }
                    Rotation3::identity()
                })
            } else {
                se3::rotation_from_rpy(angles)
            };
            self.poses.push(se3::pose(rotation, Vector3::from(place)));
        }
        self.lines.push(usize::try_from(line).unwrap_or(usize::MAX));
    }
}

/// The rotation of a quaternion x, y, z, w; its length where that is not 1.
pub(super) fn rotation([x, y, z, w]: [f64; 4]) -> Result<Rotation3<f64>, f64> {
    let quaternion = Quaternion::new(w, x, y, z);
    let length = quaternion.norm();
    if (length - 1.0).abs() > QUATERNION_TOLERANCE {
        return Err(length);
    }
    Ok(UnitQuaternion::new_normalize(quaternion).to_rotation_matrix())
}
