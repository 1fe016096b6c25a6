//! Matching published tables, screw axes and wrist parameters against the URDFs of the same robots.

use denavit_dh::matching::{
    DhNumber, Match, Nature, Sense, VendorJoint, VendorNumber, VendorRow, VendorTable, Verdict, match_table,
};
use denavit_dh::{Convention, Motion, RowLabel};
use denavit_model::tree::Reading;
use denavit_model::{Chain, Robot, urdf};
use std::path::PathBuf;

/// The vendor corpus beside the workspace, or `None` with the reason printed.
fn vendor_corpus() -> Option<PathBuf> {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../../shared/vendor");
    if !folder.is_dir() {
        println!("skipped, because {} is not there", folder.display());
        return None;
    }
    Some(folder)
}

fn read_robot(folder: &std::path::Path, file: &str) -> Robot {
    let text = std::fs::read_to_string(folder.join(file)).unwrap_or_else(|error| panic!("{file}: {error}"));
    urdf::read(file, &text).unwrap_or_else(|error| panic!("{file}: {error}"))
}

/// The chain between links as the corpus names them: `root`, a link, or `child link of JOINT`.
fn chain_of(robot: &Robot, base: &str, tip: &str, reading: Reading) -> Chain {
    let base = if base == "root" { robot.links[robot.root].name.clone() } else { base.to_owned() };
    let tip = match tip.strip_prefix("child link of ") {
        Some(joint) => robot.links[robot.joints[robot.joint_index(joint).expect(joint)].child].name.clone(),
        None => tip.to_owned(),
    };
    robot.chain(Some(&base), Some(&tip), reading).unwrap_or_else(|error| panic!("{error}")).value
}

/// One table of dh_tables.csv.
struct Published {
    robot: String,
    verdict: String,
    file: String,
    base: String,
    tip: String,
    table: VendorTable,
}

fn published(folder: &std::path::Path) -> Vec<Published> {
    let mut reader = csv::Reader::from_path(folder.join("dh_tables.csv")).unwrap();
    let headers = reader.headers().unwrap().clone();
    let mut tables: Vec<Published> = Vec::new();
    for record in reader.records() {
        let record = record.unwrap();
        let field = |name: &str| &record[headers.iter().position(|header| header == name).expect(name)];
        if tables.last().is_none_or(|last| last.robot != field("robot")) {
            tables.push(Published {
                robot: field("robot").to_owned(),
                verdict: field("match").to_owned(),
                file: field("verified_against").to_owned(),
                base: field("base_link").to_owned(),
                tip: field("tip").to_owned(),
                table: VendorTable {
                    convention: Convention::from_word(field("convention")).expect("a known convention"),
                    base: None,
                    joints: Vec::new(),
                    tool: None,
                },
            });
        }
        let number = |name| Some(VendorNumber::from_written(field(name), 1.0).expect("a number"));
        let row = VendorRow {
            theta: number("theta_offset_rad"),
            d: number("d_m"),
            alpha: number("alpha_rad"),
            a: number("a_m"),
            beta: None,
        };
        let motion = if field("joint_type") == "prismatic" { Motion::Prismatic } else { Motion::Revolute };
        tables.last_mut().unwrap().table.joints.push(VendorJoint { name: None, motion, row });
    }
    tables
}

fn summary(found: &Match) -> String {
    let joints: Vec<String> = found
        .placement
        .joints
        .iter()
        .map(|joint| format!("{}{:.5}", if joint.sense == Sense::Same { "+" } else { "-" }, joint.zero))
        .collect();
    let differences: Vec<String> = found
        .explanation
        .iter()
        .flat_map(|explanation| &explanation.differences)
        .map(|difference| {
            format!(
                "{:?} {} {} -> {} {:?}",
                difference.label,
                difference.number.word(),
                difference.vendor,
                difference.robot,
                difference.nature
            )
        })
        .collect();
    let after = found.explanation.as_ref().map(|e| e.placement.position_error);
    format!(
        "{} {:.1e} m {:.1e} rad [{}] {} {differences:?} {after:?}",
        found.verdict.word(),
        found.placement.position_error,
        found.placement.rotation_error,
        joints.join(" "),
        found.prints_back()
    )
}

#[test]
fn published_tables_come_to_their_verdicts() {
    let Some(folder) = vendor_corpus() else { return };
    let mut compared = 0;
    for published in published(&folder).iter().filter(|published| !published.file.is_empty()) {
        let robot = read_robot(&folder, &published.file);
        for reading in [Reading::AsWritten, Reading::Intended] {
            let chain = chain_of(&robot, &published.base, &published.tip, reading);
            let start = std::time::Instant::now();
            let found = match_table(&chain, &published.table).unwrap();
            let time = start.elapsed();
            println!(
                "{:14} {reading:?} expected {}: {} {time:.0?}",
                published.robot,
                published.verdict,
                summary(&found)
            );
            compared += 1;
        }
    }
}
