//! Effects with their numbers: their perturbation in a row, and their JSON form.

use crate::arm::{Arm, Perturbation, Perturbed, Row, RowState};
use crate::effects::carrier::{Action, Carrier};
use crate::effects::catalogue::Kind;
use crate::effects::curve::Curve;
use crate::effects::driver::{AtHome, Conditions, Driver, Posture, Statics, motions_into};
use crate::parameters::{Effects, Parameter, ParameterKind, Sensitivity};
use denavit_measurements::{Measurements, MissingColumn};
use denavit_model::nalgebra::Vector6;
use denavit_model::{Chain, ChainJoint, Pose, se3};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Most passes to find the posture of an arm that bends under its weight.
const MOST_PASSES: usize = 6;
/// Negligible change between two passes (rad, m).
const STILL: f64 = 1e-7;

/// How the values of a driver combine with the directions of a carrier.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Coupling {
    /// Every direction uses every value, each pair with its own coefficient.
    Each,
    /// Direction k uses value k, and all share one coefficient.
    Paired,
}

/// Where it acts × what drives it: a term of the model without its numbers.
///
/// `D`: the driver, bound to its columns, with their names only, or a [`WrittenDriver`](crate::effects::WrittenDriver) as in a file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Term<D = Driver> {
    /// The engineer's name for it.
    pub kind: Kind,
    /// Where it acts.
    pub carrier: Carrier,
    /// What drives it.
    pub driver: D,
    /// How these two combine.
    pub coupling: Coupling,
}

impl<D> Term<D> {
    /// Number of coefficients for this number of driver values.
    pub(super) fn coefficients_of(&self, statics: &Statics, values: usize) -> usize {
        let joints = statics.chain.joints();
        match self.coupling {
            Coupling::Paired => 1,
            Coupling::Each => self.carrier.directions(statics, joints, 0).len() * values,
        }
    }

    /// Whether it moves the tip; the others change what is measured.
    pub fn moves_the_tip(&self) -> bool {
        !matches!(
            self.carrier,
            Carrier::Target | Carrier::Anchor | Carrier::Scale | Carrier::Reading | Carrier::Sight | Carrier::Range
        )
    }
}

impl Term {
    /// How many coefficients it has.
    pub fn coefficients(&self, statics: &Statics) -> usize {
        self.coefficients_of(statics, self.driver.len(statics))
    }

    /// Calls back with the actions of a unit of every coefficient: its index, the action, the amount for these values of the driver.
    pub(crate) fn each_action(
        &self,
        directions: &[Vec<Action>],
        values: &[f64],
        mut take: impl FnMut(usize, &Action, f64),
    ) {
        for (direction, actions) in directions.iter().enumerate() {
            for (index, value) in values.iter().enumerate() {
                let coefficient = match self.coupling {
                    Coupling::Each => direction * values.len() + index,
                    Coupling::Paired if direction == index => 0,
                    Coupling::Paired => continue,
                };
                for action in actions {
                    take(coefficient, action, *value);
                }
            }
        }
    }

    /// Name of coefficient `index` and its unit as a pair: unit of the carrier per unit of the driver.
    pub fn coefficient_name(&self, statics: &Statics, index: usize) -> (String, &'static str, &'static str) {
        let values = self.driver.len(statics);
        let (direction, value) = match self.coupling {
            Coupling::Paired => (0, 0),
            Coupling::Each => (index / values, index % values),
        };
        let mut name = match (&self.driver, self.coupling) {
            (Driver::Harmonic { .. }, _) => ["sin", "cos"][value].to_string(),
            (Driver::SprungTorque(_), _) => ["torque", "spring_sin", "spring_cos"][value].to_string(),
            (Driver::HardeningTorque { .. }, _) => ["loaded", "unloaded"][value].to_string(),
            (Driver::LevelOverturning, _) => format!("about_{}", ["first", "second"][value]),
            (Driver::Steps { .. }, _) => format!("step_{}", value + 1),
            (Driver::Smooth { .. }, _) => format!("knot_{}", value + 2),
            (Driver::TorqueTerms { joint, .. }, _) => {
                let link = statics.carried(*joint, value / 2 + 1).last().unwrap_or(*joint);
                format!("link_{}_{}", link + 1, ["a", "b"][value % 2])
            }
            _ => "coefficient".to_string(),
        };
        if self.coupling == Coupling::Each {
            let direction = self.carrier.direction_name(direction);
            if !direction.is_empty() {
                name = format!("{direction}.{name}");
            }
        }
        (name, self.carrier.unit(&statics.chain, direction), self.driver.unit(&statics.chain, value))
    }
}

/// A term with its numbers.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Effect<D = Driver> {
    /// What it is.
    #[serde(flatten)]
    pub term: Term<D>,
    /// Coefficients: direction by direction, within it value by value of the driver; unit: carrier's per driver's.
    pub coefficients: Vec<f64>,
}

impl<D> Effect<D> {
    /// The same with its driver in another form: bound to columns, with their names, or as in a file.
    #[must_use]
    pub fn with_driver<E>(&self, driver: E) -> Effect<E> {
        let Self { term: Term { kind, carrier, coupling, .. }, coefficients } = self;
        let term = Term { kind: *kind, carrier: *carrier, driver, coupling: *coupling };
        Effect { term, coefficients: coefficients.clone() }
    }
}

/// Effects on a chain, ready for a fit, for forward kinematics, for compensation.
#[derive(Debug, Clone, PartialEq)]
pub struct EffectModel {
    /// The nominal chain and its masses.
    pub statics: Statics,
    /// The effects; they add up.
    pub effects: Vec<Effect>,
    /// Error curves of joints, no cause claimed; these add to the effects.
    pub curves: Vec<Curve>,
    /// Effects of an earlier calibration of the same chain: they act with the others and have no free numbers.
    pub earlier: Option<Arc<EffectModel>>,
}

/// An arm as effects see it: the part that is the same for all rows, and its posture in the last row.
#[derive(Debug, Clone)]
pub struct Standing {
    /// With its masses, where an effect depends on the posture.
    arm: Option<AtHome>,
    /// For each tip and each acting effect, the actions of a unit of it.
    directions: Vec<Vec<Vec<Vec<Action>>>>,
    motions: Vec<Pose>,
    posture: Posture,
    values: Vec<f64>,
    steady: Perturbation,
    given: Perturbation,
    next: Perturbation,
}

impl EffectModel {
    /// The effects on this chain.
    pub fn new(statics: Statics, effects: Vec<Effect>) -> Self {
        Self { statics, effects, curves: Vec::new(), earlier: None }
    }

    /// No effects with free numbers, with those of an earlier calibration.
    pub fn beside(statics: &Statics, earlier: Option<&Arc<Self>>) -> Self {
        Self { earlier: earlier.cloned(), ..Self::new(statics.clone(), Vec::new()) }
    }

    /// All effects that act.
    fn acting(&self) -> impl Iterator<Item = &Effect> {
        self.earlier.iter().flat_map(|earlier| &earlier.effects).chain(&self.effects)
    }

    /// These terms with every coefficient zero, with the effects of an earlier calibration.
    pub fn of_terms(statics: &Statics, earlier: Option<&Arc<Self>>, terms: &[Term]) -> Self {
        let effects = terms
            .iter()
            .map(|term| Effect { term: term.clone(), coefficients: vec![0.0; term.coefficients(statics)] })
            .collect();
        Self { effects, ..Self::beside(statics, earlier) }
    }

    /// An arm with these joints as the effects see it, the same for all rows.
    pub(crate) fn standing_of(&self, joints: &[ChainJoint]) -> Standing {
        let of_tip = |tip: usize| {
            self.acting().map(|effect| effect.term.carrier.directions(&self.statics, joints, tip)).collect()
        };
        let nothing = || Perturbation::none(joints.len());
        let needs_posture = self.acting().any(|effect| effect.term.driver.needs_posture());
        Standing {
            arm: needs_posture.then(|| self.statics.at_home(joints)),
            directions: (0..self.statics.tips.all().len()).map(of_tip).collect(),
            motions: Vec::new(),
            posture: Posture::default(),
            values: Vec::new(),
            steady: nothing(),
            given: nothing(),
            next: nothing(),
        }
    }

    /// Adds to `out` the effects' perturbation of an arm with these joints under these conditions; returns the arm's posture then.
    ///
    /// Where gravity bends the arm, its moment is that of the bent arm: passes repeat until convergence.
    pub fn add_perturbation(
        &self,
        conditions: &Conditions<'_>,
        joints: &[ChainJoint],
        out: &mut Perturbation,
    ) -> Posture {
        let mut own = Perturbation::none(joints.len());
        let posture = self.stand(conditions, joints, &mut self.standing_of(joints), &mut own).clone();
        out.add(&own);
        posture
    }

    /// The same into `out`, which must be all zero; `standing`: that of these joints.
    pub fn stand<'s>(
        &self,
        conditions: &Conditions<'_>,
        joints: &[ChainJoint],
        standing: &'s mut Standing,
        out: &mut Perturbation,
    ) -> &'s Posture {
        self.bend(conditions, joints, standing, out);
        if standing.arm.is_none() {
            standing.posture = self.statics.posture(joints, conditions, Some(out));
        }
        &standing.posture
    }

    /// The same; the posture is left out where no effect depends on it.
    pub(super) fn bend(
        &self,
        conditions: &Conditions<'_>,
        joints: &[ChainJoint],
        standing: &mut Standing,
        out: &mut Perturbation,
    ) {
        let Standing { arm, directions, motions, posture, values, steady, given, next } = standing;
        let directions = &directions[conditions.tip];
        let Some(arm) = arm else { return self.add_steady(conditions, joints, directions, values, out) };
        steady.clear();
        self.add_steady(conditions, joints, directions, values, steady);
        motions_into(joints, conditions.reading, motions);
        // A joint whose reading counts from the ground is not at its reading.
        self.statics.posture_into(arm, motions, conditions, Some(steady), posture);
        let mut bent = |posture: &Posture, next: &mut Perturbation| {
            next.clear();
            next.add(steady);
            for (effect, directions) in self.acting().zip(directions) {
                if effect.term.driver.needs_posture() {
                    self.add_effect(effect, directions, conditions, posture, values, next);
                }
            }
        };
        let mut last = 0.0;
        let passes = if self.acting().any(|effect| effect.term.driver.feels_gravity()) { MOST_PASSES } else { 0 };
        given.clear();
        for _ in 0..passes {
            bent(posture, next);
            let moved = next.twists.iter().zip(&given.twists).map(|(a, b)| (a - b).amax()).fold(0.0, f64::max);
            std::mem::swap(given, next);
            // The next pass would change it in the same proportion as this one did.
            if moved < STILL || moved * moved < STILL * last {
                out.add(given);
                return;
            }
            last = moved;
            self.statics.posture_into(arm, motions, conditions, Some(given), posture);
        }
        bent(posture, next);
        out.add(next);
    }

    /// Adds to `out` the effects that do not depend on the posture under gravity.
    fn add_steady(
        &self,
        conditions: &Conditions<'_>,
        joints: &[ChainJoint],
        directions: &[Vec<Vec<Action>>],
        values: &mut Vec<f64>,
        out: &mut Perturbation,
    ) {
        let nowhere = Posture::default();
        for (effect, directions) in self.acting().zip(directions) {
            if !effect.term.driver.needs_posture() {
                self.add_effect(effect, directions, conditions, &nowhere, values, out);
            }
        }
        for curve in self.earlier.iter().flat_map(|earlier| &earlier.curves).chain(&self.curves) {
            let reading = self.statics.chain.joints()[curve.joint].value(conditions.reading);
            out.twists[curve.joint] += joints[curve.joint].screw.twist() * curve.value(reading);
        }
    }

    /// Derivatives of a prediction by each coefficient in the current posture; `standing` is that of the same conditions.
    pub(super) fn sensitivities_of(
        &self,
        conditions: &Conditions<'_>,
        Standing { directions, posture, values, .. }: &mut Standing,
        state: &RowState,
        out: &mut [Sensitivity],
    ) {
        let before = self.acting().count() - self.effects.len();
        let mut first = 0;
        for (effect, directions) in self.effects.iter().zip(&directions[conditions.tip][before..]) {
            values.clear();
            effect.term.driver.values_into(&self.statics, conditions, posture, values);
            effect.term.each_action(directions, values, |coefficient, action, amount| {
                add_sensitivity(action, amount, state, &mut out[first + coefficient]);
            });
            first += effect.coefficients.len();
        }
    }

    fn add_effect(
        &self,
        effect: &Effect,
        directions: &[Vec<Action>],
        conditions: &Conditions<'_>,
        posture: &Posture,
        values: &mut Vec<f64>,
        out: &mut Perturbation,
    ) {
        values.clear();
        effect.term.driver.values_into(&self.statics, conditions, posture, values);
        effect.term.each_action(directions, values, |coefficient, action, amount| {
            action.add_to(amount * effect.coefficients[coefficient], out);
        });
    }

    /// base_from_tip of a chain of one tip (nominal or calibrated) with the effects that move the arm; m.
    ///
    /// Effects of target, anchor and instrument do not move the tip and are left out.
    ///
    /// # Panics
    /// `chain` has other joints than the model, or `conditions.reading` is too short.
    pub fn fk(&self, chain: &Chain, conditions: &Conditions<'_>) -> Pose {
        let mut perturbation = Perturbation::none(chain.joints().len());
        self.bend(conditions, chain.joints(), &mut self.standing_of(chain.joints()), &mut perturbation);
        perturbation.fk(chain, conditions.reading)
    }
}

/// Adds `amount` of an action to a sensitivity: twists are moved from home to the current posture.
pub fn add_sensitivity(action: &Action, amount: f64, state: &RowState, out: &mut Sensitivity) {
    match action {
        Action::Twist { slot, twist } => {
            let now = state.before.get(*slot).or(state.after.last());
            let twist: Vector6<f64> = now.map_or(*twist, |motion| se3::adjoint_times(motion, twist));
            out.twist += twist * amount;
        }
        Action::Target(shift) => out.target += shift * amount,
        Action::Anchor(shift) => out.anchor += shift * amount,
        Action::Scale => out.scale += amount,
        Action::Reading => out.reading += amount,
        Action::Sight(sight) => out.sight += *sight * amount,
    }
}

impl Effects for EffectModel {
    type Standing = Standing;

    fn standing(&self, arm: &Arm) -> Standing {
        self.standing_of(&arm.joints)
    }

    fn are_none(&self) -> bool {
        self.effects.is_empty() && self.curves.is_empty() && self.earlier.is_none()
    }

    fn parameters(&self) -> Vec<Parameter> {
        let mut parameters = Vec::new();
        for effect in &self.effects {
            let place = effect.term.carrier.place(&self.statics.chain);
            for index in 0..effect.coefficients.len() {
                let (name, unit, _) = effect.term.coefficient_name(&self.statics, index);
                let kind = ParameterKind::Effect { index: parameters.len() };
                let name = format!("{}({place}).{name}", effect.term.kind.name());
                parameters.push(Parameter { name, kind, unit, tolerance: None });
            }
        }
        parameters
    }

    fn perturb(&self, row: Row<'_>, arm: &Arm, standing: &mut Standing, out: &mut Perturbation) -> bool {
        if self.are_none() {
            return false;
        }
        self.bend(&Conditions::of(row), &arm.joints, standing, out);
        true
    }

    fn sensitivities(
        &self,
        row: Row<'_>,
        _arm: &Arm,
        standing: &mut Standing,
        at: Perturbed<'_>,
        out: &mut [Sensitivity],
    ) {
        self.sensitivities_of(&Conditions::of(row), standing, at.state, out);
    }

    fn bound_to(&self, data: &Measurements) -> Result<Self, MissingColumn> {
        let mut bound = self.clone();
        if let Some(earlier) = &self.earlier {
            bound.earlier = Some(Arc::new(earlier.bound_to(data)?));
        }
        for effect in &mut bound.effects {
            effect.term.driver = effect.term.driver.named_by(|column| data.column(column.name()))?;
        }
        Ok(bound)
    }

    fn numbers(&self) -> Vec<f64> {
        self.effects.iter().flat_map(|effect| effect.coefficients.iter().copied()).collect()
    }

    fn stepped(&self, step: &[f64]) -> Self {
        let mut result = self.clone();
        let coefficients = result.effects.iter_mut().flat_map(|effect| effect.coefficients.iter_mut());
        for (coefficient, delta) in coefficients.zip(step) {
            *coefficient += delta;
        }
        result
    }
}
