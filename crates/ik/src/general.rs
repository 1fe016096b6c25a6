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
//! joint 3, whose real eigenvalues are the solutions. Eight of its 24 are ±i whatever the arm. Any joint may be the first ([`Order`]).
//!
//! # Source
//! Raghavan, Roth 1993 (the fourteen equations); Manocha, Canny 1994 (the eigenvalue problem).

use crate::arm::{Axis, SixR, turn_between};
use crate::circles::{Few, on_line, turned_dot};
use crate::eigenvalues::eigenvalues;
use denavit_model::nalgebra::{Complex, ComplexField, FullPivLU, Matrix3, SMatrix, SVector, U12, Vector3};
use denavit_model::{Pose, se3};
use std::f64::consts::TAU;

type Line = SVector<f64, 15>;
type Motion = SMatrix<f64, 15, 15>;
type Square = SMatrix<f64, 12, 12>;

/// Angles at which the half-angle tangents of joints 3, 4 and 5 are infinite lie away from the round angles of drawings.
const SHIFTS: [f64; 3] = [0.613, -0.377, 0.841];

/// Other zeros of joint 3, rad: a third of a turn apart.
const TURNS: [f64; 2] = [TAU / 3.0, -TAU / 3.0];

/// Eigenvalues lose as many digits as the quadratic part's pivots span: three of sixteen are no loss.
pub(crate) const REGULAR: f64 = 1e-3;

/// The same where the equations are dependent to rounding.
pub(crate) const INDEPENDENT: f64 = 1e-5;

/// Sixteen eigenvalues, with two values of joint 2 each.
const MOST: usize = 32;

/// Largest imaginary part (of a half-angle tangent, as a fraction of its size) of a solution that rounding or a near
/// singularity has made complex.
const NEARLY_REAL: f64 = 2e-2;

/// The part that does not depend on the target.
#[derive(Debug, Clone)]
pub(crate) struct Elimination {
    arm: SixR,
    /// For each of 1, cos, sin of joint 3: the fourteen equations' coefficients of the products of joints 4 and 5.
    left: [SMatrix<f64, 14, 9>; 3],
    order: Order,
}

/// The result of an elimination for a pose.
#[derive(Debug, Clone)]
pub(crate) struct Candidates {
    /// Joint values, rad.
    pub joints: Few<[f64; 6], MOST>,
    /// Real eigenvalues, of which each is a solution; [`MOST`] where there are no eigenvalues.
    pub real: usize,
    /// The last pivot of the quadratic part as a share of the first: near 0 where the equations are dependent.
    pub regular: f64,
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

/// The parts of 1, cos and sin of a turn about an axis through the origin by ±angle (`sense`).
fn about_origin(u: &Vector3<f64>, sense: f64) -> [Motion; 3] {
    let along = u * u.transpose();
    [linear(&along, 1.0), linear(&(Matrix3::identity() - along), 0.0), linear(&(se3::skew(u) * sense), 0.0)]
}

/// A line turned about an axis by angle - shift: the parts of 1, cos and sin of the angle.
fn turned(axis: &Axis, shift: f64, line: &Line) -> [Line; 3] {
    let [constant, cosine, sine] = parts(axis, 1.0, line);
    let (s, c) = shift.sin_cos();
    [constant, cosine * c - sine * s, sine * c + cosine * s]
}

/// A line turned about an axis by ±angle (`sense`): the parts of 1, cos and sin of the angle.
fn parts(axis: &Axis, sense: f64, line: &Line) -> [Line; 3] {
    let there = translation(&axis.point);
    let at_origin = translation(&-axis.point) * line;
    about_origin(&axis.direction, sense).map(|part| there * (part * at_origin))
}

/// At which joint the loop of six joints is opened: which three stay on the left.
///
/// e1 ··· e6 = D is also (D e6 D⁻¹) e1 ··· e5 = D, and e6⁻¹ ··· e1⁻¹ = D⁻¹: any joint may be the first, in either order. Two
/// parallel neighbours make the equations of some orders dependent, not those of others.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Order {
    /// From the tip to the base.
    reversed: bool,
    /// This many joints of the end come first. The left side depends on the pose for more than two.
    moved: usize,
}

impl Order {
    pub const ALL: [Self; 6] = [
        Self { reversed: false, moved: 0 },
        Self { reversed: false, moved: 1 },
        Self { reversed: false, moved: 2 },
        Self { reversed: true, moved: 0 },
        Self { reversed: true, moved: 1 },
        Self { reversed: true, moved: 2 },
    ];

    /// Axes and D in this order.
    fn seen(self, axes: &[Axis; 6], displacement: &Pose) -> ([Axis; 6], Pose) {
        let (mut axes, mut displacement) = (*axes, *displacement);
        if self.reversed {
            axes.reverse();
            displacement = displacement.inverse();
        }
        axes.rotate_right(self.moved);
        for axis in &mut axes[..self.moved] {
            axis.direction = displacement.rotation * axis.direction;
            axis.point = displacement.rotation * axis.point + displacement.translation.vector;
        }
        (axes, displacement)
    }

    /// Joint values of this order as those of the arm.
    fn restored(self, mut values: [f64; 6]) -> [f64; 6] {
        values.rotate_left(self.moved);
        if self.reversed {
            values.reverse();
            values = values.map(|value| -value);
        }
        values
    }
}

impl Elimination {
    pub fn of(arm: &SixR, size: f64, order: Order) -> Self {
        // Lengths in units of the arm, so that equations of different degree are alike.
        let mut scaled = arm.clone();
        for axis in &mut scaled.axes {
            axis.point /= size;
        }
        scaled.home.translation.vector /= size;
        let ([_, _, three, four, five, six], _) = order.seen(&scaled.axes, &Pose::identity());
        let mut left = [SMatrix::<f64, 14, 9>::zeros(); 3];
        for (k, line) in turned(&five, SHIFTS[2], &line(&six.point, &six.direction)).iter().enumerate() {
            for (j, line) in turned(&four, SHIFTS[1], line).iter().enumerate() {
                for (left, line) in left.iter_mut().zip(turned(&three, SHIFTS[0], line)) {
                    left.set_column(3 * j + k, &line.fixed_rows::<14>(1));
                }
            }
        }
        Self { left, order, arm: scaled }
    }

    /// Candidates for all real solutions of a pose.
    pub fn solve(&self, target: &Pose, size: f64) -> Candidates {
        let mut found = Candidates { joints: Few::new([0.0; 6]), real: MOST, regular: 0.0 };
        let mut moved = *target;
        moved.translation.vector /= size;
        let (axes, moved) = self.order.seen(&self.arm.axes, &(moved * self.arm.home.inverse()));
        let pencil = self.pencil(&axes, &moved);
        let Some(eigenvalues) = pencil.eigenvalues() else { return found };
        for eigenvalue in eigenvalues.iter() {
            let t = eigenvalue.re;
            if eigenvalue.im.abs() > NEARLY_REAL * (1.0 + t.abs()) || eigenvalue.im < 0.0 {
                continue;
            }
            let Some((x, y)) = tangents(&pencil.at(t)) else { continue };
            let v3 = 2.0 * t.atan() - SHIFTS[0] - pencil.turn;
            let v4 = 2.0 * x.atan() - SHIFTS[1];
            let v5 = 2.0 * y.atan() - SHIFTS[2];
            others(&axes, &moved, [v3, v4, v5], |v1, v2, v6| {
                found.joints.push(self.order.restored([v1, v2, v3, v4, v5, v6]));
            });
        }
        found.real = eigenvalues.iter().filter(|eigenvalue| eigenvalue.im == 0.0).count();
        found.regular = pencil.regular;
        found
    }

    /// With joint 3 counted from the first zero without a solution near t = ∞, or from that farthest from one.
    fn pencil(&self, axes: &[Axis; 6], moved: &Pose) -> Pencil {
        let equations = self.six_equations(axes, moved).map(|rows| in_tangents(&rows));
        let mut best = Pencil::of(&equations, 0.0);
        for turn in TURNS {
            if best.regular > REGULAR {
                break;
            }
            let other = Pencil::of(&equations, turn);
            if other.regular > best.regular {
                best = other;
            }
        }
        best
    }

    /// The equations that are left when joints 1 and 2 are removed: for each of 1, cos, sin of joint 3, the coefficients of the
    /// products of joints 4 and 5.
    fn six_equations(&self, axes: &[Axis; 6], moved: &Pose) -> [SMatrix<f64, 6, 9>; 3] {
        let [one, two, .., six] = axes;
        let end = line(&(moved.rotation * six.point + moved.translation.vector), &(moved.rotation * six.direction));
        // right · (products of joints 1 and 2, without 1) = left3 · (products of joints 4 and 5) - constant.
        let mut right = SMatrix::<f64, 14, 8>::zeros();
        let mut left = self.left;
        for (k, line) in parts(one, -1.0, &end).iter().enumerate() {
            for (j, line) in parts(two, -1.0, line).iter().enumerate() {
                let column = line.fixed_rows::<14>(1);
                if j + k == 0 {
                    let constant = left[0].column(0) - column;
                    left[0].set_column(0, &constant);
                } else {
                    right.set_column(3 * j + k - 1, &column);
                }
            }
        }
        eliminate(&mut right, &mut left);
        left.map(|part| part.fixed_rows::<6>(8).into_owned())
    }
}

/// A 12 × 12 matrix polynomial of second degree in the half-angle tangent t of joint 3, singular at the solutions.
struct Pencil {
    /// The coefficients of 1, t and t².
    zeroth: Square,
    linear: Square,
    quadratic: Square,
    /// Of the quadratic part, with complete pivoting: its last pivot is this share of its first.
    factors: FullPivLU<f64, U12, U12>,
    regular: f64,
    /// Its angle is that of joint 3 and this more, rad.
    turn: f64,
}

impl Pencil {
    fn of(equations: &[SMatrix<f64, 6, 9>; 3], turn: f64) -> Self {
        let [constant, cosine, sine] = equations;
        let (s, c) = turn.sin_cos();
        let (cosine, sine) = (cosine * c - sine * s, cosine * s + sine * c);
        // (1 + t²) constant + (1 - t²) cosine + 2 t sine.
        let quadratic = doubled(&(constant - cosine));
        let factors = quadratic.full_piv_lu();
        let pivots = factors.u().diagonal().abs();
        Self {
            zeroth: doubled(&(constant + cosine)),
            linear: doubled(&(sine * 2.0)),
            quadratic,
            regular: pivots[11] / pivots[0],
            factors,
            turn,
        }
    }

    fn at(&self, t: f64) -> Square {
        self.zeroth + self.linear * t + self.quadratic * (t * t)
    }

    /// The sixteen eigenvalues; `None` of a singular pencil.
    ///
    /// Of the 24 eigenvalues of the companion matrix four are i and four -i whatever the arm, from the factor (1 + t²)⁴: their
    /// invariant subspace is that of the null vectors n of the polynomial at t = i, (n, i n). A basis of it and of its complement makes
    /// the companion matrix block triangular; the block of the complement has the others.
    fn eigenvalues(&self) -> Option<SVector<Complex<f64>, 16>> {
        let inverse = self.factors.try_inverse()?;
        let mut companion = SMatrix::<f64, 24, 24>::zeros();
        companion.fixed_view_mut::<12, 12>(0, 12).fill_with_identity();
        companion.fixed_view_mut::<12, 12>(12, 0).copy_from(&(-(inverse * self.zeroth)));
        companion.fixed_view_mut::<12, 12>(12, 12).copy_from(&(-(inverse * self.linear)));
        let at_i = (self.zeroth - self.quadratic).zip_map(&self.linear, Complex::new);
        let null = null_vectors::<_, 8, 4>(&at_i)?;
        let (re, im) = (null.map(|x| x.re), null.map(|x| x.im));
        let mut subspace = SMatrix::<f64, 24, 8>::zeros();
        subspace.fixed_view_mut::<12, 4>(0, 0).copy_from(&re);
        subspace.fixed_view_mut::<12, 4>(12, 0).copy_from(&-im);
        subspace.fixed_view_mut::<12, 4>(0, 4).copy_from(&im);
        subspace.fixed_view_mut::<12, 4>(12, 4).copy_from(&re);
        let rotation = subspace.qr();
        // Qᵀ C Q = Qᵀ (Qᵀ Cᵀ)ᵀ.
        let mut block = companion.transpose();
        rotation.q_tr_mul(&mut block);
        block.transpose_mut();
        rotation.q_tr_mul(&mut block);
        let block: SMatrix<f64, 16, 16> = block.fixed_view::<16, 16>(8, 8).into_owned();
        eigenvalues(&block)
    }
}

/// Six equations in x^a y^b, a and b to 2, and the same times x: twelve equations in a to 3.
fn doubled(rows: &SMatrix<f64, 6, 9>) -> Square {
    let mut square = Square::zeros();
    square.fixed_view_mut::<6, 9>(0, 0).copy_from(rows);
    square.fixed_view_mut::<6, 9>(6, 3).copy_from(rows);
    square
}

/// Joints 1, 2 and 6 from the other three.
fn others(axes: &[Axis; 6], moved: &Pose, [v3, v4, v5]: [f64; 3], mut add: impl FnMut(f64, f64, f64)) {
    let [one, two, three, four, five, six] = axes;
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
        let squares =
            (p - one.point).norm_squared() - (two.point - one.point).norm_squared() - (q - two.point).norm_squared();
        on_line(a * 2.0, squares - 2.0 * constant, 1.0)
    } else {
        line
    };
    let across = if six.direction.x.abs() < 0.7 { Vector3::x() } else { Vector3::y() };
    let across = six.direction.cross(&across);
    let of = |v2: f64| {
        let second = two.motion(v2);
        let (placed, turned) = (second.rotation * q + second.translation.vector, second.rotation * m);
        // Whichever of the point and the direction lies farther off axis 1 shows its angle better.
        let off = |x: &Vector3<f64>| one.direction.cross(x).norm();
        let v1 = if off(&(placed - one.point)) > off(&turned) {
            turn_between(&one.direction, &(placed - one.point), &(p - one.point))
        } else {
            turn_between(&one.direction, &turned, &l)
        };
        let both = one.motion(v1.value) * second;
        let misses = (both.rotation * q + both.translation.vector - p).norm() + (both.rotation * m - l).norm();
        let rest = (both * carried).rotation.inverse() * moved.rotation;
        (misses, [v1.value, v2, turn_between(&six.direction, &across, &(rest * across)).value])
    };
    let mut candidates = Few::<(f64, [f64; 3]), 2>::new((0.0, [0.0; 3]));
    for v2 in line.as_slice() {
        candidates.push(of(v2.value));
    }
    // One equation gives two values of joint 2; the other equations hold for one of them.
    let least = candidates.as_slice().iter().map(|(misses, _)| *misses).fold(f64::INFINITY, f64::min);
    for (misses, [v1, v2, v6]) in candidates.as_slice() {
        if *misses <= least.max(NEARLY_REAL) {
            add(*v1, *v2, *v6);
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

/// The null vectors of a matrix of that rank, as many as its twelve columns have more.
fn null_vectors<T: ComplexField, const RANK: usize, const COUNT: usize>(
    matrix: &SMatrix<T, 12, 12>,
) -> Option<SMatrix<T, 12, COUNT>> {
    // Complete pivoting brings the nearly zero pivots to the end: U v = 0 but for them.
    let factors = matrix.clone().full_piv_lu();
    let upper = factors.u();
    let right = -upper.fixed_view::<RANK, COUNT>(0, RANK);
    let dependent = upper.fixed_view::<RANK, RANK>(0, 0).solve_upper_triangular(&right)?;
    let mut null = SMatrix::<T, 12, COUNT>::zeros();
    null.fixed_view_mut::<RANK, COUNT>(0, 0).copy_from(&dependent);
    null.fixed_view_mut::<COUNT, COUNT>(RANK, 0).fill_with_identity();
    factors.q().inv_permute_rows(&mut null);
    Some(null)
}

/// x and y from the null vector of the 12 × 12 matrix, whose entries are x^a y^b (a to 3, b to 2).
fn tangents(matrix: &Square) -> Option<(f64, f64)> {
    let v = null_vectors::<_, 11, 1>(matrix)?;
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

    fn weights(angle: f64) -> [f64; 3] {
        [1.0, angle.cos(), angle.sin()]
    }

    fn products(one: f64, other: f64) -> SVector<f64, 9> {
        SVector::from_fn(|k, _| weights(one)[k / 3] * weights(other)[k % 3])
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
            let elimination = Elimination::of(&arm, 1.0, Order::ALL[0]);
            let moved = arm.fk(&q);
            let six = &arm.axes[5];
            let end = line(&(moved.rotation * six.point + moved.translation.vector), &(moved.rotation * six.direction));
            let [v3, v4, v5] = [q[2] + SHIFTS[0], q[3] + SHIFTS[1], q[4] + SHIFTS[2]];
            let left = (elimination.left[0] + elimination.left[1] * v3.cos() + elimination.left[2] * v3.sin()) * products(v4, v5);
            let [one, two, ..] = &arm.axes;
            let mut right = SVector::<f64, 14>::zeros();
            for (first, of_one) in parts(one, -1.0, &end).iter().zip(weights(q[0])) {
                for (second, of_two) in parts(two, -1.0, first).iter().zip(weights(q[1])) {
                    right += second.fixed_rows::<14>(1) * (of_one * of_two);
                }
            }
            prop_assert!((left - right).amax() < 1e-12 * (1.0 + right.amax()));
        }
    }
}
