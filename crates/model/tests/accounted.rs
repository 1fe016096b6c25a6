//! The reader says of everything in a file what became of it.

#![allow(clippy::unwrap_used, clippy::format_collect)] // Tests: a panic is a failure.

use denavit_model::{Note, Outcome, Reading, Robot, UrdfError, se3, urdf, write};
use proptest::prelude::*;

/// A robot that has every element that URDF knows, once or more.
const ROBOT: &str = r#"<robot name="r" version="1.1">
  <material name="grey"><color rgba="1 1 1 1"/></material>
  <link name="base"/>
  <link name="arm">
    <inertial><origin xyz="0 0 1" rpy="0 0 0"/><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>
    <visual name="v"><origin xyz="0 0 1" quat_xyzw="0 0 0 1"/><geometry><box size="1 1 1"/></geometry><material name="grey"/></visual>
    <visual><geometry><cylinder radius="1" length="1"/></geometry></visual>
    <collision name="c"><origin xyz="0 0 1"/><geometry><sphere radius="1"/></geometry></collision>
    <collision><geometry><mesh filename="a.stl" scale="1 1 1"/></geometry></collision>
    <collision><geometry><capsule radius="1" length="1"/></geometry></collision>
  </link>
  <link name="hand"/>
  <joint name="j" type="revolute">
    <origin xyz="0 0 1" rpy="0 0 0"/><parent link="base"/><child link="arm"/><axis xyz="0 0 1"/>
    <limit lower="-1" upper="1" velocity="1" effort="1"/><dynamics damping="1" friction="1"/>
    <safety_controller soft_lower_limit="-1" soft_upper_limit="1" k_position="1" k_velocity="1"/>
  </joint>
  <joint name="k" type="revolute">
    <parent link="arm"/><child link="hand"/><mimic joint="j" multiplier="1" offset="0"/><limit lower="0" upper="1"/>
  </joint>
  <transmission name="t"><type>simple</type></transmission>
</robot>"#;

/// Elements whose content the reader keeps whole.
const KEPT: [&str; 4] = ["material", "color", "transmission", "type"];

fn read(text: &str) -> Robot {
    urdf::read("r.urdf", text).unwrap_or_else(|error| panic!("{error}\n{text}"))
}

fn not_understood(robot: &Robot) -> Vec<String> {
    let notes = robot.notes.iter().filter(|note| matches!(note, Note::NotUnderstood { .. }));
    notes.map(ToString::to_string).collect()
}

/// Byte offsets just behind the tag name of every element that the reader takes apart, and its tag.
fn positions() -> Vec<(usize, &'static str)> {
    let starts = ROBOT.match_indices('<').filter(|(at, _)| ROBOT[at + 1..].starts_with(char::is_alphabetic));
    let tags = starts.map(|(at, _)| {
        let tag = &ROBOT[at + 1..];
        let tag = &tag[..tag.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(tag.len())];
        (at + 1 + tag.len(), tag)
    });
    tags.filter(|(_, tag)| !KEPT.contains(tag)).collect()
}

/// The text with something put into the element whose tag name ends at `at`.
fn with_inside(at: usize, what: &str) -> String {
    let end = at + ROBOT[at..].find('>').unwrap();
    let tag_at = ROBOT[..at].rfind('<').unwrap();
    if ROBOT[..end].ends_with('/') {
        let tag = &ROBOT[tag_at + 1..at];
        return format!("{}>{what}</{tag}{}", &ROBOT[..end - 1], &ROBOT[end..]);
    }
    format!("{}>{what}{}", &ROBOT[..end], &ROBOT[end + 1..])
}

#[test]
fn a_file_that_is_understood_is_wholly_understood() {
    let robot = read(ROBOT);
    assert_eq!(not_understood(&robot), Vec::<String>::new());
    let inventory = robot.inventory();
    assert_eq!(inventory.count(Outcome::Reported), 0);
    // Two materials and a transmission.
    assert_eq!(inventory.count(Outcome::Carried), 3, "{:?}", inventory.items);
    // All attributes but those of two materials, a colour and a transmission.
    assert_eq!(inventory.understood, positions().len() + ROBOT.matches("=\"").count() - 4);
}

#[test]
fn every_position_reports_an_attribute_an_element_and_a_text() {
    let line = |at: usize| 1 + ROBOT[..at].matches('\n').count();
    assert!(positions().len() > 30);
    for (at, tag) in positions() {
        let attribute = format!("{} odd=\"1\"{}", &ROBOT[..at], &ROBOT[at..]);
        for (text, words) in [
            (attribute, format!("attribute odd=\"1\" of <{tag}>")),
            (with_inside(at, "<odd/>"), format!("<odd> in <{tag}>")),
            (with_inside(at, "odd"), format!("text \"odd\" in <{tag}>")),
        ] {
            let robot = read(&text);
            let notes = not_understood(&robot);
            assert_eq!(notes.len(), 1, "{notes:?}\n{text}");
            assert!(notes[0].contains(&words), "{}: {words}", notes[0]);
            let inventory = robot.inventory();
            let reported: Vec<_> = inventory.reported().collect();
            assert_eq!(reported.len(), 1, "{reported:?}");
            assert_eq!((reported[0].place.line, &reported[0].what), (line(at), &words));
            assert!(!inventory.items.iter().any(|item| item.outcome == Outcome::Carried && item.what == "<odd>"));
        }
    }
}

#[test]
fn many_of_a_kind_have_one_note_and_as_many_items() {
    let robot = read(&ROBOT.replace("<link ", "<link odd=\"1\" "));
    let notes = not_understood(&robot);
    assert_eq!(notes.len(), 1, "{notes:?}");
    assert!(notes[0].contains("(3 of this kind in the file)"), "{notes:?}");
    assert_eq!(robot.inventory().count(Outcome::Reported), 3);
}

#[test]
fn a_file_of_nothing_else_is_read_in_time_and_summed_up() {
    let attributes: String = (0..20_000).map(|index| format!(" a{index}=\"1\"")).collect();
    let robot = read(&ROBOT.replace("<link name=\"hand\"", &format!("<link name=\"hand\"{attributes}")));
    let notes = not_understood(&robot);
    assert_eq!(notes.len(), 21);
    assert!(notes[20].contains("19980 more kinds"), "{}", notes[20]);
    assert_eq!(robot.inventory().count(Outcome::Reported), 20_000);
    let deep = 20_000;
    let nested = format!("<gazebo>{}x{}</gazebo></robot>", "<joint>".repeat(deep), "</joint>".repeat(deep));
    if let Ok(robot) = urdf::read("r.urdf", &ROBOT.replace("</robot>", &nested)) {
        assert!(robot.loops().is_empty());
    }
}

#[test]
fn near_names_are_proposed() {
    let said = |from: &str, to: &str| not_understood(&read(&ROBOT.replacen(from, to, 1))).join("\n");
    assert!(said("<limit lower", "<limits lower").contains("did you mean <limit>?"));
    assert!(said(" damping=", " dampng=").contains("did you mean damping?"));
    assert!(said("<axis xyz=", "<axis xzy=").contains("did you mean xyz?"));
    let odd =
        said("<origin xyz=\"0 0 1\" rpy=\"0 0 0\"/><parent", "<origin xyz=\"0 0 1\" quat_wxyz=\"1 0 0 0\"/><parent");
    assert!(odd.contains("joint \"j\": attribute quat_wxyz=\"1 0 0 0\" of <origin>"), "{odd}");
    assert!(odd.contains("xyz, rpy or quat_xyzw") || odd.contains("did you mean quat_xyzw"), "{odd}");
}

#[test]
fn calibration_and_second_elements_are_said() {
    let calibrated = read(&ROBOT.replace("<dynamics", "<calibration rising=\"-0.5\"/><dynamics"));
    assert!(not_understood(&calibrated)[0].contains("joint \"j\": <calibration> states where"), "{calibrated:?}");
    let second = read(&ROBOT.replace("<axis xyz=\"0 0 1\"/>", "<axis xyz=\"0 0 1\"/><axis xyz=\"0 1 0\"/>"));
    assert_eq!(second.inventory().count(Outcome::Reported), 1);
    assert!(second.notes.iter().any(|note| note.to_string().contains("a second <axis> is ignored")));
    let shapes = read(&ROBOT.replace("<sphere radius=\"1\"/>", "<sphere radius=\"1\"/><box size=\"1 1 1\"/>"));
    assert_eq!(not_understood(&shapes).len(), 1, "{:?}", shapes.notes);
    let xacro = ROBOT.replace("<robot ", "<robot xmlns:xacro=\"http://ros.org/wiki/xacro\" ");
    let xacro = read(&xacro.replace("<link name=\"hand\"/>", "<link name=\"hand\"/><xacro:tool/>"));
    assert!(not_understood(&xacro)[0].contains("xacro that was not expanded"), "{:?}", xacro.notes);
}

fn turned(origin: &str) -> Result<Robot, UrdfError> {
    let text = format!(
        r#"<robot name="r"><link name="a"/><link name="b"/>
        <joint name="j" type="fixed"><origin {origin}/><parent link="a"/><child link="b"/></joint></robot>"#
    );
    urdf::read("r.urdf", &text)
}

#[test]
fn a_quaternion_is_a_rotation_of_any_length_and_conflicts_with_rpy() {
    let robot = turned("xyz=\"1 2 3\" quat_xyzw=\"0.7071067811865476 0 0 0.7071067811865476\"").unwrap();
    assert_eq!(robot.joints[0].origin.rpy, [std::f64::consts::FRAC_PI_2, 0.0, 0.0]);
    assert!(robot.notes.is_empty(), "{:?}", robot.notes);
    let long = turned("quat_xyzw=\"2 0 0 2\"").unwrap();
    assert_eq!(long.joints[0].origin.rpy, [std::f64::consts::FRAC_PI_2, 0.0, 0.0]);
    assert!(long.notes[0].to_string().contains("has length 2.8284"), "{:?}", long.notes);
    for (origin, words) in [
        ("rpy=\"0 0 0\" quat_xyzw=\"0 0 0 1\"", "both rpy=\"0 0 0\" and quat_xyzw=\"0 0 0 1\""),
        ("quat_xyzw=\"0 0 0 0\"", "has length zero"),
        ("quat_xyzw=\"0 0 1\"", "has 3 numbers instead of 4"),
        ("quat_xyzw=\"0 0 0 x\"", "\"x\" is not a finite number"),
    ] {
        let error = turned(origin).unwrap_err().to_string();
        assert!(error.contains(words) && error.contains("r.urdf:2: joint \"j\""), "{error}");
    }
}

proptest! {
    #[test]
    fn a_quaternion_is_read_as_the_rotation_that_it_is_and_written_again(parts in prop::array::uniform4(-1.0..1.0f64)) {
        prop_assume!(parts.iter().map(|x| x * x).sum::<f64>() > 1e-3);
        let [x, y, z, w] = parts;
        let robot = turned(&format!("quat_xyzw=\"{x} {y} {z} {w}\"")).unwrap();
        let quaternion = nalgebra::UnitQuaternion::from_quaternion(nalgebra::Quaternion::new(w, x, y, z));
        let read = robot.joints[0].origin.read(Reading::Intended).pose();
        let off = se3::rotation_angle(&(read.rotation.inverse() * quaternion.to_rotation_matrix()));
        prop_assert!(off < 1e-14, "{off}");
        let again = urdf::read("again", &write::urdf(&robot)).unwrap();
        prop_assert_eq!(&again.joints[0].origin.quat_written, &robot.joints[0].origin.quat_written);
        prop_assert_eq!(again.joints[0].origin.rpy, robot.joints[0].origin.rpy);
    }
}

#[test]
fn an_axis_is_read_as_meant_with_a_note() {
    let text = r#"<robot name="r"><link name="a"/><link name="b"/><link name="c"/>
        <joint name="j" type="continuous"><axis xyz="2.2e-08 -4.4e-08 -1.0"/><parent link="a"/><child link="b"/></joint>
        <joint name="f" type="fixed"><origin xyz="1 0 0" rpy="0 -1.5707927 0"/><parent link="b"/><child link="c"/></joint></robot>"#;
    let robot = read(text);
    let axis = |reading| robot.chain(None, None, reading).unwrap().value.joints()[0].screw.direction().into_inner();
    assert_eq!(axis(Reading::Intended).as_slice(), [0.0, 0.0, -1.0]);
    assert!(axis(Reading::AsWritten).x > 1e-8);
    let notes: Vec<String> =
        robot.chain(None, None, Reading::Intended).unwrap().notes.iter().map(ToString::to_string).collect();
    assert!(notes[0].contains("axis 2.2e-08 -4.4e-08 -1.0 read as 0 0 -1"), "{notes:?}");
    assert!(notes[1].contains("-1.5707927 read as -π/2"), "{notes:?}");
}
