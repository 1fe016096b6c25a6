//! A robot's motion with joint offsets and the signs of its scales folded into the axes.

use super::axes::Axis;
use super::fit::Sample;
use denavit_model::chain::Chain;
use denavit_model::nalgebra::Vector3;
use denavit_model::screw::Screw;
use denavit_model::se3::Pose;
use std::f64::consts::PI;

pub(crate) struct Arm {
    pub screws: Vec<Screw>,
    pub home: Pose,
    /// m.
    pub size: f64,
    /// To fit by.
    pub samples: Vec<Sample>,
    /// Held out.
    pub proof: Vec<Sample>,
}

/// Configurations of a fit in addition to four for each joint: six equations each, for at most as many unknowns.
const FITTED: usize = 12;

/// A slide whose range is less than this many times the robot's size is moved by the robot's size.
const STANDS: f64 = 1e-3;

/// Configurations for the verdict.
const PROVEN: usize = 500;

impl Arm {
    pub fn of(chain: &Chain) -> Self {
        let mut moved = Pose::identity();
        let mut screws = Vec::new();
        let mut reaches = Vec::new();
        let size = chain.size();
        for joint in chain.joints() {
            let screw = joint.screw.moved(&moved);
            screws.push(if joint.scale < 0.0 { screw.reversed() } else { screw });
            moved *= joint.screw.motion(joint.offset);
            reaches.push(match joint.screw {
                Screw::Prismatic(_) => match chain.greatest_slide(joint) {
                    slide if slide > STANDS * size => slide.min(size),
                    _ => size,
                },
                _ => PI,
            });
        }
        let mut arm = Self { screws, home: moved * chain.home(), size, samples: Vec::new(), proof: Vec::new() };
        let fitted = FITTED + 4 * reaches.len();
        arm.samples = (0..fitted).map(|index| arm.sample(index, &reaches)).collect();
        arm.proof = (fitted..fitted + PROVEN).map(|index| arm.sample(index, &reaches)).collect();
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
