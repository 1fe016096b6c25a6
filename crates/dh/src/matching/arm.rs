//! A robot's motion with joint offsets and the signs of its scales folded into the axes.

use super::axes::Axis;
use super::fit::Sample;
use denavit_model::chain::{Chain, Quantity};
use denavit_model::nalgebra::{Unit, Vector3};
use denavit_model::screw::{AxisLine, Screw};
use denavit_model::se3::Pose;
use std::f64::consts::PI;

pub(crate) struct Arm {
    pub screws: Vec<Screw>,
    pub home: Pose,
    /// m.
    pub size: f64,
    /// To fit by.
    pub samples: Vec<Sample>,
    /// To judge by.
    pub proof: Vec<Sample>,
}

/// Configurations that a fit sees: some two hundred equations for at most some sixty unknowns.
const FITTED: usize = 36;

/// Configurations that the verdict rests on.
const PROVEN: usize = 500;

impl Arm {
    pub fn of(chain: &Chain) -> Self {
        let mut moved = Pose::identity();
        let mut screws = Vec::new();
        let mut reaches = Vec::new();
        let size = chain.size();
        for joint in chain.joints() {
            let screw = joint.screw.moved(&moved);
            screws.push(if joint.scale < 0.0 { reversed(&screw) } else { screw });
            moved *= joint.screw.motion(joint.offset);
            let coordinate = &chain.coordinates()[joint.coordinate];
            reaches.push(match (joint.screw, coordinate.quantity) {
                (Screw::Prismatic(_), _) => size.min(chain.greatest_slide(joint)),
                (_, Quantity::Angle | Quantity::Length) => PI,
            });
        }
        let mut arm = Self { screws, home: moved * chain.home(), size, samples: Vec::new(), proof: Vec::new() };
        arm.samples = (0..FITTED).map(|index| arm.sample(index, &reaches)).collect();
        arm.proof = (FITTED..FITTED + PROVEN).map(|index| arm.sample(index, &reaches)).collect();
        arm
    }

    /// The `index`-th of a low-discrepancy sequence of configurations.
    fn sample(&self, index: usize, reaches: &[f64]) -> Sample {
        let part = |joint: usize| (0.5 + (index as f64 + 1.0) * (joint as f64 + 2.3).sqrt()).fract() * 2.0 - 1.0;
        let values: Vec<f64> = reaches.iter().enumerate().map(|(joint, reach)| part(joint) * reach).collect();
        let reached =
            self.screws.iter().zip(&values).fold(Pose::identity(), |pose, (screw, value)| pose * screw.motion(*value));
        Sample { values, tip: reached * self.home }
    }

    pub fn axes(&self) -> Vec<Axis> {
        let axis = |screw: &Screw| Axis {
            direction: screw.direction().into_inner(),
            point: screw.line().map_or_else(Vector3::zeros, |line| line.point.coords),
            turns: screw.line().is_some(),
        };
        self.screws.iter().map(axis).collect()
    }
}

/// The same axis counted the other way; a screw stays as right- or left-handed as it is.
fn reversed(screw: &Screw) -> Screw {
    let turned = |axis: &AxisLine| AxisLine { direction: Unit::new_unchecked(-axis.direction.into_inner()), ..*axis };
    match screw {
        Screw::Revolute(axis) => Screw::Revolute(turned(axis)),
        Screw::Prismatic(direction) => Screw::Prismatic(-*direction),
        Screw::Helical { axis, pitch } => Screw::Helical { axis: turned(axis), pitch: *pitch },
    }
}
