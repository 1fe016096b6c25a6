//! Tables of real arms on the branch of their nominal ones.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "tests may stop at once, and say what they saw")]

use denavit_dh::matching::{VendorTable, match_table};
use denavit_dh::nearest::{Nearest, Parallels, nearest};
use denavit_dh::{Convention, DhRow, Motion, Options, Parallelism, Row, Table, TableJoint, ToolPart, convert};
use denavit_model::chain::{Chain, ChainJoint, Coordinate, Quantity};
use denavit_model::nalgebra::{Rotation3, Vector3};
use denavit_model::{Pose, examples, se3};
use proptest::prelude::*;
use std::f64::consts::{FRAC_PI_2, PI};

fn ur(d: [f64; 4], a: [f64; 2]) -> Vec<DhRow> {
    let row = |d: f64, a: f64, alpha: f64| DhRow { theta: 0.0, d, alpha, a };
    vec![
        row(d[0], 0.0, FRAC_PI_2),
        row(0.0, a[0], 0.0),
        row(0.0, a[1], 0.0),
        row(d[1], 0.0, FRAC_PI_2),
        row(d[2], 0.0, -FRAC_PI_2),
        row(d[3], 0.0, 0.0),
    ]
}

fn table_of(rows: &[DhRow]) -> Table {
    let names: Vec<String> = (1..=rows.len()).map(|index| format!("joint_{index}")).collect();
    let joint = |(coordinate, name): (usize, &String)| TableJoint {
        name: name.clone(),
        motion: Motion::Revolute,
        coordinate,
        scale: 1.0,
    };
    Table {
        name: "arm".into(),
        base: "base".into(),
        tip: "tool0".into(),
        coordinates: names.iter().map(|name| Coordinate::unlimited(name.clone(), Quantity::Angle)).collect(),
        joints: names.iter().enumerate().map(joint).collect(),
        rows: std::iter::once(DhRow::default()).chain(rows.iter().copied()).map(Row::Dh).collect(),
        tool: ToolPart::default(),
    }
}

/// Largest difference of the tips, m or rad, over some postures.
fn miss(chain: &Chain, found: &Nearest) -> f64 {
    let mut most = 0.0f64;
    for sample in 0..8 {
        let q: Vec<f64> =
            (0..chain.coordinates().len()).map(|index| (1.3 * f64::from(sample) + index as f64).sin()).collect();
        let (turned, moved) = se3::difference(&chain.fk(&q), &(found.base * found.table.fk(&q) * found.tool));
        most = most.max(turned).max(moved);
    }
    most
}

#[test]
fn what_controllers_add_to_their_ideal_tables_comes_back() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/vendor/ur_calibration/factory_deltas.csv");
    let Ok(text) = std::fs::read_to_string(path) else {
        println!("skipped, because the vendors' files (../shared/vendor) are not beside this clone");
        return;
    };
    let ideal = [
        ("ur10", ur([0.1273, 0.163_941, 0.1157, 0.0922], [-0.612, -0.5723])),
        ("ur10e", ur([0.1807, 0.17415, 0.11985, 0.11655], [-0.6127, -0.57155])),
    ];
    for robot in ["A", "B", "C"] {
        let lines: Vec<Vec<&str>> =
            text.lines().map(|line| line.split(',').collect()).filter(|cells: &Vec<&str>| cells[0] == robot).collect();
        let nominal = &ideal.iter().find(|(name, _)| *name == lines[0][1]).unwrap().1;
        let actual: Vec<DhRow> = nominal
            .iter()
            .zip(&lines)
            .map(|(row, cells)| {
                let added: Vec<f64> = cells[3..].iter().map(|cell| cell.parse().unwrap()).collect();
                DhRow {
                    theta: row.theta + added[0],
                    d: row.d + added[1],
                    a: row.a + added[2],
                    alpha: row.alpha + added[3],
                }
            })
            .collect();
        let chain = table_of(&actual).chain().unwrap();
        let given = table_of(nominal);
        let found = nearest(&chain, &given, Parallels::Hayati).unwrap();
        assert!(miss(&chain, &found) < 1e-10, "{robot}: {}", miss(&chain, &found));
        for (row, nominal) in found.table.rows[1..].iter().zip(nominal) {
            // A calibrated arm is near its drawing in every number.
            let angles = [row.theta() - nominal.theta, row.alpha() - nominal.alpha, row.beta().unwrap_or_default()];
            let lengths = [row.a() - nominal.a, row.d().unwrap_or_default() - nominal.d];
            assert!(angles.iter().all(|angle| angle.abs() < 0.1), "{robot}: {row:?}");
            assert!(lengths.iter().all(|length| length.abs() < 0.005), "{robot}: {row:?}");
        }
        // In the controller's own four numbers, where d is of any size.
        let found = nearest(&chain, &given, Parallels::Dh).unwrap();
        assert!(miss(&chain, &found) < 1e-9, "{robot}: {}", miss(&chain, &found));
        if robot != "C" {
            // C's controller has taken the other of the two normals: no table is nearer to its nominal one than a quarter turn.
            for (row, actual) in found.table.rows[1..].iter().zip(&actual) {
                let turns = (row.theta() - actual.theta) / (2.0 * PI);
                assert!((turns - turns.round()).abs() < 1e-8, "{robot}: {row:?} {actual:?}");
                assert!(
                    (row.d().unwrap_or_default() - actual.d).abs() < 1e-6 * (1.0 + actual.d.abs()),
                    "{robot}: {row:?} {actual:?}"
                );
                assert!((row.a() - actual.a).abs() < 1e-8, "{robot}: {row:?} {actual:?}");
            }
        }
    }
}

#[test]
fn an_arm_in_other_frames_is_given_in_those_of_the_table() {
    let chain = examples::puma_like();
    let table = convert::table(&chain, &Options::default()).unwrap().value;
    let vendor = VendorTable::of(&table, Convention::Distal, false);
    let found = match_table(&chain, &vendor).unwrap();
    let own = found.placement.in_frames_of_the_table(&chain).unwrap();
    let again = nearest(&own, &table, Parallels::Hayati).unwrap();
    assert!(miss(&own, &again) < 1e-12);
    for (row, expected) in again.table.rows[1..6].iter().zip(&table.rows[1..6]) {
        assert!(
            (row.a() - expected.a()).abs() < 1e-9 && (row.alpha() - expected.alpha()).abs() < 1e-9,
            "{row:?} {expected:?}"
        );
    }
}

/// Axes turned and moved a little.
fn disturbed(chain: &Chain, by: &[[f64; 6]]) -> Chain {
    let joints = chain.joints().iter().zip(by).map(|(joint, [a, b, c, x, y, z])| {
        let turn = Rotation3::from_euler_angles(1e-3 * a, 1e-3 * b, 1e-3 * c);
        let step = se3::pose(turn, Vector3::new(*x, *y, *z) * 1e-3);
        ChainJoint { screw: joint.screw.moved(&step), ..joint.clone() }
    });
    let names = (chain.name(), chain.base(), chain.tip());
    Chain::new(names, chain.coordinates().to_vec(), joints.collect(), *chain.home()).unwrap()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn the_table_of_an_arm_near_its_drawing_moves_as_the_arm(
        by in prop::collection::vec(prop::array::uniform6(-1.0..1.0f64), 8), which in 0..8usize) {
        let arms = examples::all();
        let arm = &arms[which % arms.len()];
        let options = Options { parallelism: Parallelism::Exact, ..Options::default() };
        let given = convert::table(arm, &options).unwrap().value;
        let chain = disturbed(arm, &by);
        for parallels in [Parallels::Hayati, Parallels::Dh] {
            let found = nearest(&chain, &given, parallels).unwrap();
            prop_assert!(miss(&chain, &found) < 1e-9, "{}", miss(&chain, &found));
            let alone = Nearest { base: Pose::identity(), table: found.in_one_table(), tool: Pose::identity() };
            prop_assert!(miss(&chain, &alone) < 1e-9, "{}", miss(&chain, &alone));
        }
        let found = nearest(&chain, &given, Parallels::Hayati).unwrap();
        let slides = given.joints.iter().any(|joint| joint.motion == Motion::Prismatic);
        for (row, given) in found.table.rows.iter().zip(&given.rows).filter(|_| !slides) {
            prop_assert!((row.theta() - given.theta()).abs() < 0.2, "{row:?} {given:?}");
            prop_assert!((row.alpha() - given.alpha()).abs() < 0.02, "{row:?} {given:?}");
        }
    }
}
