//! Sines and cosines of many angles at once.
//!
//! Reduction by quarter turns in two parts of π/2, then polynomials on \[-π/4, π/4\]: straight-line work that is the same
//! for every lane.

use super::quarter_turns::{COSINE, LARGEST_REDUCED, QUARTER_TURN, QUARTER_TURN_REST, ROUNDER, SINE};
use fearless_simd::{Bytes as _, Level, Select as _, Simd, SimdBase as _, SimdFloat as _, SimdMask as _, dispatch};

/// Sine and cosine of `angle` (rad) plus `quarters` quarter turns, lane by lane.
///
/// # Accuracy
/// Below [`LARGEST_REDUCED`] within 2 units in the last place of the standard library, or 1e-21 beside a zero; beyond,
/// the standard library itself.
#[inline(always)]
pub(crate) fn sin_cos<S: Simd>(simd: S, angle: S::f64s, quarters: S::u64s) -> (S::f64s, S::f64s) {
    let reducible = angle.abs().simd_le(LARGEST_REDUCED);
    if reducible.any_false() {
        return by_standard_library(simd, angle, quarters);
    }
    let rounder = S::f64s::splat(simd, ROUNDER);
    let shifted = angle.mul_add(std::f64::consts::FRAC_2_PI, rounder);
    let count = shifted - rounder;
    let nearer = count.mul_add(-QUARTER_TURN, angle);
    let r = count.mul_add(-QUARTER_TURN_REST, nearer);
    let square = r * r;
    let sine = (r * square).mul_add(polynomial(simd, square, SINE), r);
    let cosine = polynomial(simd, square, COSINE).mul_add(square, -0.5).mul_add(square, 1.0);
    turned_by_quarters::<S>(sine, cosine, shifted.bitcast::<S::u64s>() + quarters)
}

#[inline(always)]
fn polynomial<S: Simd>(simd: S, x: S::f64s, c: [f64; 6]) -> S::f64s {
    let sum = S::f64s::splat(simd, c[5]).mul_add(x, c[4]);
    sum.mul_add(x, c[3]).mul_add(x, c[2]).mul_add(x, c[1]).mul_add(x, c[0])
}

/// Sine and cosine of an angle that is `quarters` quarter turns larger; only the two lowest bits count.
#[inline(always)]
fn turned_by_quarters<S: Simd>(sine: S::f64s, cosine: S::f64s, quarters: S::u64s) -> (S::f64s, S::f64s) {
    let odd = (quarters << 63).simd_ne(0);
    let turned_sine = odd.select(cosine, sine);
    let turned_cosine = odd.select(sine, cosine);
    let sine_sign = (quarters << 62) & (1 << 63);
    let cosine_sign = ((quarters + 1) << 62) & (1 << 63);
    let signed = |value: S::f64s, sign: S::u64s| (value.bitcast::<S::u64s>() ^ sign).bitcast::<S::f64s>();
    (signed(turned_sine, sine_sign), signed(turned_cosine, cosine_sign))
}

/// Sine and cosine of an angle (rad) in each lane, as accurate as [`sines_and_cosines`]; for code that is compiled into a
/// function that enables the vectors.
#[inline(always)]
pub fn sine_and_cosine<S: Simd>(simd: S, angle: S::f64s) -> (S::f64s, S::f64s) {
    sin_cos(simd, angle, S::u64s::splat(simd, 0))
}

/// Sines and cosines of angles (rad), in the widest vectors that the processor has.
///
/// # Accuracy
/// Within 2 units in the last place of the standard library, or 1e-21 beside a zero.
///
/// # Panics
/// `sines` or `cosines` is shorter than `angles`.
pub fn sines_and_cosines(angles: &[f64], sines: &mut [f64], cosines: &mut [f64]) {
    let (sines, cosines) = (&mut sines[..angles.len()], &mut cosines[..angles.len()]);
    dispatch!(Level::new(), simd => by_vectors(simd, angles, sines, cosines));
}

#[inline(always)]
fn by_vectors<S: Simd>(simd: S, angles: &[f64], sines: &mut [f64], cosines: &mut [f64]) {
    let width = S::f64s::LEN;
    let none = S::u64s::splat(simd, 0);
    let chunks = angles.chunks(width).zip(sines.chunks_mut(width)).zip(cosines.chunks_mut(width));
    for ((angles, sines), cosines) in chunks {
        let values = S::f64s::from_fn(simd, |lane| angles[lane.min(angles.len() - 1)]);
        let (sine, cosine) = sin_cos(simd, values, none);
        sines.copy_from_slice(&sine.as_slice()[..sines.len()]);
        cosines.copy_from_slice(&cosine.as_slice()[..cosines.len()]);
    }
}

#[inline(always)]
fn by_standard_library<S: Simd>(simd: S, angle: S::f64s, quarters: S::u64s) -> (S::f64s, S::f64s) {
    let sine = S::f64s::from_fn(simd, |lane| angle.as_slice()[lane].sin());
    let cosine = S::f64s::from_fn(simd, |lane| angle.as_slice()[lane].cos());
    turned_by_quarters::<S>(sine, cosine, quarters)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_PI_2;

    /// Angles of every size, and those next to whole quarter turns.
    fn angles() -> Vec<f64> {
        let spread = (0..100_000u32).map(|k| {
            let part = (f64::from(k) * 0.618_033_988_749_894_9).fract() - 0.5;
            part * [1.0, 8.0, 200.0, 2.0 * LARGEST_REDUCED][k as usize % 4]
        });
        let quarters = (-500..500i32).flat_map(|k| {
            let quarter = f64::from(k) * FRAC_PI_2;
            [quarter, quarter * (1.0 + f64::EPSILON), quarter + 1e-9]
        });
        spread.chain(quarters).chain([0.0, -0.0, 1e-300, LARGEST_REDUCED]).collect()
    }

    #[inline(always)]
    fn both<S: Simd>(simd: S, angles: &[f64], quarters: u64) -> Vec<(f64, f64)> {
        let quarters = S::u64s::splat(simd, quarters);
        let chunk = |angles: &[f64]| {
            let (sine, cosine) = sin_cos(simd, S::f64s::from_fn(simd, |k| angles[k.min(angles.len() - 1)]), quarters);
            (0..angles.len()).map(|k| (sine.as_slice()[k], cosine.as_slice()[k])).collect::<Vec<_>>()
        };
        angles.chunks(S::f64s::LEN).flat_map(chunk).collect()
    }

    fn units_apart(found: f64, expected: f64) -> f64 {
        let unit = expected.abs().next_up() - expected.abs();
        ((found - expected).abs() - 1e-21).max(0.0) / unit
    }

    #[test]
    fn agrees_with_the_standard_library() {
        let angles = angles();
        let (mut sines, mut cosines) = (vec![0.0; angles.len()], vec![0.0; angles.len()]);
        sines_and_cosines(&angles, &mut sines, &mut cosines);
        for ((angle, sine), cosine) in angles.iter().zip(sines).zip(cosines) {
            let apart = units_apart(sine, angle.sin()).max(units_apart(cosine, angle.cos()));
            assert!(apart <= 2.0, "{apart} at {angle}");
        }
    }

    #[test]
    fn quarters_are_added_exactly() {
        let level = Level::new();
        let angles = [0.0, 0.3, 2.0, 2e5];
        let plain = dispatch!(level, simd => both(simd, &angles, 0));
        for quarters in 0..4 {
            let turned = dispatch!(level, simd => both(simd, &angles, quarters));
            for ((sine, cosine), turned) in plain.iter().zip(turned) {
                let expected = [(*sine, *cosine), (*cosine, -sine), (-sine, -cosine), (-cosine, *sine)];
                assert_eq!(turned, expected[usize::try_from(quarters).unwrap()]);
            }
        }
    }
}
