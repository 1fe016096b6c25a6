//! Drivers as a file has them: what they follow is a name, which is bound to a column before anything is computed.

use crate::effects::driver::{APPROACH, APPROACH_FROM_ROWS, BumpShape, Driver, JointVelocity, Statics, VELOCITY};
use crate::observation::measurements::{Column, MissingColumn};
use denavit_model::Chain;
use serde::{Deserialize, Serialize};

/// A [`Driver`] that names what it follows. It has no values.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[expect(missing_docs, reason = "each variant and field is documented at the driver of the same name")]
pub enum WrittenDriver {
    Constant,
    Reading(usize),
    Harmonic { joint: usize, order: f64 },
    Bump { joint: usize, at: f64, width: f64, shape: BumpShape },
    Torque(usize),
    TorqueTerms { joint: usize, links: usize },
    MomentAcross(usize),
    Cantilever(usize),
    EndMoment(usize),
    Overturning,
    Approach { joint: usize, from_rows: bool },
    GravitySide(usize),
    Velocities,
    Covariate(String),
    Decay { covariate: String, from: f64, constant: f64 },
    Steps { covariate: String, at: Vec<f64> },
    Smooth { covariate: String, knots: Vec<f64> },
}

impl WrittenDriver {
    /// As it is written.
    pub fn of(driver: &Driver) -> Self {
        let name = |column: &Column| column.name().to_owned();
        match driver {
            Driver::Constant => Self::Constant,
            Driver::Reading(joint) => Self::Reading(*joint),
            Driver::Harmonic { joint, order } => Self::Harmonic { joint: *joint, order: *order },
            Driver::Bump { joint, at, width, shape } => {
                Self::Bump { joint: *joint, at: *at, width: *width, shape: *shape }
            }
            Driver::Torque(joint) => Self::Torque(*joint),
            Driver::TorqueTerms { joint, links } => Self::TorqueTerms { joint: *joint, links: *links },
            Driver::MomentAcross(joint) => Self::MomentAcross(*joint),
            Driver::Cantilever(joint) => Self::Cantilever(*joint),
            Driver::EndMoment(joint) => Self::EndMoment(*joint),
            Driver::Overturning => Self::Overturning,
            Driver::Approach { joint, from_rows, .. } => Self::Approach { joint: *joint, from_rows: *from_rows },
            Driver::GravitySide(joint) => Self::GravitySide(*joint),
            Driver::Velocities(_) => Self::Velocities,
            Driver::Covariate(column) => Self::Covariate(name(column)),
            Driver::Decay { covariate, from, constant } => {
                Self::Decay { covariate: name(covariate), from: *from, constant: *constant }
            }
            Driver::Steps { covariate, at } => Self::Steps { covariate: name(covariate), at: at.clone() },
            Driver::Smooth { covariate, knots } => Self::Smooth { covariate: name(covariate), knots: knots.clone() },
        }
    }

    /// The driver, every name that it follows bound to its column.
    ///
    /// # Errors
    /// Those of `column`, which is asked for each name.
    pub fn bound(
        self,
        chain: &Chain,
        column: &dyn Fn(&str) -> Result<Column, MissingColumn>,
    ) -> Result<Driver, MissingColumn> {
        Ok(match self {
            Self::Constant => Driver::Constant,
            Self::Reading(joint) => Driver::Reading(joint),
            Self::Harmonic { joint, order } => Driver::Harmonic { joint, order },
            Self::Bump { joint, at, width, shape } => Driver::Bump { joint, at, width, shape },
            Self::Torque(joint) => Driver::Torque(joint),
            Self::TorqueTerms { joint, links } => Driver::TorqueTerms { joint, links },
            Self::MomentAcross(joint) => Driver::MomentAcross(joint),
            Self::Cantilever(joint) => Driver::Cantilever(joint),
            Self::EndMoment(joint) => Driver::EndMoment(joint),
            Self::Overturning => Driver::Overturning,
            Self::Approach { joint, from_rows } => {
                Driver::Approach { joint, from_rows, side: column(&side(chain, joint, from_rows))? }
            }
            Self::GravitySide(joint) => Driver::GravitySide(joint),
            Self::Velocities => {
                let of = |joint: usize| {
                    Ok::<_, MissingColumn>(JointVelocity { joint, of_coordinate: column(&velocity(chain, joint))? })
                };
                Driver::Velocities((0..chain.joints().len()).map(of).collect::<Result<_, _>>()?)
            }
            Self::Covariate(name) => Driver::Covariate(column(&name)?),
            Self::Decay { covariate, from, constant } => {
                Driver::Decay { covariate: column(&covariate)?, from, constant }
            }
            Self::Steps { covariate, at } => Driver::Steps { covariate: column(&covariate)?, at },
            Self::Smooth { covariate, knots } => Driver::Smooth { covariate: column(&covariate)?, knots },
        })
    }

    /// Names of the quantities without which nothing can be said, such as `temperature` or `elbow.approach`.
    ///
    /// A payload is never among them: nothing given is nothing carried.
    pub fn needed(&self, chain: &Chain) -> Vec<String> {
        match self {
            Self::Approach { joint, from_rows } => vec![side(chain, *joint, *from_rows)],
            Self::Velocities => {
                let mut names: Vec<String> = Vec::new();
                for name in (0..chain.joints().len()).map(|joint| velocity(chain, joint)) {
                    if !names.contains(&name) {
                        names.push(name);
                    }
                }
                names
            }
            Self::Covariate(covariate)
            | Self::Decay { covariate, .. }
            | Self::Steps { covariate, .. }
            | Self::Smooth { covariate, .. } => vec![covariate.clone()],
            _ => Vec::new(),
        }
    }

    /// How many values the driver will have.
    pub fn len(&self, statics: &Statics) -> usize {
        match self {
            Self::Harmonic { .. } | Self::MomentAcross(_) => 2,
            Self::TorqueTerms { joint, links } => 2 * statics.carried(*joint, *links).count(),
            Self::Cantilever(_) => 6,
            Self::Overturning | Self::EndMoment(_) => 3,
            Self::Velocities => statics.chain.joints().len(),
            Self::Steps { at, .. } => at.len(),
            Self::Smooth { knots, .. } => knots.len().saturating_sub(1),
            _ => 1,
        }
    }

    /// The joint that it follows, where it follows one.
    pub fn joint(&self) -> Option<usize> {
        match *self {
            Self::Reading(joint)
            | Self::Harmonic { joint, .. }
            | Self::Bump { joint, .. }
            | Self::Torque(joint)
            | Self::TorqueTerms { joint, .. }
            | Self::MomentAcross(joint)
            | Self::Cantilever(joint)
            | Self::EndMoment(joint)
            | Self::Approach { joint, .. }
            | Self::GravitySide(joint) => Some(joint),
            _ => None,
        }
    }

    /// What is wrong with its numbers.
    pub(super) fn fault(&self) -> Option<String> {
        let good = match self {
            Self::Harmonic { order, .. } => order.is_finite(),
            Self::Bump { at, width, .. } => at.is_finite() && *width > 0.0,
            Self::Decay { from, constant, .. } => from.is_finite() && *constant > 0.0,
            Self::Steps { at, .. } => !at.is_empty() && at.is_sorted(),
            Self::Smooth { knots, .. } => knots.len() > 1 && knots.windows(2).all(|pair| pair[0] < pair[1]),
            _ => true,
        };
        (!good).then(|| {
            "a number of its driver cannot be; width and constant are above 0, steps ascend, and knots are two or more \
             that rise"
                .into()
        })
    }
}

/// Name of the column that gives the side from which a joint came.
fn side(chain: &Chain, joint: usize, from_rows: bool) -> String {
    let ending = if from_rows { APPROACH_FROM_ROWS } else { APPROACH };
    format!("{}{ending}", chain.joints()[joint].name)
}

/// Name of the column that gives the velocity of the coordinate that moves a joint.
fn velocity(chain: &Chain, joint: usize) -> String {
    format!("{}{VELOCITY}", chain.coordinates()[chain.joints()[joint].coordinate].name)
}
