//! What a file of effects adds to a robot: effects and error curves, and an averaged prediction where there is one.

use crate::arm::{Arm, Perturbation, Perturbed, Row};
use crate::effects::averaged::Averaged;
use crate::effects::driver::Conditions;
use crate::effects::model::{EffectModel, Standing};
use crate::parameters::{Effects, Parameter, Sensitivity};
use denavit_measurements::{Measurements, MissingColumn};
use denavit_model::{Chain, ChainJoint, Pose};

/// Effects and an averaged prediction; both add up.
#[derive(Debug, Clone, PartialEq)]
pub struct Correction {
    /// Effects and error curves.
    pub effects: EffectModel,
    /// A prediction averaged over everything that may act, a correction of the robot with its geometry alone.
    pub averaged: Option<Averaged>,
}

impl From<EffectModel> for Correction {
    fn from(effects: EffectModel) -> Self {
        Self { effects, averaged: None }
    }
}

impl From<Averaged> for Correction {
    fn from(averaged: Averaged) -> Self {
        Self { effects: EffectModel::new(averaged.mean().statics.clone(), Vec::new()), averaged: Some(averaged) }
    }
}

impl Correction {
    fn at_home(&self, joints: &[ChainJoint]) -> (Standing, Option<Standing>) {
        (self.effects.standing_of(joints), self.averaged.as_ref().map(Averaged::at_home))
    }

    fn add_to(
        &self,
        conditions: &Conditions<'_>,
        joints: &[ChainJoint],
        standing: &mut (Standing, Option<Standing>),
        out: &mut Perturbation,
    ) {
        if let (Some(averaged), Some(standing)) = (&self.averaged, &mut standing.1) {
            averaged.correct(conditions, standing, out);
        }
        self.effects.bend(conditions, joints, &mut standing.0, out);
    }

    /// Adds to `out` the perturbation of an arm with these joints under these conditions.
    pub fn add_perturbation(&self, conditions: &Conditions<'_>, joints: &[ChainJoint], out: &mut Perturbation) {
        self.add_to(conditions, joints, &mut self.at_home(joints), out);
    }

    /// base_from_tip of a chain of one tip (nominal or calibrated) with what moves the arm; m.
    ///
    /// Effects of target, anchor and instrument do not move the tip and are left out.
    ///
    /// # Panics
    /// `chain` has other joints than the model, or `conditions.reading` is too short.
    pub fn fk(&self, chain: &Chain, conditions: &Conditions<'_>) -> Pose {
        let mut perturbation = Perturbation::none(chain.joints().len());
        self.add_perturbation(conditions, chain.joints(), &mut perturbation);
        perturbation.fk(chain, conditions.reading)
    }
}

/// As a fit sees it: none of its numbers is free.
impl Effects for Correction {
    type Standing = (Standing, Option<Standing>);

    fn standing(&self, arm: &Arm) -> Self::Standing {
        self.at_home(&arm.joints)
    }

    fn parameters(&self) -> Vec<Parameter> {
        Vec::new()
    }

    fn are_none(&self) -> bool {
        self.averaged.is_none() && self.effects.are_none()
    }

    fn perturb(&self, row: Row<'_>, arm: &Arm, standing: &mut Self::Standing, out: &mut Perturbation) -> bool {
        if self.are_none() {
            return false;
        }
        self.add_to(&Conditions::of(row), &arm.joints, standing, out);
        true
    }

    fn sensitivities(&self, _: Row<'_>, _: &Arm, _: &mut Self::Standing, _: Perturbed<'_>, _: &mut [Sensitivity]) {}

    fn bound_to(&self, data: &Measurements) -> Result<Self, MissingColumn> {
        Ok(Self {
            effects: self.effects.bound_to(data)?,
            averaged: self.averaged.as_ref().map(|averaged| averaged.bound_to(data)).transpose()?,
        })
    }

    fn stepped(&self, _step: &[f64]) -> Self {
        self.clone()
    }
}
