//! POE to Denavit-Hartenberg and back, on chains made to hurt.

#![allow(clippy::unwrap_used, reason = "a test that cannot build its input has failed")]

use denavit_dh::convert::{HAYATI_BELOW, table};
use denavit_dh::{Convention, Gauge, NearParallel, Options, Parallelism, Table, conventions};
use denavit_model::chain::{Chain, ChainJoint, Coordinate, Quantity};
use denavit_model::nalgebra::{Point3, Unit, Vector3, Vector6};
use denavit_model::screw::{AxisLine, Pitch, Screw};
use denavit_model::{examples, se3};
use proptest::prelude::*;
use std::f64::consts::PI;

/// Kinds of step from one axis to the next, each a way to hurt.
#[derive(Debug, Clone, Copy)]
enum Neighbour {
    Skew,
    Intersecting,
    Parallel,
    AntiParallel,
    Coincident,
    NearParallel(f64),
}

#[derive(Debug, Clone, Copy)]
enum Kind {
    Revolute,
    Prismatic,
    Helical,
}

#[derive(Debug, Clone)]
struct Step {
    kind: Kind,
    neighbour: Neighbour,
    numbers: [f64; 6],
}

fn step(nearest: f64) -> impl Strategy<Value = Step> {
    let kind = prop_oneof![3 => Just(Kind::Revolute), 1 => Just(Kind::Prismatic), 1 => Just(Kind::Helical)];
    let neighbour = prop_oneof![
        Just(Neighbour::Skew),
        Just(Neighbour::Intersecting),
        Just(Neighbour::Parallel),
        Just(Neighbour::AntiParallel),
        Just(Neighbour::Coincident),
        (nearest..-1.0).prop_map(|e| Neighbour::NearParallel(10f64.powf(e))),
    ];
    (kind, neighbour, prop::array::uniform6(-1.0..1.0f64)).prop_map(|(kind, neighbour, numbers)| Step {
        kind,
        neighbour,
        numbers,
    })
}

fn build(steps: &[Step], tool: [f64; 6], half_turn: bool, size: f64) -> Chain {
    let mut axis = AxisLine { direction: Vector3::z_axis(), point: Point3::origin() };
    let mut joints = Vec::new();
    for (index, Step { kind, neighbour, numbers }) in steps.iter().enumerate() {
        let random = Vector3::new(numbers[0], numbers[1], numbers[2]);
        let offset = Vector3::new(numbers[3], numbers[4], numbers[5]) * size;
        let u = axis.direction;
        let across = Unit::try_new(u.cross(&random), 1e-3)
            .unwrap_or_else(|| Unit::new_normalize(u.cross(&Vector3::new(0.3, 0.5, 0.7))));
        axis = match neighbour {
            Neighbour::Skew => {
                AxisLine { direction: Unit::new_normalize(random + across.as_ref()), point: axis.point + offset }
            }
            Neighbour::Intersecting => AxisLine {
                direction: Unit::new_normalize(random + across.as_ref()),
                point: axis.point + u.as_ref() * offset.x,
            },
            Neighbour::Parallel => AxisLine { direction: u, point: axis.point + offset },
            Neighbour::AntiParallel => AxisLine { direction: -u, point: axis.point + offset },
            Neighbour::Coincident => AxisLine { direction: u, point: axis.point + u.as_ref() * offset.x },
            Neighbour::NearParallel(angle) => AxisLine {
                direction: Unit::new_normalize(se3::rotation_about(&across, *angle) * u.as_ref()),
                point: axis.point + offset,
            },
        };
        let screw = match kind {
            Kind::Revolute => Screw::Revolute(axis),
            Kind::Prismatic => Screw::Prismatic(axis.direction),
            Kind::Helical => Screw::Helical {
                axis,
                pitch: Pitch::from_metres_per_radian(0.01 * size * (1.0 + numbers[0].abs())).unwrap(),
            },
        };
        joints.push(ChainJoint {
            name: format!("j{index}"),
            screw,
            coordinate: index,
            scale: 1.0 + 0.1 * numbers[5],
            offset: 0.0,
        });
    }
    let coordinates = joints.iter().map(|joint| {
        let quantity = if joint.screw.line().is_some() { Quantity::Angle } else { Quantity::Length };
        Coordinate::unlimited(joint.name.clone(), quantity)
    });
    let mut home = se3::exp(&Vector6::from(tool));
    if half_turn {
        home.rotation = se3::rotation_about(&Vector3::x(), PI);
    }
    home.translation.vector = axis.point.coords + home.translation.vector * size;
    Chain::new(("hurt", "base", "tip"), coordinates.collect(), joints.clone(), home).unwrap()
}

fn configurations(chain: &Chain, size: f64, count: usize) -> Vec<Vec<f64>> {
    let part = |sample: usize, k: usize| {
        (0.5 + (sample as f64 + 1.0) * 0.754_877_666 * (k as f64 + 1.3).sqrt()).fract() * 2.0 - 1.0
    };
    let scale = |k: usize| if chain.coordinates()[k].quantity == Quantity::Angle { PI } else { size };
    (0..count).map(|sample| (0..chain.coordinates().len()).map(|k| part(sample, k) * scale(k)).collect()).collect()
}

/// Largest rotation error (rad) and translation error (m) of the table and of its chain.
fn errors(chain: &Chain, table: &Table, size: f64) -> (f64, f64) {
    let again = table.chain().unwrap();
    let mut worst = (0.0f64, 0.0f64);
    for q in configurations(chain, size, 20) {
        let exact = chain.fk(&q);
        for found in [table.fk(&q), again.fk(&q)] {
            let (turned, moved) = se3::difference(&exact, &found);
            worst = (worst.0.max(turned), worst.1.max(moved));
        }
    }
    worst
}

/// What rounding may do: some spacings of f64 for each joint, times the largest number that is added and taken away.
fn allowed(chain: &Chain, table: &Table) -> (f64, f64) {
    let reach = chain.size().max(table.greatest_length()) * (1.0 + chain.joints().len() as f64);
    (2e-15 * (2.0 + chain.joints().len() as f64), 1e-15 * (2.0 + chain.joints().len() as f64) * reach)
}

fn options() -> impl Strategy<Value = Options> {
    let gauge = prop_oneof![Just(Gauge::Simple), Just(Gauge::Paper)];
    let near_parallel = prop_oneof![Just(NearParallel::Dh), Just(NearParallel::HayatiBelow(HAYATI_BELOW))];
    (gauge, near_parallel).prop_map(|(gauge, near_parallel)| Options {
        parallelism: Parallelism::Exact,
        gauge,
        near_parallel,
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    #[test]
    fn a_table_moves_as_its_chain(
        steps in prop::collection::vec(step(-8.0), 0..9),
        tool in prop::array::uniform6(-1.0..1.0f64),
        half_turn in any::<bool>(),
        size in prop_oneof![Just(1e-3), Just(1.0), Just(100.0)],
        options in options(),
    ) {
        let chain = build(&steps, tool, half_turn, size);
        let table = table(&chain, &options).unwrap().value;
        let (turned, moved) = errors(&chain, &table, size);
        let (turn_allowed, move_allowed) = allowed(&chain, &table);
        prop_assert!(turned <= turn_allowed && moved <= move_allowed, "{turned:e} {moved:e} of {move_allowed:e}, numbers to {}", table.greatest_length());
    }

    #[test]
    fn every_convention_reads_back_as_the_same_table(
        steps in prop::collection::vec(step(-3.0), 0..9),
        tool in prop::array::uniform6(-1.0..1.0f64),
        hayati in any::<bool>(),
    ) {
        let chain = build(&steps, tool, false, 1.0);
        let near_parallel = if hayati { NearParallel::HayatiBelow(HAYATI_BELOW) } else { NearParallel::Dh };
        let table = table(&chain, &Options { parallelism: Parallelism::Exact, near_parallel, ..Options::default() }).unwrap().value;
        for convention in Convention::ALL {
            if convention == Convention::Proximal && hayati {
                continue;
            }
            let rows = table.convention_rows(convention);
            let names = (&*table.name, &*table.base, &*table.tip);
            let again = Table::from_convention_rows(names, table.coordinates.clone(), table.joints.clone(), convention, &rows).unwrap();
            prop_assert_eq!(&again, &table);
            for q in configurations(&chain, 1.0, 3) {
                let values: Vec<f64> = table.joints.iter().map(|joint| joint.scale * q[joint.coordinate]).collect();
                let found = conventions::fk_of_rows(convention, &rows, &table.joints, &values);
                let (turned, moved) = se3::difference(&found, &table.fk(&q));
                let allowed = 1e-14 * (1.0 + table.greatest_length()) * (1.0 + steps.len() as f64);
                prop_assert!(turned < 1e-13 && moved < allowed, "{turned:e} {moved:e}");
            }
        }
    }

    #[test]
    fn gauges_differ_in_numbers_only(
        steps in prop::collection::vec(step(-2.0), 0..9),
        tool in prop::array::uniform6(-1.0..1.0f64),
    ) {
        let chain = build(&steps, tool, false, 1.0);
        let tables = [Gauge::Simple, Gauge::Paper].map(|gauge| table(&chain, &Options { gauge, parallelism: Parallelism::Exact, ..Options::default() }).unwrap().value);
        for q in configurations(&chain, 1.0, 5) {
            let (turned, moved) = se3::difference(&tables[0].fk(&q), &tables[1].fk(&q));
            let greatest = 1.0 + tables[0].greatest_length().max(tables[1].greatest_length());
            prop_assert!(turned < 1e-13 && moved < 2e-14 * greatest * (1.0 + steps.len() as f64), "{turned:e} {moved:e}");
        }
    }
}

#[test]
fn near_parallel_axes_from_a_tenth_to_nothing() {
    for exponent in 1..=16 {
        let angle = 10f64.powi(-exponent);
        let near = Step {
            kind: Kind::Revolute,
            neighbour: Neighbour::NearParallel(angle),
            numbers: [0.1, 0.9, 0.2, 0.3, -0.2, 0.1],
        };
        let skew = Step { kind: Kind::Revolute, neighbour: Neighbour::Skew, numbers: [0.5, -0.4, 0.2, -0.3, 0.2, 0.4] };
        let chain = build(&[skew.clone(), near.clone(), near, skew], [0.1, 0.2, 0.3, 0.4, 0.5, 0.6], false, 0.3);
        let size = chain.size();
        let exact = Options { parallelism: Parallelism::Exact, ..Options::default() };
        let table_exact = table(&chain, &exact).unwrap().value;
        let (turned, moved) = errors(&chain, &table_exact, 1.0);
        let greatest = table_exact.greatest_length();
        let parallel = if angle <= 1e-12 { 4.0 * angle } else { 0.0 };
        // The honest bound: two spacings of f64 at the largest number, where that is beyond the robot's size.
        assert!(turned <= 1e-14 + parallel, "{angle:e}: {turned:e} rad");
        assert!(
            moved <= (1e-14 + parallel) * size + 2.0 * f64::EPSILON * greatest * 4.0,
            "{angle:e}: {moved:e} m, numbers to {greatest:e}"
        );
        let hayati = Options { near_parallel: NearParallel::HayatiBelow(HAYATI_BELOW), ..exact };
        let table_hayati = table(&chain, &hayati).unwrap().value;
        assert!(table_hayati.greatest_length() <= 3.0 * size);
        let (turned, moved) = errors(&chain, &table_hayati, 1.0);
        assert!(turned <= 1e-14 && moved <= 1e-14 * size, "{angle:e}: {turned:e} rad {moved:e} m");
    }
}

#[test]
fn sixty_joints_keep_their_digits() {
    let steps: Vec<Step> = (0..60u32)
        .map(|k| {
            let kind = [Kind::Revolute, Kind::Prismatic, Kind::Helical][k as usize % 3];
            let part = |m: f64| (f64::from(k) * m).sin();
            Step {
                kind,
                neighbour: Neighbour::Skew,
                numbers: [part(1.3), part(2.7), part(0.9), part(3.1), part(1.9), part(0.7)],
            }
        })
        .collect();
    let chain = build(&steps, [0.1; 6], true, 1.0);
    let table = table(&chain, &Options { parallelism: Parallelism::Exact, ..Options::default() }).unwrap().value;
    let (turned, moved) = errors(&chain, &table, 1.0);
    assert!(turned < 1e-13 && moved < 1e-14 * chain.size().max(table.greatest_length()) * 10.0, "{turned:e} {moved:e}");
}

#[test]
fn straightening_moves_the_tip_by_no_more_than_it_says() {
    for angle in [1e-3, 1e-6, 1e-9] {
        let near = Step {
            kind: Kind::Revolute,
            neighbour: Neighbour::NearParallel(angle),
            numbers: [0.1, 0.9, 0.2, 0.3, -0.2, 0.1],
        };
        let skew = Step { kind: Kind::Revolute, neighbour: Neighbour::Skew, numbers: [0.5, -0.4, 0.2, -0.3, 0.2, 0.4] };
        let chain = build(&[skew.clone(), near.clone(), near, skew], [0.1, 0.2, 0.3, 0.4, 0.5, 0.6], false, 0.3);
        let noted =
            table(&chain, &Options { parallelism: Parallelism::Within { angle: 3.0 * angle }, ..Options::default() })
                .unwrap();
        let stated: f64 = noted.notes.iter().map(denavit_model::Note::tip_moves).sum();
        let moved = configurations(&chain, 1.0, 2000)
            .iter()
            .map(|q| se3::difference(&chain.fk(q), &noted.value.fk(q)).1)
            .fold(0.0, f64::max);
        assert!(moved <= stated && moved > 0.05 * stated, "{angle:e}: moved {moved:e}, stated {stated:e}");
        assert!(noted.value.greatest_length() < chain.size());
    }
}

#[test]
fn named_robots_read_as_engineers_write_them() {
    let options = Options::default();
    let scara = table(&examples::scara_helical(), &options).unwrap().value;
    assert!(scara.rows.iter().all(|row| row.theta() == 0.0), "{:?}", scara.rows);
    let puma = table(&examples::puma_like(), &options).unwrap().value;
    let odd = puma.rows.iter().filter(|row| row.a() != 0.0).count();
    assert_eq!(odd, 2, "{:?}", puma.rows);
}
