//! Comparison of two robots: the sampled displacement of the tip.

use denavit_benches::{ROBOTS, chain, moved_axes, report};
use denavit_compare::{Options, Subject, compare};
use std::hint::black_box;

/// A 7R arm and the same with every axis moved by a millimetre, with 100 000 sampled configurations and with none.
pub fn comparison() {
    let (robot, file, tip) = ROBOTS[1];
    let drawn = chain(file, tip);
    let built = moved_axes(&drawn);
    let sides = (Subject::Chain { file: "drawn", chain: &drawn }, Subject::Chain { file: "built", chain: &built });
    for (samples, who) in
        [(100_000, "denavit, compared at 100 000 configurations"), (1, "denavit, compared without sampling")]
    {
        let options = Options { samples, ..Options::default() };
        report(robot, who, "comparison", 1, || _ = black_box(compare(&sides.0, &sides.1, &options)));
    }
}
