//! Comparison of two robots: the sampled displacement of the tip.

use denavit_benches::{ROBOTS, chain, report};
use denavit_compare::{Options, Subject, compare};
use denavit_model::nalgebra::Vector3;
use denavit_model::se3;
use std::hint::black_box;

/// A 7R arm and the same with every axis moved by a millimetre, 100 000 configurations sampled; beside it, none.
pub fn comparison() {
    let (robot, file, tip) = ROBOTS[1];
    let drawn = chain(file, tip);
    let moved = drawn.joints().iter().enumerate().map(|(k, joint)| {
        let by = 1e-3 * Vector3::new((k as f64).sin(), (k as f64).cos(), 0.3);
        joint.screw.moved(&se3::translation(by))
    });
    let built = drawn.with_geometry(&moved.collect::<Vec<_>>(), *drawn.home()).expect("a chain like the drawn one");
    let sides = (Subject::Chain { file: "drawn", chain: &drawn }, Subject::Chain { file: "built", chain: &built });
    for (samples, who) in
        [(100_000, "denavit, compared at 100 000 configurations"), (1, "denavit, compared without sampling")]
    {
        let options = Options { samples, ..Options::default() };
        report(robot, who, "comparison", 1, || _ = black_box(compare(&sides.0, &sides.1, &options)));
    }
}
