//! Two angles from two equations that are linear in their sines and cosines: what is left of most arms once invariants
//! have removed the other joints.

use crate::arm::Angle;
use crate::quartic;
use denavit_model::nalgebra::{Matrix2, Vector2, Vector3};
use std::f64::consts::PI;

/// At most this many pairs solve the two equations.
pub(crate) const MOST: usize = 4;

/// A short list without allocation.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Few<T: Copy, const N: usize> {
    items: [T; N],
    count: usize,
}

impl<T: Copy, const N: usize> Few<T, N> {
    pub fn new(fill: T) -> Self {
        Self { items: [fill; N], count: 0 }
    }

    /// Adds an item; a full list stays as it is.
    pub fn push(&mut self, item: T) {
        if self.count < N {
            self.items[self.count] = item;
            self.count += 1;
        }
    }

    pub fn as_slice(&self) -> &[T] {
        &self.items[..self.count]
    }
}

/// How far beyond a tangent point an equation may be for its nearest angle to be tried, as a share of its coefficients.
pub(crate) const SLACK: f64 = 0.15;
/// The same for an arm that is exactly of its class: rounding.
pub(crate) const EXACT: f64 = 1e-9;

/// The angles with a·(cos, sin) = k; see [`Line::at`].
pub(crate) fn on_line(a: Vector2<f64>, k: f64, slack: f64) -> Few<Angle, 2> {
    Line::of(a).at(k, slack)
}

/// The left side of a·(cos, sin) = k, for one k after another.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Line {
    length: f64,
    /// Of a.
    direction: Angle,
}

impl Line {
    pub fn of(a: Vector2<f64>) -> Self {
        Self { length: a.norm(), direction: Angle::of(a.y, a.x) }
    }

    /// The angles with a·(cos, sin) = k; where none has, the nearest if it misses by less than `slack` of |a|. Two lie on either side
    /// of the direction of a, equally far.
    ///
    /// Where a is 0 every angle will do, and 0 is returned.
    ///
    /// # Source
    /// Subproblem 4 of Elias, Wen, "IK-Geo", 2022; Paden 1986.
    pub fn at(&self, k: f64, slack: f64) -> Few<Angle, 2> {
        let Self { length, direction } = *self;
        let mut angles = Few::new(Angle::ZERO);
        if length == 0.0 {
            angles.push(Angle::ZERO);
            return angles;
        }
        let left = length * length - k * k;
        if left > 0.0 {
            let half = Angle::of(left.sqrt(), k);
            angles.push(direction.plus(half));
            angles.push(direction.plus(-half));
        } else if k.abs() <= length * (1.0 + slack) {
            let nearest = if k > 0.0 { direction.value } else { direction.value + PI };
            // An arm that differs slightly from the nominal one may have two angles here: as far apart as those that are missing.
            let half = if slack > EXACT { (2.0 * (k.abs() / length - 1.0)).sqrt().max(1e-3) } else { 0.0 };
            angles.push(Angle::at(nearest + half));
            if half > 0.0 {
                angles.push(Angle::at(nearest - half));
            }
        }
        angles
    }
}

/// A row of the two equations: a·x + b·y = k with x, y on the unit circle.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Row {
    pub a: Vector2<f64>,
    pub b: Vector2<f64>,
    pub k: f64,
}

impl Row {
    fn scaled(self) -> Self {
        let size = self.a.norm_squared() + self.b.norm_squared();
        if size == 0.0 {
            return self;
        }
        let by = size.sqrt().recip();
        Self { a: self.a * by, b: self.b * by, k: self.k * by }
    }
}

/// The coefficients of (cos v, sin v) and the constant in g·(p turned by v about the unit `direction`).
#[inline]
pub(crate) fn turned_dot(direction: &Vector3<f64>, g: &Vector3<f64>, p: &Vector3<f64>) -> (Vector2<f64>, f64) {
    let along = direction.dot(p) * direction.dot(g);
    (Vector2::new(g.dot(p) - along, g.dot(&direction.cross(p))), along)
}

/// Two rows of equations whose share of one angle is this close to dependent leave it out: between exact and 1e-6 the
/// quartic below loses more digits than a Newton step cannot bring back.
const DEPENDENT: f64 = 1e-7;

/// Angles of x and of y.
pub(crate) type Pair = (Angle, Angle);

/// The pairs of angles (of x, of y) that solve two rows.
///
/// Where the rows' coefficients of x are dependent, a combination holds y alone: two values of y, for each two of x, and
/// the other way round. Otherwise x = A⁻¹(k - B y) must have length 1, a trigonometric polynomial of second degree in y.
pub(crate) fn pairs(first: Row, second: Row, slack: f64) -> Few<Pair, MOST> {
    let (first, second) = (first.scaled(), second.scaled());
    let a = Matrix2::from_rows(&[first.a.transpose(), second.a.transpose()]);
    let b = Matrix2::from_rows(&[first.b.transpose(), second.b.transpose()]);
    let k = Vector2::new(first.k, second.k);
    let (of_a, of_b) = (a.determinant().abs(), b.determinant().abs());
    if of_a <= DEPENDENT && (of_a <= of_b || of_b <= DEPENDENT) {
        return one_alone(&a, &b, &k, slack);
    }
    if of_b <= DEPENDENT {
        return swapped(one_alone(&b, &a, &k, slack));
    }
    if of_a >= of_b { both(&a, &b, &k, slack) } else { swapped(both(&b, &a, &k, slack)) }
}

fn swapped(found: Few<Pair, MOST>) -> Few<Pair, MOST> {
    let mut result = Few::new((Angle::ZERO, Angle::ZERO));
    for (x, y) in found.as_slice() {
        result.push((*y, *x));
    }
    result
}

/// A is of rank one: y first.
fn one_alone(a: &Matrix2<f64>, b: &Matrix2<f64>, k: &Vector2<f64>, slack: f64) -> Few<Pair, MOST> {
    let mut result = Few::new((Angle::ZERO, Angle::ZERO));
    let (first, second) = (a.row(0).transpose(), a.row(1).transpose());
    let (longer, shorter, of_longer, of_shorter) =
        if first.norm_squared() >= second.norm_squared() { (first, second, 0, 1) } else { (second, first, 1, 0) };
    let size = longer.norm_squared();
    let share = if size == 0.0 { 0.0 } else { shorter.dot(&longer) / size };
    let alone = b.row(of_shorter).transpose() - b.row(of_longer).transpose() * share;
    let of_x = Line::of(longer);
    for y in on_line(alone, k[of_shorter] - share * k[of_longer], slack).as_slice() {
        let at = Vector2::new(y.cosine, y.sine);
        let rest = k[of_longer] - b.row(of_longer).transpose().dot(&at);
        for x in of_x.at(rest, slack).as_slice() {
            result.push((*x, *y));
        }
    }
    result
}

/// A is regular: |A⁻¹(k - B y)| = 1.
fn both(a: &Matrix2<f64>, b: &Matrix2<f64>, k: &Vector2<f64>, slack: f64) -> Few<Pair, MOST> {
    let mut result = Few::new((Angle::ZERO, Angle::ZERO));
    let determinant = a.determinant();
    let inverse = Matrix2::new(a.m22, -a.m12, -a.m21, a.m11) / determinant;
    let (c, d) = (inverse * b, inverse * k);
    let square = c.transpose() * c;
    let mixed = c.transpose() * d;
    // f(y) = p0 + p1 cos + p2 sin + p3 cos 2y + p4 sin 2y
    let polynomial = [
        d.norm_squared() - 1.0 + 0.5 * (square.m11 + square.m22),
        -2.0 * mixed.x,
        -2.0 * mixed.y,
        0.5 * (square.m11 - square.m22),
        square.m12,
    ];
    for y in quartic::trigonometric_roots(&polynomial, slack).as_slice() {
        let y = Angle::at(*y);
        let x = d - c * Vector2::new(y.cosine, y.sine);
        result.push((Angle::of(x.y, x.x), y));
    }
    result
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn row(a: [f64; 2], b: [f64; 2], (x, y): (f64, f64)) -> Row {
        let (a, b) = (Vector2::from(a), Vector2::from(b));
        let k = a.dot(&Vector2::new(x.cos(), x.sin())) + b.dot(&Vector2::new(y.cos(), y.sin()));
        Row { a, b, k }
    }

    proptest! {
        #[test]
        fn every_pair_that_made_the_equations_is_found(
            x in -PI..PI, y in -PI..PI,
            a in prop::array::uniform4(-1.0..1.0f64), b in prop::array::uniform4(-1.0..1.0f64), kind in 0..4u8,
        ) {
            let (mut a, mut b) = (a, b);
            if kind == 1 || kind == 3 { a[2] = 0.0; a[3] = 0.0; }
            if kind == 2 || kind == 3 { b[0] = 0.0; b[1] = 0.0; }
            prop_assume!(a[0].hypot(a[1]) > 0.05 && b[2].hypot(b[3]) > 0.05);
            prop_assume!(kind != 0 || (a[0] * a[3] - a[1] * a[2]).abs() > 1e-2);
            let (first, second) = (row([a[0], a[1]], [b[0], b[1]], (x, y)), row([a[2], a[3]], [b[2], b[3]], (x, y)));
            let found = pairs(first, second, SLACK);
            // Where two roots meet their place is known to half the digits.
            let matches = found.as_slice().iter().any(|(fx, fy)| (fx.value - x).sin().hypot((fy.value - y).sin()) < 2e-3 && (fx.value - x).cos() > 0.0 && (fy.value - y).cos() > 0.0);
            prop_assert!(matches, "{x} {y} not in {:?}", found.as_slice());
        }
    }
}
