//! Whether a robot has a plausible size: far larger numbers overflow or swamp all others, and more joints than any arm has
//! take years to fit.

use denavit_model::nalgebra::Point3;
use denavit_model::{Chain, Screw};
use thiserror::Error;

/// Largest distance of an axis from the base, m: a hundred kilometres.
const LARGEST: f64 = 1e5;

/// An axis too far away.
#[derive(Debug, Clone, PartialEq, Error)]
#[error(
    "{robot}: the axis of joint \"{joint}\" is {away:e} m from the base; no robot is that large: correct the origins on the \
     way to it"
)]
pub struct OutOfProportion {
    /// The robot.
    pub robot: String,
    /// The first joint beyond the limit.
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

/// Most joints of a chain for a fit or a plan: each joint has four parameters, and the work grows with the cube of their number
/// (100 joints take seconds, 2000 would take days).
pub const MOST_JOINTS: usize = 100;

/// A chain of more joints than can be fitted at once.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error(
    "{robot}: {joints} joints move between \"{base}\" and \"{tip}\", but at most {MOST_JOINTS} can be identified at once; \
     choose a part of the chain: ‹base› and ‹tip›"
)]
pub struct TooManyJoints {
    /// The robot.
    pub robot: String,
    /// Where the chain starts.
    pub base: String,
    /// Where it ends.
    pub tip: String,
    /// Its moving joints.
    pub joints: usize,
}

/// Checks that a chain has no more than [`MOST_JOINTS`] joints.
///
/// # Errors
/// It has more.
pub fn can_be_identified(chain: &Chain) -> Result<(), TooManyJoints> {
    let joints = chain.joints().len();
    if joints <= MOST_JOINTS {
        return Ok(());
    }
    let name = |text: &str| text.to_owned();
    Err(TooManyJoints { robot: name(chain.name()), base: name(chain.base()), tip: name(chain.tip()), joints })
}
