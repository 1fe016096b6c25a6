//! Compiled chains: fast forward kinematics and Jacobians of one or many configurations, without allocation.
//!
//! ```text
//! Chain ──► frames (z on each axis, x across neighbours) ──► blocks of eight joints ──► one configuration: lanes are joints, then rows
//!                                                                                 └──► many: lanes are configurations
//! ```
//! The frames are those of Denavit and Hartenberg where these are well conditioned, so most numbers between neighbours
//! are 0 and alpha mostly 0 or a quarter turn; elsewhere the offset keeps three numbers and nothing is lost.
//! The widest vectors that the processor has are chosen once, when the chain is compiled.

#![expect(clippy::inline_always, reason = "SIMD code must be compiled into the function that enables the instructions")]

mod batch;
mod blocks;
mod frames;
pub mod quarter_turns;
mod sin_cos;
mod single;

use crate::chain::Chain;
use crate::se3::Pose;
use blocks::Block;
use fearless_simd::{Level, Simd, dispatch};
use frames::Frames;
use nalgebra::Vector6;
pub use sin_cos::{sine_and_cosine, sines_and_cosines};
use std::num::NonZeroUsize;

/// The kind of a Jacobian; its columns are `[angular; linear]` per unit of a coordinate.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum JacobianFrame {
    /// Its twist in the base frame (space Jacobian).
    Space,
    /// Its twist in its own frame (body Jacobian).
    Body,
    /// Its angular velocity and the velocity of its origin, along the base frame's axes (geometric Jacobian).
    Tip,
}

/// A chain compiled to straight-line code.
///
/// # Accuracy
/// Poses are those of [`Chain::fk`] to 1e-14 of the robot's size and 1e-14 rad, for every kind of joint, also in batches
/// (asserted on random chains in `tests/compiled.rs`). They may differ in the last digits between processors.
///
/// # Examples
/// ```
/// use denavit_model::{CompiledChain, examples, se3};
/// let chain = examples::puma_like();
/// let compiled = CompiledChain::new(&chain);
/// let q = [0.1, 0.2, 0.3, 0.4, 0.5, 0.6];
/// let (turned, moved) = se3::difference(&compiled.fk(&q), &chain.fk(&q));
/// assert!(turned < 1e-14 && moved < 1e-14);
/// ```
#[derive(Debug, Clone)]
pub struct CompiledChain {
    /// For batches: the widest.
    level: Level,
    /// For one configuration, whose handful of angles and rows of three fill no wider vector than 256 bits.
    level_of_one: Level,
    coordinates: usize,
    start: Pose,
    blocks: Vec<Block>,
    last_turn: Option<(f64, f64)>,
}

impl CompiledChain {
    /// Compiles a chain; worthwhile for about ten poses or more.
    pub fn new(chain: &Chain) -> Self {
        Self::for_instructions(chain, Level::new())
    }

    /// The same for narrower vectors than the processor has, to compare them: 512, 256 or 128 bits.
    ///
    /// `None` where the processor has no such vectors.
    pub fn with_vector_bits(chain: &Chain, bits: usize) -> Option<Self> {
        let level = narrowed(Level::new(), bits)?;
        Some(Self::for_instructions(chain, level))
    }

    fn for_instructions(chain: &Chain, level: Level) -> Self {
        let Frames { start, steps, last_turn } = Frames::of(chain);
        let blocks = Block::all(chain.joints(), &steps);
        let level_of_one = narrowed(level, 256).unwrap_or(level);
        Self { level, level_of_one, coordinates: chain.coordinates().len(), start, blocks, last_turn }
    }

    /// Bits of the vectors that batches use; one configuration uses at most 256.
    pub fn vector_bits(&self) -> usize {
        fn bits<S: Simd>(_: S) -> usize {
            64 * <S::f64s as fearless_simd::SimdBase<S>>::LEN
        }
        dispatch!(self.level, simd => bits(simd))
    }

    /// How many numbers a configuration has.
    pub fn coordinates(&self) -> usize {
        self.coordinates
    }

    /// base_from_tip at the coordinates `q` (rad, m).
    ///
    /// # Panics
    /// `q` is shorter than [`CompiledChain::coordinates`].
    pub fn fk(&self, q: &[f64]) -> Pose {
        let q = &q[..self.coordinates];
        dispatch!(self.level_of_one, simd => single::fk(simd, self, q))
    }

    /// Space Jacobian at `q`, as [`Chain::space_jacobian_into`]: column k is the twist `[omega; v]` of the tip in the base
    /// frame per unit of coordinate k. Returns base_from_tip.
    ///
    /// # Panics
    /// `q` or `columns` is shorter than [`CompiledChain::coordinates`].
    pub fn space_jacobian_into(&self, q: &[f64], columns: &mut [Vector6<f64>]) -> Pose {
        let (q, columns) = (&q[..self.coordinates], &mut columns[..self.coordinates]);
        dispatch!(self.level_of_one, simd => single::space_jacobian(simd, self, q, columns))
    }

    /// Geometric Jacobian at `q`, as [`Chain::tip_jacobian_into`]: column k is `[angular velocity; velocity of the tip's
    /// origin]` in the base frame per unit of coordinate k. Returns base_from_tip.
    ///
    /// # Panics
    /// As [`CompiledChain::space_jacobian_into`].
    pub fn tip_jacobian_into(&self, q: &[f64], columns: &mut [Vector6<f64>]) -> Pose {
        let (q, columns) = (&q[..self.coordinates], &mut columns[..self.coordinates]);
        dispatch!(self.level_of_one, simd => single::tip_jacobian(simd, self, q, columns))
    }

    /// base_from_tip at many configurations: `q` holds one after the other, `poses` takes as many.
    ///
    /// # Panics
    /// The length of `q` is not [`CompiledChain::coordinates`] times that of `poses`.
    pub fn poses_into(&self, q: &[f64], poses: &mut [Pose]) {
        assert_eq!(q.len(), self.coordinates * poses.len(), "one value for each coordinate of each configuration");
        dispatch!(self.level, simd => batch::poses(simd, self, q, poses));
    }

    /// The tip's origin, m, at many configurations; faster than whole poses, for samplers.
    ///
    /// # Panics
    /// As [`CompiledChain::poses_into`].
    ///
    /// # Examples
    /// ```
    /// use denavit_model::{CompiledChain, examples, nalgebra::Point3};
    /// let arm = CompiledChain::new(&examples::planar_arm());
    /// let mut tips = [Point3::origin(); 2];
    /// arm.tips_into(&[0.0, 0.0, std::f64::consts::FRAC_PI_2, 0.0], &mut tips);
    /// assert_eq!(tips[0], Point3::new(1.5, 0.0, 0.0));
    /// assert!((tips[1] - Point3::new(0.0, 1.5, 0.0)).norm() < 1e-15);
    /// ```
    pub fn tips_into<T: From<[f64; 3]>>(&self, q: &[f64], tips: &mut [T]) {
        assert_eq!(q.len(), self.coordinates * tips.len(), "one value for each coordinate of each configuration");
        dispatch!(self.level, simd => batch::tips(simd, self, q, tips));
    }

    /// [`CompiledChain::poses_into`] shared among threads: for work of many milliseconds, since starting one has a price.
    ///
    /// # Panics
    /// As [`CompiledChain::poses_into`].
    pub fn poses_into_by_threads(&self, threads: NonZeroUsize, q: &[f64], poses: &mut [Pose]) {
        self.share(threads, q, poses, 1, |q, poses| self.poses_into(q, poses));
    }

    /// [`CompiledChain::tips_into`] shared among threads: for work of many milliseconds, since starting one has a price.
    ///
    /// # Panics
    /// As [`CompiledChain::poses_into`].
    pub fn tips_into_by_threads<T: From<[f64; 3]> + Send>(&self, threads: NonZeroUsize, q: &[f64], tips: &mut [T]) {
        self.share(threads, q, tips, 1, |q, tips| self.tips_into(q, tips));
    }

    /// base_from_tip at many configurations as homogeneous matrices: sixteen numbers each, row by row.
    ///
    /// # Panics
    /// As [`CompiledChain::poses_into`].
    pub fn matrices_into(&self, q: &[f64], matrices: &mut [[f64; 16]]) {
        assert_eq!(q.len(), self.coordinates * matrices.len(), "one value for each coordinate of each configuration");
        dispatch!(self.level, simd => batch::matrices(simd, self, q, matrices));
    }

    /// [`CompiledChain::matrices_into`] shared among threads.
    ///
    /// # Panics
    /// As [`CompiledChain::poses_into`].
    pub fn matrices_into_by_threads(&self, threads: NonZeroUsize, q: &[f64], matrices: &mut [[f64; 16]]) {
        self.share(threads, q, matrices, 1, |q, matrices| self.matrices_into(q, matrices));
    }

    /// Jacobians at many configurations: `jacobians` takes 6 × [`CompiledChain::coordinates`] numbers for each, row by
    /// row, the angular rows first.
    ///
    /// # Panics
    /// The lengths of `q` and `jacobians` do not match.
    pub fn jacobians_into(&self, frame: JacobianFrame, q: &[f64], jacobians: &mut [f64]) {
        assert_eq!(6 * q.len(), jacobians.len(), "six numbers for each coordinate of each configuration");
        if !q.is_empty() {
            dispatch!(self.level, simd => batch::jacobians(simd, self, frame, q, jacobians));
        }
    }

    /// [`CompiledChain::jacobians_into`] shared among threads.
    ///
    /// # Panics
    /// As [`CompiledChain::jacobians_into`].
    pub fn jacobians_into_by_threads(
        &self,
        threads: NonZeroUsize,
        frame: JacobianFrame,
        q: &[f64],
        jacobians: &mut [f64],
    ) {
        let width = 6 * self.coordinates.max(1);
        self.share(threads, q, jacobians, width, |q, jacobians| self.jacobians_into(frame, q, jacobians));
    }

    /// `width` results belong to each configuration.
    fn share<T: Send>(
        &self,
        threads: NonZeroUsize,
        q: &[f64],
        results: &mut [T],
        width: usize,
        work: impl Fn(&[f64], &mut [T]) + Sync,
    ) {
        let count = results.len() / width;
        assert_eq!(q.len(), self.coordinates * count, "one value for each coordinate of each configuration");
        let each = count.div_ceil(threads.get()) * width;
        if each == results.len() || each == 0 {
            return work(q, results);
        }
        std::thread::scope(|scope| {
            let work = &work;
            let mut rest = q;
            for part in results.chunks_mut(each) {
                let mine;
                (mine, rest) = rest.split_at(self.coordinates * (part.len() / width));
                scope.spawn(move || work(mine, part));
            }
        });
    }
}

#[cfg(target_arch = "x86_64")]
fn narrowed(level: Level, bits: usize) -> Option<Level> {
    match bits {
        512 => level.as_avx512().map(Level::Avx512),
        256 => level.as_avx2().map(Level::Avx2),
        128 => level.as_sse2().map(Level::Sse2),
        _ => None,
    }
}

#[cfg(not(target_arch = "x86_64"))]
fn narrowed(level: Level, bits: usize) -> Option<Level> {
    fn width<S: Simd>(_: S) -> usize {
        64 * <S::f64s as fearless_simd::SimdBase<S>>::LEN
    }
    (dispatch!(level, simd => width(simd)) == bits).then_some(level)
}
