//! One configuration: the lanes are joints while sines are computed, then the rows of the frame that moves along the arm.

use super::CompiledChain;
use super::blocks::{Block, Gap, JOINTS};
use super::frames::Twist;
use super::sin_cos;
use crate::se3::{self, Pose};
use fearless_simd::{Simd, SimdBase as _, SimdFloat as _, f64x4};
use nalgebra::{Matrix3, Rotation3, Vector3, Vector6};

/// base_from_here: the columns of the rotation and the origin; the fourth lane is idle.
#[derive(Clone, Copy)]
struct Frame<S: Simd> {
    x: f64x4<S>,
    y: f64x4<S>,
    z: f64x4<S>,
    origin: f64x4<S>,
}

/// What the joints of a block do at a configuration.
struct Turns {
    cosine: [f64; JOINTS],
    sine: [f64; JOINTS],
    slide: [f64; JOINTS],
}

impl Turns {
    const NONE: Self = Self { cosine: [1.0; JOINTS], sine: [0.0; JOINTS], slide: [0.0; JOINTS] };

    #[inline(always)]
    fn take<S: Simd>(&mut self, simd: S, block: &Block, q: &[f64]) {
        let width = S::f64s::LEN;
        for first in (0..JOINTS).step_by(width) {
            if first >= block.count {
                break;
            }
            let load = |numbers: &[f64; JOINTS]| S::f64s::from_slice(simd, &numbers[first..first + width]);
            // Straight into a register: a vector load of numbers just stored would wait for the stores.
            let here = S::f64s::from_fn(simd, |lane| q[block.coordinate[first + lane]]);
            let value = load(&block.scale) * here + load(&block.offset);
            let quarters = S::u64s::from_slice(simd, &block.quarters[first..first + width]);
            let (mut sine, mut cosine) = sin_cos::sin_cos(simd, load(&block.turning) * value, quarters);
            if block.any_rest {
                let (c, s) = (load(&block.rest_cosine), load(&block.rest_sine));
                (sine, cosine) = (sine.mul_add(c, cosine * s), cosine.mul_sub(c, sine * s));
            }
            cosine.store_slice(&mut self.cosine[first..first + width]);
            sine.store_slice(&mut self.sine[first..first + width]);
            load(&block.sliding).mul_add(value, load(&block.along)).store_slice(&mut self.slide[first..first + width]);
        }
    }
}

impl<S: Simd> Frame<S> {
    #[inline(always)]
    fn of(simd: S, pose: &Pose) -> Self {
        let column = |vector: Vector3<f64>| f64x4::load_array(simd, [vector.x, vector.y, vector.z, 0.0]);
        let r = pose.rotation.matrix();
        Self {
            x: column(r.column(0).into()),
            y: column(r.column(1).into()),
            z: column(r.column(2).into()),
            origin: column(pose.translation.vector),
        }
    }

    /// Behind Rz(turn) T(x, y, slide) Rx(alpha).
    #[inline(always)]
    fn stepped(self, (cosine, sine): (f64, f64), slide: f64, gap: &Gap) -> Self {
        let x = self.y.mul_add(sine, self.x * cosine);
        let mut origin = x.mul_add(gap.x, self.z.mul_add(slide, self.origin));
        let y = || self.y.mul_sub(cosine, self.x * sine);
        if gap.y != 0.0 {
            origin = y().mul_add(gap.y, origin);
        }
        match gap.twist {
            Twist::Parallel => Self { x, y: y(), z: self.z, origin },
            Twist::Square => Self { x, y: self.z, z: self.x.mul_sub(sine, self.y * cosine), origin },
            Twist::Oblique { cosine, sine } => {
                let y = y();
                let (up, out) = (self.z.mul_add(sine, y * cosine), self.z.mul_sub(cosine, y * sine));
                Self { x, y: up, z: out, origin }
            }
        }
    }

    #[inline(always)]
    fn turned(self, turn: Option<(f64, f64)>) -> Self {
        let Some((cosine, sine)) = turn else { return self };
        let x = self.y.mul_add(sine, self.x * cosine);
        Self { x, y: self.y.mul_sub(cosine, self.x * sine), ..self }
    }

    #[inline(always)]
    fn pose(self) -> Pose {
        let ([a, b, c, _], [d, e, f, _]) = (self.x.to_array(), self.y.to_array());
        let ([g, h, i, _], [x, y, z, _]) = (self.z.to_array(), self.origin.to_array());
        let rotation = Rotation3::from_matrix_unchecked(Matrix3::new(a, d, g, b, e, h, c, f, i));
        se3::pose(rotation, Vector3::new(x, y, z))
    }
}

/// Walks along the arm; `visit` sees each joint's axis and a point on it.
#[inline(always)]
fn walk<S: Simd>(simd: S, chain: &CompiledChain, q: &[f64], mut visit: impl FnMut(&Block, usize, &Frame<S>)) -> Pose {
    let mut frame = Frame::of(simd, &chain.start);
    let mut turns = Turns::NONE;
    for block in &chain.blocks {
        turns.take(simd, block, q);
        for k in 0..block.count.min(JOINTS) {
            visit(block, k, &frame);
            frame = frame.stepped((turns.cosine[k], turns.sine[k]), turns.slide[k], &block.gaps[k]);
        }
    }
    frame.turned(chain.last_turn).pose()
}

#[inline(always)]
pub(super) fn fk<S: Simd>(simd: S, chain: &CompiledChain, q: &[f64]) -> Pose {
    walk(simd, chain, q, |_, _, _| {})
}

#[inline(always)]
pub(super) fn space_jacobian<S: Simd>(simd: S, chain: &CompiledChain, q: &[f64], columns: &mut [Vector6<f64>]) -> Pose {
    columns.fill(Vector6::zeros());
    walk(simd, chain, q, |block, k, frame| {
        let rate = &block.rates[k];
        let ([zx, zy, zz, _], [px, py, pz, _]) = (frame.z.to_array(), frame.origin.to_array());
        let (turning, sliding) = (rate.turning, rate.sliding);
        let column = &mut columns[rate.coordinate];
        column[0] += turning * zx;
        column[1] += turning * zy;
        column[2] += turning * zz;
        column[3] += turning * (py * zz - pz * zy) + sliding * zx;
        column[4] += turning * (pz * zx - px * zz) + sliding * zy;
        column[5] += turning * (px * zy - py * zx) + sliding * zz;
    })
}

#[inline(always)]
pub(super) fn tip_jacobian<S: Simd>(simd: S, chain: &CompiledChain, q: &[f64], columns: &mut [Vector6<f64>]) -> Pose {
    let pose = space_jacobian(simd, chain, q, columns);
    let tip = pose.translation.vector;
    for column in columns {
        let [x, y, z] = [column[0], column[1], column[2]];
        column[3] += y * tip.z - z * tip.y;
        column[4] += z * tip.x - x * tip.z;
        column[5] += x * tip.y - y * tip.x;
    }
    pose
}
