//! Maximum likelihood: the observation is `left⁻¹ moved right`, with normal errors of position and orientation.

use crate::Row;
use denavit_model::nalgebra::{Matrix3, Matrix6, SMatrix, SVector, Vector3, Vector6};
use denavit_model::{Pose, se3};

/// Normal equations of both placements: left's move and turn, right's move and turn, each in its own frame.
pub type Normal = SMatrix<f64, 12, 12>;
type Step = SVector<f64, 12>;

/// Gauss-Newton steps.
const MOST_STEPS: usize = 100;
/// A step this small ends them, m of the rows' size and rad.
const CONVERGED: f64 = 1e-13;
/// Rounds of estimating both variances.
const MOST_ROUNDS: usize = 50;
/// Variances that change by less than this share have converged.
const CONVERGED_VARIANCE: f64 = 1e-8;
/// Noise counts as no less than this share of the size, and this many rad, so that rows without any are weighed.
const LEAST_NOISE: f64 = 1e-9;

/// What is measured less what is predicted: position in the instrument's frame (m), rotation vector (rad).
pub fn residual([left, right]: &[Pose; 2], row: &Row) -> Vector6<f64> {
    let predicted = left.inverse() * row.moved * right;
    let place = row.seen.translation.vector - predicted.translation.vector;
    let turn = se3::rotation_vector(&(predicted.rotation.inverse() * row.seen.rotation));
    Vector6::new(place.x, place.y, place.z, turn.x, turn.y, turn.z)
}

/// Derivative of the prediction, position and then rotation, by a move and a turn of each placement in its own frame.
fn jacobian([left, right]: &[Pose; 2], row: &Row) -> SMatrix<f64, 6, 12> {
    let predicted = left.inverse() * row.moved * right;
    let (r, p) = (predicted.rotation.matrix(), predicted.translation.vector);
    let mut j = SMatrix::<f64, 6, 12>::zeros();
    j.fixed_view_mut::<3, 3>(0, 0).copy_from(&-Matrix3::identity());
    j.fixed_view_mut::<3, 3>(0, 3).copy_from(&se3::skew(&p));
    j.fixed_view_mut::<3, 3>(0, 6).copy_from(r);
    j.fixed_view_mut::<3, 3>(3, 3).copy_from(&-r.transpose());
    j.fixed_view_mut::<3, 3>(3, 9).copy_from(&Matrix3::identity());
    j
}

/// A pose with a move and a turn in its own frame.
fn moved(pose: &Pose, step: &Vector6<f64>) -> Pose {
    let turn = se3::pose(
        denavit_model::nalgebra::Rotation3::new(step.fixed_rows::<3>(3).into_owned()),
        step.fixed_rows::<3>(0).into_owned(),
    );
    let mut moved = pose * turn;
    moved.rotation = se3::orthonormalised(&moved.rotation);
    moved
}

/// A fit and its noise model.
#[derive(Debug, Clone, PartialEq)]
pub struct Fitted {
    /// `[left, right]`.
    pub placed: [Pose; 2],
    /// Standard deviation of one component of position, m, and of orientation, rad.
    pub noise: [f64; 2],
    /// Jᵀ W J at the end.
    pub normal: Normal,
    /// Whether steps and variances converged.
    pub converged: bool,
}

/// Weighted sum of squares.
fn cost(placed: &[Pose; 2], rows: &[Row], weights: [f64; 2]) -> f64 {
    rows.iter().map(|row| square(&residual(placed, row), weights)).sum()
}

/// A row's weighted square.
pub fn square(residual: &Vector6<f64>, [place, turn]: [f64; 2]) -> f64 {
    place * residual.fixed_rows::<3>(0).norm_squared() + turn * residual.fixed_rows::<3>(3).norm_squared()
}

fn equations(placed: &[Pose; 2], rows: &[Row], [place, turn]: [f64; 2]) -> (Normal, Step) {
    let (mut normal, mut side) = (Normal::zeros(), Step::zeros());
    for row in rows {
        let (j, r) = (jacobian(placed, row), residual(placed, row));
        for (at, weight) in [(0, place), (3, turn)] {
            let part = j.fixed_rows::<3>(at);
            normal += weight * part.transpose() * part;
            side += weight * part.transpose() * r.fixed_rows::<3>(at);
        }
    }
    (normal, side)
}

/// Least squares with given weights, by Levenberg and Marquardt; damping in units of the rows' size, so that what the rows do not
/// tell stays where it was.
fn least_squares(start: [Pose; 2], rows: &[Row], weights: [f64; 2], size: f64) -> ([Pose; 2], bool) {
    let scale = scales(size);
    let (mut placed, mut damping) = (start, 1e-6);
    let mut least = cost(&placed, rows, weights);
    for _ in 0..MOST_STEPS {
        let (normal, side) = equations(&placed, rows, weights);
        let largest = normal.diagonal().component_mul(&scale).component_mul(&scale).max();
        loop {
            let damped = normal + Normal::from_diagonal(&scale.map(|scale| damping * largest / (scale * scale)));
            let Some(factor) = damped.cholesky() else { return (placed, false) };
            let step = factor.solve(&side);
            let next = [
                moved(&placed[0], &step.fixed_rows::<6>(0).into_owned()),
                moved(&placed[1], &step.fixed_rows::<6>(6).into_owned()),
            ];
            let small = step.component_div(&scale).amax() < CONVERGED;
            let here = cost(&next, rows, weights);
            if here <= least {
                (placed, least, damping) = (next, here, (damping * 0.1).max(1e-15));
                if small {
                    return (placed, true);
                }
                break;
            }
            // At the bottom of the valley rounding decides.
            if small || damping > 1e6 {
                return (placed, true);
            }
            damping *= 10.0;
        }
    }
    (placed, false)
}

/// What one unit is in each of the twelve: the size for moves, a radian for turns.
pub fn scales(size: f64) -> Step {
    Step::from_fn(|index, _| if index % 6 < 3 { size } else { 1.0 })
}

/// The fit from a start, with both variances estimated by restricted maximum likelihood.
///
/// # Shape and units
/// `size` is how far the rows are spread, m: what a turn of one radian moves.
pub fn fit(start: [Pose; 2], rows: &[Row], size: f64) -> Fitted {
    let n = 3.0 * rows.len() as f64;
    let mut placed = start;
    let mut noise = start_noise(&placed, rows);
    let mut done = false;
    for _ in 0..MOST_ROUNDS {
        let weights = weights(noise, size);
        let (next, converged) = least_squares(placed, rows, weights, size);
        placed = next;
        let (normal, _) = equations(&placed, rows, weights);
        let covariance = covariance(&normal, size);
        let mut used = [0.0; 2];
        let mut squares = [0.0; 2];
        for row in rows {
            let (j, r) = (jacobian(&placed, row), residual(&placed, row));
            for (channel, at) in [0, 3].into_iter().enumerate() {
                let part = j.fixed_rows::<3>(at);
                used[channel] += weights[channel] * (part * covariance * part.transpose()).trace();
                squares[channel] += r.fixed_rows::<3>(at).norm_squared();
            }
        }
        let next: [f64; 2] = std::array::from_fn(|channel| {
            let degrees = (n - used[channel]).max(1.0);
            (squares[channel] / degrees).sqrt()
        });
        let change = next
            .iter()
            .zip(noise)
            .zip(least_noise(size))
            .map(|((next, before), least)| (next.max(least) / before.max(least) - 1.0).abs());
        let change = change.fold(0.0, f64::max);
        noise = next;
        if converged && change < CONVERGED_VARIANCE {
            done = true;
            break;
        }
    }
    let (normal, _) = equations(&placed, rows, weights(noise, size));
    Fitted { placed, noise, normal, converged: done }
}

fn least_noise(size: f64) -> [f64; 2] {
    [LEAST_NOISE * size, LEAST_NOISE]
}

/// The inverse of both variances.
pub fn weights(noise: [f64; 2], size: f64) -> [f64; 2] {
    let least = least_noise(size);
    [0, 1].map(|channel| noise[channel].max(least[channel]).powi(-2))
}

fn start_noise(placed: &[Pose; 2], rows: &[Row]) -> [f64; 2] {
    let residuals: Vec<Vector6<f64>> = rows.iter().map(|row| residual(placed, row)).collect();
    let of = |at: usize| median(residuals.iter().map(|residual| residual.fixed_rows::<3>(at).norm()).collect());
    [of(0), of(3)]
}

/// The median; 0 of nothing.
pub fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(0.0)
}

/// The pseudo-inverse of the normal equations, without directions that the rows do not determine.
pub fn covariance(normal: &Normal, size: f64) -> Normal {
    let scale = scales(size);
    let scaled = Normal::from_fn(|row, column| normal[(row, column)] * scale[row] * scale[column]);
    let eigen = scaled.symmetric_eigen();
    let largest = eigen.eigenvalues.max();
    let mut inverse = Normal::zeros();
    for (value, vector) in eigen.eigenvalues.iter().zip(eigen.eigenvectors.column_iter()) {
        if *value > UNTOLD * largest {
            inverse += vector * vector.transpose() / *value;
        }
    }
    Normal::from_fn(|row, column| inverse[(row, column)] * scale[row] * scale[column])
}

/// An eigenvalue below this share of the largest is rounding.
pub const UNTOLD: f64 = 1e-13;

/// The covariance of one placement, in the frame that it is given in: position (m), then rotation (rad).
pub fn in_parent(pose: &Pose, own: &Matrix6<f64>) -> Matrix6<f64> {
    let mut turn = Matrix6::zeros();
    for at in [0, 3] {
        turn.fixed_view_mut::<3, 3>(at, at).copy_from(pose.rotation.matrix());
    }
    turn * own * turn.transpose()
}

/// How far places are spread about their mean, m.
pub fn spread(places: impl Iterator<Item = Vector3<f64>> + Clone) -> f64 {
    let count = places.clone().count().max(1) as f64;
    let mean = places.clone().sum::<Vector3<f64>>() / count;
    (places.map(|place| (place - mean).norm_squared()).sum::<f64>() / count).sqrt()
}
