//! Real roots of trigonometric polynomials of second degree, by a quartic in the tangent of the half angle.

use crate::circles::{EXACT, Few};

/// Cosine and sine of directions from which the half angle is counted: 0, and those of the triangles 3-4-5 and 5-12-13 in each quarter.
const STARTS: [(f64, f64); 5] =
    [(1.0, 0.0), (0.8, 0.6), (-5.0 / 13.0, 12.0 / 13.0), (-0.8, -0.6), (5.0 / 13.0, -12.0 / 13.0)];

/// The angles y with p0 + p1 cos y + p2 sin y + p3 cos 2y + p4 sin 2y = 0.
///
/// Where two roots have just become complex, their common real part is tried if the polynomial misses zero there by less
/// than `slack` of its coefficients.
pub(crate) fn trigonometric_roots(p: &[f64; 5], slack: f64) -> Few<f64, 4> {
    let mut roots = Few::new(0.0);
    // The tangent of the half angle is infinite at π: turn until the leading coefficient, the value there, is not small.
    let size = p.iter().fold(0.0, |size: f64, x| size.max(x.abs()));
    if size == 0.0 {
        return roots;
    }
    let opposite = |(c, s): &(f64, f64)| (value_at(p, -c, -s)).abs();
    let (c1, s1) = STARTS.into_iter().max_by(|a, b| opposite(a).total_cmp(&opposite(b))).unwrap_or((1.0, 0.0));
    let start = s1.atan2(c1);
    let (s2, c2) = (2.0 * s1 * c1, c1 * c1 - s1 * s1);
    let [p1, p2] = [p[1] * c1 + p[2] * s1, p[2] * c1 - p[1] * s1];
    let [p3, p4] = [p[3] * c2 + p[4] * s2, p[4] * c2 - p[3] * s2];
    let p0 = p[0];
    // cos = (1 - t²)/(1 + t²), sin = 2t/(1 + t²); times (1 + t²)².
    let quartic = [p0 - p1 + p3, 2.0 * p2 - 4.0 * p4, 2.0 * p0 - 6.0 * p3, 2.0 * p2 + 4.0 * p4, p0 + p1 + p3];
    let mut add = |t: f64| {
        let mut y = start + 2.0 * t.atan();
        // Two Newton steps: the closed form loses digits where roots are close.
        for _ in 0..2 {
            let slope = slope(p, y);
            let step = value(p, y) / slope;
            if step.is_finite() && step.abs() < 0.1 {
                y -= step;
            }
        }
        let miss = value(p, y).abs() / size;
        if miss <= EXACT {
            roots.push(y);
        } else if miss <= slack {
            // As for one equation: a pair as far apart as the one that is missing.
            let half = (2.0 * (value(p, y) / curvature(p, y)).abs()).sqrt().clamp(1e-3, 0.5);
            roots.push(y + half);
            roots.push(y - half);
        }
    };
    solve(&quartic, &mut add);
    roots
}

fn value(p: &[f64; 5], y: f64) -> f64 {
    let (s, c) = y.sin_cos();
    value_at(p, c, s)
}

fn value_at(p: &[f64; 5], c: f64, s: f64) -> f64 {
    p[0] + p[1] * c + p[2] * s + p[3] * (c * c - s * s) + p[4] * 2.0 * s * c
}

fn slope(p: &[f64; 5], y: f64) -> f64 {
    let (s, c) = y.sin_cos();
    p[2] * c - p[1] * s + 2.0 * (p[4] * (c * c - s * s) - p[3] * 2.0 * s * c)
}

fn curvature(p: &[f64; 5], y: f64) -> f64 {
    let (s, c) = y.sin_cos();
    -(p[1] * c + p[2] * s) - 4.0 * (p[3] * (c * c - s * s) + p[4] * 2.0 * s * c)
}

/// Real parts of the roots of a4 t⁴ + ··· + a0, highest coefficient first; Ferrari's way by the resolvent cubic.
///
/// Of a complex pair the real part is given once: the caller decides whether it is near enough.
fn solve(a: &[f64; 5], add: &mut impl FnMut(f64)) {
    let [b, c, d, e] = [a[1] / a[0], a[2] / a[0], a[3] / a[0], a[4] / a[0]];
    if ![b, c, d, e].iter().all(|x| x.is_finite()) {
        return;
    }
    // t = y - b/4: y⁴ + p y² + q y + r.
    let shift = 0.25 * b;
    let p = c - 6.0 * shift * shift;
    let q = d - 2.0 * c * shift + 8.0 * shift * shift * shift;
    let r = e - d * shift + c * shift * shift - 3.0 * shift * shift * shift * shift;
    let z = greatest_root(2.0 * p, p * p - 4.0 * r, -q * q).max(0.0);
    let u = z.sqrt();
    let scale = p.abs().max(r.abs().sqrt());
    let (low, high) = if u * u <= 1e-14 * scale || u == 0.0 {
        // y⁴ + p y² + r: both quadratics in y².
        let inner = 0.25 * p * p - r;
        let root = inner.max(0.0).sqrt();
        for square in [-0.5 * p + root, -0.5 * p - root] {
            let y = square.max(0.0).sqrt();
            add(y - shift);
            if y > 0.0 {
                add(-y - shift);
            }
        }
        return;
    } else {
        let middle = 0.5 * (p + z);
        let side = q / (2.0 * u);
        (middle - side, middle + side)
    };
    for (linear, constant) in [(u, low), (-u, high)] {
        let inner = 0.25 * linear * linear - constant;
        if inner >= 0.0 {
            let root = inner.sqrt();
            add(-0.5 * linear + root - shift);
            add(-0.5 * linear - root - shift);
        } else {
            add(-0.5 * linear - shift);
        }
    }
}

/// The greatest real root of z³ + b z² + c z + d.
fn greatest_root(b: f64, c: f64, d: f64) -> f64 {
    let third = b / 3.0;
    let p = c - b * third;
    let q = 2.0 * third * third * third - third * c + d;
    let inner = 0.25 * q * q + p * p * p / 27.0;
    let mut z = if inner > 0.0 {
        let root = inner.sqrt();
        let u = if q > 0.0 { (-0.5 * q - root).cbrt() } else { (-0.5 * q + root).cbrt() };
        if u == 0.0 { 0.0 } else { u - p / (3.0 * u) }
    } else {
        let radius = (-p / 3.0).max(0.0).sqrt();
        let angle = (-inner).max(0.0).sqrt().atan2(-0.5 * q) / 3.0;
        2.0 * radius * angle.cos()
    } - third;
    for _ in 0..2 {
        let value = ((z + b) * z + c) * z + d;
        let slope = (3.0 * z + 2.0 * b) * z + c;
        let step = value / slope;
        if step.is_finite() && step.abs() <= 0.1 * z.abs() {
            z -= step;
        }
    }
    z
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// (1 - cos(y - α)) type factors: a product of two first-degree polynomials with known roots.
        #[test]
        fn roots_of_a_product_are_found(m1 in -3.0..3.0f64, h1 in 0.05..3.0f64, m2 in -3.0..3.0f64, h2 in 0.05..3.0f64) {
            // cos(y - m1) - cos h1, roots m1 ± h1.
            let [a0, a1, a2] = [-h1.cos(), m1.cos(), m1.sin()];
            let [b0, b1, b2] = [-h2.cos(), m2.cos(), m2.sin()];
            let p = [
                a0 * b0 + 0.5 * (a1 * b1 + a2 * b2),
                a0 * b1 + a1 * b0,
                a0 * b2 + a2 * b0,
                0.5 * (a1 * b1 - a2 * b2),
                0.5 * (a1 * b2 + a2 * b1),
            ];
            let roots = trigonometric_roots(&p, 0.05);
            for wanted in [m1 + h1, m1 - h1, m2 + h2, m2 - h2] {
                let near = |y: &f64| (y - wanted).sin().abs() < 1e-3 && (y - wanted).cos() > 0.0;
                prop_assert!(roots.as_slice().iter().any(near), "{wanted} not in {:?}", roots.as_slice());
            }
        }
    }
}
