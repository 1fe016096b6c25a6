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

/// A cell with an arm in it, and a tool in that.
const NESTED: &str = include_str!("models/cell.sdf");

fn of_sdf(text: &str) -> Robot {
    let urdf = denavit_sdf::read("r.sdf", text, &mut denavit_sdf::includes::nothing).unwrap();
    urdf::read("r.sdf", &urdf).unwrap()
}

#[test]
fn models_in_a_model_are_written_as_such() {
    let robot = of_sdf(NESTED);
    let written = denavit_sdf::write(&robot).unwrap();
    assert!(!written.losses.iter().any(|loss| loss.to_string().contains("::")), "{:?}", written.losses);
    for part in [
        "    <model name=\"arm\">",
        "      <model name=\"tool\">",
        "<child>tool::finger</child>",
        "<mimic joint=\"j\">",
    ] {
        assert!(written.text.contains(part), "{part}\n{}", written.text);
    }
    let again = of_sdf(&written.text);
    let names =
        |robot: &Robot| robot.links.iter().map(|link| link.name.clone()).collect::<std::collections::BTreeSet<_>>();
    assert_eq!(names(&robot), names(&again));
    let place = |robot: &Robot, link: &str, value: f64| {
        let chain = robot.chain(Some("table"), Some(link), Reading::Intended).unwrap().value;
        chain.fk(&vec![value; chain.coordinates().len()])
    };
    for link in names(&robot).iter().filter(|link| *link != "table") {
        for value in [0.0, 0.4] {
            let (one, other) = (place(&robot, link, value), place(&again, link, value));
            let apart = (one.to_homogeneous() - other.to_homogeneous()).norm();
            assert!(apart < 1e-14, "{link}: {apart}\n{}", written.text);
        }
    }
    // Joints may lead out of a model. Where two lead into it, one of its links would have to name a joint outside.
    let outside = NESTED.replace(
        "<joint name=\"mount\"",
        "<joint name=\"far\" type=\"fixed\"><parent>arm::upper</parent><child>lamp</child></joint>\
        <link name=\"lamp\"/><joint name=\"mount\"",
    );
    assert!(denavit_sdf::write(&of_sdf(&outside)).unwrap().text.contains("<model name=\"arm\">"));
    let two = NESTED.replace("</model>\n  <joint name=\"mount\"", "<link name=\"loose\"/></model>\
        <joint name=\"second\" type=\"fixed\"><parent>table</parent><child>arm::loose</child></joint>\n  <joint name=\"mount\"");
    let flat = denavit_sdf::write(&of_sdf(&two)).unwrap();
    assert!(
        flat.text.contains("arm__base")
            && flat.losses.iter().any(|loss| loss.to_string().contains("\"::\" separates models"))
    );
}

#[test]
fn an_effort_of_minus_one_is_listed() {
    let text = r#"<robot name="r"><link name="a"/><link name="b"/><joint name="j" type="prismatic"><parent link="a"/><child link="b"/>
        <limit lower="0" upper="1" effort="-1" velocity="2"/></joint></robot>"#;
    let losses = denavit_sdf::write(&urdf::read("r.urdf", text).unwrap()).unwrap().losses;
    assert!(
        losses.iter().any(|loss| loss.to_string().contains("effort limit of -1: SDF reads that as no limit")),
        "{losses:?}"
    );
}

#[test]
fn a_joint_to_a_link_of_gazebo_alone_is_listed() {
    let text = r#"<robot name="r"><link name="a"/><gazebo><link name="pad"/><joint name="loop" type="revolute"><parent>pad</parent>
        <child>a</child><axis><xyz>0 0 1</xyz></axis></joint></gazebo></robot>"#;
    let robot = urdf::read("r.urdf", text).unwrap();
    let losses = denavit_sdf::write(&robot).unwrap().losses;
    assert!(losses.iter().any(|loss| loss.to_string().contains("the robot does not have")), "{losses:?}");
    assert_eq!(again(&robot).links.len(), 1);
}
