//! Any arm with six revolute joints: all real solutions by elimination, at most sixteen.
//!
//! e3 e4 e5 (p6, u6) = e2⁻¹ e1⁻¹ D (p6, u6), p6 a point and u6 the direction of axis 6, which joint 6 does not move, and
//! D = target · home⁻¹. Of a point p and a direction l the fifteen numbers
//!
//! ```text
//! (1, p, l, p·p, p·l, p × l, (p·p) l - 2 (p·l) p)
//! ```
//! change linearly under a rigid motion, and a turn about an axis is linear in 1, cos and sin of its angle. Both sides are then
//! linear in the nine products of (1, cos, sin) of two angles: fourteen equations. Eight serve to remove joints 1 and 2; the
//! other six, with the half-angle tangents of joints 4 and 5, make a 12 × 12 matrix polynomial of second degree in that of
//! joint 3, whose real eigenvalues are the solutions.
//!
//! # Source
//! Raghavan, Roth 1993 (the fourteen equations); Manocha, Canny 1994 (the eigenvalue problem).

use crate::arm::{Axis, SixR, turn_between};
use crate::circles::{Few, on_line, turned_dot};
use denavit_model::nalgebra::{Matrix3, SMatrix, SVector, Vector3};
use denavit_model::{Pose, se3};

type Line = SVector<f64, 15>;
type Motion = SMatrix<f64, 15, 15>;

/// Angles at which the half-angle tangents of joints 3, 4 and 5 are infinite lie away from the round angles of drawings.
const SHIFTS: [f64; 3] = [0.613, -0.377, 0.841];

/// Largest imaginary part (of a half-angle tangent, as a share of its size) of a solution that rounding or a near
/// singularity has made complex.
const NEARLY_REAL: f64 = 2e-2;

/// Sweeps of the QR algorithm: some two for each eigenvalue are usual.
const MOST_SWEEPS: usize = 24 * 30;

/// What does not depend on the target.
#[derive(Debug, Clone)]
pub(crate) struct Elimination {
    arm: SixR,
    /// For each of 1, cos, sin of joint 3: the fourteen equations' coefficients of the products of joints 4 and 5.
    left: [SMatrix<f64, 14, 9>; 3],
    /// Of a turn by minus the angle of joints 1 and 2: the parts of 1, cos, sin.
    first: [Motion; 3],
    second: [Motion; 3],
}

/// The fifteen numbers of a point and a direction.
fn line(p: &Vector3<f64>, l: &Vector3<f64>) -> Line {
    let (square, along, moment) = (p.norm_squared(), p.dot(l), p.cross(l));
    let last = l * square - p * (2.0 * along);
    let mut line = Line::zeros();
    line[0] = 1.0;
    line.fixed_rows_mut::<3>(1).copy_from(p);
    line.fixed_rows_mut::<3>(4).copy_from(l);
    line[7] = square;
    line[8] = along;
    line.fixed_rows_mut::<3>(9).copy_from(&moment);
    line.fixed_rows_mut::<3>(12).copy_from(&last);
    line
}

/// A linear map of the vectors, `scalars` on the numbers that a rotation keeps.
fn linear(map: &Matrix3<f64>, scalars: f64) -> Motion {
    let mut motion = Motion::zeros();
    for k in [0, 7, 8] {
        motion[(k, k)] = scalars;
    }
    for k in [1, 4, 9, 12] {
        motion.fixed_view_mut::<3, 3>(k, k).copy_from(map);
    }
    motion
}

/// A translation t: p + t, l, p·p + 2 t·p + t², p·l + t·l, m + t × l, n - 2 t × m + t² l - 2 (p·l) t - 2 (t·l) t.
fn translation(t: &Vector3<f64>) -> Motion {
    let mut motion = Motion::identity();
    motion.fixed_view_mut::<3, 1>(1, 0).copy_from(t);
    motion[(7, 0)] = t.norm_squared();
    motion.fixed_view_mut::<1, 3>(7, 1).copy_from(&(2.0 * t.transpose()));
    motion.fixed_view_mut::<1, 3>(8, 4).copy_from(&t.transpose());
    motion.fixed_view_mut::<3, 3>(9, 4).copy_from(&se3::skew(t));
    motion.fixed_view_mut::<3, 3>(12, 9).copy_from(&(-2.0 * se3::skew(t)));
    motion.fixed_view_mut::<3, 3>(12, 4).copy_from(&(Matrix3::identity() * t.norm_squared() - 2.0 * t * t.transpose()));
    motion.fixed_view_mut::<3, 1>(12, 8).copy_from(&(-2.0 * t));
    motion
}

/// A turn about an axis by sense · (angle - shift): the parts of 1, cos and sin of the angle.
fn turn(axis: &Axis, sense: f64, shift: f64) -> [Motion; 3] {
    let u = axis.direction;
    let along = u * u.transpose();
    let (there, back) = (translation(&axis.point), translation(&-axis.point));
    let [constant, cosine, sine] =
        [linear(&along, 1.0), linear(&(Matrix3::identity() - along), 0.0), linear(&(se3::skew(&u) * sense), 0.0)]
            .map(|part| there * part * back);
    let (s, c) = shift.sin_cos();
    [constant, cosine * c - sine * s, sine * c + cosine * s]
}

impl Elimination {
    pub fn of(arm: &SixR, size: f64) -> Self {
        // Lengths in units of the arm, so that equations of different degree are alike.
        let mut scaled = arm.clone();
        for axis in &mut scaled.axes {
            axis.point /= size;
        }
        scaled.home.translation.vector /= size;
        let [one, two, three, four, five, six] = &scaled.axes;
        let third = turn(three, 1.0, SHIFTS[0]);
        let fourth = turn(four, 1.0, SHIFTS[1]);
        let fifth = turn(five, 1.0, SHIFTS[2]);
        let start = line(&six.point, &six.direction);
        let mut left = [SMatrix::<f64, 14, 9>::zeros(); 3];
        for (left, third) in left.iter_mut().zip(&third) {
            for (j, fourth) in fourth.iter().enumerate() {
                for (k, fifth) in fifth.iter().enumerate() {
                    let column = third * (fourth * (fifth * start));
                    left.set_column(3 * j + k, &column.fixed_rows::<14>(1));
                }
            }
        }
        let (first, second) = (turn(one, -1.0, 0.0), turn(two, -1.0, 0.0));
        Self { left, first, second, arm: scaled }
    }

    /// Candidates for all real solutions, joint values in rad; `target` with lengths in units of the arm.
    pub fn solve(&self, target: &Pose, size: f64) -> Few<[f64; 6], 24> {
        let mut found = Few::new([0.0; 6]);
        let mut moved = *target;
        moved.translation.vector /= size;
        let moved = moved * self.arm.home.inverse();
        let six = &self.arm.axes[5];
        let end = line(&(moved.rotation * six.point + moved.translation.vector), &(moved.rotation * six.direction));
        // right · (products of joints 1 and 2, without 1) = left3 · (products of joints 4 and 5) - constant.
        let mut right = SMatrix::<f64, 14, 8>::zeros();
        let mut left = self.left;
        for (j, second) in self.second.iter().enumerate() {
            for (k, first) in self.first.iter().enumerate() {
                let column = second * (first * end);
                let column = column.fixed_rows::<14>(1);
                if j + k == 0 {
                    let constant = left[0].column(0) - column;
                    left[0].set_column(0, &constant);
                } else {
                    right.set_column(3 * j + k - 1, &column);
                }
            }
        }
        eliminate(&mut right, &mut left);
        // Six equations in the products of joints 4 and 5; tangents x, y of their half angles in place of cos and sin.
        let six_rows = |part: usize| left[part].fixed_rows::<6>(8).into_owned();
        let [constant, cosine, sine] = [six_rows(0), six_rows(1), six_rows(2)].map(|rows| in_tangents(&rows));
        // (1 + t²) constant + (1 - t²) cosine + 2 t sine.
        let doubled = |rows: SMatrix<f64, 6, 9>| {
            let mut square = SMatrix::<f64, 12, 12>::zeros();
            square.fixed_view_mut::<6, 9>(0, 0).copy_from(&rows);
            square.fixed_view_mut::<6, 9>(6, 3).copy_from(&rows);
            square
        };
        let (zeroth, linear, quadratic) = (doubled(constant + cosine), doubled(sine * 2.0), doubled(constant - cosine));
        let Some(inverse) = quadratic.full_piv_lu().try_inverse() else { return found };
        let mut companion = SMatrix::<f64, 24, 24>::zeros();
        companion.fixed_view_mut::<12, 12>(0, 12).fill_with_identity();
        companion.fixed_view_mut::<12, 12>(12, 0).copy_from(&(-(inverse * zeroth)));
        companion.fixed_view_mut::<12, 12>(12, 12).copy_from(&(-(inverse * linear)));
        if !companion.iter().all(|x| x.is_finite()) {
            return found;
        }
        let Some(schur) = companion.try_schur(f64::EPSILON, MOST_SWEEPS) else { return found };
        for eigenvalue in schur.complex_eigenvalues().iter() {
            let t = eigenvalue.re;
            if eigenvalue.im.abs() > NEARLY_REAL * (1.0 + t.abs()) || eigenvalue.im < 0.0 {
                continue;
            }
            let matrix = zeroth + linear * t + quadratic * (t * t);
            let Some((x, y)) = tangents(&matrix) else { continue };
            let v3 = 2.0 * t.atan() - SHIFTS[0];
            let v4 = 2.0 * x.atan() - SHIFTS[1];
            let v5 = 2.0 * y.atan() - SHIFTS[2];
            self.others(&moved, [v3, v4, v5], |v1, v2, v6| found.push([v1, v2, v3, v4, v5, v6]));
        }
        found
    }

    /// Joints 1, 2 and 6 from the other three.
    fn others(&self, moved: &Pose, [v3, v4, v5]: [f64; 3], mut add: impl FnMut(f64, f64, f64)) {
        let [one, two, three, four, five, six] = &self.arm.axes;
        let carried = three.motion(v3) * four.motion(v4) * five.motion(v5);
        // e1 e2 takes (q, m) to (p, l): joint 2 by what joint 1 keeps of p and l, the better conditioned of the two.
        let (q, m) = (carried.rotation * six.point + carried.translation.vector, carried.rotation * six.direction);
        let (p, l) = (moved.rotation * six.point + moved.translation.vector, moved.rotation * six.direction);
        let (of_m, m0) = turned_dot(&two.direction, &one.direction, &m);
        let (of_q, q0) = turned_dot(&two.direction, &one.direction, &(q - two.point));
        let height = one.direction.dot(&(p - two.point));
        let line = if of_m.norm_squared() >= of_q.norm_squared() {
            on_line(of_m, one.direction.dot(&l) - m0, 1.0)
        } else {
            on_line(of_q, height - q0, 1.0)
        };
        // Where axes 1 and 2 are parallel neither tells joint 2: then the distance of p from axis 1 does.
        let line = if of_m.norm().max(of_q.norm()) < 1e-6 {
            let (a, constant) = turned_dot(&two.direction, &(two.point - one.point), &(q - two.point));
            let squares = (p - one.point).norm_squared()
                - (two.point - one.point).norm_squared()
                - (q - two.point).norm_squared();
            on_line(a * 2.0, squares - 2.0 * constant, 1.0)
        } else {
            line
        };
        let across = if six.direction.x.abs() < 0.7 { Vector3::x() } else { Vector3::y() };
        let across = six.direction.cross(&across);
        for v2 in line.as_slice() {
            let second = two.motion(v2.value);
            let (placed, turned) = (second.rotation * q + second.translation.vector, second.rotation * m);
            // Whichever of the point and the direction lies farther off axis 1 shows its angle better.
            let off = |x: &Vector3<f64>| one.direction.cross(x).norm();
            let v1 = if off(&(placed - one.point)) > off(&turned) {
                turn_between(&one.direction, &(placed - one.point), &(p - one.point))
            } else {
                turn_between(&one.direction, &turned, &l)
            };
            let rest = (one.motion(v1.value) * second * carried).rotation.inverse() * moved.rotation;
            add(v1.value, v2.value, turn_between(&six.direction, &across, &(rest * across)).value);
        }
    }
}

/// Gaussian elimination of the eight products of joints 1 and 2 with complete pivoting, done to the left side as well: the last
/// six rows no longer hold them.
fn eliminate(right: &mut SMatrix<f64, 14, 8>, left: &mut [SMatrix<f64, 14, 9>; 3]) {
    for step in 0..8 {
        let (mut at, mut largest) = ((step, step), 0.0);
        for column in step..8 {
            for row in step..14 {
                let size = right[(row, column)].abs();
                if size > largest {
                    (at, largest) = ((row, column), size);
                }
            }
        }
        if largest < 1e-11 {
            // Dependent products: the rows that are left hold none of them.
            return;
        }
        right.swap_rows(step, at.0);
        right.swap_columns(step, at.1);
        for part in left.iter_mut() {
            part.swap_rows(step, at.0);
        }
        for row in step + 1..14 {
            let factor = right[(row, step)] / right[(step, step)];
            if factor == 0.0 {
                continue;
            }
            for column in step..8 {
                right[(row, column)] -= factor * right[(step, column)];
            }
            for part in left.iter_mut() {
                for column in 0..9 {
                    part[(row, column)] -= factor * part[(step, column)];
                }
            }
        }
    }
}

/// From products of (1, cos, sin) of joints 4 and 5 to products of (1, x, x²) and (1, y, y²), times (1 + x²)(1 + y²).
fn in_tangents(rows: &SMatrix<f64, 6, 9>) -> SMatrix<f64, 6, 9> {
    let mut result = SMatrix::zeros();
    for row in 0..6 {
        let mut half = [[0.0; 3]; 3];
        for (j, half) in half.iter_mut().enumerate() {
            let [one, cosine, sine] = [rows[(row, 3 * j)], rows[(row, 3 * j + 1)], rows[(row, 3 * j + 2)]];
            *half = [one + cosine, 2.0 * sine, one - cosine];
        }
        for b in 0..3 {
            let [one, cosine, sine] = [half[0][b], half[1][b], half[2][b]];
            result[(row, b)] = one + cosine;
            result[(row, 3 + b)] = 2.0 * sine;
            result[(row, 6 + b)] = one - cosine;
        }
    }
    result
}

/// x and y from the null vector of the 12 × 12 matrix, whose entries are x^a y^b (a to 3, b to 2).
fn tangents(matrix: &SMatrix<f64, 12, 12>) -> Option<(f64, f64)> {
    // Inverse iteration: two steps from a vector without preference.
    let lu = (matrix + SMatrix::<f64, 12, 12>::identity() * (1e-14 * matrix.amax())).full_piv_lu();
    let mut v = SVector::<f64, 12>::from_fn(|k, _| 1.0 + 0.1 * k as f64);
    for _ in 0..2 {
        v = lu.solve(&v)?;
        let size = v.amax();
        if !size.is_finite() || size == 0.0 {
            return None;
        }
        v /= size;
    }
    let ratio = |over: &dyn Fn(usize) -> usize, under: &[usize]| {
        let best =
            under.iter().copied().max_by(|a, b| v[*a].hypot(v[over(*a)]).total_cmp(&v[*b].hypot(v[over(*b)])))?;
        Some(v[over(best)] / v[best])
    };
    let x = ratio(&|k| k + 3, &[0, 1, 2, 3, 4, 5, 6, 7, 8])?;
    let y = ratio(&|k| k + 1, &[0, 1, 3, 4, 6, 7, 9, 10])?;
    (!x.is_nan() && !y.is_nan()).then_some((x, y))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn products(one: f64, other: f64) -> SVector<f64, 9> {
        let parts = |angle: f64| [1.0, angle.cos(), angle.sin()];
        SVector::from_fn(|k, _| parts(one)[k / 3] * parts(other)[k % 3])
    }

    proptest! {
        /// Both sides of the fourteen equations are the fifteen numbers of axis 6 as the joints carry it.
        #[test]
        fn the_equations_hold_at_every_posture(
            numbers in prop::collection::vec(-1.0..1.0f64, 36), q in prop::array::uniform6(-3.0..3.0f64),
        ) {
            let vector = |k: usize| Vector3::new(numbers[k], numbers[k + 1], numbers[k + 2]);
            prop_assume!((0..6).all(|k| vector(6 * k).norm() > 0.1));
            let axes: [Axis; 6] = std::array::from_fn(|k| {
                Axis { direction: vector(6 * k).normalize(), point: vector(6 * k + 3) }
            });
            let arm = SixR { axes, home: Pose::identity() };
            let elimination = Elimination::of(&arm, 1.0);
            let moved = arm.fk(&q);
            let six = &arm.axes[5];
            let end = line(&(moved.rotation * six.point + moved.translation.vector), &(moved.rotation * six.direction));
            let [v3, v4, v5] = [q[2] + SHIFTS[0], q[3] + SHIFTS[1], q[4] + SHIFTS[2]];
            let left = (elimination.left[0] + elimination.left[1] * v3.cos() + elimination.left[2] * v3.sin()) * products(v4, v5);
            let mut right = SVector::<f64, 14>::zeros();
            for (k, weight) in products(q[1], q[0]).iter().enumerate() {
                let column = elimination.second[k / 3] * (elimination.first[k % 3] * end);
                right += column.fixed_rows::<14>(1) * *weight;
            }
            prop_assert!((left - right).amax() < 1e-12 * (1.0 + right.amax()));
        }
    }
}
