//! The prior of a curve in gaps between rows.
//!
//! The waves of a curve are band-limited. Rows on both sides of a gap, and errors of another kind that neighbouring rows share, may make
//! them overshoot in the gap to many times the curve's size elsewhere; the same may happen beyond the first and the last row. So a curve
//! is expected to be no larger in gaps than at the rows: wherever the nearest reading is farther away than half the curve's length scale,
//! it is 0 with its root mean square over the rows as standard deviation, once for each half period of the fastest wave.

use denavit_identify::effects::curve::{Curve, Waves};
use denavit_linear::products::gram_of;
use std::f64::consts::{PI, TAU};

/// Places in each half period of the fastest wave; together they count as one.
const PLACES: f64 = 2.0;

/// The resulting precision of the waves' coefficients, 1/rad² or 1/m², row by row; empty if there is no gap.
pub(super) fn precision(curve: &Curve, readings: &[f64]) -> Vec<f64> {
    let count = curve.waves.len();
    let places = gaps(curve, readings);
    let square = readings.iter().map(|&reading| curve.value(reading).powi(2)).sum::<f64>() / readings.len() as f64;
    if places.is_empty() || square <= 0.0 {
        return Vec::new();
    }
    let (many, mut values) = (places.len(), vec![0.0; count]);
    let mut waves = vec![0.0; count * many];
    for (at, place) in places.into_iter().enumerate() {
        curve.waves.values_into(place, &mut values);
        for (wave, value) in values.iter().enumerate() {
            waves[wave * many + at] = *value;
        }
    }
    gram_of(&waves, many).into_iter().map(|cell| cell / (PLACES * square)).collect()
}

/// Places of the waves from which the nearest reading is farther than half the curve's length.
fn gaps(curve: &Curve, readings: &[f64]) -> Vec<f64> {
    let (low, high) = match curve.waves {
        Waves::Sines { low, width, .. } => (low, low + width),
        Waves::Turns { .. } => (-PI, PI),
    };
    let apart = |place: f64, reading: f64| match curve.waves {
        Waves::Sines { .. } => (place - reading).abs(),
        Waves::Turns { .. } => ((place - reading + PI).rem_euclid(TAU) - PI).abs(),
    };
    let far = |place: &f64| readings.iter().all(|reading| apart(*place, *reading) > 0.5 * curve.length);
    let step = PI / (PLACES * curve.waves.frequency(curve.waves.len() - 1));
    let next = |place: &f64| Some(place + step).filter(|next| *next < high);
    std::iter::successors(Some(low), next).filter(far).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn curve(readings: &[f64]) -> Curve {
        let waves = Waves::over(readings[0], readings[readings.len() - 1], false, 60.0, 60);
        let weights = vec![1e-4; waves.len()];
        let range = (readings[0], readings[readings.len() - 1]);
        Curve { joint: 0, waves, weights, range, size: 1e-3, length: 0.1, spread: Vec::new() }
    }

    #[test]
    fn only_what_is_farther_from_every_reading_than_half_the_length_scale_is_a_gap() {
        let dense: Vec<f64> = (0..60).map(|k| f64::from(k) * 0.05).collect();
        let (first, last) = (dense[0], dense[59]);
        assert!(gaps(&curve(&dense), &dense).iter().all(|place| *place < first - 0.05 || *place > last + 0.05));
        let split: Vec<f64> = dense.iter().copied().filter(|reading| !(1.0..2.0).contains(reading)).collect();
        let within = |place: &&f64| (first..last).contains(*place);
        let places: Vec<f64> = gaps(&curve(&split), &split).iter().filter(within).copied().collect();
        assert!(places.iter().all(|place| (1.0..1.95).contains(place)), "{places:?}");
        assert!(places.len() > 20, "{places:?}");
    }
}
