//! Fits to runs made by pinocchio. `tests/run` makes the file (`tests/oracle/calibration/runs.py slice`) and names it in
//! `DENAVIT_CALIBRATION_ORACLE`.

#![allow(clippy::unwrap_used, clippy::print_stdout)] // Tests: a panic is a failure, what is printed is read.

use crate::runs::{self, Run, Score};
use denavit_calibrate::{Freedom, IdentifyOptions};
use denavit_identify::identifiability::identifiability;
use denavit_identify::parameters::NoEffects;
use denavit_identify::quantization;
use std::collections::BTreeMap;

/// The runs whose case holds this word.
fn runs_of(wanted: impl Fn(&str) -> bool) -> Vec<Run> {
    let Ok(path) = std::env::var("DENAVIT_CALIBRATION_ORACLE") else {
        println!("skipped, because DENAVIT_CALIBRATION_ORACLE names no file of runs; tests/run makes it");
        return Vec::new();
    };
    let text = std::fs::read_to_string(&path).unwrap();
    let found: Vec<Run> = text.lines().filter(|line| wanted(runs::case_of(line))).map(Run::parse).collect();
    assert!(!found.is_empty(), "{path} holds no such run");
    found
}

#[test]
fn noise_free_data_are_recovered_on_unseen_poses() {
    for run in runs_of(|case| case.contains("noise-free") && !case.contains("still")) {
        let found = run.identify().geometric;
        let (_, largest) = run.unseen(&found.arm);
        println!("{}: {largest:.1e} m after {} iterations", run.case, found.iterations);
        assert!(largest < 1e-12 && found.converged, "{}: {largest:e}", run.case);
    }
}

/// The model's error on noise-free unseen poses is known to a share of √(2/p) per run: the noise of test rows is added
/// as its expectation instead of drawn, which no number of test rows could do better. Eight runs of 30 parameters
/// against 600 values leave 0.3 %.
#[test]
fn held_out_error_is_what_is_attainable() {
    let mut by_case: BTreeMap<String, Vec<Score>> = BTreeMap::new();
    for run in runs_of(|case| case.ends_with(", 200")) {
        let score = Score::of(&run, &run.identify());
        by_case.entry(run.case).or_default().push(score);
    }
    let (mut inside, mut parameters, mut chi, mut freedom) = (0.0, 0.0, 0.0, 0.0);
    for (case, scores) in &by_case {
        let mean = |of: fn(&Score) -> f64| scores.iter().map(of).sum::<f64>() / scores.len() as f64;
        let reached = (1.0 + mean(|score| score.unseen)).sqrt();
        let formula = reached / (1.0 + mean(|score| score.load)).sqrt();
        let best = reached / (1.0 + mean(|score| score.attainable)).sqrt();
        println!("{case}: error {formula:.4} of floor·√(1 + p/N), {best:.4} of the Cramér-Rao bound");
        assert!((formula - 1.0).abs() < 0.03 && (best - 1.0).abs() < 0.03, "{case}: {formula} {best}");
        let total = |of: fn(&Score) -> f64| scores.iter().map(of).sum::<f64>();
        inside += total(|score| score.inside);
        parameters += total(|score| score.parameters);
        chi += total(|score| score.chi_squared);
        freedom += total(|score| score.degrees_of_freedom);
    }
    if by_case.is_empty() {
        return;
    }
    let (covered, chi) = (inside / parameters, chi / freedom);
    println!("95 % intervals cover {:.2} %, chi2/dof {chi:.4}", 100.0 * covered);
    assert!((0.94..0.96).contains(&covered), "{covered}");
    assert!((chi - 1.0).abs() < 0.02, "{chi}");
}

#[test]
fn outliers_are_listed_and_leave_the_noise_level_alone() {
    let runs = runs_of(|case| case.contains(", 300") && !case.contains("grid"));
    // Each clean run is followed by the same with outliers.
    for pair in runs.chunks_exact(2) {
        let [clean, run] = pair else { unreachable!() };
        let (of_clean, fit) = (clean.identify().geometric, run.identify().geometric);
        let ratio = fit.noise.first() / of_clean.noise.first();
        let unseen = (1.0 + (run.unseen(&fit.arm).0 / run.noise[0]).powi(2)).sqrt()
            / (1.0 + (clean.unseen(&of_clean.arm).0 / run.noise[0]).powi(2)).sqrt();
        println!("{}: {} rejected, noise {ratio:.4}, error {unseen:.4}", run.case, run.outliers.len());
        assert_eq!((run.rejected(&of_clean), run.rejected(&fit)), (vec![], run.outliers.clone()), "{}", run.case);
        assert_eq!(run.outliers.len(), 15);
        assert!((ratio - 1.0).abs() < 0.05 && (unseen - 1.0).abs() < 0.05, "{}: {ratio} {unseen}", run.case);
    }
}

#[test]
fn parallel_axes_converge_in_six_iterations() {
    for run in runs_of(|case| case.contains("2 mrad")) {
        let fit = run.identify().geometric;
        println!("{}: {} iterations", run.case, fit.iterations);
        assert!(fit.converged && fit.iterations <= 6, "{}: {}", run.case, fit.iterations);
    }
}

#[test]
fn rank_is_pinocchios_and_the_papers_count() {
    for run in runs_of(|case| case.contains("noise-free") && !case.contains("still") && !case.contains("10000")) {
        let freedom = Freedom::axes(run.chain.joints().len());
        let found = identifiability(&run.train, &run.identify().geometric.arm, &NoEffects, &freedom);
        println!("{}: {} = {}, rank {}", run.case, found.formula, found.expected, found.rank);
        assert_eq!((Some(found.rank), found.rank), (run.rank, found.expected), "{}", run.case);
    }
}

#[test]
fn a_joint_that_never_moves_is_named_and_its_neighbours_are_found() {
    for run in runs_of(|case| case.contains("still")) {
        let fit = run.identify().geometric;
        let freedom = Freedom::axes(run.chain.joints().len());
        let found = identifiability(&run.train, &fit.arm, &NoEffects, &freedom);
        let still = &run.chain.joints()[2];
        assert_eq!(Some(found.rank), run.rank, "{}", run.case);
        assert!(!found.unidentifiable.is_empty());
        for unidentifiable in &found.unidentifiable {
            assert!(
                unidentifiable.joint == still.name && unidentifiable.why.contains("never moves"),
                "{}: {unidentifiable:?}",
                run.case
            );
        }
        // It stands still in the unseen poses too.
        let (_, largest) = run.unseen(&fit.arm);
        println!("{}: rank {}, {} named, unseen {largest:.1e} m", run.case, found.rank, still.name);
        assert!(largest < 1e-12, "{}: {largest:e}", run.case);
        let change = fit.arm.change(2);
        let moved = [change.turned, change.moved].concat().iter().fold(0.0f64, |a, b| a.max(b.abs()));
        assert!(moved < 1e-6, "{}: {change:?}", run.case);
    }
}

#[test]
fn rounded_readings_are_noticed_and_their_share_is_right() {
    for run in runs_of(|case| case.contains("grid")) {
        let options = IdentifyOptions::axes(&run.chain);
        let fit = denavit_identify::identify(&run.chain, &run.train, &options).geometric;
        let rounding = quantization::rounding(&fit.arm, &run.train).unwrap();
        println!("{}: {rounding}; drawn {:.3} mm", run.case, run.rounding * 1e3);
        assert!((rounding.error / run.rounding - 1.0).abs() < 0.1, "{}: {rounding}", run.case);
        // Noise and rounding add up to what the fit finds.
        let both = (run.noise[0].powi(2) + run.rounding.powi(2) / 3.0).sqrt();
        assert!((fit.noise.first() / both - 1.0).abs() < 0.06, "{}: {} {both}", run.case, fit.noise.first());
        assert_eq!(run.train.scene.measured(), "position");
    }
}
