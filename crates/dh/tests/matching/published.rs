//! Published tables against the URDFs that they were verified with elsewhere.

use crate::corpus::{Rows, chain_of, lengths_misprinted, needed, read_robot, vendor_corpus};
use denavit_dh::matching::{DhNumber, Difference, Match, Nature, Sense, VendorTable, Verdict, match_table};
use denavit_dh::{Convention, RowLabel};
use denavit_model::tree::Reading;
use std::path::Path;

/// One table of dh_tables.csv.
struct Published {
    robot: String,
    verdict: String,
    file: String,
    base: String,
    tip: String,
    /// Reversed senses and zeros of the solution that the corpus gives.
    needed: usize,
    table: VendorTable,
}

fn published(folder: &Path) -> Vec<Published> {
    let rows = Rows::read(&folder.join("dh_tables.csv"));
    let mut tables: Vec<Published> = Vec::new();
    for record in &rows.records {
        let text = |name| rows.text(record, name);
        if tables.last().is_none_or(|last| last.robot != text("robot")) {
            let convention = Convention::from_word(text("convention")).expect("a known convention");
            tables.push(Published {
                robot: text("robot").to_owned(),
                verdict: text("match").to_owned(),
                file: text("verified_against").to_owned(),
                base: text("base_link").to_owned(),
                tip: text("tip").to_owned(),
                needed: 0,
                table: VendorTable { convention, base: None, joints: Vec::new(), tool: None },
            });
        }
        let table = tables.last_mut().unwrap();
        let columns = ["theta_offset_rad", "d_m", "alpha_rad", "a_m", "joint_type"];
        table.table.joints.push(rows.joint(record, columns, [1.0, 1.0]));
        let zero: f64 = text("joint_zero_shift_rad").parse().unwrap_or(0.0);
        table.needed += usize::from(text("joint_sign") == "-1") + usize::from(zero.abs() > 1e-3);
    }
    tables
}

fn found(folder: &Path, name: &str, reading: Reading) -> Match {
    let tables = published(folder);
    let published = tables.iter().find(|published| published.robot == name).expect(name);
    let chain = chain_of(&read_robot(&folder.join(&published.file)), &published.base, &published.tip, reading);
    match_table(&chain, &published.table).unwrap()
}

#[test]
fn published_tables_come_to_their_verdicts() {
    let Some(folder) = vendor_corpus() else { return };
    let mut counts = [0; 4];
    for published in published(&folder).iter().filter(|published| !published.file.is_empty()) {
        let robot = read_robot(&folder.join(&published.file));
        for reading in [Reading::AsWritten, Reading::Intended] {
            let name = format!("{} {reading:?}", published.robot);
            let chain = chain_of(&robot, &published.base, &published.tip, reading);
            let found = match_table(&chain, &published.table).unwrap();
            // Every URDF of a rounded match writes quarter turns as 1.5708 or so, and has no other fault.
            let expected = match (&*published.verdict, reading) {
                ("rounded", Reading::Intended) => "exact",
                (verdict, _) => verdict,
            };
            assert_eq!(found.verdict.word(), expected, "{name}: {:?}", found.placement);
            assert!(needed(&found) <= published.needed, "{name}: {:?}", found.placement.joints);
            if found.verdict <= Verdict::Rounded {
                assert!(found.prints_back() && found.explanation.is_none(), "{name}: {:?}", found.rows);
                assert_eq!(lengths_misprinted(&found), Vec::<String>::new(), "{name}");
            } else {
                let explanation = found.explanation.as_ref().unwrap_or_else(|| panic!("{name} is not explained"));
                assert!(!explanation.differences.is_empty(), "{name}");
                assert!(explanation.placement.position_error < 2e-5, "{name}: {:?}", explanation.placement);
            }
            if reading == Reading::AsWritten {
                counts[found.verdict as usize] += 1;
            }
        }
    }
    println!("exact, rounded, close, mismatch: {counts:?}");
    assert_eq!(counts, [22, 7, 6, 1]);
}

fn named(found: &Match) -> Vec<(usize, DhNumber, f64, f64)> {
    let row = |label| if let RowLabel::Joint(index) = label { index + 1 } else { 0 };
    let name = |difference: &Difference| {
        let rounded = |value: f64| (value * 1e6).round() / 1e6 + 0.0;
        (row(difference.label), difference.number, rounded(difference.vendor), rounded(difference.robot))
    };
    found.explanation.as_ref().unwrap().differences.iter().map(name).collect()
}

/// The URDF's link from joint 2 to joint 3 is 0.4318 m along and 0.0203 m across; the table has the 0.0203 m behind joint 3.
#[test]
fn the_puma_has_its_elbow_offset_on_the_wrong_side_of_joint_3() {
    let Some(folder) = vendor_corpus() else { return };
    let found = found(&folder, "puma560", Reading::Intended);
    assert_eq!(found.verdict, Verdict::Mismatch);
    let expected = [
        (2, DhNumber::A, 0.4318, 0.432277),
        (3, DhNumber::D, 0.15005, 0.1501),
        (3, DhNumber::A, 0.0203, 0.0),
        (4, DhNumber::D, 0.4318, 0.4331),
    ];
    assert_eq!(named(&found), expected);
    let explanation = found.explanation.unwrap();
    assert_eq!(explanation.differences[2].nature, Nature::OtherSideOfJoint { with: RowLabel::Joint(1) });
    assert!(explanation.placement.position_error < 1e-12);
}

#[test]
fn close_tables_say_which_numbers_differ() {
    let Some(folder) = vendor_corpus() else { return };
    let named = |name| named(&found(&folder, name, Reading::Intended));
    // The vendor's table is in whole millimetres, the URDF is not.
    assert_eq!(named("baxter_left"), [(3, DhNumber::D, 0.364, 0.36442), (5, DhNumber::D, 0.374, 0.37429)]);
    assert_eq!(named("mycobot_280"), [(4, DhNumber::D, 0.0634, 0.06462), (5, DhNumber::D, 0.07505, 0.07318)]);
    assert_eq!(
        named("j2s7s300"),
        [(2, DhNumber::D, 0.0, -0.0016), (4, DhNumber::D, -0.0098, -0.0114), (5, DhNumber::D, -0.3111, -0.31105)]
    );
}

#[test]
fn senses_and_zeros_are_part_of_the_answer() {
    let Some(folder) = vendor_corpus() else { return };
    let found = found(&folder, "kr16_2", Reading::AsWritten);
    let joints: Vec<(Sense, f64)> = found
        .placement
        .joints
        .iter()
        .map(|joint| (joint.sense, (joint.zero.to_degrees() * 1e6).round() / 1e6))
        .collect();
    let (same, reversed) = (Sense::Same, Sense::Reversed);
    let expected = [(reversed, 0.0), (same, 90.0), (same, -90.0), (reversed, 0.0), (same, 180.0), (same, 0.0)];
    assert_eq!(joints, expected);
}
