//! An unchanged model with additional free directions of the arm: candidates and sources of noise are built from their columns.

use crate::arm::{Arm, Perturbation, Perturbed, Row};
use crate::effects::carrier::{Action, Carrier};
use crate::effects::driver::Statics;
use crate::effects::model::add_sensitivity;
use crate::parameters::{Effects, Parameter, ParameterKind, Sensitivity};

/// The model, with additional directions, each driven by 1.
#[derive(Debug)]
pub struct Probe<'a, E> {
    model: &'a E,
    /// The same number for each tip.
    directions: Vec<Vec<Vec<Action>>>,
}

impl<'a, E> Probe<'a, E> {
    /// Every direction of these carriers, one carrier after the other.
    pub fn of_carriers(model: &'a E, statics: &Statics, arm: &Arm, carriers: &[Carrier]) -> Self {
        let of = |tip: usize| carriers.iter().flat_map(move |carrier| carrier.directions(statics, &arm.joints, tip));
        Self { model, directions: (0..arm.tips.all().len()).map(|tip| of(tip).collect()).collect() }
    }

    /// Every joint's own motion.
    pub fn of_joints(model: &'a E, arm: &Arm) -> Self {
        let of_tip = |tip: &denavit_model::Tip| {
            let moved = |(slot, joint): (usize, &denavit_model::ChainJoint)| {
                if tip.joints[slot] { vec![Action::Twist { slot, twist: joint.screw.twist() }] } else { Vec::new() }
            };
            arm.joints.iter().enumerate().map(moved).collect()
        };
        Self { model, directions: arm.tips.all().iter().map(of_tip).collect() }
    }

    /// Number of directions: the last of its parameters.
    pub fn directions(&self) -> usize {
        self.directions[0].len()
    }
}

impl<E> Clone for Probe<'_, E> {
    fn clone(&self) -> Self {
        Self { model: self.model, directions: self.directions.clone() }
    }
}

impl<E: Effects> Effects for Probe<'_, E> {
    type Standing = E::Standing;

    fn standing(&self, arm: &Arm) -> E::Standing {
        self.model.standing(arm)
    }

    fn parameters(&self) -> Vec<Parameter> {
        let mut parameters = self.model.parameters();
        for _ in 0..self.directions() {
            let kind = ParameterKind::Effect { index: parameters.len() };
            parameters.push(Parameter { name: String::new(), kind, unit: "", tolerance: None });
        }
        parameters
    }

    fn perturb(&self, row: Row<'_>, arm: &Arm, standing: &mut E::Standing, out: &mut Perturbation) -> bool {
        self.model.perturb(row, arm, standing, out)
    }

    fn sensitivities(
        &self,
        row: Row<'_>,
        arm: &Arm,
        standing: &mut E::Standing,
        at: Perturbed<'_>,
        out: &mut [Sensitivity],
    ) {
        let own = out.len() - self.directions();
        self.model.sensitivities(row, arm, standing, at, &mut out[..own]);
        for (direction, out) in self.directions[row.tip()].iter().zip(&mut out[own..]) {
            for action in direction {
                add_sensitivity(action, 1.0, at.state, out);
            }
        }
    }

    fn stepped(&self, _step: &[f64]) -> Self {
        self.clone()
    }
}
