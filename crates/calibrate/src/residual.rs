//! Residuals of one row and their derivatives with respect to every parameter, in closed form.

use crate::arm::{Across, Arm, Deviation, Row, RowState};
use crate::lanes::Geometry;
use crate::measurements::{MeasurementKind, Measurements};
use crate::parameters::{Effects, Layout, ParameterKind, Sensitivity};
use denavit_model::nalgebra::{Matrix3, Rotation3, Vector3, Vector6};
use denavit_model::{Pose, se3};

/// Measured data, parameters and effects: what residuals are computed from.
#[derive(Debug, Clone, Copy)]
pub struct Problem<'a, E> {
    /// What was measured.
    pub data: &'a Measurements,
    /// Which numbers are free.
    pub layout: &'a Layout,
    /// What is added to geometry.
    pub effects: &'a E,
}

/// Room for one row's computation: made once, used for many rows.
#[derive(Debug, Clone)]
pub struct Scratch {
    state: RowState,
    deviation: Deviation,
    sensitivities: Vec<Sensitivity>,
    twists: Twists,
    across: Vec<Across>,
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

    /// Less the velocity of a point (base frame, m), parameter by parameter: three rows of `columns` cells.
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

    /// Less the angular velocities, taken through `matrix`: three rows of `columns` cells.
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
    /// For this layout and the axes of this arm; make a new one when the arm has changed.
    pub fn new(layout: &Layout, arm: &Arm) -> Self {
        let nominal = arm.nominal.joints();
        let carry = |(index, joint): (usize, &denavit_model::ChainJoint)| {
            layout.across[index].carried(&nominal[index].screw, &joint.screw)
        };
        Self {
            state: RowState::default(),
            deviation: Deviation::none(arm.joints.len()),
            sensitivities: vec![Sensitivity::default(); layout.effects.len()],
            twists: Twists::zeros(layout.effects.end),
            across: arm.joints.iter().enumerate().map(carry).collect(),
            axes: vec![AxisNow::default(); arm.joints.len()],
        }
    }

    /// The arm as lanes need it, where there are no effects.
    pub(crate) fn geometry(&self, arm: &Arm, kind: MeasurementKind) -> Option<Geometry> {
        Geometry::of(arm, &self.across, kind)
    }

    /// Where the arm stood in the row computed last.
    pub fn state(&self) -> &RowState {
        &self.state
    }
}

/// A joint's axis in one row, as a change of it enters: what carries it less what it carries.
#[derive(Debug, Clone, Copy, Default)]
struct AxisNow {
    /// Directions across the axis before the joint's motion less those after it.
    directions: [Vector3<f64>; 2],
    after: [Vector3<f64>; 2],
    /// Centre before the motion, and how far the motion brought it back, m.
    centre: Vector3<f64>,
    back: Vector3<f64>,
}

impl AxisNow {
    #[inline]
    fn of(before: &Pose, after: &Pose, basis: &Across) -> Self {
        let now = [after.rotation * basis.a, after.rotation * basis.b];
        let directions = [before.rotation * basis.a - now[0], before.rotation * basis.b - now[1]];
        let centre = (before * basis.centre).coords;
        Self { directions, after: now, centre, back: centre - (after * basis.centre).coords }
    }

    /// Twist per unit of a turn about direction `across`: c × w before the motion less the same after it.
    #[inline]
    fn turned(&self, across: usize) -> (Vector3<f64>, Vector3<f64>) {
        let w = self.directions[across];
        (w, self.centre.cross(&w) + self.back.cross(&self.after[across]))
    }
}

/// Residual values per observation: 6 for poses, 3 for positions, 1 for distances.
pub fn width(kind: MeasurementKind) -> usize {
    match kind {
        MeasurementKind::Pose => 6,
        MeasurementKind::Position => 3,
        MeasurementKind::Distance => 1,
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

/// (1 - t/2 cot(t/2))/t² of the square of an angle t, rad².
pub(crate) fn square_factor(t2: f64) -> f64 {
    let t = t2.sqrt();
    if t < 1e-3 { 1.0 / 12.0 + t2 / 720.0 } else { (1.0 - t * t.sin() / (4.0 * (0.5 * t).sin().powi(2))) / t2 }
}

/// Inverse left Jacobian of SO(3) at rotation vector `r`; the right one is its transpose.
fn inverse_left_jacobian(r: &Vector3<f64>) -> Matrix3<f64> {
    let w = se3::skew(r);
    Matrix3::identity() - w * 0.5 + w * w * square_factor(r.norm_squared())
}

impl<E: Effects> Problem<'_, E> {
    /// Residuals (measured minus predicted) of one row and their derivatives.
    ///
    /// With X = instrument_from_base, T = base_from_tip(q), t the target in the tip frame, p = T t, m the measured value:
    /// - position: r = X⁻¹ m - p, in the base frame, m;
    /// - orientation: r = log(Rx⁻¹ Rm (R(T) Rt)⁻¹), rad, base frame, after the position;
    /// - distance: r = m - |p - anchor|, m.
    ///
    /// A joint's axis enters as dT T⁻¹ = Ad(A) b - Ad(A e^\[S\]v) b for each basis twist b at home, A the motion
    /// of what carries the joint.
    ///
    /// # Shape and units
    /// `residual`: targets × width values; `jacobian`: as many rows, row by row, of one column per parameter. What was
    /// not seen comes out as 0.
    pub fn row_into(
        &self,
        arm: &Arm,
        row: usize,
        scratch: &mut Scratch,
        residual: &mut [f64],
        mut jacobian: Option<&mut [f64]>,
    ) {
        let at = Row::new(self.data, row);
        scratch.deviation.clear();
        let deviates = self.effects.deviate(at, arm, &mut scratch.deviation);
        arm.state_into(at.reading(), deviates.then_some(&scratch.deviation), &mut scratch.state);
        if jacobian.is_some() {
            self.twists(arm, at, scratch);
        }
        let (columns, step) = (self.layout.len(), width(self.data.kind));
        for target in 0..self.data.targets.len() {
            let r = &mut residual[target * step..(target + 1) * step];
            let j = jacobian.as_deref_mut().map(|all| &mut all[target * step * columns..(target + 1) * step * columns]);
            if self.data.kind == MeasurementKind::Distance {
                self.distance(arm, row, scratch, r, j);
            } else {
                self.position(arm, row, target, scratch, r, j);
            }
        }
    }

    /// Twist of the tip per unit of each joint and effect parameter.
    fn twists(&self, arm: &Arm, at: Row<'_>, scratch: &mut Scratch) {
        let Scratch { state, sensitivities, twists, across, axes, .. } = scratch;
        if !self.layout.joints.is_empty() {
            for (axis, ((before, after), basis)) in
                axes.iter_mut().zip(state.before.iter().zip(&state.after).zip(across.iter()))
            {
                *axis = AxisNow::of(before, after, basis);
            }
        }
        for (column, parameter) in self.layout.parameters[self.layout.joints.clone()].iter().enumerate() {
            let Some(joint) = parameter.kind.joint() else { continue };
            let (before, axis) = (&state.before[joint], &axes[joint]);
            let (w, v) = match parameter.kind {
                ParameterKind::Turn { across, .. } => axis.turned(across),
                ParameterKind::Move { across, .. } => (Vector3::zeros(), axis.directions[across]),
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
            self.effects.sensitivities(at, arm, state, sensitivities);
            for (column, sensitivity) in self.layout.effects.clone().zip(sensitivities.iter()) {
                let twist = &sensitivity.twist;
                twists.set(column, &omega(twist), &Vector3::new(twist[3], twist[4], twist[5]));
            }
        }
    }

    fn position(
        &self,
        arm: &Arm,
        row: usize,
        target: usize,
        scratch: &Scratch,
        residual: &mut [f64],
        jacobian: Option<&mut [f64]>,
    ) {
        let Some(measured) = self.data.position(row, target) else {
            residual.fill(0.0);
            if let Some(jacobian) = jacobian {
                jacobian.fill(0.0);
            }
            return;
        };
        let (state, deviation) = (&scratch.state, &scratch.deviation);
        let on_tip = arm.targets[target].translation.vector + deviation.target;
        let predicted = state.tip.rotation * on_tip + state.tip.translation.vector;
        let to_base = arm.instrument.rotation.inverse();
        let measured_in_base = to_base * (measured / (1.0 + deviation.scale) - arm.instrument.translation.vector);
        let difference = measured_in_base - predicted;
        residual[..3].copy_from_slice(difference.as_slice());
        let orientation = (self.data.kind == MeasurementKind::Pose).then(|| {
            let turned = to_base * self.data.orientations[row];
            let turn = se3::rotation_vector(&(turned * (state.tip.rotation * arm.targets[target].rotation).inverse()));
            residual[3..6].copy_from_slice(turn.as_slice());
            inverse_left_jacobian(&turn)
        });
        let Some(jacobian) = jacobian else { return };
        let columns = self.layout.len();
        scratch.twists.less_velocities(&predicted, columns, jacobian);
        for (k, sensitivity) in scratch.sensitivities.iter().enumerate() {
            let column = self.layout.effects.start + k;
            let scale = sensitivity.scale / (1.0 + deviation.scale).powi(2);
            let value = -velocity(&sensitivity.twist, &predicted)
                - state.tip.rotation * sensitivity.target
                - to_base * measured * scale;
            put(jacobian, columns, column, &value);
        }
        let [x, y, z]: [f64; 3] = measured_in_base.into();
        let of_instrument = [[0.0, -z, y, -1.0, 0.0, 0.0], [z, 0.0, -x, 0.0, -1.0, 0.0], [-y, x, 0.0, 0.0, 0.0, -1.0]];
        let (first, tip) = (self.layout.targets.start + 3 * target, state.tip.rotation.matrix());
        for (row, line) in jacobian.chunks_exact_mut(columns).take(3).enumerate() {
            line[self.layout.instrument.clone()].copy_from_slice(&of_instrument[row]);
            line[self.layout.targets.clone()].fill(0.0);
            line[first..first + 3].copy_from_slice(&[-tip[(row, 0)], -tip[(row, 1)], -tip[(row, 2)]]);
        }
        if let Some(left) = orientation {
            self.orientation(&left, &state.tip.rotation, &scratch.twists, &mut jacobian[3 * columns..]);
        }
    }

    fn orientation(&self, left: &Matrix3<f64>, tip: &Rotation3<f64>, twists: &Twists, jacobian: &mut [f64]) {
        let columns = self.layout.len();
        let right = left.transpose();
        twists.less_turns(&right, columns, jacobian);
        let turned = right * tip.matrix();
        for (row, line) in jacobian.chunks_exact_mut(columns).take(3).enumerate() {
            let less = |matrix: &Matrix3<f64>| [-matrix[(row, 0)], -matrix[(row, 1)], -matrix[(row, 2)]];
            line[self.layout.instrument.start..].fill(0.0);
            line[self.layout.instrument.start..][..3].copy_from_slice(&less(left));
            line[self.layout.targets.end - 3..self.layout.targets.end].copy_from_slice(&less(&turned));
        }
    }

    fn distance(&self, arm: &Arm, row: usize, scratch: &Scratch, residual: &mut [f64], jacobian: Option<&mut [f64]>) {
        let (state, deviation) = (&scratch.state, &scratch.deviation);
        let on_tip = arm.targets[0].translation.vector + deviation.target;
        let predicted = state.tip.rotation * on_tip + state.tip.translation.vector;
        let from_anchor = predicted - arm.anchor - deviation.anchor;
        let distance = from_anchor.norm();
        let stretch = 1.0 + deviation.scale;
        residual[0] = self.data.distances[row] - stretch * distance - deviation.reading;
        let Some(jacobian) = jacobian else { return };
        let along = if distance > 0.0 { from_anchor * (stretch / distance) } else { Vector3::zeros() };
        let moment = predicted.cross(&along);
        let direction = [moment.x, moment.y, moment.z, along.x, along.y, along.z];
        for (column, cell) in jacobian[..self.layout.effects.end].iter_mut().enumerate() {
            // along · (omega × p + v) = (p × along) · omega + along · v.
            *cell = -scratch.twists.0.iter().zip(direction).map(|(numbers, d)| numbers[column] * d).sum::<f64>();
        }
        for (k, sensitivity) in scratch.sensitivities.iter().enumerate() {
            let moved =
                velocity(&sensitivity.twist, &predicted) + state.tip.rotation * sensitivity.target - sensitivity.anchor;
            jacobian[self.layout.effects.start + k] =
                -along.dot(&moved) - sensitivity.scale * distance - sensitivity.reading;
        }
        let on_targets = state.tip.rotation.inverse() * along;
        for k in 0..3 {
            jacobian[self.layout.instrument.start + k] = along[k];
            jacobian[self.layout.targets.start + k] = -on_targets[k];
        }
    }
}
