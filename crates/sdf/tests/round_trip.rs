//! A robot is the same after the way through SDF, whatever its joints and numbers.

#![allow(clippy::unwrap_used, clippy::format_push_string)] // Tests: a panic is a failure.

use denavit_model::{JointKind, Reading, Robot, urdf};
use proptest::prelude::*;

/// A joint of a random robot: type, parent (any link before), origin, axis, whether the link weighs something.
type Made = (usize, usize, [f64; 6], [f64; 3], bool);

const KINDS: [&str; 6] = ["fixed", "revolute", "continuous", "prismatic", "screw", "floating"];

fn robot(joints: &[Made]) -> Robot {
    let mass = "<inertial><origin xyz=\"0.1 0 0.3\" rpy=\"0.1 1.5708 0\"/><mass value=\"1.5\"/>\
                <inertia ixx=\"0.1\" ixy=\"0.01\" ixz=\"0\" iyy=\"0.2\" iyz=\"-0.02\" izz=\"0.15\"/></inertial>";
    let mut text = format!("<robot name=\"r\" xmlns:drake=\"http://drake.mit.edu\"><link name=\"l0\">{mass}</link>\n");
    for (index, (kind, parent, [x, y, z, roll, pitch, yaw], axis, heavy)) in joints.iter().enumerate() {
        let kind = KINDS[if *parent % (index + 1) == 0 { *kind } else { kind % 5 }];
        let [a, b, c] = axis;
        let tag = if kind == "screw" { "drake:joint" } else { "joint" };
        text += &format!("<link name=\"l{}\">{}</link>\n", index + 1, if *heavy { mass } else { "" });
        text += &format!(
            "<{tag} name=\"{}{index}\" type=\"{kind}\"><origin xyz=\"{x} {y} {z}\" rpy=\"{roll} {pitch} {yaw}\"/>\
             <parent link=\"l{}\"/><child link=\"l{}\"/>",
            // Every third joint is called as a link is.
            if index % 3 == 2 { "l" } else { "j" },
            parent % (index + 1),
            index + 1
        );
        if !["fixed", "floating"].contains(&kind) {
            text += &format!("<axis xyz=\"{a} {b} {c}\"/>");
        }
        match kind {
            "revolute" | "prismatic" => {
                text += "<limit lower=\"-1.2\" upper=\"2\" effort=\"10\" velocity=\"3\"/><dynamics damping=\"0.1\" friction=\"0.2\"/>";
            }
            "screw" => text += &format!("<drake:screw_thread_pitch value=\"{}\"/>", 0.01 + x.abs()),
            _ => {}
        }
        text += &format!("</{tag}>\n");
    }
    urdf::read("r.urdf", &(text + "</robot>")).unwrap()
}

fn again(robot: &Robot) -> Robot {
    let sdf = denavit_sdf::write(robot).unwrap().text;
    let text = denavit_sdf::read("r.sdf", &sdf, &mut denavit_sdf::includes::nothing);
    let text = text.unwrap_or_else(|error| panic!("{error}\n{sdf}"));
    urdf::read("r.sdf", &text).unwrap_or_else(|error| panic!("{error}\n{sdf}\n{text}"))
}

fn made() -> impl Strategy<Value = Vec<Made>> {
    let number = || prop_oneof![Just(0.0), Just(0.1), Just(-1.571), -3.0..3.0f64];
    let numbers = prop::array::uniform6(number());
    let axis = prop_oneof![Just([0.0, 0.0, 1.0]), Just([1.0, 0.0, 0.0]), prop::array::uniform3(0.1..1.0f64)];
    prop::collection::vec((0..6usize, 0..100usize, numbers, axis, any::<bool>()), 1..10)
}

proptest! {
    #[test]
    fn a_robot_comes_back_from_sdf(joints in made()) {
        let first = robot(&joints);
        let second = again(&first);
        prop_assert_eq!(&first.links[first.root].name, &second.links[second.root].name);
        prop_assert_eq!(first.links.len(), second.links.len());
        let named = |robot: &Robot, joint: &denavit_model::Joint| robot.links[joint.child].name.clone();
        for joint in &first.joints {
            let name = named(&first, joint);
            let other = second.joints.iter().find(|other| named(&second, other) == name).unwrap();
            prop_assert_eq!(&first.links[joint.parent].name, &second.links[other.parent].name);
            // In the digits that they were written with.
            prop_assert_eq!(joint.origin.read(Reading::AsWritten), other.origin.read(Reading::AsWritten));
            prop_assert_eq!(joint.origin.read(Reading::Intended), other.origin.read(Reading::Intended));
            match (&joint.kind, &other.kind) {
                (JointKind::Screw(one), JointKind::Screw(two)) => {
                    let (one, two) = (one.metres_per_radian(), two.metres_per_radian());
                    prop_assert!((one - two).abs() <= 2e-16 * one.abs());
                }
                (one, two) => prop_assert_eq!(one, two),
            }
            if joint.kind.moves() && joint.kind != JointKind::Floating {
                prop_assert_eq!(joint.axis_written, other.axis_written);
            }
            prop_assert_eq!(joint.limits, other.limits);
            prop_assert_eq!(joint.dynamics(), other.dynamics());
            if !other.name.starts_with('l') && joint.kind != JointKind::Floating {
                prop_assert!(joint.name == other.name || other.name.ends_with("_joint"), "{} {}", joint.name, other.name);
            }
        }
        for link in &first.links {
            let other = &second.links[second.link_index(&link.name).unwrap()];
            prop_assert_eq!(&link.inertial, &other.inertial);
        }
        // What was exported once does not change any more.
        let once = denavit_sdf::write(&second).unwrap().text;
        prop_assert_eq!(&once, &denavit_sdf::write(&again(&second)).unwrap().text);
    }
}

#[test]
fn a_screw_joint_stays_one_joint() {
    let text = r#"<robot name="r" xmlns:drake="http://drake.mit.edu"><link name="a"/><link name="b"/>
        <drake:joint name="s" type="screw"><parent link="a"/><child link="b"/><axis xyz="0 0 1"/>
        <drake:screw_thread_pitch value="0.02"/></drake:joint></robot>"#;
    let robot = urdf::read("r.urdf", text).unwrap();
    let sdf = denavit_sdf::write(&robot).unwrap().text;
    assert!(sdf.contains("<screw_thread_pitch>0.02</screw_thread_pitch>"), "{sdf}");
    assert_eq!(again(&robot).joints.len(), 1);
    assert_eq!(again(&robot).joints[0].kind, robot.joints[0].kind);
}
