//! Robots written as MJCF and read again.

#![allow(clippy::unwrap_used, clippy::format_push_string, clippy::type_complexity)] // Tests: a panic is a failure.

use denavit_mjcf::WriteOptions;
use denavit_model::placed::PlacedRobot;
use denavit_model::{Reading, Robot, se3, urdf};
use proptest::prelude::*;

fn written(robot: &Robot) -> denavit_model::formats::Written {
    denavit_mjcf::write(robot, &WriteOptions { fix_inertia: false, mesh: &|_| None, srdf: None })
        .unwrap_or_else(|error| panic!("{error}"))
}

fn again(robot: &Robot) -> Robot {
    let text = written(robot).text;
    let urdf = denavit_mjcf::read("again.xml", &text, &mut |name| Err(format!("there is no {name}")));
    urdf::read("again.xml", &urdf.unwrap_or_else(|error| panic!("{error}\n{text}"))).unwrap()
}

/// A chain of links, every number chosen.
fn robot(links: &[([f64; 3], [f64; 3], [f64; 3], u8, f64)]) -> Robot {
    let mut text = String::from("<robot name=\"r\"><link name=\"l0\"/>");
    for (index, (xyz, rpy, axis, kind, mass)) in links.iter().enumerate() {
        let kind = ["revolute", "continuous", "prismatic", "fixed"][usize::from(*kind) % 4];
        let words = |v: &[f64; 3]| v.map(|x| x.to_string()).join(" ");
        let next = index + 1;
        text += &format!(
            "<link name=\"l{next}\"><inertial><origin xyz=\"{0}\" rpy=\"{1}\"/><mass value=\"{mass}\"/>
            <inertia ixx=\"2\" ixy=\".1\" ixz=\".2\" iyy=\"2.5\" iyz=\"-.1\" izz=\"3\"/></inertial>
            <collision><origin xyz=\"{0}\" rpy=\"{1}\"/><geometry><box size=\"1 2 3\"/></geometry></collision></link>
            <joint name=\"j{index}\" type=\"{kind}\"><origin xyz=\"{0}\" rpy=\"{1}\"/><parent link=\"l{index}\"/>
            <child link=\"l{next}\"/><axis xyz=\"{2}\"/><limit lower=\"-1\" upper=\"{mass}\" effort=\"{mass}\"/></joint>",
            words(xyz),
            words(rpy),
            words(axis)
        );
    }
    urdf::read("r.urdf", &(text + "</robot>")).unwrap()
}

fn vector(range: std::ops::Range<f64>) -> impl Strategy<Value = [f64; 3]> {
    [range.clone(), range.clone(), range]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// Frames, axes, limits and masses come back.
    #[test]
    fn a_robot_comes_back(links in prop::collection::vec((vector(-2.0..2.0), vector(-3.0..3.0), vector(0.1..1.0), 0u8..4, 0.5f64..4.0), 1..8)) {
        let first = robot(&links);
        let second = again(&first);
        let (a, b) = (PlacedRobot::new(&first, Reading::AsWritten), PlacedRobot::new(&second, Reading::AsWritten));
        for (index, link) in first.links.iter().enumerate() {
            let other = second.link_index(&link.name).unwrap();
            let (angle, distance) = se3::difference(a.pose(index), b.pose(other));
            prop_assert!(angle < 1e-13 && distance < 1e-13, "{} {} {}", link.name, angle, distance);
            if let (Some(one), Some(two)) = (a.mass(index), b.mass(other)) {
                prop_assert!((one.mass - two.mass).abs() < 1e-14 && (one.centre - two.centre).norm() < 1e-13);
                prop_assert!((one.tensor - two.tensor).norm() < 1e-12, "{} {}", one.tensor, two.tensor);
            } else {
                prop_assert_eq!(link.name.as_str(), "l0");
            }
        }
        for joint in first.joints.iter().filter(|joint| joint.kind.moves()) {
            let other = &second.joints[second.joint_index(&joint.name).unwrap()];
            prop_assert_eq!(joint.kind.word(), other.kind.word());
            prop_assert_eq!(joint.limits_in_force(), other.limits_in_force());
            prop_assert!((joint.axis.into_inner() - other.axis.into_inner()).norm() < 1e-15);
        }
    }
}

#[test]
fn what_is_written_is_written_again_to_the_byte() {
    let first = robot(&[
        ([1.0, 0.0, 0.5], [0.0, 1.5, 0.0], [0.0, 0.0, 1.0], 0, 2.0),
        ([0.0, 0.0, 1.0], [0.0; 3], [0.0, 1.0, 0.0], 2, 1.0),
    ]);
    let text = written(&first).text;
    assert_eq!(written(&again(&first)).text, text);
}

#[test]
fn couplings_and_screws_come_back() {
    let text = r#"<robot name="r" xmlns:drake="http://drake.mit.edu"><link name="a"/><link name="b"/><link name="c"/>
      <drake:joint name="s" type="screw"><parent link="a"/><child link="b"/><axis xyz="0 0 1"/><drake:screw_thread_pitch value="0.01"/></drake:joint>
      <joint name="m" type="continuous"><parent link="a"/><child link="c"/><axis xyz="0 0 1"/><mimic joint="s" multiplier="-2" offset="0.5"/></joint>
      </robot>"#;
    let first = urdf::read("r.urdf", text).unwrap();
    let second = again(&first);
    let chain = |robot: &Robot, tip: &str| robot.chain(Some("a"), Some(tip), Reading::AsWritten).unwrap().value;
    for tip in ["b", "c"] {
        let (one, two) = (chain(&first, tip), chain(&second, tip));
        let (angle, distance) = se3::difference(&one.fk(&[0.7]), &two.fk(&[0.7]));
        assert!(angle < 1e-15 && distance < 1e-15, "{tip}");
    }
}

#[test]
fn what_no_body_can_have_is_refused_or_changed_by_choice() {
    let text = "<robot name=\"r\"><link name=\"a\"/>\n<link name=\"b\"><inertial><mass value=\"1\"/><inertia ixx=\"1\" iyy=\"1\" izz=\"3\"/>
      </inertial></link><joint name=\"j\" type=\"continuous\"><parent link=\"a\"/><child link=\"b\"/></joint></robot>";
    let robot = urdf::read("r.urdf", text).unwrap();
    let error = denavit_mjcf::write(&robot, &WriteOptions { fix_inertia: false, mesh: &|_| None, srdf: None })
        .unwrap_err()
        .to_string();
    assert!(
        error.starts_with("r.urdf:2: link \"b\": no body can have the principal moments")
            && error.contains("fix-inertia"),
        "{error}"
    );
    let changed =
        denavit_mjcf::write(&robot, &WriteOptions { fix_inertia: true, mesh: &|_| None, srdf: None }).unwrap();
    assert!(changed.losses.iter().any(|loss| loss.what == "its inertia"));
    assert!(changed.text.contains("diaginertia=\"1.5"), "{}", changed.text);
}
