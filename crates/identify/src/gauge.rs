//! The unobservable frame: moving base frame, axes and targets together changes no measured value.
//!
//! A fit fixes these directions by the condition that the axes stay as near to nominal as possible.

use crate::arm::Arm;
use crate::parameters::{Layout, ParameterKind};
use denavit_model::nalgebra::{DMatrix, DVector, Point3, Vector3, Vector6};
use denavit_model::{Pose, se3};

/// Weight of the targets' positions relative to the axes' tolerances: they hold only motions that move no axis.
const WEIGHT_OF_TARGETS: f64 = 1e-8;

/// Most iterations until the conditions hold exactly.
const MOST_MOVES: usize = 5;
/// A move of this size (rad, m) is the last.
const SMALL_MOVE: f64 = 1e-10;
/// A motion with less resistance than this, relative to the others, does not affect the conditions.
const MOVES_NOTHING: f64 = 1e-11;

/// Change of each parameter by a common motion of axes and targets: for each of the layout's frames 6 columns, twists `[omega; v]`
/// in the base frame.
///
/// Columns of the instruments are the opposite motion; points move along.
pub fn common_motions(layout: &Layout, arm: &Arm) -> DMatrix<f64> {
    let frames = &layout.frames;
    let mut motions = DMatrix::zeros(layout.len(), 6 * frames.count);
    for (row, parameter) in layout.parameters.iter().enumerate() {
        let first = 6 * match parameter.kind {
            ParameterKind::Turn { joint, .. } | ParameterKind::Move { joint, .. } => frames.joints[joint],
            ParameterKind::Instrument { setup, .. } | ParameterKind::Plane { setup, .. } => frames.setups[setup],
            ParameterKind::Point { point, .. } => frames.points[point],
            ParameterKind::Target { target, .. } | ParameterKind::TargetTurn { target, .. } => frames.targets[target],
            ParameterKind::Pitch { .. }
            | ParameterKind::Scale { .. }
            | ParameterKind::Zero { .. }
            | ParameterKind::Effect { .. } => 0,
        };
        for column in 0..6 {
            let e = Vector3::ith(column % 3, 1.0);
            let (omega, v) = if column < 3 { (e, Vector3::zeros()) } else { (Vector3::zeros(), e) };
            motions[(row, first + column)] = match parameter.kind {
                ParameterKind::Turn { joint, direction } => {
                    let basis =
                        layout.bases[joint].carried(&arm.nominal.joints()[joint].screw, &arm.joints[joint].screw);
                    omega.dot(if direction == 0 { &basis.a } else { &basis.b })
                }
                ParameterKind::Move { joint, direction } => {
                    let basis =
                        layout.bases[joint].carried(&arm.nominal.joints()[joint].screw, &arm.joints[joint].screw);
                    let at_centre = v + omega.cross(&basis.centre.coords);
                    at_centre.dot(if direction == 0 { &basis.a } else { &basis.b })
                }
                ParameterKind::Instrument { component, .. } => -f64::from(u8::from(component == column)),
                ParameterKind::Plane { setup, component } => {
                    let motion = Vector6::new(omega.x, omega.y, omega.z, v.x, v.y, v.z);
                    -se3::adjoint_times(&arm.instruments[setup], &motion)[[0, 1, 5][component]]
                }
                ParameterKind::Point { point, component } => (v + omega.cross(&arm.points[point]))[component],
                ParameterKind::Target { target, component } => {
                    let home = home_of(arm, target);
                    let point = home.rotation * arm.targets[target].translation.vector + home.translation.vector;
                    let moved = v + omega.cross(&point);
                    (home.rotation.inverse() * moved)[component]
                }
                ParameterKind::TargetTurn { target, component } => {
                    (home_of(arm, target).rotation.inverse() * omega)[component]
                }
                ParameterKind::Pitch { .. }
                | ParameterKind::Scale { .. }
                | ParameterKind::Zero { .. }
                | ParameterKind::Effect { .. } => 0.0,
            };
        }
    }
    motions
}

/// Pose of a target's tip with every joint value 0.
fn home_of(arm: &Arm, target: usize) -> &Pose {
    &arm.tips[arm.sits_on[target]].home
}

/// The conditions that hold the frame: their product with the deviation from nominal must be 0. Up to 6 columns for each frame.
///
/// No common motion may bring the axes nearer to nominal, each deviation in its tolerance. Motions are those of the drawn
/// robot. A motion that moves no axis (along the parallel axes of a SCARA) is fixed by the targets, which stay as in
/// `reference`, unless there are effects: these act at points of the arm, so the data may determine the motion, and it is
/// free. No conditions where no axis is free: the prior of the zeros holds their common motions.
pub fn conditions(layout: &Layout, reference: &Arm) -> DMatrix<f64> {
    if !layout.axes_are_free() {
        return DMatrix::zeros(layout.len(), 0);
    }
    held(layout, reference).0
}

/// The conditions, and the common motions (6 rows for each frame) that they hold.
fn held(layout: &Layout, reference: &Arm) -> (DMatrix<f64>, DMatrix<f64>) {
    let drawn = Arm { joints: reference.nominal.joints().to_vec(), ..reference.clone() };
    let motions = common_motions(layout, &drawn);
    let of_targets = if layout.effects.is_empty() { 1e6 * WEIGHT_OF_TARGETS } else { 0.0 };
    let mut conditions = motions.clone();
    for (row, parameter) in layout.parameters.iter().enumerate() {
        let weight = match (parameter.kind, parameter.tolerance) {
            (ParameterKind::Turn { .. } | ParameterKind::Move { .. }, Some(tolerance)) => tolerance.powi(-2),
            (ParameterKind::Target { .. } | ParameterKind::TargetTurn { .. }, _) => of_targets,
            _ => 0.0,
        };
        conditions.row_mut(row).scale_mut(weight);
    }
    let resistance = motions.transpose() * &conditions;
    // Scaled to size 1: rotations and translations have different weights.
    let largest = resistance.diagonal().max().max(f64::MIN_POSITIVE);
    let size = resistance.diagonal().map(|own| 1.0 / own.max(MOVES_NOTHING * MOVES_NOTHING * largest).sqrt());
    let all = resistance.nrows();
    let scaled = DMatrix::from_fn(all, all, |i, k| resistance[(i, k)] * size[i] * size[k]).symmetric_eigen();
    let kept: Vec<usize> = (0..all).filter(|&k| scaled.eigenvalues[k] > MOVES_NOTHING).collect();
    let held = DMatrix::from_diagonal(&size) * scaled.eigenvectors.select_columns(&kept);
    (conditions * &held, held)
}

/// Conditions on numbers that are each `scale` times as large, as an orthonormal basis: one row per number.
pub fn in_scaled(mut conditions: DMatrix<f64>, scale: &[f64]) -> DMatrix<f64> {
    if conditions.ncols() == 0 {
        return conditions;
    }
    for (mut row, scale) in conditions.row_iter_mut().zip(scale) {
        row.scale_mut(*scale);
    }
    conditions.qr().q()
}

/// The arm with the same predictions, moved so that the conditions hold: its axes are as near to nominal as the
/// common frame allows.
pub fn centred(layout: &Layout, arm: &Arm, reference: &Arm) -> Arm {
    if !layout.axes_are_free() {
        return arm.clone();
    }
    let (conditions, held) = held(layout, reference);
    let mut moved = arm.clone();
    for _ in 0..MOST_MOVES {
        let Some(twist) = missing(layout, &conditions, &held, &moved, reference) else { break };
        move_all(layout, &mut moved, &twist);
        if twist.norm() < SMALL_MOVE {
            break;
        }
    }
    moved
}

/// The common motion of each held frame that makes the conditions hold to first order.
fn missing(
    layout: &Layout,
    conditions: &DMatrix<f64>,
    held: &DMatrix<f64>,
    arm: &Arm,
    reference: &Arm,
) -> Option<DVector<f64>> {
    if layout.joints.is_empty() {
        return None;
    }
    let difference = DVector::from_vec(layout.difference(arm, reference));
    let matrix = conditions.transpose() * common_motions(layout, arm) * held;
    let solution = matrix
        .svd(true, true)
        .solve(&(conditions.transpose() * difference), 1e-13)
        .expect("both sets of singular vectors were asked for");
    let twists = -(held * solution);
    (twists.iter().any(|x| *x != 0.0) && twists.iter().all(|x| x.is_finite())).then_some(twists)
}

/// Moves axes, points and targets, and the instruments' frames oppositely; six numbers for each frame.
fn move_all(layout: &Layout, arm: &mut Arm, twists: &DVector<f64>) {
    let frames = &layout.frames;
    let motions: Vec<Pose> =
        (0..frames.count).map(|frame| se3::exp(&twists.fixed_rows::<6>(6 * frame).into_owned())).collect();
    for (index, joint) in arm.joints.iter_mut().enumerate() {
        joint.screw = joint.screw.moved(&motions[frames.joints[index]]).about(&layout.bases[index].centre);
    }
    for (setup, instrument) in arm.instruments.iter_mut().enumerate() {
        let moved = *instrument * motions[frames.setups[setup]].inverse();
        *instrument = se3::pose(se3::orthonormalised(&moved.rotation), moved.translation.vector);
    }
    for (index, point) in arm.points.iter_mut().enumerate() {
        *point = (motions[frames.points[index]] * Point3::from(*point)).coords;
    }
    for (index, target) in arm.targets.iter_mut().enumerate() {
        let home = arm.tips[arm.sits_on[index]].home;
        *target = home.inverse() * motions[frames.targets[index]] * home * *target;
        target.rotation = se3::orthonormalised(&target.rotation);
    }
}
