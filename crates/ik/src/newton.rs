//! Newton's method on the pose of an arm, from a start near a solution, and damped least squares where no such start is known.

use crate::arm::{Angle, Axis, SixR};
use denavit_model::nalgebra::{Matrix6, Rotation3, Vector3, Vector6};
use denavit_model::{Chain, Pose, se3};
use std::f64::consts::FRAC_1_SQRT_2;

/// A step of more than this, rad, is shortened: beyond it the linear model is not valid.
const LONGEST_STEP: f64 = 0.5;
/// Near a solution Newton's method doubles the digits in each step; a start that needs more steps has left it.
const MOST_STEPS: usize = 15;
/// An error of this, rad and share of the size, is that of some dozen products: another step would change it without reducing it.
const ROUNDING: f64 = 1e-14;

/// How far a pose is from the target: `[rotation vector, translation / size]`, both in the base frame.
#[inline]
pub(crate) fn error(target: &Pose, reached: &Pose, size: f64) -> Vector6<f64> {
    let turn = small_rotation_vector(target, reached);
    let shift = (target.translation.vector - reached.translation.vector) / size;
    Vector6::new(turn.x, turn.y, turn.z, shift.x, shift.y, shift.z)
}

/// The rotation vector (rad) from one orientation to the other: by half the difference of the columns' cross products where it is
/// small, which keeps all digits and needs no quaternion.
#[inline]
fn small_rotation_vector(target: &Pose, reached: &Pose) -> Vector3<f64> {
    let (t, r) = (target.rotation.matrix(), reached.rotation.matrix());
    let trace = t.component_mul(r).sum();
    if trace < 2.9 {
        return se3::rotation_vector(&(target.rotation * reached.rotation.inverse()));
    }
    let sum: Vector3<f64> = (0..3).map(|k| r.column(k).cross(&t.column(k))).sum();
    let sine = 0.5 * sum;
    // sin θ u; θ/sin θ to fourth order, exact to rounding for the angles that come here.
    let square = sine.norm_squared();
    sine * (1.0 + square / 6.0 + 3.0 * square * square / 40.0)
}

/// Where Newton's method ended.
pub(crate) struct Landed {
    /// The remaining angle, rad.
    pub orientation: f64,
    /// The remaining distance, as a fraction of the size.
    pub position: f64,
    /// The smallest pivot of the Jacobian of the last step, near 0 near a singularity; 1 where no step was needed.
    pub pivot: f64,
}

/// An arm at joint values: its axes in the base frame, and the motion of each joint.
///
/// Solutions of a pose share their first joint values, and what those move is not computed again.
pub(crate) struct Placed<'a> {
    arm: &'a SixR,
    angles: [Angle; 6],
    axes: [Axis; 6],
    /// base_from_moved behind no joint, behind the first, and so on.
    behind: [(Rotation3<f64>, Vector3<f64>); 7],
}

impl<'a> Placed<'a> {
    /// The arm at home.
    pub fn new(arm: &'a SixR) -> Self {
        let behind = [(Rotation3::identity(), Vector3::zeros()); 7];
        Self { arm, angles: [Angle::ZERO; 6], axes: arm.axes, behind }
    }

    /// The axes where the arm is.
    pub fn axes(&self) -> &[Axis; 6] {
        &self.axes
    }

    /// Takes the arm to joint values; base_from_tip there.
    #[inline]
    fn go(&mut self, angles: &[Angle; 6]) -> Pose {
        let same = |(a, b): &(&Angle, &Angle)| a.value.to_bits() == b.value.to_bits();
        let first = angles.iter().zip(&self.angles).take_while(same).count();
        for (k, angle) in angles.iter().enumerate().skip(first) {
            let (axis, (turn, shift)) = (&self.arm.axes[k], self.behind[k]);
            let point = turn * axis.point + shift;
            self.axes[k] = Axis { direction: turn * axis.direction, point };
            let turn = turn * axis.rotation(*angle);
            // The axis does not move.
            self.behind[k + 1] = (turn, point - turn * axis.point);
        }
        self.angles = *angles;
        let (turn, shift) = self.behind[6];
        se3::pose(turn, shift) * self.arm.home
    }
}

/// Angle (rad) and distance (share of the size) between two poses, the angle by its chord: exact where it is small.
#[inline]
fn gap(target: &Pose, reached: &Pose, size: f64) -> (f64, f64) {
    // |R1 - R2| = 2 √2 sin(θ/2)
    let chord = (target.rotation.matrix() - reached.rotation.matrix()).norm() * FRAC_1_SQRT_2;
    (chord, (target.translation.vector - reached.translation.vector).norm() / size)
}

/// Refines joint values of a six-joint arm; `None` where the remaining error exceeds `close`.
pub(crate) fn refine(
    placed: &mut Placed<'_>,
    target: &Pose,
    size: f64,
    angles: &mut [Angle; 6],
    close: f64,
) -> Option<Landed> {
    let (mut last, mut pivot) = (f64::INFINITY, 1.0);
    for _ in 0..MOST_STEPS {
        let reached = placed.go(angles);
        let (orientation, position) = gap(target, &reached, size);
        let now = (orientation * orientation + position * position).sqrt();
        let landed = |pivot| Landed { orientation, position, pivot };
        // Rounding alone is left, or the error no longer falls at the end.
        if now < ROUNDING || (now < close && now >= 0.5 * last) {
            return Some(landed(pivot));
        }
        last = now;
        let tip = reached.translation.vector;
        let mut jacobian = Matrix6::zeros();
        for (k, axis) in placed.axes.iter().enumerate() {
            jacobian.fixed_view_mut::<3, 1>(0, k).copy_from(&axis.direction);
            jacobian.fixed_view_mut::<3, 1>(3, k).copy_from(&(axis.direction.cross(&(tip - axis.point)) / size));
        }
        let mut step = error(target, &reached, size);
        let factors = jacobian.lu();
        if !factors.solve_mut(&mut step) {
            return (now < close).then(|| landed(0.0));
        }
        pivot = (0..6).map(|k| factors.lu_internal()[(k, k)].abs()).fold(f64::INFINITY, f64::min);
        let longest = step.amax();
        if !longest.is_finite() {
            return (now < close).then(|| landed(pivot));
        }
        let share = if longest > LONGEST_STEP { LONGEST_STEP / longest } else { 1.0 };
        for (angle, step) in angles.iter_mut().zip(step.iter()) {
            *angle = Angle::at(angle.value + share * step);
        }
    }
    None
}

/// Levenberg-Marquardt for any chain: from `q` to a least distance of pose, error as in [`error`]. Returns the remaining error.
///
/// The step is Jᵀ (J Jᵀ + λ)⁻¹ e, six equations for any number of coordinates.
pub(crate) fn least_squares(
    chain: &Chain,
    target: &Pose,
    size: f64,
    q: &mut [f64],
    (columns, trial): (&mut [Vector6<f64>], &mut [f64]),
    most_steps: usize,
) -> f64 {
    let mut reached = chain.tip_jacobian_into(q, columns);
    let mut left = error(target, &reached, size);
    let mut damping = 1e-3;
    for _ in 0..most_steps {
        if left.norm() < 1e-14 {
            break;
        }
        let mut square = Matrix6::zeros();
        for column in columns.iter_mut() {
            for k in 3..6 {
                column[k] /= size;
            }
            square += *column * column.transpose();
        }
        let mut improved = false;
        for _ in 0..8 {
            let damped = square + Matrix6::identity() * (damping * damping);
            let Some(factor) = damped.cholesky() else { break };
            let multiplier = factor.solve(&left);
            let mut longest: f64 = 0.0;
            for ((trial, q), column) in trial.iter_mut().zip(q.iter()).zip(columns.iter()) {
                let step = column.dot(&multiplier);
                longest = longest.max(step.abs());
                *trial = q + step;
            }
            let share = if longest > LONGEST_STEP { LONGEST_STEP / longest } else { 1.0 };
            if share < 1.0 {
                for (trial, q) in trial.iter_mut().zip(q.iter()) {
                    *trial = q + share * (*trial - q);
                }
            }
            let there = error(target, &chain.fk(trial), size);
            if there.norm() < left.norm() {
                improved = longest > 1e-13;
                q.copy_from_slice(trial);
                damping = (damping * 0.1).max(1e-9);
                break;
            }
            damping = (damping * 4.0).min(1e3);
        }
        if !improved {
            break;
        }
        reached = chain.tip_jacobian_into(q, columns);
        left = error(target, &reached, size);
    }
    left.norm()
}
