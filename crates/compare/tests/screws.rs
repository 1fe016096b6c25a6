//! Screw joints, however a file writes them.

use denavit_compare::{Options, Scope, Subject, Verdict, compare};
use denavit_model::urdf;

#[test]
fn a_screw_joint_and_the_pair_that_urdf_needs_for_it_are_the_same() {
    let links = r#"<link name="base"/><link name="nut"/><link name="tip"/>
        <joint name="flange" type="fixed"><origin xyz="0.1 0 0.2"/><parent link="nut"/><child link="tip"/></joint>"#;
    let one = format!(
        r#"<robot name="r" xmlns:drake="http://drake.mit.edu">{links}
        <drake:joint name="j" type="screw"><axis xyz="0 0 1"/><parent link="base"/><child link="nut"/>
        <drake:screw_thread_pitch value="0.02"/></drake:joint></robot>"#
    );
    let pitch = 0.02 / std::f64::consts::TAU;
    let other = format!(
        r#"<robot name="r">{links}<link name="between"/>
        <joint name="j" type="continuous"><axis xyz="0 0 1"/><parent link="base"/><child link="between"/></joint>
        <joint name="k" type="prismatic"><axis xyz="0 0 -1"/><parent link="between"/><child link="nut"/>
        <mimic joint="j" multiplier="-{pitch}"/></joint></robot>"#
    );
    let (one, other) = (urdf::read("a", &one).unwrap(), urdf::read("b", &other).unwrap());
    let options = Options { scope: Scope::Kinematics, ..Options::default() };
    let found = compare(&Subject::Robot(&one), &Subject::Robot(&other), &options).unwrap();
    assert_eq!(found.verdict, Verdict::Same, "{:?} {:?}", found.joints, found.parts);
    assert!(found.tips[0].sampled_m < 1e-15);
}
