//! A model all of whose numbers are free: the coefficients of its effects, then the weights of its curves, wave by wave.

use crate::arm::{Arm, Perturbation, Perturbed, Row, RowState};
use crate::effects::carrier::Action;
use crate::effects::curve::{Curve, Waves};
use crate::effects::driver::Conditions;
use crate::effects::model::{EffectModel, Standing, add_sensitivity};
use crate::parameters::{Effects, Parameter, ParameterKind, Sensitivity};
use denavit_measurements::{Measurements, MissingColumn};
use denavit_model::ChainJoint;

/// The model.
#[derive(Debug, Clone, PartialEq)]
pub struct Everything(pub EffectModel);

impl Everything {
    /// Number of coefficients of effects.
    pub fn coefficients(&self) -> usize {
        self.0.effects.iter().map(|effect| effect.coefficients.len()).sum()
    }

    /// Number of its parameters.
    pub fn len(&self) -> usize {
        self.coefficients() + self.0.curves.iter().map(|curve| curve.waves.len()).sum::<usize>()
    }

    /// Whether it has none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Without effects and last waves of which no number is kept (`kept` ascending), and for each number its new index.
    #[must_use]
    pub fn pruned(&self, kept: &[usize]) -> (Self, Vec<Option<usize>>) {
        let mut places = vec![None; self.len()];
        let (mut first, mut next) = (0, 0);
        let mut model = EffectModel { effects: Vec::new(), curves: Vec::new(), ..self.0.clone() };
        for effect in &self.0.effects {
            let own = first..first + effect.coefficients.len();
            if own.clone().any(|number| kept.binary_search(&number).is_ok()) {
                own.clone().for_each(|number| places[number] = Some(next + number - first));
                next += own.len();
                model.effects.push(effect.clone());
            }
            first = own.end;
        }
        for curve in &self.0.curves {
            let own = first..first + curve.waves.len();
            let last = own.clone().rev().find(|number| kept.binary_search(number).is_ok());
            first = own.end;
            let Some(last) = last else { continue };
            let count = last + 1 - own.start;
            if let Waves::Sines { low, width, .. } = curve.waves {
                (0..count).for_each(|wave| places[own.start + wave] = Some(next + wave));
                next += count;
                let (waves, weights) = (Waves::Sines { low, width, count }, curve.weights[..count].to_vec());
                model.curves.push(Curve { waves, weights, ..curve.clone() });
            }
        }
        (Self(model), places)
    }

    /// Motion of the tip per unit of a curve's value, and the curve per unit of each wave; none where its joint does not move the tip.
    pub(crate) fn of_curve(
        &self,
        curve: &Curve,
        conditions: &Conditions<'_>,
        joints: &[ChainJoint],
        state: &RowState,
    ) -> Option<(Sensitivity, Vec<f64>)> {
        if !self.0.statics.tips[conditions.tip].joints[curve.joint] {
            return None;
        }
        let action = Action::Twist { slot: curve.joint, twist: joints[curve.joint].screw.twist() };
        let mut unit = Sensitivity::default();
        add_sensitivity(&action, 1.0, state, &mut unit);
        let reading = self.0.statics.chain.joints()[curve.joint].value(conditions.reading);
        Some((unit, curve.waves.values(reading)))
    }
}

impl Effects for Everything {
    type Standing = Standing;

    fn standing(&self, arm: &Arm) -> Standing {
        self.0.standing(arm)
    }

    fn parameters(&self) -> Vec<Parameter> {
        let mut parameters = self.0.parameters();
        for _ in parameters.len()..self.len() {
            let kind = ParameterKind::Effect { index: parameters.len() };
            parameters.push(Parameter { name: "wave".into(), kind, unit: "rad", tolerance: None });
        }
        parameters
    }

    fn perturb(&self, row: Row<'_>, arm: &Arm, standing: &mut Standing, out: &mut Perturbation) -> bool {
        self.0.perturb(row, arm, standing, out)
    }

    fn sensitivities(
        &self,
        row: Row<'_>,
        arm: &Arm,
        standing: &mut Standing,
        at: Perturbed<'_>,
        out: &mut [Sensitivity],
    ) {
        let conditions = Conditions::of(row);
        let (of_effects, mut of_waves) = out.split_at_mut(self.coefficients());
        self.0.sensitivities_of(&conditions, standing, at.state, of_effects);
        for curve in &self.0.curves {
            let (own, rest) = of_waves.split_at_mut(curve.waves.len());
            of_waves = rest;
            let Some((unit, waves)) = self.of_curve(curve, &conditions, &arm.joints, at.state) else { continue };
            for (out, wave) in own.iter_mut().zip(waves) {
                out.twist += unit.twist * wave;
            }
        }
    }

    fn bound_to(&self, data: &Measurements) -> Result<Self, MissingColumn> {
        self.0.bound_to(data).map(Self)
    }

    fn numbers(&self) -> Vec<f64> {
        let waves = self.0.curves.iter().flat_map(|curve| curve.weights.iter().copied());
        self.0.numbers().into_iter().chain(waves).collect()
    }

    fn stepped(&self, step: &[f64]) -> Self {
        let (of_effects, of_waves) = step.split_at(self.coefficients());
        let mut model = self.0.stepped(of_effects);
        let weights = model.curves.iter_mut().flat_map(|curve| curve.weights.iter_mut());
        weights.zip(of_waves).for_each(|(weight, step)| *weight += step);
        Self(model)
    }
}
