//! Parameters of ortho-parallel arms come back from their chains.

#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "a test stops at what it did not expect, and says what it skips"
)]

use denavit_dh::opw::{OpwFit, OrthoParallelWrist};
use denavit_model::nalgebra::{Vector3, Vector6};
use denavit_model::{Chain, se3};
use proptest::prelude::*;
use std::path::Path;

fn comes_back(arm: &OrthoParallelWrist) -> OpwFit {
    let chain = arm.chain("arm").unwrap();
    let fit = OpwFit::of(&chain).unwrap_or_else(|error| panic!("{arm:?}: {error}"));
    let size = chain.size();
    assert!(fit.position_error < 1e-12 * size && fit.rotation_error < 1e-12, "{arm:?}\n{fit:?}");
    fit
}

#[test]
fn published_parameters_come_back() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/vendor/opw_parameters.csv");
    let Ok(text) = std::fs::read_to_string(file) else {
        println!("skipped, because the vendors' files (../shared/vendor) are not beside this clone");
        return;
    };
    let (mut count, mut same) = (0, 0);
    for line in text.lines().skip(1) {
        let cells: Vec<&str> = line.split(',').collect();
        let number = |index: usize| cells[index].parse::<f64>().unwrap();
        let six = |index: usize| -> [f64; 6] {
            let numbers: Vec<f64> = cells[index].split(' ').map(|word| word.parse().unwrap()).collect();
            numbers.try_into().unwrap()
        };
        let arm = OrthoParallelWrist {
            a1: number(1),
            a2: number(2),
            b: number(3),
            c1: number(4),
            c2: number(5),
            c3: number(6),
            c4: number(7),
            offsets: six(8),
            signs: six(9),
        };
        let fit = comes_back(&arm).parameters;
        count += 1;
        let near = |a: f64, b: f64| (a - b).abs() < 1e-9;
        same +=
            usize::from(near(fit.a1, arm.a1) && near(fit.a2, arm.a2) && near(fit.c3, arm.c3) && fit.signs == arm.signs);
    }
    println!("{count} published arms come back, {same} with the published signs and lengths");
    assert!(count > 10, "{count}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]
    #[test]
    fn parameters_at_random_come_back(
        lengths in prop::array::uniform7(-0.8..0.8f64),
        upper in 0.1..1.0f64,
        offsets in prop::array::uniform6(-3.0..3.0f64),
        signs in prop::array::uniform6(any::<bool>()),
    ) {
        let [a1, a2, b, c1, c3, c4, _] = lengths;
        let signs = signs.map(|sign| if sign { 1.0 } else { -1.0 });
        let arm = OrthoParallelWrist { a1, a2, b, c1, c2: upper, c3, c4, offsets, signs };
        comes_back(&arm);
    }
}

#[test]
fn other_arms_are_refused_and_near_ones_say_how_near() {
    let refused = |chain: &Chain| OpwFit::of(chain).unwrap_err().to_string();
    let planar = denavit_model::examples::planar_arm();
    assert!(refused(&planar).contains("six revolute joints"), "{}", refused(&planar));
    let arm = OrthoParallelWrist {
        a1: 0.1,
        a2: -0.1,
        b: 0.0,
        c1: 0.4,
        c2: 0.5,
        c3: 0.5,
        c4: 0.1,
        offsets: [0.0; 6],
        signs: [1.0; 6],
    };
    let chain = arm.chain("arm").unwrap();
    let moved = |twist: Vector6<f64>, which: usize| {
        let screw = |(k, joint): (usize, &denavit_model::ChainJoint)| {
            if k == which { joint.screw.moved(&se3::exp(&twist)) } else { joint.screw }
        };
        let screws: Vec<_> = chain.joints().iter().enumerate().map(screw).collect();
        chain.with_geometry(&screws, *chain.home()).unwrap()
    };
    let sideways = Vector6::new(0.0, 0.0, 0.0, 0.0, 0.001, 0.0);
    let near = OpwFit::of(&moved(sideways, 3)).unwrap();
    assert!(near.position_error > 1e-4 && near.position_error < 5e-3, "{near:?}");
    let far = moved(sideways * 100.0, 3);
    assert!(refused(&far).contains("do not meet in a point"), "{}", refused(&far));
    let tilted = moved(Vector6::new(0.3, 0.0, 0.0, 0.0, 0.0, 0.0), 1);
    assert!(refused(&tilted).contains("axis 2 is not perpendicular to axis 1"), "{}", refused(&tilted));
    let tool = chain.with_geometry(
        &chain.joints().iter().map(|joint| joint.screw).collect::<Vec<_>>(),
        chain.home() * se3::pose(se3::rotation_about(&Vector3::y(), 1.0), Vector3::zeros()),
    );
    assert!(refused(&tool.unwrap()).contains("is not the z axis of \"tool0\""));
}
