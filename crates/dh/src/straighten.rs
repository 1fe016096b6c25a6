//! Making near-parallel neighbours parallel, with a note.

use denavit_model::chain::{Chain, ChainError};
use denavit_model::nalgebra::{Point3, Rotation3, Unit, Vector3};
use denavit_model::notes::{Note, Noted};
use denavit_model::screw::Screw;
use denavit_model::se3::{self, angle_between};

/// Neighbouring axes whose directions differ by no more (rad) are parallel but for rounding, in every mode: the
/// rounding of the products of some sixty joints stays below, and no tip moves by more than this times its size.
pub const ROUNDING: f64 = 1e-12;

/// When neighbouring axes count as parallel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Parallelism {
    /// Only when rounding alone keeps them apart.
    Exact,
    /// Also when they are closer than `angle`, rad: they are made parallel, with a note.
    Within {
        /// rad.
        angle: f64,
    },
}

impl Default for Parallelism {
    /// 1e-6 rad: on an arm of 1 m the tip moves by at most some micrometres, and the error of π written
    /// with six digits is gone.
    fn default() -> Self {
        Self::Within { angle: 1e-6 }
    }
}

/// Angle between two lines' directions, senses left aside, in \[0, π/2\], rad.
pub(crate) fn angle_of_lines(a: &Vector3<f64>, b: &Vector3<f64>) -> f64 {
    angle_between(a, b).min(angle_between(a, &-b))
}

/// The chain in which each axis closer to parallel to the one before (the first to the base's z, the tool's z to the
/// last axis) than `angle` is parallel to it. An axis is turned about its point nearest the arm.
///
/// # Errors
/// As [`Chain::new`]; does not happen for a chain that was one.
pub fn straightened(chain: &Chain, angle: f64) -> Result<Noted<Chain>, ChainError> {
    let mut notes = Vec::new();
    let mut before = Vector3::z_axis();
    let mut name_before = "base z".to_owned();
    let mut screws: Vec<Screw> = Vec::new();
    for (index, joint) in chain.joints().iter().enumerate() {
        let mut screw = joint.screw;
        let direction = screw.direction();
        let apart = angle_of_lines(&before, &direction);
        if apart < angle && apart > 0.0 {
            let straight = if before.dot(&direction) < 0.0 { -before } else { before };
            screw = with_direction(&screw, straight);
            if apart > ROUNDING {
                let reach = screw.line().map_or(0.0, |line| chain.reach_beyond(index + 1, &line.point));
                let tip_moves = apart * (2.0 * reach + chain.greatest_slide(joint));
                let joints = (name_before.clone(), joint.name.clone());
                notes.push(Note::TreatedAsParallel { joints, angle: apart, tip_moves });
            }
        }
        before = screw.direction();
        name_before.clone_from(&joint.name);
        screws.push(screw);
    }
    let mut home = *chain.home();
    let z = home.rotation.matrix().column(2).into_owned();
    let apart = angle_of_lines(&before, &z);
    if apart < angle && apart > 0.0 {
        let straight = if before.dot(&z) < 0.0 { -before.into_inner() } else { before.into_inner() };
        home.rotation = small_rotation(&z, &straight) * home.rotation;
        if apart > ROUNDING {
            notes.push(Note::TreatedAsParallel {
                joints: (name_before, "tool z".into()),
                angle: apart,
                tip_moves: 0.0,
            });
        }
    }
    Ok(Noted { value: chain.with_geometry(&screws, home)?, notes })
}

fn with_direction(screw: &Screw, direction: Unit<Vector3<f64>>) -> Screw {
    match screw {
        Screw::Revolute(axis) => Screw::Revolute(denavit_model::AxisLine { direction, ..*axis }),
        Screw::Prismatic(_) => Screw::Prismatic(direction),
        Screw::Helical { axis, pitch } => {
            Screw::Helical { axis: denavit_model::AxisLine { direction, ..*axis }, pitch: *pitch }
        }
    }
}

/// The smallest rotation that takes direction `from` to `to`; they are close.
fn small_rotation(from: &Vector3<f64>, to: &Vector3<f64>) -> Rotation3<f64> {
    let across = from.cross(to);
    Unit::try_new(across, 0.0)
        .map_or_else(Rotation3::identity, |axis| se3::rotation_about(&axis, angle_between(from, to)))
}

/// The axis' point nearest the arm, or where it is prismatic a point that the arm passes.
pub(crate) fn place_of(screw: &Screw, otherwise: Point3<f64>) -> Point3<f64> {
    screw.line().map_or(otherwise, |line| line.point)
}
