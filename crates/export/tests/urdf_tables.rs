//! Tables into URDF and back, and the tables of canonical URDFs.

#![expect(clippy::unwrap_used, reason = "a test stops at what it did not expect")]

use crate::urdf_corpus::{corpus, random};
use denavit_dh::table::{DhRow, Row, Table};
use denavit_dh::{Convention, Gauge, Parallelism, convert};
use denavit_export::urdf::{Options, canonical, from_table, read_off};
use denavit_model::chain::Quantity;
use denavit_model::tree::Reading;
use denavit_model::{Chain, examples, se3, urdf};

fn same_motion(one: &Chain, other: &Chain) -> f64 {
    let mut next = random(7);
    let mut worst = 0.0f64;
    for _ in 0..50 {
        let q: Vec<f64> = one.coordinates().iter().map(|_| 2.0 * next() - 1.0).collect();
        let (turned, moved) = se3::difference(&one.fk(&q), &other.fk(&q));
        worst = worst.max(turned).max(moved / one.size());
    }
    worst
}

fn back(table: &Table) -> Table {
    let text = from_table(table, Convention::Distal).unwrap();
    let robot = urdf::read("made.urdf", &text).unwrap_or_else(|error| panic!("{error}\n{text}"));
    let read = read_off(&robot, Some(&table.base), Some(&table.tip), Reading::Intended).expect(&text);
    let worst = same_motion(&table.chain().unwrap(), &robot.chain(None, None, Reading::Intended).unwrap().value);
    assert!(worst < 1e-14, "{worst}");
    read
}

#[test]
fn a_table_comes_back_from_its_urdf_digit_for_digit() {
    for chain in examples::all() {
        for gauge in [Gauge::Simple, Gauge::Paper] {
            let options = convert::Options { gauge, parallelism: Parallelism::Exact, ..convert::Options::default() };
            let table = convert::table(&chain, &options).unwrap().value;
            let read = back(&table);
            assert_eq!(read.rows, table.rows, "{}", chain.name());
            assert_eq!(read.tool, table.tool);
            assert_eq!(read.joints, table.joints);
            let names =
                |table: &Table| table.coordinates.iter().map(|c| (c.name.clone(), c.quantity)).collect::<Vec<_>>();
            assert_eq!(names(&read), names(&table));
        }
    }
}

#[test]
fn odd_numbers_come_back_to_the_last_digit() {
    let mut next = random(3);
    let mut table = convert::table(&examples::rail_arm(), &convert::Options::default()).unwrap().value;
    for _ in 0..500 {
        for row in &mut table.rows {
            let mut number = || (next() - 0.5) * 6.0;
            *row = Row::Dh(DhRow { theta: number(), d: number(), alpha: number(), a: number() });
        }
        (table.tool.theta, table.tool.d) = (next(), next());
        let read = back(&table);
        for (one, other) in read.rows.iter().zip(&table.rows) {
            let (Row::Dh(one), Row::Dh(other)) = (one, other) else { panic!("{one:?}") };
            // Two neighbouring doubles may have the same products with cosine and sine.
            assert!((one.a - other.a).abs() <= f64::EPSILON * other.a.abs(), "{one:?} {other:?}");
            assert_eq!(DhRow { a: 0.0, ..*one }, DhRow { a: 0.0, ..*other });
        }
        assert_eq!(read.tool, table.tool);
    }
}

#[test]
fn senses_mimics_and_missing_limits_come_back() {
    let mut table = convert::table(&examples::puma_like(), &convert::Options::default()).unwrap().value;
    table.joints[1].scale = -1.0;
    table.joints[4].coordinate = 1;
    table.joints[4].scale = 0.5;
    table.coordinates.remove(4);
    table.joints[5].coordinate = 4;
    table.coordinates[0].limits = denavit_model::Limits::default();
    table.coordinates[0].continuous = true;
    let read = back(&table);
    assert_eq!(read.rows, table.rows);
    assert_eq!(read.joints, table.joints);
    assert_eq!(read.coordinates, table.coordinates);
    assert_eq!(read.coordinates[0].quantity, Quantity::Angle);
}

#[test]
fn a_scale_that_urdf_cannot_say_is_refused() {
    let mut table = convert::table(&examples::planar_arm(), &convert::Options::default()).unwrap().value;
    table.joints[1].scale = 1.01;
    let message = from_table(&table, Convention::Distal).unwrap_err().to_string();
    assert_eq!(
        message,
        "joint \"joint_2\": its value is 1.01 times its coordinate, which URDF cannot express; give it scale 1"
    );
}

/// The four numbers of each exported joint origin against those of the table of its default chain as it was before.
#[test]
fn exported_origins_are_the_rows_of_the_table() {
    let (mut tables, mut joints, mut canonical_already, mut odd) = (0, 0, 0, Vec::new());
    for path in corpus() {
        let file = path.display().to_string();
        let Ok(text) = std::fs::read_to_string(&path) else { continue };
        let Ok(before) = urdf::read(&file, &text) else { continue };
        let Ok(chain) = before.chain(None, None, Reading::Intended) else { continue };
        if chain.value.joints().iter().any(|joint| joint.offset != 0.0) {
            continue;
        }
        let expected = convert::table(&chain.value, &convert::Options::default()).unwrap();
        let exported = canonical(&before, &Options::default()).unwrap();
        if exported.value == text {
            canonical_already += 1;
            continue;
        }
        if exported.notes.iter().any(|note| note.to_string().contains("its axis is")) {
            continue;
        }
        let after = urdf::read(&file, &exported.value).unwrap();
        let read = read_off(&after, Some(chain.value.base()), Some(chain.value.tip()), Reading::Intended);
        // A joint that carries the tip itself has no row in the file: the tip keeps its frame.
        let read = read.unwrap_or_else(|| {
            let chain = after.chain(None, None, Reading::Intended).unwrap().value;
            convert::table(&chain, &convert::Options::default()).unwrap().value
        });
        tables += 1;
        let size = chain.value.size();
        let n = read.joints.len();
        for (index, (one, other)) in read.rows.iter().zip(&expected.value.rows).enumerate().take(n) {
            joints += 1;
            let turn = |a: f64, b: f64| (a - b).sin().atan2((a - b).cos()).abs();
            let angles = turn(one.theta(), other.theta()).max(turn(one.alpha(), other.alpha()));
            let lengths = (one.a() - other.a()).abs().max((one.d().unwrap() - other.d().unwrap()).abs());
            if angles > 1e-12 || lengths > 1e-12 * size {
                odd.push(format!("{file}: row {index}: {one:?} instead of {other:?}"));
            }
        }
    }
    println!("{joints} rows of {tables} tables ({canonical_already} files canonical already), {} odd", odd.len());
    assert!(odd.is_empty(), "{} odd:\n{}", odd.len(), odd.join("\n"));
}
