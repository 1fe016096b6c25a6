//! What noise is made of: against a dense likelihood in numpy, and on simulated runs whose noise is known.

#[path = "../examples/study_noise.rs"]
#[allow(dead_code, reason = "the study has a main of its own")]
mod study;

use denavit_identify::noise::reml::{Factor, LEAST_LEVEL, Reml, RowBlock, Tied};
use denavit_model::examples::puma_like;
use denavit_model::nalgebra::{DMatrix, DVector};
use serde::Deserialize;
use study::{World, file, found, tallied, worlds};

#[derive(Deserialize)]
struct Row {
    residual: Vec<f64>,
    columns: Vec<Vec<f64>>,
    factors: Vec<Vec<Vec<f64>>>,
}

/// A line of what `tests/oracle/calibration/noise.py` writes.
#[derive(Deserialize)]
struct RemlCase {
    rows: Vec<Row>,
    prior: Vec<Vec<f64>>,
    pull: Vec<f64>,
    variances: Vec<f64>,
    deviance: f64,
    interval_of_last: Option<[f64; 2]>,
}

fn reml(case: &RemlCase) -> Reml {
    let block = |row: &Row| RowBlock {
        residual: row.residual.clone(),
        columns: row.columns.concat(),
        factors: row
            .factors
            .iter()
            .enumerate()
            .map(|(source, columns)| Factor { source, cells: columns.concat() })
            .collect(),
        has_next: false,
    };
    let count = case.pull.len();
    let prior = DMatrix::from_fn(count, count, |i, k| case.prior[i][k]);
    let least = vec![LEAST_LEVEL; case.variances.len()];
    Reml::new(case.rows.iter().map(block).collect(), prior, DVector::from_column_slice(&case.pull), least)
}

#[test]
fn variances_are_those_of_a_dense_likelihood_in_numpy() {
    let Ok(path) = std::env::var("DENAVIT_NOISE_ORACLE") else {
        println!("skipped, because DENAVIT_NOISE_ORACLE names no file of cases; tests/run makes it");
        return;
    };
    let cases: Vec<RemlCase> = serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap();
    for case in &cases {
        let reml = reml(case);
        let count = case.variances.len();
        let tied = Tied::each(count);
        let found = reml.likeliest(&tied, &vec![1.0; count], &[], 0.0).unwrap();
        println!("{:?} after {} steps; numpy {:?}", found.numbers, found.steps, case.variances);
        assert!((found.slope.deviance - case.deviance).abs() < 1e-6, "{} {}", found.slope.deviance, case.deviance);
        for (own, other) in found.numbers.iter().zip(&case.variances) {
            assert!((own - other).abs() < 1e-4 * other, "{own} {other}");
        }
        for end in case.interval_of_last.iter().flatten() {
            let mut start = found.numbers.clone();
            start[count - 1] = *end;
            let held = reml.likeliest(&tied, &start, &[count - 1], 0.0).unwrap();
            // At the ends that scipy found the profile has risen by χ² of one degree of freedom.
            let rise = held.slope.deviance - found.slope.deviance;
            assert!((rise - 3.841_459).abs() < 1e-3, "{rise}");
        }
    }
}

fn world(name: &str) -> World {
    worlds().into_iter().find(|world| world.name == name).unwrap()
}

#[test]
fn white_noise_claims_nothing_but_its_size() {
    for name in ["white", "white, poses", "white, t with 5 degrees of freedom"] {
        let (tallies, [wrong, order, lever]) = tallied(&puma_like(), &world(name), 120, 0..6);
        // One clean file in a hundred may claim a source, and one an order of the run.
        assert!(wrong == 0 && order <= 1 && lever == 0, "{name}: {wrong} {order} {lever} {tallies:?}");
        let position = &tallies["position"];
        assert_eq!(position.claimed, 6, "{name}: {position:?}");
        assert!(position.inside >= 4, "{name}: {position:?}");
    }
}

#[test]
fn what_noise_is_made_of_is_found_within_its_interval() {
    let range = tallied(&puma_like(), &world("range"), 120, 0..5).0;
    assert!(range["range"].claimed == 5 && range["range"].inside >= 4, "{range:?}");
    let angle = tallied(&puma_like(), &world("range and angle"), 120, 0..5).0;
    assert!(angle["angle"].claimed >= 4 && angle["angle"].inside >= 4, "{angle:?}");
    let joints = tallied(&puma_like(), &world("joints 1 to 3, poses"), 160, 0..5).0;
    for joint in ["joint_1", "joint_2", "joint_3"] {
        assert!(joints[joint].claimed >= 4 && joints[joint].inside >= 4, "{joint}: {joints:?}");
    }
    for joint in ["joint_4", "joint_5", "joint_6"] {
        assert!(joints[joint].claimed <= 1, "{joint}: {joints:?}");
    }
}

#[test]
fn a_probe_that_turns_about_a_point_of_its_own_is_found_with_its_lever() {
    for name in ["poses of a probe that turns about a point 0.5 m away", "the same, joints alike"] {
        let world = world(name);
        let mut off = 0.0;
        for seed in 0..5 {
            let noise = found(&puma_like(), &file(&puma_like(), &world, 120, 7_000 + seed));
            let lever = noise.lever.unwrap_or_else(|| panic!("{name}, file {seed}: no lever"));
            println!("{name}: {lever:?}");
            for ((value, std), truth) in lever.value.iter().zip(lever.std).zip(world.lever) {
                assert!(std < 0.2, "{lever:?}");
                off += ((value - truth) / std).powi(2);
            }
            let position = noise.components.iter().find(|of| of.name == "position").unwrap();
            assert!(
                position.claimed && position.low < 4e-5,
                "what the lever makes is no noise of positions: {position:?}"
            );
        }
        // χ² of fifteen degrees of freedom: one in a thousand has more than 37.7.
        assert!(off < 37.7, "{name}: {off}");
    }
}

#[test]
fn joints_that_are_taken_as_alike_have_bounds_of_their_own() {
    // So little of each joint that none is claimed by itself.
    let world = World { repeatability: [5e-5; 6], ..world("white") };
    let mut asked = 0;
    for seed in 0..6 {
        let noise = found(&puma_like(), &file(&puma_like(), &world, 60, 8_000 + seed));
        let mut joints = noise.components.iter().filter(|of| of.name == "repeatability");
        if joints.clone().any(|of| of.joint.is_none() && of.claimed) {
            asked += 1;
            assert!(joints.all(|of| of.high.is_none_or(|high| high > 1e-5)), "{:?}", noise.components);
        }
    }
    assert!(asked > 0, "all joints alike are claimed in no file");
}
