//! Forward kinematics: the plain chain, the compiled one, and batches at each width of vector.

use denavit_benches::{BATCH, ROBOTS, chain, configurations, report};
use denavit_model::nalgebra::Point3;
use denavit_model::{CompiledChain, Pose};
use std::hint::black_box;
use std::num::NonZeroUsize;

pub fn single() {
    for (robot, file, tip) in ROBOTS {
        let chain = chain(file, tip);
        let n = chain.coordinates().len();
        let q = configurations(n, BATCH);
        let each = |fk: &dyn Fn(&[f64]) -> Pose| q.chunks(n).for_each(|q| _ = black_box(fk(black_box(q))));
        report(robot, "denavit plain", "fk", BATCH, || each(&|q| chain.fk(q)));
        for bits in [256, 128] {
            let Some(compiled) = CompiledChain::with_vector_bits(&chain, bits) else { continue };
            report(robot, &format!("denavit compiled, {bits} bits"), "fk", BATCH, || each(&|q| compiled.fk(q)));
        }
        report(robot, "denavit", "compiling the chain", 100, || {
            (0..100).for_each(|_| _ = black_box(CompiledChain::new(black_box(&chain))));
        });
    }
}

pub fn batch() {
    for (robot, file, tip) in ROBOTS {
        let chain = chain(file, tip);
        let q = configurations(chain.coordinates().len(), BATCH);
        let (mut poses, mut tips) = (vec![Pose::identity(); BATCH], vec![Point3::origin(); BATCH]);
        for bits in [512, 256, 128] {
            let Some(compiled) = CompiledChain::with_vector_bits(&chain, bits) else { continue };
            report(robot, &format!("denavit poses, {bits} bits"), "batch", BATCH, || {
                compiled.poses_into(black_box(&q), black_box(&mut poses));
            });
            report(robot, &format!("denavit tips, {bits} bits"), "batch", BATCH, || {
                compiled.tips_into(black_box(&q), black_box(&mut tips));
            });
        }
    }
}

/// 100 000 configurations of the 7R in one call, like a sampler's.
pub fn many() {
    let count = 100_000;
    let (robot, file, tip) = ROBOTS[1];
    let chain = chain(file, tip);
    let compiled = CompiledChain::new(&chain);
    let q = configurations(chain.coordinates().len(), count);
    let mut tips = vec![Point3::origin(); count];
    let all = std::thread::available_parallelism().unwrap_or(NonZeroUsize::MIN);
    for (who, threads) in [("100 000 tips, one thread", NonZeroUsize::MIN), ("100 000 tips, every core", all)] {
        report(robot, who, "many", 1, || compiled.tips_into_by_threads(threads, black_box(&q), black_box(&mut tips)));
    }
}
