//! The robots of this repository against the tables beside them.

use crate::corpus::{Rows, chain_of, lengths_misprinted, needed, read_robot};
use denavit_dh::convert::{HAYATI_BELOW, Options, table};
use denavit_dh::matching::{VendorTable, Verdict, match_table};
use denavit_dh::{Convention, NearParallel};
use denavit_model::tree::Reading;
use denavit_model::{examples, se3};
use std::path::PathBuf;

/// File, table, base, tip: chains where the table covers a part of the robot.
const ROBOTS: [(&str, &str, &str, &str); 10] = [
    ("abb/irb120.urdf", "abb/irb120_dh.csv", "root", "child link of joint_6"),
    ("adept/cobra600.urdf", "adept/cobra600_dh.csv", "root", "child link of joint_4"),
    ("franka/panda.urdf", "franka/panda_dh.csv", "root", "child link of panda_joint7"),
    ("kuka/iiwa14.urdf", "kuka/iiwa14_dh.csv", "root", "child link of joint_a7"),
    ("kuka/kr16_2_on_rail.urdf", "kuka/kr16_2_dh.csv", "child link of rail", "child link of joint_a6"),
    ("rethink/baxter.urdf", "rethink/baxter_right_arm_dh.csv", "root", "child link of right_w2"),
    ("stanford/stanford_arm.urdf", "stanford/stanford_arm_dh.csv", "root", "child link of hand_roll_joint"),
    ("ufactory/xarm7.urdf", "ufactory/xarm7_dh.csv", "root", "child link of joint7"),
    ("unimation/puma560.urdf", "unimation/puma560_dh.csv", "root", "child link of wrist_flange_joint"),
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
