//! The three forms of a product of exponentials: base, tool and local frames, and conversions between them.
//!
//! ```text
//! base   T = exp([S1] q1) ··· exp([Sn] qn) M                       twists in the base frame     eq. (5)
//! tool   T = M exp([B1] q1) ··· exp([Bn] qn),  Bi = Ad(M⁻¹) Si      twists in the tool frame     eq. (6)
//! local  T = T1 exp([L1] q1) T2 ··· exp([Ln] qn) T(n+1)             each in a frame of its own   eq. (7)
//! ```
//! Twists may come unnormalised, as an identification leaves them; [`BaseForm::chain`] normalises them (eq. 1).

use crate::chain::{Chain, ChainError, ChainJoint, Coordinate, Quantity};
use crate::screw::{Screw, TwistError};
use crate::se3::{self, Pose};
use nalgebra::Vector6;
use thiserror::Error;

/// Twists `[omega; v]` of any length in the base frame, and base_from_tip at zero.
#[derive(Debug, Clone, PartialEq)]
pub struct BaseForm {
    /// One per joint, from base to tip; rad and m per unit of the joint's coordinate.
    pub twists: Vec<Vector6<f64>>,
    /// base_from_tip at zero.
    pub home: Pose,
}

/// Twists in the tool frame, and base_from_tip at zero.
#[derive(Debug, Clone, PartialEq)]
pub struct ToolForm {
    /// One per joint, from base to tip.
    pub twists: Vec<Vector6<f64>>,
    /// base_from_tip at zero.
    pub home: Pose,
}

/// Twists in frames of their own, and the constant motions between those frames.
#[derive(Debug, Clone, PartialEq)]
pub struct LocalForm {
    /// One per joint, each in its own frame.
    pub twists: Vec<Vector6<f64>>,
    /// base_from_first, first_from_second, …, last_from_tip at zero: one more than there are joints.
    pub steps: Vec<Pose>,
}

/// Why twists do not form a chain.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum FormError {
    /// A twist is not a screw axis.
    #[error("joint {number}: {source}")]
    Twist {
        /// Counted from 1.
        number: usize,
        /// What is wrong with it.
        source: TwistError,
    },
    /// The parts do not form a chain.
    #[error(transparent)]
    Chain(#[from] ChainError),
}

impl BaseForm {
    /// The base form of a chain's motion as a function of its joint coordinates, offsets folded in.
    ///
    /// A chain in which one coordinate moves several joints has one twist per *joint*.
    pub fn of(chain: &Chain) -> Self {
        let mut zero = Pose::identity();
        let mut twists = Vec::new();
        for joint in chain.joints() {
            twists.push(se3::adjoint_times(&zero, &joint.screw.twist()) * joint.scale);
            zero *= joint.screw.motion(joint.offset);
        }
        Self { twists, home: zero * chain.home() }
    }

    /// base_from_tip at `q`, one value per twist.
    pub fn fk(&self, q: &[f64]) -> Pose {
        let mut reached = Pose::identity();
        for (twist, value) in self.twists.iter().zip(q) {
            reached *= se3::exp(&(twist * *value));
        }
        reached * self.home
    }

    /// The chain with normalised screw axes; the normalisation factor becomes each joint's scale.
    ///
    /// # Errors
    /// A twist is zero or not finite.
    ///
    /// # Source
    /// Wu, Crawford, Roberts 2019, eq. (1).
    ///
    /// # Examples
    /// ```
    /// use denavit_model::{examples, forms::BaseForm};
    /// let chain = examples::puma_like();
    /// let names: Vec<String> = chain.coordinates().iter().map(|c| c.name.clone()).collect();
    /// let again = BaseForm::of(&chain).chain("puma_like", &names)?;
    /// let q = [0.1, 0.2, 0.3, 0.4, 0.5, 0.6];
    /// assert!((again.fk(&q).to_homogeneous() - chain.fk(&q).to_homogeneous()).norm() < 1e-14);
    /// # Ok::<(), denavit_model::forms::FormError>(())
    /// ```
    pub fn chain(&self, name: &str, joint_names: &[String]) -> Result<Chain, FormError> {
        let mut coordinates = Vec::new();
        let mut joints = Vec::new();
        for (index, (twist, joint_name)) in self.twists.iter().zip(joint_names).enumerate() {
            let (screw, scale) =
                Screw::from_twist(twist).map_err(|source| FormError::Twist { number: index + 1, source })?;
            let quantity = if screw.line().is_some() { Quantity::Angle } else { Quantity::Length };
            coordinates.push(Coordinate::unlimited(joint_name.clone(), quantity));
            joints.push(ChainJoint { name: joint_name.clone(), screw, coordinate: index, scale, offset: 0.0 });
        }
        Ok(Chain::new((name, "base", "tool"), coordinates, joints, self.home)?)
    }

    /// The same motion with twists in the tool frame: Bi = Ad(M⁻¹) Si, eq. (6).
    pub fn tool_form(&self) -> ToolForm {
        let tool_from_base = self.home.inverse();
        let twists = self.twists.iter().map(|twist| se3::adjoint_times(&tool_from_base, twist)).collect();
        ToolForm { twists, home: self.home }
    }

    /// The same motion with each twist in a frame of its own, given by `frames`: base_from_frame at zero, one a joint.
    ///
    /// # Panics
    /// `frames` is empty while there are joints, or shorter than the twists.
    pub fn local_form(&self, frames: &[Pose]) -> LocalForm {
        let mut twists = Vec::new();
        let mut steps = Vec::new();
        let mut base_from_last = Pose::identity();
        for (index, twist) in self.twists.iter().enumerate() {
            let base_from_frame = frames[index];
            steps.push(base_from_last.inverse() * base_from_frame);
            twists.push(se3::adjoint_times(&base_from_frame.inverse(), twist));
            base_from_last = base_from_frame;
        }
        steps.push(base_from_last.inverse() * self.home);
        LocalForm { twists, steps }
    }
}

impl ToolForm {
    /// base_from_tip at `q`, one value per twist.
    pub fn fk(&self, q: &[f64]) -> Pose {
        let mut reached = self.home;
        for (twist, value) in self.twists.iter().zip(q) {
            reached *= se3::exp(&(twist * *value));
        }
        reached
    }

    /// The same motion with twists in the base frame: Si = Ad(M) Bi.
    pub fn base_form(&self) -> BaseForm {
        let twists = self.twists.iter().map(|twist| se3::adjoint_times(&self.home, twist)).collect();
        BaseForm { twists, home: self.home }
    }
}

impl LocalForm {
    /// base_from_tip at `q`, one value per twist.
    pub fn fk(&self, q: &[f64]) -> Pose {
        let mut reached = Pose::identity();
        for ((step, twist), value) in self.steps.iter().zip(&self.twists).zip(q) {
            reached *= step * se3::exp(&(twist * *value));
        }
        self.steps.last().map_or(reached, |last| reached * last)
    }

    /// The same motion with twists in the base frame.
    pub fn base_form(&self) -> BaseForm {
        let mut base_from_frame = Pose::identity();
        let mut twists = Vec::new();
        for (step, twist) in self.steps.iter().zip(&self.twists) {
            base_from_frame *= step;
            twists.push(se3::adjoint_times(&base_from_frame, twist));
        }
        let home = self.steps.last().map_or(base_from_frame, |last| base_from_frame * last);
        BaseForm { twists, home }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::examples;

    fn agree(a: &Pose, b: &Pose) {
        let (turned, moved) = se3::difference(a, b);
        assert!(turned < 1e-13 && moved < 1e-13, "{turned} {moved}");
    }

    #[test]
    fn every_form_moves_alike_and_converts_back() {
        for chain in examples::all() {
            let q: Vec<f64> = (0..chain.joints().len()).map(|k| 0.7 - 0.3 * k as f64).collect();
            let base = BaseForm::of(&chain);
            agree(&base.fk(&q), &chain.fk(&q));
            agree(&base.tool_form().fk(&q), &chain.fk(&q));
            agree(&base.tool_form().base_form().fk(&q), &chain.fk(&q));
            let frames: Vec<Pose> =
                base.twists.iter().map(|t| se3::exp(&(t * 0.3 + Vector6::new(0.1, 0.2, 0.3, 1.0, 2.0, 3.0)))).collect();
            let local = base.local_form(&frames);
            agree(&local.fk(&q), &chain.fk(&q));
            agree(&local.base_form().fk(&q), &chain.fk(&q));
        }
    }

    #[test]
    fn scales_and_pitches_follow_from_unnormalised_twists() {
        let chain = examples::scara_helical();
        let mut base = BaseForm::of(&chain);
        base.twists[3] *= 1.25;
        let names: Vec<String> = chain.coordinates().iter().map(|c| c.name.clone()).collect();
        let stretched = base.chain("scara", &names).unwrap();
        assert!((stretched.joints()[3].scale - 1.25).abs() < 1e-15);
        let pitch = stretched.joints()[3].screw.pitch().unwrap();
        assert!((pitch - 0.02 / std::f64::consts::TAU).abs() < 1e-15);
        agree(&stretched.fk(&[0.1, 0.2, 0.3, 0.4]), &chain.fk(&[0.1, 0.2, 0.3, 0.5]));
    }

    #[test]
    fn a_zero_twist_is_refused_by_number() {
        let base = BaseForm { twists: vec![Vector6::zeros()], home: Pose::identity() };
        let error = base.chain("nothing", &["j".into()]).unwrap_err();
        assert_eq!(error.to_string(), "joint 1: the twist is zero, so nothing moves; give the joint an axis");
    }
}
