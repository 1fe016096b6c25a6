//! Residuals of one row and their derivatives with respect to every parameter, in closed form.

use crate::arm::{Across, Arm, Deviation, Row, RowState};
use crate::measurements::{MeasurementKind, Measurements};
use crate::parameters::{Effects, Layout, ParameterKind, Sensitivity};
use denavit_model::nalgebra::{Matrix3, Rotation3, Vector3, Vector6};
use denavit_model::se3;

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
    twists: Vec<Vector6<f64>>,
    across: Vec<Across>,
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
            twists: vec![Vector6::zeros(); layout.effects.end],
            across: arm.joints.iter().enumerate().map(carry).collect(),
        }
    }

    /// Where the arm stood in the row computed last.
    pub fn state(&self) -> &RowState {
        &self.state
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

/// Inverse left Jacobian of SO(3) at rotation vector `r`; the right one is its transpose.
fn inverse_left_jacobian(r: &Vector3<f64>) -> Matrix3<f64> {
    let t2 = r.norm_squared();
    let t = t2.sqrt();
    let factor =
        if t < 1e-3 { 1.0 / 12.0 + t2 / 720.0 } else { (1.0 - t * t.sin() / (4.0 * (0.5 * t).sin().powi(2))) / t2 };
    let w = se3::skew(r);
    Matrix3::identity() - w * 0.5 + w * w * factor
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
        let Scratch { state, sensitivities, twists, across, .. } = scratch;
        for (column, parameter) in self.layout.parameters[self.layout.joints.clone()].iter().enumerate() {
            let Some(joint) = parameter.kind.joint() else { continue };
            let (before, after, basis) = (&state.before[joint], &state.after[joint], &across[joint]);
            let pick = |k: usize| if k == 0 { basis.a } else { basis.b };
            let (w, v) = match parameter.kind {
                ParameterKind::Turn { across, .. } => {
                    let (w0, w1) = (before.rotation * pick(across), after.rotation * pick(across));
                    let (c0, c1) = ((before * basis.centre).coords, (after * basis.centre).coords);
                    (w0 - w1, c0.cross(&w0) - c1.cross(&w1))
                }
                ParameterKind::Move { across, .. } => {
                    (Vector3::zeros(), before.rotation * pick(across) - after.rotation * pick(across))
                }
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
            twists[column] = Vector6::new(w.x, w.y, w.z, v.x, v.y, v.z);
        }
        if !sensitivities.is_empty() {
            sensitivities.fill(Sensitivity::default());
            self.effects.sensitivities(at, arm, state, sensitivities);
            for (twist, sensitivity) in twists[self.layout.effects.clone()].iter_mut().zip(sensitivities.iter()) {
                *twist = sensitivity.twist;
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
        let measured_in_base = arm.instrument.rotation.inverse()
            * (measured / (1.0 + deviation.scale) - arm.instrument.translation.vector);
        let difference = measured_in_base - predicted;
        residual[..3].copy_from_slice(difference.as_slice());
        let orientation = (self.data.kind == MeasurementKind::Pose).then(|| {
            let turned = arm.instrument.rotation.inverse() * self.data.orientations[row];
            let turn = se3::rotation_vector(&(turned * (state.tip.rotation * arm.targets[target].rotation).inverse()));
            residual[3..6].copy_from_slice(turn.as_slice());
            inverse_left_jacobian(&turn)
        });
        let Some(jacobian) = jacobian else { return };
        let columns = self.layout.len();
        for (column, twist) in scratch.twists.iter().enumerate() {
            put(jacobian, columns, column, &-velocity(twist, &predicted));
        }
        for (k, sensitivity) in scratch.sensitivities.iter().enumerate() {
            let column = self.layout.effects.start + k;
            let scale = sensitivity.scale / (1.0 + deviation.scale).powi(2);
            let value = -velocity(&sensitivity.twist, &predicted)
                - state.tip.rotation * sensitivity.target
                - arm.instrument.rotation.inverse() * measured * scale;
            put(jacobian, columns, column, &value);
        }
        let start = self.layout.instrument.start;
        for k in 0..3 {
            let e = Vector3::ith(k, 1.0);
            put(jacobian, columns, start + k, &-e.cross(&measured_in_base));
            put(jacobian, columns, start + 3 + k, &-e);
        }
        for other in self.layout.targets.clone() {
            let value = match self.layout.parameters[other].kind {
                ParameterKind::Target { target: of, component } if of == target => {
                    -state.tip.rotation.matrix().column(component).into_owned()
                }
                _ => Vector3::zeros(),
            };
            put(jacobian, columns, other, &value);
        }
        if let Some(left) = orientation {
            self.orientation(&left, &state.tip.rotation, &scratch.twists, &mut jacobian[3 * columns..]);
        }
    }

    fn orientation(&self, left: &Matrix3<f64>, tip: &Rotation3<f64>, twists: &[Vector6<f64>], jacobian: &mut [f64]) {
        let columns = self.layout.len();
        let right = left.transpose();
        for (column, twist) in twists.iter().enumerate() {
            put(jacobian, columns, column, &-(right * omega(twist)));
        }
        let start = self.layout.instrument.start;
        for k in 0..3 {
            put(jacobian, columns, start + k, &-left.column(k).into_owned());
            put(jacobian, columns, start + 3 + k, &Vector3::zeros());
        }
        let turned = right * tip.matrix();
        for other in self.layout.targets.clone() {
            let value = match self.layout.parameters[other].kind {
                ParameterKind::TargetTurn { component } => -turned.column(component).into_owned(),
                _ => Vector3::zeros(),
            };
            put(jacobian, columns, other, &value);
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
        for (column, twist) in scratch.twists.iter().enumerate() {
            jacobian[column] = -along.dot(&velocity(twist, &predicted));
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
