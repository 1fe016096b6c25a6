//! Non-geometric effects as plain data: the part of a calibration that code needs.
//!
//! The caller fills this in from a calibration. Joints are counted from 0, base to tip; twists are `[omega; v]`
//! (rad, m) in the base frame with every joint value 0; twist i acts before joint i's motion, the last one on the tip.

use crate::render::posture;
use denavit_model::nalgebra::{DMatrix, Vector3, Vector6};
use denavit_model::{Chain, ChainJoint, Pose};

/// Effects on a robot.
#[derive(Debug, Clone, PartialEq)]
pub struct Effects {
    /// The robot that they correct.
    pub chain: Chain,
    /// Inputs of the code at run time, in addition to joint values.
    pub arguments: Vec<Argument>,
    /// What acts.
    pub model: Model,
    /// Where `model` is that of an averaged prediction: what it is blended with.
    pub averaged: Option<Averaged>,
    /// Test cases of the code.
    pub cases: Vec<Case>,
}

/// An input of the code at run time.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Argument {
    /// Such as `temperature`.
    pub name: String,
    /// Such as `°C`.
    pub unit: String,
}

/// A posture and where the tip is in it.
#[derive(Debug, Clone, PartialEq)]
pub struct Case {
    /// Joint values, rad or m.
    pub q: Vec<f64>,
    /// A value for each argument.
    pub given: Vec<f64>,
    /// base_from_tip with the effects.
    pub pose: Pose,
}

/// Effects that add up.
#[derive(Debug, Clone, PartialEq)]
pub struct Model {
    /// The joints that they act on.
    pub joints: Vec<ChainJoint>,
    /// base_from_tip of these joints with every joint value 0.
    pub home: Pose,
    /// The joints whose values the drivers use.
    pub read: Vec<ChainJoint>,
    /// The effects.
    pub terms: Vec<Term>,
    /// Error curves of joints.
    pub curves: Vec<Curve>,
    /// The masses that gravity acts on.
    pub masses: Masses,
}

/// Masses and where the links begin.
#[derive(Debug, Clone, PartialEq)]
pub struct Masses {
    /// The joint that carries each, kg, and the centre with every joint value 0, base frame, m.
    pub points: Vec<(usize, f64, Vector3<f64>)>,
    /// m/s², base frame.
    pub gravity: Vector3<f64>,
    /// kg, and where it is attached to the tip, base frame with every joint value 0, m.
    pub payload: (f64, Vector3<f64>),
    /// The point of each joint that its load is about, base frame with every joint value 0, m.
    pub starts: Vec<Vector3<f64>>,
}

/// An effect.
#[derive(Debug, Clone, PartialEq)]
pub struct Term {
    /// What drives it.
    pub driver: Driver,
    /// Its numbers.
    pub coefficients: Vec<f64>,
    /// What each unit of a coefficient times a value of the driver moves.
    pub moves: Vec<Move>,
}

/// What a unit of a coefficient times a value of a driver moves.
#[derive(Debug, Clone, PartialEq)]
pub struct Move {
    /// Which coefficient.
    pub coefficient: usize,
    /// Which value of the driver.
    pub value: usize,
    /// What moves.
    pub action: Action,
}

/// What an effect moves.
#[derive(Debug, Clone, PartialEq)]
pub enum Action {
    /// The arm.
    Twist {
        /// Before which joint; after the last one the tip.
        slot: usize,
        /// rad, m.
        twist: Vector6<f64>,
    },
    /// The target on the tip, tip frame, m.
    Target(Vector3<f64>),
    /// The instrument's scale.
    Scale,
    /// Reading error along the line of sight: by the target's orientation (tip frame, m), and from every side (m).
    Sight(Vector3<f64>, f64),
}

/// A value that is known now, or an argument.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Input {
    /// Known now.
    Known(f64),
    /// An argument by its index.
    Argument(usize),
}

/// The outline of a bump over u = (value - at)/width.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Bump {
    /// exp(-u²/2).
    Bell,
    /// 1 - |u|/2, 0 beyond.
    Tent,
    /// (1 + cos(π u/2.5))/2, 0 beyond.
    Wave,
}

/// The driver of an effect.
#[derive(Debug, Clone, PartialEq)]
pub enum Driver {
    /// Values that are always the same.
    Constant(Vec<f64>),
    /// A joint's value.
    Reading(usize),
    /// sin and cos of order · value.
    Harmonic {
        /// The joint.
        joint: usize,
        /// Periods per 2π.
        order: f64,
    },
    /// A bump of height 1.
    Bump {
        /// The joint.
        joint: usize,
        /// Middle, rad or m.
        at: f64,
        /// Standard width, rad or m.
        width: f64,
        /// Its outline.
        shape: Bump,
    },
    /// Gravity's torque on a joint, N·m (N for a slide).
    Torque(usize),
    /// Torque per first moment of each of these links along two directions (base frame, every joint value 0).
    TorqueTerms(usize, Vec<(usize, [Vector3<f64>; 2])>),
    /// Torque, sine and cosine of the joint's value.
    SprungTorque(usize),
    /// Torque, and torque/(1 + |torque|/knee).
    HardeningTorque(usize, f64),
    /// Gravity's moment across a joint's axis along two directions of its frame.
    MomentAcross(usize, [Vector3<f64>; 2]),
    /// Turn and shift of the end of a joint's link as a round cantilever.
    Cantilever {
        /// The joint.
        joint: usize,
        /// The joint that loads its end; none where that is the tip.
        next: Option<usize>,
        /// From the joint's point to the link's end, m.
        reach: Vector3<f64>,
        /// Shear and bending under the same moment.
        twist_to_bend: f64,
    },
    /// Gravity's moment on the end of a joint's link; by which joint it is loaded, none where that is the tip.
    EndMoment(usize, Option<usize>),
    /// Gravity's moment on the base along these directions, base frame.
    Overturning(Vec<Vector3<f64>>),
    /// The side to which gravity pushes a joint.
    GravitySide(usize),
    /// The side on which a joint with play comes to rest against friction: joint, side of approach, friction.
    FrictionSide(usize, Input, f64),
    /// The side of approach times the size of gravity's torque.
    LoadedSide(usize, Input),
    /// Arguments, each times a factor.
    Told(Vec<(f64, Input)>),
    /// 1 - exp(-(value - from)/constant).
    Decay {
        /// The value.
        of: Input,
        /// Where it starts.
        from: f64,
        /// Its constant.
        constant: f64,
    },
    /// For each place: 1 from there on, 0 before.
    Steps(Input, Vec<f64>),
    /// Straight lines between knots: a value for each knot but the first.
    Smooth(Input, Vec<f64>),
}

/// A joint's error curve.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    /// The joint.
    pub joint: usize,
    /// Its waves: sin(k π (x - low)/width) from `low` to `low + width`, or, where there is no interval, sin(k x) and cos(k x) in turn.
    pub interval: Option<(f64, f64)>,
    /// One number per wave, rad or m.
    pub weights: Vec<f64>,
}

/// What an averaged prediction is blended with, and the uncertainty of each.
#[derive(Debug, Clone, PartialEq)]
pub struct Averaged {
    /// Joints of the robot with its geometry alone.
    pub geometric: Vec<ChainJoint>,
    /// Its base_from_tip with every joint value 0.
    pub home: Pose,
    /// Base and tip of the averaged robot in those of the geometric one.
    pub placed: [Pose; 2],
    /// Base and tip of the drawn robot in those of the geometric one.
    pub drawn: [Pose; 2],
    /// Tip frame, m.
    pub target: Vector3<f64>,
    /// instrument_from_base, where there is one.
    pub instrument: Option<Pose>,
    /// Uncertainty of the full model, and of geometry alone.
    pub spreads: [Spread; 2],
    /// Variance of any curve beyond its interval, rad² or m².
    pub of_curves: f64,
    /// Mean square error of the drawing, m².
    pub of_drawing: f64,
    /// That of geometry, m², and the part of it that its numbers have among the fitted rows.
    pub of_geometry: [f64; 2],
    /// How many times the variance of what is read that of the target's place is.
    pub across: f64,
    /// By how many times more unsure the blend is where the drawing has half a say.
    pub far_more: f64,
    /// Lowest and highest reading of each coordinate among the fitted rows.
    pub ranges: Vec<(f64, f64)>,
}

/// A covariance of some of a model's numbers: coefficients term by term, then weights curve by curve. After them come the instrument's frame (six
/// numbers, where there is one) and the target's place (three).
#[derive(Debug, Clone, PartialEq)]
pub struct Spread {
    /// Which numbers.
    pub kept: Vec<usize>,
    /// Their covariance.
    pub covariance: DMatrix<f64>,
}

/// Postures for testing the written effects: from the limits of the joints, then from `ranges`, rad or m.
pub fn postures(chain: &Chain, ranges: Option<&[(f64, f64)]>) -> Vec<Vec<f64>> {
    let limits: Vec<(f64, f64)> = chain.coordinates().iter().map(denavit_model::Coordinate::range).collect();
    let of = |ranges: &[(f64, f64)], index: usize| posture(ranges, index);
    let inside = ranges.iter().flat_map(|ranges| (1..4).map(|index| of(ranges, index)));
    (0..4).map(|index| of(&limits, index)).chain(inside).collect()
}
