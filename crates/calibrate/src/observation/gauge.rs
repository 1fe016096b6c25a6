//! The frame that nobody sees: moving base frame, axes and targets together changes no measured value.
//!
//! A fit holds these directions by asking that the axes stay as near to nominal as they can.

use crate::observation::arm::Arm;
use crate::observation::parameters::{Layout, ParameterKind};
use denavit_model::nalgebra::{DMatrix, DVector, Point3, Vector3, Vector6};
use denavit_model::se3;

/// Weight of the targets' places beside the axes' tolerances: only what moves no axis is left to them.
const WEIGHT_OF_TARGETS: f64 = 1e-8;

/// Moves that make the conditions hold exactly, one better than the other.
const MOST_MOVES: usize = 5;
/// A move of this size (rad, m) is the last.
const SMALL_MOVE: f64 = 1e-10;
/// A motion that resists less than this, beside the others, moves nothing that the conditions look at.
const MOVES_NOTHING: f64 = 1e-11;

/// Change of each parameter by a common motion of axes and targets: 6 columns, twists `[omega; v]` in the base frame.
///
/// Columns of the instruments are their own countermove; points move along.
pub fn common_motions(layout: &Layout, arm: &Arm) -> DMatrix<f64> {
    let mut motions = DMatrix::zeros(layout.len(), 6);
    let home = arm.nominal.home();
    for (row, parameter) in layout.parameters.iter().enumerate() {
        for column in 0..6 {
            let e = Vector3::ith(column % 3, 1.0);
            let (omega, v) = if column < 3 { (e, Vector3::zeros()) } else { (Vector3::zeros(), e) };
            motions[(row, column)] = match parameter.kind {
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
                    let point = home.rotation * arm.targets[target].translation.vector + home.translation.vector;
                    let moved = v + omega.cross(&point);
                    (home.rotation.inverse() * moved)[component]
                }
                ParameterKind::TargetTurn { component, .. } => (home.rotation.inverse() * omega)[component],
                ParameterKind::Pitch { .. } | ParameterKind::Scale { .. } | ParameterKind::Effect { .. } => 0.0,
            };
        }
    }
    motions
}

/// The conditions that hold the frame: their product with the departure from nominal is to be 0. Up to 6 columns.
///
/// They say that no common motion brings the axes nearer to nominal, each departure taken in its tolerance. Motions
/// are those of the robot as drawn. What moves none of its axes (along the parallel axes of a SCARA) is settled by
/// the targets, which stay where `reference` has them, unless there are effects: these act at places of the arm, so the
/// data may tell it, and it is left free.
pub fn conditions(layout: &Layout, reference: &Arm) -> DMatrix<f64> {
    held(layout, reference).0
}

/// The conditions, and the common motions (6 rows) that they hold.
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
    // Brought to size 1: rotations and translations weigh differently.
    let largest = resistance.diagonal().max().max(f64::MIN_POSITIVE);
    let size = resistance.diagonal().map(|own| 1.0 / own.max(MOVES_NOTHING * MOVES_NOTHING * largest).sqrt());
    let scaled = DMatrix::from_fn(6, 6, |i, k| resistance[(i, k)] * size[i] * size[k]).symmetric_eigen();
    let kept: Vec<usize> = (0..6).filter(|&k| scaled.eigenvalues[k] > MOVES_NOTHING).collect();
    let held = DMatrix::from_diagonal(&size) * scaled.eigenvectors.select_columns(&kept);
    (conditions * &held, held)
}

/// Conditions on numbers that are each `scale` times as large, as an orthonormal basis: one row per number.
pub fn in_scaled(mut conditions: DMatrix<f64>, scale: &[f64]) -> DMatrix<f64> {
    for (mut row, scale) in conditions.row_iter_mut().zip(scale) {
        row.scale_mut(*scale);
    }
    conditions.qr().q()
}

/// The arm that measures exactly the same, moved so that the conditions hold: its axes are as near to nominal as the
/// common frame allows.
pub fn centred(layout: &Layout, arm: &Arm, reference: &Arm) -> Arm {
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

/// The common motion, of those that are held, that makes the conditions hold to first order.
fn missing(
    layout: &Layout,
    conditions: &DMatrix<f64>,
    held: &DMatrix<f64>,
    arm: &Arm,
    reference: &Arm,
) -> Option<Vector6<f64>> {
    if layout.joints.is_empty() {
        return None;
    }
    let difference = DVector::from_vec(layout.difference(arm, reference));
    let matrix = conditions.transpose() * common_motions(layout, arm) * held;
    let solution = matrix.svd(true, true).solve(&(conditions.transpose() * difference), 1e-13).ok()?;
    let twist = Vector6::from_iterator((held * solution).iter().map(|x| -x));
    (twist != Vector6::zeros() && twist.iter().all(|x| x.is_finite())).then_some(twist)
}

/// Move axes, points and targets, and the instruments' frames against them.
fn move_all(layout: &Layout, arm: &mut Arm, twist: &Vector6<f64>) {
    let motion = se3::exp(twist);
    for (index, joint) in arm.joints.iter_mut().enumerate() {
        joint.screw = joint.screw.moved(&motion).about(&layout.bases[index].centre);
    }
    for instrument in &mut arm.instruments {
        let moved = *instrument * motion.inverse();
        *instrument = se3::pose(se3::orthonormalised(&moved.rotation), moved.translation.vector);
    }
    for point in &mut arm.points {
        *point = (motion * Point3::from(*point)).coords;
    }
    let home = arm.nominal.home();
    for target in &mut arm.targets {
        *target = home.inverse() * motion * home * *target;
        target.rotation = se3::orthonormalised(&target.rotation);
    }
}
