//! Residuals of one row and their derivatives with respect to every parameter, in closed form.

use crate::arm::{Arm, AxisBasis, Perturbation, Perturbed, Row, RowState};
use crate::observe::{Discrepancy, Follows, Rows, Seen, model_of};
use crate::parameters::{Effects, Layout, ParameterKind, Sensitivity};
use crate::simd_residuals::Geometry;
use crate::simd_residuals::square_factor;
use denavit_measurements::Measurements;
use denavit_measurements::kinds::Frame;
use denavit_model::nalgebra::{Matrix3, Vector3, Vector6};
use denavit_model::{Pose, se3};

/// Rotation of a joint by effects, rad, above which it turns with the joint's axis in the derivatives: a joint that counts from the ground.
/// Smaller rotations change no step of a fit.
const FAR: f64 = 0.01;

/// Measured data, parameters and effects, from which residuals are computed.
#[derive(Debug, Clone, Copy)]
pub struct ResidualModel<'a, E> {
    /// What was measured.
    pub data: &'a Measurements,
    /// Which numbers are free.
    pub layout: &'a Layout,
    /// The effects beyond geometry.
    pub effects: &'a E,
}

/// Buffers for one row's computation: made once, used for many rows.
#[derive(Debug, Clone)]
pub struct Scratch<S = ()> {
    standing: S,
    state: RowState,
    perturbation: Perturbation,
    sensitivities: Vec<Sensitivity>,
    twists: Twists,
    bases: Vec<AxisBasis>,
    axes: Vec<AxisNow>,
}

/// Twists `[omega; v]` of the tip in the base frame, one per joint and effect parameter: six numbers, each of them for
/// all parameters in a row, so that a loop over parameters runs in vectors.
#[derive(Debug, Clone, Default)]
struct Twists([Vec<f64>; 6]);

impl Twists {
    fn zeros(count: usize) -> Self {
        Self(std::array::from_fn(|_| vec![0.0; count]))
    }

    fn set(&mut self, column: usize, omega: &Vector3<f64>, v: &Vector3<f64>) {
        for k in 0..3 {
            self.0[k][column] = omega[k];
            self.0[3 + k][column] = v[k];
        }
    }

    /// Minus the velocity of a point (base frame, m), parameter by parameter: three rows of `columns` cells.
    fn less_velocities(&self, point: &Vector3<f64>, columns: usize, jacobian: &mut [f64]) {
        let count = self.0[0].len();
        let [wx, wy, wz, vx, vy, vz] = self.0.each_ref().map(|numbers| &numbers[..count]);
        let (x, rest) = jacobian.split_at_mut(columns);
        let (y, z) = rest.split_at_mut(columns);
        let (x, y, z) = (&mut x[..count], &mut y[..count], &mut z[..count]);
        for k in 0..count {
            x[k] = wz[k] * point.y - wy[k] * point.z - vx[k];
            y[k] = wx[k] * point.z - wz[k] * point.x - vy[k];
            z[k] = wy[k] * point.x - wx[k] * point.y - vz[k];
        }
    }

    /// Minus the velocity of a point along a line, parameter by parameter.
    fn less_along(&self, point: &Vector3<f64>, line: &Vector3<f64>, jacobian: &mut [f64]) {
        // line · (omega × p + v) = (p × line) · omega + line · v.
        let moment = point.cross(line);
        let direction = [moment.x, moment.y, moment.z, line.x, line.y, line.z];
        let count = self.0[0].len();
        for (column, cell) in jacobian[..count].iter_mut().enumerate() {
            *cell = -self.0.iter().zip(direction).map(|(numbers, d)| numbers[column] * d).sum::<f64>();
        }
    }

    /// Minus the angular velocity about a line, parameter by parameter.
    fn less_about(&self, line: &Vector3<f64>, jacobian: &mut [f64]) {
        let count = self.0[0].len();
        for (column, cell) in jacobian[..count].iter_mut().enumerate() {
            *cell = -self.0.iter().zip(line.iter()).map(|(numbers, d)| numbers[column] * d).sum::<f64>();
        }
    }

    /// Minus the angular velocities, multiplied by `matrix`: three rows of `columns` cells.
    fn less_turns(&self, matrix: &Matrix3<f64>, columns: usize, jacobian: &mut [f64]) {
        let count = self.0[0].len();
        let (wx, wy, wz) = (&self.0[0][..count], &self.0[1][..count], &self.0[2][..count]);
        for (row, line) in jacobian.chunks_exact_mut(columns).take(3).enumerate() {
            let (a, b, c) = (matrix[(row, 0)], matrix[(row, 1)], matrix[(row, 2)]);
            let line = &mut line[..count];
            for k in 0..count {
                line[k] = -(a * wx[k] + b * wy[k] + c * wz[k]);
            }
        }
    }
}

impl Scratch {
    /// For this layout and the axes of this arm, without effects; make a new one when the arm has changed.
    pub fn new(layout: &Layout, arm: &Arm) -> Self {
        Self::with((), layout, arm)
    }
}

impl<S> Scratch<S> {
    fn with(standing: S, layout: &Layout, arm: &Arm) -> Self {
        let nominal = arm.nominal.joints();
        let carry = |(index, joint): (usize, &denavit_model::ChainJoint)| {
            layout.bases[index].carried(&nominal[index].screw, &joint.screw)
        };
        Self {
            standing,
            state: RowState::default(),
            perturbation: Perturbation::none(arm.joints.len()),
            sensitivities: vec![Sensitivity::default(); layout.effects.len()],
            twists: Twists::zeros(layout.effects.end),
            bases: arm.joints.iter().enumerate().map(carry).collect(),
            axes: vec![AxisNow::default(); arm.joints.len()],
        }
    }

    /// The arm as the SIMD residuals need it, where there are no effects.
    pub(crate) fn geometry(&self, arm: &Arm, data: &Measurements) -> Option<Geometry> {
        Geometry::of(arm, &self.bases, data)
    }

    /// The arm's state in the last row.
    pub fn state(&self) -> &RowState {
        &self.state
    }
}

/// A change of a joint's axis in one row: the part before the joint's motion minus the part after it.
#[derive(Debug, Clone, Copy, Default)]
struct AxisNow {
    /// Directions across the axis before the joint's motion minus those after it.
    directions: [Vector3<f64>; 2],
    after: [Vector3<f64>; 2],
    /// Centre before the motion, and its displacement back by the motion, m.
    centre: Vector3<f64>,
    back: Vector3<f64>,
}

impl AxisNow {
    #[inline]
    fn of(before: &Pose, after: &Pose, basis: &AxisBasis) -> Self {
        let now = [after.rotation * basis.a, after.rotation * basis.b];
        let directions = [before.rotation * basis.a - now[0], before.rotation * basis.b - now[1]];
        let centre = (before * basis.centre).coords;
        Self { directions, after: now, centre, back: centre - (after * basis.centre).coords }
    }

    /// Twist per unit of a rotation about direction `across`: c × w before the motion minus the same after it.
    #[inline]
    fn turned(&self, direction: usize) -> (Vector3<f64>, Vector3<f64>) {
        let w = self.directions[direction];
        (w, self.centre.cross(&w) + self.back.cross(&self.after[direction]))
    }
}

fn omega(twist: &Vector6<f64>) -> Vector3<f64> {
    Vector3::new(twist[0], twist[1], twist[2])
}

fn velocity(twist: &Vector6<f64>, point: &Vector3<f64>) -> Vector3<f64> {
    omega(twist).cross(point) + Vector3::new(twist[3], twist[4], twist[5])
}

fn put(jacobian: &mut [f64], columns: usize, column: usize, value: &Vector3<f64>) {
    jacobian[column] = value.x;
    jacobian[columns + column] = value.y;
    jacobian[2 * columns + column] = value.z;
}

/// Inverse left Jacobian of SO(3) at rotation vector `r`; the right one is its transpose.
fn inverse_left_jacobian(r: &Vector3<f64>) -> Matrix3<f64> {
    let w = se3::skew(r);
    Matrix3::identity() - w * 0.5 + w * w * square_factor(r.norm_squared())
}

impl<E: Effects> ResidualModel<'_, E> {
    /// Buffers for the rows of this arm; make new ones when the arm has changed.
    pub fn scratch(&self, arm: &Arm) -> Scratch<E::Standing> {
        Scratch::with(self.effects.standing(arm), self.layout, arm)
    }

    /// Residuals (measured minus predicted) of one row and their derivatives, with the standard deviation of their noise channel.
    ///
    /// The kind of each observation defines its residual (see [`denavit_measurements::kinds`]). A joint's axis enters as
    /// dT T⁻¹ = Ad(A) b - Ad(A e^\[S\]v) b for each basis twist b at home, A the motion of the joint's carrier.
    /// Where the data give a standard deviation for each value, residual and derivatives are scaled so that all values of a channel
    /// have one standard deviation.
    ///
    /// # Shape and units
    /// `residual`: the values of the row's observations one after another, at least [`ResidualModel::height_of`];
    /// `jacobian`: as many rows, row by row, of one column per parameter.
    pub fn row_into(
        &self,
        arm: &Arm,
        row: usize,
        scratch: &mut Scratch<E::Standing>,
        residual: &mut [f64],
        mut jacobian: Option<&mut [f64]>,
    ) {
        let at = Row::new(self.data, row);
        self.stand(arm, row, scratch);
        if jacobian.is_some() {
            self.twists(arm, at, scratch);
        }
        let (columns, mut first) = (self.layout.len(), 0);
        for observation in self.data.of_row(row) {
            let height = self.data.series_of(observation).kind.height();
            let lines = first..first + height;
            let r = &mut residual[lines.clone()];
            let j = jacobian.as_deref_mut().map(|all| &mut all[lines.start * columns..lines.end * columns]);
            self.observation(arm, observation, scratch, r, j);
            first += height;
        }
    }

    /// Number of residual values of a row.
    pub fn height_of(&self, row: usize) -> usize {
        self.data.of_row(row).map(|observation| self.data.series_of(observation).kind.height()).sum()
    }

    /// Computes the arm's state in a row, into the scratch.
    pub fn stand(&self, arm: &Arm, row: usize, scratch: &mut Scratch<E::Standing>) {
        let at = Row::new(self.data, row);
        scratch.perturbation.clear();
        let perturbed = self.effects.perturb(at, arm, &mut scratch.standing, &mut scratch.perturbation);
        arm.state_into(
            at.reading(),
            self.data.tip_of(row),
            perturbed.then_some(&scratch.perturbation),
            &mut scratch.state,
        );
    }

    /// An observation of the scratch's current row.
    pub(crate) fn seen<'s>(&'s self, arm: &'s Arm, observation: usize, scratch: &'s Scratch<E::Standing>) -> Seen<'s> {
        let (series, values) = (self.data.series_of(observation), self.data.observed.values(observation));
        let weighed = self.data.observed.level(observation).is_some();
        Seen::new(arm, &scratch.state.tip, &scratch.perturbation, series, values, weighed)
    }

    /// Twist of the tip per unit of each joint and effect parameter.
    fn twists(&self, arm: &Arm, at: Row<'_>, scratch: &mut Scratch<E::Standing>) {
        let Scratch { standing, state, perturbation, sensitivities, twists, bases, axes } = scratch;
        let on_the_way = &arm.tips[self.data.tip_of(at.index())].joints;
        if !self.layout.joints.is_empty() {
            let places = state.before.iter().zip(&state.after).zip(&perturbation.twists);
            for (axis, (((before, after), by), basis)) in axes.iter_mut().zip(places.zip(bases.iter())) {
                *axis = if omega(by).norm() < FAR {
                    AxisNow::of(before, after, basis)
                } else {
                    AxisNow::of(&(before * se3::exp(&-by)), after, basis)
                };
            }
        }
        for (column, parameter) in self.layout.parameters[self.layout.joints.clone()].iter().enumerate() {
            let Some(joint) = parameter.kind.joint() else { continue };
            if let ParameterKind::Zero { .. } = parameter.kind {
                let mut twist = Vector6::zeros();
                let nominal = arm.nominal.joints().iter().zip(&arm.joints).zip(&state.before);
                for (other, ((nominal, moving), before)) in nominal.enumerate() {
                    if on_the_way[other] && moving.coordinate == arm.joints[joint].coordinate {
                        twist += se3::adjoint_times(before, &moving.screw.twist()) * nominal.scale;
                    }
                }
                twists.set(column, &omega(&twist), &Vector3::new(twist[3], twist[4], twist[5]));
                continue;
            }
            if !on_the_way[joint] {
                twists.set(column, &Vector3::zeros(), &Vector3::zeros());
                continue;
            }
            let (before, axis) = (&state.before[joint], &axes[joint]);
            let (w, v) = match parameter.kind {
                ParameterKind::Turn { direction, .. } => axis.turned(direction),
                ParameterKind::Move { direction, .. } => (Vector3::zeros(), axis.directions[direction]),
                ParameterKind::Pitch { .. } => {
                    let u = arm.joints[joint].screw.direction().into_inner();
                    (Vector3::zeros(), before.rotation * u * arm.joints[joint].value(at.reading()))
                }
                _ => {
                    let moving = &arm.joints[joint];
                    let rate = arm.nominal.joints()[joint].scale * at.reading()[moving.coordinate];
                    let twist = se3::adjoint_times(before, &moving.screw.twist()) * rate;
                    (omega(&twist), Vector3::new(twist[3], twist[4], twist[5]))
                }
            };
            twists.set(column, &w, &v);
        }
        if !sensitivities.is_empty() {
            sensitivities.fill(Sensitivity::default());
            self.effects.sensitivities(at, arm, standing, Perturbed { state, by: perturbation }, sensitivities);
            for (column, sensitivity) in self.layout.effects.clone().zip(sensitivities.iter()) {
                let twist = &sensitivity.twist;
                twists.set(column, &omega(twist), &Vector3::new(twist[3], twist[4], twist[5]));
            }
        }
    }

    fn observation(
        &self,
        arm: &Arm,
        observation: usize,
        scratch: &Scratch<E::Standing>,
        residual: &mut [f64],
        mut jacobian: Option<&mut [f64]>,
    ) {
        let seen = self.seen(arm, observation, scratch);
        let kind = seen.series.kind;
        let height = kind.place().height;
        let found = model_of(kind).discrepancy(&seen);
        residual[..height].copy_from_slice(&found.place.as_slice()[..height]);
        if kind.turn().is_some() {
            residual[height..].copy_from_slice(found.turn.as_slice());
        }
        if let Some(jacobian) = jacobian.as_deref_mut() {
            self.derivatives(&seen, &found, scratch, jacobian);
        }
        if let Some(level) = self.data.observed.level(observation) {
            let axes = if kind.unknowns().frame == Frame::Instrument && height == 3 {
                *seen.instrument().rotation.matrix()
            } else {
                Matrix3::identity()
            };
            let lines = height * self.layout.len();
            levelled(&(level * axes), &mut residual[..height], jacobian.map(|jacobian| &mut jacobian[..lines]));
        }
    }

    fn derivatives(&self, seen: &Seen<'_>, found: &Discrepancy, scratch: &Scratch<E::Standing>, jacobian: &mut [f64]) {
        let (layout, columns) = (self.layout, self.layout.len());
        let (kind, tip, p) = (seen.series.kind, seen.tip.rotation, &seen.predicted);
        let first = layout.places[seen.series.target];
        let follows = model_of(kind).follows(seen);
        match follows {
            Follows::Whole => scratch.twists.less_velocities(p, columns, jacobian),
            Follows::Line(line) => scratch.twists.less_along(p, &line, jacobian),
            Follows::Lines { point, lines } => {
                for (line, cells) in lines.iter().zip(jacobian.chunks_exact_mut(columns)) {
                    scratch.twists.less_along(&point, line, cells);
                }
            }
            Follows::Turns(lines) => {
                for (line, cells) in lines.iter().zip(jacobian.chunks_exact_mut(columns)) {
                    scratch.twists.less_about(line, cells);
                }
            }
        }
        for (k, effect) in scratch.sensitivities.iter().enumerate() {
            let column = layout.effects.start + k;
            let by_effect = model_of(kind).by_effect(seen, effect);
            let moved = velocity(&effect.twist, p) + tip * effect.target;
            match follows {
                Follows::Whole => put(jacobian, columns, column, &(by_effect - moved)),
                Follows::Line(line) => jacobian[column] = by_effect.x - line.dot(&moved),
                Follows::Lines { point, lines } => {
                    let moved = velocity(&effect.twist, &point) + tip * effect.target;
                    for (row, line) in lines.iter().enumerate() {
                        jacobian[row * columns + column] = by_effect[row] - line.dot(&moved);
                    }
                }
                Follows::Turns(lines) => {
                    for (row, line) in lines.iter().enumerate() {
                        jacobian[row * columns + column] = by_effect[row] - line.dot(&omega(&effect.twist));
                    }
                }
            }
        }
        let height = kind.place().height;
        for line in jacobian.chunks_exact_mut(columns) {
            line[layout.effects.end..].fill(0.0);
        }
        let mut rows = Rows { cells: jacobian, columns };
        let on_tip = |line: &Vector3<f64>| -(tip.inverse() * line);
        match (follows, first) {
            (Follows::Turns(lines), _) => {
                for (row, line) in lines.iter().enumerate() {
                    if let Some(first) = layout.turns[seen.series.target] {
                        rows.put(row, first, on_tip(line).as_slice());
                    }
                }
            }
            (_, None) => {}
            (Follows::Whole, Some(first)) => {
                for row in 0..3 {
                    rows.put(row, first, &[-tip[(row, 0)], -tip[(row, 1)], -tip[(row, 2)]]);
                }
            }
            (Follows::Line(line), Some(first)) => rows.put(0, first, on_tip(&line).as_slice()),
            (Follows::Lines { lines, .. }, Some(first)) => {
                for (row, line) in lines.iter().enumerate() {
                    rows.put(row, first, on_tip(line).as_slice());
                }
            }
        }
        let left = if kind.turn().is_some() { inverse_left_jacobian(&found.turn) } else { Matrix3::identity() };
        if kind.turn().is_some() {
            let right = left.transpose();
            scratch.twists.less_turns(&right, columns, &mut rows.cells[height * columns..]);
            let turned = right * tip.matrix();
            if let Some(first) = layout.turns[seen.series.target] {
                for row in 0..3 {
                    rows.put(height + row, first, &[-turned[(row, 0)], -turned[(row, 1)], -turned[(row, 2)]]);
                }
            }
        }
        model_of(kind).own_columns(seen, layout, &left, &mut rows);
    }
}

/// Rows of one value or three, multiplied by a matrix.
fn levelled(by: &Matrix3<f64>, residual: &mut [f64], jacobian: Option<&mut [f64]>) {
    let height = residual.len();
    let columns = jacobian.as_ref().map_or(0, |jacobian| jacobian.len() / height);
    let multiplied = |values: [f64; 3]| by * Vector3::from(values);
    let get = |cells: &[f64], stride: usize, at: usize| {
        std::array::from_fn(|row| if row < height { cells[row * stride + at] } else { 0.0 })
    };
    let new = multiplied(get(residual, 1, 0));
    residual.copy_from_slice(&new.as_slice()[..height]);
    let Some(jacobian) = jacobian else { return };
    for column in 0..columns {
        let new = multiplied(get(jacobian, columns, column));
        for row in 0..height {
            jacobian[row * columns + column] = new[row];
        }
    }
}
