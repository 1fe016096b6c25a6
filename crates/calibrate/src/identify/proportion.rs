//! Whether a robot is of a size that anything measures: numbers far beyond it overflow or drown all others.

use denavit_model::nalgebra::Point3;
use denavit_model::{Chain, Screw};
use thiserror::Error;

/// No robot's axes are further apart, m: a hundred kilometres.
const LARGEST: f64 = 1e5;

/// An axis beyond reason.
#[derive(Debug, Clone, PartialEq, Error)]
#[error(
    "{robot}: the axis of joint \"{joint}\" lies {away:e} m from the base; no robot is that large, and no measurement reaches \
     there: correct the origins on the way to it"
)]
pub struct OutOfProportion {
    /// The robot.
    pub robot: String,
    /// The first joint that lies out there.
    pub joint: String,
    /// How far, m.
    pub away: f64,
}

/// Checks that every axis is within a hundred kilometres of the base.
///
/// # Errors
/// The first that is not.
pub fn within_proportion(chain: &Chain) -> Result<(), OutOfProportion> {
    for joint in chain.joints() {
        let point = match &joint.screw {
            Screw::Revolute(line) | Screw::Helical { axis: line, .. } => line.point,
            Screw::Prismatic(_) => Point3::origin(),
        };
        let away = point.coords.amax();
        if away.is_nan() || away > LARGEST {
            return Err(OutOfProportion { robot: chain.name().into(), joint: joint.name.clone(), away });
        }
    }
    let away = chain.home().translation.vector.amax();
    match chain.joints().last() {
        Some(last) if away.is_nan() || away > LARGEST => {
            Err(OutOfProportion { robot: chain.name().into(), joint: last.name.clone(), away })
        }
        _ => Ok(()),
    }
}
