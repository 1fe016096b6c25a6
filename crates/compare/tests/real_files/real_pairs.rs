//! Pairs of real files of one robot, explained in words that name the joint.

use crate::real_files::support::{as_written, vendor};
use denavit_compare::report::{Colour, Report, text};
use denavit_compare::{Comparison, Options, Scope, Subject, Verdict, compare};

/// What sets two files apart as to motion; `None`, with the reason printed, where the corpus is not there.
fn explained(one: &str, other: &str, options: &Options) -> Option<(Comparison, Vec<String>)> {
    let (Some(a), Some(b)) = (vendor::robot(one), vendor::robot(other)) else {
        println!("skipped, because ../shared/vendor has no {one} or {other}");
        return None;
    };
    let found = compare(&Subject::Robot(&a), &Subject::Robot(&b), options).unwrap();
    println!("{}", text(&Report::Comparison(&found), Colour::None));
    let changes = found
        .joints
        .iter()
        .flat_map(|joint| joint.changes.iter().map(|change| format!("{}: {}", joint.joint, change.what)));
    let changes = changes.collect();
    Some((found, changes))
}

fn kinematics() -> Options {
    Options { scope: Scope::Kinematics, ..as_written() }
}

#[test]
fn twelve_limbed_robot_before_and_after_its_axes_were_corrected() {
    let Some((found, changes)) = explained("robots/jpl/t12.urdf", "robots/jpl/t12_wrong_axes.urdf", &kinematics())
    else {
        return;
    };
    assert_eq!(changes.len(), 24);
    assert!(changes.iter().all(|change| change.ends_with(": sense reversed")));
    for limb in 1..=6 {
        for joint in ["HY", "HP", "KR", "AR"] {
            assert!(changes.contains(&format!("{joint}{limb}: sense reversed")), "{joint}{limb}");
        }
    }
    assert!(found.tips.iter().all(|tip| tip.sampled_m > 1.0 && tip.sampled_m <= tip.bound_m));
    let zeros = Options { up_to_zeros: true, ..kinematics() };
    let (found, _) = explained("robots/jpl/t12.urdf", "robots/jpl/t12_wrong_axes.urdf", &zeros).unwrap();
    assert_eq!(found.verdict, Verdict::Different, "reversed senses turn the limits round, too");
    assert!(found.tips.iter().all(|tip| tip.sampled_m < 1e-6), "{:?}", found.tips);
}

/// Changes of limits left out: makers state different ones of the same arm.
fn but_limits(changes: Vec<String>) -> Vec<String> {
    changes.into_iter().filter(|change| !change.contains(" limit ")).collect()
}

#[test]
fn ur5_of_two_sources_moves_alike_and_is_drawn_and_limited_otherwise() {
    let pair = ("robots/ros-industrial/ur5.urdf", "robots/robotics-toolbox/ur5.urdf");
    let Some((found, changes)) = explained(pair.0, pair.1, &kinematics()) else { return };
    assert!(changes.contains(&"shoulder_pan_joint: upper limit 6.283185307179586 to 3.141592653589793".to_owned()));
    assert_eq!(but_limits(changes), Vec::<String>::new());
    assert!(found.tips.iter().all(|tip| tip.sampled_m < 1e-9), "{:?}", found.tips);
    let (found, _) = explained(pair.0, pair.1, &as_written()).unwrap();
    let parts: Vec<String> = found.parts.iter().map(|part| format!("{}: {}", part.part, part.what)).collect();
    assert!(parts.contains(&"link \"forearm_link\": visual moved by 350 µm".to_owned()), "{parts:#?}");
    assert!(parts.contains(&"link \"upper_arm_link\": centre of mass moved by 67.5 mm".to_owned()), "{parts:#?}");
}

#[test]
fn same_arms_of_different_makers_of_files_are_the_same() {
    for (one, other) in [
        ("robots/ur/ur5_limited_legacy.urdf", "robots/robotics-toolbox/ur5.urdf"),
        ("robots/random/anymal.urdf", "robots/oems/anymal.urdf"),
        ("robots/ros-industrial/irb120t_3_58.urdf", "robots/abb/irb120_3_58.urdf"),
    ] {
        let Some((found, _)) = explained(one, other, &kinematics()) else { return };
        assert_eq!(found.verdict, Verdict::Same, "{one} {other}");
    }
}

#[test]
fn iiwa_with_short_angles_has_two_axes_off_by_what_they_leave_out() {
    let pair = ("robots/kuka/lbr_iiwa_14_r820.urdf", "robots/drake/iiwa14_no_collision.urdf");
    let Some((found, changes)) = explained(pair.0, pair.1, &kinematics()) else { return };
    assert_eq!(but_limits(changes), ["joint_a2: axis moved by 436.2 µm", "joint_a3: axis moved by 436.2 µm"]);
    assert!(found.joints.iter().all(|joint| joint.renamed.is_some()));
    // The angle that 1.5707 or 1.57 leaves out, over the arm's length.
    assert!(found.largest().unwrap().sampled_m > 8e-4 && found.largest().unwrap().bound_m < 2e-3);
}

#[test]
fn simplified_pr2_holds_still_what_the_full_one_turns() {
    let pair = ("robots/drake/pr2_simplified.urdf", "robots/random/pr2.urdf");
    let Some((_, changes)) = explained(pair.0, pair.1, &kinematics()) else { return };
    assert!(changes.contains(&"torso_lift_joint: upper limit 0.31 to 0.33".to_owned()));
    assert!(changes.contains(&"laser_tilt_mount_joint: kind fixed to revolute".to_owned()));
    assert_eq!(changes.iter().filter(|change| change.ends_with("kind fixed to continuous")).count(), 12);
    assert_eq!(changes.iter().filter(|change| change.contains(": mimic: free to 1 × ")).count(), 6);
    let same = changes.iter().all(|change| !change.contains("axis") && !change.contains("zero"));
    assert!(same, "{changes:?}");
}

#[test]
fn panda_of_two_sources_differs_in_the_coupling_of_its_fingers() {
    let pair = ("robots/franka/panda_arm_hand_drake.urdf", "robots/franka/fer_hand.urdf");
    let Some((_, changes)) = explained(pair.0, pair.1, &kinematics()) else { return };
    assert_eq!(but_limits(changes), ["panda_finger_joint2: mimic: free to 1 × \"fer_finger_joint1\" + 0"]);
}
