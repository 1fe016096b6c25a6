//! Pairs of real files of one robot, explained in words that name the joint.

use crate::support::vendor;
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
    Options { scope: Scope::Kinematics, ..Options::default() }
}

#[test]
fn twelve_limbed_robot_before_and_after_its_axes_were_mended() {
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

#[test]
fn show() {
    for (one, other) in [
        ("robots/franka/panda_arm_hand_drake.urdf", "robots/franka/fer_hand.urdf"),
        ("robots/random/anymal.urdf", "robots/oems/anymal.urdf"),
        ("robots/robotics-toolbox/wx250s.urdf", "robots/interbotix/wx250s_expanded.urdf"),
        ("robots/ros-industrial/irb120t_3_58.urdf", "robots/abb/irb120_3_58.urdf"),
        ("robots/kuka/iiwa7.urdf", "robots/kuka/med7.urdf"),
        ("robots/robotics-toolbox/ur5.urdf", "../../main/robots/universal_robots/ur5e.urdf"),
        ("robots/kuka/lbr_iiwa_14_r820.urdf", "../../main/robots/kuka/iiwa14.urdf"),
        ("robots/franka/fer_hand.urdf", "../../main/robots/franka/panda.urdf"),
    ] {
        explained(one, other, &kinematics());
    }
}
