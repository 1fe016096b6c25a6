//! Lines in a curve's spectrum: orders with a large share of its variance.

use denavit_identify::effects::curve::Curve;
use serde::Serialize;
use std::f64::consts::TAU;

/// Number of readings at which a curve is sampled.
const PLACES: usize = 600;
/// Orders tried per period over the range: neighbours then differ by a tenth of a period.
const PER_PERIOD: f64 = 10.0;
/// Smallest share of a curve's variance that counts as a line.
const STANDS_OUT: f64 = 0.2;
/// Number of lines listed.
const LISTED: usize = 3;

/// A sine in a curve.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Line {
    /// Periods per 2π of the reading (rad; for a slide, of 2π m).
    pub order: f64,
    /// Its amplitude, rad or m.
    pub amplitude: f64,
    /// Its share of the curve's variance over the range.
    pub share: f64,
}

/// The curve over its range, and its root mean square about its mean, rad or m.
pub fn course(curve: &Curve) -> (Vec<(f64, f64)>, f64) {
    let (low, high) = curve.range;
    let course: Vec<(f64, f64)> = (0..PLACES)
        .map(|k| low + (high - low) * k as f64 / (PLACES - 1) as f64)
        .map(|reading| (reading, curve.value(reading)))
        .collect();
    let mean = course.iter().map(|(_, y)| y).sum::<f64>() / PLACES as f64;
    let rms = (course.iter().map(|(_, y)| (y - mean).powi(2)).sum::<f64>() / PLACES as f64).sqrt();
    (course, rms)
}

/// Lines, the strongest first. Each is fitted with a constant and subtracted before the next is searched for.
pub fn lines(curve: &Curve) -> Vec<Line> {
    let (course, rms) = course(curve);
    let total = rms * rms * course.len() as f64;
    let mean = course.iter().map(|(_, y)| y).sum::<f64>() / course.len() as f64;
    let mut left: Vec<(f64, f64)> = course.iter().map(|(x, y)| (*x, y - mean)).collect();
    let span = curve.range.1 - curve.range.0;
    // At least one period must lie in the range.
    let lowest = TAU / span;
    let highest = curve.waves.frequency(curve.waves.len() - 1);
    let count = ((highest - lowest) / (lowest / PER_PERIOD)).max(0.0) as usize;
    let mut found = Vec::new();
    while found.len() < LISTED && total > 0.0 {
        let orders = (0..=count).map(|k| lowest * (1.0 + k as f64 / PER_PERIOD));
        let best = orders.map(|order| (sine(&left, order), order)).max_by(|a, b| a.0.0.total_cmp(&b.0.0));
        let Some(((held, s, c), order)) = best else { break };
        let share = held / total;
        if share < STANDS_OUT {
            break;
        }
        found.push(Line { order, amplitude: s.hypot(c), share });
        for (x, y) in &mut left {
            let (sine, cosine) = (order * *x).sin_cos();
            *y -= s * sine + c * cosine;
        }
    }
    found
}

/// How much of the sum of squares a sine of this order explains, and its two numbers.
fn sine(points: &[(f64, f64)], order: f64) -> (f64, f64, f64) {
    let (mut ss, mut sc, mut cc, mut ys, mut yc) = (0.0, 0.0, 0.0, 0.0, 0.0);
    for (x, y) in points {
        let (s, c) = (order * x).sin_cos();
        ss += s * s;
        sc += s * c;
        cc += c * c;
        ys += y * s;
        yc += y * c;
    }
    let determinant = ss * cc - sc * sc;
    if determinant <= 1e-9 * ss * cc {
        return (0.0, 0.0, 0.0);
    }
    let (a, b) = ((ys * cc - yc * sc) / determinant, (yc * ss - ys * sc) / determinant);
    (a * ys + b * yc, a, b)
}

#[cfg(test)]
mod tests {
    use super::*;
    use denavit_identify::effects::curve::Waves;

    #[test]
    fn a_sine_is_a_line_of_its_order() {
        let waves = Waves::over(-3.0, 3.0, false, 40.0, 200);
        let Waves::Sines { low, width, count } = waves else {
            panic!("a joint that does not turn all round has sines")
        };
        // The wave itself, on its own interval.
        let mut weights = vec![0.0; count];
        weights[29] = 2e-4;
        let order = 30.0 * std::f64::consts::PI / width;
        let waves = Waves::Sines { low, width, count };
        let curve =
            Curve { joint: 0, waves, weights, range: (-3.0, 3.0), size: 1e-4, length: 0.1, spread: vec![0.0; 2] };
        let found = lines(&curve);
        assert_eq!(found.len(), 1);
        assert!((found[0].order - order).abs() < 0.15 && (found[0].amplitude - 2e-4).abs() < 1e-5, "{found:?}");
    }
}
