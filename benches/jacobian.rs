//! Jacobians at one configuration, pose of the tip included.

use denavit_benches::{BATCH, ROBOTS, chain, configurations, report};
use denavit_model::nalgebra::Vector6;
use denavit_model::{CompiledChain, Pose};
use std::hint::black_box;

/// Fills the columns at a configuration.
type Jacobian<'a> = &'a dyn Fn(&[f64], &mut [Vector6<f64>]) -> Pose;

pub fn single() {
    for (robot, file, tip) in ROBOTS {
        let chain = chain(file, tip);
        let n = chain.coordinates().len();
        let q = configurations(n, BATCH);
        let mut columns = vec![Vector6::zeros(); n];
        let mut each = |jacobian: Jacobian| {
            q.chunks(n).for_each(|q| _ = black_box(jacobian(black_box(q), black_box(&mut columns))));
        };
        let plain = |q: &[f64], columns: &mut [Vector6<f64>]| chain.tip_jacobian_into(q, columns);
        report(robot, "denavit plain", "jacobian", BATCH, || each(&plain));
        for bits in [256, 128] {
            let Some(compiled) = CompiledChain::with_vector_bits(&chain, bits) else { continue };
            report(robot, &format!("denavit compiled, {bits} bits"), "jacobian", BATCH, || {
                each(&|q, columns| compiled.tip_jacobian_into(q, columns));
            });
        }
    }
}
