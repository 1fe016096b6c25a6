//! Bands of error curves and intervals of effects hold the truth: a small slice of the study.

use crate::prior_effects::study::study_coverage::{Share, bands, coefficients};
use denavit_calibrate::effects::Kind;

#[test]
fn bands_of_curves_hold_the_truth() {
    let found: Vec<(Share, usize, usize)> = (0..3).map(|seed| bands(300, 40 + seed)).collect();
    let inside: f64 = found.iter().map(|run| run.0.inside).sum();
    let all: f64 = found.iter().map(|run| run.0.all).sum();
    println!("{:.3} of {all} readings", inside / all);
    assert!(found.iter().all(|run| run.1 >= 2 && run.2 == 0));
    assert!(inside > 0.88 * all, "{inside} of {all}");
}

#[test]
fn an_effect_lies_near_its_truth_by_its_standard_deviation() {
    let found: Vec<Share> = (0..3).filter_map(|seed| coefficients(Kind::JointScale, 150, 60 + seed)).collect();
    assert!(found.len() >= 2);
    assert!(found.iter().all(|share| share.squares / share.all < 9.0), "{found:?}");
}
