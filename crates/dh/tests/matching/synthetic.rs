//! Tables made at random, and robots made of them in random frames, senses and zeros: a match finds its way back.

use denavit_dh::matching::{Match, NumberMatch, Sense, VendorJoint, VendorRow, VendorTable, Verdict, match_table};
use denavit_dh::{Convention, Motion, RowLabel};
use denavit_model::chain::{Chain, ChainJoint, Coordinate, Quantity};
use denavit_model::nalgebra::{Point3, Unit, Vector3, Vector6};
use denavit_model::screw::{AxisLine, Screw};
use denavit_model::se3::{self, Pose};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;
use std::f64::consts::{FRAC_PI_2, PI};

#[derive(Debug, Clone)]
struct RowOf {
    slides: bool,
    numbers: [f64; 4],
    reversed: bool,
    zero: f64,
}

fn row(alphas: impl Strategy<Value = f64> + 'static, sparse: bool) -> impl Strategy<Value = RowOf> {
    let length = if sparse {
        prop_oneof![Just(0.0), 0.05..0.6f64, -0.6..-0.05f64].boxed()
    } else {
        prop_oneof![0.05..0.6f64, -0.6..-0.05f64].boxed()
    };
    let theta = prop_oneof![Just(0.0), Just(FRAC_PI_2), -PI..PI];
    let zero = prop_oneof![2 => Just(0.0), 1 => Just(PI), 1 => Just(FRAC_PI_2), 1 => -3.0..3.0f64];
    (prop::bool::weighted(0.15), theta, length.clone(), alphas, length, any::<bool>(), zero).prop_map(
        |(slides, theta, d, alpha, a, reversed, zero)| RowOf { slides, numbers: [theta, d, alpha, a], reversed, zero },
    )
}

/// Every kind of neighbour: parallel, anti-parallel, right angles, odd angles, meeting and coincident axes.
fn any_row() -> impl Strategy<Value = RowOf> {
    row(prop_oneof![Just(0.0), Just(PI), Just(FRAC_PI_2), Just(-FRAC_PI_2), 0.2..2.9f64, -2.9..-0.2f64], true)
}

/// Skew turning axes: no number is gauge but those of the ends.
fn skew_row() -> impl Strategy<Value = RowOf> {
    row(prop_oneof![Just(FRAC_PI_2), Just(-FRAC_PI_2), 0.3..2.8f64, -2.8..-0.3f64], false)
        .prop_map(|row| RowOf { slides: false, ..row })
}

fn vendor_of(rows: &[RowOf], convention: Convention) -> VendorTable {
    let joint = |row: &RowOf| VendorJoint {
        name: None,
        motion: if row.slides { Motion::Prismatic } else { Motion::Revolute },
        row: VendorRow {
            theta: Some(row.numbers[0].into()),
            d: Some(row.numbers[1].into()),
            alpha: Some(row.numbers[2].into()),
            a: Some(row.numbers[3].into()),
            beta: None,
        },
    };
    VendorTable { convention, base: None, joints: rows.iter().map(joint).collect(), tool: None }
}

fn turn(axis: Vector3<f64>, angle: f64) -> Pose {
    se3::pose(se3::rotation_about(&axis, angle), Vector3::zeros())
}

/// robot(q) = B · table(sense q + zero) · E, written down without the code under test.
fn robot_of(rows: &[RowOf], convention: Convention, base: [f64; 6], tool: [f64; 6]) -> Chain {
    let mut reached = se3::exp(&Vector6::from(base));
    let mut joints = Vec::new();
    for (index, row) in rows.iter().enumerate() {
        let [theta, d, alpha, a] = row.numbers;
        let twist = turn(Vector3::x(), alpha) * se3::translation(Vector3::x() * a);
        if convention == Convention::Proximal {
            reached *= twist;
        }
        let direction = Unit::new_normalize(reached.rotation * Vector3::z());
        let sense = if row.reversed { -1.0 } else { 1.0 };
        let direction = Unit::new_unchecked(direction.into_inner() * sense);
        let point = Point3::from(reached.translation.vector);
        let screw =
            if row.slides { Screw::Prismatic(direction) } else { Screw::Revolute(AxisLine { direction, point }) };
        joints.push(ChainJoint { name: format!("j{index}"), screw, coordinate: index, scale: 1.0, offset: 0.0 });
        let (turned, slid) = if row.slides { (0.0, 0.1 * row.zero) } else { (row.zero, 0.0) };
        reached *= turn(Vector3::z(), theta + turned) * se3::translation(Vector3::z() * (d + slid));
        if convention != Convention::Proximal {
            reached *= twist;
        }
    }
    let coordinates = rows.iter().enumerate().map(|(index, row)| {
        Coordinate::unlimited(format!("j{index}"), if row.slides { Quantity::Length } else { Quantity::Angle })
    });
    let home = reached * se3::exp(&Vector6::from(tool));
    Chain::new(("made", "base", "tip"), coordinates.collect(), joints, home).unwrap()
}

fn needed(found: &Match) -> usize {
    let mentioned = |zero: f64| usize::from(zero.abs() > 1e-6);
    found.placement.joints.iter().map(|joint| usize::from(joint.sense == Sense::Reversed) + mentioned(joint.zero)).sum()
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 150,
        failure_persistence: None,
        rng_seed: RngSeed::Fixed(2),
        ..ProptestConfig::default()
    })]

    #[test]
    fn a_robot_made_of_a_table_is_that_table(
        rows in prop::collection::vec(any_row(), 1..8),
        proximal in any::<bool>(),
        base in prop::array::uniform6(-2.0..2.0f64),
        tool in prop::array::uniform6(-2.0..2.0f64),
    ) {
        let convention = if proximal { Convention::Proximal } else { Convention::Distal };
        let chain = robot_of(&rows, convention, base, tool);
        let found = match_table(&chain, &vendor_of(&rows, convention)).unwrap();
        prop_assert_eq!(found.verdict, Verdict::Exact, "{:?}", found.placement);
        let odd = |number: &&NumberMatch| !number.agrees;
        let odd: Vec<&NumberMatch> = found.rows.iter().flat_map(|row| &row.numbers).filter(odd).collect();
        prop_assert!(odd.is_empty(), "{odd:?} {:?}", found.placement);
        let last = rows.len() - 1;
        let made = rows.iter().enumerate().map(|(k, row)| {
            usize::from(row.reversed) + usize::from(row.zero != 0.0 && k != 0 && k != last)
        });
        prop_assert!(needed(&found) <= made.sum(), "{:?}", found.placement.joints);
    }

    #[test]
    fn one_wrong_number_is_named(
        rows in prop::collection::vec(skew_row(), 3..8),
        proximal in any::<bool>(),
        base in prop::array::uniform6(-2.0..2.0f64),
        tool in prop::array::uniform6(-2.0..2.0f64),
        at in any::<prop::sample::Index>(),
        which in 1..4usize,
        by in prop_oneof![0.02..0.2f64, -0.2..-0.02f64],
    ) {
        let convention = if proximal { Convention::Proximal } else { Convention::Distal };
        let last = rows.len() - 1;
        // d of the first and the last joint, and what lies outside them, belong to the frames.
        let inner = match (which, proximal) {
            (1, _) => 1 + at.index(last - 1),
            (_, false) => at.index(last),
            (_, true) => 1 + at.index(last),
        };
        let mut wrong = rows.clone();
        wrong[inner].numbers[which] += by;
        let chain = robot_of(&rows, convention, base, tool);
        let found = match_table(&chain, &vendor_of(&wrong, convention)).unwrap();
        prop_assert!(found.verdict >= Verdict::Close);
        let explanation = found.explanation.as_ref();
        prop_assert!(explanation.is_some(), "{:?}", found.placement);
        let explanation = explanation.unwrap();
        prop_assert_eq!(explanation.differences.len(), 1, "{} {} {:?}", inner, which, &explanation.differences);
        let difference = &explanation.differences[0];
        let word = ["theta", "d", "alpha", "a"][which];
        prop_assert_eq!((difference.label, difference.number.word()), (RowLabel::Joint(inner), word));
        // Symmetric arms have several answers: the same amount, seen from the other side.
        let (found_as, made_as) = (difference.robot, rows[inner].numbers[which]);
        let apart = if which == 2 { found_as.sin().abs() - made_as.sin().abs() } else { found_as.abs() - made_as.abs() };
        prop_assert!(apart.abs() < 1e-8, "{difference:?}");
        prop_assert!(explanation.placement.position_error < 1e-8);
    }
}
