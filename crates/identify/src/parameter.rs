//! A fit's parameters: which are free, and how far each is expected to be from the drawing.

/// Whether a parameter of this name is the zero of a joint.
pub fn is_zero(parameter: &str) -> bool {
    parameter.ends_with(ZERO)
}

/// Ends the name of a joint's zero, after the joint.
pub(crate) const ZERO: &str = ".zero";

/// What a parameter changes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ParameterKind {
    /// The direction of a joint's axis, about [`AxisBasis::a`](crate::arm::AxisBasis) (0) or [`AxisBasis::b`](crate::arm::AxisBasis) (1), rad.
    Turn {
        /// Index of the joint.
        joint: usize,
        /// 0 or 1.
        direction: usize,
    },
    /// The position of a joint's axis, along [`AxisBasis::a`](crate::arm::AxisBasis) (0) or [`AxisBasis::b`](crate::arm::AxisBasis) (1), m.
    Move {
        /// Index of the joint.
        joint: usize,
        /// 0 or 1.
        direction: usize,
    },
    /// A joint's pitch, m/rad.
    Pitch {
        /// Index of the joint.
        joint: usize,
    },
    /// A joint's scale, relative to nominal.
    Scale {
        /// Index of the joint.
        joint: usize,
    },
    /// Offset added to the reading of a joint's coordinate, rad or m, for all joints that it moves.
    Zero {
        /// Index of the first joint that the coordinate moves.
        joint: usize,
    },
    /// A number of an effect.
    Effect {
        /// Index among the effects' parameters.
        index: usize,
    },
    /// The frame of a setup's instrument: 0-2 rotation (rad), 3-5 translation (m), base frame.
    Instrument {
        /// Index of the setup.
        setup: usize,
        /// 0 to 5.
        component: usize,
    },
    /// The frame of a setup of which only the plane z = 0 is observable, in its own axes: rotations about x and y (rad), translation
    /// along z (m); where only the direction z is observable, the rotations alone.
    Plane {
        /// Index of the setup.
        setup: usize,
        /// 0 to 2.
        component: usize,
    },
    /// A point's position, base frame, m.
    Point {
        /// Index of the point.
        point: usize,
        /// 0 to 2.
        component: usize,
    },
    /// A target's position, tip frame, m.
    Target {
        /// Index of the target.
        target: usize,
        /// 0 to 2.
        component: usize,
    },
    /// A target's orientation, about the tip frame's axes, rad.
    TargetTurn {
        /// Index of the target.
        target: usize,
        /// 0 to 2.
        component: usize,
    },
}

impl ParameterKind {
    /// Index of the joint that it belongs to.
    pub fn joint(self) -> Option<usize> {
        match self {
            Self::Turn { joint, .. }
            | Self::Move { joint, .. }
            | Self::Pitch { joint }
            | Self::Scale { joint }
            | Self::Zero { joint } => Some(joint),
            _ => None,
        }
    }
}

/// One free number of a fit.
#[derive(Debug, Clone, PartialEq)]
pub struct Parameter {
    /// Name, such as `joint_2.turn_x`.
    pub name: String,
    /// What it changes.
    pub kind: ParameterKind,
    /// Its unit: `rad`, `m`, `m/rad`, `1`.
    pub unit: &'static str,
    /// Prior standard deviation from nominal, in the parameter's unit; `None` without a prior.
    pub tolerance: Option<f64>,
}

/// Expected errors of a robot relative to its drawing: standard deviations of the prior (see [`crate::prior`]).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tolerances {
    /// Direction of an axis on the link that carries it, rad.
    pub turn: f64,
    /// Position of an axis on the link that carries it, m.
    pub shift: f64,
    /// Zero of a turning joint, rad: it is set when the arm is mastered, not machined.
    pub zero_turn: f64,
    /// Zero of a slide, m.
    pub zero_slide: f64,
    /// Pitch, m/rad.
    pub pitch: f64,
    /// Relative scale.
    pub scale: f64,
}

impl Default for Tolerances {
    /// Usual machining tolerances of an arm of about a metre: 1 mrad, 1 mm; 0.1 mm per turn; one part in a thousand.
    /// Zeros: about a degree, 5 mm.
    fn default() -> Self {
        Self {
            turn: 1e-3,
            shift: 1e-3,
            zero_turn: 0.02,
            zero_slide: 5e-3,
            pitch: 1e-4 / std::f64::consts::TAU,
            scale: 1e-3,
        }
    }
}

/// Which parts of the arm a fit may change; the instrument and the targets are always free.
#[derive(Debug, Clone, PartialEq)]
pub struct Freedom {
    /// For each joint, its axis.
    pub axes: Vec<bool>,
    /// For each joint, its scale.
    pub scales: Vec<bool>,
    /// For each joint, its pitch; helical joints' pitches are part of the axes and free with them.
    pub pitches: Vec<bool>,
    /// For each joint, its zero. Free axes already include every zero: this matters only where the axes are held.
    pub zeros: Vec<bool>,
}

impl Freedom {
    /// Instrument and targets alone: the nominal stage.
    pub fn placement(joints: usize) -> Self {
        let none = || vec![false; joints];
        Self { axes: none(), scales: none(), pitches: none(), zeros: none() }
    }

    /// The zero of every joint and nothing else.
    pub fn zeros(joints: usize) -> Self {
        Self { zeros: vec![true; joints], ..Self::placement(joints) }
    }

    /// Whether zeros are free and no axis is.
    pub fn zeros_alone(&self) -> bool {
        self.zeros.contains(&true) && !self.axes.contains(&true)
    }

    /// Every axis, no scale, no pitch of a revolute joint.
    pub fn axes(joints: usize) -> Self {
        Self { axes: vec![true; joints], ..Self::placement(joints) }
    }
}

/// A known value: its residual over its standard deviation, and the nonzero derivatives, by column.
#[derive(Debug, Clone, PartialEq)]
pub struct Known {
    /// Known minus predicted.
    pub residual: f64,
    /// Columns and derivatives of the residual.
    pub columns: Vec<(usize, f64)>,
}
