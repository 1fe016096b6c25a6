//! The machine's limits: vector arithmetic from registers alone, the sines that kinematics needs, and forward kinematics of one
//! robot written out by hand.

#![expect(clippy::inline_always, reason = "SIMD code must be compiled into the function that enables the instructions")]

use denavit_benches::{BATCH, ROBOTS, chain, configurations, report};
use denavit_model::compiled::sine_and_cosine;
use denavit_model::nalgebra::{Matrix3, Rotation3, Vector3};
use denavit_model::{Pose, se3};
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

type Triple<S> = [<S as Simd>::f64s; 3];

#[inline(always)]
fn each<S: Simd>(of: impl Fn(usize) -> S::f64s) -> Triple<S> {
    [of(0), of(1), of(2)]
}

/// The columns x and y of a frame after a turn about z.
#[inline(always)]
fn turned<S: Simd>((sine, cosine): (S::f64s, S::f64s), x: Triple<S>, y: Triple<S>) -> (Triple<S>, Triple<S>) {
    let new_x = each::<S>(|k| y[k].mul_add(sine, x[k] * cosine));
    (new_x, each::<S>(|k| y[k].mul_sub(cosine, x[k] * sine)))
}

#[inline(always)]
fn shifted<S: Simd>(origin: Triple<S>, along: Triple<S>, by: f64) -> Triple<S> {
    each::<S>(|k| along[k].mul_add(by, origin[k]))
}

/// Sine and cosine of a joint's value in each of as many configurations as there are lanes.
#[inline(always)]
fn turn<S: Simd>(simd: S, q: &[f64], joint: usize) -> (S::f64s, S::f64s) {
    sine_and_cosine(simd, S::f64s::from_fn(simd, |lane| q[lane * 6 + joint]))
}

/// Forward kinematics of the UR5e alone, joint after joint by its published D-H numbers (d, a; alpha a quarter turn or none),
/// with nothing decided at run time: the reference for batches of a chain that is known only at run time.
#[inline(always)]
fn ur5e<S: Simd>(simd: S, q: &[f64], poses: &mut [Pose]) {
    let (zero, one) = (S::f64s::splat(simd, 0.0), S::f64s::splat(simd, 1.0));
    let lanes = S::f64s::LEN;
    for (q, poses) in q.chunks_exact(6 * lanes).zip(poses.chunks_exact_mut(lanes)) {
        let (sine, cosine) = turn(simd, q, 0);
        let (x, y, z) = ([cosine, sine, zero], [zero, zero, one], [sine, -cosine, zero]);
        let origin = [zero, zero, S::f64s::splat(simd, 0.1625)];
        let (x, y) = turned::<S>(turn(simd, q, 1), x, y);
        let origin = shifted::<S>(origin, x, -0.425);
        let (x, y) = turned::<S>(turn(simd, q, 2), x, y);
        let origin = shifted::<S>(origin, x, -0.3922);
        let (x, y) = turned::<S>(turn(simd, q, 3), x, y);
        let origin = shifted::<S>(origin, z, 0.1333);
        let (y, z) = (z, each::<S>(|k| -y[k]));
        let (x, y) = turned::<S>(turn(simd, q, 4), x, y);
        let origin = shifted::<S>(origin, z, 0.0997);
        let (y, z) = (each::<S>(|k| -z[k]), y);
        let (x, y) = turned::<S>(turn(simd, q, 5), x, y);
        let origin = shifted::<S>(origin, z, 0.0996);
        for (lane, pose) in poses.iter_mut().enumerate() {
            let column =
                |v: &Triple<S>| Vector3::new(v[0].as_slice()[lane], v[1].as_slice()[lane], v[2].as_slice()[lane]);
            let rotation = Matrix3::from_columns(&[column(&x), column(&y), column(&z)]);
            *pose = se3::pose(Rotation3::from_matrix_unchecked(rotation), column(&origin));
        }
    }
}

/// The robot of which the kinematics are written out, at each width of vector.
pub fn written_out() {
    let (robot, file, tip) = ROBOTS[0];
    let chain = chain(file, tip);
    let q = configurations(chain.coordinates().len(), BATCH);
    let mut poses = vec![Pose::identity(); BATCH];
    for (bits, level) in levels() {
        report(robot, &format!("written out by hand, poses, {bits} bits"), "batch", BATCH, || {
            dispatch!(level, simd => ur5e(simd, black_box(&q), black_box(&mut poses)));
        });
        for (pose, q) in poses.iter().zip(q.chunks(6)) {
            // The base frame is turned against the URDF's; distances from the base are not.
            let apart = pose.translation.vector.norm() - chain.fk(q).translation.vector.norm();
            assert!(apart.abs() < 1e-12, "{apart} m");
        }
    }
}
