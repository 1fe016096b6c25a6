//! The numbers that a fit may change, and their order.

use crate::arm::{AlongSight, Arm, AxisBasis, Perturbation, Perturbed, Row};
use crate::effects_prior::EffectsPrior;
use crate::frames::Frames;
use crate::parameter::ZERO;
pub use crate::parameter::{Freedom, Known, Parameter, ParameterKind, Tolerances, is_zero};
use crate::prior::{KnownBefore, Prior};
use denavit_measurements::{KnownLength, Measurements, MissingColumn, Scene};
use denavit_model::nalgebra::{DVector, Rotation3, Vector3, Vector6};
use denavit_model::{Chain, Quantity, Screw, se3};
use std::ops::Range;

/// The free parameters of a fit in order: joint by joint, effects, instruments, points, targets.
#[derive(Debug, Clone, PartialEq)]
pub struct Layout {
    /// In order.
    pub parameters: Vec<Parameter>,
    /// Parameters of the joints.
    pub joints: Range<usize>,
    /// Parameters of the effects.
    pub effects: Range<usize>,
    /// Parameters of the targets: 3 for each observable position, then 3 for each observable orientation.
    pub targets: Range<usize>,
    /// First parameter of each setup's instrument, if observable.
    pub instruments: Vec<Option<usize>>,
    /// First parameter of each setup's plane, if only that is observable.
    pub planes: Vec<Option<usize>>,
    /// First parameter of each setup's direction of gravity, if observable.
    pub levels: Vec<Option<usize>>,
    /// First parameter of each point.
    pub points: Vec<usize>,
    /// First parameter of each target's position, if observable.
    pub places: Vec<Option<usize>>,
    /// First parameter of each target's orientation, if observable.
    pub turns: Vec<Option<usize>>,
    /// Per joint.
    pub bases: Vec<AxisBasis>,
    /// The unobservable frames.
    pub frames: Frames,
    /// The prior of the joints' parameters.
    pub prior: Prior,
    /// An earlier calibration's prior of effects, given those.
    pub effects_prior: Option<EffectsPrior>,
}

const AXES: [&str; 3] = ["x", "y", "z"];

/// The name of a direction: a base axis if it is one, else the given letter.
fn direction_name(direction: &Vector3<f64>, otherwise: &'static str) -> &'static str {
    (0..3).find(|&i| direction[i].abs() > 1.0 - 1e-9).map_or(otherwise, |i| AXES[i])
}

impl Layout {
    /// The layout for a chain and what is observed of it.
    pub fn new(
        chain: &Chain,
        scene: &Scene,
        freedom: &Freedom,
        tolerances: &Tolerances,
        effects: Vec<Parameter>,
    ) -> Self {
        let bases: Vec<AxisBasis> = chain.joints().iter().map(|joint| AxisBasis::of(&joint.screw)).collect();
        let mut parameters = Vec::new();
        for (index, joint) in chain.joints().iter().enumerate() {
            joint_parameters(&mut parameters, index, &joint.name, &joint.screw, &bases[index], freedom, tolerances);
            let leads = chain.joints()[..index].iter().all(|other| other.coordinate != joint.coordinate);
            if freedom.zeros[index] && leads && joint.scale != 0.0 {
                let (unit, tolerance) = match chain.coordinates()[joint.coordinate].quantity {
                    Quantity::Angle => ("rad", tolerances.zero_turn),
                    Quantity::Length => ("m", tolerances.zero_slide),
                };
                let (name, kind) = (format!("{}{ZERO}", joint.name), ParameterKind::Zero { joint: index });
                parameters.push(Parameter { name, kind, unit, tolerance: Some(tolerance) });
            }
        }
        let joints = 0..parameters.len();
        let frames = Frames::of(chain, scene);
        let prior = Prior::of_drawing(chain, &parameters, &bases, &frames, tolerances);
        let mut layout = Self {
            parameters,
            effects: joints.end..joints.end,
            targets: 0..0,
            joints,
            instruments: Vec::new(),
            planes: Vec::new(),
            levels: Vec::new(),
            points: Vec::new(),
            places: Vec::new(),
            turns: Vec::new(),
            bases,
            frames,
            prior,
            effects_prior: None,
        };
        layout.surroundings(scene);
        layout.with_effects(effects)
    }

    /// Appends the unknowns other than the arm's.
    fn surroundings(&mut self, scene: &Scene) {
        let mut free = |name: String, kind: ParameterKind, unit: &'static str| {
            self.parameters.push(Parameter { name, kind, unit, tolerance: None });
            self.parameters.len() - 1
        };
        for (setup, name) in scene.setups.iter().enumerate() {
            let mut add = |component: usize| {
                let (word, unit) = if component < 3 { ("turn_", "rad") } else { ("", "m") };
                let space = if name.is_empty() { "" } else { " " };
                let name = format!("instrument{space}{name}.{word}{}", AXES[component % 3]);
                free(name, ParameterKind::Instrument { setup, component }, unit)
            };
            let first = scene.has_instrument(setup).then(|| add(0));
            if first.is_some() {
                (1..6).for_each(|component| _ = add(component));
            }
            self.instruments.push(first);
        }
        for (setup, name) in scene.setups.iter().enumerate() {
            let mut add = |component: usize| {
                let (word, unit) = [("turn_x", "rad"), ("turn_y", "rad"), ("z", "m")][component];
                free(format!("{name}.{word}"), ParameterKind::Plane { setup, component }, unit)
            };
            let first = scene.has_plane(setup).then(|| add(0));
            if first.is_some() {
                (1..3).for_each(|component| _ = add(component));
            }
            self.planes.push(first);
        }
        for (setup, name) in scene.setups.iter().enumerate() {
            let mut add = |component: usize| {
                let name = format!("{name}.turn_{}", AXES[component]);
                free(name, ParameterKind::Plane { setup, component }, "rad")
            };
            let first = scene.has_level(setup).then(|| add(0));
            if first.is_some() {
                add(1);
            }
            self.levels.push(first);
        }
        for (point, name) in scene.points.iter().enumerate() {
            let mut add = |component: usize| {
                free(format!("{name}.{}", AXES[component]), ParameterKind::Point { point, component }, "m")
            };
            self.points.push(add(0));
            (1..3).for_each(|component| _ = add(component));
        }
        let [instruments, planes, levels] =
            [&self.instruments, &self.planes, &self.levels].map(|all| all.iter().flatten().count());
        let start = self.joints.end + 6 * instruments + 3 * (planes + self.points.len()) + 2 * levels;
        // Numbers follow the word directly, names after a blank.
        let called = |name: &str| {
            let space = if name.starts_with(|c: char| c.is_alphabetic()) { " " } else { "" };
            format!("target{space}{name}")
        };
        for (target, name) in scene.targets.iter().enumerate() {
            let name = called(name);
            let mut add = |component: usize| {
                free(format!("{name}.{}", AXES[component]), ParameterKind::Target { target, component }, "m")
            };
            let first = scene.places(target).then(|| add(0));
            if first.is_some() {
                (1..3).for_each(|component| _ = add(component));
            }
            self.places.push(first);
        }
        for (target, name) in scene.targets.iter().enumerate() {
            let mut add = |component: usize| {
                let name = format!("{}.turn_{}", called(name), AXES[component]);
                free(name, ParameterKind::TargetTurn { target, component }, "rad")
            };
            let first = scene.turns(target).then(|| add(0));
            if first.is_some() {
                (1..3).for_each(|component| _ = add(component));
            }
            self.turns.push(first);
        }
        self.targets = start..self.parameters.len();
    }

    /// The conditions of known distances between points, and that a tool's frame is that of the first tip that holds it.
    pub fn known_lengths(&self, scene: &Scene, arm: &Arm) -> Vec<Known> {
        let of = |known: &KnownLength| {
            let [a, b] = known.points;
            let apart = arm.points[b] - arm.points[a];
            let length = apart.norm();
            let along = if length > 0.0 { apart / length } else { Vector3::zeros() };
            let column =
                |point: usize, sign: f64| (0..3).map(move |k| (self.points[point] + k, sign * along[k] / known.std));
            let columns = column(a, 1.0).chain(column(b, -1.0)).collect();
            Known { residual: (known.length - length) / known.std, columns }
        };
        let lengths = scene.lengths.iter().map(of);
        // A change of the tool's frame changes no prediction: any standard deviation will do.
        let frame = |target: usize| {
            let pose = &arm.targets[target];
            let of = |first: Option<usize>, value: Vector3<f64>| {
                let first = first.into_iter().flat_map(|first| first..first + 3);
                let known = |(column, value): (usize, f64)| Known { residual: -value, columns: vec![(column, -1.0)] };
                first.zip(<[f64; 3]>::from(value)).map(known).collect::<Vec<_>>()
            };
            let turn = se3::rotation_vector(&pose.rotation);
            of(self.places[target], pose.translation.vector).into_iter().chain(of(self.turns[target], turn))
        };
        lengths.chain(scene.tool_frames().into_iter().flat_map(frame)).collect()
    }

    /// Prior knowledge of points and of effects. `numbers`: those of the effects.
    pub fn known(&self, scene: &Scene, arm: &Arm, numbers: &[f64]) -> Vec<Known> {
        let mut known = self.known_lengths(scene, arm);
        if let Some(prior) = &self.effects_prior {
            let difference = self.perturbation(arm, arm) + &self.prior.mean;
            known.extend(prior.known(&difference, numbers, self.effects.start));
        }
        known
    }

    /// The layout with other effects, without a prior.
    #[must_use]
    pub fn with_effects(&self, effects: Vec<Parameter>) -> Self {
        let (old, count) = (self.effects.len(), effects.len());
        let shift = |column: usize| column + count - old;
        let joints = self.parameters[self.joints.clone()].iter().cloned();
        let rest = self.parameters[self.effects.end..].iter().cloned();
        Self {
            parameters: joints.chain(effects).chain(rest).collect(),
            joints: self.joints.clone(),
            effects: self.joints.end..self.joints.end + count,
            targets: shift(self.targets.start)..shift(self.targets.end),
            instruments: self.instruments.iter().map(|column| column.map(shift)).collect(),
            planes: self.planes.iter().map(|column| column.map(shift)).collect(),
            levels: self.levels.iter().map(|column| column.map(shift)).collect(),
            points: self.points.iter().copied().map(shift).collect(),
            places: self.places.iter().map(|column| column.map(shift)).collect(),
            turns: self.turns.iter().map(|column| column.map(shift)).collect(),
            bases: self.bases.clone(),
            frames: self.frames.clone(),
            prior: self.prior.clone(),
            effects_prior: None,
        }
    }

    /// Whether an axis may turn or move: only then can instruments and targets absorb a common motion of all axes.
    pub fn axes_are_free(&self) -> bool {
        let of_axis = |kind| matches!(kind, ParameterKind::Turn { .. } | ParameterKind::Move { .. });
        self.parameters[self.joints.clone()].iter().any(|parameter| of_axis(parameter.kind))
    }

    /// Number of parameters.
    pub fn len(&self) -> usize {
        self.parameters.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.parameters.is_empty()
    }

    /// The arm after a step (one number per parameter; those of effects are ignored).
    #[must_use]
    pub fn stepped(&self, arm: &Arm, step: &[f64]) -> Arm {
        let mut result = arm.clone();
        let joints = arm.joints.len();
        let (mut turned, mut moved, mut pitch) = (vec![[0.0; 2]; joints], vec![[0.0; 2]; joints], vec![0.0; joints]);
        let mut instruments = vec![Vector6::zeros(); arm.instruments.len()];
        let mut planes = vec![Vector6::zeros(); arm.instruments.len()];
        let mut turns = vec![Vector3::zeros(); arm.targets.len()];
        for (parameter, &delta) in self.parameters.iter().zip(step) {
            match parameter.kind {
                ParameterKind::Turn { joint, direction } => turned[joint][direction] = delta,
                ParameterKind::Move { joint, direction } => moved[joint][direction] = delta,
                ParameterKind::Pitch { joint } => pitch[joint] = delta,
                ParameterKind::Scale { joint } => {
                    result.joints[joint].scale += delta * arm.nominal.joints()[joint].scale;
                }
                ParameterKind::Zero { joint } => result.shift_zero(joint, delta),
                ParameterKind::Effect { .. } => {}
                ParameterKind::Instrument { setup, component } => instruments[setup][component] = delta,
                ParameterKind::Plane { setup, component } => planes[setup][[0, 1, 5][component]] = delta,
                ParameterKind::Point { point, component } => result.points[point][component] += delta,
                ParameterKind::Target { target, component } => {
                    result.targets[target].translation.vector[component] += delta;
                }
                ParameterKind::TargetTurn { target, component } => turns[target][component] = delta,
            }
        }
        for (joint, nominal) in arm.nominal.joints().iter().enumerate() {
            if turned[joint] != [0.0; 2] || moved[joint] != [0.0; 2] || pitch[joint] != 0.0 {
                let basis = self.bases[joint].carried(&nominal.screw, &arm.joints[joint].screw);
                result.change_axis(joint, &basis, turned[joint], moved[joint], pitch[joint]);
            }
        }
        for (instrument, step) in result.instruments.iter_mut().zip(&instruments) {
            if *step != Vector6::zeros() {
                let moved = *instrument * se3::exp(step);
                *instrument = se3::pose(se3::orthonormalised(&moved.rotation), moved.translation.vector);
            }
        }
        for (plane, step) in result.instruments.iter_mut().zip(&planes) {
            if *step != Vector6::zeros() {
                let moved = se3::exp(step) * *plane;
                *plane = se3::pose(se3::orthonormalised(&moved.rotation), moved.translation.vector);
            }
        }
        for (target, step) in result.targets.iter_mut().zip(&turns) {
            if *step != Vector3::zeros() {
                let rotation = Rotation3::from_scaled_axis(*step) * target.rotation;
                target.rotation = se3::orthonormalised(&rotation);
            }
        }
        result
    }

    /// The same layout where some of the joints' parameters were identified before.
    #[must_use]
    pub fn knowing(mut self, before: &KnownBefore) -> Self {
        let joints = &self.parameters[self.joints.clone()];
        self.prior = self.prior.knowing(joints, &self.bases, &self.frames, before);
        self
    }

    /// The prior's cost of an arm: δᵀ P δ of the axes' deviation from the prior mean; see [`Layout::difference`].
    pub fn prior_cost(&self, arm: &Arm, reference: &Arm) -> f64 {
        let perturbation = self.perturbation(arm, reference);
        perturbation.dot(&(&self.prior.precision * &perturbation))
    }

    /// δ: deviation of the joints' parameters from the prior mean; see [`Layout::difference`].
    pub fn perturbation(&self, arm: &Arm, reference: &Arm) -> DVector<f64> {
        let difference = self.difference(arm, reference);
        DVector::from_row_slice(&difference[self.joints.clone()]) - &self.prior.mean
    }

    /// Deviation of the arm from a reference, per parameter: joints from nominal, targets from `reference`; 0 for the
    /// instruments, the points and effects.
    pub fn difference(&self, arm: &Arm, reference: &Arm) -> Vec<f64> {
        let changes: Vec<_> = (0..arm.joints.len()).map(|joint| arm.change(joint)).collect();
        let turn = |target: usize| {
            se3::rotation_vector(&(arm.targets[target].rotation * reference.targets[target].rotation.inverse()))
        };
        let turns: Vec<Vector3<f64>> = (0..self.turns.len())
            .map(|target| self.turns[target].map_or_else(Vector3::zeros, |_| turn(target)))
            .collect();
        let of = |parameter: &Parameter| match parameter.kind {
            ParameterKind::Turn { joint, direction } => changes[joint].turned[direction],
            ParameterKind::Move { joint, direction } => changes[joint].moved[direction],
            ParameterKind::Pitch { joint } => changes[joint].pitch,
            ParameterKind::Scale { joint } => changes[joint].scale,
            ParameterKind::Zero { joint } => changes[joint].zero,
            ParameterKind::Target { target, component } => {
                (arm.targets[target].translation.vector - reference.targets[target].translation.vector)[component]
            }
            ParameterKind::TargetTurn { target, component } => turns[target][component],
            ParameterKind::Effect { .. }
            | ParameterKind::Instrument { .. }
            | ParameterKind::Plane { .. }
            | ParameterKind::Point { .. } => 0.0,
        };
        self.parameters.iter().map(of).collect()
    }
}

fn joint_parameters(
    parameters: &mut Vec<Parameter>,
    joint: usize,
    name: &str,
    screw: &Screw,
    basis: &AxisBasis,
    freedom: &Freedom,
    tolerances: &Tolerances,
) {
    let mut add = |word: &str, kind: ParameterKind, unit: &'static str, tolerance: f64| {
        parameters.push(Parameter { name: format!("{name}.{word}"), kind, unit, tolerance: Some(tolerance) });
    };
    let names = [direction_name(&basis.a, "a"), direction_name(&basis.b, "b")];
    let slides = matches!(screw, Screw::Prismatic(_));
    if freedom.axes[joint] {
        for (direction, name) in names.iter().enumerate() {
            add(&format!("turn_{name}"), ParameterKind::Turn { joint, direction }, "rad", tolerances.turn);
        }
        if !slides {
            for (direction, name) in names.iter().enumerate() {
                add(&format!("move_{name}"), ParameterKind::Move { joint, direction }, "m", tolerances.shift);
            }
        }
    }
    let helical = matches!(screw, Screw::Helical { .. });
    if (helical && freedom.axes[joint]) || (!slides && freedom.pitches[joint]) {
        add("pitch", ParameterKind::Pitch { joint }, "m/rad", tolerances.pitch);
    }
    if freedom.scales[joint] {
        add("scale", ParameterKind::Scale { joint }, "1", tolerances.scale);
    }
}

/// Derivative of a prediction by an effect's parameter, in one row.
#[derive(Debug, Clone, PartialEq)]
pub struct Sensitivity {
    /// Twist `[omega; v]` of the tip in the base frame, in the current posture: Ad(before\[i\]) · carrier at home.
    pub twist: Vector6<f64>,
    /// Shift of the targets, tip frame, m.
    pub target: Vector3<f64>,
    /// Shift of the anchor, base frame, m.
    pub anchor: Vector3<f64>,
    /// Change of the instrument's relative scale.
    pub scale: f64,
    /// Change of the distance read, m.
    pub reading: f64,
    /// Change of the excess of the range along the line of sight.
    pub sight: AlongSight,
}

impl Default for Sensitivity {
    fn default() -> Self {
        Self {
            twist: Vector6::zeros(),
            target: Vector3::zeros(),
            anchor: Vector3::zeros(),
            scale: 0.0,
            reading: 0.0,
            sight: AlongSight::default(),
        }
    }
}

/// Effects beyond geometry, as a fit sees them: perturbations per row and their derivatives by free numbers.
pub trait Effects: Clone + Sync {
    /// Their state of an arm, the same for all rows, and buffers for one row.
    type Standing;

    /// The state of this arm; make a new one when the arm or the effects have changed.
    fn standing(&self, arm: &Arm) -> Self::Standing;

    /// The free numbers, each of kind [`ParameterKind::Effect`].
    fn parameters(&self) -> Vec<Parameter>;

    /// Whether there is nothing beyond geometry: rows can then be computed several at a time.
    fn are_none(&self) -> bool {
        false
    }

    /// Writes the effects' perturbation of this arm in a row to `out`, which must be all zero; `false` if there is none.
    fn perturb(&self, row: Row<'_>, arm: &Arm, standing: &mut Self::Standing, out: &mut Perturbation) -> bool;

    /// Writes the derivatives of the prediction by each parameter, in the perturbed posture, to `out`, which must be all zero; `standing` is
    /// that of the same row.
    fn sensitivities(
        &self,
        row: Row<'_>,
        arm: &Arm,
        standing: &mut Self::Standing,
        at: Perturbed<'_>,
        out: &mut [Sensitivity],
    );

    /// The effects bound to the columns of these rows; needed for rows other than those (or a part of those) that the effects
    /// were made with.
    ///
    /// # Errors
    /// An effect depends on a column that these rows lack.
    fn bound_to(&self, _data: &Measurements) -> Result<Self, MissingColumn> {
        Ok(self.clone())
    }

    /// The values of the free numbers, in their order.
    fn numbers(&self) -> Vec<f64> {
        Vec::new()
    }

    /// The effects after a step, one number per parameter.
    #[must_use]
    fn stepped(&self, step: &[f64]) -> Self;
}

/// Geometry alone.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct NoEffects;

impl Effects for NoEffects {
    type Standing = ();

    fn standing(&self, _arm: &Arm) {}

    fn are_none(&self) -> bool {
        true
    }

    fn parameters(&self) -> Vec<Parameter> {
        Vec::new()
    }

    fn perturb(&self, _row: Row<'_>, _arm: &Arm, _standing: &mut (), _out: &mut Perturbation) -> bool {
        false
    }

    fn sensitivities(&self, _: Row<'_>, _: &Arm, (): &mut (), _: Perturbed<'_>, _: &mut [Sensitivity]) {}

    fn stepped(&self, _step: &[f64]) -> Self {
        *self
    }
}
