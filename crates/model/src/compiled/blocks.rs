//! The numbers of a compiled chain, laid out for the machine: eight joints side by side.

use super::frames::{Step, Twist};
use crate::chain::ChainJoint;
use crate::screw::Screw;

/// Joints in a block: as many angles as the widest vector holds.
pub(crate) const JOINTS: usize = 8;

/// The constant step from one joint's axis to the next, after the joint's turn and its slide along z.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Gap {
    /// Offset along x, m.
    pub x: f64,
    /// Offset along y, m; mostly 0.
    pub y: f64,
    pub twist: Twist,
}

/// How fast a joint turns and slides along its frame's z, per unit of its coordinate.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Rate {
    pub coordinate: usize,
    pub turning: f64,
    pub sliding: f64,
}

/// Up to eight neighbouring joints; what lies beyond [`Block::count`] is neutral.
#[derive(Debug, Clone)]
pub(crate) struct Block {
    pub count: usize,
    pub coordinate: [usize; JOINTS],
    /// Joint value = scale · q + offset, as [`ChainJoint::value`].
    pub scale: [f64; JOINTS],
    pub offset: [f64; JOINTS],
    /// Angle about z per joint value: 1, -1, or 0 for slides.
    pub turning: [f64; JOINTS],
    /// Slide along z per joint value, m or m/rad.
    pub sliding: [f64; JOINTS],
    /// Slide along z at joint value 0, m.
    pub along: [f64; JOINTS],
    /// Quarter turns added to the angle.
    pub quarters: [u64; JOINTS],
    /// Cosine and sine of the rest of the angle's offset.
    pub rest_cosine: [f64; JOINTS],
    pub rest_sine: [f64; JOINTS],
    /// Whether any of these is not zero.
    pub any_rest: bool,
    pub gaps: [Gap; JOINTS],
    pub rates: [Rate; JOINTS],
}

impl Block {
    const NEUTRAL: Self = Self {
        count: 0,
        coordinate: [0; JOINTS],
        scale: [0.0; JOINTS],
        offset: [0.0; JOINTS],
        turning: [0.0; JOINTS],
        sliding: [0.0; JOINTS],
        along: [0.0; JOINTS],
        quarters: [0; JOINTS],
        rest_cosine: [1.0; JOINTS],
        rest_sine: [0.0; JOINTS],
        any_rest: false,
        gaps: [Gap { x: 0.0, y: 0.0, twist: Twist::Parallel }; JOINTS],
        rates: [Rate { coordinate: 0, turning: 0.0, sliding: 0.0 }; JOINTS],
    };

    /// The joints and the steps that follow them, in blocks.
    pub fn all(joints: &[ChainJoint], steps: &[(f64, Step)]) -> Vec<Self> {
        joints.chunks(JOINTS).zip(steps.chunks(JOINTS)).map(|(joints, steps)| Self::of(joints, steps)).collect()
    }

    fn of(joints: &[ChainJoint], steps: &[(f64, Step)]) -> Self {
        let mut block = Self { count: joints.len(), ..Self::NEUTRAL };
        for (k, (joint, (sense, step))) in joints.iter().zip(steps).enumerate() {
            let (turning, sliding) = match joint.screw {
                Screw::Revolute(_) => (*sense, 0.0),
                Screw::Prismatic(_) => (0.0, *sense),
                Screw::Helical { pitch, .. } => (*sense, sense * pitch.metres_per_radian()),
            };
            block.coordinate[k] = joint.coordinate;
            block.scale[k] = joint.scale;
            block.offset[k] = joint.offset;
            block.turning[k] = turning;
            block.sliding[k] = sliding;
            block.quarters[k] = step.quarters;
            (block.rest_cosine[k], block.rest_sine[k]) = step.rest;
            let [x, y, along] = step.offset;
            block.along[k] = along;
            block.gaps[k] = Gap { x, y, twist: step.twist };
            let (coordinate, scale) = (joint.coordinate, joint.scale);
            block.rates[k] = Rate { coordinate, turning: turning * scale, sliding: sliding * scale };
        }
        block.any_rest = block.rest_sine.iter().any(|sine| *sine != 0.0);
        block
    }
}
