//! What the machine can do at best: vector arithmetic from registers alone, and the sines that kinematics cannot go without.

#![expect(clippy::inline_always, reason = "SIMD code must be compiled into the function that enables the instructions")]

use denavit_benches::{configurations, report};
use fearless_simd::{Level, Simd, SimdBase as _, SimdFloat as _, dispatch};
use std::hint::black_box;

/// Independent sums, enough to hide the latency of an operation.
const SUMS: usize = 12;
/// Operations on each sum in a run.
const TIMES: usize = 100;

/// `SUMS · TIMES` multiplications with addition.
#[inline(always)]
fn multiply_add<S: Simd>(simd: S, factor: f64) -> f64 {
    let mut sums = [S::f64s::splat(simd, 1.0); SUMS];
    let factor = S::f64s::splat(simd, factor);
    for _ in 0..TIMES {
        for sum in &mut sums {
            *sum = sum.mul_add(factor, factor);
        }
    }
    sums.iter().map(|sum| sum.as_slice()[0]).sum()
}

/// As many additions between as many multiplications with addition.
#[inline(always)]
fn multiply_add_and_add<S: Simd>(simd: S, factor: f64) -> f64 {
    let mut sums = [S::f64s::splat(simd, 1.0); SUMS];
    let factor = S::f64s::splat(simd, factor);
    for _ in 0..TIMES / 2 {
        for (k, sum) in sums.iter_mut().enumerate() {
            *sum = if k % 2 == 0 { sum.mul_add(factor, factor) } else { *sum + factor };
        }
        for (k, sum) in sums.iter_mut().enumerate() {
            *sum = if k % 2 == 1 { sum.mul_add(factor, factor) } else { *sum + factor };
        }
    }
    sums.iter().map(|sum| sum.as_slice()[0]).sum()
}

fn levels() -> Vec<(usize, Level)> {
    let level = Level::new();
    #[cfg(target_arch = "x86_64")]
    let levels = [
        (512, level.as_avx512().map(Level::Avx512)),
        (256, level.as_avx2().map(Level::Avx2)),
        (128, level.as_sse2().map(Level::Sse2)),
    ];
    #[cfg(not(target_arch = "x86_64"))]
    let levels = [(128, Some(level))];
    levels.into_iter().filter_map(|(bits, level)| Some((bits, level?))).collect()
}

pub fn arithmetic() {
    for (bits, level) in levels() {
        let times = 100 * SUMS * TIMES;
        report("registers", &format!("multiply-add, {bits} bits"), "limit", times, || {
            (0..100).for_each(|_| _ = black_box(dispatch!(level, simd => multiply_add(simd, black_box(0.5)))));
        });
        report("registers", &format!("multiply-add and add in turn, {bits} bits"), "limit", times, || {
            (0..100).for_each(|_| _ = black_box(dispatch!(level, simd => multiply_add_and_add(simd, black_box(0.5)))));
        });
    }
}

pub fn standard_sines() {
    let angles = configurations(1, 6000);
    report("standard library", "sin_cos of six angles", "limit", 1000, || {
        for angle in &angles {
            black_box(black_box(angle).sin_cos());
        }
    });
}
