//! Reads screw axes into a chain: twists may be unnormalised, as in the paper's Table I.

use super::rows::{RowOf, Rows};
use super::{Read, Source, SourceError, SourceErrorKind, coordinate_of, coordinates_of, in_si, place, stem};
use crate::poe::PoeFile;
use denavit_dh::Motion;
use denavit_model::chain::{Chain, ChainJoint, Coordinate, Quantity};
use denavit_model::nalgebra::{Matrix3, Rotation3, Vector3, Vector6};
use denavit_model::screw::Screw;
use denavit_model::se3::{self, Pose};

/// A chain from CSV rows 1 … n with `wx … vz`, and `tool` (or `home`): the twist whose exponential is the home pose.
pub(super) fn of_rows(rows: Rows) -> Result<Read, SourceError> {
    rows.known_units_only()?;
    let source = Source::Poe(chain_of(&rows)?);
    Ok(Read { source, assumed: Vec::new(), notes: rows.notes, inventory: rows.inventory })
}

fn chain_of(rows: &Rows) -> Result<Chain, SourceError> {
    let mut joints: Vec<ChainJoint> = Vec::new();
    let mut coordinates: Vec<Coordinate> = Vec::new();
    let mut home = None;
    for row in rows.iter() {
        let label = row.text("row").to_owned();
        let twist = twist_of(&row)?;
        match label.as_str() {
            "tool" | "home" if home.is_none() => home = Some(se3::exp(&twist)),
            _ if home.is_some() => return Err(row.error(SourceErrorKind::Order(label))),
            label => {
                if label.parse().is_ok_and(|number: usize| number != joints.len() + 1) {
                    return Err(row.error(SourceErrorKind::Order(label.to_owned())));
                }
                let (screw, length) = Screw::from_twist(&twist).map_err(|error| row.error(error.into()))?;
                same_motion(&screw, row.text("kind"), row.number("pitch")?).map_err(|kind| row.error(kind))?;
                let scale = length * row.number("scale")?.unwrap_or(1.0);
                let name = match row.name("joint") {
                    name if name.is_empty() => format!("joint_{}", joints.len() + 1),
                    name => name,
                };
                let known = coordinates.iter().position(|coordinate| coordinate.name == name);
                let coordinate = known.unwrap_or_else(|| {
                    coordinates.push(Coordinate::unlimited(name.clone(), quantity(&screw)));
                    coordinates.len() - 1
                });
                joints.push(ChainJoint { name, screw, coordinate, scale, offset: 0.0 });
            }
        }
    }
    let name = rows.comment("robot").map_or_else(|| stem(rows.file), str::to_owned);
    let home = home.unwrap_or_else(Pose::identity);
    Chain::new((name, "base", "tool"), coordinates, joints, home)
        .and_then(Chain::within_reach)
        .map_err(|error| rows.error(error.into()))
}

fn quantity(screw: &Screw) -> Quantity {
    if screw.line().is_some() { Quantity::Angle } else { Quantity::Length }
}

fn twist_of(row: &RowOf) -> Result<Vector6<f64>, SourceError> {
    let mut twist = Vector6::zeros();
    for (slot, column) in twist.iter_mut().zip(["wx", "wy", "wz", "vx", "vy", "vz"]) {
        *slot = row.required(column)?;
    }
    Ok(twist)
}

/// Kind and pitch repeat the twist for readers; they must not contradict it.
fn same_motion(screw: &Screw, kind: &str, pitch: Option<f64>) -> Result<(), SourceErrorKind> {
    let motion = Motion::of(screw);
    let same = |pitch: f64| (pitch - motion.pitch()).abs() <= 1e-6 * motion.pitch().abs().max(1e-6);
    let said = match (kind, pitch) {
        ("", None) => return Ok(()),
        ("", Some(pitch)) if same(pitch) => return Ok(()),
        ("", Some(pitch)) => format!("the pitch is given as {pitch} m/rad"),
        (kind, pitch) => match super::table::motion(kind, pitch.unwrap_or(motion.pitch())) {
            Ok(found) if found.word() == motion.word() && same(found.pitch()) => return Ok(()),
            Ok(found) => format!("the kind is given as {} with pitch {} m/rad", found.word(), found.pitch()),
            Err(error) => return Err(error),
        },
    };
    let (word, pitch) = (motion.word(), motion.pitch());
    Err(SourceErrorKind::Axes(format!(
        "{said}, but the twist is {word} with pitch {pitch} m/rad; correct one of the two"
    )))
}

/// A chain from its JSON file.
pub(super) fn of_file(file: &str, content: &PoeFile) -> Result<Chain, SourceError> {
    let error = |element: String, kind| SourceError::at(place(file, 1, element), kind);
    in_si(file, &content.units)?;
    let coordinates = coordinates_of(file, &content.coordinates)?;
    let mut joints = Vec::new();
    for entry in &content.joints {
        let element = format!("joint \"{}\"", entry.name);
        let (screw, length) =
            Screw::from_twist(&Vector6::from(entry.twist)).map_err(|kind| error(element.clone(), kind.into()))?;
        same_motion(&screw, &entry.kind, Some(entry.pitch)).map_err(|kind| error(element.clone(), kind))?;
        let coordinate = coordinate_of(file, &entry.name, &entry.coordinate, &coordinates)?;
        joints.push(ChainJoint {
            name: entry.name.clone(),
            screw,
            coordinate,
            scale: entry.scale * length,
            offset: entry.offset,
        });
    }
    let m = &content.home;
    if m[3] != [0.0, 0.0, 0.0, 1.0] {
        let what = "the last row of the home pose is not 0 0 0 1; write base_from_tip as four rows of four".to_owned();
        return Err(error("home".into(), SourceErrorKind::Axes(what)));
    }
    let rotation = Rotation3::from_matrix_unchecked(Matrix3::from_fn(|row, column| m[row][column]));
    let home = se3::pose(rotation, Vector3::new(m[0][3], m[1][3], m[2][3]));
    Chain::new((&*content.robot, &*content.base, &*content.tip), coordinates, joints, home)
        .and_then(Chain::within_reach)
        .map_err(|kind| error("chain".into(), kind.into()))
}
