//! Bands of error curves and intervals of effects hold the truth: a small slice of the study.

use crate::prior_effects::study::study_coverage::{SMOOTH, Share, bands, coefficients};
use denavit_identify::effects::Kind;

#[test]
fn bands_of_curves_hold_the_truth() {
    let found: Vec<(Share, usize, usize)> = (0..3).map(|seed| bands(SMOOTH, 300, 40 + seed)).collect();
    let inside: f64 = found.iter().map(|run| run.0.inside).sum();
    let all: f64 = found.iter().map(|run| run.0.all).sum();
    println!("{:.3} of {all} readings", inside / all);
    assert!(found.iter().all(|run| run.1 >= 2 && run.2 == 0));
    assert!(inside > 0.88 * all, "{inside} of {all}");
}

/// A hundred rows have four values for each of seven waves a curve, too few waves for what these gears do.
#[test]
fn bands_hold_the_truth_in_few_rows_too() {
    let found: Vec<(Share, usize, usize)> = (0..6).map(|seed| bands(SMOOTH, 100, 40 + seed)).collect();
    let sum = |of: &dyn Fn(&Share) -> f64| found.iter().map(|run| of(&run.0)).sum::<f64>();
    let (inside, all) = (sum(&|share| share.inside), sum(&|share| share.all));
    let (right, wrong) = found.iter().fold((0, 0), |sum, run| (sum.0 + run.1, sum.1 + run.2));
    println!("{:.3} of {all} readings; {right} of 18 curves, {wrong} of others", inside / all);
    assert!(inside > 0.92 * all && sum(&|share| share.squares) < 1.3 * all, "{inside} of {all}");
    assert!(right >= 15 && wrong <= 1, "{right} curves found, {wrong} of others");
}

#[test]
fn an_effect_lies_near_its_truth_by_its_standard_deviation() {
    let found: Vec<Share> = (0..3).filter_map(|seed| coefficients(Kind::JointScale, 150, 60 + seed)).collect();
    assert!(found.len() >= 2);
    assert!(found.iter().all(|share| share.squares / share.all < 9.0), "{found:?}");
}
