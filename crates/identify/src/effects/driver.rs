//! What drives an effect: functions of a row's readings, of gravity, and of recorded quantities.
//!
//! No driver sees a measured value. Other than the readings, a driver depends only on a [`Column`], which exists only where every
//! row has a value for it. A new driver is a variant of [`Driver`], its arms in [`Driver::values_into`], [`Driver::len`],
//! [`Driver::joint`], [`Driver::named_by`] and [`Driver::unit`], and a term that uses it in [`super::candidates`]; the
//! test `every_driver_gives_as_many_values_as_it_says` then covers it.
//!
//! ```compile_fail,E0308
//! use denavit_identify::effects::Driver;
//! let driver: Driver = Driver::Covariate("temperature".to_owned());
//! ```

mod bump;
mod piecewise;
mod side;
mod statics;
mod torque;

pub use self::bump::BumpShape;
pub use self::side::Side;
pub use self::statics::{AtHome, Conditions, LinkEnd, Posture, StandingAxis, Statics, motions_into};
pub use self::torque::TWIST_TO_BEND;
pub use crate::effects::columns::{
    APPROACH, APPROACH_FROM_ROWS, CURRENT, EFFORT, MEMORIES, MOTOR_TORQUE, RUN_ORDER, TIME, VELOCITY, WARMTH, WOUND_UP,
    unit_of,
};

use self::piecewise::hats;
use self::side::side_of;
use crate::effects::history::History;
use denavit_measurements::Column;
use denavit_model::nalgebra::Vector3;
use denavit_model::{Chain, Screw};
use serde::{Deserialize, Serialize};

/// What drives an effect. Joints are counted from 0, base to tip.
///
/// `C`: a recorded quantity, as a column of the data, or a name before it is bound to one.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", bound(deserialize = "C: Deserialize<'de> + Default"))]
pub enum Driver<C = Column> {
    /// 1.
    Constant,
    /// The joint's value, rad or m.
    Reading(usize),
    /// sin and cos of order · value.
    Harmonic {
        /// The joint whose value it follows.
        joint: usize,
        /// Periods per 2π rad (or per 2π m).
        order: f64,
    },
    /// A bump of height 1.
    Bump {
        /// The joint whose value it follows.
        joint: usize,
        /// Middle, rad or m.
        at: f64,
        /// Standard width, rad or m.
        width: f64,
        /// Its outline.
        shape: BumpShape,
    },
    /// Gravity's torque on a joint about its axis, N·m (force along it for a slide, N), payload included.
    Torque(usize),
    /// Parts of that torque with free sizes, for unknown masses. Two per link (one first moment in the plane
    /// across the axis each), for `links` links from the joint on; then the payload's part.
    TorqueTerms {
        /// The joint.
        joint: usize,
        /// How many links.
        links: usize,
    },
    /// That torque, and sine and cosine of the joint's value, three values: a spring between the joint's two links carries part
    /// of the torque.
    SprungTorque(usize),
    /// That torque, and its saturating form torque/(1 + |torque|/knee), two values: a joint that stiffens under load,
    /// as harmonic drives do (Spong 1987; makers give three straight pieces).
    HardeningTorque {
        /// The joint.
        joint: usize,
        /// Torque at which the compliance is half, N·m (N for a slide).
        knee: f64,
    },
    /// Gravity's moment across a joint's axis, N·m: two values, about a and b of its [`AxisBasis`](crate::arm::AxisBasis).
    MomentAcross(usize),
    /// Turn and shift of the end of a joint's link as a round cantilever of unit flexural rigidity (1 N·m²): six values.
    Cantilever(usize),
    /// Gravity's moment on the end of a joint's link, in the link's axes at home, N·m: three values.
    EndMoment(usize),
    /// Gravity's moment on the base about its origin, N·m: three values.
    Overturning,
    /// The same about two lines perpendicular to gravity, N·m, two values: gravity has no moment about its own line.
    LevelOverturning,
    /// The side from which a joint came, +1 from below.
    Approach(Side<C>),
    /// The side to which gravity pushes a joint, +1 or -1.
    GravitySide(usize),
    /// The side on which a joint with play comes to rest, +1 or -1: gravity's side where gravity is stronger than friction, else the side
    /// to which the joint was driven.
    FrictionSide {
        /// The side to which it was driven.
        #[serde(flatten)]
        side: Side<C>,
        /// Friction, N·m (N for a slide).
        friction: f64,
    },
    /// The side of approach times the size of gravity's torque on the joint, N·m (N for a slide): friction grows with the load, and
    /// the output lags by it.
    LoadedSide(Side<C>),
    /// Every joint's velocity, rad/s or m/s; not needed for a joint that stands still in every row.
    #[serde(skip)]
    Velocities(Vec<JointVelocity<C>>),
    /// A recorded quantity.
    Covariate(C),
    /// 1 - exp(-(value - from)/constant) of a recorded quantity.
    Decay {
        /// The quantity.
        covariate: C,
        /// Where it starts.
        from: f64,
        /// Time constant, in the quantity's unit.
        constant: f64,
    },
    /// For each place: 1 from there on, 0 before.
    Steps {
        /// The recorded quantity.
        covariate: C,
        /// Places, ascending.
        at: Vec<f64>,
    },
    /// Straight lines between knots: one value per knot but the first.
    Smooth {
        /// The recorded quantity.
        covariate: C,
        /// Knots, ascending.
        knots: Vec<f64>,
    },
    /// Values that are the same in every row: the mean of a driver whose quantity is not recorded.
    Fixed(Vec<f64>),
}

/// A joint's velocity, recorded as that of the coordinate that moves it.
#[derive(Debug, Clone, PartialEq)]
pub struct JointVelocity<C = Column> {
    /// The joint.
    pub joint: usize,
    /// Its coordinate's velocity, rad/s or m/s.
    pub of_coordinate: C,
}

/// The drivers of one joint, as a pattern that names it.
macro_rules! follows_a_joint {
    ($joint:ident) => {
        Self::Reading($joint)
            | Self::Harmonic { joint: $joint, .. }
            | Self::Bump { joint: $joint, .. }
            | Self::Torque($joint)
            | Self::TorqueTerms { joint: $joint, .. }
            | Self::SprungTorque($joint)
            | Self::HardeningTorque { joint: $joint, .. }
            | Self::MomentAcross($joint)
            | Self::Cantilever($joint)
            | Self::EndMoment($joint)
            | Self::GravitySide($joint)
            | Self::Approach(Side { joint: $joint, .. })
            | Self::FrictionSide { side: Side { joint: $joint, .. }, .. }
            | Self::LoadedSide(Side { joint: $joint, .. })
    };
}

impl<C> Driver<C> {
    /// Number of its values.
    pub fn len(&self, statics: &Statics) -> usize {
        match self {
            Self::Harmonic { .. } | Self::MomentAcross(_) | Self::LevelOverturning | Self::HardeningTorque { .. } => 2,
            Self::TorqueTerms { joint, links } => 2 * statics.carried(*joint, *links).count(),
            Self::Cantilever(_) => 6,
            Self::Overturning | Self::EndMoment(_) | Self::SprungTorque(_) => 3,
            Self::Velocities(_) => statics.chain.joints().len(),
            Self::Steps { at, .. } => at.len(),
            Self::Smooth { knots, .. } => knots.len().saturating_sub(1),
            Self::Fixed(values) => values.len(),
            _ => 1,
        }
    }

    /// The joint that it depends on, if it is one.
    pub fn joint(&self) -> Option<usize> {
        match *self {
            follows_a_joint!(joint) => Some(joint),
            _ => None,
        }
    }

    /// Every joint that it depends on.
    pub fn joints(&self) -> Vec<usize> {
        self.joint().into_iter().collect()
    }

    /// The same as [`Driver::joint`], mutable.
    pub(super) fn joint_mut(&mut self) -> Option<&mut usize> {
        match self {
            follows_a_joint!(joint) => Some(joint),
            _ => None,
        }
    }

    /// The side of approach that it depends on, if any: used by [`Driver::columns`], left out of files, and used to offer future poses.
    pub fn side(&self) -> Option<&Side<C>> {
        match self {
            Self::Approach(side) | Self::FrictionSide { side, .. } | Self::LoadedSide(side) => Some(side),
            _ => None,
        }
    }

    /// The same, mutable.
    pub(super) fn side_mut(&mut self) -> Option<&mut Side<C>> {
        match self {
            Self::Approach(side) | Self::FrictionSide { side, .. } | Self::LoadedSide(side) => Some(side),
            _ => None,
        }
    }

    /// Whether its values depend on the arm's deflection.
    pub fn feels_gravity(&self) -> bool {
        matches!(
            self,
            Self::Torque(_)
                | Self::TorqueTerms { .. }
                | Self::SprungTorque(_)
                | Self::HardeningTorque { .. }
                | Self::MomentAcross(_)
                | Self::Cantilever(_)
                | Self::EndMoment(_)
                | Self::Overturning
                | Self::LevelOverturning
        )
    }

    /// Whether its values depend on the arm's posture or load.
    pub fn needs_posture(&self) -> bool {
        self.feels_gravity()
            || matches!(self, Self::GravitySide(_) | Self::FrictionSide { .. } | Self::LoadedSide { .. })
    }

    /// Every column that it depends on; a payload is not included, since no payload column means no payload.
    pub fn columns(&self) -> Vec<&C> {
        match self {
            Self::Covariate(column)
            | Self::Decay { covariate: column, .. }
            | Self::Steps { covariate: column, .. }
            | Self::Smooth { covariate: column, .. } => vec![column],
            Self::Velocities(moving) => moving.iter().map(|joint| &joint.of_coordinate).collect(),
            _ => self.side().map(|side| &side.column).into_iter().collect(),
        }
    }

    /// The same with other columns.
    ///
    /// # Errors
    /// Those of `named`.
    pub fn named_by<D, E>(&self, mut named: impl FnMut(&C) -> Result<D, E>) -> Result<Driver<D>, E> {
        Ok(match self {
            Self::Constant => Driver::Constant,
            Self::Reading(joint) => Driver::Reading(*joint),
            Self::Harmonic { joint, order } => Driver::Harmonic { joint: *joint, order: *order },
            Self::Bump { joint, at, width, shape } => {
                Driver::Bump { joint: *joint, at: *at, width: *width, shape: *shape }
            }
            Self::Torque(joint) => Driver::Torque(*joint),
            Self::TorqueTerms { joint, links } => Driver::TorqueTerms { joint: *joint, links: *links },
            Self::SprungTorque(joint) => Driver::SprungTorque(*joint),
            Self::HardeningTorque { joint, knee } => Driver::HardeningTorque { joint: *joint, knee: *knee },
            Self::MomentAcross(joint) => Driver::MomentAcross(*joint),
            Self::Cantilever(joint) => Driver::Cantilever(*joint),
            Self::EndMoment(joint) => Driver::EndMoment(*joint),
            Self::Overturning => Driver::Overturning,
            Self::LevelOverturning => Driver::LevelOverturning,
            Self::Approach(side) => Driver::Approach(side.named_by(named)?),
            Self::GravitySide(joint) => Driver::GravitySide(*joint),
            Self::FrictionSide { side, friction } => {
                Driver::FrictionSide { side: side.named_by(named)?, friction: *friction }
            }
            Self::LoadedSide(side) => Driver::LoadedSide(side.named_by(named)?),
            Self::Velocities(moving) => {
                let of = |JointVelocity { joint, of_coordinate }: &JointVelocity<C>| {
                    Ok(JointVelocity { joint: *joint, of_coordinate: named(of_coordinate)? })
                };
                Driver::Velocities(moving.iter().map(of).collect::<Result<_, _>>()?)
            }
            Self::Covariate(covariate) => Driver::Covariate(named(covariate)?),
            Self::Decay { covariate, from, constant } => {
                Driver::Decay { covariate: named(covariate)?, from: *from, constant: *constant }
            }
            Self::Steps { covariate, at } => Driver::Steps { covariate: named(covariate)?, at: at.clone() },
            Self::Smooth { covariate, knots } => Driver::Smooth { covariate: named(covariate)?, knots: knots.clone() },
            Self::Fixed(values) => Driver::Fixed(values.clone()),
        })
    }
}

impl Driver {
    /// Its values in one row, appended to `out`.
    pub fn values_into(&self, statics: &Statics, conditions: &Conditions<'_>, posture: &Posture, out: &mut Vec<f64>) {
        let joints = statics.chain.joints();
        let recorded = |column: &Column| conditions.recorded.value(column);
        match self {
            Self::Constant => out.push(1.0),
            Self::Reading(joint) => out.push(joints[*joint].value(conditions.reading)),
            Self::Harmonic { joint, order } => {
                let (sine, cosine) = (order * joints[*joint].value(conditions.reading)).sin_cos();
                out.extend([sine, cosine]);
            }
            Self::Bump { joint, at, width, shape } => {
                out.push(shape.height((joints[*joint].value(conditions.reading) - at) / width));
            }
            Self::Torque(joint) => out.push(statics.torque(posture, *joint)),
            Self::TorqueTerms { joint, links } => statics.torque_terms(posture, *joint, *links, out),
            Self::SprungTorque(joint) => {
                let (sine, cosine) = joints[*joint].value(conditions.reading).sin_cos();
                out.extend([statics.torque(posture, *joint), sine, cosine]);
            }
            Self::HardeningTorque { joint, knee } => {
                let torque = statics.torque(posture, *joint);
                out.extend([torque, torque / (1.0 + torque.abs() / knee)]);
            }
            Self::MomentAcross(joint) => {
                let basis = &statics.bases[*joint];
                let moment = posture.state.before[*joint].rotation.inverse() * posture.moment_across(*joint);
                out.extend([moment.dot(&basis.a), moment.dot(&basis.b)]);
            }
            Self::Cantilever(joint) => {
                for part in statics.cantilever(posture, *joint, conditions.tip) {
                    out.extend(part.iter());
                }
            }
            Self::EndMoment(joint) => {
                let end = statics.link_end(*joint, conditions.tip);
                let load = end.and_then(|end| posture.loads.get(end.slot));
                let moment = load.map_or_else(Vector3::zeros, |load| load.moment);
                out.extend((posture.state.after[*joint].rotation.inverse() * moment).iter());
            }
            Self::Overturning => out.extend(statics.overturning(posture).iter()),
            Self::LevelOverturning => {
                let (moment, [first, second]) = (statics.overturning(posture), statics.level());
                out.extend([moment.dot(&first), moment.dot(&second)]);
            }
            Self::Approach(side) => out.push(side.value(&conditions.recorded)),
            Self::FrictionSide { side, friction } => {
                let torque = statics.torque(posture, side.joint);
                out.push(side.at_rest(&conditions.recorded, torque, *friction));
            }
            Self::LoadedSide(side) => {
                out.push(side.value(&conditions.recorded) * statics.torque(posture, side.joint).abs());
            }
            Self::GravitySide(joint) => out.push(side_of(statics.torque(posture, *joint))),
            Self::Velocities(moving) => {
                let first = out.len();
                out.resize(first + joints.len(), 0.0);
                for JointVelocity { joint, of_coordinate } in moving {
                    out[first + joint] = joints[*joint].scale * recorded(of_coordinate);
                }
            }
            Self::Covariate(column) => out.push(recorded(column)),
            Self::Decay { covariate, from, constant } => {
                out.push(-(-(recorded(covariate) - from).max(0.0) / constant).exp_m1());
            }
            Self::Steps { covariate, at } => {
                let value = recorded(covariate);
                out.extend(at.iter().map(|&place| if value >= place { 1.0 } else { 0.0 }));
            }
            Self::Smooth { covariate, knots } => hats(recorded(covariate), knots, out),
            Self::Fixed(values) => out.extend(values),
        }
    }

    /// Unit of the value at this index.
    pub fn unit(&self, chain: &Chain, value: usize) -> &'static str {
        let slides = |joint: usize| matches!(chain.joints()[joint].screw, Screw::Prismatic(_));
        match self {
            Self::Reading(joint) => {
                if slides(*joint) {
                    "m"
                } else {
                    "rad"
                }
            }
            Self::SprungTorque(_) if value > 0 => "1",
            Self::Torque(joint)
            | Self::SprungTorque(joint)
            | Self::HardeningTorque { joint, .. }
            | Self::LoadedSide(Side { joint, .. }) => {
                if slides(*joint) {
                    "N"
                } else {
                    "N m"
                }
            }
            Self::TorqueTerms { .. } => "kg m²/s² per m",
            Self::MomentAcross(_) | Self::EndMoment(_) | Self::Overturning | Self::LevelOverturning => "N m",
            Self::Cantilever(_) => "1/(N m²)",
            Self::Velocities(_) => "1/s",
            Self::Covariate(column) => match History::of_column(column.name()) {
                Some((name, history)) => {
                    let joint = chain.joints().iter().position(|joint| joint.name == name);
                    history.unit(joint.is_some_and(slides))
                }
                None => unit_of(column.name()),
            },
            _ => "1",
        }
    }

    /// The recorded quantity that it depends on, other than a joint's side or velocity.
    pub fn covariate(&self) -> Option<&str> {
        match self {
            Self::Covariate(column) => Some(column.name()),
            Self::Decay { covariate, .. } | Self::Steps { covariate, .. } | Self::Smooth { covariate, .. } => {
                Some(covariate.name())
            }
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::written::WrittenDriver;
    use denavit_measurements::{Covariate, Covariates};
    use denavit_model::examples;

    #[test]
    fn every_driver_gives_as_many_values_as_it_says() {
        for chain in examples::all() {
            let statics = Statics::of_chain(&chain);
            let n = statics.chain.joints().len();
            let recorded: Covariates = vec![Covariate { name: "time".into(), values: vec![3.0] }].into();
            let name = || recorded.column("one row", 1, "time").unwrap();
            let mut drivers = vec![
                Driver::Constant,
                Driver::Overturning,
                Driver::LevelOverturning,
                Driver::Velocities((0..n).map(|joint| JointVelocity { joint, of_coordinate: name() }).collect()),
                Driver::Covariate(name()),
                Driver::Decay { covariate: name(), from: 0.0, constant: 2.0 },
                Driver::Steps { covariate: name(), at: vec![1.0, 5.0] },
                Driver::Smooth { covariate: name(), knots: vec![0.0, 2.0, 5.0, 9.0] },
                Driver::Smooth { covariate: name(), knots: Vec::new() },
                Driver::Smooth { covariate: name(), knots: vec![f64::NAN, 1.0] },
            ];
            for joint in 0..n {
                let side = |from_rows| Side { joint, from_rows, column: name() };
                drivers.extend([
                    Driver::Reading(joint),
                    Driver::Harmonic { joint, order: 2.5 },
                    Driver::Bump { joint, at: 0.1, width: 0.2, shape: BumpShape::Tent },
                    Driver::Torque(joint),
                    Driver::TorqueTerms { joint, links: 2 },
                    Driver::SprungTorque(joint),
                    Driver::HardeningTorque { joint, knee: 3.0 },
                    Driver::MomentAcross(joint),
                    Driver::Cantilever(joint),
                    Driver::EndMoment(joint),
                    Driver::Approach(side(true)),
                    Driver::GravitySide(joint),
                    Driver::FrictionSide { side: side(false), friction: 2.0 },
                    Driver::LoadedSide(side(true)),
                ]);
            }
            let q = vec![0.3; statics.chain.coordinates().len()];
            let conditions = Conditions { reading: &q, recorded: recorded.row(0), tip: 0 };
            let posture = statics.posture(chain.joints(), &conditions, None);
            for driver in drivers {
                let mut values = Vec::new();
                driver.values_into(&statics, &conditions, &posture, &mut values);
                assert_eq!(values.len(), driver.len(&statics), "{driver:?}");
                assert!(values.iter().all(|value| value.is_finite()), "{driver:?}");
                let text = serde_json::to_string(&WrittenDriver::of(&driver)).unwrap();
                // NaN is not a number in a file.
                let read = serde_json::from_str::<WrittenDriver>(&text).ok().filter(|_| !text.contains("null"));
                let written = read.unwrap_or_else(|| WrittenDriver::of(&driver));
                assert_eq!(written.named(&statics.chain).len(&statics), values.len(), "{text}");
            }
        }
    }
}
