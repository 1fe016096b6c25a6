//! Joint commands with which the calibrated robot reaches given poses: Newton's method on the full model.

mod in_order;

pub use in_order::in_order;

use denavit_ik::Solver;
use denavit_model::chain::Quantity;
use denavit_model::nalgebra::{DMatrix, DVector, Rotation3, Vector6};
use denavit_model::{Chain, Pose, Screw, se3};
use std::f64::consts::TAU;

/// What is to be reached.
#[derive(Debug, Clone, PartialEq)]
pub enum Wanted {
    /// base_from_tip.
    Pose(Pose),
    /// The pose that the nominal robot has at these joint values.
    Joints(Vec<f64>),
}

/// A command, and its expected error.
#[derive(Debug, Clone, PartialEq)]
pub struct Command {
    /// Joint values that the nominal robot would need; rad, m.
    pub nominal: Vec<f64>,
    /// Joint values to command; rad, m.
    pub joints: Vec<f64>,
    /// Distance of the tip from its wanted position, by the full model, m.
    pub position_error: f64,
    /// Angle of the tip from its wanted orientation, by the full model, rad.
    pub orientation_error: f64,
    /// The same without compensation.
    pub uncompensated: (f64, f64),
    /// Joints outside of their limits.
    pub outside: Vec<String>,
    /// Newton steps on the full model.
    pub steps: usize,
    /// Whether the arm keeps the configuration (elbow up or down, wrist flipped or not) of the joint values that the search
    /// started near: it comes from there without passing a singularity.
    pub keeps_configuration: bool,
}

/// Largest error of a command that counts as reaching its pose: m and rad.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Allowed {
    /// m.
    pub position: f64,
    /// rad.
    pub orientation: f64,
}

impl Allowed {
    /// Whether the command reaches its pose and keeps the limits.
    pub fn met_by(&self, command: &Command) -> bool {
        self.reached_by(command) && command.outside.is_empty()
    }

    /// Whether the command reaches its pose.
    pub fn reached_by(&self, command: &Command) -> bool {
        command.position_error <= self.position && command.orientation_error <= self.orientation
    }
}

/// Orientation weighs as this lever (share of the robot's size) where a pose is out of reach.
const LEVER: f64 = 0.1;
/// The same for a chain of fewer than six coordinates, which can never correct both: position has priority.
const LEVER_OF_FEW: f64 = 0.01;
/// Largest error of a solution at the nominal tip, m (rad times lever).
const REACHED: f64 = 1e-9;
/// Steps of one search.
const MOST_STEPS: usize = 200;

/// Find the command for a wanted pose.
///
/// `solver` is that of the robot as drawn, `actual` gives base_from_tip of the calibrated robot, effects included; `calibrated` is its
/// chain, whose Jacobian is accurate enough for Newton's steps. The search starts at the nominal solution nearest to `near` (rad, m).
///
/// # Shape and units
/// `near`: one value per coordinate.
pub fn compensate(
    solver: &Solver,
    calibrated: &Chain,
    actual: &dyn Fn(&[f64]) -> Pose,
    wanted: &Wanted,
    near: &[f64],
) -> Command {
    let nominal = solver.chain();
    let (pose, (start, keeps_configuration)) = match wanted {
        Wanted::Joints(q) => (nominal.fk(q), (q.clone(), true)),
        Wanted::Pose(pose) => (*pose, nominal_solution(solver, pose, near)),
    };
    let lever = lever(nominal);
    let (joints, steps) = newton(calibrated, actual, &pose, &start, lever);
    let (orientation_error, position_error) = se3::difference(&actual(&joints), &pose);
    let (turned, moved) = se3::difference(&actual(&start), &pose);
    let outside = beyond_limits(nominal, &joints);
    Command {
        nominal: start,
        joints,
        position_error,
        orientation_error,
        uncompensated: (moved, turned),
        outside,
        steps,
        keeps_configuration,
    }
}

/// Joint values at which the nominal robot has a pose, and whether they keep the configuration of `near`.
///
/// First the straight path of the tip from its pose at `near` is followed. If it is interrupted, all branches of inverse kinematics are
/// tried: the nearest within the limits that keeps the configuration, else the nearest within the limits, else any, else
/// the nearest miss.
fn nominal_solution(solver: &Solver, pose: &Pose, near: &[f64]) -> (Vec<f64>, bool) {
    let chain = solver.chain();
    let lever = lever(chain);
    if let Some(found) = followed(chain, pose, near, lever) {
        return (found, true);
    }
    let solutions = solver.solve(pose, near);
    let within = || solutions.iter().filter(|(_, found)| solutions.reached() && found.within_limits);
    if let Some((kept, _)) = within().find(|(joints, _)| regular_between(chain, near, joints, lever)) {
        return (kept.to_vec(), true);
    }
    if let Some((joints, _)) = within().next() {
        return (joints.to_vec(), false);
    }
    let found = solutions.iter().next().map_or_else(|| near.to_vec(), |(joints, _)| joints.to_vec());
    let found = if solutions.reached() {
        found
    } else {
        // Out of reach: the least error with this command's weights of place and direction.
        unwound(chain, newton(chain, &|q| chain.fk(q), pose, &found, lever).0, near)
    };
    let keeps = regular_between(chain, near, &found, lever);
    (found, keeps)
}

/// Parts of the straight way of the tip.
const PARTS_OF_THE_WAY: u32 = 32;
/// A joint that turns by more within one part, rad, has jumped to another configuration.
const JUMP: f64 = 0.5;

/// The joint values at the end of the tip's straight path from its pose at `near`; `None` if the path leaves the workspace, jumps, or
/// ends outside the limits.
fn followed(chain: &Chain, pose: &Pose, near: &[f64], lever: f64) -> Option<Vec<f64>> {
    let from = chain.fk(near);
    let turn = se3::rotation_vector(&(pose.rotation * from.rotation.inverse()));
    let shift = pose.translation.vector - from.translation.vector;
    let mut q = near.to_vec();
    for part in 1..=PARTS_OF_THE_WAY {
        let share = f64::from(part) / f64::from(PARTS_OF_THE_WAY);
        let rotation = Rotation3::new(turn * share) * from.rotation;
        let wanted =
            if part == PARTS_OF_THE_WAY { *pose } else { se3::pose(rotation, from.translation.vector + shift * share) };
        let (found, _) = newton(chain, &|q| chain.fk(q), &wanted, &q, lever);
        let jumps =
            chain.coordinates().iter().zip(found.iter().zip(&q)).any(|(coordinate, (now, before))| {
                coordinate.quantity == Quantity::Angle && (now - before).abs() > JUMP
            });
        if jumps || error(&chain.fk(&found), &wanted, lever).norm() >= REACHED {
            return None;
        }
        q = found;
    }
    let found = unwound(chain, q, near);
    beyond_limits(chain, &found).is_empty().then_some(found)
}

/// Points between two sets of joint values at which singularities are checked.
const POINTS_BETWEEN: u32 = 256;
/// Smallest over largest singular value of the Jacobian at a singularity.
const SINGULAR: f64 = 1e-2;
/// The determinant, as a share of its largest on the way, below which two singularities may be passed at once: a product of
/// two that go through zero together keeps its sign.
const TWICE_SINGULAR: f64 = 1e-3;

/// Whether the straight way between two sets of joint values passes no singularity: with six coordinates the Jacobian's
/// determinant keeps its sign and stays away from zero, with others its smallest singular value does.
fn regular_between(chain: &Chain, from: &[f64], to: &[f64], lever: f64) -> bool {
    let n = chain.coordinates().len();
    let mut columns = vec![Vector6::zeros(); n];
    let (mut sign, mut least, mut most) = (0.0, f64::INFINITY, 0.0f64);
    for point in 0..=POINTS_BETWEEN {
        let share = f64::from(point) / f64::from(POINTS_BETWEEN);
        let q: Vec<f64> = from.iter().zip(to).map(|(from, to)| from + share * (to - from)).collect();
        let jacobian = jacobian(chain, &q, &mut columns, lever);
        if n == 6 {
            let now = jacobian.determinant();
            if now * sign < 0.0 {
                return false;
            }
            if now != 0.0 {
                sign = now.signum();
            }
            (least, most) = (least.min(now.abs()), most.max(now.abs()));
        } else {
            let values = jacobian.singular_values();
            if values.min() < SINGULAR * values.max() {
                return false;
            }
        }
    }
    n != 6 || least > TWICE_SINGULAR * most
}

/// The tip's Jacobian, m and rad times lever.
fn jacobian(chain: &Chain, q: &[f64], columns: &mut [Vector6<f64>], lever: f64) -> DMatrix<f64> {
    chain.tip_jacobian_into(q, columns);
    DMatrix::from_fn(6, columns.len(), |i, k| columns[k][i] * if i < 3 { lever } else { 1.0 })
}

/// The same angles with whole turns taken off: within the limits if that can be, and there nearest to `near`.
///
/// A coordinate of a joint that is not revolute, or turns by a ratio other than 1, is not changed.
fn unwound(chain: &Chain, mut q: Vec<f64>, near: &[f64]) -> Vec<f64> {
    for (index, coordinate) in chain.coordinates().iter().enumerate() {
        let mut moved = chain.joints().iter().filter(|joint| joint.coordinate == index);
        if !moved.all(|joint| matches!(joint.screw, Screw::Revolute(_)) && joint.scale.abs() == 1.0) {
            continue;
        }
        let nearest = q[index] - TAU * ((q[index] - near[index]) / TAU).round();
        let (lower, upper) = coordinate.range();
        let within = |value: &f64| coordinate.limits.range.is_none() || (lower..=upper).contains(value);
        let others = (1..=4).flat_map(|turns| [nearest + TAU * f64::from(turns), nearest - TAU * f64::from(turns)]);
        q[index] = std::iter::once(nearest).chain(others).find(within).unwrap_or(nearest);
    }
    q
}

/// Names of the coordinates that are outside of their limits.
pub fn beyond_limits(chain: &Chain, q: &[f64]) -> Vec<String> {
    let beyond = |(coordinate, value): (&denavit_model::Coordinate, &f64)| {
        let (lower, upper) = coordinate.range();
        (coordinate.limits.range.is_some() && (*value < lower || *value > upper)).then(|| coordinate.name.clone())
    };
    chain.coordinates().iter().zip(q).filter_map(beyond).collect()
}

fn lever(chain: &Chain) -> f64 {
    let share = if chain.coordinates().len() < 6 { LEVER_OF_FEW } else { LEVER };
    share * chain.size()
}

/// The error to the wanted pose: rotation vector times lever, then translation; base frame, m.
fn error(reached: &Pose, wanted: &Pose, lever: f64) -> Vector6<f64> {
    let turn = se3::rotation_vector(&(wanted.rotation * reached.rotation.inverse())) * (lever);
    let shift = wanted.translation.vector - reached.translation.vector;
    Vector6::new(turn.x, turn.y, turn.z, shift.x, shift.y, shift.z)
}

/// Damped Newton steps from `start` until the error does not fall any more.
fn newton(chain: &Chain, fk: &dyn Fn(&[f64]) -> Pose, wanted: &Pose, start: &[f64], lever: f64) -> (Vec<f64>, usize) {
    let n = chain.coordinates().len();
    let mut q = start.to_vec();
    let mut columns = vec![Vector6::zeros(); n];
    let mut left = error(&fk(&q), wanted, lever);
    let mut damping = 1e-9;
    for step in 0..MOST_STEPS {
        let jacobian = jacobian(chain, &q, &mut columns, lever);
        let gradient = jacobian.transpose() * DVector::from_column_slice(left.as_slice());
        let normal = jacobian.transpose() * &jacobian;
        let largest = normal.diagonal().max().max(f64::MIN_POSITIVE);
        let mut improved = false;
        for _ in 0..10 {
            let mut damped = normal.clone();
            for i in 0..n {
                damped[(i, i)] += damping * largest;
            }
            let Some(factor) = damped.cholesky() else {
                damping *= 10.0;
                continue;
            };
            let delta = factor.solve(&gradient);
            let trial: Vec<f64> = q.iter().zip(delta.iter()).map(|(value, delta)| value + delta).collect();
            let now = error(&fk(&trial), wanted, lever);
            if now.norm() < left.norm() {
                let gained = left.norm() - now.norm();
                improved = gained > 1e-16 * chain.size() && gained > 1e-9 * left.norm();
                q = trial;
                left = now;
                damping = (damping * 0.1).max(1e-12);
                break;
            }
            damping *= 10.0;
        }
        if !improved {
            return (q, step + 1);
        }
    }
    (q, MOST_STEPS)
}
