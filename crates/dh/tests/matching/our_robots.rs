//! The robots of this repository against the tables beside them.

use crate::corpus::{Rows, chain_of, lengths_misprinted, needed, read_robot, vendor_corpus};
use denavit_dh::convert::{HAYATI_BELOW, Options, table};
use denavit_dh::matching::{DhNumber, VendorTable, Verdict, match_table};
use denavit_dh::{Convention, NearParallel, Parallelism, RowLabel};
use denavit_model::tree::Reading;
use denavit_model::{examples, se3, urdf};
use std::path::PathBuf;

/// File, table, base, tip: chains where the table covers a part of the robot.
const ROBOTS: [(&str, &str, &str, &str); 12] = [
    ("abb/irb120.urdf", "abb/irb120_dh.csv", "root", "child link of joint_6"),
    ("adept/cobra600.urdf", "adept/cobra600_dh.csv", "root", "child link of joint_4"),
    ("franka/panda.urdf", "franka/panda_dh.csv", "root", "child link of panda_joint7"),
    ("kuka/iiwa14.urdf", "kuka/iiwa14_dh.csv", "root", "child link of joint_a7"),
    ("kuka/kr16_2_on_rail.urdf", "kuka/kr16_2_dh.csv", "child link of rail", "child link of joint_a6"),
    ("rethink/baxter.urdf", "rethink/baxter_right_arm_dh.csv", "root", "child link of right_w2"),
    ("stanford/stanford_arm.urdf", "stanford/stanford_arm_dh.csv", "root", "child link of hand_roll_joint"),
    ("ufactory/xarm7.urdf", "ufactory/xarm7_dh.csv", "root", "child link of joint7"),
    ("unimation/puma560.urdf", "unimation/puma560_dh.csv", "root", "child link of wrist_flange_joint"),
    ("universal_robots/ur5.urdf", "universal_robots/ur5_dh.csv", "root", "child link of wrist_3_joint"),
    ("universal_robots/ur10.urdf", "universal_robots/ur10_dh.csv", "root", "child link of wrist_3_joint"),
    ("universal_robots/ur10e.urdf", "universal_robots/ur10e_dh.csv", "root", "child link of wrist_3_joint"),
];

fn read_table(path: &std::path::Path) -> VendorTable {
    let text = std::fs::read_to_string(path).unwrap();
    let convention = if text.contains("convention: proximal") { Convention::Proximal } else { Convention::Distal };
    let rows = Rows::read(path);
    let in_degrees = rows.has("theta_deg");
    let columns = if in_degrees {
        ["theta_deg", "d_mm", "alpha_deg", "a_mm", "kind"]
    } else {
        ["theta", "d", "alpha", "a", "kind"]
    };
    let units = if in_degrees { [1f64.to_radians(), 1e-3] } else { [1.0, 1.0] };
    let joints = rows.records.iter().map(|record| {
        let mut joint = rows.joint(record, columns, units);
        joint.name = Some(rows.text(record, "joint").to_owned());
        joint
    });
    VendorTable { convention, base: None, joints: joints.collect(), tool: None }
}

#[test]
fn our_robots_are_those_of_their_tables() {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../robots");
    for (file, table, base, tip) in ROBOTS {
        let robot = read_robot(&folder.join(file));
        let base = base.strip_prefix("child link of ").map_or_else(
            || base.to_owned(),
            |joint| robot.links[robot.joints[robot.joint_index(joint).unwrap()].child].name.clone(),
        );
        let chain = chain_of(&robot, &base, tip, Reading::Intended);
        let found = match_table(&chain, &read_table(&folder.join(table))).unwrap();
        assert_eq!(found.verdict, Verdict::Exact, "{file}: {:?}", found.placement);
        assert!(found.prints_back(), "{file}: {:?}", found.rows);
        assert_eq!(lengths_misprinted(&found), Vec::<String>::new(), "{file}");
        println!("{file}: {} senses and zeros needed", needed(&found));
    }
}

#[test]
fn a_robot_matches_its_own_table_in_every_convention() {
    for chain in examples::all() {
        for convention in Convention::ALL {
            for frames in [true, false] {
                let near_parallel = match convention {
                    Convention::Hayati => NearParallel::HayatiBelow(HAYATI_BELOW),
                    _ => NearParallel::Dh,
                };
                let own = table(&chain, &Options { near_parallel, ..Options::default() }).unwrap().value;
                let found = match_table(&chain, &VendorTable::of(&own, convention, frames)).unwrap();
                let name = format!("{} {convention:?} {frames}", chain.name());
                assert_eq!(found.verdict, Verdict::Exact, "{name}: {:?}", found.placement);
                assert!(needed(&found) == 0 && found.prints_back(), "{name}: {:?}", found.placement);
                if frames {
                    let identity = denavit_model::Pose::identity();
                    assert_eq!(se3::difference(&found.placement.base, &identity), (0.0, 0.0), "{name}");
                    assert_eq!(se3::difference(&found.placement.tool, &identity), (0.0, 0.0), "{name}");
                }
            }
        }
    }
}

#[test]
fn a_base_row_that_is_given_must_hold() {
    let chain = examples::puma_like();
    let own = table(&chain, &Options::default()).unwrap().value;
    let mut vendor = VendorTable::of(&own, Convention::Proximal, true);
    let base = vendor.base.as_mut().unwrap();
    let before = base.d.clone().unwrap_or_default().value;
    base.d = Some((before + 0.1).into());
    let found = match_table(&chain, &vendor).unwrap();
    assert_eq!(found.verdict, Verdict::Mismatch);
    vendor.base = None;
    assert_eq!(match_table(&chain, &vendor).unwrap().verdict, Verdict::Exact);
}

fn urdf_files(folder: &std::path::Path, found: &mut Vec<PathBuf>) {
    let mut entries: Vec<PathBuf> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    entries.sort();
    for path in entries {
        if path.is_dir() {
            urdf_files(&path, found);
        } else if path.extension().is_some_and(|extension| extension == "urdf") {
            found.push(path);
        }
    }
}

#[test]
fn every_robot_of_the_corpus_matches_its_own_table() {
    let Some(folder) = vendor_corpus() else { return };
    let mut files = Vec::new();
    urdf_files(&folder.join("robots"), &mut files);
    let (mut compared, mut worst) = (0, 0.0f64);
    for path in files {
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        let Ok(robot) = urdf::read(&name, &std::fs::read_to_string(&path).unwrap()) else { continue };
        let Ok(chain) = robot.chain(None, None, Reading::Intended) else { continue };
        let chain = chain.value;
        let parallelism = Parallelism::Within { angle: 1e-6 };
        let own = table(&chain, &Options { parallelism, ..Options::default() }).unwrap();
        let found = match_table(&chain, &VendorTable::of(&own.value, Convention::Distal, false)).unwrap();
        assert_eq!(found.verdict, Verdict::Exact, "{name}: {:?}", found.placement);
        for (joint, of_chain) in found.placement.joints.iter().zip(chain.joints()) {
            assert_eq!((joint.sense.sign(), joint.zero), (of_chain.scale.signum(), 0.0), "{name}: {}", joint.name);
        }
        worst = worst.max(found.placement.position_error);
        compared += 1;
    }
    println!("{compared} robots, largest error {worst:.1e} m");
    assert!(compared > 200);
}

/// A wrong length in the middle of the arm: a belongs to one row alone, d may stand in any row of parallel axes.
#[test]
fn a_wrong_number_in_the_table_of_a_corpus_robot_is_named() {
    let Some(folder) = vendor_corpus() else { return };
    let mut files = Vec::new();
    urdf_files(&folder.join("robots"), &mut files);
    let (mut named, mut elsewhere) = (0, Vec::new());
    for path in files {
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        let Ok(robot) = urdf::read(&name, &std::fs::read_to_string(&path).unwrap()) else { continue };
        let Ok(chain) = robot.chain(None, None, Reading::Intended) else { continue };
        let chain = chain.value;
        let joints = chain.joints().len();
        if !(4..=7).contains(&joints) {
            continue;
        }
        let own = table(&chain, &Options::default()).unwrap().value;
        let mut wrong = VendorTable::of(&own, Convention::Distal, false);
        let which = if named % 2 == 0 { DhNumber::A } else { DhNumber::D };
        let row = &mut wrong.joints[joints / 2].row;
        let number = if which == DhNumber::A { row.a.as_mut() } else { row.d.as_mut() }.unwrap();
        number.value += 0.03 * chain.size();
        let found = match_table(&chain, &wrong).unwrap();
        // On an arm of some centimetres this is no more than a rounded number; some d are the frames' own.
        let Some(explanation) = &found.explanation else {
            assert!(found.verdict <= Verdict::Rounded, "{name}: {:?}", found.placement);
            continue;
        };
        assert_eq!(explanation.differences.len(), 1, "{name}: {:?}", explanation.differences);
        assert_eq!(explanation.differences[0].number, which, "{name}: {:?}", explanation.differences);
        assert!(explanation.placement.position_error < 1e-4 * chain.size(), "{name}: {:?}", explanation.placement);
        if explanation.differences[0].label == RowLabel::Joint(joints / 2) {
            named += 1;
        } else {
            elsewhere.push(name);
        }
    }
    println!("named in its row {named} times, in another of a run of parallel axes: {elsewhere:?}");
    assert!(named > 100 && elsewhere.len() < named / 20, "{named} {elsewhere:?}");
}
