//! Many configurations: each lane is a configuration, and all lanes run the same instructions.

use super::blocks::{Block, Gap};
use super::frames::Twist;
use super::sin_cos;
use super::{CompiledChain, JacobianFrame};
use crate::se3::{self, Pose};
use fearless_simd::{Simd, SimdBase as _, SimdFloat as _};
use nalgebra::{Matrix3, Rotation3, Vector3};

/// A vector in each lane.
type Vectors<S> = [<S as Simd>::f64s; 3];

/// Cosines and sines.
type Turns<S> = (<S as Simd>::f64s, <S as Simd>::f64s);

/// base_from_here in each lane.
struct Frames<S: Simd> {
    x: Vectors<S>,
    y: Vectors<S>,
    z: Vectors<S>,
    origin: Vectors<S>,
}

#[inline(always)]
fn each<S: Simd>(of: impl Fn(usize) -> S::f64s) -> Vectors<S> {
    [of(0), of(1), of(2)]
}

impl<S: Simd> Frames<S> {
    #[inline(always)]
    fn all(simd: S, pose: &Pose) -> Self {
        let r = pose.rotation.matrix();
        let p = pose.translation.vector;
        let splat = |value| S::f64s::splat(simd, value);
        Self {
            x: each::<S>(|row| splat(r[(row, 0)])),
            y: each::<S>(|row| splat(r[(row, 1)])),
            z: each::<S>(|row| splat(r[(row, 2)])),
            origin: each::<S>(|row| splat(p[row])),
        }
    }

    /// This frame followed by Rz(turn) T(x, y, slide) Rx(alpha).
    #[inline(always)]
    fn stepped(self, (cosine, sine): Turns<S>, slide: Option<S::f64s>, gap: &Gap) -> Self {
        let Self { x, y, z, mut origin } = self;
        let turned_x = each::<S>(|row| y[row].mul_add(sine, x[row] * cosine));
        let turned_y = || each::<S>(|row| y[row].mul_add(cosine, -(x[row] * sine)));
        if let Some(slide) = slide {
            origin = each::<S>(|row| z[row].mul_add(slide, origin[row]));
        }
        if gap.x != 0.0 {
            origin = each::<S>(|row| turned_x[row].mul_add(gap.x, origin[row]));
        }
        if gap.y != 0.0 {
            let y = turned_y();
            origin = each::<S>(|row| y[row].mul_add(gap.y, origin[row]));
        }
        match gap.twist {
            Twist::Parallel => Self { x: turned_x, y: turned_y(), z, origin },
            Twist::Square => {
                let out = each::<S>(|row| x[row].mul_sub(sine, y[row] * cosine));
                Self { x: turned_x, y: z, z: out, origin }
            }
            Twist::Oblique { cosine, sine } => {
                let y = turned_y();
                let up = each::<S>(|row| z[row].mul_add(sine, y[row] * cosine));
                let out = each::<S>(|row| z[row].mul_sub(cosine, y[row] * sine));
                Self { x: turned_x, y: up, z: out, origin }
            }
        }
    }
}

/// The frames of as many configurations as there are lanes, from configuration `first` on; lanes beyond `count` repeat
/// the last.
#[inline(always)]
fn reached<S: Simd>(simd: S, chain: &CompiledChain, q: &[f64], first: usize, count: usize) -> Frames<S> {
    walked(simd, chain, q, first, count, |_, _, _| {})
}

/// The same; calls `visit` with each joint's axis and a point on it.
#[inline(always)]
fn walked<S: Simd>(
    simd: S,
    chain: &CompiledChain,
    q: &[f64],
    first: usize,
    count: usize,
    mut visit: impl FnMut(&Block, usize, &Frames<S>),
) -> Frames<S> {
    let stride = chain.coordinates;
    let here = &q[first * stride..(first + count) * stride];
    let mut frames = Frames::all(simd, &chain.start);
    for block in &chain.blocks {
        for k in 0..block.count.min(super::blocks::JOINTS) {
            let coordinate = block.coordinate[k];
            let values = if count == S::f64s::LEN {
                S::f64s::from_fn(simd, |lane| here[lane * stride + coordinate])
            } else {
                S::f64s::from_fn(simd, |lane| here[lane.min(count - 1) * stride + coordinate])
            };
            let (turn, slide) = turn_and_slide(simd, block, k, values);
            visit(block, k, &frames);
            frames = frames.stepped(turn, slide, &block.gaps[k]);
        }
    }
    if let Some((cosine, sine)) = chain.last_turn {
        let turn = (S::f64s::splat(simd, cosine), S::f64s::splat(simd, sine));
        frames = frames.stepped(turn, None, &Gap { x: 0.0, y: 0.0, twist: Twist::Parallel });
    }
    frames
}

#[inline(always)]
fn turn_and_slide<S: Simd>(simd: S, block: &Block, k: usize, q: S::f64s) -> (Turns<S>, Option<S::f64s>) {
    let value = q * block.scale[k] + block.offset[k];
    let quarters = S::u64s::splat(simd, block.quarters[k]);
    let (mut sine, mut cosine) = sin_cos::sin_cos(simd, value * block.turning[k], quarters);
    if block.rest_sine[k] != 0.0 {
        let (c, s) = (block.rest_cosine[k], block.rest_sine[k]);
        (sine, cosine) = (sine.mul_add(c, cosine * s), cosine.mul_sub(c, sine * s));
    }
    let slide = if block.sliding[k] != 0.0 {
        Some(value.mul_add(block.sliding[k], block.along[k]))
    } else if block.along[k] != 0.0 {
        Some(S::f64s::splat(simd, block.along[k]))
    } else {
        None
    };
    ((cosine, sine), slide)
}

#[inline(always)]
pub(super) fn poses<S: Simd>(simd: S, chain: &CompiledChain, q: &[f64], poses: &mut [Pose]) {
    let width = S::f64s::LEN;
    for (chunk, poses) in poses.chunks_mut(width).enumerate() {
        let frames = reached(simd, chain, q, chunk * width, poses.len());
        let Frames { x, y, z, origin } = &frames;
        for (lane, pose) in poses.iter_mut().enumerate() {
            let at = |vectors: &Vectors<S>, row: usize| vectors[row].as_slice()[lane];
            let column = |vectors: &Vectors<S>| Vector3::new(at(vectors, 0), at(vectors, 1), at(vectors, 2));
            let rotation = Matrix3::from_columns(&[column(x), column(y), column(z)]);
            *pose = se3::pose(Rotation3::from_matrix_unchecked(rotation), column(origin));
        }
    }
}

#[inline(always)]
pub(super) fn matrices<S: Simd>(simd: S, chain: &CompiledChain, q: &[f64], matrices: &mut [[f64; 16]]) {
    let width = S::f64s::LEN;
    for (chunk, matrices) in matrices.chunks_mut(width).enumerate() {
        let Frames { x, y, z, origin } = reached(simd, chain, q, chunk * width, matrices.len());
        for (lane, matrix) in matrices.iter_mut().enumerate() {
            for row in 0..3 {
                for (column, vectors) in [&x, &y, &z, &origin].into_iter().enumerate() {
                    matrix[4 * row + column] = vectors[row].as_slice()[lane];
                }
            }
            [matrix[12], matrix[13], matrix[14], matrix[15]] = [0.0, 0.0, 0.0, 1.0];
        }
    }
}

#[inline(always)]
pub(super) fn tips<S: Simd, T: From<[f64; 3]>>(simd: S, chain: &CompiledChain, q: &[f64], tips: &mut [T]) {
    let width = S::f64s::LEN;
    for (chunk, tips) in tips.chunks_mut(width).enumerate() {
        let Frames { origin, .. } = reached(simd, chain, q, chunk * width, tips.len());
        for (lane, tip) in tips.iter_mut().enumerate() {
            *tip = std::array::from_fn(|row| origin[row].as_slice()[lane]).into();
        }
    }
}

/// u × v in each lane.
#[inline(always)]
fn cross<S: Simd>(u: &Vectors<S>, v: &Vectors<S>) -> Vectors<S> {
    each::<S>(|row| {
        let (next, last) = ((row + 1) % 3, (row + 2) % 3);
        u[next].mul_sub(v[last], u[last] * v[next])
    })
}

#[inline(always)]
pub(super) fn jacobians<S: Simd>(
    simd: S,
    chain: &CompiledChain,
    frame: JacobianFrame,
    q: &[f64],
    jacobians: &mut [f64],
) {
    let (width, n) = (S::f64s::LEN, chain.coordinates);
    let zero = [S::f64s::splat(simd, 0.0); 3];
    // The angular and the linear part of each coordinate's column.
    let mut columns = vec![(zero, zero); n];
    for (chunk, jacobians) in jacobians.chunks_mut(6 * n * width).enumerate() {
        columns.fill((zero, zero));
        let Frames { x, y, z, origin } =
            walked(simd, chain, q, chunk * width, jacobians.len() / (6 * n), |block, k, Frames { z, origin, .. }| {
                let rate = &block.rates[k];
                let (angular, linear) = &mut columns[rate.coordinate];
                if rate.turning != 0.0 {
                    let moment = cross::<S>(origin, z);
                    *angular = each::<S>(|row| z[row].mul_add(rate.turning, angular[row]));
                    *linear = each::<S>(|row| moment[row].mul_add(rate.turning, linear[row]));
                }
                if rate.sliding != 0.0 {
                    *linear = each::<S>(|row| z[row].mul_add(rate.sliding, linear[row]));
                }
            });
        for (angular, linear) in &mut columns {
            if frame != JacobianFrame::Space {
                let carried = cross::<S>(angular, &origin);
                *linear = each::<S>(|row| linear[row] + carried[row]);
            }
            if frame == JacobianFrame::Body {
                let along =
                    |axis: &Vectors<S>, v: &Vectors<S>| axis[0].mul_add(v[0], axis[1].mul_add(v[1], axis[2] * v[2]));
                *angular = [along(&x, angular), along(&y, angular), along(&z, angular)];
                *linear = [along(&x, linear), along(&y, linear), along(&z, linear)];
            }
        }
        for (lane, jacobian) in jacobians.chunks_exact_mut(6 * n).enumerate() {
            for (k, (angular, linear)) in columns.iter().enumerate() {
                for (row, part) in angular.iter().chain(linear).enumerate() {
                    jacobian[row * n + k] = part.as_slice()[lane];
                }
            }
        }
    }
}
