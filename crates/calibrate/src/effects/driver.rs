//! What drives an effect: functions of a row's readings, of gravity, and of what was recorded beside them.
//!
//! No driver sees a measured value. What a driver follows beside the readings is a [`Column`], which is only there where every
//! row has a value for it. A new driver is a variant of [`Driver`], its arms in [`Driver::values_into`], [`Driver::len`],
//! [`Driver::joint`], [`Driver::named_by`] and [`Driver::unit`], and an entry that uses it in [`super::catalogue::KINDS`]; the
//! test `every_driver_gives_as_many_values_as_it_says` then covers it.

use crate::effects::carrier::{axis_points, link_points, points_of};
use crate::effects::field::Products;
use crate::effects::gravity::{Load, Masses};
use crate::observation::arm::{AxisBasis, Perturbation, Row, RowState};
use crate::observation::measurements::covariates::PAYLOAD;
use crate::observation::measurements::{Column, RecordedRow};
use denavit_model::nalgebra::{Point3, Rotation3, Vector3};
use denavit_model::{Chain, ChainJoint, PlacedRobot, Pose, Reading, Robot, Screw, Tips, se3};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Name of the covariate that counts rows in run order.
pub const RUN_ORDER: &str = "run order";
/// Ending of the covariates that give the side from which a joint came, +1 from below.
pub const APPROACH: &str = ".approach";
/// Ending of the same when it was read from the order of the rows.
pub const APPROACH_FROM_ROWS: &str = ".approach from run order";
/// Within the names of the covariates that say how far a joint has wound itself up since it last turned back, -1 to +1, for one of
/// [`MEMORIES`]: read from the order of the rows.
pub const WOUND_UP: &str = ".wound up over";
/// Travels after which a joint that turned back is wound up to all but 1/e, rad or m.
pub const MEMORIES: [f64; 3] = [0.02, 0.1, 0.5];
/// Ending of the covariates that give a joint's velocity.
pub const VELOCITY: &str = ".velocity";

/// Endings of the covariates that give what a joint's motor works against: torque, the same as ROS calls it (N·m; N for a slide), and current, A.
pub const MOTOR_TORQUE: &str = ".torque";
/// See [`MOTOR_TORQUE`].
pub const EFFORT: &str = ".effort";
/// See [`MOTOR_TORQUE`].
pub const CURRENT: &str = ".current";

/// Shear and bending of a round tube under the same end moment: E/(2G) · 2 for steel.
const TWIST_TO_BEND: f64 = 1.3;

/// An axis whose direction times that of gravity is more than this stands upright: within 2.6°.
const UPRIGHT: f64 = 0.999;

/// What drives an effect. Joints are counted from 0, base to tip.
///
/// `C`: what stands for a recorded quantity, a column of the data at hand, or a name before it is bound to one.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
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
    /// Parts of that torque whose sizes are free: where masses are unknown. Two per link (one first moment in the plane
    /// across the axis each), for `links` links from the joint on; then the payload's part.
    TorqueTerms {
        /// The joint.
        joint: usize,
        /// How many links.
        links: usize,
    },
    /// That torque, and sine and cosine of the joint's value, three values: what a spring between the joint's two links takes up
    /// of it.
    SprungTorque(usize),
    /// That torque, and the same as it levels off, torque/(1 + |torque|/knee), two values: a joint that stiffens as it is loaded,
    /// as harmonic drives do (Spong 1987; makers give three straight pieces).
    HardeningTorque {
        /// The joint.
        joint: usize,
        /// Where half of the softness is gone, N·m (N for a slide).
        knee: f64,
    },
    /// Gravity's moment across a joint's axis, N·m: two values, about [`AxisBasis::a`] and [`AxisBasis::b`].
    MomentAcross(usize),
    /// Turn and shift of the end of a joint's link as a round cantilever of unit flexural rigidity (1 N·m²): six values.
    Cantilever(usize),
    /// Gravity's moment on the end of a joint's link, in the link's axes at home, N·m: three values.
    EndMoment(usize),
    /// Gravity's moment on the base about its origin, N·m: three values.
    Overturning,
    /// The same about two lines across gravity, N·m, two values: gravity has no moment about its own line.
    LevelOverturning,
    /// The side from which a joint came, +1 from below.
    Approach {
        /// The joint.
        joint: usize,
        /// Read from the order of the rows, for the file does not say.
        from_rows: bool,
        /// Where it is recorded.
        #[serde(skip)]
        side: C,
    },
    /// The side to which gravity pushes a joint, +1 or -1.
    GravitySide(usize),
    /// The side on which a joint with play comes to rest, +1 or -1: where gravity is stronger than friction its own, else that
    /// which the joint was driven to.
    FrictionSide {
        /// The joint.
        joint: usize,
        /// Friction, N·m (N for a slide).
        friction: f64,
        /// The side from which it came is read from the order of the rows.
        from_rows: bool,
        /// Where it is recorded.
        #[serde(skip)]
        side: C,
    },
    /// The side from which a joint came times the size of gravity's torque on it, N·m (N for a slide): friction grows with what a
    /// joint carries, and the output stays behind by it.
    LoadedSide {
        /// The joint.
        joint: usize,
        /// The side is read from the order of the rows.
        from_rows: bool,
        /// Where it is recorded.
        #[serde(skip)]
        side: C,
    },
    /// Every joint's velocity, rad/s or m/s; a joint that stands still in every row needs none.
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
    /// Products of shapes of two joints' readings: a smooth function of both.
    Products(Products),
}

/// Where a joint's velocity is recorded: as that of the coordinate that moves it.
#[derive(Debug, Clone, PartialEq)]
pub struct JointVelocity<C = Column> {
    /// The joint.
    pub joint: usize,
    /// Its coordinate's velocity, rad/s or m/s.
    pub of_coordinate: C,
}

/// The outline of a bump over u = (value - at)/width.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum BumpShape {
    /// exp(-u²/2).
    Bell,
    /// 1 - |u|/2, 0 beyond.
    Tent,
    /// (1 + cos(π u/2.5))/2, 0 beyond.
    Wave,
}

impl BumpShape {
    /// Every outline.
    pub const ALL: [Self; 3] = [Self::Bell, Self::Tent, Self::Wave];

    /// Height at u.
    pub fn height(self, u: f64) -> f64 {
        match self {
            Self::Bell => (-0.5 * u * u).exp(),
            Self::Tent => (1.0 - 0.5 * u.abs()).max(0.0),
            Self::Wave if u.abs() > 2.5 => 0.0,
            Self::Wave => 0.5 + 0.5 * (std::f64::consts::PI * u / 2.5).cos(),
        }
    }
}

/// Where the arm stands and what it carries, for the nominal chain.
#[derive(Debug, Clone, Default)]
pub struct Posture {
    /// Motions of the joints.
    pub state: RowState,
    /// Gravity on each joint.
    pub loads: Vec<Load>,
}

/// What a driver may look at in one row.
#[derive(Clone, Copy)]
pub struct Conditions<'a> {
    /// Joint readings in coordinate order, rad or m.
    pub reading: &'a [f64],
    /// What was recorded beside them.
    pub recorded: RecordedRow<'a>,
    /// The tip that was measured, of several: its place among [`Statics::tips`].
    pub tip: usize,
}

impl<'a> Conditions<'a> {
    /// Those of a row.
    pub fn of(row: Row<'a>) -> Self {
        Self { reading: row.reading(), recorded: row.recorded(), tip: row.tip() }
    }
}

/// The chain and its masses: what drivers are computed with. Of several tips the joints of all, see [`Chain::joined`].
#[derive(Debug, Clone, PartialEq)]
pub struct Statics {
    /// The nominal chain.
    pub chain: Chain,
    /// Its tips.
    pub tips: Arc<Tips>,
    /// What gravity acts on.
    pub masses: Masses,
    /// One point per joint and one for each tip, base frame at home, m: where links begin and end.
    pub points: Vec<Point3<f64>>,
    /// For each joint the one that carries it.
    carriers: Vec<Option<usize>>,
}

/// Where a link ends on the way to a tip.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LinkEnd {
    /// The twist of [`Perturbation::twists`] that acts there: that of the next joint, or the tip's.
    pub slot: usize,
    /// At home, base frame, m.
    pub point: Point3<f64>,
}

impl Statics {
    /// Of these parts; `points`: one per joint and one for each tip.
    pub(super) fn new(chain: Chain, tips: Arc<Tips>, masses: Masses, points: Vec<Point3<f64>>) -> Self {
        let carriers = tips.carriers();
        Self { chain, tips, masses, points, carriers }
    }

    /// For a chain of this robot, its angles as intended.
    pub fn of(robot: &Robot, chain: &Chain) -> Self {
        Self::placed(&PlacedRobot::new(robot, Reading::Intended), chain)
    }

    /// For a chain of this robot, its angles read as for the chain.
    pub fn placed(robot: &PlacedRobot, chain: &Chain) -> Self {
        Self::placed_tips(robot, chain, &Arc::new(Tips::only(chain)))
    }

    /// For the joints of several tips of this robot, angles read as for them.
    pub fn placed_tips(robot: &PlacedRobot, chain: &Chain, tips: &Arc<Tips>) -> Self {
        let masses = Masses::of(robot, chain, tips);
        let points = points_of(chain, tips, |chain| link_points(robot, chain));
        Self::new(chain.clone(), tips.clone(), masses, points)
    }

    /// For a chain without a tree: masses stand in, links run from axis to axis.
    pub fn of_chain(chain: &Chain) -> Self {
        Self::of_tips(chain, &Arc::new(Tips::only(chain)))
    }

    /// The same for the joints of several tips.
    pub fn of_tips(chain: &Chain, tips: &Arc<Tips>) -> Self {
        let (masses, points) = (Masses::stand_in(chain, tips), points_of(chain, tips, axis_points));
        Self::new(chain.clone(), tips.clone(), masses, points)
    }

    /// The joint that carries a joint; none where it stands on the base.
    pub fn carrier(&self, joint: usize) -> Option<usize> {
        self.carriers[joint]
    }

    /// The joints on the way to a tip, base to tip.
    pub fn on_the_way(&self, tip: usize) -> impl Iterator<Item = usize> + '_ {
        self.tips[tip].on_the_way()
    }

    /// Where a joint's link ends on the way to a tip; none where the joint is not on it.
    pub fn link_end(&self, joint: usize, tip: usize) -> Option<LinkEnd> {
        let joints = self.chain.joints().len();
        self.tips[tip].joints[joint].then(|| match self.on_the_way(tip).find(|&other| other > joint) {
            Some(next) => LinkEnd { slot: next, point: self.points[next] },
            None => LinkEnd { slot: joints, point: self.points[joints + tip] },
        })
    }

    /// The joint itself and those that it carries, at most so many.
    pub(super) fn carried(&self, joint: usize, most: usize) -> impl Iterator<Item = usize> + '_ {
        (joint..self.chain.joints().len()).filter(move |&other| self.tips.carries(joint, other)).take(most)
    }

    /// Stands the arm as one row has it, given way by a perturbation where one is known.
    ///
    /// Joints that are not on the way to the row's tip stand as they read: what they carry loads the joints before them.
    pub fn posture(&self, conditions: &Conditions<'_>, perturbation: Option<&Perturbation>) -> Posture {
        let mut state = RowState::default();
        let tip = &self.tips[conditions.tip];
        let mut last = None;
        for (index, joint) in self.chain.joints().iter().enumerate() {
            let mut reached = self.carriers[index].map_or_else(Pose::identity, |carrier| state.after[carrier]);
            if tip.joints[index] {
                last = Some(index);
                if let Some(perturbation) = perturbation {
                    reached *= se3::exp(&perturbation.twists[index]);
                }
            }
            state.before.push(reached);
            reached *= joint.screw.motion(joint.value(conditions.reading));
            state.after.push(reached);
        }
        let mut reached = last.map_or_else(Pose::identity, |last| state.after[last]);
        if let Some(last) = perturbation.and_then(|perturbation| perturbation.twists.last()) {
            reached *= se3::exp(last);
        }
        state.tip = reached * tip.home;
        let payload = last.map(|joint| (joint, conditions.recorded.payload()));
        let loads = self.masses.loads(&self.points, &self.carriers, &state, payload);
        Posture { state, loads }
    }

    /// Whether gravity may load a joint: not one that turns about an upright axis wherever the joints before it stand. What
    /// little torque the tilt of a mounted base makes there tells nothing that geometry does not.
    pub fn feels_gravity(&self, joint: usize) -> bool {
        let down = self.masses.gravity.normalize();
        let upright = |joint: &ChainJoint| joint.screw.direction().dot(&down).abs() > UPRIGHT;
        let turns = |joint: &ChainJoint| !matches!(joint.screw, Screw::Prismatic(_));
        let joints = self.chain.joints();
        let before = (0..joint).filter(|&other| self.tips.carries(other, joint)).map(|other| &joints[other]);
        let stays = before.filter(|before| turns(before)).all(upright);
        !(stays && turns(&joints[joint]) && upright(&joints[joint]))
    }

    /// Gravity's torque (N·m) or force (N) on a joint along its own motion.
    pub fn torque(&self, posture: &Posture, joint: usize) -> f64 {
        let turn = posture.state.before[joint].rotation * self.chain.joints()[joint].screw.direction().into_inner();
        let load = &posture.loads[joint];
        match &self.chain.joints()[joint].screw {
            Screw::Prismatic(_) => turn.dot(&load.force),
            Screw::Revolute(_) => turn.dot(&load.moment),
            Screw::Helical { pitch, .. } => turn.dot(&load.moment) + pitch.metres_per_radian() * turn.dot(&load.force),
        }
    }

    /// Gravity's moment on the base about its origin, base frame, N·m.
    fn overturning(&self, posture: &Posture) -> Vector3<f64> {
        let on_the_base = self.carriers.iter().zip(&self.points).zip(&posture.loads);
        let moments = on_the_base.filter(|((carrier, _), _)| carrier.is_none());
        moments.map(|((_, at), load)| load.moment + at.coords.cross(&load.force)).sum()
    }

    /// Two lines across gravity, base frame: x and y as nearly as may be.
    fn level(&self) -> [Vector3<f64>; 2] {
        let down = self.masses.gravity.normalize();
        let along = if down.x.abs() < down.y.abs().max(down.z.abs()) { Vector3::x() } else { Vector3::z() };
        let first = (along - down * down.dot(&along)).normalize();
        [first, first.cross(&down)]
    }

    fn torque_terms(&self, posture: &Posture, joint: usize, links: usize, out: &mut Vec<f64>) {
        let state = &posture.state;
        let axis = state.before[joint].rotation * self.chain.joints()[joint].screw.direction().into_inner();
        // Torque per first moment h (kg m): axis · (h × gravity) = (gravity × axis) · h.
        let lever = self.masses.gravity.cross(&axis);
        for link in self.carried(joint, links) {
            let basis = AxisBasis::of(&self.chain.joints()[link].screw);
            let rotation = &state.after[link].rotation;
            out.push(lever.dot(&(rotation * basis.a)));
            out.push(lever.dot(&(rotation * basis.b)));
        }
    }

    fn cantilever(&self, posture: &Posture, joint: usize, tip: usize) -> [Vector3<f64>; 2] {
        let Some(end) = self.link_end(joint, tip) else { return [Vector3::zeros(); 2] };
        let reach = end.point - self.points[joint];
        let length = reach.norm();
        if length == 0.0 {
            return [Vector3::zeros(); 2];
        }
        let to_home: Rotation3<f64> = posture.state.after[joint].rotation.inverse();
        let (force, torque) = match posture.loads.get(end.slot) {
            Some(load) => (to_home * load.force, to_home * load.moment),
            None => (Vector3::zeros(), Vector3::zeros()),
        };
        let along = reach / length;
        let twist = along * along.dot(&torque);
        let bend = torque - twist;
        let turn = (bend + twist * TWIST_TO_BEND) * length + reach.cross(&force) * (0.5 * length);
        let basis = force - along * along.dot(&force);
        let shift = basis * (length.powi(3) / 3.0) + bend.cross(&reach) * (0.5 * length);
        [turn, shift]
    }
}

/// The drivers that follow one joint, as a pattern that names it.
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
            | Self::Approach { joint: $joint, .. }
            | Self::GravitySide($joint)
            | Self::FrictionSide { joint: $joint, .. }
            | Self::LoadedSide { joint: $joint, .. }
    };
}

impl<C> Driver<C> {
    /// How many values it has.
    pub fn len(&self, statics: &Statics) -> usize {
        match self {
            Self::Harmonic { .. } | Self::MomentAcross(_) | Self::LevelOverturning | Self::HardeningTorque { .. } => 2,
            Self::TorqueTerms { joint, links } => 2 * statics.carried(*joint, *links).count(),
            Self::Cantilever(_) => 6,
            Self::Overturning | Self::EndMoment(_) | Self::SprungTorque(_) => 3,
            Self::Velocities(_) => statics.chain.joints().len(),
            Self::Steps { at, .. } => at.len(),
            Self::Smooth { knots, .. } => knots.len().saturating_sub(1),
            Self::Products(_) => Products::COUNT,
            _ => 1,
        }
    }

    /// The joint that it follows, where it follows one.
    pub fn joint(&self) -> Option<usize> {
        match *self {
            follows_a_joint!(joint) => Some(joint),
            _ => None,
        }
    }

    /// Every joint that it follows.
    pub fn joints(&self) -> Vec<usize> {
        match self {
            Self::Products(products) => products.joints().to_vec(),
            _ => self.joint().into_iter().collect(),
        }
    }

    /// The same as [`Driver::joint`], to be counted anew.
    pub(super) fn joint_mut(&mut self) -> Option<&mut usize> {
        match self {
            follows_a_joint!(joint) => Some(joint),
            _ => None,
        }
    }

    /// Whether its values depend on how far the arm has given way.
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

    /// Whether its values depend on how the arm stands, or on its load.
    pub fn needs_posture(&self) -> bool {
        self.feels_gravity()
            || matches!(self, Self::GravitySide(_) | Self::FrictionSide { .. } | Self::LoadedSide { .. })
    }

    /// Every column that it follows; a payload is none of them, for nothing given is nothing carried.
    pub fn columns(&self) -> Vec<&C> {
        match self {
            Self::Covariate(column)
            | Self::Approach { side: column, .. }
            | Self::FrictionSide { side: column, .. }
            | Self::LoadedSide { side: column, .. }
            | Self::Decay { covariate: column, .. }
            | Self::Steps { covariate: column, .. }
            | Self::Smooth { covariate: column, .. } => vec![column],
            Self::Velocities(moving) => moving.iter().map(|joint| &joint.of_coordinate).collect(),
            _ => Vec::new(),
        }
    }

    /// The same with others in the place of the columns that it follows.
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
            Self::Approach { joint, from_rows, side } => {
                Driver::Approach { joint: *joint, from_rows: *from_rows, side: named(side)? }
            }
            Self::GravitySide(joint) => Driver::GravitySide(*joint),
            Self::FrictionSide { joint, friction, from_rows, side } => {
                Driver::FrictionSide { joint: *joint, friction: *friction, from_rows: *from_rows, side: named(side)? }
            }
            Self::LoadedSide { joint, from_rows, side } => {
                Driver::LoadedSide { joint: *joint, from_rows: *from_rows, side: named(side)? }
            }
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
            Self::Products(products) => Driver::Products(*products),
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
                let basis = AxisBasis::of(&joints[*joint].screw);
                let moment = posture.state.before[*joint].rotation.inverse() * posture.loads[*joint].moment;
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
            Self::Approach { side, .. } => out.push(recorded(side)),
            Self::FrictionSide { joint, friction, side, .. } => {
                // What comes from below lags behind, as what gravity pushes down does.
                let torque = statics.torque(posture, *joint) - friction * recorded(side);
                out.push(if torque < 0.0 { -1.0 } else { 1.0 });
            }
            Self::LoadedSide { joint, side, .. } => {
                out.push(recorded(side) * statics.torque(posture, *joint).abs());
            }
            Self::GravitySide(joint) => {
                let torque = statics.torque(posture, *joint);
                out.push(if torque < 0.0 { -1.0 } else { 1.0 });
            }
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
            Self::Products(products) => {
                products.values_into(products.joints().map(|joint| joints[joint].value(conditions.reading)), out);
            }
        }
    }

    /// Unit of its value of this index: what a coefficient is per.
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
            | Self::LoadedSide { joint, .. } => {
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
            Self::Covariate(column) => unit_of(column.name()),
            _ => "1",
        }
    }

    /// The recorded quantity that it follows, where it follows one that is no joint's side or velocity.
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

/// The unit that the contract gives to a recorded quantity.
pub fn unit_of(covariate: &str) -> &'static str {
    match covariate {
        "time" => "s",
        PAYLOAD => "kg",
        RUN_ORDER => "row",
        name if name.ends_with("temperature") => "°C",
        name if name.ends_with(MOTOR_TORQUE) || name.ends_with(EFFORT) => "N m",
        name if name.ends_with(CURRENT) => "A",
        _ => "1",
    }
}

/// Piecewise linear basis over the knots; the first one is left out and the ends are held.
fn hats(value: f64, knots: &[f64], out: &mut Vec<f64>) {
    let (Some(first), Some(last)) = (knots.first(), knots.last()) else { return };
    // Not `clamp`, which panics where the knots are not in order.
    let value = value.max(*first).min(*last);
    out.extend((1..knots.len()).map(|k| {
        if value <= knots[k] {
            ((value - knots[k - 1]) / (knots[k] - knots[k - 1])).max(0.0)
        } else {
            knots.get(k + 1).map_or(1.0, |next| ((next - value) / (next - knots[k])).max(0.0))
        }
    }));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::field::{ShapedReading, Shapes};
    use crate::effects::written::WrittenDriver;
    use crate::observation::measurements::{Covariate, Covariates};
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
                Driver::Products(Products { of: [ShapedReading { joint: 0, shapes: Shapes::Turns }; 2], size: 1e-4 }),
            ];
            for joint in 0..n {
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
                    Driver::Approach { joint, from_rows: true, side: name() },
                    Driver::GravitySide(joint),
                    Driver::FrictionSide { joint, friction: 2.0, from_rows: false, side: name() },
                    Driver::LoadedSide { joint, from_rows: true, side: name() },
                ]);
            }
            let q = vec![0.3; statics.chain.coordinates().len()];
            let conditions = Conditions { reading: &q, recorded: recorded.row(0), tip: 0 };
            let posture = statics.posture(&conditions, None);
            for driver in drivers {
                let mut values = Vec::new();
                driver.values_into(&statics, &conditions, &posture, &mut values);
                assert_eq!(values.len(), driver.len(&statics), "{driver:?}");
                assert!(values.iter().all(|value| value.is_finite()), "{driver:?}");
                let text = serde_json::to_string(&WrittenDriver::of(&driver)).unwrap();
                // What is not a number is none in a file.
                let read = serde_json::from_str::<WrittenDriver>(&text).ok().filter(|_| !text.contains("null"));
                let written = read.unwrap_or_else(|| WrittenDriver::of(&driver));
                assert_eq!(written.named(&statics.chain).len(&statics), values.len(), "{text}");
            }
        }
    }

    #[test]
    fn torque_is_the_change_of_potential_energy() {
        for chain in examples::all() {
            let statics = Statics::of_chain(&chain);
            let recorded = RecordedRow::nothing();
            let energy = |q: &[f64]| -> f64 {
                let posture = statics.posture(&Conditions { reading: q, recorded, tip: 0 }, None);
                statics
                    .masses
                    .points
                    .iter()
                    .map(|p| -p.mass * statics.masses.gravity.dot(&(posture.state.after[p.joint] * p.centre).coords))
                    .sum()
            };
            let q: Vec<f64> = (0..statics.chain.coordinates().len()).map(|k| 0.4 + 0.3 * k as f64).collect();
            let posture = statics.posture(&Conditions { reading: &q, recorded, tip: 0 }, None);
            for (index, coordinate) in (0..q.len()).map(|k| (k, k)) {
                let movers: Vec<usize> = (0..statics.chain.joints().len())
                    .filter(|&j| statics.chain.joints()[j].coordinate == coordinate)
                    .collect();
                let (mut up, mut low) = (q.clone(), q.clone());
                up[index] += 1e-5;
                low[index] -= 1e-5;
                let slope = (energy(&up) - energy(&low)) / 2e-5;
                let torque: f64 =
                    movers.iter().map(|&j| statics.torque(&posture, j) * statics.chain.joints()[j].scale).sum();
                assert!((torque + slope).abs() < 1e-5 * (1.0 + slope.abs()), "{torque} {slope}");
            }
        }
    }

    #[test]
    fn hats_are_straight_between_knots_and_held_beyond() {
        let at = |value: f64| {
            let mut out = Vec::new();
            hats(value, &[0.0, 1.0, 3.0], &mut out);
            out
        };
        assert_eq!(at(0.5), [0.5, 0.0]);
        assert_eq!(at(2.0), [0.5, 0.5]);
        assert_eq!(at(-1.0), [0.0, 0.0]);
        assert_eq!(at(7.0), [0.0, 1.0]);
    }
}
