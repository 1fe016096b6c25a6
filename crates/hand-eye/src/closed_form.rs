//! Closed forms of A R = L B, as starts for the fit and as a check of one against another.

use crate::Row;
use denavit_model::nalgebra::{DMatrix, Matrix3, Matrix4, Rotation3, SMatrix, SVector, Vector3, Vector4};
use denavit_model::{Pose, se3};

/// A closed form.
#[derive(Debug, Clone, Copy)]
pub struct Method {
    /// Who published it, and when.
    pub name: &'static str,
    /// `[left, right]`; `None` where the rows do not determine it.
    pub solve: fn(&[Row]) -> Option<[Pose; 2]>,
}

/// All that are tried.
pub const METHODS: [Method; 3] = [
    Method { name: "Park and Martin 1994", solve: park_martin },
    Method { name: "Daniilidis 1999", solve: daniilidis },
    Method { name: "Shah 2013", solve: shah },
];

/// Rotations below this do not determine an axis, rad.
const LEAST_TURN: f64 = 1e-3;
/// Rotations this close to half a turn have an axis of undefined sense, rad.
const MOST_TURN: f64 = 3.0;
/// Of many rows each is paired with this many others.
const PARTNERS: usize = 12;
/// A singular value below this share of the largest is 0.
const RANK: f64 = 1e-9;

/// Relative motions: (of the robot, of what is seen), which are conjugate: `A' R = R B'`.
fn motions(rows: &[Row]) -> impl Iterator<Item = (Pose, Pose)> {
    let n = rows.len();
    let steps: Vec<usize> =
        if n <= PARTNERS { (1..n).collect() } else { (1..=PARTNERS).map(|part| part * (n - 1) / PARTNERS).collect() };
    (0..n).flat_map(move |i| {
        let pairs: Vec<_> = steps.iter().map(|step| (i, (i + step) % n)).filter(|(i, j)| i != j).collect();
        pairs.into_iter().map(|(i, j)| (rows[i].moved.inverse() * rows[j].moved, rows[i].seen.inverse() * rows[j].seen))
    })
}

/// The nearest rotation R to R a ≈ b, from Σ b aᵀ.
fn procrustes(sum: &Matrix3<f64>) -> Option<Rotation3<f64>> {
    let svd = sum.svd(true, true);
    let (u, v_t) = (svd.u?, svd.v_t?);
    // Two directions make a rotation; the third follows.
    if svd.singular_values[1] <= RANK * svd.singular_values[0] {
        return None;
    }
    let sign = (u.determinant() * v_t.determinant()).signum();
    Some(Rotation3::from_matrix_unchecked(u * Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, sign)) * v_t))
}

/// The left part that goes with a right one: the mean over the rows.
pub fn left_of(rows: &[Row], right: &Pose) -> Option<Pose> {
    let each = rows.iter().map(|row| row.moved * right * row.seen.inverse());
    let (mut turn, mut place) = (Matrix3::zeros(), Vector3::zeros());
    for pose in each {
        turn += pose.rotation.matrix();
        place += pose.translation.vector;
    }
    Some(se3::pose(procrustes(&turn)?, place / rows.len() as f64))
}

/// F. C. Park, B. J. Martin, "Robot sensor calibration: solving AX = XB on the Euclidean group", IEEE T-RA 1994, eqs. (21)
/// and (24): rotation vectors of motions are turned into each other; then the translation by least squares.
fn park_martin(rows: &[Row]) -> Option<[Pose; 2]> {
    let mut sum = Matrix3::zeros();
    for (robot, seen) in motions(rows) {
        let turns = [&robot, &seen].map(|pose| se3::rotation_vector(&pose.rotation));
        if turns.iter().all(|turn| (LEAST_TURN..MOST_TURN).contains(&turn.norm())) {
            sum += turns[0] * turns[1].transpose();
        }
    }
    let rotation = procrustes(&sum)?;
    let (mut normal, mut side) = (Matrix3::zeros(), Vector3::zeros());
    for (robot, seen) in motions(rows) {
        let m = robot.rotation.matrix() - Matrix3::identity();
        normal += m.transpose() * m;
        side += m.transpose() * (rotation * seen.translation.vector - robot.translation.vector);
    }
    let place = normal.svd(true, true).solve(&side, RANK * normal.norm()).ok()?;
    let right = se3::pose(rotation, place);
    Some([left_of(rows, &right)?, right])
}

/// A unit dual quaternion of a pose, (w, x, y, z) each, its first w ≥ 0.
fn dual(pose: &Pose) -> (Vector4<f64>, Vector4<f64>) {
    let [x, y, z, w] = se3::quaternion_xyzw(&pose.rotation);
    let sign = if w < 0.0 { -1.0 } else { 1.0 };
    let q = Vector4::new(w, x, y, z) * sign;
    let t = pose.translation.vector;
    (q, 0.5 * product(&Vector4::new(0.0, t.x, t.y, t.z), &q))
}

fn product(a: &Vector4<f64>, b: &Vector4<f64>) -> Vector4<f64> {
    let (av, bv) = (a.fixed_rows::<3>(1).into_owned(), b.fixed_rows::<3>(1).into_owned());
    let v = bv * a.x + av * b.x + av.cross(&bv);
    Vector4::new(a.x * b.x - av.dot(&bv), v.x, v.y, v.z)
}

/// K. Daniilidis, "Hand-eye calibration using dual quaternions", IJRR 1999, eqs. (31), (33) to (35).
fn daniilidis(rows: &[Row]) -> Option<[Pose; 2]> {
    let mut normal = SMatrix::<f64, 8, 8>::zeros();
    for (robot, seen) in motions(rows) {
        let ((a, a_dual), (b, b_dual)) = (dual(&robot), dual(&seen));
        let part = |v: &Vector4<f64>| v.fixed_rows::<3>(1).into_owned();
        let (a, b, a_dual, b_dual) = (part(&a), part(&b), part(&a_dual), part(&b_dual));
        let mut s = SMatrix::<f64, 6, 8>::zeros();
        for (row, column, minus, plus) in
            [(0, 0, a - b, a + b), (3, 0, a_dual - b_dual, a_dual + b_dual), (3, 4, a - b, a + b)]
        {
            s.fixed_view_mut::<3, 1>(row, column).copy_from(&minus);
            s.fixed_view_mut::<3, 3>(row, column + 1).copy_from(&se3::skew(&plus));
        }
        normal += s.transpose() * s;
    }
    let eigen = normal.symmetric_eigen();
    let mut order: Vec<usize> = (0..8).collect();
    order.sort_by(|&a, &b| eigen.eigenvalues[a].total_cmp(&eigen.eigenvalues[b]));
    let vector = |index: usize| -> SVector<f64, 8> { eigen.eigenvectors.column(order[index]).into_owned() };
    let (first, second) = (vector(0), vector(1));
    let halves = |v: &SVector<f64, 8>| (v.fixed_rows::<4>(0).into_owned(), v.fixed_rows::<4>(4).into_owned());
    let ((u1, v1), (u2, v2)) = (halves(&first), halves(&second));
    // λ1² u1·v1 + λ1 λ2 (u1·v2 + u2·v1) + λ2² u2·v2 = 0, with s = λ1 / λ2.
    let (a, b, c) = (u1.dot(&v1), u1.dot(&v2) + u2.dot(&v1), u2.dot(&v2));
    let root = (b * b - 4.0 * a * c).max(0.0).sqrt();
    let ratios: Vec<f64> = if a.abs() > f64::MIN_POSITIVE {
        vec![(-b + root) / (2.0 * a), (-b - root) / (2.0 * a)]
    } else {
        return None;
    };
    let length = |s: f64| s * s * u1.dot(&u1) + 2.0 * s * u1.dot(&u2) + u2.dot(&u2);
    let s = ratios.into_iter().filter(|s| s.is_finite()).max_by(|a, b| length(*a).total_cmp(&length(*b)))?;
    let lambda = length(s).sqrt().recip();
    let (q, q_dual) = (lambda * (s * u1 + u2), lambda * (s * v1 + v2));
    if q.norm().is_nan() || q.norm() <= 0.5 {
        return None;
    }
    let conjugate = Vector4::new(q.x, -q.y, -q.z, -q.w);
    let place = 2.0 * product(&q_dual, &conjugate);
    let rotation = rotation_of(&q)?;
    let right = se3::pose(rotation, Vector3::new(place.y, place.z, place.w));
    Some([left_of(rows, &right)?, right])
}

fn rotation_of(q: &Vector4<f64>) -> Option<Rotation3<f64>> {
    use denavit_model::nalgebra::{Quaternion, UnitQuaternion};
    let unit = UnitQuaternion::try_new(Quaternion::new(q.x, q.y, q.z, q.w), 1e-9)?;
    Some(unit.to_rotation_matrix())
}

/// M. Shah, "Solving the robot-world/hand-eye calibration problem using the Kronecker product", ASME JMR 2013: both rotations
/// from the singular vectors of Σ R_B ⊗ R_A, then both translations by least squares.
fn shah(rows: &[Row]) -> Option<[Pose; 2]> {
    let mut sum = SMatrix::<f64, 9, 9>::zeros();
    for row in rows {
        sum += row.seen.rotation.matrix().kronecker(row.moved.rotation.matrix());
    }
    let svd = sum.svd(true, true);
    let (u, v_t) = (svd.u?, svd.v_t?);
    let largest = svd.singular_values.imax();
    let matrix = |entries: &mut dyn Iterator<Item = f64>| {
        let m = Matrix3::from_iterator(entries);
        m * m.determinant().signum()
    };
    let right = procrustes(&matrix(&mut v_t.row(largest).iter().copied()))?;
    let left = procrustes(&matrix(&mut u.column(largest).iter().copied()))?;
    let mut system = DMatrix::zeros(3 * rows.len(), 6);
    let mut side = DMatrix::zeros(3 * rows.len(), 1);
    for (index, row) in rows.iter().enumerate() {
        system.fixed_view_mut::<3, 3>(3 * index, 0).copy_from(row.moved.rotation.matrix());
        system.fixed_view_mut::<3, 3>(3 * index, 3).copy_from(&-Matrix3::identity());
        let here = left * row.seen.translation.vector - row.moved.translation.vector;
        side.fixed_view_mut::<3, 1>(3 * index, 0).copy_from(&here);
    }
    let norm = system.norm();
    let found = system.svd(true, true).solve(&side, RANK * norm).ok()?;
    let place = |at: usize| Vector3::new(found[at], found[at + 1], found[at + 2]);
    Some([se3::pose(left, place(3)), se3::pose(right, place(0))])
}

/// A matrix of the eight signs and quarter turns from which a fit starts where no closed form is determined.
pub fn quarter_turns() -> Vec<Rotation3<f64>> {
    let mut found: Vec<Rotation3<f64>> = Vec::new();
    let quarter = std::f64::consts::FRAC_PI_2;
    for (a, b, c) in (0..4).flat_map(|a| (0..4).flat_map(move |b| (0..4).map(move |c| (a, b, c)))) {
        let turn = se3::rotation_from_rpy([f64::from(a) * quarter, f64::from(b) * quarter, f64::from(c) * quarter]);
        if found.iter().all(|known| se3::rotation_angle(&(known.inverse() * turn)) > 0.1) {
            found.push(turn);
        }
    }
    found
}

/// A pose as its rows print.
pub fn homogeneous(pose: &Pose) -> [[f64; 4]; 4] {
    let m: Matrix4<f64> = pose.to_homogeneous();
    std::array::from_fn(|row| std::array::from_fn(|column| m[(row, column)]))
}
