//! Pairs of real files.

use denavit_compare::report::{Colour, Report, text};
use denavit_compare::{Options, Scope, Subject, compare};
use denavit_model::{Robot, urdf};
use std::path::PathBuf;

fn vendor(name: &str) -> Option<Robot> {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../../shared/vendor").join(name);
    let text = std::fs::read_to_string(&path).ok()?;
    Some(urdf::read(name, &text).unwrap())
}

#[test]
fn pairs_are_explained() {
    for (one, other) in [
        ("robots/jpl/t12.urdf", "robots/jpl/t12_wrong_axes.urdf"),
        ("robots/ros-industrial/ur5.urdf", "robots/robotics-toolbox/ur5.urdf"),
        ("robots/ur/ur5_limited_legacy.urdf", "robots/robotics-toolbox/ur5.urdf"),
        ("robots/kuka/lbr_iiwa_14_r820.urdf", "robots/drake/iiwa14_no_collision.urdf"),
        ("robots/drake/pr2_simplified.urdf", "robots/random/pr2.urdf"),
        ("robots/robotics-toolbox/pr2.urdf", "robots/random/pr2.urdf"),
        ("robots/franka/panda_arm_hand_drake.urdf", "robots/franka/fer_hand.urdf"),
        ("robots/random/anymal.urdf", "robots/oems/anymal.urdf"),
    ] {
        let (Some(a), Some(b)) = (vendor(one), vendor(other)) else { continue };
        let start = std::time::Instant::now();
        let found = compare(
            &Subject::Robot(&a),
            &Subject::Robot(&b),
            &Options { scope: Scope::Kinematics, ..Options::default() },
        )
        .unwrap();
        println!("{:?}\n{}", start.elapsed(), text(&Report::Comparison(&found), Colour::None));
    }
}
